#include "batch/output_folder.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "io/files.hpp"
#include "io/output.hpp"

namespace hybrid::batch {
namespace {
namespace fs = std::filesystem;
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

std::string begin(const fs::path& out, const std::vector<fs::path>& inputs) {
  return error_of(ErrorKind::input, [&] { const OutputFolder folder(out, "church", inputs); });
}

}  // namespace

TEST(OutputFolder, a_second_run_into_it_is_told_to_wait_and_goes_on_after_the_first) {
  const TemporaryFolder scratch;
  const fs::path out = scratch.path() / "out";
  {
    const OutputFolder first(out, "church", {});
    EXPECT_TRUE(holds(error_of(ErrorKind::temporary, [&] { const OutputFolder second(out, "church", {}); }),
                      "another run is writing into it; wait"));
  }
  EXPECT_NO_THROW(OutputFolder(out, "church", {}));
}

// Inputs beside the folders of scans are the layout of many a scene; below them they would be written over.
TEST(OutputFolder, inputs_where_results_are_written_are_refused_before_anything_is_touched) {
  const TemporaryFolder scratch;
  const fs::path out = scratch.path() / "out";
  for (const char* name : {"scans/west/range.exr", "views/both.png", "summary.json", "report/a/b.jpg"}) {
    fs::create_directories((out / name).parent_path());
    io::write_text(out / name, "input");
    EXPECT_TRUE(
        holds(begin(out, {scratch.path() / "scene.toml", scratch.path() / "out/../out" / name}), name));
    EXPECT_EQ(io::read_text(out / name), "input");
    EXPECT_FALSE(fs::exists(out / "timing.json"));
  }
  io::write_text(out / "scans/west.ptx", "input");
  EXPECT_NO_THROW(
      OutputFolder(out, "church", {out / "scans/west.ptx", out / "scene.toml", out / "images/a.png"}));
}

// Many scenes bear one name: a second one's file tells it from the first, which may have been moved since.
TEST(OutputFolder, another_scene_of_the_same_name_is_another) {
  const TemporaryFolder scratch;
  const fs::path out = scratch.path() / "out", abbey = scratch.path() / "abbey.toml",
                 chapel = scratch.path() / "chapel.toml";
  for (const fs::path& file : {abbey, chapel}) io::write_text(file, "[scene]\n");
  { const OutputFolder folder(out, "church", {abbey}); }
  const auto check = [&](const fs::path& scene_file, bool force) {
    return error_of(ErrorKind::input, [&] { check_output_folder(out, "church", scene_file, force); });
  };
  EXPECT_TRUE(
      holds(check(chapel, false), "holds the results of " + abbey.string() + ", not of " + chapel.string()));
  EXPECT_TRUE(holds(check(chapel, false), "choose another --out or add --force"));
  EXPECT_NO_THROW(check_output_folder(out, "church", chapel, true));
  EXPECT_NO_THROW(check_output_folder(out, "church", scratch.path() / "out/../abbey.toml", false));
  fs::rename(abbey, scratch.path() / "moved.toml");
  EXPECT_NO_THROW(check_output_folder(out, "church", scratch.path() / "moved.toml", false));
}

TEST(OutputFolder, what_an_earlier_run_left_is_named) {
  const TemporaryFolder scratch;
  const fs::path out = scratch.path() / "out";
  for (const char* name : {"scans/west/colour.exr", "views/old.png", "mine.txt"}) {
    fs::create_directories((out / name).parent_path());
    io::write_text(out / name, "of the night before");
    fs::last_write_time(out / name, fs::file_time_type::clock::now() - std::chrono::hours(24));
  }
  const OutputFolder folder(out, "church", {});
  fs::create_directories(out / "scans/west");
  io::write_text(out / "scans/west/range.exr", "of this run");
  ::testing::internal::CaptureStderr();
  folder.warn_of_leftovers();
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_TRUE(holds(said, "scans/west/colour.exr, views/old.png: left from an earlier run")) << said;
  EXPECT_EQ(said.find("range.exr"), std::string::npos);
}

}  // namespace hybrid::batch
