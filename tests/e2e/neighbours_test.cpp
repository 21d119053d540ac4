// Scans that the model does not place, through the program: their neighbours do, or there is no model at all.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/pose.hpp"
#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

namespace fs = std::filesystem;

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

// The scene and its proxy with every length of the model times `scale`, which is not told.
void write_scaled_scene(const Scratch& scratch, std::string text, const fs::path& proxy, double scale) {
  std::istringstream model(io::read_text(proxy));
  std::string scaled;
  for (std::string line; std::getline(model, line);) {
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3)
      line = fmt::format("v {} {} {}", scale * x, scale * y, scale * z);
    scaled += line + "\n";
  }
  io::write_text(scratch / "proxy.obj", scaled);
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace(proxy.string(), (scratch / "proxy.obj").string());
  replace("truth = ", "# ");
  replace("unit = \"m\"", "unit = \"arbitrary\"");
  text += "\n[register]\nscale = \"free\"\n";
  const std::string before = "model = [";
  for (auto at = text.find(before); at != std::string::npos; at = text.find(before, at + 1)) {
    const auto begin = at + before.size(), end = text.find(']', begin);
    double x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(text.substr(begin, end - begin).c_str(), "%lf, %lf, %lf", &x, &y, &z), 3);
    text.replace(begin, end - begin, fmt::format("{}, {}, {}", scale * x, scale * y, scale * z));
  }
  io::write_text(scratch / "scene.toml", text);
}

