#include "io/scene/scene_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "io/files.hpp"

namespace hybrid::io::scene_file_test {
namespace {
namespace fs = std::filesystem;
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

const std::string kScan = "[[scan]]\nfile = \"a.ply\"\n";

SceneFile read_text_scene(const TemporaryFolder& folder, const std::string& text) {
  return read_scene_file(folder.write("church.toml", text));
}

TEST(scene_file, reads_everything) {
  const TemporaryFolder folder;
  const SceneFile scene = read_text_scene(folder, R"(
[scene]
name = "church"
levelled = true
crs = "EPSG:27700"
shift = [530000.0, 180000, 0.5]
truth = "truth.json"
[[scan]]
id = "west"
file = "scans/../scans/west.ply"
index = 2
landmarks = [
  { scan = [1.02, 3.30, 0.51], model = [0.0, 4.0, 0.0] },
  { pixel = [812, 2040], vertex = 12 },
  { scan = [2.0, 1.0, 0.2], model = [1.5, 2.5, 0.1], snap = false },
]
[[scan]]
file = "/data/east.ptx"
pose = [0, -2, 0, 5, 2, 0, 0, 6, 0, 0, 2, 7, 0, 0, 0, 1]
fixed = true
[model]
file = "proxy.obj"
unit = "mm"
up = "y"
[photographs]
colmap = "sparse/0"
images = "images"
world_from_photographs = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
[planes]
square = "auto"
qualifying = 0.8
[register]
iterations = 50
[edit]
openings = "off"
[render]
photographs = false
[[view]]
name = "front"
photograph = "DSC_0001.JPG"
leave_out = ["DSC_0001.JPG"]
[[view]]
name = "free"
eye = [0, -10, 1.6]
target = [0, 0, 3]
fov_deg = 60
size = [640, 480]
show = "proxy"
texture = false
cameras = true
)");
  EXPECT_EQ(scene.name, "church");
  EXPECT_TRUE(scene.levelled);
  EXPECT_EQ(scene.crs, "EPSG:27700");
  EXPECT_EQ(scene.shift, Vec3(530000, 180000, 0.5));
  EXPECT_EQ(scene.truth, folder.path() / "truth.json");
  ASSERT_EQ(scene.scans.size(), 2u);
  const SceneScan& west = scene.scans[0];
  EXPECT_EQ(west.id, "west");
  EXPECT_EQ(west.line, 8);
  EXPECT_EQ(west.file, folder.path() / "scans/west.ply");
  EXPECT_EQ(west.index, 2);
  ASSERT_EQ(west.landmarks.size(), 3u);
  EXPECT_EQ(*west.landmarks[0].scan, Vec3(1.02, 3.30, 0.51));
  EXPECT_EQ(*west.landmarks[0].model, Vec3(0, 4, 0));
  EXPECT_TRUE(west.landmarks[0].snap);
  EXPECT_EQ(*west.landmarks[1].pixel, (std::array{812, 2040}));
  EXPECT_EQ(west.landmarks[1].vertex, 12);
  EXPECT_EQ(west.landmarks[1].line, 14);
  EXPECT_FALSE(west.landmarks[2].snap);
  EXPECT_EQ(scene.scans[1].file, "/data/east.ptx");
  EXPECT_TRUE(scene.scans[1].fixed);
  EXPECT_EQ((*scene.scans[1].pose)[7], 6);
  EXPECT_EQ(scene.model->file, folder.path() / "proxy.obj");
  EXPECT_EQ(scene.model->unit, "mm");
  EXPECT_EQ(scene.model->up, "y");
  EXPECT_EQ(scene.photographs->cameras.path, folder.path() / "sparse/0");
  EXPECT_EQ(scene.photographs->images, folder.path() / "images");
  EXPECT_EQ((*scene.photographs->world_from_photographs)[5], 1);
  EXPECT_EQ(scene.planes.at("square").value, OptionValue(std::string("auto")));
  EXPECT_EQ(scene.planes.at("qualifying").value, OptionValue(0.8));
  EXPECT_EQ(scene.planes.at("qualifying").line, 31);
  EXPECT_EQ(scene.registration.at("iterations").value, OptionValue(std::int64_t{50}));
  EXPECT_EQ(scene.edit.at("openings").value, OptionValue(std::string("off")));
  EXPECT_EQ(scene.render.at("photographs").value, OptionValue(false));
  ASSERT_EQ(scene.views.size(), 2u);
  EXPECT_EQ(scene.views[0].photograph, "DSC_0001.JPG");
  EXPECT_EQ(scene.views[0].leave_out, std::vector<std::string>{"DSC_0001.JPG"});
  EXPECT_TRUE(scene.views[0].texture);
  EXPECT_EQ(scene.views[1].eye, Vec3(0, -10, 1.6));
  EXPECT_EQ(scene.views[1].up, Vec3(0, 0, 1));
  EXPECT_EQ(scene.views[1].size, (std::array{640, 480}));
  EXPECT_EQ(scene.views[1].show, "proxy");
  EXPECT_FALSE(scene.views[1].texture);
  EXPECT_TRUE(scene.views[1].cameras);
}

TEST(scene_file, defaults) {
  const TemporaryFolder folder;
  const SceneFile scene = read_text_scene(folder, kScan);
  EXPECT_EQ(scene.name, "church");  // the file's stem
  EXPECT_FALSE(scene.levelled);
  EXPECT_FALSE(scene.model || scene.photographs || scene.truth);
  EXPECT_EQ(scene.scans[0].id, "");
  EXPECT_FALSE(scene.scans[0].index || scene.scans[0].pose || scene.scans[0].fixed);
}

TEST(scene_file, paths_are_relative_to_the_scene_file) {
  const TemporaryFolder folder;
  folder.write("sub/s.toml", "[[scan]]\nfile = \"../a.ply\"\n");
  EXPECT_EQ(read_scene_file(folder.path() / "sub/s.toml").scans[0].file, folder.path() / "a.ply");
}

TEST(scene_file, environment_variables_in_paths) {
  const TemporaryFolder folder;
  setenv("HYBRID_TEST_ROOT", "/archive", 1);
  setenv("HYBRID_TEST_EMPTY", "", 1);
  unsetenv("HYBRID_TEST_UNSET");
  const auto file = [&](const std::string& written) {
    return read_text_scene(folder, "[[scan]]\nfile = \"" + written + "\"\n").scans[0].file;
  };
  EXPECT_EQ(file("${HYBRID_TEST_ROOT}/a.ply"), "/archive/a.ply");
  EXPECT_EQ(file("${HYBRID_TEST_UNSET:-data}/a${HYBRID_TEST_EMPTY}.ply"), folder.path() / "data/a.ply");
  EXPECT_EQ(file("${HYBRID_TEST_EMPTY:-/x}/a.ply"), "/x/a.ply");
  EXPECT_EQ(file("${HYBRID_TEST_ROOT:-data}/a.ply"), "/archive/a.ply");
  EXPECT_EQ(file("$HOME/a.ply"), folder.path() / "$HOME/a.ply");
}

struct Broken {
  std::string text;
  std::string place;  // line, or line:column
  std::string part;
};

void expect_errors(const std::vector<Broken>& cases) {
  const TemporaryFolder folder;
  for (const Broken& broken : cases) {
    SCOPED_TRACE(broken.text);
    const std::string message = error_of(ErrorKind::input, [&] { read_text_scene(folder, broken.text); });
    EXPECT_TRUE(holds(message, (folder.path() / "church.toml").string() + ":" + broken.place + ": "));
    EXPECT_TRUE(holds(message, broken.part));
  }
}

TEST(scene_file, unknown_keys_name_the_known_ones) {
  expect_errors({
      {"[scene]\nlevel = true\n" + kScan, "2",
       "[scene]: unknown key \"level\"; did you mean \"levelled\"? Known: name"},
      {"[scenes]\n", "1", "unknown key \"scenes\"; did you mean \"scene\"?"},
      {"[[scan]]\nfiel = \"a\"\n", "2", "[[scan]] 1: unknown key \"fiel\"; did you mean \"file\"?"},
      {kScan + kScan + "zzzzzz = 1\n", "5", "[[scan]] 2: unknown key \"zzzzzz\"; Known: id, file"},
      {kScan + "landmarks = [\n{ scan = [0,0,0], modle = [0,0,0] }]\n", "4",
       "landmarks 1: unknown key \"modle\""},
      {"[model]\nfile = \"a\"\nunits = \"m\"\n", "3", "did you mean \"unit\"?"},
      {"[photographs]\ncolmaps = \"a\"\n" + kScan, "2", "did you mean \"colmap\"?"},
      {"[[view]]\nname = \"a\"\nfov = 60\n", "3", "unknown key \"fov\""},
  });
}

TEST(scene_file, wrong_types_and_values) {
  expect_errors({
      {"[scene]\nname = 3\n", "2", "[scene]: name: expected a string, found 3"},
      {"[scene]\nlevelled = \"yes\"\n", "2", "expected true or false, found \"yes\""},
      {"[scene]\nshift = [1, 2]\n", "2", "expected an array of 3 numbers, found an array of 2"},
      {"[scene]\nshift = [1, 2, \"3\"]\n", "2", "found \"3\" in place 3"},
      {"[scene]\nshift = [1, nan, 3]\n", "2", "expected 3 finite numbers, found nan in place 2"},
      {"[scene]\ncrs = 2024-01-01\n", "2", "found a date or time"},
      {"scene = 4\n", "1", "expected one table [scene], found 4"},
      {"[[scene]]\n", "1", "expected one table [scene], found an array"},
      {"[scan]\nfile = \"a.ply\"\n", "1", "expected tables [[scan]], found a table"},
      {"scan = [1]\n", "1", "expected an array of tables, found 1"},
      {"[[scan]]\nid = \"a\"\n", "1", "expected the key file, found none"},
      {"[[scan]]\nfile = \"\"\n", "2", "expected a path that is not empty"},
      {"[[scan]]\nfile = \"a\\u0000b\"\n", "2", "control characters"},
      {kScan + "index = -1\n", "3", "expected a whole number from 0, found -1"},
      {kScan + "index = 1.5\n", "3", "expected a whole number from 0, found 1.5"},
      {kScan + "index = 99999999999\n", "3", "found 99999999999"},
      {"[model]\nunit = \"m\"\n", "1", "expected the key file"},
      {"[model]\nfile = \"a\"\nunit = \"inch\"\n", "3", "expected one of m, mm, arbitrary, found \"inch\""},
      {"[model]\nfile = \"a\"\nup = \"x\"\n", "3", "expected one of z, y, found \"x\""},
      {"[model]\nfile = \"a\"\nunit = \"arbitrary\"\n", "3", "needs [register] scale = \"free\""},
      {kScan + "[planes]\nsquare = [3, 5]\n", "4", "expected a number, a string, true or false"},
      {kScan + "[edit]\nopenings = [1]\n", "4", "expected a number, a string, true or false"},
      {"[scene]\n", "1", "expected at least one [[scan]] or a [model]"},
  });
}

TEST(scene_file, names_are_usable_as_folders_and_unique) {
  expect_errors({
      {kScan + "id = \"\"\n", "3", "usable as a folder"},
      {kScan + "id = \"..\"\n", "3", "usable as a folder"},
      {kScan + "id = \"a/b\"\n", "3", "usable as a folder"},
      {kScan + "id = 'a\\b'\n", "3", "usable as a folder"},
      {kScan + "id = \"" + std::string(201, 'a') + "\"\n", "3", "usable as a folder"},
      {kScan + "id = \"a\"\n" + kScan + "id = \"a\"\n", "6", "found \"a\" again (line 3)"},
      {"[[view]]\nphotograph = \"a\"\n", "1", "expected the key name"},
      {"[[view]]\nname = \"a/b\"\nphotograph = \"a\"\n", "2", "usable as a folder"},
      {"[[view]]\nname = \"v\"\nphotograph = \"a\"\n[[view]]\nname = \"v\"\nphotograph = \"b\"\n", "5",
       "found \"v\" again (line 2)"},
      {"[[view]]\nname = \"v-pair\"\nphotograph = \"b\"\n"
       "[[view]]\nname = \"v\"\nphotograph = \"a\"\nleave_out = [\"a\"]\n",
       "2", "\"v-pair\" is what the view \"v\" (line 4)"},
  });
}

TEST(scene_file, polygons_of_clips_and_depth_edits_are_simple) {
  const std::string clip = kScan + "[[edit.clip]]\nprism = ",
                    depth = kScan + "[[edit.depth]]\nscan = \"a\"\n";
  expect_errors({
      {clip + "[[0, 0], [2, 2], [2, 0], [0, 2]]\n", "4", "meets itself: its edges from vertex 0 at (0, 0)"},
      {clip + "[[0, 0], [1, 1], [2, 2]]\n", "4", "all 3 vertices on one line"},
      {depth + "by_m = 1\npolygon = [[0, 0], [9, 9], [0, 9], [9, 0]]\n", "6", "meets itself"},
      {depth + "by_m = 1\npolygon = [[0, 0], [9, 9], [9, 9], [9, 0]]\n", "6", "again as vertex 2"},
      {depth + "by_m = 1\npolygon = [[0, 0], [9.5, 9], [9, 0]]\n", "6", "found 9.5, 9"},
  });
}

TEST(scene_file, poses_and_landmarks) {
  const std::string identity = "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]";
  const std::string landmark = "landmarks = [{ scan = [0,0,0], vertex = 1 }]\n";
  expect_errors({
      {kScan + "pose = [1, 2, 3]\n", "3", "expected an array of 16 numbers, found an array of 3"},
      {kScan + "pose = [1,0,0,inf, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n", "3", "found inf in place 4"},
      {kScan + "pose = [1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1]\n", "3", "mirrored"},
      {kScan + "pose = [1,0.5,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n", "3", "not a rotation times a scale"},
      {kScan + "pose = [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]\n", "3", "expected the last row 0 0 0 1"},
      {kScan + "fixed = true\n", "3", "expected a pose that is to be final"},
      {kScan + "pose = " + identity + "\nfixed = true\n" + landmark, "3", "found both"},
      {kScan + landmark + "pose = " + identity + "\n", "4",
       "either a pose or landmarks as the start, found both"},
      {kScan + "landmarks = [{ vertex = 1 }]\n", "3",
       "one of scan = [x, y, z] and pixel = [row, column], found neither"},
      {kScan + "landmarks = [{ scan = [0,0,0], pixel = [1,2], vertex = 1 }]\n", "3", "found both"},
      {kScan + "landmarks = [\n{ scan = [0,0,0] }]\n", "4",
       "one of model = [x, y, z] and vertex = index, found neither"},
      {kScan + "landmarks = [{ scan = [0,0,0], vertex = 1, model = [0,0,0] }]\n", "3", "found both"},
      {kScan + "landmarks = [{ pixel = [-1, 0], vertex = 1 }]\n", "3",
       "expected a whole number from 0, found -1"},
      {kScan + "landmarks = [{ scan = [0, 0, nan], vertex = 1 }]\n", "3", "finite"},
      {kScan + "landmarks = [3]\n", "3", "expected an array of tables, found 3"},
      {kScan + "landmarks = 3\n", "3", "expected tables [[landmarks]], found 3"},
  });
}

TEST(scene_file, lists_of_texts_may_be_arrays_and_misspelt_edits_are_named) {
  const TemporaryFolder folder;
  const SceneFile scene = read_text_scene(folder, "[export]\nformats = [\"glb\", \"obj\"]\n" + kScan);
  EXPECT_EQ(std::get<std::string>(scene.exporting.at("formats").value), "glb, obj");
  expect_errors({
      {"[export]\nformats = [\"glb\", 3]\n" + kScan, "2",
       "expected a number, a string, true or false, found an array"},
      {"[export]\nformats = []\n" + kScan, "2", "found an array"},
      {"[[edit.hole]]\nface = 0\n" + kScan, "1", "unknown key \"hole\"; did you mean \"holes\"?"},
  });
}

TEST(scene_file, landmarks_of_photographs) {
  const std::string section = "[photographs]\ncolmap = \"c\"\nimages = \"i\"\n";
  const TemporaryFolder folder;
  const auto picks = read_text_scene(folder, section + R"(landmarks = [
  { photograph = "a.jpg", pixel = [812, 2040.5], vertex = 12 },
  { photograph = "a.jpg", model = [4, -12, 1.6] },
  { point = [0.1, 0.2, 0.3], model = [1, 2, 3] },
  { point = [0.1, 0.2, 0.3], model = [1, 2, 3], snap = false },
]
)" + kScan)
                         .photographs->landmarks;
  ASSERT_EQ(picks.size(), 4u);
  EXPECT_EQ(picks[0].photograph, "a.jpg");
  EXPECT_EQ(picks[0].pixel, (std::array{812.0, 2040.5}));
  EXPECT_EQ(picks[0].vertex, 12);
  EXPECT_EQ(picks[0].line, 5);
  EXPECT_TRUE(picks[0].snap);
  EXPECT_FALSE(picks[1].pixel);
  EXPECT_FALSE(picks[1].snap) << "no photograph is taken at a corner";
  EXPECT_EQ(*picks[2].point, Vec3(0.1, 0.2, 0.3));
  EXPECT_TRUE(picks[2].snap);
  EXPECT_FALSE(picks[3].snap);
  const auto one = [&](const std::string& pick) {
    return section + "landmarks = [{ " + pick + " }]\n" + kScan;
  };
  expect_errors({
      {one("pixel = [1, 2], vertex = 0"), "4",
       "one of photograph = \"name\" and point = [x, y, z], found neither"},
      {one("photograph = \"a\", point = [1, 2, 3], vertex = 0"), "4", "found both"},
      {one("point = [1, 2, 3], pixel = [1, 2], vertex = 0"), "4", "expected the photograph that it is in"},
      {one("photograph = \"a\", pixel = [1, 2]"), "4", "one of model = [x, y, z] and vertex = index"},
      {one("photograph = \"a\", pixel = [1], vertex = 0"), "4", "expected an array of 2 numbers"},
      {one("photo = \"a\", pixel = [1, 2], vertex = 0"), "4", "unknown key \"photo\""},
      {"[photographs]\ne57 = \"a.e57\"\nlandmarks = []\n" + kScan, "3", "go with their scans"},
      {section +
           "world_from_photographs = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\nlandmarks = [{ photograph = "
           "\"a\", vertex = 0 }]\n" +
           kScan,
       "5", "found both; remove one"},
  });
}

TEST(scene_file, every_format_of_cameras) {
  const TemporaryFolder folder;
  const auto photographs = [&](const std::string& keys) {
    return *read_scene_file(folder.write("scene.toml", "[photographs]\n" + keys + "\n" + kScan)).photographs;
  };
  for (const CameraFormat format :
       {CameraFormat::colmap, CameraFormat::strecha, CameraFormat::bundler, CameraFormat::nerfstudio}) {
    const auto read = photographs(fmt::format("{} = \"a/cameras.json\"\nimages = \"b\"", name_of(format)));
    EXPECT_EQ(read.cameras.format, format);
    EXPECT_EQ(read.cameras.path, folder.path() / "a/cameras.json");
    EXPECT_EQ(read.images, folder.path() / "b");
  }
  // The folder of a format of one file.
  std::filesystem::create_directory(folder.path() / "a");
  EXPECT_EQ(photographs("bundler = \"a\"\nimages = \"b\"").cameras.path, folder.path() / "a/bundle.out");
  EXPECT_EQ(photographs("nerfstudio = \"a\"").cameras.path, folder.path() / "a/transforms.json");
  EXPECT_EQ(photographs("nerfstudio = \"a\"").images, folder.path() / "a");
  EXPECT_EQ(photographs("colmap = \"a\"\nimages = \"b\"").cameras.path, folder.path() / "a");
  // Nerfstudio's names start at its own file.
  EXPECT_EQ(photographs("nerfstudio = \"a/transforms.json\"").images, folder.path() / "a");
}

TEST(scene_file, depth_images_have_a_camera) {
  const TemporaryFolder folder;
  const std::string kDepth = "[[scan]]\nfile = \"depth/0001.PNG\"\n";
  const SceneFile scene =
      read_text_scene(folder, kDepth + "intrinsics = [525, 520, 319.5, 239.5]\ndepth_scale = 0.0002\n");
  ASSERT_TRUE(scene.scans[0].depth.has_value());
  EXPECT_EQ(scene.scans[0].depth->fy, 520);
  EXPECT_EQ(scene.scans[0].depth->scale, 0.0002);
  EXPECT_EQ(scene.scans[0].axes, ScanAxes::camera);
  EXPECT_EQ(read_text_scene(folder, kDepth + "intrinsics = [525, 520, 319.5, 239.5]\n").scans[0].depth->scale,
            0.001);
  expect_errors({
      {kDepth, "2", "needs intrinsics = [fx, fy, cx, cy]"},
      {kDepth + "intrinsics = [525, 525, 319.5]\n", "3", "expected an array of 4 numbers"},
      {kDepth + "intrinsics = [525, 0, 319.5, 239.5]\n", "3", "positive fx and fy"},
      {kDepth + "intrinsics = [525, 525, 1, 1]\ndepth_scale = 0\n", "4", "above 0 and at most 1"},
      {kDepth + "intrinsics = [525, 525, 1, 1]\ndepth_scale = 1000\n", "4", "above 0 and at most 1"},
      {kDepth + "intrinsics = [525, 525, 1, 1]\nindex = 0\n", "4", "a depth image is one scan"},
      {kDepth + "intrinsics = [525, 525, 1, 1]\nscanner = [0, 0, 0]\n", "4", "a depth image is one scan"},
      {kDepth + "intrinsics = [525, 525, 1, 1]\naxes = \"camera\"\n", "4", "a depth image is one scan"},
      {kScan + "intrinsics = [525, 525, 1, 1]\n", "3", "belongs to depth images"},
  });
}

TEST(scene_file, unit_of_a_scan) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_text_scene(folder, kScan).scans[0].unit_m, 1);
  EXPECT_EQ(read_text_scene(folder, kScan + "unit = \"mm\"\n").scans[0].unit_m, 0.001);
  EXPECT_EQ(read_text_scene(folder, kScan + "unit = \"ft\"\n").scans[0].unit_m, 0.3048);
  expect_errors({{kScan + "unit = \"inch\"\n", "3", "us-ft"}, {kScan + "unit = 0.001\n", "3", "unit"}});
}

