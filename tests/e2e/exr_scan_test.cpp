// Range images as scans: what `hybrid planes` writes is fed in again and gives the same; what hybrid-synth
// writes as EXR is worth what it writes as PTX.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/output.hpp"
#include "io/read_scan.hpp"
#include "io/truth.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// One church in both formats, made once.
class ExrScene : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new Scratch;
    for (const char* format : {"ptx", "exr"}) {
      const auto outcome =
          run("hybrid-synth church --preset tiny --seed 4 --megapixels 0.06 --quiet --format " +
              std::string(format) + " --out " + scene(format).string());
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
  }
  static void TearDownTestSuite() {
    delete scratch_;
    scratch_ = nullptr;
  }
  static fs::path scene(const std::string& format) { return *scratch_ / format; }
  static fs::path scan(const std::string& format, const std::string& id) {
    return scene(format) / "scans" / (id + "." + format);
  }
  static inline Scratch* scratch_ = nullptr;
};

// `hybrid planes` on a scan, then on the range image that came of it.
void expect_same_twice(const fs::path& file) {
  const Scratch scratch;
  const std::string id = file.stem();
  const auto first = scratch / "first", second = scratch / "second";
  auto outcome = run("hybrid planes " + file.string() + " --quiet --out " + first.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto range = first / "scans" / id / "range.exr";
  outcome = run("hybrid planes " + range.string() + " --quiet --out " + second.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto again = second / "scans" / id;  // a range.exr is named after its folder
  ASSERT_TRUE(fs::exists(again / "range.exr"));
  for (const char* same : {"planes.json", "labels.exr", "detail.ply", "classes.png", "range.png"})
    EXPECT_EQ(io::read_text(again / same), io::read_text(range.parent_path() / same)) << same;
  ASSERT_EQ(fs::exists(again / "extra.ply"), fs::exists(range.parent_path() / "extra.ply"));
  if (fs::exists(again / "extra.ply")) {
    EXPECT_EQ(io::read_text(again / "extra.ply"), io::read_text(range.parent_path() / "extra.ply"));
  }
  // Of all figures, only what tells the input apart may differ.
  auto a = json_of(first / "summary.json")["scans"][0], b = json_of(second / "summary.json")["scans"][0];
  EXPECT_GT(a["superclusters"], 3);
  EXPECT_EQ(b["nodes"]["measured"].get<int>() + b["extra_samples"].get<int>(), b["input_returns"]);
  for (auto* figures : {&a, &b})
    for (const char* own : {"input_samples", "input_returns", "duplicate_samples", "notes", "file", "xxh3"})
      figures->erase(own);
  EXPECT_EQ(a, b);
}

}  // namespace

TEST_F(ExrScene, planes_of_a_grid_and_of_its_range_image_are_the_same_bytes) {
  expect_same_twice(scan("ptx", "chancel"));
}

// Resampled: nodes that were interpolated, samples beside the grid.
TEST_F(ExrScene, planes_of_columns_and_of_their_range_image_are_the_same_bytes) {
  expect_same_twice(room() / "scans" / "west.ply");
}

// The same returns with the same truth at the same nodes.
TEST_F(ExrScene, formats_hold_the_same_samples) {
  const auto of_ptx = io::read_truth(scene("ptx") / "truth.json").scans;
  const auto of_exr = io::read_truth(scene("exr") / "truth.json").scans;
  ASSERT_EQ(of_exr.size(), 3u);
  for (std::size_t s = 0; s < 3; ++s) {
    SCOPED_TRACE(of_exr[s].id);
    const Scan ptx = io::read_scan(scan("ptx", of_ptx[s].id), 0);
    const Scan exr = io::read_scan(scan("exr", of_exr[s].id), 0);
    ASSERT_EQ(of_exr[s].plane.size(), exr.points.size());
    ASSERT_EQ(exr.grid_rows, ptx.grid_rows);
    ASSERT_EQ(exr.grid_cols, ptx.grid_cols);
    ASSERT_TRUE(exr.range_grid && exr.range_grid->wraps);
    const double most_off = 0.75 * (exr.range_grid->elevation_rad[0] - exr.range_grid->elevation_rad[1]);
    std::size_t returns = 0;
    for (int col = 0; col < exr.grid_cols; ++col)
      for (int row = exr.grid_rows - 1; row >= 0; --row) {
        const std::size_t i = exr.grid_index(row, col), j = ptx.grid_index(exr.grid_rows - 1 - row, col);
        const Vec3 point = exr.point(i);
        ASSERT_EQ(point.allFinite(), ptx.point(j).allFinite()) << row << ' ' << col;
        ASSERT_EQ(of_exr[s].plane[i], of_ptx[s].plane[j]);
        ASSERT_EQ(of_exr[s].kind[i], of_ptx[s].kind[j]);
        if (!point.allFinite()) continue;
        ASSERT_LT((point - ptx.point(j)).norm(), 1e-5);  // PTX has five decimals
        const double elevation = std::atan2(point.z(), std::hypot(point.x(), point.y()));
        ASSERT_NEAR(elevation, exr.range_grid->elevation_rad[static_cast<std::size_t>(row)], most_off);
        ++returns;
      }
    EXPECT_EQ(returns, json_of(scene("exr") / "truth.json")["scans"][s]["returns"]);
    EXPECT_GT(returns, 20000u);
  }
}

TEST_F(ExrScene, scores_as_the_ptx_does) {
  std::map<std::string, nlohmann::json> scores;
  for (const char* format : {"ptx", "exr"}) {
    const auto out = *scratch_ / (std::string(format) + "-result");
    auto outcome = run("hybrid run " + (scene(format) / "scene.toml").string() +
                       " --only planes,register --quiet --out " + out.string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    outcome = run("hybrid-score " + (scene(format) / "truth.json").string() + " " + out.string() + " --json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    scores[format] = nlohmann::json::parse(outcome.out)["scans"];
  }
  ASSERT_EQ(scores["ptx"].size(), 3u);
  for (std::size_t s = 0; s < 3; ++s) {
    const auto &ptx = scores["ptx"][s], &exr = scores["exr"][s];
    SCOPED_TRACE(ptx["id"].dump());
    EXPECT_EQ(exr["id"], ptx["id"]);
    for (const char* same : {"input_samples", "measured_samples", "planar_samples", "planes",
                             "curved_samples", "mixed_samples", "ghost_samples"})
      EXPECT_EQ(exr["planes"][same], ptx["planes"][same]) << same;
    EXPECT_EQ(exr["decimation"]["input_samples"], ptx["decimation"]["input_samples"]);
    // PTX rounds to 0.01 mm, which settles small planes at their limit otherwise. Measured: the same to 0.01
    // % but for one plane of 475 samples in `nave`.
    const double right = exr["planes"]["planar_samples_right_share"];
    EXPECT_GT(right, 0.88);
    EXPECT_NEAR(right, ptx["planes"]["planar_samples_right_share"], 0.02);
    EXPECT_NEAR(exr["decimation"]["discarded_share"], ptx["decimation"]["discarded_share"], 0.02);
    EXPECT_EQ(exr["pose"]["status"], "accepted");
    EXPECT_NEAR(exr["pose"]["translation_mm"], ptx["pose"]["translation_mm"], 0.1);
    EXPECT_NEAR(exr["pose"]["rotation_deg"], ptx["pose"]["rotation_deg"], 0.001);
  }
}

// lossless = true: the sample file holds what the range image holds, and gives the same planes again.
TEST_F(ExrScene, sample_file_holds_every_sample_and_gives_the_same_again) {
  const Scratch scratch;
  const auto scan_folder = scratch / "first" / "scans" / "nave";
  auto outcome = run("hybrid planes " + scan("ptx", "nave").string() +
                     " --set planes.lossless=true --json --quiet --out " + (scratch / "first").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto figures = nlohmann::json::parse(outcome.out)["scans"][0];
  const auto lossless = figures["lossless"];
  EXPECT_EQ(lossless["bytes"], fs::file_size(scan_folder / "samples.hsf"));
  EXPECT_EQ(lossless["samples"], figures["nodes"]["measured"]);
  EXPECT_EQ(lossless["discarded"], figures["decimation"]["discarded"]);
  for (const char* from : {"range", "samples"}) {
    const std::string extension = from == std::string("range") ? ".exr" : ".hsf";
    outcome = run("hybrid convert --quiet " + (scan_folder / (from + extension)).string() + " " +
                  (scratch / (from + std::string(".ply"))).string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  EXPECT_EQ(io::read_text(scratch / "samples.ply"), io::read_text(scratch / "range.ply"));
  outcome = run("hybrid planes " + (scan_folder / "samples.hsf").string() + " --quiet --out " +
                (scratch / "second").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* same : {"labels.exr", "detail.ply", "classes.png"})
    EXPECT_EQ(io::read_text(scratch / "second" / "scans" / "samples" / same),
              io::read_text(scan_folder / same))
        << same;
}

}  // namespace hybrid::e2e
