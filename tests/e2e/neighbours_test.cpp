// Scans that the model does not place, through the program: their neighbours do, or there is no model at all.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "geometry/pose.hpp"
#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

namespace fs = std::filesystem;

nlohmann::json json_of(const fs::path& file) {
  return nlohmann::json::parse(io::read_text(file));
}

// The tiny room's scene without photographs and views; from `from` on, of the n-th occurrence, to the end of
// the list of landmarks.
std::string scene_without_landmarks(bool of_the_first_too, bool model) {
  std::string text = io::read_text(room() / "scene.toml");
  text.resize(text.find("[photographs]"));
  for (auto at = text.rfind("landmarks = ["); at != std::string::npos; at = text.rfind("landmarks = [")) {
    text.erase(at, text.find("\n]\n", at) + 3 - at);
    if (!of_the_first_too) break;
  }
  if (const auto at = text.find("[model]"); !model) text.erase(at, text.find("\n\n", at) - at);
  const auto absolute = [&](const std::string& from, const fs::path& to) {
    for (auto at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.string().size() + 1))
      text.replace(at, from.size(), '"' + to.string());
  };
  absolute("\"scans", room() / "scans");
  absolute("\"proxy.obj", room() / "proxy.obj");
  absolute("\"truth.json", room() / "truth.json");
  return text;
}

}  // namespace

// The room is symmetric, so that neither scan is aligned to the proxy without clicks; its furniture is not.
TEST(Neighbours, landmarks_of_one_scan_place_the_other) {
  const Scratch scratch;
  io::write_text(scratch / "scene.toml", scene_without_landmarks(false, true));
  const auto out = scratch / "out";
  const auto outcome = run("hybrid run " + (scratch / "scene.toml").string() +
                           " --only register,planes,report --quiet --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto pose = json_of(out / "scans/east/pose.json");
  EXPECT_EQ(pose["how"], "neighbour");
  EXPECT_EQ(pose["aligned_to"], "west");
  EXPECT_TRUE(pose["neighbour"]["accepted"]);
  EXPECT_FALSE(fs::exists(out / "scans/east/sheet"));
  EXPECT_TRUE(fs::exists(out / "scans/east/residuals.png"));
  const auto summary = json_of(out / "summary.json");
  for (const auto& scan : summary["scans"]) {
    EXPECT_LT(scan["truth"]["pose_error_mm"], 0.2) << scan["id"];  // measured 0.013 and 0.028
    EXPECT_LT(scan["truth"]["pose_error_deg"], 0.002) << scan["id"];
    EXPECT_FALSE(scan["registration"]["faces"]["solved_with_the_pose"]);
  }
  ASSERT_EQ(summary["joint"]["pairs"].size(), 1u);
  const auto& pair = summary["joint"]["pairs"][0];
  EXPECT_GT(pair["overlap"], 0.8);
  EXPECT_LT(pair["distance_m"], 0.001);
  EXPECT_NE(io::read_text(out / "report/index.html").find("Scan to scan"), std::string::npos);
}

TEST(Neighbours, scans_without_a_model_are_registered_to_the_first) {
  const Scratch scratch;
  io::write_text(scratch / "scene.toml", scene_without_landmarks(true, false));
  const auto out = scratch / "out";
  const auto outcome =
      run("hybrid register " + (scratch / "scene.toml").string() + " --quiet --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(json_of(out / "scans/west/pose.json")["how"], "frame");
  EXPECT_EQ(json_of(out / "scans/east/pose.json")["how"], "neighbour");
  const auto summary = json_of(out / "summary.json");
  EXPECT_EQ(summary["joint"]["frame"], "west");
  EXPECT_LT(summary["scans"][1]["truth"]["pose_error_mm"], 0.2);  // measured 0.032
  EXPECT_LT(summary["scans"][1]["truth"]["pose_error_deg"], 0.002);

  // They are reported and exported as well.
  const auto whole =
      run("hybrid run " + (scratch / "scene.toml").string() +
          " --only planes,register,export,report --set export.formats=ply,glb --quiet --out " + out.string());
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_NE(io::read_text(out / "report/index.html").find("Scan to scan"), std::string::npos);
  EXPECT_GT(std::filesystem::file_size(out / "export/points.ply"), 100000u);
}

}  // namespace hybrid::e2e
