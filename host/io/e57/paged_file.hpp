#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/input_file.hpp"

namespace hybrid::io {

// Of an E57 file.
inline constexpr std::uint64_t kFileHeader_bytes = 48, kSectionHeader_bytes = 32, kBlobHeader_bytes = 16;

// An E57 file below its structure (ASTM E2807): a header of 48 bytes and pages of 1024 bytes, of which the
// last four are the page's CRC-32C. The file's own offsets are physical (they count the checksums); all
// offsets here are logical (they do not), unless said otherwise.
class PagedFile {
 public:
  static constexpr std::uint64_t kPage_bytes = 1024, kPayload_bytes = 1020;

  // Throws ErrorKind::input: no E57, another version, another length than the header says, a damaged first
  // page. With `salvage` these become notes where the rest can still be read.
  PagedFile(const std::filesystem::path& file, bool salvage);

  const std::string& name() const { return file_.name(); }
  bool salvage() const { return salvage_; }
  std::uint64_t size() const { return size_; }              // logical
  std::uint64_t xml_offset() const { return xml_offset_; }  // within size()
  std::uint64_t xml_length() const { return xml_length_; }  // not beyond size(); in salvage 0: unknown
  const std::vector<std::string>& notes() const { return notes_; }  // what salvage met so far

  static std::uint64_t physical(std::uint64_t logical) { return logical + 4 * (logical / kPayload_bytes); }
  // Throws when `physical` lies outside the file or on a checksum. `what` says whose offset it is.
  std::uint64_t logical(std::uint64_t physical, const std::string& what) const;

  // Bytes [at, at + to.size()), every page of them checked; safe to call from several threads. Throws
  // ErrorKind::input for bytes outside the file, and for a bad page unless `bad_pages` takes its number: then
  // its bytes are delivered as they are (zero where the file ends).
  void read(std::uint64_t at, std::span<char> to, std::vector<std::uint64_t>* bad_pages = nullptr) const;

 private:
  void read_header();

  InputFile file_;
  bool salvage_;
  std::uint64_t size_ = 0, xml_offset_ = 0, xml_length_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace hybrid::io
