// What goes wrong with hybrid-synth: the exit codes of the house, one clear message, nothing half-written.
#include <gtest/gtest.h>

#include "bad_output_check.hpp"
#include "io/output.hpp"

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
  const std::string room = "room --out OUT --preset tiny ";
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
      {"unknown_option", room + "--fast", 2, {"--fast"}},
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

}  // namespace hybrid::e2e
