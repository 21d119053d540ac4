#pragma once
#include <nlohmann/json.hpp>

#include "score/scene_score.hpp"

namespace score {

// Label measures against a public benchmark's truth.
struct BenchmarkScore {
  std::string name;
  PlaneScore planes;
  // SegComp states angles between adjacent regions, no directions.
  int angles_compared = 0;
  double mean_angle_error_deg = 0;
};

// NAME.pcd (SynPEB) or NAME.gt-seg (SegComp), by the file's name.
bool is_benchmark(const std::filesystem::path& truth);

// `results`: a folder with range.exr and labels.exr (or scans/<the only scan>/ with both), of the image that
// the truth labels; SegComp also NAME.ms-seg, with NAME.ms-nor beside it for directions. Throws InputError.
BenchmarkScore score_benchmark(const std::filesystem::path& truth, const std::filesystem::path& results,
                               const ScoreOptions& options);

nlohmann::ordered_json benchmark_json(const BenchmarkScore& score);
std::string benchmark_table(const BenchmarkScore& score);

}  // namespace score
