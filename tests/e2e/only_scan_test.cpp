// One scan of a synthetic scene by itself: the same bytes as in the whole scene, and a truth that tells of it
// alone.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

class OnlyScan : public ::testing::TestWithParam<const char*> {};

}  // namespace

TEST_P(OnlyScan, has_the_bytes_it_has_in_the_whole_scene) {
  const Scratch scratch;
  const std::string id = GetParam(), out = scratch.path().string() + "/alone";
  ASSERT_EQ(
      run("hybrid-synth room --seed 1 --preset tiny --quiet --only-scan " + id + " --out " + out).exit_code,
      0);
  EXPECT_EQ(io::read_text(scratch / "alone/scans" / (id + ".ply")),
            io::read_text(room() / "scans" / (id + ".ply")));
  EXPECT_EQ(io::read_text(scratch / "alone/truth" / (id + ".exr")),
            io::read_text(room() / "truth" / (id + ".exr")));
  const auto truth = nlohmann::json::parse(io::read_text(scratch / "alone/truth.json"));
  ASSERT_EQ(truth.at("scans").size(), 1u);
  EXPECT_EQ(truth.at("scans")[0].at("id"), id);
  EXPECT_TRUE(truth.at("cameras").empty());
  EXPECT_FALSE(fs::exists(scratch / "alone/photographs"));
}

INSTANTIATE_TEST_SUITE_P(Room, OnlyScan, ::testing::Values("west", "east"),
                         [](const auto& row) { return std::string(row.param); });

}  // namespace hybrid::e2e
