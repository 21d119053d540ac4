#include "batch/scene_summary.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "batch/planes_json.hpp"
#include "batch/registration/registration_json.hpp"
#include "batch/registration/residual_figures.hpp"
#include "batch/truth_figures.hpp"
#include "core/log.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

// Without a model the first scan that has a pose is the frame: its true pose brings the others into the
// truth's.
Pose in_truth_s_frame(const SceneRun& run, const io::SceneTruth& truths,
                      const ScanRegistration& registration) {
  const auto first = std::find_if(run.registrations.begin(), run.registrations.end(),
                                  [](const auto& one) { return one.has_value(); });
  if (run.model || first == run.registrations.end()) return registration.world_from_scan();
  const auto frame = static_cast<std::size_t>(first - run.registrations.begin());
  for (const auto& truth : truths.scans)
    if (truth.id == run.products[frame].id)
      return truth.world_from_scan * (*first)->world_from_scan().inverse() * registration.world_from_scan();
  return registration.world_from_scan();
}

// The truth says what each sample of hybrid-synth's file is; of another file nothing can be scored.
bool is_of_this_file(const SceneRun& run, const io::ScanTruth& truth, const ScanProduct& product) {
  if (std::cmp_equal(truth.plane.size(), product.input_samples)) return true;
  log::warning(
      "{}: scan {}: expected the truth of its file's {} samples, found that of {}: not scored; name the "
      "scan's file that hybrid-synth wrote, or take `truth` from the scene",
      run.scene.truth->string(), truth.id, product.input_samples, truth.plane.size());
  return false;
}

Json scan_summary(const SceneRun& run, const io::SceneTruth* truths, std::size_t i) {
  Json json = scan_figures(run.products[i]);
  const auto& registration = run.registrations[i];
  if (const auto& found = registration ? registration : run.abstentions[i]) {
    json["registration"] = registration_figures(*found);
    if (const auto nodes = residual_nodes(run.products[i], *found))
      json["registration"]["residuals"] = residual_figures(*nodes);
  }
  if (const ScanProduct& product = run.products[i]; !product.drawn.empty()) {
    const DrawnCounts& of = product.drawn_counts;
    json["drawn"] = {{"retained", of.retained},
                     {"on_contours", of.on_contours},
                     {"in_the_air", of.in_the_air},
                     {"seen_finer", of.seen_finer},
                     {"on_faces", of.on_faces},
                     {"drawn", of.retained - of.on_contours - of.in_the_air - of.seen_finer}};
  }
  if (truths == nullptr) return json;
  for (const auto& truth : truths->scans)
    if (truth.id == run.products[i].id && is_of_this_file(run, truth, run.products[i])) {
      const auto pose =
          registration ? std::optional(in_truth_s_frame(run, *truths, *registration)) : std::nullopt;
      json["truth"] = truth_figures(truth, run.products[i], pose ? &*pose : nullptr);
    }
  return json;
}

}  // namespace

Json scan_summaries(const SceneRun& run, const io::SceneTruth* truth) {
  Json scans = Json::array();
  for (std::size_t i = 0; i < run.products.size(); ++i) scans.push_back(scan_summary(run, truth, i));
  return scans;
}

}  // namespace hybrid::batch
