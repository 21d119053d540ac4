#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace hybrid::io {

// Calls write(temporary) with a fresh name in the target's folder (same extension), then renames it to
// `file`; on any failure the temporary is removed and nothing half-written remains. Creates the parent
// folders. Throws ErrorKind::temporary when the disk is full, ErrorKind::failed for an unwritable folder,
// naming both.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

void write_text(const std::filesystem::path& file, const std::string& text);

// The whole file. Throws ErrorKind::input: missing, a folder, unreadable.
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
