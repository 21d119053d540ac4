#include <fmt/format.h>

#include <stdexcept>

#include "compare/process.hpp"
#include "compare/results.hpp"
#include "compare/setup.hpp"
#include "shared/pose_json.hpp"

namespace hybrid::compare {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

// One of our scenes and where its results are.
struct Place {
  ScanRecipe recipe;
  Path scenes, work;

  Path scene(const Case& at) const { return scenes / (recipe.folder + "-" + size_of(at)); }
  Path results(const Case& at) const { return work / "end-to-end" / (recipe.folder + "-" + size_of(at)); }
  Path ours(const Case& at) const { return results(at) / "hybrid"; }
  Path ours_scan(const Case& at) const { return ours(at) / "scans" / recipe.scan; }
  Path cloud(const Case& at) const { return results(at) / "scan.pcd"; }
  Json truth(const Case& at) const { return read_json(scene(at) / "truth.json"); }

  static std::string size_of(const Case& at) { return at.size.substr(0, at.size.find(' ')); }
};

Eigen::Matrix4d true_pose(const Place& place, const Case& at) {
  const Json truth = place.truth(at);
  for (const Json& scan : truth.at("scans"))
    if (scan.at("id") == place.recipe.scan) return peers::matrix_of(scan.at("world_from_scan"));
  throw std::runtime_error(place.scene(at).string() + ": expected a scan named " + place.recipe.scan +
                           " in its truth");
}

// The scene with a start that is off by 5 cm and 2 degrees in the place of the landmarks; the same start for
// the peers.
void write_start(const Place& place, const Case& at) {
  const Json start = peers::json_of(peers::disturbed(true_pose(place, at)));
  write_text(place.scene(at) / "start.json", Json{{"start", start}}.dump() + "\n");
  write_text(place.scene(at) / "end-to-end.toml",
             fmt::format("[scene]\nname = \"end-to-end\"\n\n"
                         "[[scan]]\nid = \"{}\"\nfile = \"scans/{}.e57\"\npose = {}\n\n"
                         "[model]\nfile = \"proxy.obj\"\nunit = \"m\"\nup = \"z\"\n",
                         place.recipe.scan, place.recipe.scan, start.dump()));
}

// Which of our stages belong to which part.
Json parts_of(const Json& stages) {
  const std::pair<const char*, std::vector<const char*>> kParts[] = {
      {"read", {"read", "resample"}},
      {"planes", {"square planes", "superclusters", "contours"}},
      {"register", {"landmarks", "ICP", "residuals"}},
      {"decimate", {"decimate"}},
      {"write", {"write"}}};
  Json parts;
  for (const auto& [part, names] : kParts) {
    double seconds = 0;
    for (const char* name : names) seconds += stages.value(name, 0.0);
    parts[part] = seconds;
  }
  return parts;
}

Run run_ours(const Setup& setup, const Place& place, const Case& at) {
  const Path out = place.ours(at);
  std::filesystem::remove_all(out);
  const Finished finished = run_process(
      {(setup.bin / "hybrid").string(), "run", (place.scene(at) / "end-to-end.toml").string(), "--out",
       out.string(), "--only", "planes,register", "--quiet", "--threads", std::to_string(setup.threads)},
      2 * setup.run_limit_s);
  if (const auto failure = failure_of(finished); !failure.empty()) throw std::runtime_error(failure);
  const Json summary = read_json(out / "summary.json"), &scan = summary.at("scans").at(0);
  Run run;
  run.seconds = run.wall_s = finished.wall_s;
  run.cpu_s = finished.cpu_s;
  run.peak_mb = finished.peak_mb;
  run.report = {{"package", "hybrid " + summary.at("program").at("version").get<std::string>()},
                {"samples", scan.at("nodes").at("measured")},
                {"parts", parts_of(read_json(out / "timing.json").at("seconds_by_stage"))},
                {"world_from_scan", read_json(place.ours_scan(at) / "pose.json").at("world_from_scan")},
                {"discarded_share", scan.at("decimation").at("discarded_share")},
                {"out", out.string()},
                {"settings", "E57; also pictures of scan, classes, planes and residuals"}};
  return run;
}

// A peer's input is made from our range image, once and not timed: it has neither to decode E57 nor to
// resample.
Run run_chain(const Setup& setup, const Place& place, const Case& at, const std::string& variant) {
  const Path range = place.ours_scan(at) / "range.exr", cloud = place.cloud(at),
             out = place.results(at) / ("pcl-" + variant);
  if (!std::filesystem::exists(range)) throw NoInput("no range image: hybrid run made none");
  const auto command = [&](const std::vector<std::string>& more) {
    std::vector<std::string> line = {(setup.bin / "peers" / "pcl_chain").string(), "--range", range.string(),
                                     "--scan", cloud.string()};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  };
  if (!std::filesystem::exists(cloud))
    if (const auto failure = failure_of(run_process(command({"--prepare"}), setup.run_limit_s));
        !failure.empty())
      throw NoInput("no PCD: " + failure);
  std::filesystem::remove_all(out);
  Run run = run_peer(
      command({"--target", (place.scene(at) / "proxy.obj").string(), "--start",
               (place.scene(at) / "start.json").string(), "--out", out.string(), "--variant", variant,
               "--sigma", place.truth(at).at("noise_m").dump(), "--threads", std::to_string(setup.threads)}),
      setup.run_limit_s);
  run.seconds = run.wall_s;
  run.report["out"] = out.string();
  return run;
}

void score(const Setup& setup, const Place& place, const Case& at, Row& row) {
  const Json& report = row.runs.back().report;
  score_labels(setup, place.scene(at), place.recipe.scan, report.at("out").get<std::string>(), row);
  const auto error = peers::pose_error(peers::matrix_of(report.at("world_from_scan")), true_pose(place, at));
  row.quality += fmt::format("; {:.4f} deg, {:.2f} mm; {:.0f} % discarded", error.angle_deg,
                             error.distance_mm, 100 * report.at("discarded_share").get<double>());
}

Job job_of(const Setup& setup, const Place& place) {
  Job job{place.recipe.scene, {}, {}};
  for (const auto& size : setup.sizes) {
    if (setup.ladder.say) setup.ladder.say(fmt::format("scan of a {}, {} MP", place.recipe.scene, size));
    const Case at{size + " MP", 1e6 * std::stod(size), false, false, make_scene(setup, size, place.recipe)};
    if (at.missing.empty()) write_start(place, at);
    // Made from our last results, which may be of another program by now.
    std::filesystem::remove(place.cloud(at));
    job.cases.push_back(at);
  }
  Program ours;
  ours.name = "hybrid run";
  ours.ours = true;
  ours.run = [=](const Case& at) { return run_ours(setup, place, at); };
  ours.score = [=](const Case& at, Row& row) { score(setup, place, at, row); };
  job.programs.push_back(ours);
  for (const std::string variant : {"gradient", "covariance"}) {
    Program peer = ours;
    peer.name = "PCL chain, " + variant;
    peer.ours = false;
    peer.missing = missing_peer(setup, "pcl_chain", "PCL");
    peer.run = [=](const Case& at) { return run_chain(setup, place, at, variant); };
    job.programs.push_back(peer);
  }
  return job;
}

}  // namespace

std::vector<Job> end_to_end_jobs(Setup& setup) {
  // Long programs have their rounds too: that is what this is for.
  setup.ladder.repeat_limit_s = setup.ladder.peer_limit_s = 600;
  std::vector<Job> jobs;
  for (const ScanRecipe& recipe :
       {ScanRecipe{"room-e57", "room", "west", "e57"}, ScanRecipe{"church-e57", "church", "nave", "e57"}})
    jobs.push_back(job_of(setup, {recipe, setup.scenes, setup.work}));
  return jobs;
}

}  // namespace hybrid::compare
