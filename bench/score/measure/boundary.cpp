#include "score/measure/boundary.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "score/measure/region_table.hpp"

namespace score {
namespace {

using Borders = std::map<std::uint32_t, std::vector<Eigen::Vector2f>>;  // by plane; (column, row)

// Adaptor of a list of points for nanoflann.
struct PointList {
  const std::vector<Eigen::Vector2f>& list;
  std::size_t kdtree_get_point_count() const { return list.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return list[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointList>, PointList, 2>;

class BorderFinder {
 public:
  BorderFinder(const JoinedScan& scan, Borders& truth, Borders& result)
      : scan_(scan),
        majority_(count_overlaps(scan, Planes::all).majority()),
        truth_(truth),
        result_(result) {}

  void find() {
    for (int row = 0; row < scan_.rows; ++row)
      for (int col = 0; col < scan_.cols; ++col) {
        if (!says_something(row, col)) continue;
        look(row, col, 0, 1);
        look(row, col, 1, 0);
      }
  }

 private:
  std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(scan_.cols) +
           static_cast<std::size_t>(col % scan_.cols);
  }
  bool says_something(int row, int col) const {
    const std::uint8_t kind = scan_.kind[index(row, col)];
    return kind == kPlanar || kind == kCurved;
  }

  // Both sides' borders between this sample and the next that says something.
  void look(int row, int col, int down, int right) {
    for (int step = 1; step <= kMostSkipped + 1; ++step) {
      const int next_row = row + step * down, next_col = col + step * right;
      if (next_row >= scan_.rows || (next_col >= scan_.cols && !scan_.wraps)) return;
      if (!says_something(next_row, next_col)) continue;
      const std::size_t here = index(row, col), there = index(next_row, next_col);
      const Eigen::Vector2f middle(static_cast<float>(col + next_col) / 2,
                                   static_cast<float>(row + next_row) / 2);
      add(true_plane(here), true_plane(there), middle, truth_);
      add(result_plane(here), result_plane(there), middle, result_);
      return;
    }
  }

  std::uint32_t true_plane(std::size_t i) const { return scan_.counts(i) ? scan_.plane[i] : 0; }
  std::uint32_t result_plane(std::size_t i) const {
    if (scan_.label[i] == 0) return 0;
    const auto plane = majority_.find(scan_.label[i]);
    return plane == majority_.end() ? 0 : plane->second;
  }

  static void add(std::uint32_t a, std::uint32_t b, const Eigen::Vector2f& place, Borders& borders) {
    if (a == b) return;
    if (a != 0) borders[a].push_back(place);
    if (b != 0) borders[b].push_back(place);
  }

  const JoinedScan& scan_;
  std::map<std::uint32_t, std::uint32_t> majority_;
  Borders &truth_, &result_;
};

// From each of `from` to the nearest of `to`, appended.
void append_distances(const std::vector<Eigen::Vector2f>& from, std::vector<Eigen::Vector2f> to, int turn,
                      std::vector<float>& distances) {
  if (turn > 0) {  // what lies across the seam is near
    const std::size_t count = to.size();
    for (std::size_t i = 0; i < count; ++i)
      for (const float shift : {-1.0f, 1.0f})
        to.push_back(to[i] + Eigen::Vector2f(shift * static_cast<float>(turn), 0));
  }
  const PointList points{to};
  Tree tree(2, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  tree.buildIndex();
  const std::size_t first = distances.size();
  distances.resize(first + from.size());
  tbb::parallel_for(std::size_t{0}, from.size(), [&](std::size_t i) {
    std::uint32_t nearest = 0;
    float squared = 0;
    tree.knnSearch(from[i].data(), 1, &nearest, &squared);
    distances[first + i] = std::sqrt(squared);
  });
}

BoundaryScore::Distances summarise(std::vector<float> distances) {
  BoundaryScore::Distances summary;
  summary.borders = static_cast<std::int64_t>(distances.size());
  if (distances.empty()) return summary;
  const auto beyond = std::count_if(distances.begin(), distances.end(), [](float d) { return d > 1; });
  summary.share_beyond_1 = static_cast<double>(beyond) / static_cast<double>(distances.size());
  const auto rank = [&](double share) {
    const auto place =
        static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(distances.size()))) - 1;
    std::nth_element(distances.begin(), distances.begin() + place, distances.end());
    return static_cast<double>(distances[static_cast<std::size_t>(place)]);
  };
  summary.median = rank(0.5);
  summary.percentile_95 = rank(0.95);
  return summary;
}

}  // namespace

BoundaryScore score_boundaries(const JoinedScan& scan) {
  Borders truth, result;
  BorderFinder(scan, truth, result).find();
  const int turn = scan.wraps ? scan.cols : 0;
  BoundaryScore score;
  std::vector<float> displaced, invented;
  for (const auto& [plane, borders] : truth) {
    const auto found = result.find(plane);
    if (found == result.end()) {
      score.not_compared += static_cast<std::int64_t>(borders.size());
      continue;
    }
    append_distances(borders, found->second, turn, displaced);
    append_distances(found->second, borders, turn, invented);
  }
  score.displaced = summarise(std::move(displaced));
  score.invented = summarise(std::move(invented));
  return score;
}

}  // namespace score
