#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>

#include "io/output_file.hpp"

namespace hybrid::io {

// Writes the pages of an E57 file (see PagedFile), each with its checksum, one after the other. Positions are
// logical. What is only known later is patched into pages that keep() names before they are full.
class PagedOutput {
 public:
  explicit PagedOutput(const std::filesystem::path& file) : file_(file) {}

  std::uint64_t position() const { return page_ * kPayload + used_; }
  void write(std::span<const char> bytes);
  void align();  // zeros up to a multiple of four

  // The next `bytes` bytes may be patched at any time before close().
  void keep(std::uint64_t bytes);
  void patch(std::uint64_t at, std::span<const char> bytes);

  // Fills and writes the last page, rewrites the patched ones. Returns the file's size in bytes.
  void close();
  // Of the file once closed, with the current page whole: what the header must say.
  std::uint64_t file_bytes() const;

 private:
  static constexpr std::size_t kPayload = 1020;
  using Page = std::array<char, kPayload + 4>;
  void flush();
  static void add_checksum(Page& page);

  OutputFile file_;
  Page current_{};
  std::uint64_t page_ = 0;
  std::size_t used_ = 0;
  std::map<std::uint64_t, Page> kept_;
};

}  // namespace hybrid::io
