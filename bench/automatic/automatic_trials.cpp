// hybrid-automatic-trials: how often the automatic alignment is right, wrong or silent, on many random rooms
// or on the scans of hybrid-synth's scenes, whose truth is known.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "batch/scene_model.hpp"
#include "batch/scene_request.hpp"
#include "batch/scene_scan.hpp"
#include "cases/trial_room.hpp"
#include "stages/registration/automatic.hpp"
#include "stages/registration/automatic_search.hpp"

namespace {

using namespace hybrid;
using Json = nlohmann::ordered_json;

constexpr double kRight_m = 0.05, kRightDeg = 0.5;
// A pose is distinguishable when, under the true pose, at least this share of the planar area lies on faces
// that every other hypothesis contradicts, more than speaks against it: and the pose that lies `kSlide_m`
// from it along the direction in which planes hold it least, as along a wall of which nothing else is seen.
// That is what faces may be off and more.
constexpr double kDistinguishable = 0.003, kSlide_m = 0.3;

struct Trial {
  std::string outcome;  // right | wrong | abstained
  bool distinguishable = false, best_is_right = false;
  PoseDifference from_truth;  // of the pose that was found
  // Right, or as near to the pose that ICP on this proxy makes of the true one: where a proxy is off by
  // centimetres no fit to it is the truth.
  bool same_as_fitted_truth = false;
  stages::AutomaticAlignment alignment;
  double seconds = 0;
  stages::SightShares truth;      // under the true pose
  stages::Comparison with_truth;  // of the pose that was found against the true one
};

bool is_near(const PoseDifference& difference) {
  return difference.distance_m < kRight_m && difference.angle_rad < kRightDeg * std::numbers::pi / 180;
}

double margin_of_truth(device::Queue& queue, const stages::ScanEvidence& evidence,
                       const stages::ProxyModel& proxy, const Pose& truth,
                       const stages::AutomaticOptions& options, Trial& trial) {
  const auto& shapes = proxy.shapes();
  stages::SightCaster caster(queue, proxy);
  auto search = stages::search_poses(caster, evidence, shapes, 1, options);
  stages::add_symmetric_rivals(caster, evidence, shapes, proxy.motions(options.levelled), truth, options,
                               search);
  const auto lines = caster.cast(evidence.rays, truth, stages::sight_options(options));
  trial.truth = stages::shares_of(evidence.rays, lines);
  const auto found =
      caster.cast(evidence.rays, trial.alignment.world_from_scan, stages::sight_options(options));
  trial.with_truth = stages::compare(evidence.rays, found, lines);
  double least = 1;
  for (const auto& other : search.finalists)
    if (!stages::same_place(evidence, other.fit.world_from_scan, truth, 0.2))
      least = std::min(least, stages::compare(evidence.rays, lines, other.lines).gap());
  const Vec3 weakest = stages::fit_tiles(evidence, shapes, truth).weakest;
  for (const double way : {-kSlide_m, kSlide_m}) {
    Pose slid = truth;
    slid.translation += way * weakest;
    const auto other = caster.cast(evidence.rays, slid, stages::sight_options(options));
    least = std::min(least, stages::compare(evidence.rays, lines, other).gap());
  }
  return least;
}

Trial judge(device::Queue& queue, const stages::ScanEvidence& evidence, const stages::ProxyModel& proxy,
            const Pose& truth, const stages::AutomaticOptions& options) {
  Trial trial;
  const auto begin = std::chrono::steady_clock::now();
  trial.alignment = stages::align_automatically(queue, evidence, proxy, options);
  trial.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Pose& found = trial.alignment.world_from_scan;
  trial.from_truth = difference(truth, found);
  trial.best_is_right = trial.alignment.has_pose && is_near(trial.from_truth);
  trial.same_as_fitted_truth =
      trial.best_is_right ||
      (trial.alignment.has_pose &&
       is_near(difference(stages::fit_tiles(evidence, proxy.shapes(), truth).world_from_scan, found)));
  trial.outcome = !trial.alignment.accepted ? "abstained" : trial.best_is_right ? "right" : "wrong";
  trial.distinguishable = margin_of_truth(queue, evidence, proxy, truth, options, trial) >= kDistinguishable;
  return trial;
}

struct Request {
  std::vector<std::string> kinds = {"box", "niche", "hall", "ell", "oblique", "alcoves"};
  int trials = 20, seed = 1, first = 0;
  double crop = 0.5, proxy_error_m = 0.01, least_planes = stages::AutomaticOptions().least_planes;
  std::vector<std::filesystem::path> scenes;
  bool levelled = false, other_room = false, verbose = false;
};

class Tally {
 public:
  explicit Tally(std::string kind) : kind_(std::move(kind)) {}

