#include "stages/registration/joint_poses.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/error.hpp"
#include "stages/registration/joint_pairs.hpp"

namespace hybrid::stages {
namespace {

using Step = std::array<double, 6>;  // rotation vector about the scanner, translation; world axes
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kMostRounds = 30;
constexpr double kJointSettledAngleRad = 1e-7, kJointSettledDistanceM = 1e-6;
constexpr double kLeastReach_m = 0.03;  // of matches in the last rounds
// A start is never known better than this: the segmentation's errors are not in its covariance.
constexpr double kLeastPrior_m = 1e-4, kLeastPriorRad = 1e-5;
// And never worse: neighbours' planes lie within reach of it. Weak against any pair of planes.
constexpr double kMostPrior_m = 0.1, kMostPriorRad = 0.02;

Pose stepped(const Pose& pose, const Step& step) {
  const Vec3 turn(step[0], step[1], step[2]);
  Pose moved = pose;
  if (turn.norm() > 0)
    moved.rotation = (Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.rotation).normalized();
  moved.translation += Vec3(step[3], step[4], step[5]);
  return moved;
}

// Heights of a tile over a plane of another scan, exact over its samples: of the centroid, and of one
// standard deviation along the tile's two axes.
struct TileOnPlane {
  Vec3 centroid;               // of the tile, turned into the world, from its scanner
  std::array<Vec3, 2> spread;  // the same, deviations
  Vec3 from, to;               // scanners
  Vec3 normal;                 // of the plane, world
  double offset_m;             // from the scanner it was seen from
  double weight;               // square root of the information

  template <typename T>
  bool operator()(const T* tile_step, const T* plane_step, T* residual) const {
    const auto turned = [](const T* step, const Vec3& v, T* out) {
      const T in[3] = {T(v.x()), T(v.y()), T(v.z())};
      ceres::AngleAxisRotatePoint(step, in, out);
    };
    T n[3], c[3], s[3];
    turned(plane_step, normal, n);
    turned(tile_step, centroid, c);
    T height = T(-offset_m);
    for (int k = 0; k < 3; ++k)
      height += n[k] * (c[k] + T(from(k)) + tile_step[3 + k] - T(to(k)) - plane_step[3 + k]);
    residual[0] = T(weight) * height;
    for (std::size_t a = 0; a < 2; ++a) {
      turned(tile_step, spread[a], s);
      residual[1 + a] = T(weight) * (n[0] * s[0] + n[1] * s[1] + n[2] * s[2]);
    }
    return true;
  }
};

// What is known of a scan's start: root of the information about its scanner, and how far it has moved since.
struct StartPrior {
  Matrix6 root;
  Vector6 moved;

