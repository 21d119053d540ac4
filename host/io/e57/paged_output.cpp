#include "io/e57/paged_output.hpp"

#include <algorithm>
#include <cstring>

#include "io/e57/crc32c.hpp"
#include "io/e57/little_endian.hpp"

namespace hybrid::io {

void PagedOutput::write(std::span<const char> bytes) {
  while (!bytes.empty()) {
    const std::size_t count = std::min(bytes.size(), kPayload - used_);
    std::memcpy(&current_[used_], bytes.data(), count);
    used_ += count;
    bytes = bytes.subspan(count);
    if (used_ == kPayload) flush();
  }
}

void PagedOutput::align() {
  constexpr std::array<char, 3> kZeros{};
  write(std::span(kZeros).first((4 - position() % 4) % 4));
}

void PagedOutput::keep(std::uint64_t bytes) {
  const std::uint64_t last = (position() + bytes - 1) / kPayload;
  for (std::uint64_t page = page_; page <= last; ++page) kept_.try_emplace(page);
}

void PagedOutput::patch(std::uint64_t at, std::span<const char> bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::uint64_t page = (at + i) / kPayload;
    (page == page_ ? current_ : kept_.at(page))[(at + i) % kPayload] = bytes[i];
  }
}

void PagedOutput::add_checksum(Page& page) {
  store(&page[kPayload], __builtin_bswap32(crc32c(std::span(page).first(kPayload))));
}

void PagedOutput::flush() {
  add_checksum(current_);
  file_.write(current_.data(), current_.size());
  if (const auto kept = kept_.find(page_); kept != kept_.end()) kept->second = current_;
  current_ = {};
  used_ = 0;
  ++page_;
}

std::uint64_t PagedOutput::file_bytes() const {
  return (page_ + (used_ > 0)) * (kPayload + 4);
}

void PagedOutput::close() {
  if (used_ > 0) flush();
  for (auto& [number, page] : kept_) {
    add_checksum(page);
    file_.seek(number * page.size());
    file_.write(page.data(), page.size());
  }
  file_.close();
}

}  // namespace hybrid::io
