#include "batch/truth_figures.hpp"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/parallel_blocks.hpp"

namespace hybrid::batch {
namespace {

// How many measured samples have this label and this true plane, in this order, and how many are curved.
struct LabelCounts {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::int64_t> samples;
  std::int64_t curved = 0, curved_as_planar = 0;

  LabelCounts& operator+=(const LabelCounts& other) {
    for (const auto& [pair, count] : other.samples) samples[pair] += count;
    curved += other.curved;
    curved_as_planar += other.curved_as_planar;
    return *this;
  }
};

LabelCounts count_samples(const io::ScanTruth& truth, const RangeImage& image,
                          const std::vector<std::uint32_t>& labels) {
  return sum_blocks<LabelCounts>(image.count(), [&](std::size_t begin, std::size_t end) {
    LabelCounts counts;
    std::pair<std::uint32_t, std::uint32_t> pair;  // of the samples of a run
    std::int64_t run = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (image.mask[i] != kMeasured) continue;
      const std::uint32_t source = image.source[i];
      if (truth.kind.at(source) == 1) {
        ++counts.curved;
        counts.curved_as_planar += labels[i] != 0;
      }
      const std::pair its(labels[i], truth.plane.at(source));
      if (its != pair && run > 0) counts.samples[pair] += std::exchange(run, 0);
      pair = its;
      ++run;
    }
    if (run > 0) counts.samples[pair] += run;
    return counts;
  });
}

// Per label the true plane of most of its samples; 0: none.
std::vector<std::uint32_t> majorities(const LabelCounts& counts, std::size_t labels) {
  std::vector<std::uint32_t> plane(labels, 0);
  std::vector<std::int64_t> most(labels, 0);
  for (const auto& [pair, count] : counts.samples)
    if (pair.second != 0 && count > most[pair.first]) {
      plane[pair.first] = pair.second;
      most[pair.first] = count;
    }
  return plane;
}

double share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

}  // namespace

nlohmann::ordered_json truth_figures(const io::ScanTruth& truth, const ScanProduct& product,
                                     const Pose* world_from_scan) {
  const auto& segmentation = product.segmentation;
  const LabelCounts counts = count_samples(truth, product.image, segmentation.sample_label);
  const auto majority = majorities(counts, segmentation.superclusters.size() + 1);
  std::int64_t planar = 0, right = 0;
  std::map<std::uint32_t, std::int64_t> samples_of_plane, right_of_plane;
  for (const auto& [pair, count] : counts.samples) {
    const auto& [label, plane] = pair;
    if (plane == 0) continue;
    const std::int64_t correct = label != 0 && majority[label] == plane ? count : 0;
    planar += count;
    right += correct;
    samples_of_plane[plane] += count;
    right_of_plane[plane] += correct;
  }
  std::int64_t planes = 0, found = 0;
  for (const auto& [plane, samples] : samples_of_plane) {
    if (samples < 100) continue;
    ++planes;
    found += 2 * right_of_plane[plane] >= samples;
  }
  nlohmann::ordered_json json = {
      {"planar_samples", planar},
      {"planar_samples_right_share", share(right, planar)},
      {"planes_of_100_samples", planes},
      {"planes_found", found},
      {"curved_samples", counts.curved},
      {"curved_called_planar_share", share(counts.curved_as_planar, counts.curved)}};
  if (world_from_scan) {
    const auto error = difference(truth.world_from_scan, *world_from_scan);
    json["pose_error_mm"] = error.distance_m * 1000;
    json["pose_error_deg"] = error.angle_rad * 180 / M_PI;
  }
  return json;
}

}  // namespace hybrid::batch
