#include "stages/planes/decimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "device.hpp"
#include "stages/box_room.hpp"
#include "stages/contours/contours.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::testing {
namespace {

// 4 x 8 samples in two squares of 4: a member and a non-planar one.
struct Small {
  RangeImage image = make_range_image(4, 8);
  PlaneSegmentation segmentation;
  std::vector<std::uint8_t> boundary;
  Small() {
    std::fill(image.mask.begin(), image.mask.end(), std::uint8_t{kMeasured});
    segmentation.square = 4;
    segmentation.square_rows = 1;
    segmentation.square_cols = 2;
    segmentation.square_class = {kSuperclusterMember, kNonPlanar};
    segmentation.square_label = {1, 0};
    segmentation.sample_label.assign(image.count(), 0);
    for (int row = 0; row < 4; ++row)
      for (int col = 0; col < 5; ++col) segmentation.sample_label[image.index(row, col)] = 1;
    boundary.assign(image.count(), 0);
  }
};

}  // namespace

TEST(Decimate, keeps_what_the_paper_keeps) {
  Small s;
  s.image.mask[s.image.index(0, 0)] = kInterpolated;
  s.image.mask[s.image.index(0, 7)] = kEmpty;
  s.boundary[s.image.index(1, 0)] = 1;
  s.segmentation.sample_label[s.image.index(2, 0)] = 0;
  s.image.extra = {5, 6, 7};
  const auto result = stages::decimate(queue(), s.image, s.segmentation, s.boundary);
  EXPECT_EQ(result.fate[s.image.index(0, 0)], stages::kNoSample);
  EXPECT_EQ(result.fate[s.image.index(0, 7)], stages::kNoSample);
  EXPECT_EQ(result.fate[s.image.index(1, 0)], stages::kBoundary);
  EXPECT_EQ(result.fate[s.image.index(2, 0)], stages::kOutlier);
  EXPECT_EQ(result.fate[s.image.index(3, 3)], stages::kDiscarded);
  EXPECT_EQ(result.fate[s.image.index(3, 4)], stages::kNonPlanarSquare);  // labelled, but the paper keeps it
  EXPECT_EQ(result.measured, 30 + 3);
  EXPECT_EQ(result.discarded, 16 - 3);
  EXPECT_DOUBLE_EQ(result.discarded_share(), 13.0 / 33);
}

TEST(Decimate, mixed_squares_on_request) {
  Small s;
  stages::DecimateOptions options;
  options.discard_in_mixed_squares = true;
  const auto result = stages::decimate(queue(), s.image, s.segmentation, s.boundary, options);
  EXPECT_EQ(result.fate[s.image.index(3, 4)], stages::kDiscarded);
  EXPECT_EQ(result.fate[s.image.index(3, 5)], stages::kNonPlanarSquare);
}

TEST(Decimate, unexplained_interiors_come_back) {
  Small s;
  auto result = stages::decimate(queue(), s.image, s.segmentation, s.boundary);
  ASSERT_EQ(result.discarded, 16);
  std::vector<std::uint8_t> explained(s.image.count(), 1);
  explained[s.image.index(0, 0)] = explained[s.image.index(0, 7)] = 0;
  stages::keep_unexplained(explained, result);
  EXPECT_EQ(result.fate[s.image.index(0, 0)], stages::kUnexplained);
  EXPECT_EQ(result.fate[s.image.index(0, 7)], stages::kNonPlanarSquare);
  EXPECT_EQ(result.discarded, 15);
  explained.pop_back();
  EXPECT_THROW(stages::keep_unexplained(explained, result), Error);
}

TEST(Decimate, box_room_loses_most_of_its_samples_and_tiles_agree) {
  const BoxRoom room;
  const auto scan = scan_room(room);
  auto segmentation =
      stages::grow_superclusters(queue(), scan.image, fit_squares(scan.image, 5, room.noise_m));
  const auto boundary = stages::trace_contours(queue(), scan.image, segmentation);
  const auto result = stages::decimate(queue(), scan.image, segmentation, boundary);
  EXPECT_GT(result.discarded_share(), 0.9);  // measured: 0.935
  EXPECT_EQ(result.measured, static_cast<std::int64_t>(scan.image.count()));
  std::int64_t column = 0, discarded = 0;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    column += scan.truth[i] == kColumn;
    discarded += scan.truth[i] == kColumn && result.fate[i] == stages::kDiscarded;
  }
  EXPECT_LT(discarded, column / 100);
  stages::DecimateOptions options;
  options.tile = 64;
  EXPECT_EQ(stages::decimate(queue(), scan.image, segmentation, boundary, options).fate, result.fate);
}

TEST(Decimate, nothing_and_wrong_extents) {
  const auto image = make_range_image(0, 0);
  PlaneSegmentation none;
  const auto result = stages::decimate(queue(), image, none, {});
  EXPECT_EQ(result.measured, 0);
  EXPECT_EQ(result.discarded_share(), 0);
  Small s;
  s.boundary.pop_back();
  EXPECT_THROW(stages::decimate(queue(), s.image, s.segmentation, s.boundary), Error);
}

}  // namespace hybrid::testing
