// Everything that can be wrong with a scene file, through the program: one clear error that names file, line,
// key, expectation and remedy; exit code 4, or 3 when a unit fails alone; nothing half-written. tests/io
// checks the reader's messages one by one.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "bad_mini_scene.hpp"
#include "bad_output_check.hpp"
#include "io/output.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

struct SceneCase {
  const char* name;
  std::function<void(const fs::path& folder)> change;  // of a copy of the mini scene
  int code;
  std::vector<std::string> message;
  bool in_headers = true;  // --dry-run tells it, too; of failures of single units (3) it is not asked
};

using Change = std::function<void(const fs::path&)>;

// Replaces `from` in the scene file.
Change instead(const std::string& from, const std::string& to) {
  return [=](const fs::path& folder) {
    std::string text = mini_scene_text();
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    io::write_text(folder / "scene.toml", text.replace(at, from.size(), to));
  };
}

Change appended(const std::string& more) {
  return [=](const fs::path& folder) { io::write_text(folder / "scene.toml", mini_scene_text() + more); };
}

Change text(const std::string& whole) {
  return [=](const fs::path& folder) { io::write_text(folder / "scene.toml", whole); };
}

Change with_faces(const std::string& more) {
  return [=](const fs::path& folder) {
    io::write_text(folder / "proxy.obj", io::read_text(folder / "proxy.obj") + more);
  };
}

std::string utf16(const std::string& text) {
  std::string wide = "\xff\xfe";
  for (char c : text) wide += {c, '\0'};
  return wide;
}

