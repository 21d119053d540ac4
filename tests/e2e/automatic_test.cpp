// Scans without landmarks, through the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "geometry/pose.hpp"
#include "io/output.hpp"
#include "places.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

namespace fs = std::filesystem;

std::string without_landmarks(const fs::path& scene) {
  std::string text = io::read_text(scene);
  const auto remove = [&](const std::string& from, const std::string& to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at))
      text.erase(at, text.find(to, at) + to.size() - at);
  };
  remove("landmarks = [", "\n]\n");
  return text;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

}  // namespace

TEST(AutomaticScene, the_symmetric_room_abstains_with_a_sheet_and_the_run_goes_on) {
  const Scratch scratch;
  std::string text = without_landmarks(room() / "scene.toml");
  replace_all(text, "\"scans/", fmt::format("\"{}/", (room() / "scans").string()));
  replace_all(text, "\"proxy.obj\"", fmt::format("\"{}\"", (room() / "proxy.obj").string()));
  replace_all(text, "truth = \"truth.json\"", "");
  text.resize(text.find("[photographs]"));
  io::write_text(scratch / "scene.toml", text);
  const auto out = scratch / "out";
  const auto outcome = run("hybrid run " + (scratch / "scene.toml").string() +
                           " --only planes,register,report --quiet --out " + out.string());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("automatic alignment abstains"), std::string::npos) << outcome.err;
  for (const char* scan : {"west", "east"}) {
    const auto pose = json_of(out / "scans" / scan / "pose.json");
    EXPECT_EQ(pose["status"], "abstained");
    EXPECT_EQ(pose["how"], "automatic");
    EXPECT_TRUE(pose["world_from_scan"].is_null());
    EXPECT_LT(pose["margin"], 0.001);
    EXPECT_NE(pose["rivals"].dump().find("turned by 180 degrees about the vertical"), std::string::npos);
    for (const char* file : {"scan.png", "model.png", "landmarks.toml", "places.png", "places.toml"})
      EXPECT_TRUE(fs::exists(out / "scans" / scan / "sheet" / file)) << file;
    EXPECT_TRUE(fs::exists(out / "scans" / scan / "detail.ply"));
  }
  const auto page = io::read_text(out / "report" / "index.html");
  EXPECT_NE(page.find("sheet/model.png"), std::string::npos);
  EXPECT_NE(page.find("sheet/places.png"), std::string::npos);

  // A person tells the place from its picture; its pose, as it stands there, settles it.
  const auto truth = json_of(room() / "truth.json");
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string scan = truth["scans"][i]["id"];
    const Pose right =
        pose_from_row_major(truth["scans"][i]["world_from_scan"].get<std::array<double, 16>>());
    const auto pose = json_of(out / "scans" / scan / "pose.json");
    ASSERT_EQ(pose["places"].size(), 4u) << scan;  // upside down, too: the scene is not levelled
    std::size_t place = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if (const auto rows = pose["places"][k]["world_from_scan"].get<std::array<double, 16>>();
          difference(pose_from_row_major(rows), right).within(0.05, 0.01))
        place = k + 1;
    ASSERT_NE(place, 0u) << scan;
    text = with_place(text, out, scan, place);
  }
  io::write_text(scratch / "chosen.toml", text);
  const auto chosen = run("hybrid register " + (scratch / "chosen.toml").string() + " --quiet --out " +
                          (scratch / "chosen").string());
  EXPECT_EQ(chosen.exit_code, 0) << chosen.err;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string scan = truth["scans"][i]["id"];
    const auto pose = json_of(scratch / "chosen" / "scans" / scan / "pose.json");
    EXPECT_EQ(pose["how"], "given");
    const auto apart =
        difference(pose_from_row_major(pose["world_from_scan"].get<std::array<double, 16>>()),
                   pose_from_row_major(truth["scans"][i]["world_from_scan"].get<std::array<double, 16>>()));
    EXPECT_LT(apart.distance_m, 2e-4) << scan;
  }

  // What the sheet asks for, filled in, settles it, and the sheet goes.
  const auto once_more = run("hybrid register " + (room() / "scene.toml").string() +
                             " --set register.automatic=first --quiet --force --out " + out.string());
  EXPECT_EQ(once_more.exit_code, 0) << once_more.err;
  const auto pose = json_of(out / "scans" / "west" / "pose.json");
  EXPECT_EQ(pose["how"], "landmarks");
  EXPECT_FALSE(pose["automatic"]["accepted"]);
  EXPECT_FALSE(fs::exists(out / "scans" / "west" / "sheet"));
}

TEST(AutomaticScene, real_scans_are_aligned_as_their_landmarks_say) {
  const char* folder = std::getenv("HYBRID_DATA");
  const fs::path data = folder ? fs::path(folder) : fs::path(HYBRID_PROJECT_DIR) / ".." / "shared" / "data";
  if (!fs::exists(data / "scans/pcl-room/room_scan1.pcd"))
    GTEST_SKIP() << "no real scans at " << data << "; set HYBRID_DATA";
  const fs::path scene = HYBRID_PROJECT_DIR "/datasets/pcl-room";
  const Scratch scratch;
  std::string text = without_landmarks(scene / "scene.toml");
  replace_all(text, "${HYBRID_DATA:-../../../shared/data}", data.string());
  replace_all(text, "\"proxy.obj\"", fmt::format("\"{}\"", (scene / "proxy.obj").string()));
  io::write_text(scratch / "scene.toml", text);
  const auto pose_json = [&](const std::string& out, const std::string& scan) {
    return json_of(scratch / out / "scans" / scan / "pose.json");
  };
  const auto register_to = [&](const fs::path& file, const std::string& out) {
    return run("hybrid register " + file.string() + " --quiet --out " + (scratch / out).string()).exit_code;
  };
  // Scan 2 sees a wall of 10 m that the proxy lacks.
  EXPECT_EQ(register_to(scratch / "scene.toml", "automatic"), 0);
  EXPECT_EQ(register_to(scene / "scene.toml", "landmarks"), 0);
  const auto pose_of = [&](const std::string& out, const std::string& scan) {
    return pose_from_row_major(pose_json(out, scan)["world_from_scan"].get<std::array<double, 16>>());
  };
  for (const char* scan : {"scan1", "scan2"}) {
    EXPECT_EQ(pose_json("automatic", scan)["how"], "automatic");
    const auto apart = difference(pose_of("automatic", scan), pose_of("landmarks", scan));
    EXPECT_LT(apart.distance_m, 0.001) << scan;  // measured: 0
    EXPECT_LT(apart.angle_rad * 180 / M_PI, 0.01) << scan;
  }

  // Scan to scan, without the proxy. Not levelled, planes alone do not tell it from upside down; what the
  // scans see through does.
  const std::size_t model = text.find("[model]"), planes = text.find("[planes]"),
                    view = text.find("[[view]]");
  text = text.substr(0, model) + text.substr(planes, view - planes);
  const auto second_in_first = [&](const std::string& out) {
    return pose_of(out, "scan1").inverse() * pose_of(out, "scan2");
  };
  for (const char* levelled : {"false", "true"}) {
    io::write_text(scratch / "scans.toml", text);
    EXPECT_EQ(register_to(scratch / "scans.toml", "scans"), 0);
    const auto apart = difference(second_in_first("automatic"), second_in_first("scans"));
    EXPECT_LT(apart.distance_m, 0.02) << levelled;  // measured: 0.7 mm
    EXPECT_LT(apart.angle_rad * 180 / M_PI, 0.2) << levelled;
    replace_all(text, "levelled = false", "levelled = true");
  }
}

}  // namespace hybrid::e2e
