// What goes wrong with hybrid-synth: the exit codes of the house, one clear message, nothing half-written.
#include <gtest/gtest.h>

#include "bad_output_check.hpp"
#include "io/output.hpp"
#include "mounts.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

struct SynthCase {
  const char* name;
  std::string arguments;  // OUT stands for a folder that must not come into being
  int code;
  std::vector<std::string> message;
};

std::vector<SynthCase> synth_cases() {
  const std::string room = "room --out OUT --preset tiny ", church = "church --out OUT --preset tiny ";
  return {
      {"nothing", "", 2, {"subcommand"}},
      {"unknown_scene", "castle --out OUT", 2, {"castle"}},
      {"no_out", "room", 2, {"--out is required"}},
      {"unknown_preset", "room --out OUT --preset huge", 2, {"--preset", "huge", "tiny"}},
      {"seed_text", room + "--seed x", 2, {"--seed", "x"}},
      {"seed_negative", room + "--seed -1", 2, {"--seed", "-1"}},
      {"seed_huge", room + "--seed 99999999999999999999999", 2, {"--seed"}},
      {"noise_out_of_range", room + "--noise-m 5", 2, {"--noise-m", "5"}},
      {"dropout_out_of_range", room + "--dropout 1", 2, {"--dropout", "1"}},
      {"proxy_error_not_finite", room + "--proxy-error-m nan", 2, {"--proxy-error-m", "nan"}},
      {"threads_negative", room + "--threads -1", 2, {"--threads", "-1"}},
      {"only_scan_unknown", room + "--only-scan north", 2, {"--only-scan north", "west, east"}},
      {"unknown_option", room + "--fast", 2, {"--fast"}},
      {"room_has_no_full_preset", "room --out OUT --preset full", 2, {"--preset", "full"}},
      {"church_unknown_preset", "church --out OUT --preset huge", 2, {"--preset", "huge", "demo"}},
      {"church_noise_growth", church + "--noise-per-m 1", 2, {"--noise-per-m", "1"}},
      {"church_proxy_error_negative", church + "--proxy-error -0.01", 2, {"--proxy-error", "-0.01"}},
      {"church_camera_error_text", church + "--camera-error much", 2, {"--camera-error", "much"}},
      {"church_too_many_megapixels", church + "--megapixels 4000", 2, {"--megapixels", "4000"}},
      {"church_variation_not_finite", church + "--photograph-variation inf", 2, {"--photograph-variation"}},
      {"church_unknown_format", church + "--format las", 2, {"--format", "las", "ptx", "exr"}},
      {"archive_without_count", "archive --out OUT", 2, {"scenes"}},
      {"archive_of_none", "archive 0 --out OUT", 2, {"scenes", "0"}},
      {"archive_of_exr_over_the_disk",
       "archive 100000 --preset full --format exr --out OUT",
       75,
       {"needs about", "free", "No space"}},
      {"archive_over_the_disk",
       "archive 100000 --preset full --out OUT",
       75,
       {"needs about", "free", "No space"}},
  };
}

void PrintTo(const SynthCase& row, std::ostream* out) {
  *out << row.name;
}

class BadSynth : public ::testing::TestWithParam<SynthCase> {};

}  // namespace

TEST_P(BadSynth, is_told) {
  const Scratch scratch;
  std::string arguments = GetParam().arguments;
  if (const auto at = arguments.find("OUT"); at != std::string::npos)
    arguments.replace(at, 3, (scratch / "out").string());
  const auto outcome = run("timeout 60 hybrid-synth " + arguments);
  expect_failure(outcome, GetParam().code, GetParam().message);
  EXPECT_EQ(outcome.out, "");
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

INSTANTIATE_TEST_SUITE_P(Options, BadSynth, ::testing::ValuesIn(synth_cases()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(BadSynth, an_output_folder_that_cannot_be) {
  const Scratch scratch;
  io::write_text(scratch / "file", "mine");
  for (const char* out : {"file", "file/below"}) {
    const auto outcome = run("timeout 60 hybrid-synth room --preset tiny --out " + (scratch / out).string());
    expect_failure(outcome, 1, {(scratch / out).string(), "Give another --out"});
  }
  EXPECT_EQ(io::read_text(scratch / "file"), "mine");
}

// What hybrid-synth says on a file system mounted with `options`, and the hidden files it leaves there.
Outcome make_room_on(const std::string& options) {
  const Scratch disk;
  const std::string folder = disk.path().string();
  return run_with_mounts("mount -t tmpfs -o " + options + " none " + folder +
                         "\ntimeout 60 hybrid-synth room --preset tiny --quiet --out " + folder +
                         "/out\ncode=$?\nfind " + folder + " -name \".*\"\nexit $code\n");
}

TEST(BadSynth, a_disk_too_small_for_the_scene) {
  SKIP_WITHOUT_MOUNTS();
  const auto outcome = make_room_on("size=200k");
  expect_failure(outcome, 75, {"/out", "needs about", "No space left on device; free space and run again"});
  EXPECT_EQ(outcome.out, "");
}

// Room for the bytes, not for so many files: the space check passes and a writer fails.
TEST(BadSynth, a_disk_that_fills_up_while_writing) {
  SKIP_WITHOUT_MOUNTS();
  const auto outcome = make_room_on("size=64m,nr_inodes=9");
  expect_failure(outcome, 75,
                 {"writing ", "cameras/cameras.txt: No space left on device; free space and run again"});
  EXPECT_EQ(outcome.out, "");
}

}  // namespace hybrid::e2e
