#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace hybrid::archive {

// Another program, run to its end: exit code (128 + signal when it was killed, 127 when there is none of
// that name), what it said on stdout and, unless `shows_errors`, on stderr; else stderr is ours.
struct ProgramEnd {
  int exit_code = 0;
  std::string out, err;
};
ProgramEnd run_program(const std::vector<std::string>& words, bool shows_errors = false);

// The file of this program.
std::filesystem::path own_program();

}  // namespace hybrid::archive
