// A unit whose arrays leave memory again and again while it runs, under a budget far too small for it, makes
// the same bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>
#include <thread>

#include "archive/manifest.hpp"
#include "archive/unit_run.hpp"
#include "core/memory_budget.hpp"
#include "core/paged_arrays.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// So many that an array of one number a sample is large enough for a file of its own.
constexpr int kRows = 800, kColumns = 1400;
static_assert(std::size_t{4} * kRows * kColumns > paged_arrays::kLeast_bytes);

// A room of 8 x 6 x 4 m seen from its middle, with walls that are not quite flat: an organised PCD.
void write_room(const fs::path& file) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out << "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << kColumns
      << "\nHEIGHT " << kRows << "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << kRows * kColumns
      << "\nDATA binary\n";
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double elevation = (0.5 - (row + 0.5) / kRows) * 0.9 * std::numbers::pi,
                   azimuth = 2 * std::numbers::pi * (column + 0.5) / kColumns;
      const double x = std::cos(elevation) * std::cos(azimuth), y = std::cos(elevation) * std::sin(azimuth),
                   z = std::sin(elevation);
      const double range = 1 / std::max({std::abs(x) / 4, std::abs(y) / 3, std::abs(z) / 2}) +
                           0.001 * std::sin(0.7 * row * column);
      for (const double value : {x, y, z}) {
        const auto number = static_cast<float>(range * value);
        out.write(reinterpret_cast<const char*>(&number), sizeof number);
      }
    }
}

}  // namespace

TEST(UnitMemory, paging_changes_no_byte) {
  const Scratch scratch;
  write_room(scratch / "archive" / "room.pcd");
  const auto planned = plan(scratch / "archive", scratch / "store");
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  const auto manifest = archive::read_manifest(scratch / "store" / "manifest.json");
  const archive::Unit& unit = manifest.units.at(0);
  ASSERT_EQ(unit.kind, archive::UnitKind::planes);
  device::Queue queue;
  archive::run_planes_unit(queue, unit, scratch / "in memory");

  std::atomic<std::uint64_t> gone_bytes = 0;
  {
    // Below what an empty process holds, so that its own thread works all the time, too.
    const MemoryBudget budget(64 << 20, scratch / "pages");
    const std::jthread pager([&](const std::stop_token& ended) {
      while (!ended.stop_requested()) {
        gone_bytes += paged_arrays::trim(64 << 20);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
    archive::run_planes_unit(queue, unit, scratch / "paged");
  }
  EXPECT_GT(gone_bytes.load(), std::uint64_t{12} * kRows * kColumns);  // at least the scan's coordinates once
  EXPECT_EQ(content_list(scratch / "paged"), content_list(scratch / "in memory"));
  EXPECT_NE(content_list(scratch / "paged").find("labels.exr"), std::string::npos);
}

}  // namespace hybrid::e2e