  template <typename T>
  bool operator()(const T* step, T* residual) const {
    for (int row = 0; row < 6; ++row) {
      residual[row] = T(0);
      for (int col = 0; col < 6; ++col) residual[row] += T(root(row, col)) * (step[col] + T(moved(col)));
    }
    return true;
  }
};

// From the world's origin to the scanner: a rotation about the origin also moves it.
Matrix6 moves_about(const Vec3& place) {
  Matrix6 m = Matrix6::Identity();
  m.block<3, 3>(3, 0) << 0, place.z(), -place.y(), -place.z(), 0, place.x(), place.y(), -place.x(), 0;
  return m;
}

// Root of the information about a start. Directions that nothing else holds keep to it.
Matrix6 root_information(const JointScan& scan, const Vec3& place) {
  Matrix6 information = Matrix6::Zero();
  if (scan.covariance) {
    const Matrix6 move = moves_about(place);
    Matrix6 c = move * Eigen::Map<const Matrix6>(scan.covariance->data()) * move.transpose();
    const double reach = std::max(scan.evidence->reach_m, 1e-3);
    for (int k = 0; k < 6; ++k) {
      const double least = k < 3 ? std::hypot(kLeastPriorRad, scan.face_sigma_m / reach)
                                 : std::hypot(kLeastPrior_m, scan.face_sigma_m);
      c(k, k) += least * least;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(c);
    const Vector6 inverse = solver.eigenvalues().cwiseMax(1e-12).cwiseInverse();
    information = solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  }
  for (int k = 0; k < 6; ++k) {
    const double most = k < 3 ? kMostPriorRad : kMostPrior_m;
    information(k, k) += 1 / (most * most);
  }
  return information.llt().matrixU();
}

Vector6 moved_since(const Pose& start, const Pose& now) {
  const Eigen::AngleAxisd turn(now.rotation * start.rotation.conjugate());
  Vector6 moved;
  moved << turn.angle() * turn.axis(), now.translation - start.translation;
  return moved;
}

// Weights from the robust scale; every pair of superclusters counts by its area, all together as the number
// of independent planes that the areas amount to.
void weigh(const std::vector<JointScan>& scans, double scale, std::vector<JointMatch>& matches) {
  using Planes = std::tuple<std::size_t, std::size_t, std::uint32_t, std::uint32_t>;
  std::map<std::pair<std::size_t, std::size_t>, std::map<Planes, double>> areas;
  for (JointMatch& match : matches) {
    const PlaneTile& tile = scans[match.from].evidence->tiles[match.tile];
    const double ratio = match.rms_m / (4.685 * scale);
    match.weight = ratio < 1 ? (1 - ratio * ratio) * (1 - ratio * ratio) * tile.area_m2 : 0;
    areas[std::minmax(match.from, match.to)][{match.from, match.to, tile.supercluster, match.face->face}] +=
        match.weight;
  }
  std::map<std::pair<std::size_t, std::size_t>, double> factor;
  for (const auto& [pair, planes] : areas) {
    double sum = 0, squares = 0;
    for (const auto& [key, area] : planes) {
      sum += area;
      squares += area * area;
    }
    // Effective number of planes, per unit of area; half, as each is seen both ways.
    factor[pair] = squares > 0 ? sum / squares / 2 : 0;
  }
  for (JointMatch& match : matches) match.weight *= factor[std::minmax(match.from, match.to)];
  std::erase_if(matches, [](const JointMatch& match) { return !(match.weight > 0); });
}

class JointProblem {
 public:
  JointProblem(const std::vector<JointScan>& scans, const std::vector<bool>& fixed,
               const std::vector<Pose>& poses, const std::vector<JointMatch>& matches, double sigma_m)
      : steps_(scans.size(), Step{}) {
    for (const JointMatch& match : matches) add(scans, poses, match, sigma_m);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      if (!fixed[i] && (scans[i].covariance || used_.count(i))) {
        auto* prior = new ceres::AutoDiffCostFunction<StartPrior, 6, 6>(new StartPrior{
            root_information(scans[i], poses[i].translation), moved_since(scans[i].start, poses[i])});
        problem_.AddResidualBlock(prior, nullptr, steps_[i].data());
        used_.insert(i);
      }
      if (used_.count(i) && fixed[i]) problem_.SetParameterBlockConstant(steps_[i].data());
    }
  }

  const std::vector<Step>& solve() {
    ceres::Solver::Options options;
    // Priors hold every direction, so that normal equations do; rows have 12 entries however many scans there
    // are.
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.num_threads = 1;
    options.max_num_iterations = 20;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-12;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable()) fail(ErrorKind::failed, "joint refinement: {}", summary.message);
    return steps_;
  }

  // About the world's origin, as Registration::covariance; zero of scans that take no part.
  std::vector<std::array<double, 36>> covariances(const std::vector<bool>& fixed,
                                                  const std::vector<Pose>& poses) {
    std::vector<std::array<double, 36>> result(steps_.size(), std::array<double, 36>{});
    ceres::Problem::EvaluateOptions options;
    for (const std::size_t i : used_)
      if (!fixed[i]) options.parameter_blocks.push_back(steps_[i].data());
    if (options.parameter_blocks.empty()) return result;
    const Eigen::MatrixXd inverse = inverse_information(options);
    Eigen::Index at = 0;
    for (const std::size_t i : used_) {
      if (fixed[i]) continue;
      const Matrix6 at_scanner = inverse.block<6, 6>(at, at);
      at += 6;
      const Matrix6 back = moves_about(-poses[i].translation);
      Eigen::Map<Matrix6>(result[i].data()) = back * at_scanner * back.transpose();
    }
    return result;
  }

