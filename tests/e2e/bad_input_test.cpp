// What a user does wrong: one clear error (file, place, expectation, remedy), the exit code of SCENE.md, no
// half-written output.
#include <gtest/gtest.h>

#include <fstream>

#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// A private copy of the tiny room to damage.
fs::path copy_room(const Scratch& scratch) {
  fs::copy(room(), scratch / "room", fs::copy_options::recursive);
  return scratch / "room";
}

void replace(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = io::read_text(file);
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from << " is not in " << file;
  io::write_text(file, text.replace(at, from.size(), to));
}

Outcome run_room(const fs::path& scene_folder, const Scratch& scratch, const std::string& more = "",
                 const std::string& environment = "") {
  return run(environment + " hybrid run " + (scene_folder / "scene.toml").string() + " --out " +
             (scratch / "out").string() + " --quiet " + more);
}

void expect_error(const Outcome& outcome, int code, const std::vector<std::string>& parts) {
  EXPECT_EQ(outcome.exit_code, code) << outcome.err;
  for (const auto& part : parts)
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
}

void expect_no_temporary_files(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    EXPECT_NE(entry.path().filename().string()[0], '.') << entry.path();
}

}  // namespace

TEST(BadInput, a_missing_scene_file) {
  const Scratch scratch;
  expect_error(run("hybrid run /nowhere/scene.toml --out " + (scratch / "out").string()), 4,
               {"/nowhere/scene.toml", "no such file"});
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

TEST(BadInput, an_unknown_key_names_key_and_line) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  replace(folder / "scene.toml", "[scene]", "[scene]\nlevveled = true");
  expect_error(run_room(folder, scratch), 4, {"scene.toml:4", "levveled", "levelled"});
}

TEST(BadInput, an_option_out_of_range_names_key_range_and_value) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  std::ofstream(folder / "scene.toml", std::ios::app) << "\n[planes]\nsquare = 40\n";
  expect_error(run_room(folder, scratch), 4, {"scene.toml:", "square", "3", "16", "40"});
}

TEST(BadInput, a_missing_scan_fails_alone) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  fs::remove(folder / "scans" / "west.ply");
  expect_error(run_room(folder, scratch), 3, {"scan west", "west.ply", "no such file"});
  EXPECT_TRUE(fs::exists(scratch / "out/scans/east/pose.json"));
  EXPECT_FALSE(fs::exists(scratch / "out/scans/west"));
  expect_no_temporary_files(scratch / "out");
}

TEST(BadInput, a_truncated_scan_fails_alone) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  fs::resize_file(folder / "scans" / "east.ply", fs::file_size(folder / "scans" / "east.ply") / 2);
  expect_error(run_room(folder, scratch), 3, {"scan east", "east.ply", "expected"});
  EXPECT_TRUE(fs::exists(scratch / "out/scans/west/pose.json"));
}

TEST(BadInput, a_malformed_header) {
  const Scratch scratch;
  io::write_text(scratch / "scan.ply",
                 "ply\nformat binary_little_endian 1.0\nelement vertex many\nend_header\n");
  expect_error(
      run("hybrid planes " + (scratch / "scan.ply").string() + " --out " + (scratch / "out").string()), 4,
      {"scan.ply", "3", "many"});
}

TEST(BadInput, a_non_finite_pose) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  replace(folder / "scene.toml", "id = \"west\"",
          "id = \"west\"\npose = [1, 0, 0, nan, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]");
  expect_error(run_room(folder, scratch), 4, {"scene.toml:", "pose", "finite"});
}

TEST(BadInput, fewer_than_three_landmarks) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  const std::string text = io::read_text(folder / "scene.toml");
  const auto begin = text.find("landmarks = [");
  const auto end = text.find("]\n", text.find("\n]", begin));
  io::write_text(folder / "scene.toml", text.substr(0, begin) +
                                            "landmarks = [{ scan = [1, 0, 0], model = [0, 0, 0] }]\n" +
                                            text.substr(end + 2));
  expect_error(run_room(folder, scratch), 3, {"scan west", "3", "landmark"});
}

