#include "stages/scan/interleaving.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.hpp"

namespace hybrid::stages {

double interleaved_share(const RangeImage& image, const PlaneSegmentation& segmentation) {
  constexpr double kNearlyParallel = 5 * std::numbers::pi / 180;
  const auto& labels = segmentation.sample_label;
  const auto normal = [&](std::uint32_t label) { return segmentation.superclusters[label - 1].plane.normal; };
  const auto is_between = [&](std::uint32_t own, std::uint32_t one, std::uint32_t other) {
    return one == other && one != 0 && one != own && normal(own).dot(normal(one)) > std::cos(kNearlyParallel);
  };
  struct Count {
    std::int64_t labelled = 0, between = 0;
  };
  std::vector<Count> of_row(static_cast<std::size_t>(image.rows));
  parallel_for(of_row.size(), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (labels[i] == 0) continue;
      of_row[r].labelled += 1;
      if (col > 0 && col + 1 < image.cols)
        of_row[r].between += is_between(labels[i], labels[i - 1], labels[i + 1]);
      if (row > 0 && row + 1 < image.rows)
        of_row[r].between +=
            is_between(labels[i], labels[image.index(row - 1, col)], labels[image.index(row + 1, col)]);
    }
  });
  Count all;
  for (const Count& count : of_row) all.labelled += count.labelled, all.between += count.between;
  return all.labelled == 0 ? 0 : static_cast<double>(all.between) / static_cast<double>(all.labelled);
}

}  // namespace hybrid::stages
