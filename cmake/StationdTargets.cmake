# stationd_library(NAME): the folder's one static library, from all its .cpp files except *_main.cpp.
function(stationd_library name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_main\\.cpp$")
  add_library(${name} STATIC ${sources})
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE stationd_warnings PUBLIC Threads::Threads)
endfunction()

# stationd_program(NAME FILE LIBS...): one executable.
function(stationd_program name file)
  add_executable(${name} ${file})
  target_link_libraries(${name} PRIVATE stationd_warnings ${ARGN})
endfunction()

# What scripts/sanitized builds: the executables of all unit tests.
add_custom_target(unit_tests)

# stationd_test(NAME FILES files... LIBS libs... [LABEL label]): one doctest executable, one ctest test.
# Label: unit (default) or e2e (whole daemons; runs alone). All tests that may open a DDS domain share the one
# that the run has claimed (STATIOND_TEST_DOMAIN), so they run one at a time.
function(stationd_test name)
  cmake_parse_arguments(T "" "LABEL" "FILES;LIBS" ${ARGN})
  add_executable(${name} ${T_FILES} ${CMAKE_SOURCE_DIR}/tests/doctest_main.cpp)
  target_link_libraries(${name} PRIVATE stationd_warnings ${T_LIBS})
  # Tests are compiled more often than they run, and what they test is optimised all the same: half of the
  # time of a cold scripts/check goes into optimising assertions, with sanitizers more.
  target_compile_options(${name} PRIVATE -O0 -g1)
  add_test(NAME ${name} COMMAND ${STATIOND_TEST_LAUNCHER} $<TARGET_FILE:${name}>)
  stationd_test_properties(${name} "${T_LABEL}")
  if(NOT T_LABEL OR T_LABEL STREQUAL unit)
    add_dependencies(unit_tests ${name})
  endif()
  if(T_LIBS MATCHES "stationd_(dds_bridge|daemon|supervisor|ctl)")
    set_tests_properties(${name} PROPERTIES RESOURCE_LOCK dds_domain)
  endif()
endfunction()

# stationd_script_test(NAME LABEL COMMAND...): a test that is a script; it is told where the build is.
function(stationd_script_test name label)
  add_test(NAME ${name} COMMAND ${ARGN} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  stationd_test_properties(${name} "${label}")
endfunction()

function(stationd_test_properties name label)
  set(environment STATIOND_BUILD=${CMAKE_BINARY_DIR} ${STATIOND_SANITIZER_ENVIRONMENT})
  set_tests_properties(${name} PROPERTIES LABELS unit TIMEOUT 120 ENVIRONMENT "${environment}")
  if(label AND NOT label STREQUAL unit)
    set_tests_properties(${name} PROPERTIES LABELS "${label}")
  endif()
  if(label MATCHES "e2e|analysis")
    set_tests_properties(${name} PROPERTIES RUN_SERIAL TRUE TIMEOUT 900)
  elseif(STATIOND_SANITIZE)
    set_tests_properties(${name} PROPERTIES TIMEOUT 600)
  endif()
endfunction()
