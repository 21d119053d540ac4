#include "io/e57/paged_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/error.hpp"
#include "io/e57/crc32c.hpp"
#include "io/e57/little_endian.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kPagesAtOnce = 64;  // 64 KiB stay in a core's cache between check and copy

// The checksum is the one big-endian number of the format.
std::uint32_t stored_checksum(const char* page) {
  return __builtin_bswap32(load<std::uint32_t>(page + PagedFile::kPayload_bytes));
}

std::uint32_t computed_checksum(const char* page) {
  return crc32c({page, PagedFile::kPayload_bytes});
}

}  // namespace

PagedFile::PagedFile(const std::filesystem::path& file, bool salvage) : file_(file), salvage_(salvage) {
  const std::uint64_t rest = file_.size() % kPage_bytes;
  size_ = file_.size() / kPage_bytes * kPayload_bytes + std::min(rest, kPayload_bytes);
  read_header();
}

void PagedFile::read_header() {
  std::array<char, kFileHeader_bytes> header{};
  if (file_.size() >= 8) file_.read(0, std::span(header).first(8));
  if (std::memcmp(header.data(), "ASTM-E57", 8) != 0)
    fail_input("{}: byte 0: expected the signature ASTM-E57, found another; is this an E57 file?", name());
  if (file_.size() < kPage_bytes)
    fail_input("{}: expected at least one page of {} bytes, found {}; the file is cut short: copy it again",
               name(), kPage_bytes, file_.size());
  file_.read(0, header);
  const auto major = load<std::uint32_t>(&header[8]), minor = load<std::uint32_t>(&header[12]);
  const auto length = load<std::uint64_t>(&header[16]), xml = load<std::uint64_t>(&header[24]);
  xml_length_ = load<std::uint64_t>(&header[32]);
  const auto page = load<std::uint64_t>(&header[40]);

  // What salvage forgives is a note there.
  const auto complain = [&](std::string message, const char* remedy) {
    if (!salvage_) fail_input("{}: {}; {}", name(), message, remedy);
    notes_.push_back(std::move(message));
  };
  std::array<char, kPage_bytes> first{};
  file_.read(0, first);
  if (stored_checksum(first.data()) != computed_checksum(first.data()))
    complain(fmt::format("byte 0 (page 0): expected checksum {:08x}, found {:08x}",
                         computed_checksum(first.data()), stored_checksum(first.data())),
             "the page is damaged: copy the file again or use --salvage");
  if (major != 1)
    complain(fmt::format("byte 8: expected E57 version 1, found {}.{}", major, minor),
             "export it as version 1.0");
  if (page != kPage_bytes)
    complain(fmt::format("byte 40: expected pages of {} bytes, found {}", kPage_bytes, page),
             "export the file again");
  if (length != file_.size())
    complain(fmt::format("byte 16: expected a file of {} bytes as its header says, found {}", length,
                         file_.size()),
             "the file is cut short or another follows in it: copy it again or use --salvage");
  try {
    xml_offset_ = logical(xml, "byte 24: the XML section");
  } catch (const Error& error) {
    if (!salvage_) throw;
    const std::string message = error.what();
    notes_.push_back(message.substr(name().size() + 2));
    xml_length_ = 0;
    return;
  }
  if (xml_length_ == 0 || xml_length_ > size_ - xml_offset_) {
    complain(fmt::format("byte 32: expected an XML section of 1 to {} bytes, found {}", size_ - xml_offset_,
                         xml_length_),
             "the file is cut short: copy it again or use --salvage");
    xml_length_ = size_ - xml_offset_;
  }
}

std::uint64_t PagedFile::logical(std::uint64_t physical, const std::string& what) const {
  if (physical >= file_.size() || physical < kFileHeader_bytes)
    fail_input(
        "{}: {}: expected an offset of {} to {}, found {}; the file is cut short or its header is wrong: "
        "copy "
        "it again",
        name(), what, kFileHeader_bytes, file_.size() - 1, physical);
  if (physical % kPage_bytes >= kPayload_bytes)
    fail_input("{}: {}: expected an offset of data, found {}, where a page's checksum lies; export it again",
               name(), what, physical);
  return physical - 4 * (physical / kPage_bytes);
}

void PagedFile::read(std::uint64_t at, std::span<char> to, std::vector<std::uint64_t>* bad_pages) const {
  if (at > size_ || to.size() > size_ - at)
    fail_input(
        "{}: byte {}: expected {} bytes, found {}; the file is cut short or a length in it is wrong: copy it "
        "again",
        name(), physical(at), to.size(), size_ - std::min(at, size_));
  if (to.empty()) return;
  thread_local std::vector<char> pages;
  pages.resize(kPagesAtOnce * kPage_bytes);
  const std::uint64_t last = (at + to.size() - 1) / kPayload_bytes;
  for (std::uint64_t page = at / kPayload_bytes; page <= last; page += kPagesAtOnce) {
    const std::uint64_t count = std::min(kPagesAtOnce, last - page + 1);
    const std::uint64_t present = std::min(count * kPage_bytes, file_.size() - page * kPage_bytes);
    file_.read(page * kPage_bytes, std::span(pages).first(present));
    std::fill(pages.begin() + static_cast<std::ptrdiff_t>(present),
              pages.begin() + static_cast<std::ptrdiff_t>(count * kPage_bytes), '\0');
    for (std::uint64_t i = 0; i < count; ++i) {
      const char* bytes = pages.data() + i * kPage_bytes;
      const bool whole = (i + 1) * kPage_bytes <= present;
      const std::uint32_t computed = computed_checksum(bytes);
      if (!whole || computed != stored_checksum(bytes)) {
        if (!bad_pages)
          fail_input(
              "{}: byte {} (page {}): expected checksum {:08x}, found {:08x}; the page is damaged: copy the "
              "file again or use --salvage",
              name(), (page + i) * kPage_bytes, page + i, computed, stored_checksum(bytes));
        bad_pages->push_back(page + i);
      }
      const std::uint64_t start = (page + i) * kPayload_bytes;
      const std::uint64_t from = std::max(start, at), end = std::min(start + kPayload_bytes, at + to.size());
      std::memcpy(to.data() + (from - at), bytes + (from - start), end - from);
    }
  }
}

}  // namespace hybrid::io
