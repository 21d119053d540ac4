#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hybrid::archive {

// A file that a unit reads, as it was when the plan was made.
struct Input {
  std::filesystem::path file;  // absolute
  std::uintmax_t bytes = 0;
  std::int64_t mtime_ns = 0;
  std::string xxh3;     // of the content; "" where it could not be read
  std::string problem;  // why, or ""
};

// The scans of a file by their headers, as far as a plan needs them.
struct ScanListing {
  struct One {
    std::size_t index = 0;
    std::uint64_t samples = 0;
  };
  std::vector<One> scans;
  std::string problem;  // why the file cannot be listed, or ""
};

// Hashes of inputs and listings of scan files, kept from plan to plan: a file whose size, modification time
// and inode are as they were is not read again.
class InputCache {
 public:
  // `rehash`: reads every file again, and says which had changed behind their times. `sources`: the listings
  // are this program version's. A damaged or missing cache file is an empty cache.
  InputCache(std::filesystem::path file, std::string sources, bool rehash);

  // Never throws for a file that cannot be read: that is its `problem`.
  Input look(const std::filesystem::path& file);
  // Of a file of many: hashes them on all threads.
  std::vector<Input> look(const std::vector<std::filesystem::path>& files);
  // `salvage` as for io::list_scans.
  ScanListing list(const std::filesystem::path& file, bool salvage);

  // Files whose content differs though size and times are the same (only with `rehash`).
  const std::vector<std::string>& changed_unseen() const { return changed_unseen_; }
  std::uintmax_t bytes_read() const { return bytes_read_; }

  // Writes the cache of what was looked at since construction, unless it is as the file has it.
  void save() const;

 private:
  struct Stat {
    std::uintmax_t bytes = 0, inode = 0;
    std::int64_t mtime_ns = 0;
    bool operator==(const Stat&) const = default;
  };
  static Stat stat_of(const std::filesystem::path& file);
  static std::vector<std::int64_t> numbers_of(const Stat& stat);

  std::filesystem::path file_;
  std::string sources_;
  bool rehash_;
  nlohmann::json old_, new_;
  std::string old_text_;
  std::map<std::string, Input> seen_;
  std::vector<std::string> changed_unseen_;
  std::uintmax_t bytes_read_ = 0;
};

// Whether the file's size and time are still those of the plan. Throws ErrorKind::failed naming the file
// when not: the result would not be that of its key.
void check_unchanged(const Input& input);

nlohmann::ordered_json to_json(const Input& input);
Input input_from_json(const nlohmann::ordered_json& json);

}  // namespace hybrid::archive
