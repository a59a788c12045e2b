# A compiler cache where there is one: a second checkout builds in seconds.
find_program(STATIOND_CCACHE ccache)
mark_as_advanced(STATIOND_CCACHE)
if(STATIOND_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER ${STATIOND_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${STATIOND_CCACHE})
endif()
