#include "stages/scan/sample_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hybrid::testing::sample_surface_test {
namespace {

constexpr double kWallStep = std::numbers::pi / 180;

// The wall x = 2 seen under up to 60 degrees, one degree apart.
RangeImage wall_by_degrees() {
  RangeImage image = make_range_image(61, 121);
  for (int r = 0; r < 61; ++r) image.elevation_rad[static_cast<std::size_t>(r)] = (30 - r) * kWallStep;
  for (int c = 0; c < 121; ++c) image.azimuth_rad[static_cast<std::size_t>(c)] = (c - 60) * kWallStep;
  for (int r = 0; r < 61; ++r)
    for (int c = 0; c < 121; ++c) {
      const std::size_t i = image.index(r, c);
      const double el = image.elevation_rad[static_cast<std::size_t>(r)],
                   az = image.azimuth_rad[static_cast<std::size_t>(c)];
      const double range = 2 / (std::cos(el) * std::cos(az));
      image.range_m[i] = static_cast<float>(range);
      image.x[i] = 2;
      image.y[i] = static_cast<float>(range * std::cos(el) * std::sin(az));
      image.z[i] = static_cast<float>(range * std::sin(el));
      image.mask[i] = kMeasured;
    }
  return image;
}

}  // namespace

TEST(SampleSurface, knows_normal_and_spacing_of_a_wall) {
  RangeImage image = wall_by_degrees();
  const double step = kWallStep;
  const PlaneSegmentation none;
  for (int c : {0, 30, 60, 120}) {
    const auto surface = stages::SampleSurfaces(image, none).at(30, c);
    EXPECT_NEAR(surface.normal.x(), -1, 1e-4);
    const double cosine = std::cos((c - 60) * step);
    // Half the diagonal of the patch; 3 %, because neighbours a degree apart are not the derivative.
    const double down_m = step * 2 / cosine, radius_m = 0.5 * std::hypot(down_m, down_m / cosine);
    EXPECT_NEAR(surface.radius_m, radius_m, 0.03 * radius_m);
  }
  // A sample alone in space tells no normal; its supercluster does.
  for (std::size_t i = 0; i < image.count(); ++i)
    if (i != image.index(30, 60)) image.mask[i] = kEmpty;
  EXPECT_EQ(stages::SampleSurfaces(image, none).at(30, 60).normal, Vec3(Vec3::Zero()));
  PlaneSegmentation segmentation;
  segmentation.sample_label.assign(image.count(), 1);
  segmentation.superclusters.resize(1);
  segmentation.superclusters[0].plane.normal = -Vec3::UnitX();
  EXPECT_EQ(stages::SampleSurfaces(image, segmentation).at(30, 60).normal, Vec3(-Vec3::UnitX()));
}

TEST(SampleSurface, ends_at_an_edge) {
  // From column 60 on the wall lies 68 cm, 19 spacings of the near side and 15 of the far one, farther away.
  RangeImage stepped = wall_by_degrees();
  for (int r = 0; r < stepped.rows; ++r)
    for (int c = 60; c < stepped.cols; ++c) {
      const std::size_t i = stepped.index(r, c);
      for (auto* channel : {&stepped.range_m, &stepped.x, &stepped.y, &stepped.z}) (*channel)[i] *= 1.34f;
    }
  const PlaneSegmentation none;
  for (int c = 56; c < 64; ++c)
    EXPECT_NEAR(stages::SampleSurfaces(stepped, none).at(30, c).normal.x(), -1, 1e-4) << c;
  // There 10 cm of the wall, three spacings, are missing: samples beside reach half a spacing over on that
  // side.
  RangeImage slit = wall_by_degrees();
  for (int r = 0; r < slit.rows; ++r)
    for (int c = 60; c < slit.cols; ++c) slit.y[slit.index(r, c)] += 0.1f;
  const double spacing_m = 2 * kWallStep, at_edge_m = 0.5 * std::hypot(spacing_m, 1.5 * spacing_m);
  for (int c : {59, 60})
    EXPECT_NEAR(stages::SampleSurfaces(slit, none).at(30, c).radius_m, at_edge_m, 0.02 * at_edge_m) << c;
  EXPECT_NEAR(stages::SampleSurfaces(slit, none).at(30, 57).radius_m, std::sqrt(0.5) * spacing_m,
              0.02 * spacing_m);
}

}  // namespace hybrid::testing::sample_surface_test