void expect_scaled_pose(const nlohmann::json& pose, const nlohmann::json& truth, double scale) {
  SCOPED_TRACE(pose["scan"]);
  EXPECT_NEAR(pose["scale"].get<double>() / scale, 1, 2e-5);
  for (const std::size_t k : {3, 7, 11})
    EXPECT_NEAR(pose["world_from_scan"][k].get<double>() / scale, truth[k].get<double>(), 0.001);
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

// A model of unknown scale takes its scale from one scan's landmarks; the other scan lies beside that one as
// large.
TEST(Neighbours, of_a_model_of_unknown_scale_landmarks_of_one_scan_are_enough) {
  constexpr double kScale = 0.37;
  const Scratch scratch;
  write_scaled_scene(scratch, scene_without_landmarks(false, true), room() / "proxy.obj", kScale);
  const auto out = scratch / "out";
  const auto outcome =
      run("hybrid register " + (scratch / "scene.toml").string() + " --quiet --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const auto& scan : json_of(room() / "truth.json")["scans"]) {
    const std::string id = scan["id"];
    const auto pose = json_of(out / "scans" / id / "pose.json");
    EXPECT_EQ(pose["how"], id == "east" ? "neighbour" : "landmarks");
    expect_scaled_pose(pose, scan["world_from_scan"], kScale);
  }
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
  for (const int i : {0, 1}) {
    const auto& residuals = summary["scans"][i]["registration"]["residuals"];
    EXPECT_EQ(residuals["to"], "scans");
    EXPECT_LT(residuals["median_m"], 0.002) << i;
    EXPECT_GT(residuals["median_m"], 0) << i;
  }
  for (const char* scan : {"west", "east"})
    EXPECT_TRUE(fs::exists(out / "scans" / scan / "residuals.png")) << scan;
  EXPECT_EQ(json_of(out / "scans/east/pose.json")["residuals"]["to"], "scans");

  // They are reported and exported as well.
  const auto whole =
      run("hybrid run " + (scratch / "scene.toml").string() +
          " --only planes,register,export,report --set export.formats=ply,glb --quiet --out " + out.string());
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_NE(io::read_text(out / "report/index.html").find("Scan to scan"), std::string::npos);
  EXPECT_GT(std::filesystem::file_size(out / "export/points.ply"), 100000u);
  for (const char* picture : {"registration-after", "registration-plan"})
    EXPECT_TRUE(fs::exists(out / "report" / (std::string(picture) + ".png"))) << picture;
  EXPECT_FALSE(fs::exists(out / "report/registration-before.png"));
}

// A scene of these scans without a model, the second with this pose where there is one.
void write_posed_scene(const fs::path& file, const fs::path& west, const fs::path& east, const Pose* pose) {
  std::string text = fmt::format(
      "[scene]\nname = \"posed\"\nlevelled = true\ntruth = \"{}\"\n[[scan]]\nid = \"west\"\nfile = "
      "\"{}\"\n[[scan]]\nid = \"east\"\nfile = \"{}\"\n",
      (room() / "truth.json").string(), west.string(), east.string());
  if (pose != nullptr) text += fmt::format("pose = {}\n", nlohmann::json(row_major(*pose)).dump());
  io::write_text(file, text);
}

// Where the truth has the second scan, the first at the origin.
Pose east_in_west() {
  const auto truth = json_of(room() / "truth.json");
  const auto pose = [&](std::size_t i) {
    return pose_from_row_major(truth["scans"][i]["world_from_scan"].get<std::array<double, 16>>());
  };
  return pose(0).inverse() * pose(1);
}

fs::path scan_of_room(const std::string& id) {
  for (const auto& entry : fs::directory_iterator(room() / "scans"))
    if (entry.path().stem() == id) return entry.path();
  return {};
}

// A pose is where ICP on the other scan starts: 30 cm and 10 degrees off it arrives. One that the scans
// contradict is refused with the numbers, and planes place the scan.
TEST(Neighbours, a_pose_without_a_model_is_a_start_that_is_judged) {
  const Scratch scratch;
  const auto out = scratch / "out";
  Pose start = east_in_west();
  start.translation += Vec3(0.2, -0.2, 0.1);
  start.rotation = Eigen::AngleAxisd(10 * M_PI / 180, Vec3(0.3, 0.2, 1).normalized()) * start.rotation;
  write_posed_scene(scratch / "scene.toml", scan_of_room("west"), scan_of_room("east"), &start);
  const std::string command = "hybrid run " + (scratch / "scene.toml").string() +
                              " --only register,report --quiet --out " + out.string();
  auto outcome = run(command);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  auto pose = json_of(out / "scans/east/pose.json");
  EXPECT_EQ(pose["how"], "scan-icp");
  EXPECT_EQ(pose["aligned_to"], "west");
  EXPECT_EQ(pose["on_scans"]["start"], "given");
  EXPECT_LT(pose["on_scans"]["seen_through"], 0.02);
  EXPECT_GT(pose["on_scans"]["overlap"], 0.8);
  auto summary = json_of(out / "summary.json");
  EXPECT_LT(summary["scans"][1]["truth"]["pose_error_mm"], 0.2);
  EXPECT_LT(summary["scans"][1]["truth"]["pose_error_deg"], 0.002);
  EXPECT_NE(outcome.out.find("lie on other scans"), std::string::npos) << outcome.out;
  EXPECT_NE(io::read_text(out / "report/index.html").find("seen through"), std::string::npos);

  start = east_in_west();
  start.translation += Vec3(2.5, 2, 0);
  write_posed_scene(scratch / "scene.toml", scan_of_room("west"), scan_of_room("east"), &start);
  outcome = run(command);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  pose = json_of(out / "scans/east/pose.json");
  EXPECT_EQ(pose["how"], "neighbour");
  ASSERT_EQ(pose["warnings"].size(), 1u);
  EXPECT_NE(pose["warnings"][0].get<std::string>().find("the other scans contradict the pose"),
            std::string::npos);
  EXPECT_LT(json_of(out / "summary.json")["scans"][1]["truth"]["pose_error_mm"], 0.2);
}

// What `hybrid register` makes of a church's front and nave, of which a sixth is seen through the door, the
// nave's pose 5 cm and 2 degrees off, in `out`.
Outcome register_through_the_door(const Scratch& scratch, int seed) {
  const auto church = scratch / "church";
  const auto made =
      run(fmt::format("hybrid-synth church --seed {} --preset tiny --megapixels 0.3 --quiet --out {}", seed,
                      church.string()));
  EXPECT_EQ(made.exit_code, 0) << made.err;
  const auto truth = json_of(church / "truth.json");
  std::string text = "[scene]\nname = \"door\"\nlevelled = true\ntruth = \"church/truth.json\"\n";
  for (const std::size_t i : {0u, 1u}) {
    Pose pose = pose_from_row_major(truth["scans"][i]["world_from_scan"].get<std::array<double, 16>>());
    if (i == 1) {
      const Vec3 turn(0.0031, 0.0178, -0.0299);
      pose.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.rotation;
      pose.translation += Vec3(0.0475, -0.0135, 0.0080);
    }
    const auto id = truth["scans"][i]["id"].get<std::string>();
    text += fmt::format("[[scan]]\nid = \"{}\"\nfile = \"church/scans/{}.ply\"\npose = {}\n", id, id,
                        nlohmann::json(row_major(pose)).dump());
  }
  io::write_text(scratch / "scene.toml", text);
  return run("hybrid register " + (scratch / "scene.toml").string() + " --quiet --out " +
             (scratch / "out").string());
}

// Through a church's door ICP finds two places 15 cm apart that fit alike: neither is taken.
TEST(Neighbours, of_two_places_where_little_holds_a_scan_none_is_taken) {
  const Scratch scratch;
  const auto outcome = register_through_the_door(scratch, 109);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  const auto pose = json_of(scratch / "out/scans/nave/pose.json");
  EXPECT_EQ(pose["status"], "abstained");
  EXPECT_NE(pose["reason"].get<std::string>().find("from beside it ICP finds another"), std::string::npos)
      << pose["reason"];
}

// ICP comes back from beside the right place: its pairs are the closest samples, not the closest ones tried.
// (In strides alone it found another place from there, and the right one was refused.)
TEST(Neighbours, where_little_holds_a_scan_it_is_laid_if_icp_comes_back_from_beside) {
  const Scratch scratch;
  const auto outcome = register_through_the_door(scratch, 106);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto nave = json_of(scratch / "out/summary.json")["scans"][1];
  EXPECT_LT(nave["truth"]["pose_error_mm"], 0.5);  // measured 0.16
  EXPECT_LT(nave["truth"]["pose_error_deg"], 0.005);
}

TEST(Neighbours, where_little_holds_a_scan_a_warning_says_so) {
  const Scratch scratch;
  const auto outcome = register_through_the_door(scratch, 103);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto nave = json_of(scratch / "out/summary.json")["scans"][1];
  ASSERT_EQ(nave["id"], "nave");
  EXPECT_LT(nave["truth"]["pose_error_mm"], 2);  // measured 1.5; with the coarser scan's word as well 2.8
  EXPECT_LT(nave["truth"]["pose_error_deg"], 0.03);
  const auto warnings = nave["registration"]["warnings"];
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].get<std::string>().find("little holds it: at most 1"), std::string::npos) << warnings;
}

