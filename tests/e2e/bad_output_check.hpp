#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"

namespace hybrid::e2e {

// After a run of the mini scene that did not end well: `out` may not exist; every file in it must be one that
// a good run writes, complete, and none may be a temporary.
void expect_complete_files(const std::filesystem::path& out);

// Exit code, "error" on stderr, and every part of the message.
void expect_failure(const Outcome& outcome, int code, const std::vector<std::string>& parts);

}  // namespace hybrid::e2e
