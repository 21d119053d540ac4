#include "marks.hpp"
#include "score/read/model_files.hpp"

namespace score_tests {

TEST_F(PerfectRoom, an_opening_that_stays_closed_is_not_open) {
  Results results = perfect();
  results.polygons.push_back(truth().openings[0].ring);
  const auto marks = marks_of(results);
  EXPECT_EQ(marks["openings"]["openings"][0]["open_share"], 0.0);
  expect_others_hold(marks, {"/openings/openings/0/open_share"});
}

TEST_F(PerfectRoom, a_face_that_is_gone_is_wrongly_open) {
  Results results = perfect();
  results.polygons.erase(results.polygons.begin());  // the floor
  const auto marks = marks_of(results);
  EXPECT_GT(marks["openings"]["wrongly_open_m2"], 50);
  expect_others_hold(marks, {"/openings/wrongly_open_m2"});
}

TEST_F(PerfectRoom, an_opening_that_is_not_reported_is_counted) {
  Results results = perfect();
  results.reported.erase(results.reported.begin());
  const auto marks = marks_of(results);
  EXPECT_EQ(marks["openings"]["openings"][0]["reported_share"], 0.0);
  EXPECT_TRUE(marks["openings"]["openings"][0]["border_m"].is_null());
  EXPECT_EQ(marks["openings"]["of_500_rays"]["found"],
            marks["openings"]["of_500_rays"]["openings"].get<int>() - 1);
  expect_others_hold(marks, {"/openings/openings/0/reported_share", "/openings/openings/0/border_m",
                             "/openings/of_500_rays/found", "/openings/of_500_rays/border_within_bound"});
}

TEST_F(PerfectRoom, an_opening_reported_beside_its_place_is_found_and_off_its_border) {
  Results results = perfect();
  auto& ring = results.reported[0];
  const score::Vec3 aside = 0.2 * (ring[1] - ring[0]).normalized();
  for (auto& p : ring) p += aside;
  const auto marks = marks_of(results)["openings"];
  ASSERT_GE(marks["openings"][0]["rays"], 500);
  EXPECT_NEAR(marks["openings"][0]["border_m"], 0.2, 0.01);
  EXPECT_GT(marks["openings"][0]["border_m"], marks["openings"][0]["border_bound_m"]);
  EXPECT_EQ(marks["of_500_rays"]["found"], marks["of_500_rays"]["openings"]);
  EXPECT_EQ(marks["of_500_rays"]["border_within_bound"], marks["of_500_rays"]["openings"].get<int>() - 1);
  EXPECT_EQ(marks["false_openings"], 0);
}

TEST_F(PerfectRoom, an_opening_that_is_not_there_is_wrongly_reported) {
  Results results = perfect();
  results.reported.push_back({{2, 2, 0}, {3, 2, 0}, {3, 3, 0}, {2, 3, 0}});  // a square metre of the floor
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["openings"]["wrongly_reported_m2"], 1, 0.05);
  EXPECT_EQ(marks["openings"]["false_openings"], 1);
  expect_others_hold(marks, {"/openings/wrongly_reported_m2", "/openings/false_openings"});
}

}  // namespace score_tests
