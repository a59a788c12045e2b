# Tests of the supervisor and of stationctl, included by CMakeLists.txt.
stationd_test(supervisor_test FILES supervisor_model_test.cpp supervisor_live_test.cpp
              LIBS stationd_supervisor)
stationd_test(ctl_test FILES ctl_test.cpp ctl_tags_test.cpp LIBS stationd_ctl)
stationd_test(supervisor_e2e_test LABEL e2e FILES supervisor_e2e_test.cpp LIBS stationd_supervisor)
stationd_test(ctl_e2e_test LABEL e2e FILES ctl_e2e_test.cpp LIBS stationd_dds_bridge)
target_compile_definitions(ctl_e2e_test PRIVATE STATIONCTL="$<TARGET_FILE:stationctl>")
add_dependencies(ctl_e2e_test stationctl)
