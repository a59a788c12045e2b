// Files that are no TOML: place, what is wrong, and what was probably meant.
#include <doctest/doctest.h>

#include "config/config.hpp"

namespace stationd::config {
namespace {

/// The one problem of that text.
std::string said_of(std::string_view text) {
  const auto loaded = parse_controller(text, "c.toml");
  REQUIRE(loaded.problems.size() == 1);
  return loaded.problems.front().text;
}

bool says(std::string_view text, std::string_view part) {
  const std::string said = said_of(text);
  INFO(said);
  return said.starts_with("c.toml:") && said.find(": syntax error: ") != std::string::npos &&
         said.find("; " + std::string(part)) != std::string::npos;
}

}  // namespace

TEST_CASE("a syntax error has its place, the parser's words and a hint [CFG-1]") {
  CHECK(said_of("[[task]]\nperiod = 10ms # fast\n") ==
        "c.toml:2:12: syntax error: expected digit, saw 'm'; what is no number stands in quotation marks: "
        "period = \"10ms\" (the rest of the file is checked once this is mended)");
}

TEST_CASE("a value without quotation marks is told how it is written [CFG-1]") {
  CHECK(says("period = 10 ms\n", "what is no number stands in quotation marks: period = \"10 ms\""));
  CHECK(says("address = 127.0.0.1:502\n", "what is no number stands in quotation marks: address ="));
  CHECK(says("program = loader\n", "what is no number stands in quotation marks: program = \"loader\""));
  CHECK(
      says("a = \xE2\x80\x9C"
           "10ms\xE2\x80\x9D\n",
           "take straight quotation marks"));
  CHECK(says("a = True\n", "true and false are the words"));
  CHECK(says("a = off\n", "true and false are the words"));
  CHECK(says("a = 0123\n", "what is no number"));
}

TEST_CASE("what is not closed or parted is named [CFG-1]") {
  CHECK(says("a = \"abc\nb = 1\n", "the closing quotation mark is missing"));
  CHECK(says("a = 'abc\nb = 1\n", "the closing quotation mark is missing"));
  CHECK(says("a = \"\"\"abc\n", "the closing quotation mark is missing"));
  CHECK(says("a = \"x\"y\"\n", "something follows the closing quotation mark"));
  CHECK(says("a = \"a\x01b\"\n", "a control character"));
  CHECK(says("a = [1, 2\nb = 3\n", "the values of a list are parted by commas, and ] ends it"));
  CHECK(says("a = [1, , 2]\n", "a value is missing before the comma"));
  CHECK(says("a = { x = 1\nb = 2\n", "the pairs of { ... } are parted by commas"));
  CHECK(says("a = { x = 1, }\n", "no comma stands before }"));
  CHECK(says("[controller\n", "the heading's closing bracket is missing"));
  CHECK(says("[controller] x\n", "a heading stands alone on its line"));
}

TEST_CASE("keys, signs and comments of other languages are named [CFG-1]") {
  CHECK(says("period 10\n", "\"=\" is missing"));
  CHECK(says("two words = 1\n", "a key is one word"));
  CHECK(says("period: 10\n", "a value follows \"=\", not \":\""));
  CHECK(says("= 1\n", "the key before \"=\" is missing"));
  CHECK(says("a =\n", "the value behind \"=\" is missing"));
  CHECK(says("a == 1\n", "each KEY = VALUE stands on a line of its own"));
  CHECK(says("a = 1 b = 2\n", "each KEY = VALUE stands on a line of its own"));
  CHECK(says("// x\n", "a comment begins with #"));
  CHECK(says("a = 1 // x\n", "a comment begins with #"));
  CHECK(says("; x\n", "a comment begins with #"));
  CHECK(says("a = \"c:\\path\"\n", "a backslash in text is written"));
  CHECK(says("a = \"\xFF\"\n", "save the file as UTF-8"));
}

TEST_CASE("what stands twice is named [CFG-2]") {
  CHECK(says("a = 1\na = 2\n", "a key stands once in its section"));
  CHECK(says("[t]\nx = 1\n[t]\ny = 2\n", "a heading stands once"));
}

}  // namespace stationd::config
