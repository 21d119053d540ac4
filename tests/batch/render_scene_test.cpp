#include <gtest/gtest.h>

#include "batch/render_unit.hpp"

namespace hybrid::testing {
namespace {

// The front of a thing at y = 2 before a wall at y = 4, as a scanner at the origin sees them.
batch::ScanProduct thing_before_wall() {
  constexpr int kRows = 40, kCols = 60;
  constexpr double kStep_rad = 0.02;
  batch::ScanProduct product;
  RangeImage& image = product.image = make_range_image(kRows, kCols);
  for (int row = 0; row < kRows; ++row)
    for (int col = 0; col < kCols; ++col) {
      const double el = kStep_rad * (kRows / 2 - row), az = std::acos(0.0) + kStep_rad * (col - kCols / 2);
      image.elevation_rad[static_cast<std::size_t>(row)] = el;
      image.azimuth_rad[static_cast<std::size_t>(col)] = az;
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const Vec3 near = 2 / ray.y() * ray;
      const Vec3 point = std::abs(near.x()) < 0.3 && std::abs(near.z()) < 0.3 ? near : Vec3(2 * near);
      const std::size_t i = image.index(row, col);
      image.range_m[i] = static_cast<float>(point.norm());
      image.x[i] = static_cast<float>(point.x());
      image.y[i] = static_cast<float>(point.y());
      image.z[i] = static_cast<float>(point.z());
      image.mask[i] = kMeasured;
    }
  product.segmentation.sample_label.assign(image.count(), 0);
  product.stray.assign(image.count(), stages::kNotStray);
  product.drawn.assign(image.count(), stages::kDrawn);
  return product;
}

}  // namespace

TEST(RenderScene, curtains_hang_where_registered_scans_stand_in_the_world_and_only_when_asked_for) {
  const std::vector<batch::ScanProduct> products = {thing_before_wall(), thing_before_wall()};
  const Pose world_from_scan{1, Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Vec3::UnitZ())), {10, 20, 3}};
  std::vector<std::optional<batch::ScanRegistration>> registrations(2);  // the second has no pose
  registrations[0].emplace();
  registrations[0]->icp.world_from_scan = world_from_scan;
  const auto with = [&](double unseen_m) {
    return batch::build_render_scene({}, products, registrations, {}, {}, unseen_m).curtains;
  };
  EXPECT_TRUE(with(0).empty());
  const auto curtains = with(0.5);
  EXPECT_NEAR(static_cast<double>(curtains.size()), 4 * 15, 8);  // its outline, in nodes
  const Pose scan_from_world = world_from_scan.inverse();
  for (const stages::Curtain& curtain : curtains)
    for (const Vec3& corner : curtain) {
      const Vec3 at = scan_from_world * corner;
      EXPECT_NEAR(std::max(std::abs(at.x()), std::abs(at.z())) / at.y(), 0.15, 0.03);
      EXPECT_GT(at.y(), 1.9);
      EXPECT_LT(at.y(), 2.7);
    }
  registrations[0].reset();
  EXPECT_TRUE(with(0.5).empty());
}

TEST(RenderScene, views_of_nothing_are_named) {
  const auto views = [](double a, double b) {
    return nlohmann::ordered_json{{{"name", "a"}, {"surface_share", a}},
                                  {{"name", "round/0001"}, {"surface_share", b}}};
  };
  EXPECT_EQ(batch::empty_views(nlohmann::ordered_json::array()), "");
  EXPECT_EQ(batch::empty_views(views(0.01, 1)), "");
  const std::string words = batch::empty_views(views(0.5, 0));
  EXPECT_NE(words.find("1 of 2 views show nothing of model and scans (round/0001)"), std::string::npos)
      << words;
}

}  // namespace hybrid::testing
