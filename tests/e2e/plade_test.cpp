// PLADE's polyhedron (skipped where the data are absent).
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/pose.hpp"
#include "io/output.hpp"
#include "places.hpp"
#include "program.hpp"

namespace hybrid::e2e {

TEST(PladePolyhedron, two_clouds_in_no_order_are_aligned_as_the_given_transformation_says) {
  namespace fs = std::filesystem;
  const char* folder = std::getenv("HYBRID_DATA");
  const fs::path data = folder ? fs::path(folder) : fs::path(HYBRID_PROJECT_DIR) / ".." / "shared" / "data";
  const fs::path truth_file = data / "registration/plade/polyhedron_source_groundtruth.txt";
  if (!fs::exists(truth_file)) GTEST_SKIP() << "no " << truth_file << "; set HYBRID_DATA";
  const Scratch scratch;
  const auto outcome =
      run("hybrid register " HYBRID_PROJECT_DIR "/datasets/plade-polyhedron/scene.toml --quiet --out " +
          scratch.path().string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

  std::array<double, 16> matrix{};
  std::istringstream text(io::read_text(truth_file));
  for (double& value : matrix) ASSERT_TRUE(text >> value);
  const Pose truth = pose_from_row_major(matrix);  // source's file to target's

  const auto pose_of = [&](const char* scan) {
    const auto json = nlohmann::json::parse(io::read_text(scratch / "scans" / scan / "pose.json"));
    return pose_from_row_major(json["world_from_scan"].get<std::array<double, 16>>());
  };
  // Scans have their origins where the scene says that the scanner stood, the files elsewhere.
  const Pose file_from_target{1, Eigen::Quaterniond::Identity(), Vec3(-0.24, 0.866, 0.144)};
  const auto apart = difference(truth, file_from_target * pose_of("target").inverse() * pose_of("source"));
  EXPECT_LT(apart.distance_m, 1e-4);  // measured: 1 um
  EXPECT_LT(apart.angle_rad * 180 / M_PI, 0.01);
}

}  // namespace hybrid::e2e
