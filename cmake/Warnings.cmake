# Warnings are errors in our own code; system headers are exempt.
add_library(stationd_warnings INTERFACE)
target_compile_options(stationd_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual -Wcast-align>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 22)
  # doctest's macros use __COUNTER__, which every compiler that we know has; and std::stable_sort of the older
  # libstdc++ uses what a newer standard deprecates.
  target_compile_options(stationd_warnings INTERFACE -Wno-c2y-extensions -Wno-deprecated-declarations)
endif()
