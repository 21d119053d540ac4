// Scans that nobody meant to make, through all stages of one scan: a clear error or a result that holds
// together, never a crash, a plane of NaN or an invalid polygon.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "batch/orthophotos.hpp"
#include "batch/scan_unit.hpp"
#include "device.hpp"
#include "geometry/vectors.hpp"
#include "io/files.hpp"
#include "stages/contours/rings_check.hpp"

namespace hybrid::batch::odd_scans_test {
namespace {

using testing::queue;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
using Point = std::array<float, 3>;

Scan cloud(const std::vector<Point>& points) {
  Scan scan;
  scan.name = "odd";
  scan.points = points;
  return scan;
}

// Column by column.
template <typename At>
Scan grid(int rows, int cols, const At& at) {
  Scan scan;
  scan.name = "odd";
  scan.grid_rows = rows;
  scan.grid_cols = cols;
  for (int col = 0; col < cols; ++col)
    for (int row = 0; row < rows; ++row) scan.points.push_back(at(row, col));
  return scan;
}

// The direction of a node of a grid that spans 60 by 40 degrees.
Vec3 ray(int row, int col) {
  const double elevation = -0.35 + 0.01 * row, azimuth = -0.5 + 0.01 * col;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}
Point scaled(const Vec3& direction, double range) {
  return {static_cast<float>(range * direction.x()), static_cast<float>(range * direction.y()),
          static_cast<float>(range * direction.z())};
}

void expect_sound(const Scan& scan, const ScanProduct& product) {
  const auto& image = product.image;
  const auto& segmentation = product.segmentation;
  ASSERT_EQ(segmentation.sample_label.size(), image.count());
  std::vector<std::int64_t> samples(segmentation.superclusters.size() + 1);
  for (std::size_t i = 0; i < image.count(); ++i) {
    ASSERT_LE(segmentation.sample_label[i], segmentation.superclusters.size());
    if (image.mask[i] != kMeasured) continue;
    ++samples[segmentation.sample_label[i]];
    ASSERT_TRUE(std::isfinite(image.x[i]) && std::isfinite(image.y[i]) && std::isfinite(image.z[i]));
    ASSERT_LT(image.source[i], scan.points.size());
  }
  for (const Supercluster& plane : segmentation.superclusters) {
    EXPECT_NEAR(plane.plane.normal.norm(), 1, 1e-9);
    EXPECT_TRUE(std::isfinite(plane.plane.offset_m) && std::isfinite(plane.rms_m) &&
                std::isfinite(plane.area_m2));
    EXPECT_EQ(plane.samples, samples[plane.id]);
    testing::expect_valid_contours(plane);
  }
  // Nothing is lost: every point with a return is on a node, beside the grid or a repetition.
  EXPECT_EQ(product.decimation.measured + static_cast<std::int64_t>(image.duplicates.size()),
            product.input_returns);
  EXPECT_LE(product.decimation.discarded, product.decimation.measured);
  EXPECT_TRUE(std::isfinite(product.sigma_m));
}

// Both as it is and with options at the ends of their ranges; then all files are written.
void expect_handled(const Scan& scan, const char* error = nullptr) {
  for (const int square : {0, 3, 16}) {
    SCOPED_TRACE(square);
    StageOptions options;
    if (square > 0) options.set_square(std::int64_t{square});
    Progress progress(true);
    if (error) {
      const auto message =
          testing::error_of(ErrorKind::input, [&] { process_scan(queue(), "odd", scan, options, progress); });
      EXPECT_TRUE(testing::holds(message, error));
      continue;
    }
    const auto [product, remains] = process_scan(queue(), "odd", scan, options, progress);
    expect_sound(scan, product);
    const testing::TemporaryFolder folder;
    write_plane_outputs(folder.path(), product, remains, {});
    write_detail(folder.path(), product, remains, nullptr);
    write_samples(folder.path(), product, remains);
  }
}

}  // namespace

TEST(OddScans, without_any_return) {
  expect_handled(cloud({}), "expected returns, found none among 0 samples");
  expect_handled(cloud(std::vector<Point>(1000, {kNaN, kNaN, kNaN})), "expected returns");
  expect_handled(cloud(std::vector<Point>(1000, {0, 0, 0})), "expected returns");
  expect_handled(grid(50, 60,
                      [](int, int) {
                        return Point{kNaN, kInfinity, -kInfinity};
                      }),
                 "expected returns");
}

TEST(OddScans, with_one_return) {
  expect_handled(cloud({{1, 2, 3}}), "no columns found among 1 samples");
  expect_handled(grid(50, 60, [](int row, int col) {
    return row == 20 && col == 30 ? scaled(ray(row, col), 5) : Point{kNaN, kNaN, kNaN};
  }));
}

TEST(OddScans, with_the_same_point_again_and_again) {
  expect_handled(cloud(std::vector<Point>(5000, {1, 2, 3})), "no columns found");
  expect_handled(grid(40, 40, [](int, int) { return Point{1, 2, 3}; }));
}

TEST(OddScans, in_line) {
  std::vector<Point> line, ray_out;
  for (int i = 1; i <= 3000; ++i) {
    line.push_back({5, 0.01f * static_cast<float>(i - 1500), 0});
    ray_out.push_back({0.01f * static_cast<float>(i), 0, 0});  // all in one direction
  }
  expect_handled(cloud(line), "no columns found");
  expect_handled(cloud(ray_out), "no columns found");
  expect_handled(grid(2, 2, [](int row, int col) { return scaled(ray(row, col), 5); }));
  expect_handled(grid(3, 3, [](int row, int col) { return scaled(ray(row, col), 5 / ray(row, col).x()); }));
  expect_handled(grid(200, 2, [](int row, int col) { return scaled(ray(row, col), 5); }));
}

TEST(OddScans, one_plane_fills_the_view) {
  expect_handled(
      grid(70, 100, [](int row, int col) { return scaled(ray(row, col), 5 / ray(row, col).x()); }));
}

TEST(OddScans, ranges_beyond_reason) {
  expect_handled(grid(60, 60, [](int row, int col) { return scaled(ray(row, col), row < 30 ? 1e30 : 5); }));
  expect_handled(grid(60, 60, [](int row, int col) { return scaled(ray(row, col), row < 30 ? 1e-30 : 5); }));
  expect_handled(
      grid(60, 60, [](int row, int col) { return scaled(ray(row, col), col < 30 ? 3e38 : 1e-42); }));
  expect_handled(
      grid(60, 60, [](int row, int col) { return scaled(ray(row, col), (row + col) % 2 ? -5 : 5); }));
}

TEST(OddScans, at_random) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  std::vector<Point> points;
  for (int i = 0; i < 20'000; ++i) points.push_back({normal(random), normal(random), normal(random)});
  expect_handled(cloud(points), "no columns found");
  expect_handled(grid(100, 200, [&](int row, int col) {
    return scaled(ray(row, col), 3 + std::abs(static_cast<double>(normal(random))));
  }));
}

TEST(OddScans, with_rows_that_repeat) {
  expect_handled(grid(60, 60, [](int row, int col) { return scaled(ray(row / 10, col), 5); }));
  expect_handled(grid(60, 60, [](int row, int) { return scaled(ray(row, 7), 5); }));
}

}  // namespace hybrid::batch::odd_scans_test
