#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace hybrid::io {

// Makes the folder and those above it. Throws ErrorKind::failed when there is no writable folder then,
// ErrorKind::temporary when the disk is full.
void create_output_folder(const std::filesystem::path& folder);

// Calls write(temporary) with a fresh name in the target's folder (same extension), then renames it to
// `file`; on any failure the temporary is removed and nothing half-written remains; what a killed process
// left there is removed too. Creates the parent folders. Throws ErrorKind::temporary when the disk is full,
// ErrorKind::failed for an unwritable folder or file, naming it, ErrorKind::interrupted before anything is
// written.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

// While it lives, what the functions above make below `folder` is not brought to the disk file by file:
// whoever made it brings there all of it at the end (archive::Store::commit_object), which a disk does much
// faster. One at a time.
class BroughtTogether {
 public:
  explicit BroughtTogether(const std::filesystem::path& folder);
  ~BroughtTogether();
  BroughtTogether(const BroughtTogether&) = delete;
  BroughtTogether& operator=(const BroughtTogether&) = delete;
};

void write_text(const std::filesystem::path& file, const std::string& text);

// The whole file. Throws ErrorKind::input: missing, a folder, a pipe or device, unreadable.
std::string read_text(const std::filesystem::path& file);

// Same checks, without reading: call before handing a path to a library whose own message is unclear.
void check_readable(const std::filesystem::path& file);

// Size in bytes and XXH3-128 (hex) of a file's content, for summary.json.
struct FileFingerprint {
  std::uintmax_t bytes = 0;
  std::string xxh3;
};
FileFingerprint fingerprint(const std::filesystem::path& file);

}  // namespace hybrid::io