std::vector<SceneCase> scene_cases() {
  return {
      // Not a scene file at all.
      {"missing",
       [](const fs::path& folder) { fs::remove(folder / "scene.toml"); },
       4,
       {"scene.toml: no such file", "check the path"}},
      {"folder",
       [](const fs::path& folder) {
         fs::remove(folder / "scene.toml");
         fs::create_directory(folder / "scene.toml");
       },
       4,
       {"scene.toml: expected a scene file, found a folder with neither a scene.toml nor scans"}},
      {"pipe",
       [](const fs::path& folder) {
         fs::remove(folder / "scene.toml");
         mkfifo((folder / "scene.toml").c_str(), 0600);
       },
       4,
       {"scene.toml: expected a regular file, found a pipe"}},
      {"link_to_itself",
       [](const fs::path& folder) {
         fs::remove(folder / "scene.toml");
         fs::create_symlink("scene.toml", folder / "scene.toml");
       },
       4,
       {"scene.toml: cannot be found (Too many levels of symbolic links)"}},
      {"empty", text(""), 4, {"scene.toml:1: expected at least one [[scan]] or a [model], found neither"}},
      {"utf16", text(utf16(mini_scene_text())), 4, {"scene.toml:1: expected UTF-8", "found UTF-16", "save"}},
      {"binary", text(std::string("[scene]\n\0", 9)), 4, {"scene.toml:2: ", "zero byte"}},
      {"no_utf8", instead("mini", "m\xe4ni"), 4, {"scene.toml:2:", "no valid TOML"}},
      {"syntax", instead("[model]", "[model"), 4, {"scene.toml:11:", "no valid TOML"}},
      {"deeply_nested", text("a = " + std::string(20000, '[')), 4, {"scene.toml:1:", "no valid TOML"}},
      {"key_twice",
       instead("name = \"mini\"", "name = \"mini\"\nname = \"maxi\""),
       4,
       {"scene.toml:3:", "name"}},
      {"json", text("{\"scene\": {\"name\": \"mini\"}}"), 4, {"scene.toml:1:", "no valid TOML"}},

      // Keys, types, ranges.
      {"unknown_key",
       instead("levelled", "leveled"),
       4,
       {"scene.toml:3: [scene]: unknown key \"leveled\"", "did you mean \"levelled\"?"}},
      {"unknown_table", instead("[model]", "[modell]"), 4, {"scene.toml:11: ", "did you mean \"model\"?"}},
      {"unknown_option",
       appended("[planes]\nsqare = 5\n"),
       4,
       {"scene.toml:29: [planes]", "unknown key \"sqare\"", "did you mean \"square\"?"}},
      {"wrong_type",
       instead("levelled = true", "levelled = 1"),
       4,
       {"scene.toml:3: [scene]: levelled: expected true or false, found 1"}},
      {"wrong_option_type",
       appended("[render]\nblend = 2\n"),
       4,
       {"scene.toml:29: [render]", "blend", "string"}},
      {"table_for_tables", instead("[[scan]]", "[scan]"), 4, {"scene.toml:6: ", "expected tables [[scan]]"}},
      {"option_out_of_range",
       appended("[planes]\nsquare = 40\n"),
       4,
       {"scene.toml:29: [planes]", "square", "from 3 to 16", "found 40"}},
      {"fov_out_of_range", instead("size = [32, 24]", "fov_deg = 200"), 4, {"scene.toml:", "fov_deg", "200"}},
      {"size_out_of_range",
       instead("[32, 24]", "[32, 100000]"),
       4,
       {"scene.toml:22: [[view]] 1: size", "from 1 to 32768", "100000"}},
      {"size_negative", instead("[32, 24]", "[-32, 24]"), 4, {"scene.toml:22: ", "found -32"}},
      {"not_finite", instead("[2, 0.5, 1.2]", "[2, nan, 1.2]"), 4, {"scene.toml:20: ", "finite", "nan"}},
      {"mirrored_pose", instead("0, 0, 1, 1.2", "0, 0, -1, 1.2"), 4, {"scene.toml:9: ", "mirrored"}},
      // Edits.
      {"openings_wrong",
       appended("[edit]\nopenings = \"maybe\"\n"),
       4,
       {"scene.toml:29: [edit]", "openings", "off, report, cut"}},
      {"edit_unknown_key",
       appended("[edit]\nopening = \"off\"\n"),
       4,
       {"scene.toml:29: [edit]", "did you mean \"openings\"?"}},
      {"removed_face_is_not_there",
       appended("[edit]\nremove_faces = [\"face-9\"]\n"),
       4,
       {"scene.toml:29: [edit]: remove_faces", "face-9", "face-0"}},
      {"removed_index_too_large",
       appended("[edit]\nremove_faces = [6]\n"),
       4,
       {"scene.toml:29: [edit]: remove_faces", "face 6: the model has 6 faces"}},
      {"no_face_left",
       appended("[edit]\nremove_faces = [0, 1, 2, 3, 4, 5]\n"),
       4,
       {"scene.toml:29: [edit]: remove_faces", "expected a face to remain"}},
      {"hole_meets_itself",
       appended("[[edit.holes]]\nface = 0\npolygon = [[1, 1], [2, 2], [2, 1], [1, 2]]\n"),
       4,
       {"scene.toml:28: [edit]: holes 1", "meets itself"}},
      {"hole_outside",
       appended("[[edit.holes]]\nface = \"face-0\"\npolygon = [[1, 1], [9, 1], [1, 2]]\n"),
       4,
       {"scene.toml:28: [edit]: holes 1", "outside face face-0"}},
      {"hole_off_the_plane",
       appended("[[edit.holes]]\nface = 0\nworld = [[1, 1, 1], [2, 1, 1], [1, 2, 1]]\n"),
       4,
       {"scene.toml:28: [edit]: holes 1", "of the face's plane"}},
      {"holes_overlap",
       appended("[[edit.holes]]\nface = 0\npolygon = [[1, 1], [2, 1], [1, 2]]\n[[edit.holes]]\nface = 0\n"
                "polygon = [[1.1, 1.1], [2, 1.1], [1, 2.1]]\n"),
       4,
       {"scene.toml:31: [edit]: holes 2", "overlaps hole 1"}},
      {"hole_without_polygon",
       appended("[[edit.holes]]\nface = 0\n"),
       4,
       {"scene.toml:28: [[edit.holes]] 1", "neither"}},
      {"clip_of_no_scan",
       appended("[[edit.clip]]\nscan = \"t\"\nbox = [0, 0, 0, 1, 1, 1]\n"),
       4,
       {"scene.toml:28: [edit]: clip", "\"t\"", "s"}},
      {"clip_box_turned",
       appended("[[edit.clip]]\nbox = [1, 0, 0, 0, 1, 1]\n"),
       4,
       {"scene.toml:29: [[edit.clip]] 1: box"}},
      {"clip_of_two_shapes",
       appended("[[edit.clip]]\nbox = [0, 0, 0, 1, 1, 1]\nplane = [0, 0, 1, 2]\n"),
       4,
       {"scene.toml:28: [[edit.clip]] 1: expected one of box, plane and prism, found several"}},
      {"depth_edit_of_no_scan",
       appended("[[edit.depth]]\nscan = \"t\"\npolygon = [[0, 0], [0, 5], [5, 5]]\nby_m = 0.1\n"),
       4,
       {"scene.toml:28: [edit]: depth", "\"t\"", "s"}},
      {"depth_edit_outside",
       appended("[[edit.depth]]\nscan = \"s\"\npolygon = [[0, 0], [0, 500], [5, 5]]\nby_m = 0.1\n"),
       4,
       {"scan s", "scene.toml:28: [edit]: depth", "[0, 500]: outside the range image"},
       false},

      // Empty tables.
      {"empty_scan", appended("[[scan]]\n"), 4, {"scene.toml:28: [[scan]] 2: expected the key file"}},
      {"empty_view", appended("[[view]]\n"), 4, {"scene.toml:28: [[view]] 3: expected the key name"}},
      {"empty_model",
       instead("file = \"proxy.obj\"", ""),
       4,
       {"scene.toml:11: [model]: expected the key file"}},
      {"empty_photographs",
       instead("colmap = \"cameras\"\nimages = \"images\"", ""),
       4,
       {"scene.toml:14: [photographs]: expected exactly one of colmap"}},
      {"empty_options", appended("[planes]\n[register]\n[edit]\n[render]\n"), 0, {}},

      // Names.
      {"scan_id_twice",
       appended("[[scan]]\nid = \"s\"\nfile = \"s.ply\"\n"),
       4,
       {"scene.toml:29: [[scan]] 2: id", "found \"s\" again (line 7)"}},
      {"view_name_twice",
       instead("\"left-out\"", "\"front\""),
       4,
       {"scene.toml:25: [[view]] 2: name", "found \"front\" again (line 19)"}},
      {"view_name_with_slash", instead("\"front\"", "\"a/front\""), 4, {"scene.toml:19: ", "no slashes"}},
      {"view_name_that_escapes",
       instead("\"front\"", "\"../../front\""),
       4,
       {"scene.toml:19: ", "no slashes"}},
      {"scan_id_that_escapes",
       instead("id = \"s\"", "id = \"..\""),
       4,
       {"scene.toml:7: ", "usable as a folder"}},
      {"scan_id_with_backslash", instead("id = \"s\"", "id = 's\\t'"), 4, {"scene.toml:7: ", "no slashes"}},
      {"scan_id_with_line_end",
       instead("id = \"s\"", "id = \"s\\n\""),
       4,
       {"scene.toml:7: ", "control char"}},
      {"scan_id_too_long",
       instead("id = \"s\"", "id = \"" + std::string(300, 's') + "\""),
       4,
       {"scene.toml:7: ", "1 to 200 bytes"}},

      // Poses and landmarks.
      {"pose_and_landmarks",
       instead(kPose, kPose + "\nlandmarks = [{ scan = [1, 0, 0], vertex = 1 }]"),
       4,
       {"scene.toml:9: [[scan]] 1: pose", "either a pose or landmarks", "found both; remove one"}},
      {"fixed_without_pose", instead(kPose, "fixed = true"), 4, {"scene.toml:9: ", "fixed", "found none"}},
      {"neither_pose_nor_landmarks", instead(kPose, ""), 3, {"scan s: no landmarks and no pose", "give"}},
      {"landmark_without_partner",
       instead(kPose, "landmarks = [{ scan = [1, 0, 0] }]"),
       4,
       {"scene.toml:9: ", "model = [x, y, z] and vertex = index, found neither"}},
      {"landmark_vertex_out_of_range",
       instead(kPose, "landmarks = [{ scan = [1, 0, 0], vertex = 99 }]"),
       3,
       {"scan s: landmark 1 (line 9): vertex 99: the model has 8 vertices"}},
      {"landmark_pixel_out_of_range",
       instead(kPose, "landmarks = [{ pixel = [1, 99999], vertex = 1 }]"),
       3,
       {"scan s: landmark 1 (line 9): pixel [1, 99999]: outside the range image"}},

      {"nan_pose",
       instead("1.61, 0, 1", "nan, 0, 1"),
       4,
       {"scene.toml:9: ", "pose: expected 16 finite numbers"}},
      {"model_in_millimetres",
       [](const fs::path& folder) {
         io::write_text(folder / "proxy.obj",
                        "v 0 0 0\nv 4000 0 0\nv 0 3000 0\nv 4000 3000 0\nv 0 0 2500\nv 4000 0 2500\n"
                        "v 0 3000 2500\nv 4000 3000 2500\n"
                        "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n");
       },
       3,
       {"scan s: registration: from its start no plane", "the model is 5590 m across", "unit in [model]"}},

      {"face_that_crosses_itself",
       with_faces("v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 9 10 11 12\n"),
       4,
       {"proxy.obj:19: face face-6: expected a simple outline"}},
      {"scan_without_returns",
       [](const fs::path& folder) {
         std::string ptx = "3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
         for (int i = 0; i < 12; ++i) ptx += "0 0 0 0.5\n";
         io::write_text(folder / "s.ptx", ptx);
         instead("\"s.ply\"", "\"s.ptx\"")(folder);
       },
       4,
       {"scan s: ", "s.ptx: expected returns, found none in a grid of 4 x 3; export the scan again"},
       false},

      // Files that the scene names: absent, of another kind, in circles.
      {"scan_missing", instead("\"s.ply\"", "\"t.ply\""), 4, {"scan s: ", "t.ply: no such file"}},
      {"scan_is_the_scene", instead("\"s.ply\"", "\"scene.toml\""), 4, {"scan s: ", "expected a scan as"}},
      {"scan_is_a_folder", instead("\"s.ply\"", "\"images\""), 4, {"scan s: ", "images: "}},
      {"scan_index",
       instead("file = \"s.ply\"", "file = \"s.ply\"\nindex = 3"),
       4,
       {"scan s: ", "index 3: the file holds 1 scans (0-based)"}},
      {"model_missing", instead("\"proxy.obj\"", "\"none.obj\""), 4, {"none.obj: no such file"}},
      {"model_is_the_scene", instead("\"proxy.obj\"", "\"scene.toml\""), 4, {"scene.toml:"}},
      {"model_is_a_folder", instead("\"proxy.obj\"", "\".\""), 4, {"found a folder"}},
      {"cameras_missing", instead("\"cameras\"", "\"none\""), 4, {"none"}},
      {"cameras_are_a_file", instead("\"cameras\"", "\"proxy.obj\""), 4, {"proxy.obj"}},
      {"images_missing",
       instead("images = \"images\"", "images = \"none\""),
       4,
       {"none/0.png: no such file"}},
      {"truth_missing", instead("levelled = true", "truth = \"none.json\""), 4, {"none.json: no such file"}},
      {"truth_is_the_scene",
       instead("levelled = true", "truth = \"scene.toml\""),
       4,
       {"scene.toml: expected the truth of a synthetic scene"}},
      {"view_photograph_unknown",
       instead("photograph = \"0.png\"", "photograph = \"9.png\""),
       3,
       {"view left-out: ", "photograph '9.png'"}},
      {"view_leaves_out_unknown",
       instead("leave_out = [\"0.png\"]", "leave_out = [\"9.png\"]"),
       3,
       {"view left-out: ", "leave_out", "\"9.png\""}},
      {"undefined_variable",
       instead("\"s.ply\"", "\"${HYBRID_TEST_UNSET}/s.ply\""),
       4,
       {"scene.toml:8: [[scan]] 1: file: the environment variable HYBRID_TEST_UNSET is not set",
        "${HYBRID_TEST_UNSET:-default}"}},
      {"no_model",
       instead("[model]\nfile = \"proxy.obj\"", ""),
       4,
       {"scene.toml: no [model]", "--only planes"}},

      // Odd but right.
      {"byte_order_mark", text("\xef\xbb\xbf" + mini_scene_text()), 0, {}},
      {"carriage_returns",
       [](const fs::path& folder) {
         std::string lines;
         for (char c : mini_scene_text()) lines += c == '\n' ? "\r\n" : std::string(1, c);
         io::write_text(folder / "scene.toml", lines);
       },
       0,
       {}},
      {"tabs", instead("levelled = true", "\tlevelled\t=\ttrue\t"), 0, {}},
      {"default_variable", instead("\"s.ply\"", "\"${HYBRID_TEST_UNSET:-.}/s.ply\""), 0, {}},
      {"names_of_all_kinds", instead("id = \"s\"", "id = \"S \xc3\xbc #1 100% <&>\""), 0, {}},
  };
}

