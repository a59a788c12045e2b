# Tests of dds_bridge, included by CMakeLists.txt.
stationd_test(bus_test FILES ${CMAKE_CURRENT_LIST_DIR}/bus_types_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bus_body_test.cpp ${CMAKE_CURRENT_LIST_DIR}/bus_text_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bus_order_numbers_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bus_tags_test.cpp
              LIBS stationd_dds_bridge)
target_compile_definitions(bus_test PRIVATE STATIOND_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
stationd_test(bus_exchange_test LABEL e2e FILES ${CMAKE_CURRENT_LIST_DIR}/bus_exchange_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bus_flood_test.cpp LIBS stationd_dds_bridge)
stationd_test(bus_bridge_test LABEL e2e FILES ${CMAKE_CURRENT_LIST_DIR}/bus_bridge_test.cpp LIBS
  stationd_dds_bridge)
stationd_test(bus_wire_test LABEL e2e FILES ${CMAKE_CURRENT_LIST_DIR}/bus_wire_test.cpp
              LIBS stationd_dds_bridge stationd_fastdds)

# A foreign peer made from the paper's literal types; idlc and Cyclone DDS serve in tests alone.
find_package(CycloneDDS QUIET)
if(CycloneDDS_FOUND)
  idlc_generate(TARGET table4_types FILES ${CMAKE_CURRENT_LIST_DIR}/interop/table4.idl)
  add_executable(cyclone_peer ${CMAKE_CURRENT_LIST_DIR}/interop/cyclone_peer.c)
  target_link_libraries(cyclone_peer PRIVATE table4_types CycloneDDS::ddsc)
  set_source_files_properties(${CMAKE_CURRENT_LIST_DIR}/interop/cyclone_peer.c
                              PROPERTIES COMPILE_OPTIONS "-Wall;-Wextra;-Wpedantic;-Werror")
  stationd_test(bus_interop_test LABEL e2e FILES ${CMAKE_CURRENT_LIST_DIR}/bus_interop_test.cpp LIBS
    stationd_dds_bridge)
  target_compile_definitions(bus_interop_test PRIVATE STATIOND_CYCLONE_PEER="$<TARGET_FILE:cyclone_peer>")
  add_dependencies(bus_interop_test cyclone_peer)
else()
  message(STATUS "No Cyclone DDS: bus_interop_test is left out (scripts/setup --test installs it)")
endif()
