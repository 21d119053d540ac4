// What a scan's registration says that it knows of its pose, against what the pose is truly off.
#include "stages/registration/joint_priors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "cases/trial_room.hpp"
#include "stages/registration/icp_step.hpp"
#include "stages/registration/tile_icp.hpp"

namespace hybrid {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// A room of 8 x 6 x 3 m about the scanner, which stands at 1.5 m, in tiles of a metre; each face is seen as
// two superclusters.
struct Room {
  PolygonModel model;
  stages::ScanEvidence evidence;
};

void add_face(Room& room, const Vec3& corner, const Vec3& along, const Vec3& up) {
  const auto first = static_cast<std::uint32_t>(room.model.vertices.size());
  for (const Vec3& p : {corner, Vec3(corner + along), Vec3(corner + along + up), Vec3(corner + up)})
    room.model.vertices.push_back(p);
  const auto index = static_cast<std::uint32_t>(room.model.faces.size());
  room.model.faces.push_back({"face", {first, first + 1, first + 2, first + 3}, {}});
  const Vec3 normal = along.cross(up).normalized();
  const int columns = static_cast<int>(along.norm()), rows = static_cast<int>(up.norm());
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < columns; ++col) {
      stages::PlaneTile tile;
      tile.supercluster = 2 * index + (2 * col < columns ? 0 : 1);
      tile.normal = normal;
      tile.area_m2 = 1;
      tile.centroid = corner + along.normalized() * (col + 0.5) + up.normalized() * (row + 0.5);
      tile.scatter = (Mat3::Identity() - normal * normal.transpose()) / 12;
      room.evidence.tiles.push_back(tile);
    }
}

Room make_room(bool with_ends) {
  Room room;
  add_face(room, {-4, -3, -1.5}, {8, 0, 0}, {0, 6, 0});
  add_face(room, {-4, 3, 1.5}, {8, 0, 0}, {0, -6, 0});
  add_face(room, {4, -3, -1.5}, {-8, 0, 0}, {0, 0, 3});
  add_face(room, {-4, 3, -1.5}, {8, 0, 0}, {0, 0, 3});
  if (with_ends) {
    add_face(room, {-4, -3, -1.5}, {0, 6, 0}, {0, 0, 3});
    add_face(room, {4, 3, -1.5}, {0, -6, 0}, {0, 0, 3});
  }
  room.evidence.reach_m = 4;
  return room;
}

// Every supercluster off by its own draw, along its normal.
void displace(Room& room, double sigma_m, std::uint32_t seed) {
  testing::Draw draw(seed, 21);
  std::vector<double> offsets;
  for (std::size_t k = 0; k < 2 * room.model.faces.size(); ++k) offsets.push_back(sigma_m * draw.normal());
  for (auto& tile : room.evidence.tiles) tile.centroid += offsets[tile.supercluster] * tile.normal;
}

Pose fitted(const Room& room) {
  const auto shapes = stages::measure_model(room.model);
  Pose pose;
  for (int k = 0; k < 5; ++k) {
    stages::PlaneSums sums;
    const auto pairs = stages::find_tile_pairs(room.evidence, shapes, pose, 0.1);
    for (std::size_t t = 0; t < pairs.size(); ++t)
      if (pairs[t].face) stages::add_tile(room.evidence.tiles[t], pairs[t], pose, Vec3::Zero(), 1, sums);
    stages::apply_plane_step(sums, Vec3::Zero(), 4, false, pose);
  }
  return pose;
}

Matrix6 covariance_of(const Room& room, const Pose& pose) {
  const auto found =
      stages::covariance_on_exact_faces(room.evidence, stages::measure_model(room.model), pose);
  EXPECT_TRUE(found.has_value());
  return Eigen::Map<const Matrix6>(found->data());
}

}  // namespace

TEST(JointPriors, are_as_wide_as_poses_are_off) {
  for (const double sigma_m : {2e-4, 1e-3}) {
    double sum = 0;
    constexpr int kDraws = 100;
    for (std::uint32_t seed = 0; seed < kDraws; ++seed) {
      Room room = make_room(true);
      displace(room, sigma_m, seed);
      const Pose pose = fitted(room);  // the truth is no motion at all
      const Eigen::AngleAxisd turn(pose.rotation);
      Vector6 off;
      off << turn.angle() * turn.axis(), pose.translation;
      sum += off.dot(covariance_of(room, pose).llt().solve(off)) / 6;
    }
    // 1 where the covariance is exactly as wide. It is the sum of two estimates: rather too wide.
    EXPECT_GT(sum / kDraws, 0.2) << sigma_m;
    EXPECT_LT(sum / kDraws, 1.0) << sigma_m;
    if (std::getenv("TRIALS")) printf("%.4f m: %.3f\n", sigma_m, sum / kDraws);
  }
}

TEST(JointPriors, leave_open_what_the_planes_leave_open) {
  Room room = make_room(false);  // a corridor along x
  displace(room, 5e-4, 3);
  const Matrix6 c = covariance_of(room, fitted(room));
  EXPECT_GT(c(3, 3), 0.9);
  EXPECT_LT(c(4, 4), 1e-6);
  EXPECT_LT(c(5, 5), 1e-6);
}

TEST(JointPriors, are_not_widened_by_what_stands_before_a_wall) {
  Room bare = make_room(true);
  displace(bare, 5e-4, 5);
  Room furnished = bare;
  for (int k = 0; k < 6; ++k) {
    auto tile = bare.evidence.tiles[static_cast<std::size_t>(100 + k)];
    tile.centroid += 0.04 * tile.normal;
    tile.supercluster = 40;
    furnished.evidence.tiles.push_back(tile);
  }
  const Pose pose = fitted(bare);
  const Matrix6 without = covariance_of(bare, pose), with = covariance_of(furnished, pose);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(with(k, k), without(k, k), 0.05 * without(k, k)) << k;
}

TEST(JointPriors, say_nothing_without_a_face_in_reach) {
  Room room = make_room(true);
  Pose far;
  far.translation = Vec3(100, 0, 0);
  EXPECT_FALSE(
      stages::covariance_on_exact_faces(room.evidence, stages::measure_model(room.model), far).has_value());
}

// As if the information of one more observation had been added.
TEST(JointPriors, what_holds_a_scan_along_a_direction_adds_its_information) {
  Room room = make_room(false);
  displace(room, 5e-4, 3);
  Pose pose = fitted(room);
  const Matrix6 before = covariance_of(room, pose);
  std::array<double, 36> rows{};
  Eigen::Map<Matrix6>(rows.data()) = before;
  const Vec3 place(3, -2, 1.5), direction = Vec3(1, 0.2, 0).normalized();
  constexpr double kSigma = 0.002;
  const auto held = stages::covariance_held_along(rows, place, direction, kSigma);
  Vector6 moves;  // of the place along the direction, by a step about the origin
  for (int k = 0; k < 3; ++k) moves(k) = direction.dot(Vec3::Unit(k).cross(place));
  moves.tail<3>() = direction;
  const Matrix6 expected = (before.inverse() + moves * moves.transpose() / (kSigma * kSigma)).inverse();
  const Matrix6 found = Eigen::Map<const Matrix6>(held.data());
  EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm());
  EXPECT_NEAR(std::sqrt(moves.dot(found * moves)), kSigma, 1e-5);
}

}  // namespace hybrid
