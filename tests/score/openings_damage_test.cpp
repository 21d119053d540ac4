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
  expect_others_hold(marks, {"/openings/openings/0/reported_share", "/openings/openings/0/border_m"});
}

TEST_F(PerfectRoom, an_opening_that_is_not_there_is_wrongly_reported) {
  Results results = perfect();
  results.reported.push_back({{2, 2, 0}, {3, 2, 0}, {3, 3, 0}, {2, 3, 0}});  // a square metre of the floor
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["openings"]["wrongly_reported_m2"], 1, 0.05);
  expect_others_hold(marks, {"/openings/wrongly_reported_m2"});
}

}  // namespace score_tests
