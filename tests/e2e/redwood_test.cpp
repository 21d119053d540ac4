// Depth images and photographs of one camera in one room (skipped where the data are absent).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "geometry/pose.hpp"
#include "io/output.hpp"
#include "io/scene/scene_file.hpp"
#include "places.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

const fs::path kRedwood = fs::path(HYBRID_PROJECT_DIR) / "datasets/redwood/scene.toml";

bool redwood_present() {
  const char* folder = std::getenv("HYBRID_DATA");
  const fs::path data = folder ? fs::path(folder) : fs::path(HYBRID_PROJECT_DIR) / ".." / "shared" / "data";
  return fs::exists(data / "photos/redwood-livingroom/depth/00015.png");
}

// The scene's frames without a model, all but the first moved by so much along x.
std::string frames_moved_by(double moved_m) {
  const auto scene = io::read_scene_file(kRedwood);
  std::string text = "[scene]\nname = \"frames\"\n";
  for (std::size_t k = 0; k < scene.scans.size(); ++k) {
    const auto& scan = scene.scans[k];
    auto pose = *scan.pose;
    if (k > 0) pose[3] += moved_m;
    text += fmt::format(
        "[[scan]]\nid = \"{}\"\nfile = \"{}\"\nintrinsics = [525, 525, 319.5, 239.5]\npose = {}\n", scan.id,
        scan.file.string(), nlohmann::json(pose).dump());
  }
  return text;
}

}  // namespace

// Their trajectory's own poses lie up to 2 cm and 0.7 degrees from where the frames fall together.
TEST(Redwood, depth_frames_without_a_model_are_laid_on_each_other) {
  if (!redwood_present()) GTEST_SKIP() << "photos/redwood-livingroom is not in the data folder";
  const Scratch scratch;
  const auto pose_json = [&](const std::string& out, const std::string& scan) {
    return nlohmann::json::parse(io::read_text(scratch / out / "scans" / scan / "pose.json"));
  };
  for (const auto& [out, moved_m] : {std::pair("near", 0.0), std::pair("far", 0.2)}) {
    io::write_text(scratch / "scene.toml", frames_moved_by(moved_m));
    const auto made = run("hybrid register " + (scratch / "scene.toml").string() + " --quiet --out " +
                          (scratch / out).string());
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  for (const char* scan : {"frame-045", "frame-075", "frame-105", "frame-135"}) {
    const auto pose = pose_json("far", scan);
    EXPECT_EQ(pose["how"], "scan-icp") << scan;
    EXPECT_GT(pose["on_scans"]["overlap"], 0.8) << scan;  // measured 0.87 to 1.00
    EXPECT_LT(pose["on_scans"]["rms_m"], 0.001) << scan;  // 0.18 to 0.24 mm
    EXPECT_LT(pose["on_scans"]["seen_through"], 0.01) << scan;
    const auto apart = difference(
        pose_from_row_major(pose["world_from_scan"].get<std::array<double, 16>>()),
        pose_from_row_major(pose_json("near", scan)["world_from_scan"].get<std::array<double, 16>>()));
    EXPECT_LT(apart.distance_m, 0.0002) << scan;
  }
}

TEST(Redwood, depth_frames_lie_on_the_proxy_and_fill_what_it_lacks) {
  if (!redwood_present()) GTEST_SKIP() << "photos/redwood-livingroom is not in the data folder";
  const Scratch scratch;
  const auto made =
      run("hybrid render " + kRedwood.string() +
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