 private:
  // Of the steps of some scans, in their order. Directions that nothing holds are left out.
  Eigen::MatrixXd inverse_information(const ceres::Problem::EvaluateOptions& options) {
    constexpr double kLeastOfLargest = 1e-14;
    ceres::CRSMatrix jacobian;
    problem_.Evaluate(options, nullptr, nullptr, nullptr, &jacobian);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
    for (std::size_t row = 0; row < static_cast<std::size_t>(jacobian.num_rows); ++row)
      for (int a = jacobian.rows[row]; a < jacobian.rows[row + 1]; ++a)
        for (int b = jacobian.rows[row]; b < jacobian.rows[row + 1]; ++b) {
          const auto left = static_cast<std::size_t>(a), right = static_cast<std::size_t>(b);
          information(jacobian.cols[left], jacobian.cols[right]) +=
              jacobian.values[left] * jacobian.values[right];
        }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
    const Eigen::VectorXd& held = solver.eigenvalues();
    const double least = kLeastOfLargest * held.maxCoeff();
    const Eigen::VectorXd inverse = (held.array() > least).select(held.cwiseInverse(), 0.0);
    return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  }

  void add(const std::vector<JointScan>& scans, const std::vector<Pose>& poses, const JointMatch& match,
           double sigma_m) {
    const PlaneTile& tile = scans[match.from].evidence->tiles[match.tile];
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(tile.scatter / tile.area_m2);
    auto* cost = new TileOnPlane;
    const auto& from = poses[match.from];
    cost->centroid = from.scale * from.rotate(tile.centroid);
    for (int a = 0; a < 2; ++a)
      cost->spread[static_cast<std::size_t>(a)] = from.scale *
                                                  std::sqrt(std::max(axes.eigenvalues()(1 + a), 0.0)) *
                                                  from.rotate(axes.eigenvectors().col(1 + a));
    cost->from = from.translation;
    cost->to = poses[match.to].translation;
    cost->normal = poses[match.to].rotate(match.face->plane.normal);
    cost->offset_m = poses[match.to].scale * match.face->plane.offset_m;
    cost->weight = std::sqrt(match.weight) / sigma_m;
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<TileOnPlane, 3, 6, 6>(cost), nullptr,
                              steps_[match.from].data(), steps_[match.to].data());
    used_.insert({match.from, match.to});
  }

  std::vector<Step> steps_;
  std::set<std::size_t> used_;
  ceres::Problem problem_;
};

std::vector<bool> fixed_scans(const std::vector<JointScan>& scans) {
  std::vector<bool> fixed;
  bool held = false;
  for (const JointScan& scan : scans) {
    fixed.push_back(scan.fixed);
    held |= scan.fixed || scan.covariance.has_value();
  }
  if (!held && !fixed.empty()) fixed[0] = true;
  return fixed;
}

}  // namespace

JointPoses refine_jointly(const std::vector<JointScan>& scans, const JointOptions& options) {
  JointPoses result;
  for (const JointScan& scan : scans) result.world_from_scan.push_back(scan.start);
  result.covariance.resize(scans.size());
  auto& poses = result.world_from_scan;
  const auto fixed = fixed_scans(scans);
  double scale = options.reach_m / 4.685, reach = options.reach_m;
  std::vector<JointMatch> matches;
  for (bool settled = false; !settled && result.iterations < kMostRounds; ++result.iterations) {
    matches = find_matches(scans, poses, reach);
    const double wanted = std::max(1.4826 * median_rms(matches, scans), options.least_sigma_m);
    const bool last_scale = wanted >= 0.5 * scale;
    scale = std::max(wanted, 0.5 * scale);
    reach = std::clamp(4.685 * scale, kLeastReach_m, options.reach_m);
    weigh(scans, scale, matches);
    JointProblem problem(scans, fixed, poses, matches, scale);
    double turn = 0, shift = 0;
    const auto& steps = problem.solve();
    if (last_scale) result.covariance = problem.covariances(fixed, poses);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (fixed[i]) continue;
      poses[i] = stepped(poses[i], steps[i]);
      turn = std::max(turn, Vec3(steps[i][0], steps[i][1], steps[i][2]).norm());
      shift = std::max(shift, Vec3(steps[i][3], steps[i][4], steps[i][5]).norm());
    }
    settled = last_scale && turn < kJointSettledAngleRad && shift < kJointSettledDistanceM;
    result.converged = settled;
  }
  result.sigma_m = scale;
  for (JointMatch& match : matches) match.rms_m = rms_of(match, scans, poses);
  result.pairs = report_pairs(scans, poses, matches);
  return result;
}

}  // namespace hybrid::stages
