// Texts that the tools write for people: numbers, codes, states, events.
#include <doctest/doctest.h>

#include <cstdlib>
#include <ctime>

#include "dds_bridge/text.hpp"

namespace stationd::bus {

TEST_CASE("durations, codes, states and counts are as people read them [SYS-7]") {
  CHECK(short_duration(870) == "870ns");
  CHECK(short_duration(12'400) == "12us");
  CHECK(short_duration(1'340'000) == "1.3ms");
  CHECK(short_duration(2'100'000'000) == "2.1s");
  CHECK(short_duration(INT64_MIN).starts_with("-"));
  CHECK(code_text(1101) == "ST1101 field device lost");
  CHECK(code_text(123456) == "ST123456");
  CHECK(code_text(0).empty());
  CHECK(state_text(3) == "FAULT");
  CHECK(state_text(77) == "STATE 77");
  CHECK(severity_text(77) == "fault");
  CHECK(count_text(1, "station") == "1 station");
  CHECK(count_text(0, "piece") == "0 pieces");
  CHECK(count_text(2, "miss") == "2 misses");
}

TEST_CASE("a text is cut and padded by characters, not by bytes [SYS-7]") {
  CHECK(columns_of("Käfig") == 5);
  CHECK(fit("Käfig", 6) == "Käfig ");
  CHECK(fit("Käfigtür", 6) == "Käfig~");
  CHECK(fit_right("12", 4) == "  12");
  CHECK(fit("abc", 0).empty());
  CHECK(cut("abc", 3) == "abc");
}

TEST_CASE("a text from the network cannot move the cursor [SYS-7]") {
  CHECK(printable("a\x1b[2Jb\nc") == "a?[2Jb?c");
  CHECK(printable("a\nb\x1b", true) == "a\nb?");
  CHECK(printable("\xC2\x9B"
                  "31m") == "?31m");
  Gse gse;
  gse.STATION = "r\x1b";
  gse.TEXT = "\x07";
  CHECK(event_text(gse) == "--:--:-- r? info : ?");
}

TEST_CASE("an event's line says whether it is gone or still there [SYS-7]") {
  Gse gse;
  gse.STATION = "robot";
  gse.STATUS = 1101;
  gse.SEVERITY = 1;
  gse.SEQ = 4;
  CHECK(event_text(gse) == "--:--:-- robot warning gone: ST1101 field device lost");
  gse.ACTIVE = true;
  gse.EDGE = false;
  CHECK(event_text(gse) == "--:--:-- robot warning ST1101 field device lost (still)");
}

TEST_CASE("an event's line names the device that was lost [ASE-3]") {
  Gse gse;
  gse.STATION = "robot";
  gse.STATUS = 1101;
  gse.SEVERITY = 1;
  gse.SEQ = 4;
  gse.ACTIVE = true;
  gse.TEXT = "field device lost";
  CHECK(event_text(gse) == "--:--:-- robot warning ST1101 field device lost");
  gse.TEXT = "field device lost: remote-io-1";
  CHECK(event_text(gse) == "--:--:-- robot warning ST1101 field device lost: remote-io-1");
  CHECK(event_source(gse) == "remote-io-1");
  gse.STATUS = 9999;
  gse.TEXT = "tank is empty";
  CHECK(event_text(gse) == "--:--:-- robot warning ST9999: tank is empty");
}

TEST_CASE("a time has its zone [SYS-7]") {
  const std::int64_t time_ns = 1'767'225'600'250'000'000;  // 2026-01-01T00:00:00.25Z
  ::setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);
  ::tzset();
  CHECK(iso_time(time_ns) == "2026-01-01T01:00:00.250+01:00");
  CHECK(time_text(time_ns) == "01:00:00");
  CHECK(zone_text(time_ns) == "CET, UTC+01:00");
  ::setenv("TZ", "<-0330>3:30", 1);
  ::tzset();
  CHECK(iso_time(time_ns) == "2025-12-31T20:30:00.250-03:30");
  CHECK(zone_text(time_ns) == "UTC-03:30");
  ::setenv("TZ", "UTC0", 1);
  ::tzset();
  CHECK(zone_text(time_ns) == "UTC");
  ::unsetenv("TZ");
  ::tzset();
  CHECK(iso_time(0).empty());
}

TEST_CASE("a Table 4 event has ERROR and STATUS alone [ASE-4]") {
  Gse gse;
  gse.ERROR = true;
  gse.STATUS = 7;
  CHECK(event_text(gse) == "--:--:-- (no name) fault ST0007");
  gse.STATUS = 0;
  CHECK(event_text(gse) == "--:--:-- (no name) fault (no code)");
}

}  // namespace stationd::bus
