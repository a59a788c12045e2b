# Tests of the supervisor and of stationctl.
stationd_test(supervisor_test FILES supervisor_model_test.cpp supervisor_live_test.cpp
              LIBS stationd_supervisor)
