#include "io/e57/e57.hpp"

#include <algorithm>
#include <array>

#include "core/error.hpp"
#include "io/e57/e57_xml.hpp"
#include "io/e57/little_endian.hpp"
#include "io/e57/lost_description.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kLongestXml_bytes = 64 << 20;  // a parsed tree takes ten times that

std::string pages_note(const std::string& what, const std::vector<std::uint64_t>& bad_pages) {
  return fmt::format("{}: {} damaged pages of 1024 bytes, the first at byte {}", what, bad_pages.size(),
                     bad_pages.front() * PagedFile::kPage_bytes);
}

struct Description {
  std::string text;
  bool damaged = false;
};

Description read_stretch(const PagedFile& pages, const E57Stretch& xml, std::vector<std::string>& notes) {
  std::string text(xml.length, '\0');
  std::vector<std::uint64_t> bad_pages;
  pages.read(xml.offset, text, pages.salvage() ? &bad_pages : nullptr);
  if (!bad_pages.empty()) notes.push_back(pages_note("XML section", bad_pages));
  return {std::move(text), !bad_pages.empty()};
}

Description read_xml(const PagedFile& pages, std::vector<std::string>& notes) {
  if (pages.xml_length() > kLongestXml_bytes && !pages.salvage())
    fail_input(
        "{}: byte 32: expected an XML section of at most {} bytes, found {}; export fewer scans into one "
        "file",
        pages.name(), kLongestXml_bytes, pages.xml_length());
  const E57Stretch told{pages.xml_offset(), std::min(pages.xml_length(), kLongestXml_bytes)};
  Description description = read_stretch(pages, told, notes);
  if (!pages.salvage() || description.text.find("<e57Root") != description.text.npos) return description;
  const auto found = find_description(pages);
  if (!found)
    fail_input(
        "{}: byte 24: expected an XML section, found none in all of its {} bytes, as when the end of the "
        "file is "
        "cut off; {}; copy the file again or take it from a backup",
        pages.name(), PagedFile::physical(pages.size()), tell_tables(pages));
  notes.push_back(fmt::format("the XML section is taken from byte {}, not from where the header says",
                              PagedFile::physical(found->offset)));
  return read_stretch(pages, {found->offset, std::min(found->length, kLongestXml_bytes)}, notes);
}

}  // namespace

E57File::E57File(const std::filesystem::path& file, const E57Options& options)
    : pages_(file, options.salvage), notes_(pages_.notes()) {
  contents_ = parse_e57_xml(name(), read_xml(pages_, notes_).text, options.salvage);
  notes_.insert(notes_.end(), contents_.notes.begin(), contents_.notes.end());
}

std::vector<char> E57File::read_blob(const E57Blob& blob, const std::string& what,
                                     std::vector<std::string>* notes) const {
  const std::uint64_t start = pages_.logical(blob.offset, what);
  std::vector<std::uint64_t> bad_pages;
  std::vector<std::uint64_t>* const bad = pages_.salvage() ? &bad_pages : nullptr;
  std::array<char, kBlobHeader_bytes> header{};
  pages_.read(start, header, bad);
  const auto length = load<std::uint64_t>(&header[8]);
  if (header[0] != 0 || length < kBlobHeader_bytes || blob.length > length - kBlobHeader_bytes ||
      length > pages_.size() - start)
    fail_input(
        "{}: byte {}: {}: expected a blob section (0) of {} to {} bytes, found section {} of {}; the file is "
        "cut short or damaged: copy it again",
        name(), blob.offset, what, blob.length + kBlobHeader_bytes, pages_.size() - start,
        static_cast<int>(static_cast<unsigned char>(header[0])), length);
  std::vector<char> bytes(blob.length);
  pages_.read(start + kBlobHeader_bytes, bytes, bad);
  if (!bad_pages.empty() && notes) notes->push_back(pages_note(what, bad_pages));
  return bytes;
}

void E57File::for_each_block(const E57Table& table, std::span<const std::size_t> fields, std::size_t most,
                             const std::function<void(const E57Records&)>& body) const {
  io::for_each_block(open(table), table, fields, most, body);
}

std::string E57File::xml(bool* whole) const {
  std::vector<std::string> noted;
  Description description = read_xml(pages_, noted);
  if (whole) *whole = !description.damaged;
  return std::move(description.text);
}

}  // namespace hybrid::io
