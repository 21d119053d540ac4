// Starts that are wrong, through the program: no confident wrong pose, and words that say whom to blame. The
// mini scene's room is symmetric, so that the planes alone cannot place its scan.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bad_mini_scene.hpp"
#include "bad_output_check.hpp"
#include "geometry/pose.hpp"
#include "io/output.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// The mini scene's scan with another start, registered.
class BadRegistration : public ::testing::Test {
 protected:
  Outcome register_from(const std::string& start, const std::string& options = "") {
    fs::copy(mini_scene(), scratch_ / "scene", fs::copy_options::recursive);
    std::string text = mini_scene_text();
    text.replace(text.find(kPose), kPose.size(), start);
    if (!model_) text = text.substr(0, text.find("[model]"));
    io::write_text(scratch_ / "scene/scene.toml", text);
    if (!proxy_.empty()) io::write_text(scratch_ / "scene/proxy.obj", proxy_);
    return run(fmt::format("hybrid register {} --quiet --out {} {}", (scratch_ / "scene/scene.toml").string(),
                           (scratch_ / "out").string(), options));
  }
  nlohmann::json pose() const {
    return nlohmann::json::parse(io::read_text(scratch_ / "out/scans/s/pose.json"));
  }
  nlohmann::json summary() const {
    return nlohmann::json::parse(io::read_text(scratch_ / "out/summary.json"));
  }
  fs::path sheet() const { return scratch_ / "out/scans/s/sheet"; }

  std::string proxy_{};  // instead of the mini scene's
  bool model_ = true;    // and photographs and views

 private:
  Scratch scratch_;
};

// `seen` are the corners (numbers of the model's vertices) picked in the scan, `meant` in the model.
std::string landmarks(const std::vector<int>& seen, const std::vector<int>& meant) {
  std::string text = "landmarks = [";
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Vec3 p = Vec3(seen[i] & 1 ? 4 : 0, seen[i] & 2 ? 3 : 0, seen[i] & 4 ? 2.5 : 0) - kScanner_m;
    text +=
        fmt::format("\n  {{ scan = [{:.3f}, {:.3f}, {:.3f}], vertex = {} }},", p.x(), p.y(), p.z(), meant[i]);
  }
  return text + "\n]";
}

// Of the mini scene's model.
std::string corners() {
  std::string text;
  for (int corner = 0; corner < 8; ++corner)
    text += fmt::format("v {} {} {}\n", corner & 1 ? 4 : 0, corner & 2 ? 3 : 0, corner & 4 ? 2.5 : 0);
  return text;
}

}  // namespace

TEST_F(BadRegistration, exchanged_landmarks_give_no_pose_and_are_named) {
  expect_failure(register_from(landmarks({0, 7, 1, 6, 2}, {7, 0, 1, 6, 2})), 3,
                 {"scan s: the landmarks do not belong together",
                  "landmark 1 (line 10) and landmark 2 (line 11) seem exchanged",
                  "the automatic alignment abstains, too"});
  EXPECT_EQ(pose()["status"], "abstained");
  EXPECT_EQ(pose()["how"], "landmarks");
  EXPECT_TRUE(pose()["world_from_scan"].is_null());
  EXPECT_TRUE(fs::exists(sheet() / "landmarks.toml"));
}

TEST_F(BadRegistration, the_planes_alone_are_not_asked_where_they_may_not_try) {
  const auto outcome =
      register_from(landmarks({0, 7, 1, 6, 2}, {7, 0, 1, 6, 2}), "--set register.automatic=never");
  expect_failure(outcome, 3, {"seem exchanged"});
  EXPECT_EQ(outcome.err.find("automatic alignment"), std::string::npos) << outcome.err;
}

TEST_F(BadRegistration, a_bad_landmark_is_named_and_left_out) {
  const auto outcome = register_from(landmarks({0, 7, 1, 6, 2}, {0, 7, 3, 6, 2}));
  expect_failure(outcome, 0, {"scan s: landmark 3 (line 12), scan [2.400, -1.300, -1.200], is left out"});
  EXPECT_NE(outcome.out.find("warning: landmark 3 (line 12)"), std::string::npos) << outcome.out;
  EXPECT_EQ(pose()["landmarks"]["left_out"], 3);
  EXPECT_EQ(pose()["warnings"].size(), 1u);
  EXPECT_NEAR(pose()["world_from_scan"][3], kScanner_m.x(), 1e-3);
}

