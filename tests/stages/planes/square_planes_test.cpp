#include "stages/planes/square_planes.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "core/error.hpp"
#include "device.hpp"
#include "shared/params_square_planes.h"
#include "stages/room_scan.hpp"
#include "stages/scan/range_noise.hpp"

namespace hybrid::testing {
namespace {

using stages::fit_square_planes;
using stages::SquarePlaneOptions;
using stages::SquarePlanes;

double angle(const SquareRecord& record, const Vec3& normal) {
  const Vec3 found(record.normal[0], record.normal[1], record.normal[2]);
  return std::atan2(found.cross(normal).norm(), found.dot(normal));
}

const SquareRecord& square_at(const SquarePlanes& planes, int row, int col) {
  return planes.squares[static_cast<std::size_t>(row * planes.cols + col)];
}

SquarePlaneOptions with_noise(double sigma_m) {
  SquarePlaneOptions options;
  options.sigma_m = sigma_m;
  return options;
}

// How many rays of a whole square meet each face of the room; one entry: a square on one face.
struct FaceShare {
  Vec3 normal;
  double offset;
  int rays;
};
std::vector<FaceShare> faces(const RangeImage& image, int side, int square_row, int square_col) {
  std::vector<FaceShare> found;
  for (int k = 0; k < side * side; ++k) {
    const Vec3 ray = direction(image.elevation_rad[static_cast<std::size_t>(square_row * side + k / side)],
                               image.azimuth_rad[static_cast<std::size_t>(square_col * side + k % side)]);
    const auto hit = Room{}.cast(ray);
    const double offset = hit.normal.dot(hit.range_m * ray);
    const auto same = std::find_if(found.begin(), found.end(), [&](const auto& f) {
      return f.normal == hit.normal && std::abs(f.offset - offset) < 1e-6;
    });
    if (same == found.end())
      found.push_back({hit.normal, offset, 1});
    else
      ++same->rays;
  }
  return found;
}

}  // namespace

TEST(SquarePlanes, walls_are_planar_with_the_right_normal_and_honest_sigma) {
  const RangeImage image = image_room(200, 400, 0.01, 0.002);
  const SquarePlanes planes = fit_square_planes(queue(), image);
  ASSERT_EQ(planes.rows, 40);
  ASSERT_EQ(planes.cols, 80);
  double squares = 0, on_walls = 0, planar = 0, worst = 0;
  for (int r = 0; r < planes.rows; ++r)
    for (int c = 0; c < planes.cols; ++c) {
      const auto met = faces(image, 5, r, c);
      if (met.size() > 1) continue;
      const SquareRecord& record = square_at(planes, r, c);
      on_walls += 1;
      if (record.state != SQUARE_PLANAR) continue;
      planar += 1;
      const double off = angle(record, met[0].normal) / record.sigma_normal;
      squares += off * off;
      worst = std::max(worst, off);
      ASSERT_LT(record.offset, 0);
      ASSERT_LT(angle(record, met[0].normal), 0.5);
    }
  EXPECT_GT(planar, 0.99 * on_walls);
  // sigma_normal covers both degrees of freedom of a direction: 1 in the mean square.
  EXPECT_NEAR(std::sqrt(squares / planar), 1, 0.2);
  EXPECT_LT(worst, 6);
}

TEST(SquarePlanes, squares_across_edges_and_jumps_are_not_planar) {
  const RangeImage image = image_room(200, 400, 0.01, 0.0005);
  const SquarePlanes planes = fit_square_planes(queue(), image);
  int mixed = 0, called_planar = 0;
  for (int r = 0; r < planes.rows; ++r)
    for (int c = 0; c < planes.cols; ++c) {
      const auto met = faces(image, 5, r, c);
      // With a quarter or less in the minority one face alone may hold 80 %.
      if (std::any_of(met.begin(), met.end(), [](const auto& f) { return f.rays > 18; })) continue;
      ++mixed;
      called_planar += square_at(planes, r, c).state == SQUARE_PLANAR;
    }
  EXPECT_GT(mixed, 50);
  EXPECT_LE(called_planar, mixed / 20);
}

TEST(SquarePlanes, few_samples_are_undersampled_and_partial_squares_count_against_whole_ones) {
  RangeImage image = image_room(23, 44, 0.01, 0.001);
  for (int k = 0; k < 8; ++k) make_empty(image, k / 5, k % 5);      // 17 of 25 left: 68 %
  for (int k = 0; k < 7; ++k) make_empty(image, k / 5, 5 + k % 5);  // 18: 72 %
  const SquarePlanes planes = fit_square_planes(queue(), image, with_noise(0.001));
  ASSERT_EQ(planes.rows, 5);
  ASSERT_EQ(planes.cols, 9);
  EXPECT_EQ(square_at(planes, 0, 0).state, SQUARE_UNDERSAMPLED);
  EXPECT_EQ(square_at(planes, 0, 0).valid, 17u);
  EXPECT_NE(square_at(planes, 0, 1).state, SQUARE_UNDERSAMPLED);
  EXPECT_EQ(square_at(planes, 0, 1).valid, 18u);
  EXPECT_EQ(square_at(planes, 4, 0).valid, 15u);  // 3 of 5 rows
  EXPECT_EQ(square_at(planes, 4, 0).state, SQUARE_UNDERSAMPLED);
  EXPECT_EQ(square_at(planes, 1, 8).valid, 20u);  // 4 of 5 columns: enough
  EXPECT_NE(square_at(planes, 1, 8).state, SQUARE_UNDERSAMPLED);
}

TEST(SquarePlanes, tiles_change_nothing) {
  RangeImage image = image_room(203, 411, 0.01, 0.002);
  for (int k = 0; k < 20000; k += 3) make_empty(image, k % 203, k % 411);
  for (const int side : {3, 5, 16}) {
    SquarePlaneOptions options;
    options.square = side;
    options.tile = 64;
    const auto small = fit_square_planes(queue(), image, options);
    options.tile = 1024;
    const auto large = fit_square_planes(queue(), image, options);
    EXPECT_TRUE(same_bits(small.squares, large.squares)) << side;
    EXPECT_EQ(small.sigma_m, large.sigma_m);
  }
}

TEST(SquarePlanes, range_noise_is_estimated_from_the_scan) {
  for (const double noise : {0.0005, 0.002, 0.01}) {
    EXPECT_NEAR(stages::estimate_range_noise(image_room(200, 400, 0.01, noise)), noise, 0.25 * noise);
    EXPECT_NEAR(stages::estimate_range_noise(image_room(600, 1200, 0.002, noise)), noise, 0.25 * noise);
  }
  EXPECT_EQ(stages::estimate_range_noise(image_room(100, 100, 0.01, 0)), 1e-4);
  EXPECT_EQ(stages::estimate_range_noise(make_range_image(100, 100)), 1e-4);
  EXPECT_EQ(stages::estimate_range_noise(make_range_image(0, 0)), 1e-4);
}

TEST(SquarePlanes, outliers_turn_the_eigen_fit_but_not_ransac) {
  RangeImage image = image_room(100, 200, 0.01, 0.001);
  for (int r = 0; r < 100; r += 5)
    for (int c = 0; c < 200; c += 5) {  // one sample of each square 20 cm nearer: a mixed pixel
      const std::size_t i = image.index(r + (r / 5) % 5, c + (c / 5) % 5);
      const float nearer = 1 - 0.2f / image.range_m[i];
      image.x[i] *= nearer;
      image.y[i] *= nearer;
      image.z[i] *= nearer;
    }
  const auto share_right = [&](const SquarePlaneOptions& options) {
    const SquarePlanes planes = fit_square_planes(queue(), image, options);
    double right = 0, all = 0;
    for (int r = 0; r < planes.rows; ++r)
      for (int c = 0; c < planes.cols; ++c) {
        const auto met = faces(image, 5, r, c);
        if (met.size() > 1) continue;
        const SquareRecord& record = square_at(planes, r, c);
        all += 1;
        right += record.state == SQUARE_PLANAR && angle(record, met[0].normal) < 0.05;
      }
    return right / all;
  };
  auto options = with_noise(0.001);
  EXPECT_GT(share_right(options), 0.97);
  options.score = "paper";
  EXPECT_GT(share_right(options), 0.97);
  options.fit = "eigen";
  EXPECT_LT(share_right(options), 0.5);
}

TEST(SquarePlanes, an_empty_image_has_no_squares_and_one_sample_one) {
  EXPECT_TRUE(fit_square_planes(queue(), make_range_image(0, 0)).squares.empty());
  const auto one = fit_square_planes(queue(), image_room(1, 1, 0.01, 0));
  ASSERT_EQ(one.squares.size(), 1u);
  EXPECT_EQ(one.squares[0].state, SQUARE_UNDERSAMPLED);
  EXPECT_EQ(one.squares[0].valid, 1u);
}

TEST(SquarePlanes, triplets_name_three_samples_that_span_an_area) {
  for (int side = 3; side <= 16; ++side) {
    const auto triplets = stages::sample_triplets(side, 1);
    ASSERT_EQ(triplets.size(), SQUARE_TRIPLETS);
    for (const auto triplet : triplets) {
      const int a = triplet & 255, b = triplet >> 8 & 255, c = static_cast<int>(triplet >> 16);
      ASSERT_LT(std::max({a, b, c}), side * side);
      ASSERT_NE((b / side - a / side) * (c % side - a % side), (c / side - a / side) * (b % side - a % side));
    }
  }
}

TEST(SquarePlanes, its_options_have_the_ranges_they_say) {
  SquarePlaneOptions options;
  for (const auto& row : stages::square_plane_option_table()) {
    EXPECT_NO_THROW(set_option(options, row, get_option(options, row))) << row.name;
    EXPECT_THROW(set_option(options, row, OptionValue{std::string("of no such kind")}), Error) << row.name;
  }
  options.square = 17;
  EXPECT_THROW(fit_square_planes(queue(), make_range_image(9, 9), options), Error);
}

}  // namespace hybrid::testing
