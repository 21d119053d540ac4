// Faces of a proxy that are off, each by its own offset: the pose and the offsets are those of the true
// planes.
#include "stages/registration/face_offsets.hpp"
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cases/closest_point_case.hpp"
#include "cases/trial_room.hpp"
#include "device.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid {
namespace {

using stages::FaceOffsets;
using testing::Draw;
using testing::queue;

Vec3 random_direction(Draw& draw) {
  return Vec3(draw.normal(), draw.normal(), draw.normal()).normalized();
}

// Every corner by 1 to 3 cm in a direction of its own.
void move_corners(PolygonModel& model, Draw& draw) {
  for (Vec3& v : model.vertices) v += draw.within(0.01, 0.03) * random_direction(draw);
}

// Proxy face of each supercluster: the one that was its plane before the corners moved; -1 for what the proxy
// lacks.
std::vector<int> faces_of(const PolygonModel& exact_proxy, const testing::TrialScan& scan) {
  std::vector<int> faces;
  for (const Supercluster& one : scan.segmentation.superclusters) {
    const Vec3 n = scan.world_from_scan.rotate(one.plane.normal);
    const double d = one.plane.offset_m + n.dot(scan.world_from_scan.translation);
    const Vec3 centre = scan.world_from_scan * one.centroid_m;
    int found = -1;
    for (std::size_t f = 0; f < exact_proxy.faces.size(); ++f) {
      const Plane plane = face_plane(exact_proxy, exact_proxy.faces[f]);
      if ((plane.normal - n).norm() > 1e-6 || std::abs(plane.offset_m - d) > 1e-6) continue;
      // Sills of doors are all as high: only where the face is.
      Eigen::AlignedBox3d box;
      for (const auto v : exact_proxy.faces[f].outer) box.extend(exact_proxy.vertices[v]);
      if (box.exteriorDistance(centre) < 0.05) found = static_cast<int>(f);
    }
    faces.push_back(found);
  }
  return faces;
}

// The optimum that the issue asks for: the pose that lays the true planes, as far as the scan sees them, on
// the proxy's faces with the least squares by area. Correspondences and planes from the truth, no noise.
// Written on its own: plain Gauss-Newton on samples, nothing of the stage.
Pose best_fit_of_true_planes(const PolygonModel& exact_proxy, const PolygonModel& proxy,
                             const testing::TrialScan& scan) {
  const auto faces = faces_of(exact_proxy, scan);
  Pose pose = scan.world_from_scan;
  for (int k = 0; k < 10; ++k) {
    Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < scan.image.count(); ++i) {
      const std::uint32_t label = scan.segmentation.sample_label[i];
      if (label == 0 || faces[label - 1] < 0) continue;
      const Plane& truth = scan.segmentation.superclusters[label - 1].plane;
      const Vec3 ray = scan.image.point(i).normalized();
      const double cosine = truth.normal.dot(ray), range = truth.offset_m / cosine;
      const double elevation = scan.image.elevation_rad[i / static_cast<std::size_t>(scan.image.cols)];
      const double area = range * range * std::cos(elevation) / std::abs(cosine);
      const Plane plane = face_plane(proxy, proxy.faces[static_cast<std::size_t>(faces[label - 1])]);
      const Vec3 x = pose * Vec3(range * ray);
      Eigen::Matrix<double, 6, 1> j;
      j << (x - pose.translation).cross(plane.normal), plane.normal;
      h += area * j * j.transpose();
      g += area * plane.distance(x) * j;
    }
    const Eigen::Matrix<double, 6, 1> step = -h.ldlt().solve(g);
    const Vec3 turn = step.head<3>();
    pose.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.rotation;
    pose.translation += step.tail<3>();
  }
  return pose;
}

stages::ScanEvidence evidence_of(const testing::TrialScan& scan) {
  return stages::gather_evidence(scan.image, scan.segmentation, 1000, 1);
}

}  // namespace

