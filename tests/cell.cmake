# Tests of programs, included by CMakeLists.txt.
add_library(cell_harness STATIC ${CMAKE_CURRENT_LIST_DIR}/cell_harness.cpp)
target_link_libraries(cell_harness PRIVATE stationd_warnings PUBLIC stationd_programs stationd_io)
if(STATIOND_SANITIZE)
  target_compile_definitions(cell_harness PUBLIC CELL_THINNED=8)
endif()
stationd_test(cell_run_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_run_test.cpp LIBS cell_harness)
stationd_test(cell_kill_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_kill_test.cpp LIBS cell_harness)
stationd_test(cell_fault_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_fault_test.cpp LIBS cell_harness)
stationd_test(cell_parts_test FILES ${CMAKE_CURRENT_LIST_DIR}/cell_parts_test.cpp LIBS stationd_programs)
if(NOT STATIOND_SANITIZE) # which have a longer time-out already
  set_tests_properties(cell_kill_test cell_run_test cell_fault_test PROPERTIES TIMEOUT 300)
endif()