void PrintTo(const SceneCase& row, std::ostream* out) {
  *out << row.name;
}

class BadScene : public ::testing::TestWithParam<SceneCase> {};

}  // namespace

// Every folder has a blank and a letter outside ASCII in its name.
TEST_P(BadScene, is_told) {
  const Scratch scratch;
  const fs::path folder = scratch / "sc\xc3\xa8ne 1", out = scratch / "r\xc3\xa9sultat 1";
  fs::copy(mini_scene(), folder, fs::copy_options::recursive);
  GetParam().change(folder);
  const std::string command = "timeout 60 hybrid run '" + (folder / "scene.toml").string() +
                              "' --quiet --out '" + out.string() + "' --only planes,register,render";
  const auto tried = run(command + " --dry-run");
  EXPECT_FALSE(fs::exists(out));
  if (GetParam().code != 3 && GetParam().in_headers)
    expect_failure(tried, GetParam().code, GetParam().message);
  const auto outcome = run(command);
  expect_failure(outcome, GetParam().code, GetParam().message);
  EXPECT_EQ(GetParam().code == 0, outcome.err.empty()) << outcome.err;
  // Either the inputs were refused and nothing was begun, or the run went to its end.
  EXPECT_EQ(fs::exists(out), fs::exists(out / "summary.json"));
  std::error_code absent;
  for (const auto& entry : fs::recursive_directory_iterator(out, absent)) {
    EXPECT_NE(entry.path().filename().string()[0], '.') << entry.path();
  }
  for (const auto& entry : fs::directory_iterator(scratch.path()))
    EXPECT_TRUE(entry.path() == folder || entry.path() == out) << "written elsewhere: " << entry.path();
}

