#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "score/geometry.hpp"

namespace score {

inline constexpr std::uint32_t kNoSource = 0xffffffffu;

// range.exr and labels.exr of one scan: the measured samples on their grid.
struct LabelledGrid {
  int rows = 0, cols = 0;
  bool wraps = false;                        // the last column is next to the first
  std::vector<std::uint32_t> source, label;  // source: kNoSource where nothing was measured; label: 0 = none
  std::vector<float> range_m;                // as measured
  std::vector<Eigen::Vector3f> point;        // scan frame, metres; empty when range.exr has no x y z

  std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};
LabelledGrid read_labelled_grid(const std::filesystem::path& folder);
struct ResultPlane {
  Plane plane;                           // scan frame
  std::vector<std::vector<Vec3>> rings;  // outer and inner, scan frame
};
// planes.json by supercluster id; nothing when the folder has none.
std::optional<std::map<std::uint32_t, ResultPlane>> read_result_planes(const std::filesystem::path& folder);

struct ResultCylinder {
  Vec3 foot, axis;  // scan frame; the axis of length 1
  double length_m = 0, radius_m = 0;
};
// Those seen from outside in planes.json; nothing when there is none or it lists no cylinders, not even none.
std::optional<std::vector<ResultCylinder>> read_result_cylinders(const std::filesystem::path& folder);

struct ResultPose {
  Similarity world_from_scan;
  bool accepted = false;  // else abstained
  bool is_frame = false;  // without a model: the frame of all poses is this scan's
};
std::optional<ResultPose> read_result_pose(const std::filesystem::path& folder);

// Vertices of detail.ply, scan frame; nothing when the folder has none.
std::optional<std::vector<Eigen::Vector3f>> read_kept_points(const std::filesystem::path& folder);

}  // namespace score
