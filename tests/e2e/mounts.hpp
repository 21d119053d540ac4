#pragma once
#include <gtest/gtest.h>

#include <string>

#include "program.hpp"

namespace hybrid::e2e {

// Runs shell lines as root of a mount namespace, which ends with them; the user's own where the test does
// not run as root.
Outcome run_with_mounts(const std::string& lines);

bool may_mount();

}  // namespace hybrid::e2e

#define SKIP_WITHOUT_MOUNTS() \
  if (!hybrid::e2e::may_mount()) GTEST_SKIP() << "this machine does not allow mounts"
