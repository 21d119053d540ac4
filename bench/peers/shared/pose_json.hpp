#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace hybrid::peers {

// 16 numbers, row-major. Throws std::runtime_error when there are not 16.
Eigen::Matrix4d matrix_of(const nlohmann::json& numbers);
nlohmann::json json_of(const Eigen::Matrix4d& matrix);

// Member `name` of a JSON file, as a matrix. Throws std::runtime_error naming the file.
Eigen::Matrix4d read_pose(const std::filesystem::path& file, const std::string& name);

// How far a pose is from the truth: rotation in degrees; distance in millimetres of where the two put the
// scanner.
struct PoseError {
  double angle_deg = 0, distance_mm = 0;
};
PoseError pose_error(const Eigen::Matrix4d& pose, const Eigen::Matrix4d& truth);

// A start for registrations: 2 degrees about an axis oblique to all walls, 5 cm in a direction oblique to all
// walls.
Eigen::Matrix4d disturbed(const Eigen::Matrix4d& truth);

}  // namespace hybrid::peers
