#include "core/parallel.hpp"

#include <tbb/global_control.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include "core/error.hpp"

namespace hybrid {
namespace {

std::unique_ptr<tbb::global_control>& limit() {
  static std::unique_ptr<tbb::global_control> instance;
  return instance;
}

}  // namespace

void set_thread_count(int count) {
  constexpr int kMost = 4096;
  if (count < 0 || count > kMost)
    fail(ErrorKind::usage, "--threads {}: expected 0 (all cores) or a number from 1 to {}", count, kMost);
  if (count == 0) return;
  limit() = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(count));
  // PoCL reads this once, when its CPU device starts.
  setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(count).c_str(), 1);
}

int thread_count() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace hybrid
