#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace hybrid {

// A file without a name in this folder, open for reading and writing: it goes with the process, however that
// ends. -1 where none can be made (errno).
int open_nameless_file(const std::string& folder);

// Where scratch files go: $TMPDIR, else /var/tmp, which unlike /tmp is never memory by default.
std::filesystem::path scratch_folder();

// Room on disk for what is dear to compute again. All of it is optional: where there is no disk, or not
// enough room, callers compute again.
class ScratchFile {
 public:
  // Null where the folder lies in memory or has less than four times this room free.
  static std::unique_ptr<ScratchFile> make(std::uint64_t bytes,
                                           const std::filesystem::path& folder = scratch_folder());
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  // Whether all of it was written, or read.
  bool write(std::uint64_t offset, std::span<const char> bytes) noexcept;
  bool read(std::uint64_t offset, std::span<char> bytes) const noexcept;

 private:
  explicit ScratchFile(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace hybrid
