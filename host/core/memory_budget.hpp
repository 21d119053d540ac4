#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace hybrid {

// Whether what is freed stays with the process, for what it allocates next. Stages allocate and free images
// by the hundred megabytes: given back to the system each time, every page is cleared again for the next one,
// a twentieth of a large scan's CPU time (of 20 megapixels 5.2 s in the system, 3.3 kept, of 43 s in all).
// Returns what was asked for before (at first false).
bool keep_freed_memory(bool keep);

// Keeps the memory of this process near `bytes` while it lives: arrays of 4 MiB and more that `new` makes (as
// all of std::vector does) are then pages of files without a name in `folder`, and a thread takes pages out
// of memory, oldest first, when the process holds more than the budget. What is touched again comes back by
// itself, from the system's file cache or from the disk; no result changes. The system may drop these pages
// wherever others need memory, and a kill leaves no file behind.
//
// Not a limit: what is smaller than an array, and the device's buffers, stays in memory, and 256 MiB of
// arrays (a quarter of the budget, if less) stay whatever else there is, so that the work goes on. An array
// that finds no room in the folder (full, or of a file system that cannot promise room) is made in memory as
// usual, with one warning. Arrays made before, or that outlive the budget, are left where they are. One
// budget at a time. While it lives, freed memory is given back.
class MemoryBudget {
 public:
  MemoryBudget(std::uint64_t bytes, const std::filesystem::path& folder);
  ~MemoryBudget();
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

 private:
  class Trimmer;
  std::unique_ptr<Trimmer> trimmer_;
  bool kept_;
};

// Memory of this process now: all, and of that pages of files.
struct ResidentMemory {
  std::uint64_t bytes = 0, file_bytes = 0;
};
ResidentMemory resident_memory();

}  // namespace hybrid
