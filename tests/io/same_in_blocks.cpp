#include "io/same_in_blocks.hpp"

#include <gtest/gtest.h>

#include <random>

#include "io/read_scan.hpp"
#include "io/stream_scan.hpp"

namespace hybrid::testing {

Samples samples_of(const io::ScanStream& scan) {
  Samples samples;
  scan.for_each_block([&](const io::SampleBlock& block) {
    samples.add(block);
    return true;
  });
  return samples;
}

namespace {

void expect_same_facts(const io::SampleFacts& a, const io::SampleFacts& b) {
  EXPECT_EQ(a.returns, b.returns);
  EXPECT_EQ(a.no_returns, b.no_returns);
  EXPECT_EQ(a.beside, b.beside);
  EXPECT_EQ(a.least, b.least);
  EXPECT_EQ(a.greatest, b.greatest);
  EXPECT_EQ(a.least_finite, b.least_finite);
  EXPECT_EQ(a.greatest_finite, b.greatest_finite);
  EXPECT_EQ(a.whole, b.whole);
  EXPECT_EQ(a.least_m, b.least_m);
  EXPECT_EQ(a.greatest_m, b.greatest_m);
  EXPECT_EQ(a.hash, b.hash);
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.least_seen_m, b.least_seen_m);
  EXPECT_EQ(a.greatest_seen_m, b.greatest_seen_m);
  EXPECT_EQ(a.least_range_m, b.least_range_m);
  EXPECT_EQ(a.greatest_range_m, b.greatest_range_m);
}

}  // namespace

std::unique_ptr<io::ScanStream> expect_same(const std::filesystem::path& file, bool streams, bool salvage) {
  std::unique_ptr<io::ScanStream> stream;
  for (const bool exact : {false, true})
    for (io::ScanEntry& entry : io::list_scans(file, {.salvage = salvage, .exact = exact})) {
      entry.kept_bytes = exact ? 1 << 20 : 0;  // some of them, or all; none
      SCOPED_TRACE(::testing::Message() << file.filename() << ' ' << entry.name << (exact ? " exact" : ""));
      const io::ScanInMemory whole(io::read_scan(file, entry));
      stream = io::stream_scan(file, entry);
      EXPECT_EQ(dynamic_cast<const io::ScanInMemory*>(stream.get()) == nullptr, streams);
      const Scan &a = whole.head(), &b = stream->head();
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.origin, b.origin);
      EXPECT_EQ(a.grid_rows, b.grid_rows);
      EXPECT_EQ(a.grid_cols, b.grid_cols);
      EXPECT_EQ(a.row_by_row, b.row_by_row);
      EXPECT_EQ(a.intensity_limits, b.intensity_limits);
      EXPECT_EQ(a.crs, b.crs);
      EXPECT_EQ(a.notes, b.notes);
      EXPECT_EQ(a.steps.has_value(), b.steps.has_value());
      EXPECT_EQ(a.world_from_scan.has_value(), b.world_from_scan.has_value());
      EXPECT_EQ(a.range_grid.has_value(), b.range_grid.has_value());
      expect_same_facts(whole.facts(), stream->facts());
      const Samples expected = samples_of(whole);
      EXPECT_TRUE(expected == samples_of(*stream));
      // Anywhere.
      std::mt19937 random(3);
      for (int i = 0; i < 6 && whole.count() > 0; ++i) {
        const std::uint64_t first = random() % whole.count();
        const std::size_t count = 1 + random() % (whole.count() - first);
        Samples some, same;
        some.add(whole.read(first, count));
        same.add(stream->read(first, count));
        EXPECT_TRUE(some == same) << first << " " << count;
      }
    }
  return stream;
}

}  // namespace hybrid::testing
