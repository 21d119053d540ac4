#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "compare/ladder.hpp"

namespace hybrid::compare {

inline constexpr const char* kScan = "west";  // of the room, whose planes and pose are compared

// Megapixels; larger sizes are for ours and the twin only, unless all is asked for.
inline constexpr double kLarge_mp = 50;

// Where programs and scenes are and what was asked for.
struct Setup {
  std::filesystem::path bin;                   // hybrid, hybrid-score and peers/
  std::filesystem::path scenes;                // room-<size>/ of hybrid-synth, size in megapixels
  std::filesystem::path work;                  // results
  std::filesystem::path external;              // HYBRID_PEERS_DIR; empty = not given
  std::filesystem::path results;               // RESULTS.md to be written into; empty = none
  std::filesystem::path e57;                   // a scan for the reading job; empty = none
  std::vector<std::string> sizes;              // megapixels, ascending: "1", "5"
  std::string probe_size = "0.25";             // for programs so slow that larger sizes are extrapolated
  std::map<std::string, std::string> no_scan;  // why there is none, by size
  bool quick = false;
  int threads = 0;
  double run_limit_s = 240;  // what hangs is ended
  LadderOptions ladder;
};

// Why a program of bin/peers cannot run ("not run: PCL not installed"), or empty.
std::string missing_peer(const Setup& setup, const std::string& program, const std::string& package);
// The same for a program under HYBRID_PEERS_DIR.
std::string missing_external(const Setup& setup, const std::string& program);

// Runs a peer's command line and reads the JSON line it ends with. Throws std::runtime_error with its last
// words.
Run run_peer(const std::vector<std::string>& command, double limit_s);

// One scan of a scene of hybrid-synth, seed 1.
struct ScanRecipe {
  std::string folder = "room";  // under `scenes`, before the size
  std::string scene = "room", scan = "west";
  std::string format = {};  // of its file; empty = the scene's own
};

// Makes scenes/<folder>-<size> where it is not there yet; what went wrong, or empty.
std::string make_scene(const Setup& setup, const std::string& size, const ScanRecipe& recipe = {});

nlohmann::json read_json(const std::filesystem::path& file);

// hybrid-score's measures of a scan's labels in a result folder, against the scene's truth, the same for all.
void score_labels(const Setup& setup, const std::filesystem::path& scene, const std::string& scan,
                  const std::filesystem::path& result, Row& row);

Job planes_job(const Setup& setup);
Job squares_job(const Setup& setup);
// One job for each source of samples: all of them, and our planar samples.
std::vector<Job> icp_jobs(const Setup& setup);
// Decoding E57 files.
Job e57_job(const Setup& setup);
// From a scan's file to decimated points in the world, all files written, of a room and of a church: `parts`
// in the runs' reports, seconds of the whole process. Makes its scenes.
std::vector<Job> end_to_end_jobs(Setup& setup);
// Rays, photographs and closest points: one program measures ours and Embree in turn, which saves the scene's
// making.
std::vector<Row> ray_rows(const Setup& setup);

// What ran: processor, memory, system, OpenCL device and driver, commit.
nlohmann::ordered_json machine_json(const Setup& setup);

}  // namespace hybrid::compare
