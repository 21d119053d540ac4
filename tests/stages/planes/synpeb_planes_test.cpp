// The planes of one range image of the SynPEB benchmark against its ground truth, which is in `intensity`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "device.hpp"
#include "io/read_scan.hpp"
#include "places.hpp"
#include "stages/planes/superclusters.hpp"
#include "stages/scan/resample.hpp"

namespace hybrid::testing {

TEST(SynpebPlanes, all_faces_but_one_are_found) {
  const char* data = std::getenv("HYBRID_DATA");
  const auto file = std::filesystem::path(data ? data : HYBRID_PROJECT_DIR "/../shared/data") /
                    "planes/synpeb/test_100.pcd";
  if (!std::filesystem::exists(file))
    GTEST_SKIP() << "needs planes/synpeb under ../shared/data or HYBRID_DATA";
  const auto scan = io::read_scan(file, 0);
  const auto image = stages::resample_scan(queue(), scan);
  stages::SquarePlaneOptions options;
  options.square = 6;  // what square = "auto" chooses
  const auto segmentation =
      stages::grow_superclusters(queue(), image, stages::fit_square_planes(queue(), image, options));

  std::map<int, std::map<std::uint32_t, int>> by_face;  // true face, label
  std::map<std::uint32_t, std::map<int, int>> by_label;
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (image.mask[i] != kMeasured) continue;
    const auto face = static_cast<int>(scan.intensity[image.source[i]]);
    ++by_face[face][segmentation.sample_label[i]];
    if (segmentation.sample_label[i] != 0) ++by_label[segmentation.sample_label[i]][face];
  }
  const auto more = [](const auto& a, const auto& b) { return a.second < b.second; };
  int faces = 0, found = 0, samples = 0, right = 0;
  for (const auto& [face, labels] : by_face) {
    int all = 0, own = 0;
    for (const auto& [label, count] : labels) {
      all += count;
      if (label != 0 && std::max_element(by_label[label].begin(), by_label[label].end(), more)->first == face)
        own += count;
    }
    samples += all;
    right += own;
    faces += all >= 100;
    found += all >= 100 && 2 * own >= all;
  }
  EXPECT_EQ(faces, 10);
  // Measured 9 of 10 faces, 95 % of the samples. This sensor's noise along the ray is 2 to 10 mm at 54 to 84
  // degrees of incidence against 1 mm elsewhere, and 289 squares are too few to learn that from: two faces
  // are planes because their squares say so. The last is seen at 78 degrees.
  EXPECT_GE(found, 9);
  EXPECT_GT(right, 0.94 * samples);
  for (const auto& [label, counts] : by_label) {
    int all = 0;
    for (const auto& [face, count] : counts) all += count;
    EXPECT_GT(std::max_element(counts.begin(), counts.end(), more)->second, 0.75 * all) << "label " << label;
  }
}

}  // namespace hybrid::testing
