// hybrid-automatic-trials: how often the automatic alignment is right, wrong or silent, on many random rooms
// (or on crops of a real pipeline's scans, see scene mode) whose truth is known.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cases/trial_room.hpp"
#include "stages/automatic.hpp"
#include "stages/automatic_search.hpp"

namespace {

using namespace hybrid;
using Json = nlohmann::ordered_json;

constexpr double kRight_m = 0.05, kRightDeg = 0.5;
// A pose is distinguishable when, under the true pose, at least this share of the planar area lies on faces
// that every other hypothesis contradicts, more than speaks against it.
constexpr double kDistinguishable = 0.003;

struct Trial {
  std::string outcome;  // right | wrong | abstained
  bool distinguishable = false, best_is_right = false;
  stages::AutomaticAlignment alignment;
  double seconds = 0;
  stages::SightShares truth;  // under the true pose
};

double margin_of_truth(device::Queue& queue, const stages::ScanEvidence& evidence,
                       const stages::ProxyModel& proxy, const Pose& truth,
                       const stages::AutomaticOptions& options, stages::SightShares& of_truth) {
  const auto& shapes = proxy.shapes();
  stages::SightCaster caster(queue, proxy);
  auto search = stages::search_poses(caster, evidence, shapes, 1, options);
  stages::add_symmetric_rivals(caster, evidence, shapes, truth, options, search);
  const auto lines = caster.cast(evidence.rays, truth, stages::sight_options(options));
  of_truth = stages::shares_of(evidence.rays, lines);
  double least = 1;
  for (const auto& other : search.finalists)
    if (!stages::same_place(evidence, other.fit.world_from_scan, truth, 0.2))
      least = std::min(least, stages::compare(evidence.rays, lines, other.lines).gap());
  return least;
}

Trial judge(device::Queue& queue, const stages::ScanEvidence& evidence, const PolygonModel& proxy,
            const Pose& truth, const stages::AutomaticOptions& options) {
  Trial trial;
  const auto begin = std::chrono::steady_clock::now();
  trial.alignment = stages::align_automatically(queue, evidence, proxy, options);
  trial.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto error = difference(truth, trial.alignment.world_from_scan);
  trial.best_is_right = trial.alignment.has_pose && error.distance_m < kRight_m &&
                        error.angle_rad < kRightDeg * std::numbers::pi / 180;
  trial.outcome = !trial.alignment.accepted ? "abstained" : trial.best_is_right ? "right" : "wrong";
  trial.distinguishable =
      margin_of_truth(queue, evidence, proxy, truth, options, trial.truth) >= kDistinguishable;
  return trial;
}

struct Request {
  std::vector<std::string> kinds = {"box", "niche", "hall", "ell", "oblique", "alcoves"};
  int trials = 20, seed = 1, first = 0;
  double crop = 0.5, proxy_error_m = 0.01;
  bool levelled = false, other_room = false, verbose = false;
};

Json run_kind(device::Queue& queue, const std::string& kind, const Request& request) {
  int right = 0, wrong = 0, abstained = 0, distinguishable = 0, right_of_these = 0, best_right = 0;
  double seconds = 0;
  for (int k = request.first; k < request.first + request.trials; ++k) {
    const auto seed = static_cast<std::uint32_t>(1000 * request.seed + k);
    testing::Draw draw(seed, 3);
    const auto room = testing::make_trial_room(kind, seed, request.proxy_error_m);
    const double crop = k % 2 ? draw.within(request.crop, 1) : 1;
    const auto scan = testing::scan_trial_room(queue, room, seed, crop);
    stages::AutomaticOptions options;
    options.levelled = request.levelled;
    const auto evidence = stages::gather_evidence(scan.image, scan.segmentation, options.rays, options.seed);
    Pose truth = scan.world_from_scan;
    PolygonModel proxy = room.proxy;
    if (request.other_room) {
      proxy = testing::make_trial_room(kind, seed + 500000, request.proxy_error_m).proxy;
      truth.translation += Vec3(1e3, 0, 0);  // nothing is right
    }
    const Trial trial = judge(queue, evidence, proxy, truth, options);
    seconds += trial.seconds;
    right += trial.outcome == "right";
    wrong += trial.outcome == "wrong";
    abstained += trial.outcome == "abstained";
    distinguishable += trial.distinguishable;
    right_of_these += trial.distinguishable && trial.outcome == "right";
    best_right += trial.best_is_right;
    if (request.verbose || trial.outcome == "wrong") {
      const auto& a = trial.alignment;
      std::cerr << fmt::format(
          "{} {} crop {:.2f}: {}{}{} score {:.3f} S {:.2f} F {:.2f} T {:.2f} B {:.2f} doubt {:.2f} margin "
          "{:.4f} "
          "finalists {}",
          kind, seed, crop, trial.outcome, trial.distinguishable ? " distinguishable" : "",
          trial.best_is_right ? " best-right" : " best-WRONG", a.shares.score, a.shares.supported,
          a.shares.in_front, a.shares.through, a.shares.behind, a.doubt, a.margin, a.finalists);
      if (!a.rivals.empty()) {
        const auto& c = a.rivals[0].comparison;
        std::cerr << fmt::format(
            " truth score {:.3f} S {:.2f} for {:.4f} against {:.4f} rest {:.4f} strength {:.2f} [{}]",
            trial.truth.score, trial.truth.supported, c.for_it, c.against_it, c.without_largest(),
            a.rivals[0].strength, a.rivals[0].words);
      }
      std::cerr << " " << a.reason.substr(0, 90) << "\n";
    }
  }
  return {{"kind", kind},
          {"trials", request.trials},
          {"accepted_right", right},
          {"accepted_wrong", wrong},
          {"abstained", abstained},
          {"best_right", best_right},
          {"distinguishable", distinguishable},
          {"distinguishable_accepted_right", right_of_these},
          {"mean_seconds", seconds / request.trials}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Automatic alignment: trials with known truth", "hybrid-automatic-trials"};
  Request request;
  app.add_option("--kinds", request.kinds, "box niche hall ell oblique alcoves")->capture_default_str();
  app.add_option("--trials", request.trials, "per kind")->capture_default_str();
  app.add_option("--seed", request.seed, "trials of another seed share no room")->capture_default_str();
  app.add_option("--first", request.first, "number of the first trial")->capture_default_str();
  app.add_option("--crop", request.crop, "every other scan is cropped to between this share and all")
      ->capture_default_str();
  app.add_option("--proxy-error-m", request.proxy_error_m, "standard deviation")->capture_default_str();
  app.add_flag("--levelled", request.levelled);
  app.add_flag("--other-room", request.other_room, "the proxy is another room's: nothing is right");
  app.add_flag("--verbose", request.verbose);
  CLI11_PARSE(app, argc, argv);
  try {
    device::Queue queue;
    Json all = Json::array();
    for (const auto& kind : request.kinds) all.push_back(run_kind(queue, kind, request));
    std::cout << all.dump(1) << "\n";
  } catch (const std::exception& error) {
    std::cerr << "hybrid-automatic-trials: " << error.what() << "\n";
    return 1;
  }
}
