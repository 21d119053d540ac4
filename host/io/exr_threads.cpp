#include "io/exr_threads.hpp"

#include <ImfThreading.h>

#include <mutex>

#include "core/parallel.hpp"

namespace hybrid::io {

int start_exr_threads() {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const int count = thread_count();
  if (Imf::globalThreadCount() != count) Imf::setGlobalThreadCount(count);
  return count;
}

}  // namespace hybrid::io
