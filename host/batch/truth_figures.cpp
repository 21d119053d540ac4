#include "batch/truth_figures.hpp"

#include <cmath>
#include <map>

namespace hybrid::batch {
namespace {

using Counts = std::map<std::uint32_t, std::int64_t>;

std::uint32_t most_frequent(const Counts& counts) {
  std::uint32_t best = 0;
  std::int64_t best_count = 0;
  for (const auto& [label, count] : counts)
    if (label != 0 && count > best_count) {
      best = label;
      best_count = count;
    }
  return best;
}

double share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

}  // namespace

nlohmann::ordered_json truth_figures(const io::ScanTruth& truth, const ScanProduct& product,
                                     const Pose* world_from_scan) {
  const auto& image = product.image;
  const auto& labels = product.segmentation.sample_label;
  std::vector<Counts> by_supercluster(product.segmentation.superclusters.size() + 1);
  for (std::size_t i = 0; i < image.count(); ++i)
    if (image.mask[i] == kMeasured && labels[i] != 0)
      ++by_supercluster[labels[i]][truth.plane.at(image.source[i])];
  std::vector<std::uint32_t> majority(by_supercluster.size(), 0);
  for (std::size_t id = 1; id < majority.size(); ++id) majority[id] = most_frequent(by_supercluster[id]);

  std::int64_t planar = 0, right = 0, curved = 0, curved_as_planar = 0;
  Counts samples_of_plane, right_of_plane;
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (image.mask[i] != kMeasured) continue;
    const std::uint32_t plane = truth.plane[image.source[i]];
    if (truth.kind[image.source[i]] == 1) {
      ++curved;
      curved_as_planar += labels[i] != 0;
    }
    if (plane == 0) continue;
    const bool correct = labels[i] != 0 && majority[labels[i]] == plane;
    ++planar;
    right += correct;
    ++samples_of_plane[plane];
    right_of_plane[plane] += correct;
  }
  std::int64_t planes = 0, found = 0;
  for (const auto& [plane, samples] : samples_of_plane) {
    if (samples < 100) continue;
    ++planes;
    found += 2 * right_of_plane[plane] >= samples;
  }
  nlohmann::ordered_json json = {
      {"planar_samples", planar},        {"planar_samples_right_share", share(right, planar)},
      {"planes_of_100_samples", planes}, {"planes_found", found},
      {"curved_samples", curved},        {"curved_called_planar_share", share(curved_as_planar, curved)}};
  if (world_from_scan) {
    const auto error = difference(truth.world_from_scan, *world_from_scan);
    json["pose_error_mm"] = error.distance_m * 1000;
    json["pose_error_deg"] = error.angle_rad * 180 / M_PI;
  }
  return json;
}

}  // namespace hybrid::batch