TEST(scene_file, axes_of_a_scan) {
  const TemporaryFolder folder;
  const auto axes = [&](const std::string& keys) {
    return read_text_scene(folder, kScan + keys).scans[0].axes;
  };
  EXPECT_EQ(axes(""), ScanAxes::z_up);
  EXPECT_EQ(axes("axes = \"z-up\"\n"), ScanAxes::z_up);
  EXPECT_EQ(axes("axes = \"camera\"\n"), ScanAxes::camera);
  EXPECT_EQ(axes("axes = \"opengl\"\n"), ScanAxes::opengl);
  expect_errors({{kScan + "axes = \"y-up\"\n", "3", "z-up"}});
}

TEST(scene_file, what_is_not_supported_yet_says_so) {
  expect_errors({
      {kScan + "depth_scale = 0.001\n", "3", "belongs to depth images"},
      {"[photographs]\nimages = \"a\"\n" + kScan, "1",
       "exactly one of colmap, strecha, bundler, nerfstudio, e57, found none"},
      {"[photographs]\ncolmap = \"a\"\nbundler = \"b\"\n" + kScan, "1", "found colmap, bundler"},
      {"[photographs]\ncolmap = \"a\"\n" + kScan, "1", "expected the key images"},
  });
}

TEST(scene_file, views) {
  const std::string view = "[[view]]\nname = \"v\"\n";
  expect_errors({
      {view, "1", "either photograph or eye and target, found neither"},
      {view + "photograph = \"a\"\neye = [0,0,0]\n", "1", "found both"},
      {view + "photograph = \"a\"\nsize = [1, 1]\n", "4", "the photograph has its own camera"},
      {view + "eye = [0,0,0]\n", "1", "found no target"},
      {view + "eye = [1,2,3]\ntarget = [1,2,3]\n", "1", "coincide"},
      {view + "eye = [0,0,0]\ntarget = [0,0,1]\n", "1", "parallel"},
      {view + "eye = [0,0,0]\ntarget = [0,1,0]\nfov_deg = 180\n", "1", "fov_deg"},
      {view + "eye = [0,0,0]\ntarget = [0,1,0]\nfov_deg = nan\n", "5", "finite"},
      {view + "eye = [0,0,0]\ntarget = [0,1,0]\nsize = [0, 9]\n", "5", "from 1 to 32768 pixels, found 0 x 9"},
      {view + "photograph = \"a\"\nprojection = \"equirectangular\"\n", "4", "has its own camera"},
      {view + "eye = [0,0,0]\ntarget = [0,1,0]\nprojection = \"fisheye\"\n", "5",
       "expected one of perspective"},
      {view + "eye = [0,0,0]\ntarget = [0,1,0]\nprojection = \"equirectangular\"\nfov_deg = 60\n", "6",
       "a panorama shows all directions"},
      {view + "eye = [0,0,0]\ntarget = [0,1,0]\nprojection = \"equirectangular\"\nsize = [100, 60]\n", "1",
       "twice as wide as high"},
      {view + "photograph = \"a\"\nshow = \"all\"\n", "4", "expected one of proxy, scan, both"},
      {view + "photograph = \"a\"\nleave_out = [1]\n", "4", "expected an array of strings"},
  });
}

