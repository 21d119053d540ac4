#include "io/exr/exr_threads.hpp"

#include <ImfThreading.h>

#include <mutex>

#include "core/parallel.hpp"

namespace hybrid::io {

int start_exr_threads() {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  // Of one thread the caller itself: a worker would only be waited for, tile by tile.
  const int count = thread_count() == 1 ? 0 : thread_count();
  if (Imf::globalThreadCount() != count) Imf::setGlobalThreadCount(count);
  return count;
}

}  // namespace hybrid::io