// The issue: corners off by 1 to 3 cm, recesses and furniture that the proxy lacks.
TEST(FaceOffsets, the_pose_is_the_best_fit_of_the_true_planes_to_a_proxy_with_wrong_corners) {
  for (const char* kind : {"box", "niche", "hall", "ell", "oblique", "alcoves"})
    for (std::uint32_t seed = 0; seed < 9; ++seed) {
      auto room = testing::make_trial_room(kind, 4100 + seed);
      const PolygonModel exact_proxy = room.proxy;
      Draw draw(seed, 9);
      move_corners(room.proxy, draw);
      const auto scan = testing::scan_trial_room(queue(), room, 4100 + seed, 1);
      Pose start = scan.world_from_scan;
      start.translation += 0.05 * random_direction(draw);
      start.rotation = Eigen::AngleAxisd(2 * kDegree, random_direction(draw)) * start.rotation;
      const Pose pose = stages::solve_face_offsets(scan.segmentation, evidence_of(scan), room.proxy, start);
      const auto apart = difference(best_fit_of_true_planes(exact_proxy, room.proxy, scan), pose);
      EXPECT_FALSE(
          stages::measure_face_offsets(scan.segmentation, evidence_of(scan), room.proxy, pose).agree);
      EXPECT_LT(apart.distance_m, 0.001) << kind << " " << seed;
      EXPECT_LT(apart.angle_rad, 0.01 * kDegree) << kind << " " << seed;
    }
}

// One wall moved as a whole: its offset is found, on the right side, and a recess 8 cm behind it is no part
// of it.
TEST(FaceOffsets, a_wall_that_was_drawn_too_far_in_is_reported_behind) {
  for (const double shift : {0.012, -0.025}) {
    const auto exact = testing::make_trial_room("niche", 4200);
    auto room = exact;
    const auto wall = std::find_if(room.proxy.faces.begin(), room.proxy.faces.end(),
                                   [](const Face& face) { return face.name == "wall-2"; });
    const Plane plane = face_plane(room.proxy, *wall);
    for (Vec3& v : room.proxy.vertices)
      if (std::abs(plane.distance(v)) < 1e-9) v += shift * plane.normal;
    const auto scan = testing::scan_trial_room(queue(), exact, 4200, 1);
    // Against the true pose: the others are right.
    const auto found =
        stages::measure_face_offsets(scan.segmentation, evidence_of(scan), room.proxy, scan.world_from_scan);
    EXPECT_TRUE(found.agree);
    ASSERT_FALSE(found.faces.empty());
    for (const auto& face : found.faces) {
      EXPECT_NEAR(face.offset_m, face.name == "wall-2" ? -shift : 0, 2e-4) << face.name;
      EXPECT_LT(face.tilt_deg, 0.05) << face.name;
      EXPECT_EQ(room.proxy.faces[face.face].name, face.name);
      const std::string words = stages::offset_in_words(face);
      EXPECT_EQ(words.find(shift > 0 ? "scan lies 12.0 mm behind, sigma"
                                     : "scan lies 25.0 mm in front, sigma") == 0,
                face.name == "wall-2")
          << words;
    }
  }
}

TEST(FaceOffsets, the_pose_s_uncertainty_is_in_those_of_the_offsets) {
  stages::FaceOffsets offsets;
  offsets.faces.resize(2);
  offsets.faces[0].normal = Vec3::UnitX();
  offsets.faces[1].normal = Vec3::UnitZ();
  offsets.faces[1].centre = {10, 0, 0};
  std::array<double, 36> covariance{};
  covariance[6 * 3 + 3] = 4e-6;  // 2 mm along x
  covariance[6 * 1 + 1] = 1e-8;  // 0.1 mrad about y
  stages::add_pose_sigma(covariance, offsets);
  EXPECT_NEAR(offsets.faces[0].pose_sigma_m, 0.002, 1e-9);
  EXPECT_NEAR(offsets.faces[1].pose_sigma_m, 0.001, 1e-9);
}

}  // namespace hybrid