TEST_F(BadRegistration, a_given_pose_that_is_a_quarter_off_is_contradicted) {
  expect_failure(register_from("pose = [0, -1, 0, 1.6, 1, 0, 0, 1.3, 0, 0, 1, 1.2, 0, 0, 0, 1]"), 3,
                 {"scan s: the scan's planes contradict the pose that ICP found from the given pose",
                  "in front of them", "another pose", "Check the pose", "fixed = true"});
  EXPECT_EQ(pose()["status"], "abstained");
  EXPECT_TRUE(pose()["refused"]["rms_m"].is_number());
  EXPECT_TRUE(fs::exists(sheet() / "landmarks.toml"));
}

// As modelling programs export them: some faces, or all, with their backs to the scanner.
TEST_F(BadRegistration, a_model_whose_faces_are_turned_round_is_told) {
  proxy_ =
      corners() +
      "g floor\nf 3 4 2 1\ng ceiling\nf 6 8 7 5\ng south\nf 2 6 5 1\ng north\nf 7 8 4 3\ng west\nf 5 7 3 1\n"
      "g east\nf 4 8 6 2\n";
  expect_failure(
      register_from(landmarks({0, 7, 1, 6, 2}, {0, 7, 1, 6, 2})), 3,
      {"no plane of the scan lies on a face of the model that looks its way",
       "of the planar area lie on faces, but", "on backs (", "and 3 more)", "turn such faces round"});
}

TEST_F(BadRegistration, one_turned_face_of_a_model_that_places_the_scan_is_told) {
  proxy_ =
      corners() +
      "g floor\nf 1 2 4 3\ng ceiling\nf 6 8 7 5\ng south\nf 1 5 6 2\ng north\nf 3 4 8 7\ng west\nf 1 3 7 5\n"
      "g east\nf 2 6 8 4\n";
  expect_failure(register_from(landmarks({0, 7, 1, 6, 2}, {0, 7, 1, 6, 2})), 0,
                 {"model: 1 of 6 faces are seen by scans from behind (ceiling)"});
  EXPECT_EQ(pose()["status"], "accepted");
  EXPECT_EQ(summary()["warnings"].size(), 1u);
  EXPECT_EQ(summary()["faces_seen_from_behind"], nlohmann::json::array({"ceiling"}));
}

TEST_F(BadRegistration, what_the_model_leaves_open_is_said) {
  // The floor alone, and a start that is off.
  proxy_ = "v 0 0 0.012\nv 4 0 0\nv 4 3 0\nv 0 3 0.012\nf 1 2 3 4\n";
  const auto outcome = register_from(kPose);
  expect_failure(outcome, 0, {"scan s: the model leaves the pose undetermined: it is free to slide along"});
  EXPECT_NE(outcome.out.find("warning: the model leaves the pose undetermined"), std::string::npos);
  EXPECT_EQ(pose()["warnings"].size(), 1u);
}

TEST_F(BadRegistration, icp_did_not_converge_though_faces_are_solved_with_the_pose) {
  // Walls off by 12 mm outwards.
  for (int corner = 0; corner < 8; ++corner)
    proxy_ += fmt::format("v {} {} {}\n", corner & 1 ? 4.012 : -0.012, corner & 2 ? 3.012 : -0.02,
                          corner & 4 ? 2.53 : 0);
  proxy_ += "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
  expect_failure(register_from(kPose, "--set register.max_iterations=1"), 0, {"ICP did not converge in 1"});
  EXPECT_EQ(pose()["faces"]["solved_with_the_pose"], true);
  EXPECT_EQ(pose()["converged"], false);
}

TEST_F(BadRegistration, landmarks_without_a_model_place_nothing_and_say_so) {
  model_ = false;
  const auto outcome =
      register_from(landmarks({0, 7, 1}, {0, 7, 1}) + "\n[[scan]]\nid = \"t\"\nfile = \"s.ply\"");
  expect_failure(outcome, 3,
                 {"scan s: its 3 landmarks (line 10 on) place nothing", "the scene has no [model]",
                  "scan t: no pose: against scan s"});
  EXPECT_EQ(outcome.err.find("landmark sheet"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out.find("sheet/"), std::string::npos) << outcome.out;
}

TEST_F(BadRegistration, a_few_samples_are_no_fault_of_the_model) {
  expect_failure(register_from(kPose, "--set register.max_samples=1"), 3,
                 {"scan s: registration: expected at least 10 planar samples", "max_samples", "0 = all"});
}

}  // namespace hybrid::e2e
