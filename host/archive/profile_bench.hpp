#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hybrid::archive {

struct BenchRequest {
  std::filesystem::path archive;
  std::vector<std::filesystem::path> profiles;  // io::ProfileFile each; their names must differ
  std::filesystem::path out;                    // a store per profile, named after it; bench.json, index.html
  std::vector<std::string> run_options;         // for every `hybrid batch run`
};

// Processes an archive with one profile after the other, each into a store of its own (so that a second call
// computes what changed alone), and tabulates quality and time:
//   {"profiles": [{"name", "store", "units": {state: count}, "failures", "cpu_s", "seconds": summed over
//    units, "peak_memory_bytes", "scored": scenes with truth}],
//    "figures": [{"name", "scenes", "mean": [per profile], "worst": [...]}],
//    "scenes": [{"result", "figure", "values": [per profile]}]}
// Figures are those of summary.json, and of hybrid-score ("score/...", the program beside this one) where the
// scene names its truth; a scene's is the mean of its scans or views. Means are over the scenes that have it
// under every profile, so that a profile that fails on the hard ones is not the better for it.
nlohmann::ordered_json run_bench(const BenchRequest& request);

// A table of the figures that tell quality, and of time.
std::string bench_text(const nlohmann::ordered_json& bench);
// DIR/index.html.
void write_bench_page(const std::filesystem::path& folder, const nlohmann::ordered_json& bench);

}  // namespace hybrid::archive
