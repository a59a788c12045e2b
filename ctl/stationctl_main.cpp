// stationctl: the command line of a cell.
#include <cstdlib>
#include <string_view>
#include <vector>

#include "ctl/commands.hpp"

int main(int argc, char** argv) {
  const std::vector<std::string_view> words(argv + (argc > 0 ? 1 : 0), argv + argc);
  return stationd::ctl::run(
      stationd::ctl::parse_arguments(words, [](const char* name) { return std::getenv(name); }));
}
