#include "stages/rendering/atlas.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "cases/holed_room.hpp"
#include "core/error.hpp"
#include "lib/random.h"

namespace hybrid::testing {
namespace {

using stages::AtlasChart;

// Rectangles of pseudo-random sizes.
std::vector<AtlasChart> rectangles(std::size_t count, int most) {
  std::vector<AtlasChart> charts(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto draw = [&](std::uint32_t k) {
      return 1 +
             static_cast<int>(random_bits(3, static_cast<std::uint32_t>(i), k) % static_cast<unsigned>(most));
    };
    charts[i].width_m = 0.01 * draw(0);
    charts[i].height_m = 0.01 * draw(1);
    stages::size_chart(charts[i], 0.01, 1000);
  }
  return charts;
}

// Every texel of a page belongs to at most one chart, padding included; all charts lie on their pages.
void expect_apart(const std::vector<AtlasChart>& charts, const stages::AtlasLayout& layout, int padding) {
  for (std::size_t page = 0; page < layout.pages.size(); ++page) {
    const auto [width, height] = layout.pages[page];
    std::vector<int> uses(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    for (const AtlasChart& chart : charts) {
      if (chart.page != static_cast<int>(page)) continue;
      ASSERT_GE(chart.x - padding, 0);
      ASSERT_GE(chart.y - padding, 0);
      ASSERT_LE(chart.x + chart.cols + padding, width);
      ASSERT_LE(chart.y + chart.rows + padding, height);
      for (int y = chart.y - padding; y < chart.y + chart.rows + padding; ++y)
        for (int x = chart.x - padding; x < chart.x + chart.cols + padding; ++x)
          ++uses[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    ASSERT_LE(*std::max_element(uses.begin(), uses.end()), 1);
  }
}

}  // namespace

TEST(Atlas, a_chart_is_upright_and_its_texels_lie_on_the_face) {
  const auto room = holed_room(0, 1, 1);
  const auto& proxy = room.scene.proxy;
  for (std::uint32_t face = 0; face < proxy.faces.size(); ++face)
    for (const bool back : {false, true}) {
      AtlasChart chart = stages::make_chart(proxy, face, false, back);
      stages::size_chart(chart, 0.013, 4096);
      const Plane plane = face_plane(proxy, proxy.faces[face]);
      EXPECT_NEAR(chart.normal.dot(plane.normal), back ? -1 : 1, 1e-12);
      EXPECT_NEAR(chart.across.cross(chart.down).dot(chart.normal), -1, 1e-12);  // a picture: y runs down
      if (std::abs(plane.normal.z()) < 0.5) {
        EXPECT_NEAR(chart.down.z(), -1, 1e-12);
      }
      EXPECT_NEAR(plane.distance(chart.point(3.5, 4.5)), 0, 1e-12);
      for (const std::uint32_t vertex : proxy.faces[face].outer) {
        const Vec2 at = chart.position(proxy.vertices[vertex]);
        EXPECT_GE(at.minCoeff(), 0.5 - 1e-9);
        EXPECT_LE(at.x(), chart.cols - 0.5 + 1e-9);
        EXPECT_LE(at.y(), chart.rows - 0.5 + 1e-9);
      }
      // The mask's area is the face's, holes left out, up to half a texel along its rings.
      double outline_m = 0;
      auto rings = proxy.faces[face].holes;
      rings.push_back(proxy.faces[face].outer);
      for (const auto& ring : rings)
        for (std::size_t i = 0; i < ring.size(); ++i)
          outline_m += (proxy.vertices[ring[i]] - proxy.vertices[ring[(i + 1) % ring.size()]]).norm();
      const auto mask = stages::chart_mask(chart, proxy);
      const double area = std::accumulate(mask.begin(), mask.end(), 0.0) * chart.texel_m * chart.texel_m;
      EXPECT_NEAR(area, face_area_m2(proxy, proxy.faces[face]), 0.5 * 0.013 * outline_m) << face;
    }
}

TEST(Atlas, a_chart_larger_than_a_page_has_larger_texels) {
  AtlasChart chart;
  chart.width_m = 100;
  chart.height_m = 1;
  stages::size_chart(chart, 0.001, 500);
  EXPECT_LE(chart.cols, 500);
  EXPECT_GT(chart.cols, 480);
  EXPECT_GE(chart.cols - 1, chart.width_m / chart.texel_m);
}

TEST(Atlas, charts_never_overlap_and_the_same_charts_lie_alike) {
  auto charts = rectangles(400, 120);
  const auto layout = stages::place_charts(charts, 1024, 64, 3);
  EXPECT_GT(layout.pages.size(), 1u);
  EXPECT_EQ(layout.enlarged, 1);
  expect_apart(charts, layout, 3);
  auto again = rectangles(400, 120);
  EXPECT_EQ(stages::place_charts(again, 1024, 64, 3).pages, layout.pages);
  for (std::size_t i = 0; i < charts.size(); ++i) {
    EXPECT_EQ(charts[i].x, again[i].x);
    EXPECT_EQ(charts[i].y, again[i].y);
    EXPECT_EQ(charts[i].page, again[i].page);
  }
}

TEST(Atlas, a_full_page_is_mostly_charts) {
  auto charts = rectangles(3000, 60);
  const auto layout = stages::place_charts(charts, 1024, 64, 0);
  double texels = 0, page_texels = 0;
  for (const auto& chart : charts)
    if (chart.page == 0) texels += chart.cols * chart.rows;
  page_texels = layout.pages[0][0] * layout.pages[0][1];
  EXPECT_GT(texels / page_texels, 0.9);
}

TEST(Atlas, texels_grow_until_the_pages_suffice) {
  auto charts = rectangles(400, 120);
  const auto layout = stages::place_charts(charts, 512, 1, 2);
  EXPECT_EQ(layout.pages.size(), 1u);
  EXPECT_GT(layout.enlarged, 1.5);
  for (const auto& chart : charts) EXPECT_NEAR(chart.texel_m, 0.01 * layout.enlarged, 1e-9);
  expect_apart(charts, layout, 2);
}

TEST(Atlas, no_charts_need_no_page_and_too_many_are_an_error) {
  std::vector<AtlasChart> none;
  EXPECT_TRUE(stages::place_charts(none, 64, 1, 4).pages.empty());
  auto many = rectangles(3000, 2);
  EXPECT_THROW(stages::place_charts(many, 64, 1, 4), Error);
}

}  // namespace hybrid::testing
