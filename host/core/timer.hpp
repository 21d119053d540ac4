#pragma once
#include <chrono>

namespace hybrid {

// Wall clock since construction, for logs, timing.json and bench/ only: no result depends on it.
class Timer {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace hybrid
