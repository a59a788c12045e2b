# The tests of preset rtsan: what is marked STATIOND_NONBLOCKING runs under RealtimeSanitizer, which ends the
# process at the first call that may block. Unit tests whose programs are made of std::function are no subject
# for it.
add_library(cell_harness STATIC cell_harness.cpp)
target_link_libraries(cell_harness PRIVATE stationd_warnings PUBLIC stationd_programs stationd_io)
target_compile_definitions(cell_harness PUBLIC CELL_THINNED=8)
stationd_test(cell_run_test FILES cell_run_test.cpp LIBS cell_harness)
stationd_test(cell_fault_test FILES cell_fault_test.cpp LIBS cell_harness)
add_dependencies(unit_tests stationd stationd-supervisor stationctl)
stationd_script_test(in_process unit ${CMAKE_CURRENT_SOURCE_DIR}/e2e/in_process.py)

# That both would catch it: a program that allocates in its scan.
add_executable(rtsan_catches rtsan_catches.cpp)
target_link_libraries(rtsan_catches PRIVATE stationd_warnings stationd_scan)
add_dependencies(unit_tests rtsan_catches)
stationd_script_test(rtsan_catches unit $<TARGET_FILE:rtsan_catches>)
set_tests_properties(rtsan_catches PROPERTIES PASS_REGULAR_EXPRESSION
                     "Intercepted call to real-time unsafe function `malloc` in real-time context")
stationd_script_test(function_effects_catch unit ${CMAKE_CXX_COMPILER} -std=c++20 -fsyntax-only -Werror
                     -Wfunction-effects -DSTATIOND_PROVE -I${CMAKE_SOURCE_DIR}
                     ${CMAKE_CURRENT_SOURCE_DIR}/rtsan_catches.cpp)
set_tests_properties(function_effects_catch PROPERTIES PASS_REGULAR_EXPRESSION
                     "must not allocate or deallocate memory")
