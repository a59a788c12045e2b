// stationd: runs one controller from its configuration file.
#include <cstdio>
#include <string>
#include <vector>

#include "daemon/application.hpp"
#include "daemon/exit_status.hpp"

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  return stationd::run_stationd(arguments);
}
