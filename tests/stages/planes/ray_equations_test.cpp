#include "stages/planes/ray_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hybrid::testing::ray_equations_test {
namespace {

constexpr std::uint32_t kOwn = 1, kOther = 2;
const stages::RangeNoise kNoise{0.002, 1e-4, 5e-4, 1e-5};

// A slanted wall with samples of another label, of none, mixed ones and holes here and there, right up to the
// seam.
struct Wall {
  RangeImage image = make_range_image(7, 61);
  std::vector<std::uint32_t> labels = std::vector<std::uint32_t>(image.count(), kOwn);
  stages::RayEquations::Frame frame;

  Wall() {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> percent(0, 99);
    std::normal_distribution<double> noise(0, 0.004);
    for (int row = 0; row < image.rows; ++row)
      image.elevation_rad[static_cast<std::size_t>(row)] = 0.02 - 0.0015 * row;
    for (int col = 0; col < image.cols; ++col)
      image.azimuth_rad[static_cast<std::size_t>(col)] = 0.0015 * col;
    for (std::size_t i = 0; i < image.count(); ++i) {
      const double azimuth = image.azimuth_rad[i % 61], elevation = image.elevation_rad[i / 61];
      const double range =
          3.2 / ((std::cos(azimuth) - std::sin(azimuth)) * std::cos(elevation)) + noise(random);
      image.x[i] = static_cast<float>(range * std::cos(azimuth) * std::cos(elevation));
      image.y[i] = static_cast<float>(range * std::sin(azimuth) * std::cos(elevation));
      image.z[i] = static_cast<float>(range * std::sin(elevation));
      image.mask[i] = kMeasured;
      const int dice = percent(random);
      if (dice < 3) labels[i] = kOther;
      if (dice == 4) labels[i] = 0;
      if (dice == 5) image.mask[i] = kEmpty;
    }
    const Vec3 normal = Vec3(1, -1, -0.002).normalized(), across = normal.unitOrthogonal();
    frame.axes.row(0) = normal;
    frame.axes.row(1) = across;
    frame.axes.row(2) = normal.cross(across);
    frame.m = normal * (std::sqrt(2) / 3.2);
    frame.noise = &kNoise;
  }
  bool of_plane(std::size_t i) const { return labels[i] == kOwn && image.mask[i] == kMeasured; }
  bool beside_other(int row, int col, int reach) const {
    const auto other = [&](int r, int c) {
      if (r < 0 || r >= image.rows) return false;
      const std::size_t i = image.index(r, (c + image.cols) % image.cols);
      return labels[i] != kOwn && image.mask[i] != kEmpty;
    };
    return other(row - reach, col) || other(row + reach, col) || other(row, col - reach) ||
           other(row, col + reach);
  }
};

// One sample after the other, as the header says it.
void expect_sums(const Wall& wall, const stages::RayEquations& sums) {
  std::array<double, 11> inner{}, border{};
  std::int64_t inside = 0, beside = 0, far = 0;
  for (int row = 0; row < wall.image.rows; ++row)
    for (int col = 0; col < wall.image.cols; ++col) {
      const std::size_t i = wall.image.index(row, col);
      if (!wall.of_plane(i)) continue;
      const Vec3 point = wall.image.point(i), turned = wall.frame.axes * point;
      const double range = point.norm(), r = range * (1 - wall.frame.m.dot(point));
      const double sigma = kNoise.at(range, std::abs(turned[0]) / range), u = r / (3.5 * sigma);
      if (std::abs(u) >= 1) continue;
      const double weight = std::pow(1 - u * u, 2) / (sigma * sigma);
      const bool two = 0.0075 / (0.0015 * range) >= 1.5, other = wall.beside_other(row, col, two ? 2 : 1);
      const double a = range * turned[0], b = range * turned[1], c = range * turned[2];
      const double terms[] = {
          a * a, a * b, a * c, b * b, b * c, c * c, a * r, b * r, c * r, 1, (1 - 5 * u * u) / (1 - u * u)};
      for (std::size_t t = 0; t < 11; ++t) (other ? border : inner)[t] += weight * terms[t];
      (other ? beside : inside) += 1;
      far += two ? 0 : 1;
    }
  ASSERT_GT(beside, 20);
  ASSERT_GT(far, 20);  // both widths of a border occur
  const auto in = sums.inner.total(), at = sums.border.total();
  EXPECT_EQ(in.samples, inside);
  EXPECT_EQ(at.samples, beside);
  for (std::size_t t = 0; t < 11; ++t) {
    // Of terms with a mean near zero the rounding is that of their size.
    EXPECT_NEAR(in.of[t], inner[t], 1e-12 * std::max(inner[0], inner[9])) << t;
    EXPECT_NEAR(at.of[t], border[t], 1e-12 * std::max(border[0], border[9])) << t;
  }
}

TEST(RayEquations, of_vectors_are_those_of_single_samples) {
  const Wall wall;
  stages::RayEquations sums;
  // Groups of all lengths, from one node to more than two vectors, in whatever place of a row.
  std::size_t length = 0;
  for (std::size_t i = 0; i < wall.image.count();) {
    const std::size_t count = std::min(1 + length++ % 19, (i / 61 + 1) * 61 - i);
    sums.add_nodes(wall.image, wall.labels, i, count, kOwn, wall.frame);
    i += count;
  }
  expect_sums(wall, sums);
}

}  // namespace
}  // namespace hybrid::testing::ray_equations_test
