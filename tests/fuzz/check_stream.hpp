#pragma once
#include <filesystem>

#include "fuzz/check_scan.hpp"
#include "io/read_scan.hpp"
#include "io/stream_scan.hpp"

namespace hybrid::testing {

template <typename T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

// A file's scan in blocks, of which nothing stays in memory, is the one that read_scan() reads of the same
// entry; what one refuses the other does.
inline void check_stream(const std::filesystem::path& file, io::ScanEntry entry, std::optional<Scan> scan) {
  entry.kept_bytes = 0;
  const auto stream = unless_refused([&] { return io::stream_scan(file, entry); });
  expect(scan.has_value() == stream.has_value(), "a stream where there is a scan");
  if (!scan) return;
  const io::ScanInMemory whole(std::move(*scan));
  const io::ScanStream& parts = **stream;
  const Scan &a = whole.head(), &b = parts.head();
  expect(a.name == b.name && a.notes == b.notes && a.origin == b.origin && a.grid_rows == b.grid_rows &&
             a.grid_cols == b.grid_cols && a.row_by_row == b.row_by_row,
         "the same head");
  expect(whole.count() == parts.count() && whole.has_exact() == parts.has_exact() &&
             whole.has_intensity() == parts.has_intensity() && whole.has_colour() == parts.has_colour() &&
             whole.has_node() == parts.has_node(),
         "the same columns");
  expect(whole.facts().hash == parts.facts().hash && whole.laid_out() == parts.laid_out(), "the same facts");
  for (std::uint64_t left = whole.count(); left > 0;) {  // from the end on, so that each block is sought
    const std::uint64_t count = std::min(left, whole.count() / 3 + 1);
    left -= count;
    const io::SampleBlock expected = whole.read(left, count), got = parts.read(left, count);
    expect(same_bytes(expected.points, got.points) && same_bytes(expected.exact, got.exact) &&
               same_bytes(expected.intensity, got.intensity) && same_bytes(expected.rgb, got.rgb) &&
               same_bytes(expected.node, got.node),
           "the same samples");
  }
}

}  // namespace hybrid::testing