void make_scene(const fs::path& out, const std::string& kind, int seed, const std::string& options) {
  const auto made = run(fmt::format("hybrid-synth {} --seed {} --preset tiny {} --quiet --out {}", kind, seed,
                                    options, out.string()));
  ASSERT_EQ(made.exit_code, 0) << made.err;
}

// What `hybrid register` makes of the same scan of these scenes, as a folder.
Outcome register_alike(const Scratch& scratch, const std::string& kind, const std::vector<int>& seeds,
                       const std::string& scan, const std::string& megapixels) {
  fs::create_directories(scratch / "both");
  for (const int seed : seeds) {
    const auto place = scratch / std::to_string(seed);
    make_scene(place, kind, seed, "--only-scan " + scan + " --megapixels " + megapixels);
    fs::copy_file(place / "scans" / (scan + ".ply"), scratch / "both" / (std::to_string(seed) + ".ply"));
  }
  return run("hybrid register " + (scratch / "both").string() + " --quiet --out " +
             (scratch / "out").string());
}

// Turned by half a turn this nave's planes fit the chancel's nearly as well; there the scans see through each
// other.
TEST(Neighbours, what_scans_see_through_decides_between_rivals) {
  const Scratch scratch;
  const auto out = scratch / "out", church = scratch / "church";
  make_scene(church, "church", 106, "--megapixels 0.3");
  fs::remove(church / "scans/front.ply");
  const auto outcome =
      run("hybrid register " + (church / "scans").string() + " --quiet --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto nave = json_of(out / "scans/nave/pose.json");
  ASSERT_EQ(nave["status"], "accepted") << nave;
  EXPECT_EQ(nave["aligned_to"], "chancel");
  const auto& neighbour = nave["neighbour"];
  EXPECT_LT(neighbour["seen_through"], 0.02);
  EXPECT_LT(neighbour["rivals"][0]["strength"], 1);
  EXPECT_GT(neighbour["rivals"][0]["seen_through"], 0.05);
  const auto truth = json_of(church / "truth.json");
  Pose in_truth[2];
  for (const auto& scan : truth["scans"])
    for (const int i : {0, 1})
      if (scan["id"] == (i == 0 ? "chancel" : "nave"))
        in_truth[i] = pose_from_row_major(scan["world_from_scan"].get<std::array<double, 16>>());
  const auto off = difference(pose_from_row_major(nave["world_from_scan"].get<std::array<double, 16>>()),
                              in_truth[0].inverse() * in_truth[1]);
  EXPECT_LT(off.distance_m, 0.001);  // measured 0.03 mm
  EXPECT_LT(off.angle_rad, 1e-4);
}

// Two churches of nearly one size: planes of the one fit those of the other.
TEST(Neighbours, scans_of_two_places_that_are_alike_are_not_laid_on_each_other) {
  const Scratch scratch;
  const auto outcome = register_alike(scratch, "church", {103, 105}, "nave", "0.3");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;  // of a folder nobody says that it is one place
  const auto pose = json_of(scratch / "out" / "scans/105/pose.json");
  EXPECT_EQ(pose["status"], "abstained");
  EXPECT_NE(pose["reason"].get<std::string>().find("its planes fit, but"), std::string::npos)
      << pose["reason"];
  EXPECT_GT(pose["neighbour"]["seen_through"], 0.05);
}

// Of two rooms in one folder one is the scene; how the other's scans lie among themselves is told.
TEST(Neighbours, of_scans_of_two_places_the_smaller_group_is_told_how_it_lies) {
  const Scratch scratch;
  const auto out = scratch / "out", both = scratch / "both";
  make_scene(scratch / "thirteen", "room", 13, "--megapixels 0.15");
  fs::create_directories(both);
  for (const char* scan : {"west", "east"}) {
    fs::copy_file(scan_of_room(scan), both / (std::string("b-") + scan + ".ply"));
    fs::copy_file(scratch / "thirteen/scans" / (std::string(scan) + ".ply"),
                  both / (std::string("a-") + scan + ".ply"));
  }
  const auto outcome = run("hybrid register " + both.string() + " --quiet --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* scan : {"a-west", "a-east"})
    EXPECT_EQ(json_of(out / "scans" / scan / "pose.json")["status"], "accepted") << scan;
  const auto west = json_of(out / "scans/b-west/pose.json");
  EXPECT_EQ(west["status"], "abstained");
  EXPECT_NE(west["reason"].get<std::string>().find("it hangs together with b-east"), std::string::npos)
      << west["reason"];
  EXPECT_EQ(west["island"]["frame"], "b-east");
  const auto found = pose_from_row_major(west["island"]["frame_from_scan"].get<std::array<double, 16>>());
  const auto off = difference(found, east_in_west().inverse());
  EXPECT_LT(off.distance_m, 0.0002);  // measured 0.04 mm
  EXPECT_LT(off.angle_rad, 0.00002);
  EXPECT_LT(west["island"]["on_scans"]["rms_m"], 0.003);
  EXPECT_EQ(west["residuals"]["to"], "scans");
  EXPECT_TRUE(fs::exists(out / "scans/b-west/residuals.png"));
  const auto joint = json_of(out / "summary.json")["joint"];
  ASSERT_EQ(joint["islands"].size(), 1u);
  EXPECT_EQ(joint["islands"][0]["frame"], "b-east");
  ASSERT_EQ(joint["islands"][0]["pairs"].size(), 1u);
  EXPECT_LT(joint["islands"][0]["pairs"][0]["distance_m"], 0.001);
}

// Two rooms whose walls differ by less than what is called near: nothing tells them apart but how far their
// scans lie from each other.
TEST(Neighbours, places_that_are_alike_within_centimetres_are_told_by_a_warning) {
  const Scratch scratch;
  const auto outcome = register_alike(scratch, "room", {15, 18}, "east", "0.15");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto pose = json_of(scratch / "out" / "scans/18/pose.json");
  if (pose["status"] == "abstained") return;  // even better
  ASSERT_TRUE(pose.contains("warnings")) << pose;
  EXPECT_NE(pose["warnings"][0].get<std::string>().find("times its noise"), std::string::npos)
      << pose["warnings"];
}

// Registered files keep their frame: the first scan's pose in its file is the scene's, the others' are
// starts.
TEST(Neighbours, poses_in_scan_files_are_starts) {
  const Scratch scratch;
  const auto out = scratch / "out";
  Pose start = east_in_west();
  write_posed_scene(scratch / "scene.toml", scan_of_room("west"), scan_of_room("east"), &start);
  const auto written = run("hybrid register " + (scratch / "scene.toml").string() +
                           " --write e57 --quiet --out " + (scratch / "first").string());
  ASSERT_EQ(written.exit_code, 0) << written.err;
  write_posed_scene(scratch / "again.toml", scratch / "first/scans/west/registered.e57",
                    scratch / "first/scans/east/registered.e57", nullptr);
  const auto outcome =
      run("hybrid register " + (scratch / "again.toml").string() + " --quiet --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto pose = json_of(out / "scans/east/pose.json");
  EXPECT_EQ(pose["how"], "scan-icp");
  EXPECT_EQ(pose["on_scans"]["start"], "recorded");
  const auto got = pose_from_row_major(pose["world_from_scan"].get<std::array<double, 16>>());
  EXPECT_LT(difference(got, start).distance_m, 2e-4);
}

// A church's front and the ground before it fit a model of any scale; the nave shows it.
TEST(Neighbours, a_scan_that_does_not_show_the_models_scale_takes_that_of_the_others) {
  constexpr double kScale = 0.37;
  const Scratch scratch;
  const fs::path church = scratch / "church";
  make_scene(church, "church", 300, "--megapixels 0.1");
  std::string text = io::read_text(church / "scene.toml");
  text.resize(text.find("[photographs]"));
  for (const std::string file : {"scans/", "proxy.obj"})
    for (auto at = text.find('"' + file); at != std::string::npos; at = text.find('"' + file, at + 1))
      text.insert(at + 1, church.string() + "/");
  write_scaled_scene(scratch, text, church / "proxy.obj", kScale);
  const auto out = scratch / "out";
  const auto outcome =
      run("hybrid register " + (scratch / "scene.toml").string() + " --quiet --out " + out.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* id : {"front", "nave", "chancel"}) {
    SCOPED_TRACE(id);
    const auto pose = json_of(out / "scans" / id / "pose.json");
    EXPECT_EQ(pose.value("scale_of_others", false), id == std::string("front"));
    EXPECT_NEAR(pose["scale"].get<double>() / kScale, 1, 2e-5);  // by its landmarks the front's is 4e-4 off
  }
}

}  // namespace hybrid::e2e
