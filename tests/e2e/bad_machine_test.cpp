// The machine fails: no device, a kernel cache that cannot be used, a disk that fills up under each writer,
// output folders that cannot be written. Small file systems are mounted in a namespace of the test's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bad_mini_scene.hpp"
#include "bad_output_check.hpp"
#include "core/error.hpp"
#include "io/output.hpp"
#include "mounts.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

std::string scene_file() {
  return (mini_scene() / "scene.toml").string();
}

std::uintmax_t pages(std::uintmax_t bytes) {
  return (bytes + 4095) / 4096;
}

// What the mini scene gives on a file system of so many pages; its files are copied to `copy`.
// On one thread the writers of a scan's files work in order, so that each meets the full disk in turn.
Outcome run_on_small_disk(std::uintmax_t disk_pages, const fs::path& copy) {
  const Scratch disk;
  const std::string folder = disk.path().string();
  return run_with_mounts(
      fmt::format("mount -t tmpfs -o size={}k none {}\n"
                  "hybrid run {} --threads 1 --quiet --out {}/out\n"
                  "code=$?\n"
                  "cp -a {}/out {}\n"
                  "exit $code\n",
                  4 * disk_pages, folder, scene_file(), folder, folder, copy.string()));
}

// The output that the message names; "" when there is none.
std::string named_output(const std::string& message) {
  std::string longest;
  for (const auto& name : mini_outputs())
    if (message.find("/out/" + name + ":") != std::string::npos && name.size() > longest.size())
      longest = name;
  return longest;
}

std::uintmax_t used_pages(const fs::path& folder) {
  std::uintmax_t used = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) used += pages(entry.file_size());
  return used;
}

}  // namespace

// The disk grows from run to run by what the file that failed lacked, so that each writer in turn meets a
// disk too small by one page.
TEST(BadMachine, a_disk_that_fills_up_under_each_writer) {
  SKIP_WITHOUT_MOUNTS();
  std::set<std::string> failed;
  std::uintmax_t disk = 0;
  for (int round = 0; round < 40; ++round) {
    const Scratch copy;
    // size=0 would be no limit; the first output, timing.json, must fail too.
    const auto outcome = run_on_small_disk(std::max<std::uintmax_t>(disk, 1), copy / "out");
    if (outcome.exit_code == 0) break;
    expect_failure(outcome, 75, {"the disk is full; free space and run again"});
    const std::string name = named_output(outcome.err);
    ASSERT_NE(name, "") << outcome.err;
    failed.insert(name);
    EXPECT_FALSE(fs::exists(copy / "out/summary.json"));
    expect_complete_files(copy / "out");
    const std::uintmax_t need = used_pages(copy / "out") + pages(fs::file_size(mini_result() / name));
    disk = std::max(disk + 1, need);
  }
  std::set<std::string> all;
  for (const auto& name : mini_outputs()) all.insert(name);
  // Those of a page at most that find one: the disk that was made large enough for the temporary of a file
  // that replaces its first version (timing.json, detail.ply) has room left when the next is written.
  for (const char* small : {"timing.json", "report/timing.js"}) {
    all.erase(small);
    failed.erase(small);
  }
  EXPECT_EQ(failed, all);
}

TEST(BadMachine, hybrid_planes_on_a_full_disk) {
  SKIP_WITHOUT_MOUNTS();
  const Scratch disk;
  const std::string folder = disk.path().string();
  const auto outcome = run_with_mounts("mount -t tmpfs -o size=32k none " + folder + "\nhybrid planes " +
                                       (mini_scene() / "s.ply").string() + " --threads 1 --quiet --out " +
                                       folder + "/out; code=$?\n" + "find " + folder +
                                       "/out -name '.*' -o -name summary.json; exit $code\n");
  expect_failure(outcome, 75, {"planes.json", "the disk is full"});
  EXPECT_EQ(outcome.out, "");
}

TEST(BadMachine, a_read_only_output_folder) {
  SKIP_WITHOUT_MOUNTS();
  const Scratch scratch;
  const std::string folder = scratch.path().string();
  const auto outcome = run_with_mounts("mount -t tmpfs -o ro none " + folder + "\nhybrid run " +
                                       scene_file() + " --quiet --out " + folder + "/out\n");
  expect_failure(outcome, 1, {folder + "/out", "writable output folder", "Read-only file system", "--out"});
  const auto itself = run_with_mounts("mount -t tmpfs -o ro none " + folder + "\nhybrid run " + scene_file() +
                                      " --quiet --out " + folder + "\n");
  expect_failure(itself, 1, {folder, "writable output folder", "Read-only file system", "--out"});
}

TEST(BadMachine, an_output_folder_that_is_a_file) {
  const Scratch scratch;
  io::write_text(scratch / "file", "mine");
  for (const char* out : {"file", "file/below"}) {
    const auto outcome = run("hybrid run " + scene_file() + " --quiet --out " + (scratch / out).string());
    expect_failure(outcome, 1, {(scratch / out).string(), "writable output folder", "choose another --out"});
  }
  EXPECT_EQ(io::read_text(scratch / "file"), "mine");
}