INSTANTIATE_TEST_SUITE_P(Table, BadScene, ::testing::ValuesIn(scene_cases()),
                         [](const auto& row) { return std::string(row.param.name); });

// A file name may give a scan the id that the scene file gives another.
TEST(BadScene, ids_from_file_names_avoid_the_given_ones) {
  const Scratch scratch;
  fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene/scene.toml",
                 "[[scan]]\nfile = \"s.ply\"\n[[scan]]\nid = \"s\"\nfile = \"s.ply\"\n");
  const auto outcome = run("hybrid run " + (scratch / "scene/scene.toml").string() + " --quiet --out " +
                           (scratch / "out").string() + " --only planes");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(scratch / "out/scans/s/planes.json"));
  EXPECT_TRUE(fs::exists(scratch / "out/scans/s-2/planes.json"));
}

// Photographs are neither read nor asked for where nothing is drawn of them.
TEST(BadScene, planes_and_poses_need_no_photographs) {
  const Scratch scratch;
  fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene/images/0.png", "no picture");
  const std::string command = "hybrid run " + (scratch / "scene/scene.toml").string() + " --quiet --out " +
                              (scratch / "out").string() + " --only planes,register";
  EXPECT_EQ(run(command).exit_code, 0);
  expect_failure(run(command + ",render"), 4, {"images/0.png: is no picture that can be read"});
}

