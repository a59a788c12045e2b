// Commands: what stationctl does, one function for each.
// Owned by main().
// The main thread.
#pragma once

#include "ctl/arguments.hpp"

namespace stationd::ctl {

/// Carries out the command line; the process's exit status. Catches what the bus throws.
int run(const Arguments& arguments);

int list(const Arguments& arguments);
int watch(const Arguments& arguments);
int start(const Arguments& arguments);
int stop(const Arguments& arguments);
int msg(const Arguments& arguments);
int reset(const Arguments& arguments);
int get(const Arguments& arguments);
int force(const Arguments& arguments);
int unforce(const Arguments& arguments);
int set(const Arguments& arguments);
int describe(const Arguments& arguments);
int events(const Arguments& arguments);
int stats(const Arguments& arguments);

}  // namespace stationd::ctl
