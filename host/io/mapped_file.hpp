#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace hybrid::io {

// A file's bytes, mapped read-only: nothing is copied, and a file larger than memory can be read from front
// to back. Throws ErrorKind::input: missing, a folder, unreadable, not a regular file, empty. The file must
// not be shortened by another process meanwhile.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return bytes_; }
  const std::string& name() const { return name_; }  // the path, for messages

 private:
  std::string name_;
  std::string_view bytes_;
};

// The text without a UTF-8 byte order mark; UTF-16 is an error that says so.
std::string_view without_byte_order_mark(const std::string& file, std::string_view bytes);

// Throws when `count` records of at least `least_bytes` each cannot fit into `available` bytes: called before
// anything is allocated for them. `place` and `records` name them, "line 9" and "points".
void check_count_fits(const std::string& file, const std::string& place, const char* records,
                      std::uint64_t count, std::uint64_t least_bytes, std::uint64_t available);

}  // namespace hybrid::io
