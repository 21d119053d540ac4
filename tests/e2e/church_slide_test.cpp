// The front of a small church is one wall before a yard: its proxy leaves the scan free to slide along it,
// and what the scans inside see of it through the door says where it is.
#include <gtest/gtest.h>

#include <string>

#include "program.hpp"

namespace hybrid::e2e {
namespace {

struct SlidingChurch {
  Scratch scratch;
  Outcome outcome;

  SlidingChurch(int seed, const std::string& options) {
    const auto scene = scratch / "church";
    EXPECT_EQ(run("hybrid-synth church --preset tiny --quiet --seed " + std::to_string(seed) + " --out " +
                  scene.string())
                  .exit_code,
              0);
    outcome = run("hybrid run " + (scene / "scene.toml").string() + " --only planes,register --quiet --out " +
                  out().string() + " " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  std::filesystem::path out() const { return scratch / "out"; }
  nlohmann::json front() const { return json_of(out() / "scans/front/pose.json"); }
  double front_error_mm() const {
    const auto summary = json_of(out() / "summary.json");
    for (const auto& scan : summary["scans"])
      if (scan["id"] == "front") return scan["truth"]["pose_error_mm"];
    return NAN;
  }
};

const std::string kSlides = "the model leaves the pose undetermined: it is free to slide along (1.00, 0.00";

}  // namespace

TEST(ChurchSlide, a_front_that_slides_is_held_through_the_door) {
  const SlidingChurch church(4, "");
  const auto front = church.front();
  EXPECT_EQ(front["degenerate"].size(), 1u);
  EXPECT_FALSE(front.contains("warnings")) << front["warnings"];
  EXPECT_EQ(front["slide"]["status"], "accepted");
  EXPECT_NEAR(front["slide"]["shift_m"], 0.0051, 0.001);  // its landmarks are so far off along the wall
  EXPECT_EQ(front["slide"]["scans"].size(), 2u);
  EXPECT_NE(church.outcome.out.find("  free to slide along (1.00, 0.00, 0.00): other scans hold it, 5."),
            std::string::npos)
      << church.outcome.out;
  EXPECT_LT(church.front_error_mm(), 1);  // measured 0.45
}

TEST(ChurchSlide, without_joint_refinement_it_stays_and_is_told) {
  const SlidingChurch church(4, "--set register.joint=false");
  EXPECT_FALSE(church.front().contains("slide"));
  EXPECT_NE(church.front()["warnings"][0].get<std::string>().find(kSlides), std::string::npos);
}

TEST(ChurchSlide, where_the_others_do_not_tell_it_is_said_why) {
  const SlidingChurch church(12, "");
  const auto front = church.front();
  EXPECT_EQ(front["slide"]["status"], "abstained");
  EXPECT_NE(church.outcome.out.find(": no other scan holds it there"), std::string::npos)
      << church.outcome.out;
  EXPECT_NE(front["slide"]["reason"].get<std::string>().find("another place along it fits"),
            std::string::npos);
  const auto warning = front["warnings"][0].get<std::string>();
  EXPECT_NE(warning.find(kSlides), std::string::npos) << warning;
  EXPECT_NE(warning.find("(their samples do not: another place along it fits"), std::string::npos) << warning;
}

}  // namespace hybrid::e2e
