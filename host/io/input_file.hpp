#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hybrid::io {

// A file read through a window of about 1 MiB, so that files larger than memory can be read. Not mapped: a
// mapped file that another process shortens, or that a network file system loses, ends the program by SIGBUS;
// here both are ErrorKind::input that names the byte.
class InputFile {
 public:
  // Throws ErrorKind::input: missing, a folder, unreadable, not a regular file, empty.
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& name() const { return name_; }  // the path, for messages
  std::uint64_t size() const { return size_; }       // when it was opened, in bytes; at least 1

  // Bytes [offset, offset + bytes), which must lie within size(); valid until the next call of any of these.
  const char* at(std::uint64_t offset, std::uint64_t bytes) {
    const std::uint64_t skipped = offset - window_start_;  // wraps to a large number for an earlier offset
    if (skipped <= window_.size() && bytes <= window_.size() - skipped) return window_.data() + skipped;
    load(offset, bytes);
    return window_.data();
  }
  // From `offset` on: at least min(least, rest of the file) bytes, and what else the window holds.
  std::string_view ahead(std::uint64_t offset, std::uint64_t least);
  // Into memory of the caller, past the window.
  void read(std::uint64_t offset, std::span<char> to) const;
  // Whether bytes [offset, size()) are all zero.
  bool only_zeros_from(std::uint64_t offset);

 private:
  void load(std::uint64_t offset, std::uint64_t bytes);

  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::uint64_t window_start_ = 0;
  std::vector<char> window_;
};

// Where the text of a file starts: after a UTF-8 byte order mark. UTF-16, with its mark or without, is an
// error that says so.
std::uint64_t start_of_text(InputFile& file);

// Throws when the bytes from `data` on are binary data that a transfer "as text" has spoilt: the header's
// lines end in CR LF, and so does every LF in the data. Called where data are left over.
void check_not_sent_as_text(InputFile& file, std::uint64_t data);

// Throws when `count` records of at least `least_bytes` each cannot fit into `available` bytes: called before
// anything is allocated for them. `place` and `records` name them, "line 9" and "points".
void check_count_fits(const std::string& file, const std::string& place, const char* records,
                      std::uint64_t count, std::uint64_t least_bytes, std::uint64_t available,
                      bool salvage_helps = false);

}  // namespace hybrid::io
