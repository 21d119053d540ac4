#include "shared/grow_squares.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hybrid::peers {
namespace {

constexpr float kSameDirection = 0.99619f;  // cosine of 5 degrees
constexpr int kLeastSquares = 8;

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

bool one_plane(const SquareFit& a, const SquareFit& b, float tolerance_m) {
  if (!a.planar || !b.planar || a.normal.dot(b.normal) < kSameDirection) return false;
  const Eigen::Vector3f between = b.centroid - a.centroid;
  return std::abs(between.dot(a.normal)) < tolerance_m && std::abs(between.dot(b.normal)) < tolerance_m;
}

std::vector<std::uint32_t> join(const SquareExtent& extent, const std::vector<SquareFit>& fits,
                                float tolerance_m) {
  std::vector<std::uint32_t> parent(extent.count());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto cols = static_cast<std::uint32_t>(extent.cols);
  for (std::uint32_t i = 0; i < parent.size(); ++i) {
    const std::uint32_t right = i + 1, below = i + cols;
    if (right % cols != 0 && one_plane(fits[i], fits[right], tolerance_m))
      parent[root_of(parent, right)] = root_of(parent, i);
    if (below < parent.size() && one_plane(fits[i], fits[below], tolerance_m))
      parent[root_of(parent, below)] = root_of(parent, i);
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = root_of(parent, i);
  return parent;
}

struct Group {
  int squares = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(), centroid = Eigen::Vector3d::Zero();
  std::uint32_t label = 0;
};

std::vector<Group> groups_of(const std::vector<std::uint32_t>& root, const std::vector<SquareFit>& fits) {
  std::vector<Group> groups(fits.size());
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i].planar) continue;
    Group& group = groups[root[i]];
    ++group.squares;
    group.normal += fits[i].normal.cast<double>();
    group.centroid += fits[i].centroid.cast<double>();
  }
  std::uint32_t next = 0;
  for (Group& group : groups) {
    if (group.squares < kLeastSquares) continue;
    group.label = ++next;
    group.normal.normalize();
    group.centroid /= group.squares;
  }
  return groups;
}

}  // namespace

void square_nodes(const RangeScan& scan, const SquareExtent& extent, int row, int col,
                  std::vector<std::uint32_t>& nodes) {
  nodes.clear();
  const int last_row = std::min((row + 1) * extent.side, scan.rows),
            last_col = std::min((col + 1) * extent.side, scan.cols);
  for (int r = row * extent.side; r < last_row; ++r)
    for (int c = col * extent.side; c < last_col; ++c) {
      const auto i =
          static_cast<std::size_t>(r) * static_cast<std::size_t>(scan.cols) + static_cast<std::size_t>(c);
      if (scan.mask[i] != 0) nodes.push_back(static_cast<std::uint32_t>(i));
    }
}

std::vector<std::uint32_t> grow_squares(const RangeScan& scan, const SquareExtent& extent,
                                        const std::vector<SquareFit>& fits, double sigma_m) {
  const auto root = join(extent, fits, static_cast<float>(4 * sigma_m + 0.005));
  const auto groups = groups_of(root, fits);
  const float near_m = static_cast<float>(3 * sigma_m + 0.002);
  std::vector<std::uint32_t> labels(scan.count(), 0);
#pragma omp parallel for schedule(dynamic, 8)
  for (int row = 0; row < extent.rows; ++row) {
    std::vector<std::uint32_t> nodes;
    for (int col = 0; col < extent.cols; ++col) {
      // The square's own group first, then those of the squares around it.
      std::vector<const Group*> candidates;
      const int around[5][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
      for (const auto& [dr, dc] : around) {
        const int r = row + dr, c = col + dc;
        if (r < 0 || c < 0 || r >= extent.rows || c >= extent.cols) continue;
        const auto i =
            static_cast<std::size_t>(r) * static_cast<std::size_t>(extent.cols) + static_cast<std::size_t>(c);
        const Group* group = &groups[root[i]];
        if (group->label != 0 && std::find(candidates.begin(), candidates.end(), group) == candidates.end())
          candidates.push_back(group);
      }
      if (candidates.empty()) continue;
      square_nodes(scan, extent, row, col, nodes);
      for (std::uint32_t i : nodes) {
        float best = near_m;
        for (const Group* group : candidates) {
          const Eigen::Vector3d p(scan.x[i], scan.y[i], scan.z[i]);
          const auto distance = static_cast<float>(std::abs(group->normal.dot(p - group->centroid)));
          if (distance >= best) continue;
          best = distance;
          labels[i] = group->label;
        }
      }
    }
  }
  return labels;
}

}  // namespace hybrid::peers
