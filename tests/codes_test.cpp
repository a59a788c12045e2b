#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "scan/codes.hpp"

using namespace stationd;

namespace {

const std::string kPage = std::string(STATIOND_SOURCE_DIR) + "/docs/codes.md";

std::string page() {
  std::string text =
      "# Codes: faults, warnings and events\n\n"
      "Made from the table in `scan/codes.cpp`; `stationctl describe ST1203` tells the same. 1xxx come from "
      "the runtime, 2xxx and\n"
      "3xxx from the cell's programs, 9xxx are free for your own. A fault puts the station into FAULT; a "
      "warning and an info do not.\n\n"
      "| code | severity | name | cause | remedy |\n| --- | --- | --- | --- | --- |\n";
  for (const CodeInfo& row : all_codes())
    text += "| ST" + std::to_string(row.code) + " | " + std::string(name_of(row.severity)) + " | " +
            std::string(row.name) + " | " + std::string(row.cause) + " | " + std::string(row.remedy) + " |\n";
  return text;
}

}  // namespace

TEST_CASE("Code table is ascending, each row with name, cause and remedy") {
  std::uint32_t last = 0;
  for (const CodeInfo& row : all_codes()) {
    CAPTURE(row.code);
    CHECK(row.code > last);
    CHECK_FALSE(row.name.empty());
    CHECK_FALSE(row.cause.empty());
    CHECK_FALSE(row.remedy.empty());
    CHECK(find_code(row.code) == &row);
    last = row.code;
  }
  CHECK(find_code(0) == nullptr);
  CHECK(find_code(last + 1) == nullptr);
}

TEST_CASE("Page of codes is the table (STATIOND_WRITE_DOCS=1 writes it)") {
  if (std::getenv("STATIOND_WRITE_DOCS") != nullptr) std::ofstream(kPage) << page();
  std::ifstream file(kPage);
  const std::string shipped{std::istreambuf_iterator<char>(file), {}};
  CHECK(shipped == page());
}
