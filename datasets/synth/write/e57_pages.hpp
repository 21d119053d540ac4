#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "write/files.hpp"

namespace synth {

// The pages of an E57 file (ASTM E2807): 1020 bytes and their CRC-32C each. Written as they fill up; the
// first one stays in memory until the end, because what its headers say is known last.
class E57Pages {
 public:
  explicit E57Pages(const std::filesystem::path& path) : file_(path) {}

  void write(const void* bytes, std::size_t count);
  void write(const std::string& bytes) { write(bytes.data(), bytes.size()); }
  template <typename T>
  void number(T value) {  // little-endian, as the machine
    write(&value, sizeof value);
  }
  void align();  // to four bytes
  std::uint64_t logical() const { return count_; }
  // As offsets in the file's own words: checksums count.
  std::uint64_t physical() const { return count_ / kPayload * kPage + count_ % kPayload; }

  // Over bytes written already, within the first page only.
  template <typename T>
  void patch(std::uint64_t at, T value) {
    patch(at, &value, sizeof value);
  }
  // Fills up the last page; its size in bytes is then physical(). The first page can still be patched.
  void fill();
  void commit();

  static constexpr std::uint64_t kPage = 1024, kPayload = 1020;

 private:
  using Page = std::array<char, kPage>;
  void patch(std::uint64_t at, const void* bytes, std::size_t count);
  void write_page(Page& page);

  OutputFile file_;
  Page first_{}, page_{};
  std::uint64_t count_ = 0;
};

}  // namespace synth
