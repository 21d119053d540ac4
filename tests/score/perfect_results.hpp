#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "score/read/scan_result.hpp"
#include "score/read/scene_truth.hpp"
#include "score/read/view_result.hpp"

namespace score_tests {

// The results a perfect program would leave: labels, poses, pictures and openings are the truth's. Tests
// damage one of these and write the folder.
struct PerfectScan {
  std::string id;
  score::LabelledGrid grid;
  std::vector<float> range_m;                          // per node of the grid
  std::map<std::uint32_t, score::ResultPlane> planes;  // hulls of the true points
  std::vector<Eigen::Vector3f> kept;
  score::Similarity world_from_scan;
  std::string status = "accepted", how = "landmarks";
};

struct PerfectView {
  std::string name;
  score::ViewResult image;
};

struct Results {
  std::vector<PerfectScan> scans;
  std::vector<PerfectView> views;
  std::vector<std::vector<score::Vec3>> polygons;  // model/edited.obj
  std::vector<std::vector<score::Vec3>> reported;  // model/openings.json
};

// From truth.json and the scene it lies in.
Results perfect_results(const score::SceneTruth& truth);
void write_results(const Results& results, const std::filesystem::path& folder);

void write_text(const std::filesystem::path& file, const std::string& text);
void write_range_exr(const std::filesystem::path& file, const score::LabelledGrid& grid,
                     const std::vector<float>& range_m);
void write_labels_exr(const std::filesystem::path& file, const score::LabelledGrid& grid);

}  // namespace score_tests