TEST(BadInput, collinear_landmarks) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  const std::string text = io::read_text(folder / "scene.toml");
  const auto begin = text.find("landmarks = [");
  const auto end = text.find("]\n", text.find("\n]", begin));
  io::write_text(
      folder / "scene.toml",
      text.substr(0, begin) +
          "landmarks = [{ scan = [1, 0, 0], model = [1, 0, 0], snap = false }, { scan = [2, 0, 0], model = "
          "[2, 0, 0], snap = false }, { scan = [3, 0, 0], model = [3, 0, 0], snap = false }]\n" +
          text.substr(end + 2));
  expect_error(run_room(folder, scratch), 3, {"scan west", "collinear"});
}

TEST(BadInput, a_landmark_far_from_every_vertex) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  const std::string text = io::read_text(folder / "scene.toml");
  const auto begin = text.find("model = [", text.find("landmarks"));
  const auto end = text.find(']', begin);
  io::write_text(folder / "scene.toml", text.substr(0, begin) + "model = [1.7, 2.9, 1.3" + text.substr(end));
  expect_error(run_room(folder, scratch), 3, {"landmark 1", "vertex", "snap"});
}

TEST(BadInput, a_face_index_out_of_range) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  std::ofstream(folder / "proxy.obj", std::ios::app) << "f 1 2 999\n";
  expect_error(run_room(folder, scratch), 4, {"proxy.obj:", "999"});
}

TEST(BadInput, a_photograph_that_does_not_decode) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  io::write_text(folder / "photographs" / "000.jpg", "not a photograph");
  expect_error(run_room(folder, scratch), 4, {"000.jpg"});
}

TEST(BadInput, a_photograph_of_another_size_than_its_camera) {
  const Scratch scratch;
  const auto folder = copy_room(scratch);
  replace(folder / "cameras" / "cameras.txt", " 320 240 ", " 640 480 ");
  expect_error(run_room(folder, scratch), 4, {".jpg", "320", "640"});
}

TEST(BadInput, no_opencl_device) {
  const Scratch scratch;
  expect_error(run_room(room(), scratch, "", "OCL_ICD_VENDORS=/nonexistent"), 5,
               {"OpenCL", "pocl-opencl-icd"});
}

TEST(BadInput, an_unusable_pocl_cache_folder) {
  const Scratch scratch;
  io::write_text(scratch / "file", "a file, not a folder");
  expect_error(run_room(room(), scratch, "", "POCL_CACHE_DIR=" + (scratch / "file").string()), 5,
               {"POCL_CACHE_DIR", "writable"});
}

TEST(BadInput, the_output_folder_of_another_scene) {
  const Scratch scratch;
  io::write_text(scratch / "out" / "summary.json", "{\"scene\": \"cathedral\"}\n");
  expect_error(run_room(room(), scratch), 4, {"cathedral", "--force"});
}

TEST(BadInput, an_unknown_command_or_option_is_a_usage_error) {
  EXPECT_EQ(run("hybrid fly").exit_code, 2);
  EXPECT_EQ(run("hybrid run --no-such-option").exit_code, 2);
  EXPECT_EQ(run("hybrid planes x.ply --out /tmp/x --square 99").exit_code, 2);
}

TEST(BadInput, folders_that_are_no_scene_are_told) {
  const Scratch scratch;
  fs::create_directories(scratch / "empty");
  expect_error(run("hybrid run " + (scratch / "empty").string() + " --out " + (scratch / "out").string()), 4,
               {(scratch / "empty").string(), "found a folder with neither a scene.toml nor scans ("});
  const std::string scans = (copy_room(scratch) / "scans").string();
  expect_error(run("hybrid run " + scans + " --out " + scans), 4,
               {scans + ": holds the scans themselves", "choose another --out"});
  EXPECT_FALSE(fs::exists(fs::path(scans) / "summary.json"));
  expect_error(run("hybrid run " + scans + " --only render --out " + (scratch / "out").string()), 4,
               {scans, "no [model]", "--only planes,register,report"});
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

}  // namespace hybrid::e2e
