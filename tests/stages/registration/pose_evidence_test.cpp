// Poses that were given: right ones are not contradicted, those of another place, scale or hand are.
#include "stages/registration/pose_evidence.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "cases/trial_room.hpp"
#include "device.hpp"
#include "stages/registration/automatic_checks.hpp"

namespace hybrid::pose_evidence_test {
namespace {

using stages::AutomaticOptions;

struct Trial {
  testing::TrialRoom room;
  testing::TrialScan scan;
  stages::ScanEvidence evidence;
};

Trial trial(const std::string& kind, std::uint32_t seed, double crop, double proxy_error_m) {
  Trial t{testing::make_trial_room(kind, seed, proxy_error_m), {}, {}};
  t.scan = testing::scan_trial_room(testing::queue(), t.room, seed, crop);
  t.evidence = stages::gather_evidence(t.scan.image, t.scan.segmentation, AutomaticOptions().rays, 1);
  return t;
}

stages::PoseEvidence judged(const Trial& t, const PolygonModel& proxy, const Pose& start,
                            const AutomaticOptions& options = {}) {
  stages::IcpOptions icp;
  icp.free_scale = options.free_scale;
  const auto samples = stages::choose_planar_samples(t.scan.image, t.scan.segmentation, 20000, 1);
  const auto found = stages::register_to_model(testing::queue(), samples, proxy, start, icp);
  return stages::judge_pose(testing::queue(), t.evidence, proxy, found, icp, options);
}

PolygonModel scaled(PolygonModel model, double factor) {
  for (Vec3& v : model.vertices) v *= factor;
  return model;
}

PolygonModel mirrored(PolygonModel model) {
  for (Vec3& v : model.vertices) v.x() = -v.x();
  for (Face& face : model.faces) {
    std::reverse(face.outer.begin(), face.outer.end());
    for (auto& hole : face.holes) std::reverse(hole.begin(), hole.end());
  }
  return model;
}

const char* const kKinds[] = {"box", "niche", "hall", "ell", "oblique", "alcoves"};

std::uint32_t trials(std::uint32_t usual) {
  const char* more = std::getenv("TRIALS");
  return more ? static_cast<std::uint32_t>(std::atoi(more)) : usual;
}

}  // namespace

// Faces off by up to 3 cm, furniture, recesses that the proxy lacks, half of a turn.
TEST(PoseEvidence, right_poses_are_not_contradicted) {
  for (const char* kind : kKinds)
    for (std::uint32_t seed = 1; seed <= trials(3); ++seed) {
      const Trial t = trial(kind, seed, seed % 2 ? 0.5 : 1, 0.01 * (seed % 4));
      EXPECT_EQ(judged(t, t.room.proxy, t.scan.world_from_scan).contradiction, "") << kind << " " << seed;
    }
}

TEST(PoseEvidence, neither_is_one_of_which_the_model_shows_a_wall_or_displaces_it) {
  const Trial t = trial("ell", 4, 1, 0);
  PolygonModel one = t.room.proxy, displaced = t.room.proxy;
  one.faces.resize(1);
  EXPECT_EQ(judged(t, one, t.scan.world_from_scan).contradiction, "");
  for (Vec3& v : displaced.vertices)
    if (v.x() < 0.01) v.x() -= 0.15;
  EXPECT_EQ(judged(t, displaced, t.scan.world_from_scan).contradiction, "");
}

// A start turned by a quarter leads ICP to a wrong pose, of which its rms says nothing.
TEST(PoseEvidence, wrong_poses_are_contradicted) {
  for (const char* kind : kKinds) {
    const Trial t = trial(kind, 1, 1, 0.01);
    Pose wrong = t.scan.world_from_scan;
    wrong.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()) * wrong.rotation;
    EXPECT_NE(judged(t, t.room.proxy, wrong).contradiction, "") << kind;
  }
}

TEST(PoseEvidence, what_is_wrong_with_the_model_is_named) {
  const Trial t = trial("ell", 31, 1, 0.01);
  const Pose& truth = t.scan.world_from_scan;
  AutomaticOptions levelled;  // else a mirrored room may be one upside down
  levelled.levelled = true;
  const auto diagnosis = [&](const PolygonModel& proxy, const Pose& start) {
    const auto evidence = judged(t, proxy, start);
    EXPECT_NE(evidence.contradiction, "");
    return stages::diagnose_pose(testing::queue(), t.evidence, proxy, 1, evidence.shares.supported, levelled);
  };
  EXPECT_NE(diagnosis(scaled(t.room.proxy, 1000), truth).find("is the model in millimetres?"),
            std::string::npos);
  EXPECT_NE(diagnosis(mirrored(t.room.proxy), truth).find("mirrored"), std::string::npos);
  Pose away = truth;
  away.translation += Vec3(40, 0, 0);
  EXPECT_NE(diagnosis(t.room.proxy, away).find("another pose would lay"), std::string::npos);
}

// A model of no known unit: what is near a face is told in the scan's metres.
TEST(PoseEvidence, with_a_free_scale_distances_are_the_scans) {
  const Trial t = trial("ell", 5, 1, 0.01);
  AutomaticOptions free;
  free.free_scale = true;
  for (const double unit : {0.01, 200.0}) {
    Pose start = t.scan.world_from_scan;
    start.scale = unit;
    start.translation *= unit;
    EXPECT_EQ(judged(t, scaled(t.room.proxy, unit), start, free).contradiction, "") << unit;
  }
}

}  // namespace hybrid::pose_evidence_test
