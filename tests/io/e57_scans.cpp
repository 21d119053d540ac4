#include "io/e57_scans.hpp"

#include <stdexcept>

#include "io/e57/crc32c.hpp"

namespace hybrid::testing {

std::string without_checksums(const std::string& file) {
  std::string content;
  for (std::size_t at = 0; at < file.size(); at += 1024) content += file.substr(at, 1020);
  return content;
}

std::string with_checksums(const std::string& content) {
  std::string file;
  for (std::size_t at = 0; at < content.size(); at += 1020) {
    std::string page = content.substr(at, 1020);
    page.resize(1020);
    const std::uint32_t crc = io::crc32c_by_tables(page);
    for (int byte = 3; byte >= 0; --byte) page += static_cast<char>(crc >> (8 * byte));  // the highest first
    file += page;
  }
  return file;
}

std::string overwritten(const std::string& file, std::size_t at, const std::string& by) {
  return with_checksums(without_checksums(file).replace(at, by.size(), by));
}

std::string with_xml(const std::string& file, const std::string& from, const std::string& to) {
  std::string content = without_checksums(file);
  const std::size_t start = content.find("<?xml"), at = content.find(from, start);
  if (at == content.npos) throw std::logic_error("no such XML: " + from);
  content.replace(at, from.size(), to);
  const std::size_t length = content.find("</e57Root>") == content.npos ? content.find_last_not_of('\0') + 1
                                                                        : content.rfind("</e57Root>") + 11;
  content.resize(length);
  const std::uint64_t pages = (length + 1019) / 1020;
  content.replace(16, 8, little_endian(1024 * pages));
  content.replace(32, 8, little_endian(std::uint64_t{length - start}));
  return with_checksums(content);
}

}  // namespace hybrid::testing