  void add(const Trial& trial, const std::string& which, bool verbose) {
    ++trials_;
    seconds_ += trial.seconds;
    slowest_ = std::max(slowest_, trial.seconds);
    right_ += trial.outcome == "right";
    wrong_ += trial.outcome == "wrong";
    elsewhere_ += trial.outcome == "wrong" && !trial.same_as_fitted_truth;
    abstained_ += trial.outcome == "abstained";
    distinguishable_ += trial.distinguishable;
    right_of_these_ += trial.distinguishable && trial.outcome == "right";
    best_right_ += trial.best_is_right;
    if (verbose || trial.outcome == "wrong") print(trial, which);
  }

  void skip() { ++no_model_; }

  Json json() const {
    return {{"kind", kind_},
            {"trials", trials_},
            {"no_model", no_model_},
            {"accepted_right", right_},
            {"accepted_wrong", wrong_},
            {"accepted_elsewhere", elsewhere_},
            {"abstained", abstained_},
            {"best_right", best_right_},
            {"distinguishable", distinguishable_},
            {"distinguishable_accepted_right", right_of_these_},
            {"mean_seconds", seconds_ / std::max(trials_, 1)},
            {"slowest_seconds", slowest_}};
  }

 private:
  void print(const Trial& trial, const std::string& which) const {
    const auto& a = trial.alignment;
    std::cerr << fmt::format(
        "{} {}: {}{}{} score {:.3f} S {:.2f} F {:.2f} T {:.2f} B {:.2f} doubt {:.2f} planes {} off {:.3f} by "
        "{:.2f} deg "
        "margin {:.4f} finalists {}",
        kind_, which, trial.outcome, trial.distinguishable ? " distinguishable" : "",
        trial.best_is_right ? " best-right" : " best-WRONG", a.shares.score, a.shares.supported,
        a.shares.in_front, a.shares.through, a.shares.behind, a.doubt, a.planes, a.farthest_m,
        a.farthest_rad * 180 / std::numbers::pi, a.margin, a.finalists);
    if (!a.rivals.empty()) {
      const auto& c = a.rivals[0].comparison;
      std::cerr << fmt::format(
          " truth score {:.3f} S {:.2f} for {:.4f} against {:.4f} rest {:.4f} strength {:.2f} [{}]",
          trial.truth.score, trial.truth.supported, c.for_it, c.against_it, c.without_largest(),
          a.rivals[0].strength, a.rivals[0].words);
    }
    const auto& t = trial.with_truth;
    std::cerr << fmt::format(" against the truth: for {:.4f} against {:.4f} firm {:.4f}", t.for_it,
                             t.against_it, t.largest_firm);
    std::cerr << fmt::format(" from the truth {:.3f} m {:.3f} deg{}", trial.from_truth.distance_m,
                             trial.from_truth.angle_rad * 180 / std::numbers::pi,
                             trial.same_as_fitted_truth ? ", where ICP takes it" : "");
    std::cerr << " " << a.reason.substr(0, 90) << "\n";
  }

