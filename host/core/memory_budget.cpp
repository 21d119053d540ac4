#include "core/memory_budget.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <thread>

#include "core/error.hpp"
#include "core/log.hpp"
#include "core/memory_pause.hpp"
#include "core/paged_arrays.hpp"

namespace hybrid {
namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

// Of arrays, a quarter of the budget where that is less.
constexpr std::uint64_t kLeastArrays_bytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kMostStep_bytes = std::uint64_t{64} << 20;
// All threads together fill memory no faster than this; between looks it stays within the share left for it.
constexpr double kFill_bytes_per_ms = 64e6;
constexpr double kShortest_ms = 0.5, kLongest_ms = 20;

}  // namespace

bool keep_freed_memory(bool keep) {
  static std::atomic<bool> kept = false;
  mallopt(M_MMAP_THRESHOLD, keep ? 1 << 30 : 1 << 20);
  mallopt(M_TRIM_THRESHOLD, keep ? std::numeric_limits<int>::max() : 1 << 20);
  if (!keep) malloc_trim(0);
  return kept.exchange(keep);
}

ResidentMemory resident_memory() {
  static const int statm = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  static const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  char text[128] = {};
  if (statm < 0 || pread(statm, text, sizeof text - 1, 0) <= 0) return {};
  char* at = text;
  std::strtoull(at, &at, 10);  // all addresses
  const std::uint64_t bytes = std::strtoull(at, &at, 10) * page;
  return {bytes, std::strtoull(at, &at, 10) * page};
}

class MemoryBudget::Trimmer {
 public:
  explicit Trimmer(std::uint64_t bytes)
      : most_(bytes - bytes / 8),
        far_too_much_(bytes - bytes / 32 * 3),
        least_arrays_(std::min(kLeastArrays_bytes, bytes / 4)),
        files_before_(resident_memory().file_bytes),
        thread_([this] { work(); }) {}
  ~Trimmer() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    while (!ends_) {
      ResidentMemory now = resident_memory();
      if (now.bytes > most_) {
        // Threads that read arrays bring pages in faster than they can be taken out. They do not wait where
        // that was no use: what holds the memory is no array.
        if (helps_ && now.bytes > far_too_much_) memory_is_short = true;
        // A sixteenth below, so that it does not start anew at once.
        const std::uint64_t wanted = most_ - most_ / 16;
        const std::uint64_t round = paged_arrays::total_bytes();
        for (std::uint64_t gone = 0; now.bytes > wanted && holds_arrays(now) && gone < round;) {
          const std::uint64_t step = paged_arrays::trim(std::min(kMostStep_bytes, most_ / 16));
          if (step == 0) break;
          gone += step;
          now = resident_memory();
          if (helps_ && now.bytes > far_too_much_) memory_is_short = true;
        }
        helps_ = now.bytes <= wanted;
        memory_is_short = false;
        memory_is_short.notify_all();
      }
      if (!told_ && paged_arrays::refused() > 0) {
        told_ = true;
        log::warning("no room for arrays beside the results; they stay in memory, over its budget");
      }
      const double left = now.bytes < most_ ? static_cast<double>(most_ - now.bytes) : 0;
      wake_.wait_for(lock, Milliseconds(std::clamp(left / kFill_bytes_per_ms, kShortest_ms, kLongest_ms)));
    }
  }

  bool holds_arrays(const ResidentMemory& now) const {
    return now.file_bytes > files_before_ + least_arrays_;
  }

  const std::uint64_t most_, far_too_much_, least_arrays_, files_before_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ends_ = false, told_ = false, helps_ = true;
  std::thread thread_;
};

MemoryBudget::MemoryBudget(std::uint64_t bytes, const std::filesystem::path& folder)
    : kept_(keep_freed_memory(false)) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (!paged_arrays::use_folder(folder)) {
    log::warning("the system has no addresses left for arrays under a memory budget: there is none");
    paged_arrays::use_folder({});
    return;
  }
  trimmer_ = std::make_unique<Trimmer>(bytes);
}

MemoryBudget::~MemoryBudget() {
  keep_freed_memory(kept_);
  paged_arrays::use_folder({});
}

}  // namespace hybrid
