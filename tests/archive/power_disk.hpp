#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace hybrid::e2e {

// What a power cut takes away of what was not brought to the disk (fsync of the file; for names, of the
// folder).
enum class Loss { nothing, everything, by_chance };

// A folder on a disk that forgets (power/power_cut.cpp) and whose power can be cut at any operation.
class PowerDisk {
 public:
  // Makes an empty folder, and `state` beside it.
  PowerDisk(std::filesystem::path folder, std::filesystem::path state);

  // Words before a command line: everything that it starts has this disk, and its process group dies before
  // the given operation from now (0: never). `ignore`: "files" or "folders", whose fsync shall do nothing.
  std::string environment(unsigned long cut_at, const std::string& ignore = "") const;
  // So many there were.
  unsigned long operations() const;

  // Waits until nobody is left of the commands that were started, and leaves in the folder what is there
  // after a restart. By chance: of each file the old bytes, the new ones or their beginning; of each name the
  // old or the new.
  void restart(Loss loss, std::uint32_t seed) const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_, state_;
};

}  // namespace hybrid::e2e
