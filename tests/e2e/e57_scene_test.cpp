// The tiny room with scans and photographs in E57 files that hybrid-synth's own writer made: the scans are in
// a surveyor's frame, the panoramas taken from them, too; the photographs of the lens lie in a file apart.
#include <gtest/gtest.h>

#include <fmt/ranges.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "io/output.hpp"
#include "io/picture.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

namespace fs = std::filesystem;

class E57Scene : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<Scratch>();
    const auto made =
        run("hybrid-synth room --out " + room().string() + " --seed 1 --preset tiny --format e57 --quiet");
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  static fs::path room() { return *scratch_ / "room"; }
  static fs::path folder(const std::string& name) { return *scratch_ / name; }

  // The scene with another [photographs] and more views.
  static fs::path scene(const std::string& name, const std::string& photographs,
                        const std::string& more = "") {
    std::string text = io::read_text(room() / "scene.toml");
    const std::size_t start = text.find("e57 = ["), end = text.find('\n', start);
    text.replace(start, end - start, photographs);
    io::write_text(room() / name, text + more);
    return room() / name;
  }

  static void run_scene(const fs::path& scene, const std::string& out, const std::string& options = "") {
    const auto done =
        run("hybrid run " + scene.string() + " --out " + folder(out).string() + " --quiet " + options);
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }

 private:
  static std::unique_ptr<Scratch> scratch_;
};

std::unique_ptr<Scratch> E57Scene::scratch_;

// Over the pixels that a photograph sees (not red).
double psnr_db(const fs::path& view, const fs::path& truth) {
  const Image8 a = io::read_photograph(view, 0, 0), b = io::read_photograph(truth, a.width, a.height);
  double sum = 0, count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const std::uint8_t *p = a.at(x, y), *q = b.at(x, y);
      if (p[0] == 255 && p[1] == 0 && p[2] == 0) continue;
      for (int k = 0; k < 3; ++k, ++count) sum += (p[k] - q[k]) * (p[k] - q[k]);
    }
  EXPECT_GT(count, 2.5 * a.width * a.height);  // most of the view is seen
  return 10 * std::log10(255 * 255 * count / sum);
}

nlohmann::json summary(const fs::path& out) {
  return nlohmann::json::parse(io::read_text(out / "summary.json"));
}

// The PLY room's own points, moved.
void move_the_room(const fs::path& to) {
  std::string ply = io::read_text(e2e::room() / "scans/west.ply");
  const std::size_t body = ply.find("end_header\n") + 11;
  for (std::size_t at = body; at + 16 <= ply.size(); at += 16) {
    float point[3];
    std::memcpy(point, ply.data() + at, sizeof point);
    point[0] += 64, point[1] -= 32, point[2] += 8;  // rounding at these sizes: 4 micrometres
    std::memcpy(ply.data() + at, point, sizeof point);
  }
  io::write_text(to, ply);
}

}  // namespace

// Panoramas alone texture the room; the same view from COLMAP's photographs reaches 24.9 dB.
TEST_F(E57Scene, panoramas_follow_their_scans_and_land_in_the_right_place) {
  const auto file = scene("panoramas.toml", "e57 = [\"scans/west.e57\", \"scans/east.e57\"]",
                          "\n[[view]]\nname = \"left-out\"\nphotograph = \"west-panorama.jpg\"\n"
                          "leave_out = [\"west-panorama.jpg\"]\n");
  // The views of the scene that want photographs by name are for its own cameras.
  std::string text = io::read_text(file);
  const std::size_t own = text.find("[[view]]\nname = \"leave-one-out\"");
  ASSERT_NE(own, text.npos);
  text.erase(own, text.find("[[view]]", own + 1) - own);
  io::write_text(file, text);
  run_scene(file, "panoramas");
  const auto document = summary(folder("panoramas"));
  ASSERT_EQ(document["photographs"].size(), 2u);
  EXPECT_EQ(document["photographs"][0]["placed_with"], "scan west");
  EXPECT_EQ(document["photographs"][1]["placed_with"], "scan east");
  for (const auto& scan : document["scans"]) {
    EXPECT_GT(scan["truth"]["planar_samples_right_share"], 0.99) << scan["id"];  // measured: 0.996 of both
    EXPECT_EQ(scan["truth"]["planes_found"], scan["truth"]["planes_of_100_samples"]) << scan["id"];
    EXPECT_LT(scan["truth"]["pose_error_mm"], 0.1) << scan["id"];  // measured: 0.014, 0.031
  }
  for (const char* view : {"both-textured", "novel-2"}) {
    const double psnr = psnr_db(folder("panoramas") / "views" / (std::string(view) + ".png"),
                                room() / "truth/views" / (std::string(view) + ".png"));
    RecordProperty(view, std::to_string(psnr));
    EXPECT_GT(psnr, 20) << view;
  }
}

TEST_F(E57Scene, embedded_photographs_give_the_views_that_the_files_give) {
  const auto embedded = scene("embedded.toml", "e57 = \"photographs.e57\"");
  const auto files = scene("files.toml", "colmap = \"cameras\"\nimages = \"photographs\"");
  run_scene(embedded, "embedded", "--only render");
  run_scene(files, "files", "--only render");
  for (const char* view : {"both-textured", "leave-one-out", "novel-2"}) {
    const std::string name = std::string("views/") + view + ".exr";
    EXPECT_EQ(io::fingerprint(folder("embedded") / name).xxh3, io::fingerprint(folder("files") / name).xxh3)
        << view;
  }
}

