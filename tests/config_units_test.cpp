// Units, addresses and environment variables as configuration files write them.
#include <cstdlib>

#include <array>

#include <doctest/doctest.h>

#include "config/expand.hpp"
#include "config/units.hpp"

namespace stationd::config {

TEST_CASE("duration with a unit is exact in nanoseconds [CFG-2]") {
  CHECK(parse_duration_ns("250us") == 250'000);
  CHECK(parse_duration_ns("10ms") == 10'000'000);
  CHECK(parse_duration_ns("1.5s") == 1'500'000'000);
  CHECK(parse_duration_ns("2min") == 120'000'000'000);
  CHECK(parse_duration_ns("1h") == 3'600'000'000'000);
  CHECK(parse_duration_ns("0ms") == 0);
  CHECK(parse_duration_ns("0.000001s") == 1'000);
  CHECK(parse_duration_ns("10 ms") == 10'000'000);
}

TEST_CASE("duration without unit, with a wrong one or out of bounds is none [CFG-2]") {
  for (const std::string_view text :
       {"", "10", "ms", "-1ms", "1.ms", ".5s", "1.2.3s", "10msec", "10m", "0.1ns", "1e3s",
        "99999999999999999999s", "9223372036854775807h", "10ms ", "١ms"})
    CHECK_MESSAGE(!parse_duration_ns(text), text);
}

TEST_CASE("duration text names the largest unit that is whole [CFG-1]") {
  CHECK(duration_text(250'000) == "250us");
  CHECK(duration_text(60'000'000'000) == "1min");
  CHECK(duration_text(1'500'000'000) == "1500ms");
  CHECK(duration_text(0) == "0s");
}

TEST_CASE("size needs a unit [CFG-2]") {
  CHECK(parse_size_bytes("8KiB") == 8192);
  CHECK(parse_size_bytes("64kB") == 64'000);
  CHECK(!parse_size_bytes("8192"));
  CHECK(size_text(8192) == "8KiB");
}

TEST_CASE("address is an IPv4 literal with a port [CFG-1]") {
  std::string error;
  const auto full = parse_host_port("192.168.0.10:5020", error);
  REQUIRE(full);
  CHECK(full->host == "192.168.0.10");
  CHECK(full->port == 5020);
  CHECK(parse_host_port("10.0.0.1", error)->port == 502);
  for (const std::string_view text :
       {"", "plc.local:502", "10.0.0:502", "10.0.0.256:502", "10.0.0.1:0", "10.0.0.1:", "10.0.0.1:65536",
        "1.2.3.4.5:6", "01.2.3.4:5", "::1", "10.0.0.1:5:6", "1..2.3"})
    CHECK_MESSAGE(!parse_host_port(text, error), text);
}

TEST_CASE("point is device, table and address from 0 [IO-1]") {
  std::string error;
  const auto point = parse_point("remote-io-1:di:19", error);
  REQUIRE(point);
  CHECK(point->device == "remote-io-1");
  CHECK(point->table == io::Table::discrete_input);
  CHECK(point->address == 19);
  CHECK(parse_point("io:hr:0xFFFF", error)->address == 65535);
  for (const std::string_view text : {"", "io", "io:di", "io:di:", "io:dx:0", ":di:0", "io:di:-1",
                                      "io:di:65536", "io:di:1:2", "io:di:1x", "i o:di:1"})
    CHECK_MESSAGE(!parse_point(text, error), text);
}

TEST_CASE("point in the 40001 style is refused with the address that is meant [IO-1]") {
  std::string error;
  CHECK(!parse_point("io:40001", error));
  CHECK(error.find("here \"io:hr:0\"") != std::string::npos);
  CHECK(!parse_point("io:hr:40100", error));
  CHECK(error.find("here \"io:hr:99\"") != std::string::npos);
  CHECK(error.find("0x9ca4") != std::string::npos);
  CHECK(!parse_point("io:ir:30003", error));
  CHECK(error.find("here \"io:ir:2\"") != std::string::npos);
  CHECK(!parse_point("io:hr:400001", error));
  CHECK(error.find("here \"io:hr:0\"") != std::string::npos);
  CHECK(parse_point("io:hr:30001", error));
}

TEST_CASE("nearest finds the key that was meant and nothing far off [CFG-1]") {
  static constexpr std::array<std::string_view, 4> known = {"period", "priority", "phase", "cpu"};
  CHECK(nearest("peroid", known) == "period");
  CHECK(nearest("priorty", known) == "priority");
  CHECK(nearest("colour_of_the_box", known).empty());
  CHECK(nearest("", known).empty());
  CHECK(nearest(std::string(100'000, 'x'), known).empty());
}

TEST_CASE("environment variable takes the place of its name, or the default [CFG-1]") {
  setenv("STATIOND_TEST_SET", "42", 1);
  setenv("STATIOND_TEST_EMPTY", "", 1);
  unsetenv("STATIOND_TEST_UNSET");
  CHECK(expand_environment("a${STATIOND_TEST_SET}b").text == "a42b");
  CHECK(expand_environment("${STATIOND_TEST_SET:-7}").text == "42");
  CHECK(expand_environment("${STATIOND_TEST_UNSET:-7}").text == "7");
  CHECK(expand_environment("${STATIOND_TEST_EMPTY:-7}").text == "7");
  CHECK(expand_environment("${STATIOND_TEST_UNSET:-}").text.empty());
  CHECK(expand_environment("$${HOME} $5 }").text == "${HOME} $5 }");
  CHECK(!expand_environment("$${HOME}").expanded);
}

TEST_CASE("environment reference that is broken or unset says how to mend it [CFG-1]") {
  unsetenv("STATIOND_TEST_UNSET");
  CHECK(expand_environment("${STATIOND_TEST_UNSET}").error.find(":-default") != std::string::npos);
  CHECK(expand_environment("${STATIOND").error.find("closing") != std::string::npos);
  CHECK(!expand_environment("${}").error.empty());
  CHECK(!expand_environment("${9x}").error.empty());
  CHECK(!expand_environment("${a b:-c}").error.empty());
}

}  // namespace stationd::config
