#include "stages/registration/icp.hpp"
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/recess_room.hpp"
#include "core/error.hpp"
#include "device.hpp"
#include "stages/registration/icp_step.hpp"
#include "stages/registration/landmarks.hpp"

namespace hybrid::stages::icp_test {
namespace {

using namespace hybrid::testing;

const RecessRoomScan& room() {
  static const RecessRoomScan scan = scan_recess_room(300, 600, 0.002);
  return scan;
}

PlanarSamples samples_of(const RecessRoomScan& scan, int count = 20000) {
  return choose_planar_samples(scan.image, scan.segmentation, count, 1);
}

// The goal of FINDINGS.md, with a little more room for the angle.
void expect_at(const Registration& found, const Pose& truth) {
  EXPECT_TRUE(found.converged);
  EXPECT_LT(difference(found.world_from_scan, truth).distance_m, 2e-4);
  EXPECT_LT(difference(found.world_from_scan, truth).angle_rad, 0.005 * kDegree);
}

bool same(const Registration& a, const Registration& b) {
  return row_major(a.world_from_scan) == row_major(b.world_from_scan) && a.covariance == b.covariance &&
         a.rms_m == b.rms_m && a.overlap == b.overlap && a.iterations == b.iterations &&
         a.rms_history_m == b.rms_history_m && a.degenerate == b.degenerate;
}

// Closest point on the walls of the room without recesses, by clamping to each.
Vec3 closest_on_box(const Vec3& p) {
  const Vec3 size(8, 6, 3);
  Vec3 best = Vec3::Constant(INFINITY);
  for (int axis = 0; axis < 3; ++axis)
    for (double value : {0.0, size(axis)}) {
      Vec3 q = p.cwiseMax(Vec3::Zero()).cwiseMin(size);
      q(axis) = value;
      if ((q - p).norm() < (best - p).norm()) best = q;
    }
  return best;
}

IcpOptions paper_options() {
  IcpOptions options;
  options.step = "point";
  options.robust = "none";
  options.normal_deg = 180;
  options.max_iterations = 2000;
  return options;
}

template <typename Body>
void expect_refused(const std::string& part, const Body& body) {
  try {
    body();
    ADD_FAILURE() << "accepted; expected an error with: " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace

TEST(Icp, reaches_the_pose_from_twenty_random_starts_though_the_proxy_lacks_the_recesses) {
  for (int count : {30, 1000, 20000}) {
    const auto samples = samples_of(room(), count);
    for (std::uint32_t trial = 0; trial < 20; ++trial)
      for (const auto& [distance, angle] : {std::pair{0.05, 2.0}, std::pair{0.3, 10.0}}) {
        SCOPED_TRACE(
            fmt::format("{} samples, trial {}, start {} m {} deg off", count, trial, distance, angle));
        const Pose start = disturbed(room().world_from_scan, distance, angle, trial);
        const auto found = register_to_model(queue(), samples, room().proxy, start);
        expect_at(found, room().world_from_scan);
        EXPECT_TRUE(found.degenerate.empty());
      }
  }
}

TEST(Icp, works_far_from_the_origin) {
  const auto scan = scan_recess_room(150, 300, 0.002, Vec3(530000.25, 180000.5, 40));
  const auto found =
      register_to_model(queue(), samples_of(scan), scan.proxy, disturbed(scan.world_from_scan, 0.3, 10, 3));
  expect_at(found, scan.world_from_scan);
}

TEST(Icp, says_how_well_it_fits) {
  const auto found = register_to_model(queue(), samples_of(room()), room().proxy,
                                       disturbed(room().world_from_scan, 0.05, 2, 1));
  EXPECT_LT(found.rms_m, 0.0005);  // samples are projected onto their planes, which fit the proxy's
  // Seen recess backs (4.4 + 4.2 m2, less what their edges hide) and sides are not on the proxy.
  EXPECT_GT(found.overlap, 0.9);
  EXPECT_LT(found.overlap, 0.96);
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(found.covariance.data());
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-18);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(covariance);
  EXPECT_GT(solver.eigenvalues()(0), 0);
  EXPECT_LT(solver.eigenvalues()(5), 1e-6);  // a millimetre, at most
}

TEST(Icp, faces_off_by_centimetres_give_one_answer_and_a_covariance_of_what_can_be_seen) {
  const auto samples = samples_of(room(), 5000);
  for (std::uint32_t trial = 0; trial < 40; ++trial) {
    PolygonModel proxy = room().proxy;  // each wall moved by up to 2 cm
    for (auto& vertex : proxy.vertices)
      for (int axis = 0; axis < 3; ++axis) {
        const auto wall = static_cast<std::uint32_t>(2 * axis + (vertex(axis) > 1));
        vertex(axis) += 0.04 * (random_bits(4, trial, wall) / 4294967296.0 - 0.5);
      }
    const auto a =
        register_to_model(queue(), samples, proxy, disturbed(room().world_from_scan, 0.3, 10, trial));
    const auto b =
        register_to_model(queue(), samples, proxy, disturbed(room().world_from_scan, 0.05, 2, trial + 50));
    EXPECT_TRUE(a.converged && b.converged);
    EXPECT_LT(difference(a.world_from_scan, b.world_from_scan).distance_m, 2e-5);
    // At the scanner: translation of the left perturbation there.
    const Vec3 at = a.world_from_scan.translation;
    Eigen::Matrix<double, 3, 6> move;
    move << 0, at.z(), -at.y(), 1, 0, 0, -at.z(), 0, at.x(), 0, 1, 0, at.y(), -at.x(), 0, 0, 0, 1;
    using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
    const Mat3 covariance = move * Eigen::Map<const Matrix6>(a.covariance.data()) * move.transpose();
    // What opposite walls have in common moves the proxy as a whole. No residual shows it, so no covariance
    // from residuals can hold it (in 10 of these 40 it is beyond the 99 % bound below); only the rest is
    // judged.
    Vec3 common;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const double sum =
          random_bits(4, trial, 2 * axis) / 4294967296.0 + random_bits(4, trial, 2 * axis + 1) / 4294967296.0;
      common(axis) = 0.02 * (sum - 1);
    }
    const Vec3 error = at - room().world_from_scan.translation - common;
    EXPECT_LT(error.dot(covariance.inverse() * error), 11.3) << trial;  // chi-squared, 3 degrees, 99 %
    EXPECT_LT(covariance.trace(), 3 * 0.04 * 0.04);
  }
}

TEST(Icp, covariance_is_written_about_the_world_s_origin) {
  const Vec3 shift(1000, -2000, 30);
  const auto samples = samples_of(room());
  PolygonModel moved = room().proxy;
  for (auto& v : moved.vertices) v += shift;
  Pose start = room().world_from_scan;
  const auto here = register_to_model(queue(), samples, room().proxy, start);
  start.translation += shift;
  const auto there = register_to_model(queue(), samples, moved, start);
  using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  const Eigen::Map<const Matrix6> a(here.covariance.data()), b(there.covariance.data());
  // exp(w, t) about the shifted origin: the translation gains shift x w.
  Matrix6 move = Matrix6::Identity();
  move.block<3, 3>(3, 0) << 0, -shift.z(), shift.y(), shift.z(), 0, -shift.x(), -shift.y(), shift.x(), 0;
  const Matrix6 expected = move * a * move.transpose();
  EXPECT_LT((b - expected).norm(), 1e-3 * expected.norm());
  EXPECT_LT((b - expected).eval().topLeftCorner(3, 3).norm(), 1e-3 * a.topLeftCorner(3, 3).norm());
}

TEST(Icp, keeps_what_two_parallel_planes_leave_open_and_names_it) {
  const auto scan = scan_recess_room(150, 300, 0.002, Vec3::Zero(), {4, 5});  // floor and ceiling
  Pose start = scan.world_from_scan;
  start.translation += Vec3(0.2, -0.1, 0.05);
  start.rotation = Eigen::AngleAxisd(0.02, Vec3(1, 0.5, 0).normalized()) * start.rotation;
  const auto found = register_to_model(queue(), samples_of(scan), scan.proxy, start);
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.degenerate, (std::vector<std::string>{"free to slide along (1.00, 0.00, 0.00)",
                                                        "free to slide along (0.00, 1.00, 0.00)",
                                                        "free to turn about (0.00, 0.00, 1.00)"}));
  const Vec3 error = found.world_from_scan.translation - scan.world_from_scan.translation;
  EXPECT_NEAR(error.z(), 0, 2e-4);
  EXPECT_NEAR(error.x(), 0.2, 0.05);  // stays, but for the turn about the samples' centre
  EXPECT_GT(found.covariance[6 * 3 + 3], 1e5);
  const Vec3 up = found.world_from_scan.rotate(scan.world_from_scan.rotation.conjugate() * Vec3::UnitZ());
  EXPECT_LT(std::acos(std::min(up.z(), 1.0)), 0.005 * kDegree);
}

TEST(Icp, names_the_direction_of_a_corridor) {
  const auto scan =
      scan_recess_room(150, 300, 0.002, Vec3::Zero(), {2, 3, 4, 5});  // ends x = 0 and x = 8 are open
  const auto found =
      register_to_model(queue(), samples_of(scan), scan.proxy, disturbed(scan.world_from_scan, 0.1, 3, 2));
  EXPECT_EQ(found.degenerate, std::vector<std::string>{"free to slide along (1.00, 0.00, 0.00)"});
}

// Planes that face y and z; what moved the pose along x is no longer among the pairs.
TEST(Icp, goes_back_to_the_start_along_what_the_last_pairs_leave_open) {
  const double radius = 3;
  PlaneSums sums;
  sums.weight = 1;
  sums.matrix.diagonal() << radius * radius, radius * radius, radius * radius, 0, 0.5, 0.5, 0;
  const Vec3 centre(1, 2, 3);
  Pose start, pose;
  start.rotation = Eigen::AngleAxisd(0.7, Vec3::UnitZ());
  start.translation = Vec3(10, -4, 2);
  pose.rotation = Eigen::AngleAxisd(0.01, Vec3::UnitZ()) * start.rotation;
  pose.translation = start.translation + Vec3(0.1, 0.2, -0.3);
  const Pose before = pose;
  const StepSize back = return_along_open(sums, centre, radius, start, pose);
  const Vec3 moved = pose * centre - before * centre, gone = before * centre - start * centre;
  EXPECT_NEAR(moved.x(), -gone.x(), 1e-12);
  EXPECT_NEAR(moved.tail<2>().norm(), 0, 1e-12);
  EXPECT_NEAR(pose.rotation.angularDistance(before.rotation), 0, 1e-9);
  EXPECT_NEAR(back.distance_m, std::abs(gone.x()), 1e-12);
}

TEST(Icp, recovers_a_free_scale) {
  auto samples = samples_of(room());
  for (auto& p : samples.points)
    for (std::size_t a = 0; a < 3; ++a) p[a] /= 1.02f;
  Pose truth = room().world_from_scan;
  truth.scale = 1.02;
  Pose start = disturbed(room().world_from_scan, 0.05, 2, 4);
  IcpOptions options;
  options.free_scale = true;
  const auto found = register_to_model(queue(), samples, room().proxy, start, options);
  expect_at(found, truth);
  EXPECT_NEAR(found.world_from_scan.scale, 1.02, 2e-5);

  // A start's scale stays as it is when it is not free.
  start.scale = 1.02;
  const auto fixed = register_to_model(queue(), samples, room().proxy, start);
  EXPECT_EQ(fixed.world_from_scan.scale, 1.02);
  expect_at(fixed, truth);
}

TEST(Icp, a_corner_leaves_the_scale_open) {
  const auto scan = scan_recess_room(150, 300, 0.002, Vec3::Zero(), {0, 2, 4});
  IcpOptions options;
  options.free_scale = true;
  const auto found = register_to_model(queue(), samples_of(scan), scan.proxy, scan.world_from_scan, options);
  EXPECT_EQ(found.degenerate, std::vector<std::string>{"free to scale"});
  EXPECT_NEAR(found.world_from_scan.scale, 1, 1e-3);

  // From a start that is off the scale stays the start's all the same.
  Pose start = disturbed(scan.world_from_scan, 0.05, 2, 4);
  start.scale = 1.01;
  const auto moved = register_to_model(queue(), samples_of(scan), scan.proxy, start, options);
  EXPECT_EQ(moved.degenerate, std::vector<std::string>{"free to scale"});
  EXPECT_EQ(moved.world_from_scan.scale, 1.01);
  EXPECT_TRUE(moved.converged);
}

TEST(Icp, the_papers_step_is_horn_on_the_closest_points) {
  const auto samples = samples_of(room(), 500);
  const Pose start = disturbed(room().world_from_scan, 0.05, 2, 5);
  IcpOptions options = paper_options();
  options.max_iterations = 1;
  const auto found = register_to_model(queue(), samples, room().proxy, start, options);
  std::vector<Vec3> from, to;
  std::vector<double> areas;
  for (const auto& p : samples.points) {
    from.emplace_back(p[0], p[1], p[2]);
    to.push_back(closest_on_box(start * from.back()));
    areas.push_back(p[3]);
  }
  const Pose expected = horn(from, to, areas, false);
  EXPECT_LT(difference(found.world_from_scan, expected).distance_m, 1e-5);
  EXPECT_LT(difference(found.world_from_scan, expected).angle_rad, 2e-6);
  EXPECT_FALSE(found.converged);
}

TEST(Icp, the_papers_method_lowers_the_mean_square_distance_until_it_stops) {
  for (std::uint32_t trial = 0; trial < 5; ++trial) {
    const auto found = register_to_model(queue(), samples_of(room(), 2000), room().proxy,
                                         disturbed(room().world_from_scan, 0.05, 2, trial), paper_options());
    EXPECT_TRUE(found.converged);
    ASSERT_GT(found.rms_history_m.size(), 3u);
    for (std::size_t i = 1; i < found.rms_history_m.size(); ++i)
      EXPECT_LE(found.rms_history_m[i], found.rms_history_m[i - 1] * (1 + 1e-6)) << i;
    // Without the recesses in the proxy it stops centimetres off at best: why the plane step is the default.
    EXPECT_LT(difference(found.world_from_scan, room().world_from_scan).distance_m, 0.1);
  }
}

TEST(Icp, the_papers_scale_is_found_on_points_too) {
  const auto scan = scan_recess_room(150, 300, 0, Vec3::Zero(), {0, 2, 4, 5});
  auto samples = samples_of(scan, 5000);
  for (auto& p : samples.points)
    for (std::size_t a = 0; a < 3; ++a) p[a] /= 1.01f;
  IcpOptions options = paper_options();
  options.free_scale = true;
  options.tau = 1e-7;
  const auto found = register_to_model(queue(), samples, scan.proxy, scan.world_from_scan, options);
  EXPECT_NEAR(found.world_from_scan.scale, 1.01, 1e-3);
}

TEST(Icp, gives_the_same_bits_at_two_work_group_sizes_and_twice) {
  const auto samples = samples_of(room());
  const Pose start = disturbed(room().world_from_scan, 0.3, 10, 6);
  for (const auto& options : {IcpOptions{}, paper_options()}) {
    auto body = [&] { return register_to_model(queue(), samples, room().proxy, start, options); };
    const auto [a, b] = at_two_work_group_sizes(body);
    EXPECT_TRUE(same(a, b));
    EXPECT_TRUE(same(a, body()));
  }
}

TEST(Icp, refuses_what_it_cannot_register) {
  const auto samples = samples_of(room(), 100);
  const Pose start = room().world_from_scan;
  expect_refused("no planar samples", [&] { register_to_model(queue(), {}, room().proxy, start); });
  expect_refused("at least one face", [&] { register_to_model(queue(), samples, PolygonModel{}, start); });
  Pose infinite = start;
  infinite.translation.x() = INFINITY;
  expect_refused("start pose", [&] { register_to_model(queue(), samples, room().proxy, infinite); });
  PolygonModel floor = room().proxy;  // only the floor's back side: no normal is compatible with its samples
  floor.faces.resize(1);
  std::reverse(floor.faces[0].outer.begin(), floor.faces[0].outer.end());
  const auto scan = scan_recess_room(60, 120, 0.002, Vec3::Zero(), {4});
  expect_refused("front sides", [&] { register_to_model(queue(), samples_of(scan), floor, start); });
  IcpOptions options;
  options.step = "line";
  expect_refused("step: expected one of point, plane",
                 [&] { register_to_model(queue(), samples, room().proxy, start, options); });
}

TEST(Icp, gives_up_when_steps_run_out) {
  IcpOptions options;
  options.max_iterations = 2;
  const auto found = register_to_model(queue(), samples_of(room(), 1000), room().proxy,
                                       disturbed(room().world_from_scan, 0.3, 10, 1), options);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.iterations, 2);
}

}  // namespace hybrid::stages::icp_test