TEST_F(E57Scene, info_lists_every_image) {
  const auto told = run("hybrid info " + (room() / "scans/west.e57").string() + " --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const auto document = nlohmann::json::parse(told.out);
  ASSERT_EQ(document["images"].size(), 1u);
  const auto& image = document["images"][0];
  EXPECT_EQ(image["type"], "spherical");
  EXPECT_EQ(image["size"], (nlohmann::json{800, 400}));
  EXPECT_EQ(image["mask"], true);
  EXPECT_EQ(image["scan"], 0);
  EXPECT_EQ(image["world_from_image"], document["scans"][0]["world_from_scan"]);
  const auto alone = run("hybrid info " + (room() / "photographs.e57").string() + " --json");
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_EQ(nlohmann::json::parse(alone.out)["images"].size(), 6u);
}

TEST_F(E57Scene, a_damaged_picture_is_named_and_salvage_goes_on_without_it) {
  std::string bytes = io::read_text(room() / "photographs.e57");
  bytes[2000] = static_cast<char>(bytes[2000] ^ 1);  // in the first picture
  io::write_text(room() / "damaged.e57", bytes);
  const std::string command = "hybrid render " + scene("damaged.toml", "e57 = \"damaged.e57\"").string() +
                              " --view novel-2 --quiet --out " + folder("damaged").string();
  const auto failed = run(command);
  EXPECT_EQ(failed.exit_code, 4);
  EXPECT_NE(failed.err.find("damaged.e57: byte 1024 (page 1)"), std::string::npos) << failed.err;
  EXPECT_NE(failed.err.find("image 0 (000.jpg)"), std::string::npos) << failed.err;
  const auto salvaged = run(command + " --salvage");
  EXPECT_EQ(salvaged.exit_code, 0) << salvaged.err;
  EXPECT_NE(salvaged.err.find("image 0 (000.jpg)"), std::string::npos) << salvaged.err;
  EXPECT_NE(salvaged.err.find("damaged"), std::string::npos) << salvaged.err;
}

// METHOD 1: clouds without a grid need to know where the scanner stood.
TEST_F(E57Scene, a_cloud_in_site_coordinates_gives_the_same_planes_with_the_scanner_key) {
  const std::string shifted = folder("site.ply").string();
  move_the_room(shifted);
  const auto without = run("hybrid planes " + shifted + " --quiet --out " + folder("without").string());
  EXPECT_NE(without.err.find("--scanner x,y,z"), std::string::npos) << without.err;  // a warning
  const auto with =
      run("hybrid planes " + shifted + " --scanner 64,-32,8 --quiet --out " + folder("with").string());
  ASSERT_EQ(with.exit_code, 0) << with.err;
  const auto moved = summary(folder("with"))["scans"][0], own = summary(result())["scans"][0];
  EXPECT_EQ(with.err.find("--scanner"), std::string::npos) << with.err;
  EXPECT_NE(summary(folder("without"))["scans"][0]["superclusters"], own["superclusters"]);
  EXPECT_EQ(moved["grid"], own["grid"]);
  EXPECT_EQ(moved["superclusters"], own["superclusters"]);
  const double before = own["decimation"]["measured"], after = moved["decimation"]["measured"];
  EXPECT_NEAR(after / before, 1, 1e-3);
  const auto planes = [](const fs::path& out, const std::string& id) {
    return nlohmann::json::parse(io::read_text(out / "scans" / id / "planes.json"))["superclusters"];
  };
  const auto a = planes(folder("with"), "site"), b = planes(result(), "west");
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i]["offset_m"].get<double>(), b[i]["offset_m"].get<double>(), 1e-3) << i;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(a[i]["normal"][k].get<double>(), b[i]["normal"][k].get<double>(), 1e-3) << i;
  }
}

// The pose is in the file's coordinates then.
TEST_F(E57Scene, the_scanner_key_of_a_scene_takes_the_pose_of_the_files_coordinates) {
  move_the_room(folder("site.ply"));
  const auto truth =
      nlohmann::json::parse(io::read_text(result() / "scans/west/pose.json"))["world_from_scan"];
  // world_from_file = world_from_scan after the way back from the file's coordinates.
  std::vector<double> pose = truth.get<std::vector<double>>();
  for (std::size_t row = 0; row < 3; ++row)
    pose[4 * row + 3] -= 64 * pose[4 * row] - 32 * pose[4 * row + 1] + 8 * pose[4 * row + 2];
  io::write_text(
      folder("key.toml"),
      fmt::format("[[scan]]\nid = \"west\"\nfile = \"site.ply\"\nscanner = [64, -32, 8]\npose = [{}]\n"
                  "[model]\nfile = \"{}\"\n",
                  fmt::join(pose, ", "), (e2e::room() / "proxy.obj").string()));
  const auto done =
      run("hybrid register " + folder("key.toml").string() + " --quiet --out " + folder("key").string());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto found = nlohmann::json::parse(io::read_text(folder("key") / "scans/west/pose.json"));
  for (std::size_t i = 0; i < 16; ++i)
    EXPECT_NEAR(found["world_from_scan"][i].get<double>(), truth[i].get<double>(), 1e-4) << i;
}

}  // namespace hybrid::e2e
