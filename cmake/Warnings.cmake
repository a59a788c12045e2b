# Warnings are errors in our own code; system headers are exempt.
add_library(stationd_warnings INTERFACE)
target_compile_options(stationd_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual -Wcast-align>)
