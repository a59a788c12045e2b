# Tests of dds_bridge, included by CMakeLists.txt.
stationd_test(bus_exchange_test LABEL e2e FILES ${CMAKE_CURRENT_LIST_DIR}/bus_exchange_test.cpp LIBS stationd_dds_bridge)
