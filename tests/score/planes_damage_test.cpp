// Each test damages one thing in perfect results and sees its measure fail and the others hold.
#include "marks.hpp"

namespace score_tests {
namespace {

const char* const kPlanes = "/scans/0/planes/";

std::string of_planes(const std::string& name) {
  return kPlanes + name;
}

// Ids of the planes of the first scan with the most samples, largest first.
std::vector<std::uint32_t> largest_planes(const PerfectScan& scan) {
  std::map<std::uint32_t, int> sizes;
  for (const std::uint32_t label : scan.grid.label)
    if (label != 0) ++sizes[label];
  std::vector<std::uint32_t> ids;
  for (const auto& [id, size] : sizes) ids.push_back(id);
  std::sort(ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) { return sizes[a] > sizes[b]; });
  return ids;
}

}  // namespace

TEST_F(PerfectRoom, a_plane_in_two_regions_is_over_segmented) {
  Results results = perfect();
  PerfectScan& scan = results.scans[0];
  const std::uint32_t plane = largest_planes(scan)[0];
  for (int row = 0; row < scan.grid.rows; ++row)
    for (int col = 0; col < scan.grid.cols; col += 2)
      if (auto& label = scan.grid.label[scan.grid.index(row, col)]; label == plane) label = 9999;
  scan.planes[9999] = scan.planes[plane];
  const auto marks = marks_of(results);
  EXPECT_EQ(marks["scans"][0]["planes"]["hoover"][0]["over_segmented"], 1);
  EXPECT_EQ(marks["scans"][0]["planes"]["hoover"][6]["over_segmented"], 1);
  EXPECT_EQ(marks["scans"][0]["planes"]["planar_samples_right_share"], 1.0);
  expect_others_hold(marks, {of_planes("hoover/*/correct"), of_planes("hoover/*/over_segmented"),
                             of_planes("hoover/*/mean_angle_deg"), of_planes("normals/*")});
}

TEST_F(PerfectRoom, two_planes_in_one_region_are_under_segmented) {
  Results results = perfect();
  PerfectScan& scan = results.scans[0];
  const auto largest = largest_planes(scan);
  for (auto& label : scan.grid.label)
    if (label == largest[1]) label = largest[0];
  const auto marks = marks_of(results);
  const auto& planes = marks["scans"][0]["planes"];
  EXPECT_EQ(planes["hoover"][0]["under_segmented"], 1);
  EXPECT_EQ(planes["hoover"][0]["planes_under_segmented"], 2);
  EXPECT_LT(planes["planar_samples_right_share"], 0.95);
  EXPECT_EQ(planes["planes_found"], planes["planes"].get<int>() - 1);
  EXPECT_EQ(planes["planes_lost"][0], largest[1]);
  EXPECT_GT(marks["scans"][0]["decimation"]["largest_mm"], 100);  // its samples stand on the wrong polygon
  expect_others_hold(marks,
                     {of_planes("hoover/*"), of_planes("normals/*"), of_planes("planar_samples_right*"),
                      of_planes("planes_*"), of_planes("boundary/*"), "/scans/0/decimation/*_mm"});
}

TEST_F(PerfectRoom, a_plane_without_labels_is_missed) {
  Results results = perfect();
  PerfectScan& scan = results.scans[0];
  const std::uint32_t plane = largest_planes(scan)[2];
  for (auto& label : scan.grid.label)
    if (label == plane) label = 0;
  const auto marks = marks_of(results);
  const auto& planes = marks["scans"][0]["planes"];
  for (const auto& hoover : planes["hoover"]) {
    EXPECT_EQ(hoover["missed"], 1);
    EXPECT_EQ(hoover["correct"], hoover["planes"].get<int>() - 1);
  }
  EXPECT_EQ(planes["planes_lost"][0], plane);
  EXPECT_GT(planes["boundary"]["not_compared"], 0);
  EXPECT_GT(marks["scans"][0]["decimation"]["discarded_without_polygon"], 100);
  expect_others_hold(
      marks, {of_planes("hoover/*"), of_planes("normals/*"), of_planes("planar_samples_right*"),
              of_planes("planes_*"), of_planes("boundary/*/borders"), of_planes("boundary/not_compared"),
              "/scans/0/decimation/discarded_without_polygon", "/scans/0/decimation/percentile*"});
}

TEST_F(PerfectRoom, a_column_called_planar_is_noise) {
  Results results = perfect();
  PerfectScan& scan = results.scans[0];
  const auto samples = score::read_true_samples(truth().scans[0]);
  for (std::size_t i = 0; i < scan.grid.source.size(); ++i)
    if (scan.grid.source[i] != score::kNoSource && samples.kind[scan.grid.source[i]] == score::kCurved)
      scan.grid.label[i] = 9999;
  const auto marks = marks_of(results);
  EXPECT_EQ(marks["scans"][0]["planes"]["curved_called_planar_share"], 1.0);
  EXPECT_EQ(marks["scans"][0]["planes"]["hoover"][0]["noise"], 1);
  expect_others_hold(marks, {of_planes("hoover/*/noise"), of_planes("curved_called_planar_share")});
}

