#include "shared/pose_json.hpp"

#include <cmath>
#include <fstream>
#include <numbers>
#include <stdexcept>

namespace hybrid::peers {

Eigen::Matrix4d matrix_of(const nlohmann::json& numbers) {
  if (!numbers.is_array() || numbers.size() != 16)
    throw std::runtime_error("expected a pose of 16 numbers, row-major");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)].get<double>();
  return matrix;
}

nlohmann::json json_of(const Eigen::Matrix4d& matrix) {
  auto numbers = nlohmann::json::array();
  for (int i = 0; i < 16; ++i) numbers.push_back(matrix(i / 4, i % 4));
  return numbers;
}

Eigen::Matrix4d read_pose(const std::filesystem::path& file, const std::string& name) {
  try {
    std::ifstream input(file);
    if (!input) throw std::runtime_error("cannot be opened");
    return matrix_of(nlohmann::json::parse(input).at(name));
  } catch (const std::exception& problem) {
    throw std::runtime_error(file.string() + ": " + name + ": " + problem.what());
  }
}

PoseError pose_error(const Eigen::Matrix4d& pose, const Eigen::Matrix4d& truth) {
  const Eigen::Matrix3d turn = pose.topLeftCorner<3, 3>() * truth.topLeftCorner<3, 3>().transpose();
  // The angle from the skew part stays exact near zero, where acos of the trace does not.
  const Eigen::Vector3d axis(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  const double angle = std::atan2(axis.norm() / 2, (turn.trace() - 1) / 2);
  return {angle * 180 / std::numbers::pi,
          1000 * (pose.topRightCorner<3, 1>() - truth.topRightCorner<3, 1>()).norm()};
}

Eigen::Matrix4d disturbed(const Eigen::Matrix4d& truth) {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.5, -0.6, 0.62).normalized();
  Eigen::Matrix4d start = truth;
  start.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(2 * std::numbers::pi / 180, axis).toRotationMatrix() * truth.topLeftCorner<3, 3>();
  start.topRightCorner<3, 1>() += 0.05 * Eigen::Vector3d(0.6, 0.55, -0.58).normalized();
  return start;
}

}  // namespace hybrid::peers
