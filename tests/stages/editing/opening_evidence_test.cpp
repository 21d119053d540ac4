#include "stages/editing/opening_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hybrid::stages::opening_evidence_test {
namespace {

// All around a scanner, anything from 1 to 15 m away, a third of it dropouts.
struct Scattered {
  RangeImage image = make_range_image(90, 180);
  PlaneSegmentation segmentation;
  Pose pose;

  Scattered(unsigned seed, const Pose& world_from_scan) : pose(world_from_scan) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0, 1);
    for (int row = 0; row < image.rows; ++row)
      image.elevation_rad[static_cast<std::size_t>(row)] = (45 - row) * M_PI / 100;
    for (int col = 0; col < image.cols; ++col)
      image.azimuth_rad[static_cast<std::size_t>(col)] = col * M_PI / 90;
    for (int row = 0; row < image.rows; ++row)
      for (int col = 0; col < image.cols; ++col) {
        if (share(random) < 1.0 / 3) continue;
        const std::size_t i = image.index(row, col);
        const double el = image.elevation_rad[static_cast<std::size_t>(row)];
        const double az = image.azimuth_rad[static_cast<std::size_t>(col)];
        const double range = 1 + 14 * share(random);
        image.x[i] = static_cast<float>(range * std::cos(el) * std::cos(az));
        image.y[i] = static_cast<float>(range * std::cos(el) * std::sin(az));
        image.z[i] = static_cast<float>(range * std::sin(el));
        image.range_m[i] = static_cast<float>(range);
        image.mask[i] = kMeasured;
      }
    segmentation.sample_label.assign(image.count(), 0);
  }
};

// The same points, none of which is ruled out by where it lies.
EvidenceCloud without_directions(const EvidenceCloud& cloud) {
  EvidenceCloud all = cloud;
  all.runs.clear();
  all.first_run.clear();
  std::size_t first = 0;
  for (std::size_t scan = 0; scan < cloud.scanners.size(); ++scan) {
    std::size_t end = first;
    while (end < cloud.points.size() && cloud.points[end].scan == scan) ++end;
    EvidenceRun run{first, end - first};
    run.far_m = std::numeric_limits<float>::infinity();
    all.first_run.push_back(all.runs.size());
    all.runs.push_back(run);
    first = end;
  }
  all.first_run.push_back(all.runs.size());
  return all;
}

FaceFrame random_frame(std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  PolygonModel model;
  const Vec3 corner(20 * share(random) - 10, 20 * share(random) - 10, 6 * share(random) - 3);
  const Vec3 u = Vec3(share(random) - 0.5, share(random) - 0.5, share(random) - 0.5).normalized();
  const Vec3 v = u.cross(Vec3(share(random), share(random), 2)).normalized();
  const double width = std::pow(10.0, 2 * share(random) - 1), height = std::pow(10.0, 2 * share(random) - 1);
  model.vertices = {corner, corner + width * u, corner + width * u + height * v, corner + height * v};
  model.faces = {{"face", {0, 1, 2, 3}, {}}};
  return face_frame(model, model.faces[0]);
}

}  // namespace

TEST(OpeningEvidence, DirectionsLeaveOutNoSampleOfAFace) {
  const Scattered one(1, Pose{1, Eigen::Quaterniond(0.9, 0.1, 0.3, 0.2).normalized(), Vec3(1, 2, 0)});
  const Scattered two(2, Pose{1, Eigen::Quaterniond::Identity(), Vec3(-6, 4, 1)});
  PolygonModel model;
  model.vertices = {{3, 1, 0}};
  const EvidenceCloud cloud = gather_points(model, {{&one.image, &one.segmentation, nullptr, one.pose},
                                                    {&two.image, &two.segmentation, nullptr, two.pose}});
  const EvidenceCloud all = without_directions(cloud);
  std::mt19937 random(3);
  std::size_t total = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const FaceFrame frame = random_frame(random);
    const auto some = samples_of_face(cloud, frame).samples, expected = samples_of_face(all, frame).samples;
    ASSERT_EQ(some.size(), expected.size()) << "face " << trial;
    for (std::size_t i = 0; i < some.size(); ++i) {
      ASSERT_EQ(some[i].u, expected[i].u);
      ASSERT_EQ(some[i].v, expected[i].v);
      ASSERT_EQ(some[i].height_m, expected[i].height_m);
      ASSERT_EQ(some[i].scan, expected[i].scan);
    }
    total += some.size();
  }
  EXPECT_GT(total, 10'000u);
}

}  // namespace hybrid::stages::opening_evidence_test
