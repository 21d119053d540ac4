// Hoover's rules on tables small enough to count by hand.
#include "score/measure/planes_hoover.hpp"

#include <gtest/gtest.h>

namespace score_tests {
namespace {

score::RegionTable table(const std::vector<score::RegionTable::Overlap>& overlaps,
                         const std::map<std::uint32_t, std::int64_t>& regions,
                         const std::map<std::uint32_t, std::int64_t>& planes) {
  return {overlaps, regions, planes};
}

score::HooverScore classify(const score::RegionTable& regions, double overlap) {
  return score::score_hoover(regions, overlap, 100, {}, {});
}

}  // namespace

TEST(Hoover, correct_needs_the_overlap_on_both_sides) {
  const auto regions =
      table({{1, 10, 800}}, {{1, 1000}}, {{10, 900}});  // 80 % of the region, 89 % of the plane
  EXPECT_EQ(classify(regions, 0.80).correct, 1);
  const auto stricter = classify(regions, 0.85);
  EXPECT_EQ(stricter.correct, 0);
  EXPECT_EQ(stricter.missed, 1);
  EXPECT_EQ(stricter.noise, 1);
}

TEST(Hoover, over_segmentation_needs_the_parts_to_cover_the_plane) {
  const auto regions = table({{1, 10, 450}, {2, 10, 450}}, {{1, 450}, {2, 450}}, {{10, 1000}});
  EXPECT_EQ(classify(regions, 0.90).over_segmented, 1);
  EXPECT_EQ(classify(regions, 0.90).noise, 0);
  EXPECT_EQ(classify(regions, 0.95).over_segmented, 0);
  EXPECT_EQ(classify(regions, 0.95).missed, 1);
  EXPECT_EQ(classify(regions, 0.95).noise, 2);
}

TEST(Hoover, under_segmentation_counts_the_region_and_its_planes) {
  const auto regions = table({{1, 10, 500}, {1, 11, 400}}, {{1, 900}}, {{10, 500}, {11, 400}});
  const auto score = classify(regions, 0.51);  // 56 % of the region is plane 10: the whole fits better
  EXPECT_EQ(score.correct, 0);
  EXPECT_EQ(score.under_segmented, 1);
  EXPECT_EQ(score.planes_under_segmented, 2);
  EXPECT_EQ(score.missed, 0);
}

TEST(Hoover, a_correct_region_holds_against_a_scrap_beside_it) {
  // The scrap lies wholly on the plane: over-segmentation would cover 99 % of it instead of 96 %.
  const auto regions = table({{1, 10, 960}, {2, 10, 30}}, {{1, 960}, {2, 30}}, {{10, 1000}});
  const auto score = classify(regions, 0.80);
  EXPECT_EQ(score.correct + score.over_segmented, 1);
  EXPECT_EQ(score.over_segmented, 1);  // as Hoover's rule says: the larger mean share holds
}

TEST(Hoover, every_plane_is_counted_once) {
  const auto regions =
      table({{1, 10, 90}, {1, 11, 80}, {2, 12, 70}, {3, 12, 20}, {4, 13, 5}},
            {{1, 200}, {2, 75}, {3, 25}, {4, 500}}, {{10, 100}, {11, 100}, {12, 100}, {13, 1000}});
  for (const double overlap : score::kHooverOverlaps) {
    const auto score = classify(regions, overlap);
    EXPECT_EQ(score.correct + score.over_segmented + score.planes_under_segmented + score.missed, 4)
        << overlap;
  }
}

TEST(Hoover, nothing_at_all) {
  const auto score = classify({}, 0.8);
  EXPECT_EQ(score.planes, 0);
  EXPECT_EQ(score.missed, 0);
  EXPECT_EQ(score.noise, 0);
}

TEST(Hoover, angles_do_not_care_which_way_a_normal_points) {
  const auto regions = table({{1, 10, 100}, {2, 11, 100}}, {{1, 100}, {2, 100}}, {{10, 100}, {11, 100}});
  const score::Vec3 tilted = Eigen::AngleAxisd(M_PI / 90, score::Vec3::UnitX()) * score::Vec3::UnitZ();
  const auto score = score::score_hoover(regions, 0.8, 100, {{1, -tilted}, {2, score::Vec3::UnitX()}},
                                         {{10, score::Vec3::UnitZ()}, {11, score::Vec3::UnitX()}});
  EXPECT_EQ(score.angles, 2);
  EXPECT_NEAR(score.mean_angle_deg, 1, 1e-9);
}

}  // namespace score_tests