  std::string kind_;
  int trials_ = 0, no_model_ = 0, right_ = 0, wrong_ = 0, elsewhere_ = 0, abstained_ = 0,
      distinguishable_ = 0, right_of_these_ = 0, best_right_ = 0;
  double seconds_ = 0, slowest_ = 0;
};

Json run_kind(device::Queue& queue, const std::string& kind, const Request& request) {
  Tally tally(kind);
  for (int k = request.first; k < request.first + request.trials; ++k) {
    const auto seed = static_cast<std::uint32_t>(1000 * request.seed + k);
    testing::Draw draw(seed, 3);
    const auto room = testing::make_trial_room(kind, seed, request.proxy_error_m);
    const double crop = k % 2 ? draw.within(request.crop, 1) : 1;
    const auto scan = testing::scan_trial_room(queue, room, seed, crop);
    stages::AutomaticOptions options;
    options.levelled = request.levelled;
    options.least_planes = request.least_planes;
    const auto evidence = stages::gather_evidence(scan.image, scan.segmentation, options.rays, options.seed);
    Pose truth = scan.world_from_scan;
    PolygonModel proxy = room.proxy;
    if (request.other_room) {
      proxy = testing::make_trial_room(kind, seed + 500000, request.proxy_error_m).proxy;
      truth.translation += Vec3(1e3, 0, 0);  // nothing is right
    }
    try {
      tally.add(judge(queue, evidence, proxy, truth, options), fmt::format("{} crop {:.2f}", seed, crop),
                request.verbose);
    } catch (const Error& error) {  // a model so far off that it is none: a recess beyond its wall
      if (error.kind() != ErrorKind::input) throw;
      tally.skip();
    }
  }
  return tally.json();
}

// The true pose of a scan of hybrid-synth.
Pose true_pose(const Json& truth, const std::string& id) {
  for (const auto& scan : truth.at("scans"))
    if (scan.at("id") == id)
      return pose_from_row_major(scan.at("world_from_scan").get<std::array<double, 16>>());
  throw std::runtime_error(fmt::format("truth.json: no scan {}", id));
}

// Scans of hybrid-synth's scenes, each with planes as `hybrid planes` finds them and seen by a scanner turned
// by any yaw and about a degree of tilt, `trials` times. Neither the start nor the truth is read to align.
void run_scene(device::Queue& queue, const std::filesystem::path& folder, const Request& request,
               Tally& tally) {
  batch::RunRequest run;
  run.scene_file = folder / "scene.toml";
  std::set<std::string> stages_wanted = {"register"};
  batch::StageOptions stage_options;
  const auto scene = batch::read_scene(run, stages_wanted, stage_options);
  std::vector<io::ObjFaceNames> face_names;
  const PolygonModel polygons = batch::read_scene_model(scene.model.value(), face_names);
  const stages::ProxyModel proxy(polygons);
  const Json truth = Json::parse(std::ifstream(folder / "truth.json"));
  batch::ScanNames names(scene);
  batch::Progress progress(true);
  for (const auto& entry : scene.scans) {
    const std::string id = names.next(entry, 0, 1);
    const auto made = batch::make_planes(queue, id, entry, batch::list_scene_scans(entry, false).at(0),
                                         stage_options, progress);
    for (int k = request.first; k < request.first + request.trials; ++k) {
      testing::Draw draw(static_cast<std::uint32_t>(1000 * request.seed + k), 5);
      RangeImage image = made.product.image;
      PlaneSegmentation segmentation = made.product.segmentation;
      const double crop = k == 0 ? 1 : draw.within(request.crop, 1);
      testing::crop_scan(image, segmentation, draw.within(0, 2 * std::numbers::pi), crop);
      const Vec3 lean(draw.within(-1, 1), draw.within(-1, 1), 0);
      const Eigen::Quaterniond turn =
          Eigen::AngleAxisd(draw.within(0, 2 * std::numbers::pi), Vec3::UnitZ()) *
          Eigen::AngleAxisd(lean.norm() * std::numbers::pi / 180, lean.normalized());
      stages::AutomaticOptions options;
      options.levelled = request.levelled;
      options.least_planes = request.least_planes;
      const auto evidence =
          stages::turned(stages::gather_evidence(image, segmentation, options.rays, options.seed), turn);
      Pose true_of_turned = true_pose(truth, id);
      true_of_turned.rotation = true_of_turned.rotation * turn.conjugate();
      tally.add(judge(queue, evidence, proxy, true_of_turned, options),
                fmt::format("{} {} crop {:.2f}", folder.filename().string(), id, crop), request.verbose);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Automatic alignment: trials with known truth", "hybrid-automatic-trials"};
  Request request;
  app.add_option("--kinds", request.kinds, "box niche hall ell oblique alcoves")->capture_default_str();
  app.add_option("--scenes", request.scenes,
                 "folders of hybrid-synth instead: its scans, each turned at random")
      ->check(CLI::ExistingDirectory);
  app.add_option("--trials", request.trials, "per kind, or per scan of a scene")->capture_default_str();
  app.add_option("--seed", request.seed, "trials of another seed share no room")->capture_default_str();
  app.add_option("--first", request.first, "number of the first trial")->capture_default_str();
  app.add_option("--crop", request.crop,
                 "every other scan (of a scene all but the first) is cropped to between this share and all")
      ->capture_default_str();
  app.add_option("--proxy-error-m", request.proxy_error_m, "standard deviation")->capture_default_str();
  app.add_option("--least-planes", request.least_planes, "0: however few planes hold a scan, and how far off")
      ->capture_default_str();
  app.add_flag("--levelled", request.levelled);
  app.add_flag("--other-room", request.other_room, "the proxy is another room's: nothing is right");
  app.add_flag("--verbose", request.verbose);
  CLI11_PARSE(app, argc, argv);
  try {
    device::Queue queue;
    Json all = Json::array();
    Tally of_scenes("scenes");
    for (const auto& folder : request.scenes) run_scene(queue, folder, request, of_scenes);
    if (!request.scenes.empty())
      all.push_back(of_scenes.json());
    else
      for (const auto& kind : request.kinds) all.push_back(run_kind(queue, kind, request));
    std::cout << all.dump(1) << "\n";
  } catch (const std::exception& error) {
    std::cerr << "hybrid-automatic-trials: " << error.what() << "\n";
    return 1;
  }
}
