#pragma once
#include <optional>
#include <string>

#include "program.hpp"

namespace hybrid::e2e {

// A moment in a run, exact to the system call, so that a signal needs no sleep and no hook in the program.
struct Moment {
  std::string prints;   // a thread is about to print this on stderr, or
  std::string renames;  // to rename a file to a path that ends so
};

// Runs `hybrid ARGUMENTS` and sends it `signal` at the first such moment. Nothing when this machine does not
// allow tracing. A run that has not ended after a minute is killed and has exit code -1; one that the signal
// ended has 128 + signal.
std::optional<Outcome> run_and_signal(const std::string& arguments, const Moment& moment, int signal);

}  // namespace hybrid::e2e