TEST(BadScene, landmarks_of_a_file_of_several_scans_need_an_index) {
  const Scratch scratch;
  fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene/two.ptx",
                 "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n"
                 "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 4 0.5\n");
  std::string text = mini_scene_text();
  text.replace(text.find("[[scan]]"), text.find("[model]") - text.find("[[scan]]"),
               "[[scan]]\nid = \"two\"\nfile = \"two.ptx\"\nlandmarks = [\n"
               "{ scan = [0, 0, 0], model = [0, 0, 0] },\n{ scan = [4, 0, 0], model = [4, 0, 0] },\n"
               "{ scan = [0, 3, 0], model = [0, 3, 0] }]\n\n");
  io::write_text(scratch / "scene/scene.toml", text);
  expect_failure(run("hybrid run " + (scratch / "scene/scene.toml").string() + " --quiet --out " +
                     (scratch / "out").string() + " --only planes,register"),
                 4,
                 {"scene.toml:", "expected the landmarks of one scan, found 2 scans in two.ptx", "`index`"});
}

// Latin-1 names, of a folder, a group of the model and the results, with a question mark: the bytes are the
// file system's; in JSON what is no UTF-8 becomes U+FFFD.
TEST(BadScene, names_need_not_be_utf8) {
  const Scratch scratch;
  const fs::path folder = scratch / "sc\xe4ne?", out = scratch / "r\xe9sultat why?";
  fs::copy(mini_scene(), folder, fs::copy_options::recursive);
  std::string model = io::read_text(folder / "proxy.obj");
  io::write_text(folder / "proxy.obj", model.insert(model.find("f "), "g W\xe4nde\n"));
  const auto outcome = run("timeout 60 hybrid run '" + (folder / "scene.toml").string() +
                           "' --quiet --json --out '" + out.string() + "'");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(out / "report" / "index.html") || fs::exists(out / "report.html"));
  const std::string summary = io::read_text(out / "summary.json");
  EXPECT_TRUE(nlohmann::json::accept(summary));
  EXPECT_TRUE(nlohmann::json::accept(outcome.out));
  EXPECT_NE(summary.find("W\xef\xbf\xbdnde"), std::string::npos);
}

