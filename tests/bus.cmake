# Tests of dds_bridge, included by CMakeLists.txt.
stationd_test(bus_test FILES ${CMAKE_CURRENT_LIST_DIR}/bus_types_test.cpp ${CMAKE_CURRENT_LIST_DIR}/bus_body_test.cpp
              LIBS stationd_dds_bridge)
target_compile_definitions(bus_test PRIVATE STATIOND_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
stationd_test(bus_exchange_test LABEL e2e FILES ${CMAKE_CURRENT_LIST_DIR}/bus_exchange_test.cpp LIBS stationd_dds_bridge)
stationd_test(bus_bridge_test LABEL e2e FILES ${CMAKE_CURRENT_LIST_DIR}/bus_bridge_test.cpp LIBS stationd_dds_bridge)