TEST_F(PerfectRoom, a_turned_plane_has_an_angle) {
  Results results = perfect();
  auto& plane = results.scans[0].planes.at(largest_planes(results.scans[0])[0]);
  const score::Vec3 centre = plane.rings[0][0];
  plane.plane.normal =
      Eigen::AngleAxisd(3 * M_PI / 180, plane.plane.normal.unitOrthogonal()) * plane.plane.normal;
  plane.plane.offset_m = plane.plane.normal.dot(centre);
  const auto marks = marks_of(results);
  const auto& hoover = marks["scans"][0]["planes"]["hoover"][0];
  EXPECT_NEAR(hoover["mean_angle_deg"], 3.0 / hoover["planes"].get<int>(), 1e-6);
  const auto& normals = marks["scans"][0]["planes"]["normals"];
  EXPECT_EQ(normals["within_3_bounds"], normals["planes"].get<int>() - 1);
  expect_others_hold(
      marks, {of_planes("hoover/*/mean_angle_deg"), of_planes("normals/*"), "/scans/0/decimation/*_mm"});
}

TEST_F(PerfectRoom, borders_two_samples_off_are_displaced) {
  Results results = perfect();
  score::LabelledGrid& grid = results.scans[0].grid;
  const std::uint32_t plane = largest_planes(results.scans[0])[0];
  // Shrinks the plane: what has another label within two samples to the left or right loses its own.
  const auto before = grid.label;
  for (int row = 0; row < grid.rows; ++row)
    for (int col = 2; col < grid.cols - 2; ++col)
      for (int step = -2; step <= 2; ++step) {
        const std::size_t i = grid.index(row, col), near = grid.index(row, col + step);
        if (before[i] == plane && grid.source[near] != score::kNoSource && before[near] != plane)
          grid.label[i] = 0;
      }
  const auto marks = marks_of(results);
  const auto& boundary = marks["scans"][0]["planes"]["boundary"];
  EXPECT_GT(boundary["displaced"]["share_beyond_1_sample"], 0.02);
  EXPECT_GE(boundary["displaced"]["percentile_95_samples"], 1.0);
  EXPECT_LE(boundary["displaced"]["percentile_95_samples"], 3.0);
  EXPECT_GT(boundary["invented"]["share_beyond_1_sample"], 0.02);
  expect_others_hold(marks, {of_planes("boundary/*"), of_planes("planar_samples_right*"),
                             of_planes("hoover/*"), "/scans/0/decimation/*"});
}

TEST_F(PerfectRoom, keeping_everything_discards_nothing) {
  Results results = perfect();
  PerfectScan& scan = results.scans[0];
  scan.kept.clear();
  for (std::size_t i = 0; i < scan.grid.source.size(); ++i)
    if (scan.grid.source[i] != score::kNoSource) scan.kept.push_back(scan.grid.point[i]);
  const auto marks = marks_of(results);
  EXPECT_EQ(marks["scans"][0]["decimation"]["discarded"], 0);
  expect_others_hold(marks, {"/scans/0/decimation/*"});
}

TEST_F(PerfectRoom, a_polygon_off_its_plane_is_far_from_the_true_points) {
  Results results = perfect();
  auto& plane = results.scans[0].planes.at(largest_planes(results.scans[0])[0]);
  plane.plane.offset_m += 0.02;
  for (auto& point : plane.rings[0]) point += 0.02 * plane.plane.normal;
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["scans"][0]["decimation"]["largest_mm"], 20, 0.01);
  EXPECT_NEAR(marks["scans"][0]["decimation"]["percentile_99_9_mm"], 20, 0.01);
  expect_others_hold(marks, {"/scans/0/decimation/*_mm"});
}

TEST_F(PerfectRoom, a_polygon_that_covers_too_little_is_far_from_some) {
  Results results = perfect();
  auto& ring = results.scans[0].planes.at(largest_planes(results.scans[0])[0]).rings[0];
  score::Vec3 middle = score::Vec3::Zero();
  for (const auto& point : ring) middle += point / static_cast<double>(ring.size());
  for (auto& point : ring) point = middle + 0.8 * (point - middle);
  const auto marks = marks_of(results);
  EXPECT_GT(marks["scans"][0]["decimation"]["largest_mm"], 200);
  expect_others_hold(marks, {"/scans/0/decimation/*_mm"});
}

}  // namespace score_tests
