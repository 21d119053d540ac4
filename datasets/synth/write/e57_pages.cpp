#include "write/e57_pages.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

namespace synth {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written in the machine's byte order");

// CRC-32C (Castagnoli), one table, a byte at a time.
std::array<std::uint32_t, 256> make_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t rest = i;
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ (rest & 1 ? 0x82F63B78u : 0u);
    table[i] = rest;
  }
  return table;
}

std::uint32_t checksum(const char* bytes, std::size_t count) {
  static const auto table = make_table();
  std::uint32_t rest = ~0u;
  for (std::size_t i = 0; i < count; ++i)
    rest = (rest >> 8) ^ table[(rest ^ static_cast<unsigned char>(bytes[i])) & 255];
  return ~rest;
}

}  // namespace

void E57Pages::write(const void* bytes, std::size_t count) {
  const char* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const std::uint64_t in_page = count_ % kPayload;
    const std::size_t part = std::min<std::size_t>(count, kPayload - in_page);
    std::memcpy((count_ < kPayload ? first_ : page_).data() + in_page, from, part);
    from += part;
    count -= part;
    count_ += part;
    if (count_ % kPayload != 0) continue;
    write_page(count_ == kPayload ? first_ : page_);  // the first one again at the end
    page_.fill(0);
  }
}

void E57Pages::write_page(Page& page) {
  const std::uint32_t sum = checksum(page.data(), kPayload);
  for (std::size_t i = 0; i < 4; ++i)  // big-endian, alone in the format
    page[kPayload + i] = static_cast<char>(sum >> (24 - 8 * i));
  file_.write(page.data(), page.size());
}

void E57Pages::align() {
  const char zeros[4] = {};
  write(zeros, (4 - count_ % 4) % 4);
}

void E57Pages::patch(std::uint64_t at, const void* bytes, std::size_t count) {
  if (at + count > kPayload) throw std::logic_error("E57: only the first page can be patched");
  std::memcpy(first_.data() + at, bytes, count);
}

void E57Pages::fill() {
  const std::string zeros((kPayload - count_ % kPayload) % kPayload, '\0');
  write(zeros);
}

void E57Pages::commit() {
  file_.seek(0);
  write_page(first_);
  file_.commit();
}

}  // namespace synth
