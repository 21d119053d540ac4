#include "core/paged_arrays.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <string>

#include "core/scratch_file.hpp"

namespace hybrid::paged_arrays {
namespace {

// Addresses are handed out of one range, so that a comparison tells whose an array is.
constexpr std::uint64_t kRange_bytes = std::uint64_t{1} << 40;
constexpr std::uint64_t kGrain_bytes = std::uint64_t{2} << 20;

struct State {
  std::mutex mutex;
  std::string folder;
  std::map<std::uintptr_t, std::uint64_t> arrays;  // begin, bytes
  std::uintptr_t next = 0;                         // where to look for a gap
  std::uintptr_t hand = 0;                         // where trimming goes on
};

// Never destroyed: arrays may be released after main.
State& state() {
  alignas(State) static unsigned char memory[sizeof(State)];
  static State* instance = new (memory) State;
  return *instance;
}

std::atomic<std::uintptr_t> range_begin{0};
std::atomic<bool> in_use{false};
std::atomic<std::uint64_t> refusals{0};

void* at(std::uintptr_t address) {
  return reinterpret_cast<void*>(address);
}

bool reserve(std::uintptr_t begin, std::uint64_t bytes) {
  return mmap(at(begin), bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0) !=
         MAP_FAILED;
}

// The first gap of so many bytes from `from` on, 0 when there is none.
std::uintptr_t gap(const State& s, std::uintptr_t from, std::uint64_t bytes) {
  const std::uintptr_t begin = range_begin, end = begin + kRange_bytes;
  std::uintptr_t start = std::max(from, begin);
  auto after = s.arrays.upper_bound(start);
  if (after != s.arrays.begin()) {
    const auto before = std::prev(after);
    start = std::max(start, before->first + before->second);
  }
  for (; after != s.arrays.end() && after->first - start < bytes; ++after)
    start = after->first + after->second;
  return end - start >= bytes ? start : 0;
}

// A nameless file, all its room promised: a full disk is met here and not by a signal later.
int open_file(const std::string& folder, std::uint64_t bytes) {
  const int file = open_nameless_file(folder);
  if (file >= 0 && fallocate(file, 0, 0, static_cast<off_t>(bytes)) != 0) {
    close(file);
    return -1;
  }
  return file;
}

}  // namespace

bool use_folder(const std::filesystem::path& folder) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  s.folder = folder.string();
  refusals = 0;
  if (!s.folder.empty() && range_begin == 0) {
    void* range = mmap(nullptr, kRange_bytes + kGrain_bytes, PROT_NONE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (range == MAP_FAILED) return false;
    range_begin = reinterpret_cast<std::uintptr_t>(range);
    range_begin = (range_begin + kGrain_bytes - 1) / kGrain_bytes * kGrain_bytes;
    s.next = s.hand = range_begin;
  }
  in_use = !s.folder.empty();
  return true;
}

void* make(std::size_t bytes) noexcept {
  if (!in_use.load(std::memory_order_relaxed) || bytes > kRange_bytes / 2) return nullptr;
  State& s = state();
  try {
    const std::lock_guard lock(s.mutex);
    if (s.folder.empty()) return nullptr;
    const std::uint64_t whole = (bytes + kGrain_bytes - 1) / kGrain_bytes * kGrain_bytes;
    std::uintptr_t begin = gap(s, s.next, whole);
    if (begin == 0) begin = gap(s, range_begin, whole);
    const int file = begin == 0 ? -1 : open_file(s.folder, whole);
    if (file < 0) {
      ++refusals;
      return nullptr;
    }
    const bool mapped =
        mmap(at(begin), whole, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0) != MAP_FAILED;
    close(file);
    if (!mapped) {
      ++refusals;
      return nullptr;
    }
    // Page by page: else the kernel maps what lies around a touched page with it, and what is filled column
    // by column, rows apart, is in memory as a whole again as soon as it is taken out.
    madvise(at(begin), whole, MADV_RANDOM);
    s.arrays.emplace(begin, whole);
    s.next = begin + whole;
    return at(begin);
  } catch (...) {  // no memory for the list's entry: nor will there be for the array
    return nullptr;
  }
}

bool is_ours(const void* memory) noexcept {
  const std::uintptr_t begin = range_begin.load(std::memory_order_relaxed);
  return begin != 0 && reinterpret_cast<std::uintptr_t>(memory) - begin < kRange_bytes;
}

void release(void* memory) noexcept {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  const auto array = s.arrays.find(reinterpret_cast<std::uintptr_t>(memory));
  reserve(array->first, array->second);  // the last of the file, which goes with it
  s.arrays.erase(array);
}

std::uint64_t trim(std::uint64_t bytes) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  std::uint64_t done = 0, all = 0;
  for (const auto& [begin, size] : s.arrays) all += size;
  bytes = std::min(bytes, all);
  while (done < bytes) {
    auto array = s.arrays.upper_bound(s.hand);
    if (array != s.arrays.begin() && std::prev(array)->first + std::prev(array)->second > s.hand) --array;
    if (array == s.arrays.end()) {
      s.hand = range_begin;
      continue;
    }
    const std::uintptr_t from = std::max(s.hand, array->first), end = array->first + array->second;
    const std::uint64_t size = std::min<std::uint64_t>(end - from, bytes - done);
    // Of a shared mapping: the page goes, what was written to it stays in the file.
    madvise(at(from), size, MADV_DONTNEED);
    s.hand = from + size;
    done += size;
  }
  return done;
}

std::uint64_t total_bytes() {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  std::uint64_t all = 0;
  for (const auto& [begin, size] : s.arrays) all += size;
  return all;
}

std::uint64_t refused() {
  return refusals;
}

}  // namespace hybrid::paged_arrays
