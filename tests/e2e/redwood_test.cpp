// Depth images and photographs of one camera in one room (skipped where the data are absent).
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "io/output.hpp"
#include "places.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

const fs::path kScene = fs::path(HYBRID_PROJECT_DIR) / "datasets/redwood/scene.toml";

bool redwood_present() {
  const char* folder = std::getenv("HYBRID_DATA");
  const fs::path data = folder ? fs::path(folder) : fs::path(HYBRID_PROJECT_DIR) / ".." / "shared" / "data";
  return fs::exists(data / "photos/redwood-livingroom/depth/00015.png");
}

}  // namespace

TEST(Redwood, depth_frames_lie_on_the_proxy_and_fill_what_it_lacks) {
  if (!redwood_present()) GTEST_SKIP() << "photos/redwood-livingroom is not in the data folder";
  const Scratch scratch;
  const auto made =
      run("hybrid render " + kScene.string() +
          " --view held-090-both --set render.next_cameras=2 --quiet --out " + scratch.path().string());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto summary = nlohmann::json::parse(io::read_text(scratch / "summary.json"));
  ASSERT_EQ(summary["scans"].size(), 5u);
  for (const auto& scan : summary["scans"]) {
    EXPECT_EQ(scan["registration"]["how"], "given");
    // Frames 45 and 105 had no part in the proxy. What is not within 5 cm is the curtain, the chair, a
    // picture.
    EXPECT_GT(scan["registration"]["wall_after_icp"]["within_5cm"].get<double>(), 0.6) << scan["id"];
  }
  const auto& view = summary["views"][0];
  EXPECT_GT(view["left_out"]["share_seen"].get<double>(), 0.9);
  EXPECT_GT(view["left_out"]["psnr_db"].get<double>(), 20);
}

}  // namespace hybrid::e2e
