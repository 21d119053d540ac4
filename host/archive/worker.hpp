#pragma once
#include <filesystem>
#include <string>

namespace hybrid::archive {

// Where a worker's answers go: beside stdin, stdout and stderr, on which libraries may speak.
inline constexpr int kAnswerDescriptor = 3;

// The loop of a worker process: one unit after the other as stdin names them, until it ends. What a unit says
// on stderr goes to log.txt in its folder. Kernels are built once for all units.
//   stdin, per unit:  {"unit": index, "key": key of its object, "work": folder of Store::begin_object}
//   answers:          {"ready": true} when the device is open, or {"ready": false, "error_kind", "error"};
//                     per unit {"unit", "ok": true}, or {"unit", "ok": false, "error_kind", "error"}
// Returns the process' exit code.
int run_worker(const std::filesystem::path& store, const std::string& device);

}  // namespace hybrid::archive
