#include "stages/superclusters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

#include "box_room.hpp"
#include "device.hpp"

namespace hybrid::testing {
namespace {

struct Score {
  double right = 0;          // share of scored planar samples with their supercluster's majority label
  double curved_planar = 0;  // share of the column's samples with any label
  int found = 0;             // planes with at least half of their samples right
  int planes = 0;            // superclusters
};

Score score(const RoomScan& scan, const PlaneSegmentation& segmentation) {
  const std::size_t count = segmentation.superclusters.size();
  std::vector<std::array<std::int64_t, 16>> votes(count + 1);
  for (std::size_t i = 0; i < scan.truth.size(); ++i)
    votes[segmentation.sample_label[i]][scan.truth[i]] += 1;
  std::vector<std::size_t> majority(count + 1, kNothing);
  for (std::size_t k = 1; k <= count; ++k)
    majority[k] = static_cast<std::size_t>(std::max_element(votes[k].begin(), votes[k].end()) - votes[k].begin());
  std::array<std::int64_t, 16> right{}, total{};
  std::int64_t curved = 0;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    const std::uint32_t label = segmentation.sample_label[i];
    total[scan.truth[i]] += 1;
    right[scan.truth[i]] += label != 0 && majority[label] == scan.truth[i];
    curved += scan.truth[i] == kColumn && label != 0;
  }
  Score result;
  std::int64_t all = 0, all_right = 0;
  for (int face = 1; face <= kScoredPlanes; ++face) {
    const auto f = static_cast<std::size_t>(face);
    all += total[f];
    all_right += right[f];
    result.found += 2 * right[f] >= total[f] && total[f] > 0;
  }
  for (int face = 1; face <= kScoredPlanes; ++face) std::printf(" %d: %.4f of %ld |", face, double(right[face]) / total[face], (long)total[face]);
  std::puts("");
  result.right = static_cast<double>(all_right) / static_cast<double>(all);
  result.curved_planar = static_cast<double>(curved) / static_cast<double>(std::max<std::int64_t>(total[kColumn], 1));
  result.planes = static_cast<int>(count);
  return result;
}

}  // namespace

TEST(Superclusters, dev) {
  for (int fine = 0; fine < 3; ++fine)
    for (double noise : {0.0005, 0.002, 0.004}) {
      BoxRoom room;
      room.rows = 300 << fine;
      room.cols = 720 << fine;
      room.noise_m = noise;
      const auto scan = scan_room(room);
      const auto squares = fit_squares(scan.image, fine == 2 ? 10 : 5, noise);
      const auto seg = stages::grow_superclusters(queue(), scan.image, squares);
      const auto s = score(scan, seg);
      std::printf("fine %d noise %g: right %.4f found %d planes %d curved %.4f\n", fine, noise, s.right, s.found, s.planes,
                  s.curved_planar);
      for (auto& c : seg.superclusters)
        std::printf("  %u n %.4f %.4f %.4f d %.4f rms %.5f area %.3f squares %d samples %ld\n", c.id, c.plane.normal.x(),
                    c.plane.normal.y(), c.plane.normal.z(), c.plane.offset_m, c.rms_m, c.area_m2, c.squares, (long)c.samples);
    }
}

}  // namespace hybrid::testing
