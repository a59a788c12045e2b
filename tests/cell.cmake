# Tests of programs, included by CMakeLists.txt.
add_library(cell_harness STATIC ${CMAKE_CURRENT_LIST_DIR}/cell_harness.cpp)
target_link_libraries(cell_harness PRIVATE stationd_warnings PUBLIC stationd_programs stationd_io)
stationd_test(cell_run_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_run_test.cpp LIBS cell_harness)
stationd_test(cell_kill_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_kill_test.cpp LIBS cell_harness)
stationd_test(cell_fault_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_fault_test.cpp LIBS cell_harness)
stationd_test(cell_parts_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_parts_test.cpp LIBS stationd_programs)
