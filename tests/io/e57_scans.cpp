#include "io/e57_scans.hpp"

#include "io/e57/crc32c.hpp"

namespace hybrid::testing {

void renew_checksum(std::string& bytes, std::size_t page) {
  const std::uint32_t crc = io::crc32c_by_tables({&bytes[1024 * page], 1020});
  for (std::size_t i = 0; i < 4; ++i)  // the highest byte first
    bytes[1024 * page + 1020 + i] = static_cast<char>(crc >> (24 - 8 * i));
}

void overwrite(std::string& bytes, std::size_t at, const std::string& by) {
  bytes.replace(at, by.size(), by);
  for (std::size_t page = at / 1024; page <= (at + by.size() - 1) / 1024; ++page) renew_checksum(bytes, page);
}

}  // namespace hybrid::testing