TEST(BadScene, truth_of_another_file_scores_nothing) {
  const Scratch scratch;
  fs::copy(room(), scratch / "room", fs::copy_options::recursive);
  std::string truth = io::read_text(scratch / "room/truth.json");
  for (const auto& [from, to] : {std::pair{"\"west\"", "\"none\""}, {"\"east\"", "\"west\""}})
    for (std::size_t at = truth.find(from); at != std::string::npos; at = truth.find(from, at + 1))
      truth.replace(at, std::strlen(from), to);
  io::write_text(scratch / "room/truth.json", truth);
  const auto outcome = run("hybrid run " + (scratch / "room/scene.toml").string() + " --quiet --out " +
                           (scratch / "out").string() + " --only planes");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("truth.json: scan west: expected the truth of"), std::string::npos)
      << outcome.err;
  const auto summary = nlohmann::json::parse(io::read_text(scratch / "out/summary.json"));
  for (const auto& scan : summary.at("scans")) EXPECT_FALSE(scan.contains("truth"));
}

// A mesh has slivers: they do not end a night.
TEST(BadScene, faces_without_area_are_left_out) {
  const Scratch scratch;
  fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  with_faces("v 1 1 1\nv 2 2 2\nv 3 3 3\ng sliver\nf 9 10 11\n")(scratch / "scene");
  const auto outcome = run("hybrid register " + (scratch / "scene/scene.toml").string() + " --quiet --out " +
                           (scratch / "out").string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("proxy.obj: 1 of 7 faces have no area and are left out (line 19, face sliver: 3 "
                             "vertices on one point or line)"),
            std::string::npos)
      << outcome.err;
}

}  // namespace hybrid::e2e
