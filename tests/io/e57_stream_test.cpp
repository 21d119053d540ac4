// E57 files in blocks: damaged ones, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "io/e57_grids.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/files.hpp"
#include "io/node_blocks.hpp"
#include "io/read_scan.hpp"
#include "io/same_in_blocks.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

TEST(E57Stream, ItAndItsRangeImageAreTheSameInBlocks) {
  const TemporaryFolder folder;
  constexpr int kRows = 421, kCols = 330;
  auto shuffled = all_nodes(kRows, kCols, true);
  std::ranges::shuffle(shuffled, std::mt19937(4));
  shuffled.resize(shuffled.size() - 999);
  auto twice = all_nodes(9, 8, false);
  twice.insert(twice.end(), {5, 5, 70});
  auto some = all_nodes(kRows, kCols, true);
  std::erase_if(some, [](std::uint32_t node) { return node % 11 == 0; });
  const fs::path file = folder.path() / "a.e57", exr = folder.path() / "a.exr";
  const auto check = [&] {
    expect_same(file);
    io::write_exr_scan(io::E57FileSource(file), 0, exr, {});
    expect_same(exr);
  };
  for (const auto& order : {all_nodes(kRows, kCols, true), all_nodes(kRows, kCols, false), some, shuffled})
    e57_of(file, kRows, kCols, order), check();
  e57_of(file, 9, 8, twice), check();
  e57_of(file, 9, 8, all_nodes(9, 8, true), io::E57Limits{0, 3}), check();     // indices beyond
  e57_of(file, 9, 8, all_nodes(9, 8, true), io::E57Limits{0, 4000}), check();  // far fewer than declared
  e57_of(file, 1, 8, all_nodes(1, 8, true)), check();
  e57_of(file, 4000, 4000, {1, 4000 * 4000 - 1}), check();  // no grid worth its memory
  e57_of(file, 9, 8, twice, {}, true), check();             // several returns of a node
  auto thrice = all_nodes(kRows, kCols, true);
  for (std::size_t i = 0; i < thrice.size(); ++i) thrice[i] = thrice[i / 3];
  e57_of(file, kRows, kCols, thrice, {}, true), check();
  e57_of(file, 9, 8, all_nodes(9, 8, false), {}, true), check();  // by the index alone
  e57_of(file, 9, 8, {}), check();
}

// Lines of a grid that do not all fit, in both directions, against all at once.
TEST(E57Stream, NodesInBandsAreTheNodesAtOnce) {
  const TemporaryFolder folder;
  auto order = all_nodes(37, 29, false);
  std::erase_if(order, [](std::uint32_t node) { return node % 5 == 0; });
  order.push_back(17);  // again: the last one counts
  for (const bool shuffle : {false, true}) {
    if (shuffle) std::ranges::shuffle(order, std::mt19937(6));
    const auto stream = expect_same(e57_of(folder.path() / "a.e57", 37, 29, order));
    for (const bool by_columns : {false, true}) {
      const auto in_bands = [&](std::uint64_t nodes) {
        Samples samples;
        io::for_each_node_block(
            *stream, by_columns, [&](const io::SampleBlock& block) { samples.add(block); }, nodes);
        return samples;
      };
      const Samples all = in_bands(io::kBandNodes);
      ASSERT_EQ(all.node.size(), 37u * 29u);
      for (std::uint32_t i = 0; i < all.node.size(); ++i) {
        const std::uint32_t node = by_columns ? i % 37 * 29 + i / 37 : i;
        const bool there = std::ranges::find(order, node) != order.end();
        ASSERT_EQ(all.node[i], there ? node : Scan::kNoNode);
        if (!there) continue;
        const auto last = std::find(order.rbegin(), order.rend(), node);
        const auto record = static_cast<std::uint64_t>(order.rend() - last - 1);
        ASSERT_EQ(all.intensity[i], stream->read(record, 1).intensity[0]);
      }
      for (const std::uint64_t nodes : {1u, 37u, 100u, 500u}) EXPECT_TRUE(all == in_bands(nodes)) << nodes;
    }
  }
}

// Pages that are zero: where every record is in its place, where none is, and with several returns of a node.
TEST(E57Stream, DamageIsTheSameInBlocks) {
  const TemporaryFolder folder;
  constexpr int kRows = 421, kCols = 330;
  const fs::path file = folder.path() / "a.e57";
  auto shuffled = all_nodes(kRows, kCols, true);
  std::ranges::shuffle(shuffled, std::mt19937(4));
  auto thrice = all_nodes(kRows, kCols, true);
  for (std::size_t i = 0; i < thrice.size(); ++i) thrice[i] = thrice[i / 3];
  const auto check = [&](std::size_t first, std::size_t count) {
    std::string bytes = bytes_of(file);
    ASSERT_GT(bytes.size(), 1024 * (first + count + 10));
    bytes.replace(1024 * first, 1024 * count, std::string(1024 * count, '\0'));
    const auto damaged = folder.write("damaged.e57", bytes);
    error_of(ErrorKind::input, [&] { io::read_scan(damaged, 0); });
    const auto stream = expect_same(damaged, true, true);
    EXPECT_GT(stream->facts().returns, 0u);
    EXPECT_TRUE(std::ranges::any_of(stream->head().notes, [](const std::string& note) {
      return holds(note, "lost to damage: taken as no-returns");
    }));
  };
  for (const auto& order : {all_nodes(kRows, kCols, true), all_nodes(kRows, kCols, false), shuffled})
    e57_of(file, kRows, kCols, order), check(60, 1), check(500, 300);
  e57_of(file, kRows, kCols, thrice, {}, true), check(60, 1), check(500, 300);
}

}  // namespace
}  // namespace hybrid::testing