TEST(scene_file, environment_variable_errors) {
  unsetenv("HYBRID_TEST_UNSET");
  expect_errors({
      {"[[scan]]\nfile = \"${HYBRID_TEST_UNSET}/a.ply\"\n", "2", "variable HYBRID_TEST_UNSET is not set"},
      {"[[scan]]\nfile = \"${HYBRID\"\n", "2", "expected } after ${"},
      {"[[scan]]\nfile = \"${A B}\"\n", "2", "found ${A B}"},
      {"[[scan]]\nfile = \"${HYBRID_TEST_UNSET:-}\"\n", "2", "expected a path that is not empty"},
  });
}

TEST(scene_file, syntax_errors_have_line_and_column) {
  expect_errors({
      {"[scene]\nname = \"a\n", "2:10", "no valid TOML"},
      {"[scene]\nname = \n", "2:8", "no valid TOML"},
      {"[scene]\nname = \"a\"\nname = \"b\"\n", "3:8", "no valid TOML"},
      {"[scene]\nname = \"\xff\"\n", "2:8", "no valid TOML"},
  });
}

TEST(scene_file, default_scan_ids) {
  EXPECT_EQ(default_scan_id("scans/west.ply", 0, 1, {}), "west");
  EXPECT_EQ(default_scan_id("scans/west.e57", 3, 5, {}), "west-3");
  EXPECT_EQ(default_scan_id("other/west.ply", 0, 1, {"west", "west-2"}), "west-3");
  EXPECT_EQ(default_scan_id("/", 0, 1, {}), "scan");
}

}  // namespace
}  // namespace hybrid::io::scene_file_test
