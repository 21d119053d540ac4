#include "stages/contours/orthophoto.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "stages/room_scan.hpp"
#include "stages/scan/node_lookup.hpp"

namespace hybrid::testing::orthophoto_test {
namespace {

// A wall at x = 4, seen straight on over 60 degrees: bright left of the scanner's axis (y > 0), dark right of
// it, with a square hole where another surface stands before it.
struct Wall {
  RangeImage image = make_range_image(120, 160);
  PlaneSegmentation segmentation;

  Wall() {
    image.intensity.assign(image.count(), 0);
    segmentation.sample_label.assign(image.count(), 1);
    for (int row = 0; row < image.rows; ++row)
      image.elevation_rad[static_cast<std::size_t>(row)] = 0.3 - 0.005 * row;
    for (int col = 0; col < image.cols; ++col)
      image.azimuth_rad[static_cast<std::size_t>(col)] = -0.4 + 0.005 * col;
    Supercluster plane{.id = 1, .plane = {{-1, 0, 0}, -4}, .contours = {}};
    for (std::size_t node = 0; node < image.count(); ++node) {
      const auto row = node / static_cast<std::size_t>(image.cols),
                 col = node % static_cast<std::size_t>(image.cols);
      const Vec3 ray = direction(image.elevation_rad[row], image.azimuth_rad[col]);
      const Vec3 point = ray * (4 / ray.x());
      image.x[node] = static_cast<float>(point.x());
      image.y[node] = static_cast<float>(point.y());
      image.z[node] = static_cast<float>(point.z());
      image.mask[node] = kMeasured;
      image.intensity[node] = point.y() > 0 ? 1.0f : 0.0f;
      if (std::abs(point.y() - 0.5) < 0.2 && std::abs(point.z()) < 0.2) segmentation.sample_label[node] = 0;
    }
    plane.samples = static_cast<std::int64_t>(image.count());
    plane.area_m2 = 0.02 * 0.02 * static_cast<double>(image.count());
    plane.contours = {{{{4, 1.6, -1}, {4, -1.6, -1}, {4, -1.6, 1}, {4, 1.6, 1}}, true}};
    segmentation.superclusters = {plane};
  }
  // Grey of the pixel that shows y, z.
  int grey(const stages::Orthophoto& photo, double y, double z) const {
    const Vec3 from = Vec3(4, y, z) - photo.origin;
    const auto* pixel = photo.picture.at(static_cast<int>(std::lround(photo.right.dot(from) / photo.pixel_m)),
                                         static_cast<int>(std::lround(-photo.up.dot(from) / photo.pixel_m)));
    EXPECT_EQ(pixel[0], pixel[2]);
    return pixel[0];
  }
  std::optional<stages::Orthophoto> photo(int most = 1024) const {
    return stages::make_orthophoto(image, segmentation, segmentation.superclusters[0],
                                   stages::SampleLook(image), most);
  }
};

}  // namespace

TEST(Orthophoto, shows_the_wall_as_one_who_stands_before_it_sees_it) {
  const Wall wall;
  const auto photo = wall.photo();
  ASSERT_TRUE(photo);
  EXPECT_NEAR(photo->pixel_m, 0.02, 1e-9);
  EXPECT_NEAR((photo->up - Vec3::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR((photo->right + Vec3::UnitY()).norm(), 0, 1e-12);  // looking along +x, y is to the left
  EXPECT_EQ(wall.grey(*photo, 1, 0.5), 255);
  EXPECT_EQ(wall.grey(*photo, -1, 0.5), 70);
  EXPECT_EQ(wall.grey(*photo, 0.5, 0), 40);      // the hole
  EXPECT_EQ(wall.grey(*photo, 0.5, 0.25), 255);  // beside it
}

TEST(Orthophoto, is_no_larger_than_asked_and_shows_nothing_outside_the_scan) {
  const Wall wall;
  const auto photo = wall.photo(64);
  ASSERT_TRUE(photo);
  EXPECT_LE(std::max(photo->picture.width, photo->picture.height), 64);
  Wall larger;
  larger.segmentation.superclusters[0].contours[0].points[0] = {4, 3, -1};  // beyond the first column
  const auto wide = larger.photo();
  ASSERT_TRUE(wide);
  EXPECT_EQ(larger.grey(*wide, 2.5, 0), 40);
  EXPECT_EQ(larger.grey(*wide, 1, 0.5), 255);
}

TEST(Orthophoto, of_nothing_is_nothing) {
  Wall wall;
  wall.segmentation.superclusters[0].contours[0].points.assign(3, Vec3(4, 0, 0));
  EXPECT_FALSE(wall.photo());
  wall.segmentation.superclusters[0].contours.clear();
  EXPECT_FALSE(wall.photo());
}

// Along lines that leave the image, jump, and pass behind the scanner, of images that turn either way.
TEST(NodeWalk, says_what_the_lookup_says) {
  for (const bool turned : {false, true})
    for (const double columns_end : {1.0, 2 * std::numbers::pi}) {
      RangeImage image = make_range_image(90, 180);
      image.wraps = columns_end > 2;
      for (int row = 0; row < image.rows; ++row)
        image.elevation_rad[static_cast<std::size_t>(row)] = (turned ? -1 : 1) * (0.7 - 0.015 * row);
      for (int col = 0; col < image.cols; ++col)
        image.azimuth_rad[static_cast<std::size_t>(col)] =
            (turned ? -1 : 1) * (columns_end * (col + 0.2 * std::sin(col)) / image.cols - 0.5);
      const stages::NodeLookup lookup(image);
      stages::NodeWalk walk(lookup);
      int inside = 0, lines = 0;
      for (const Vec3& from :
           {Vec3(4, -3, -2), Vec3(4, 3, 1.9), Vec3(-2, 5, 0.3), Vec3(1, 0.01, 6), Vec3(3, -1, -0.2)})
        for (const Vec3& step :
             {Vec3(0.003, 0.011, 0.007), Vec3(-0.021, 0.002, 0.001), Vec3(-0.4, 0.2, 0.1)}) {
          ++lines;
          for (int k = 0; k < 900; ++k) {
            const Vec3 point = from + k * step;
            const auto expected = lookup.towards(point), found = walk.towards(point);
            ASSERT_EQ(found.row, expected.row) << point.transpose();
            ASSERT_EQ(found.col, expected.col) << point.transpose();
            ASSERT_EQ(found.within, expected.within) << point.transpose();
            inside += found.within;
          }
        }
      EXPECT_GT(inside, 900 * lines / 20);
      EXPECT_LT(inside, 900 * lines);
    }
}

TEST(NodeLookup, knows_the_borders_of_the_grid) {
  Wall wall;
  EXPECT_TRUE(stages::NodeLookup(wall.image).towards(direction(0.3, -0.4)).within);
  EXPECT_TRUE(stages::NodeLookup(wall.image).towards(direction(0.304, -0.404)).within);
  EXPECT_FALSE(stages::NodeLookup(wall.image).towards(direction(0.31, 0)).within);
  EXPECT_FALSE(stages::NodeLookup(wall.image).towards(direction(-0.31, 0)).within);
  EXPECT_FALSE(stages::NodeLookup(wall.image).towards(direction(0, -0.41)).within);
  EXPECT_FALSE(stages::NodeLookup(wall.image).towards(direction(0, 0.41)).within);
  EXPECT_FALSE(stages::NodeLookup(wall.image).towards(direction(0, 3)).within);
  wall.image.wraps = true;
  EXPECT_TRUE(stages::NodeLookup(wall.image).towards(direction(0, 3)).within);
  const auto node = stages::NodeLookup(wall.image).towards(direction(0.1, 0.1));
  EXPECT_EQ(node.row, 40);
  EXPECT_EQ(node.col, 100);
  // Uneven steps.
  for (int col = 0; col < wall.image.cols; ++col)
    wall.image.azimuth_rad[static_cast<std::size_t>(col)] = 1e-4 * col * col / 3;
  for (int col = 1; col < wall.image.cols; ++col)
    EXPECT_EQ(stages::NodeLookup(wall.image).towards(direction(0, 1e-4 * col * col / 3 + 1e-6)).col, col);
}

}  // namespace hybrid::testing::orthophoto_test
