// Patches of a few squares in front of a wall: parts of one small plane, or two of them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "device.hpp"
#include "stages/box_room.hpp"
#include "stages/planes/superclusters.hpp"
#include "stages/room_scan.hpp"

namespace hybrid::testing::small_plane_parts_test {
namespace {

constexpr int kRows = 60, kCols = 240;
constexpr double kStep = 0.005, kNoise_m = 0.002;

struct Patch {
  int row, col;
  double offset_m;  // of its plane, which faces the scanner along x
  double noise_m = kNoise_m;
  int rows = 12, cols = 14;
  bool has(int r, int c) const { return r >= row && r < row + rows && c >= col && c < col + cols; }
};

// `open`: nothing comes back from around the patches, where the wall would show that they are apart.
RangeImage scan_patches(const std::vector<Patch>& patches, unsigned seed, bool open = false) {
  RangeImage image = make_range_image(kRows, kCols);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int row = 0; row < kRows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = 0.15 - kStep * row;
  for (int col = 0; col < kCols; ++col) image.azimuth_rad[static_cast<std::size_t>(col)] = -0.6 + kStep * col;
  for (int row = 0; row < kRows; ++row)
    for (int col = 0; col < kCols; ++col) {
      const std::size_t i = image.index(row, col);
      const Vec3 ray = direction(image.elevation_rad[static_cast<std::size_t>(row)],
                                 image.azimuth_rad[static_cast<std::size_t>(col)]);
      double offset_m = 5, noise_m = kNoise_m;
      bool empty = open && row >= 15 && row < 57;
      for (const Patch& patch : patches)
        if (patch.has(row, col)) offset_m = patch.offset_m, noise_m = patch.noise_m, empty = false;
      if (empty) continue;
      const double range = offset_m / ray.x() + noise_m * normal(random);
      image.x[i] = static_cast<float>(range * ray.x());
      image.y[i] = static_cast<float>(range * ray.y());
      image.z[i] = static_cast<float>(range * ray.z());
      image.range_m[i] = static_cast<float>(range);
      image.mask[i] = kMeasured;
    }
  return image;
}

PlaneSegmentation segment(const RangeImage& image) {
  return stages::grow_superclusters(queue(), image, fit_squares(image, 5, kNoise_m));
}

// Labels inside a patch, and the share of its samples that have them.
std::pair<std::set<std::uint32_t>, double> labels_of(const RangeImage& image, const PlaneSegmentation& found,
                                                     const Patch& patch) {
  std::set<std::uint32_t> labels;
  int labelled = 0;
  for (int row = patch.row; row < patch.row + patch.rows; ++row)
    for (int col = patch.col; col < patch.col + patch.cols; ++col)
      if (const std::uint32_t label = found.sample_label[image.index(row, col)]; label != 0) {
        labels.insert(label);
        labelled += 1;
      }
  return {labels, labelled / static_cast<double>(patch.rows * patch.cols)};
}

}  // namespace

// A patch 20 cm wide tells where its plane passes 2 m beside it to a centimetre or so: the plane of both
// tells it everywhere.
TEST(SmallPlaneParts, far_parts_of_one_plane_are_one_and_keep_their_samples) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Patch left{20, 40, 3}, right{24, 186, 3};
    const RangeImage image = scan_patches({left, right}, seed, true);
    const auto found = segment(image);
    EXPECT_EQ(found.superclusters.size(), 2u) << seed;  // and the wall
    for (const Patch& patch : {left, right}) {
      const auto [labels, share] = labels_of(image, found, patch);
      EXPECT_EQ(labels.size(), 1u) << seed;
      EXPECT_GT(share, 0.95) << seed;
    }
  }
}

// Each is too narrow to tell how it is turned about its own length.
TEST(SmallPlaneParts, a_rail_and_a_post_eleven_millimetres_behind_it_are_two_planes) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Patch rail{18, 90, 3, kNoise_m, 4, 70}, post{24, 92, 3.011, kNoise_m, 30, 3};
    const RangeImage image = scan_patches({rail, post}, seed, true);
    const auto found = segment(image);
    EXPECT_EQ(found.superclusters.size(), 3u) << seed;
    const auto of_rail = labels_of(image, found, rail), of_post = labels_of(image, found, post);
    EXPECT_NE(of_rail.first, of_post.first) << seed;
    EXPECT_GT(std::min(of_rail.second, of_post.second), 0.9) << seed;
  }
}

// Three metres beside it the large plane, 22 cm wide, is as uncertain as the small one is off: the planes
// agree, but few samples of the one lie on the other, which would not get them.
TEST(SmallPlaneParts, a_patch_behind_where_an_uncertain_plane_passes_keeps_its_samples) {
  for (unsigned seed = 1; seed <= 16; ++seed) {
    const Patch large{16, 10, 3, 1.4 * kNoise_m, 40, 15}, small{24, 220, 3.0125};
    const RangeImage image = scan_patches({large, small}, seed, true);
    const auto found = segment(image);
    EXPECT_GT(labels_of(image, found, large).second, 0.9) << seed;
    EXPECT_GT(labels_of(image, found, small).second, 0.9) << seed;
  }
}

// The noise of a scan is learnt from its large planes; a small one may have more (a dark, glossy surface).
TEST(SmallPlaneParts, a_plane_noisier_than_the_others_is_one) {
  int found_planes = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Patch patch{20, 110, 3, 1.4 * kNoise_m};
    const RangeImage image = scan_patches({patch}, seed);
    const auto [labels, share] = labels_of(image, segment(image), patch);
    found_planes += labels.size() == 1 && share > 0.9;
  }
  EXPECT_EQ(found_planes, 8);
}

}  // namespace hybrid::testing::small_plane_parts_test