// Units whose place is taken fail alone.
TEST(BadMachine, a_file_in_the_place_of_a_folder_and_the_other_way_round) {
  const Scratch scratch;
  io::write_text(scratch / "out/scans/s", "mine");
  fs::create_directories(scratch / "out/views/front.png");
  const auto outcome = run("hybrid run " + scene_file() + " --quiet --out " + (scratch / "out").string());
  expect_failure(outcome, 3,
                 {"scan s: ", "out/scans/s: expected a writable output folder",
                  "view front: ", "front.png: cannot write: Is a directory"});
  EXPECT_TRUE(fs::exists(scratch / "out/views/left-out.png"));
  EXPECT_NE(io::read_text(scratch / "out/summary.json").find("\"unit\": \"view front\""), std::string::npos);
  EXPECT_EQ(io::read_text(scratch / "out/scans/s"), "mine");
}

TEST(BadMachine, the_output_folder_of_something_else) {
  const Scratch scratch;
  const auto run_into = [&](const std::string& more) {
    return run("hybrid run " + scene_file() + " --quiet --out " + (scratch / "out").string() + more);
  };
  for (const auto& [text, found] : std::vector<std::pair<std::string, std::string>>{
           {"{\"scene\": \"cathedral\"}", "holds the results of scene 'cathedral', not of scene 'mini'"},
           {"{\"scans\": []}", "holds the results of single scans (hybrid planes), not of scene 'mini'"},
           {"{\"scene\": 3}", "summary.json: expected a file of an earlier run, found something else"},
           {"[1, 2]", "summary.json: expected a file of an earlier run, found something else"},
           {"no JSON", "summary.json: expected a file of an earlier run, found something else"},
           {"", "summary.json: expected a file of an earlier run, found something else"}}) {
    SCOPED_TRACE(text);
    io::write_text(scratch / "out/summary.json", text);
    expect_failure(run_into(""), 4, {found, "choose another --out", "--force"});
    EXPECT_EQ(run_into(" --dry-run").exit_code, 4);
    EXPECT_EQ(io::read_text(scratch / "out/summary.json"), text);
  }
  EXPECT_EQ(run_into(" --force --only planes").exit_code, 0);
  EXPECT_EQ(run_into(" --only planes").exit_code, 0) << "its own folder";
  const auto planes = run("hybrid planes " + (mini_scene() / "s.ply").string() + " --quiet --out " +
                          (scratch / "out").string());
  expect_failure(planes, 4, {"holds the results of scene 'mini', not of single scans", "--force"});
}

TEST(BadMachine, no_device) {
  const Scratch scratch;
  for (const std::string& command :
       {"run " + scene_file() + " --out " + (scratch / "out").string(),
        "planes " + (mini_scene() / "s.ply").string() + " --out " + (scratch / "out").string(),
        std::string("devices")}) {
    const auto outcome = run("OCL_ICD_VENDORS=" + scratch.path().string() + " hybrid " + command);
    expect_failure(outcome, 5, {"no OpenCL device found", "pocl-opencl-icd"});
    EXPECT_FALSE(fs::exists(scratch / "out"));
  }
}

TEST(BadMachine, the_picture_library_of_another_build) {
  const Scratch scratch;
  const std::string folder = scratch.path().string();
  const auto outcome = run("cp \"$(command -v hybrid)\" " + folder + " && cp " HYBRID_OTHER_PICTURES " " +
                           folder + "/libhybrid_pictures.so && " + folder + "/hybrid render " + scene_file() +
                           " --quiet --out " + folder + "/out");
  expect_failure(outcome, 1, {folder + "/libhybrid_pictures.so", "of another build", "beside the program"});
}

TEST(BadMachine, an_unusable_kernel_cache) {
  const Scratch scratch;
  io::write_text(scratch / "file", "not a folder");
  const std::string command = " hybrid run " + scene_file() + " --quiet --out " + (scratch / "out").string();
  expect_failure(run("POCL_CACHE_DIR=" + (scratch / "file").string() + command), 5,
                 {"POCL_CACHE_DIR", "writable folder"});
  EXPECT_FALSE(fs::exists(scratch / "out"));
  SKIP_WITHOUT_MOUNTS();
  fs::create_directories(scratch / "cache");
  const std::string cache = (scratch / "cache").string();
  expect_failure(
      run_with_mounts("mount -t tmpfs -o ro none " + cache + "\nPOCL_CACHE_DIR=" + cache + command), 5,
      {"POCL_CACHE_DIR", "writable folder", "Read-only file system"});
  EXPECT_FALSE(fs::exists(scratch / "out"));
  expect_failure(
      run_with_mounts("mount -t tmpfs -o size=64k none " + cache + "\nPOCL_CACHE_DIR=" + cache + command), 75,
      {cache, "the OpenCL driver ended the program", "disk is full", "POCL_CACHE_DIR"});
  expect_complete_files(scratch / "out");
}

}  // namespace hybrid::e2e
