#include "score/measure/labels.hpp"

namespace score {

LabelScore score_labels(const JoinedScan& scan) {
  LabelScore score;
  for (std::size_t i = 0; i < scan.kind.size(); ++i) {
    const bool labelled = scan.label[i] != 0;
    const auto count = [labelled](std::int64_t& all, std::int64_t& called_planar) {
      ++all;
      called_planar += labelled;
    };
    if (scan.kind[i] == kCurved) count(score.curved, score.curved_called_planar);
    if (scan.kind[i] == kMixed) count(score.mixed, score.mixed_called_planar);
    if (scan.kind[i] == kGhost) count(score.ghosts, score.ghosts_called_planar);
  }

  const RegionTable table = count_overlaps(scan, Planes::all);
  const auto majority = table.majority();
  std::map<std::uint32_t, std::int64_t> right;
  for (const auto& [region, plane, samples] : table.overlaps)
    if (majority.at(region) == plane) right[plane] += samples;
  for (const auto& [plane, size] : table.plane_size) {
    score.planar += size;
    score.right += right[plane];
    if (size < scan.min_samples) continue;
    ++score.planes;
    if (2 * right[plane] >= size)
      ++score.found;
    else
      score.lost.push_back(plane);
  }
  return score;
}

}  // namespace score
