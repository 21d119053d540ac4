#include "stages/registration/automatic_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kGuessesPerRotation = 60, kMostGuesses = 320, kMostFits = 40, kMostFinalists = 28;
constexpr std::size_t kCoarseRays = 400;
constexpr double kGuessShare = 0.4;      // of the best guess's area
constexpr double kSamePlace_m = 0.10;    // of two poses after ICP
constexpr double kSymmetricShare = 0.6;  // of the model's area on itself
constexpr std::size_t kMotionsPerRotation = 3;

void sort_by_score(std::vector<PoseGuess>& guesses) {
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const PoseGuess& a, const PoseGuess& b) { return a.score > b.score; });
}

// Coarse guesses are off by decimetres, so they are judged by as much.
void look_coarsely(SightCaster& caster, const ScanEvidence& scan, const AutomaticOptions& options,
                   std::vector<PoseGuess>& guesses) {
  SightOptions coarse = sight_options(options);
  coarse.tolerance_m = std::max(0.2, 2 * coarse.tolerance_m);
  coarse.clear_m = std::max(0.4, 2 * coarse.clear_m);
  coarse.recesses = false;
  const std::size_t stride = std::max<std::size_t>(1, scan.rays.size() / kCoarseRays);
  std::vector<Pose> poses;
  for (const PoseGuess& guess : guesses) poses.push_back(guess.world_from_scan);
  const auto lines = caster.cast(scan.rays, poses, coarse, stride);
  parallel_for(guesses.size(),
               [&](std::size_t k) { guesses[k].score = shares_of(scan.rays, lines[k], stride).score; });
  sort_by_score(guesses);
}

bool may_be_final(const TileFit& fit, const AutomaticOptions& options) {
  if (!fit.world_from_scan.translation.allFinite() || fit.least_share <= 0) return false;
  return !options.levelled || fit.world_from_scan.rotate(Vec3::UnitZ()).z() >= 0.99;
}

void add_finalists(SightCaster& caster, const ScanEvidence& scan, const ModelShapes& model,
                   const std::vector<Pose>& starts, const AutomaticOptions& options,
                   std::vector<Finalist>& finalists) {
  std::vector<TileFit> fits(starts.size());
  parallel_for(starts.size(), [&](std::size_t k) { fits[k] = fit_tiles(scan, model, starts[k]); });
  const std::size_t known = finalists.size();
  std::vector<Pose> poses;
  for (const TileFit& fit : fits) {
    if (!may_be_final(fit, options)) continue;
    if (std::any_of(finalists.begin(), finalists.end(), [&](const Finalist& other) {
          return same_place(scan, other.fit.world_from_scan, fit.world_from_scan, kSamePlace_m);
        }))
      continue;
    finalists.push_back({fit, {}, {}});
    poses.push_back(fit.world_from_scan);
  }
  auto lines = caster.cast(scan.rays, poses, sight_options(options));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    finalists[known + k].shares = shares_of(scan.rays, lines[k]);
    finalists[known + k].lines = std::move(lines[k]);
  }
}

void sort_by_score(std::vector<Finalist>& finalists) {
  std::stable_sort(finalists.begin(), finalists.end(),
                   [](const Finalist& a, const Finalist& b) { return a.shares.score > b.shares.score; });
}

// The model as a scan of itself: a tile for every face, or for pieces of it where it is large.
ScanEvidence as_evidence(const ModelShapes& model) {
  ScanEvidence evidence;
  for (const ModelPlane& plane : model.planes) evidence.planes.push_back({plane.plane, Vec3::Zero(), 0});
  const Vec3 centre = model.box.center();
  for (const FaceShape& face : model.faces) {
    Vec2 low = face.rings[0][0], high = low;
    for (const Vec2& p : face.rings[0]) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    std::vector<Vec3> inside;
    constexpr int kSide = 5;
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j) {
        const Vec2 at = low + (high - low).cwiseProduct(Vec2(i + 0.5, j + 0.5) / kSide);
        const Vec3 p = face.origin + at.x() * face.u + at.y() * face.v;
        if (face.outside_m(p) == 0) inside.push_back(p - centre);
      }
    for (const Vec3& p : inside) {
      PlaneTile tile;
      tile.plane = face.plane_index;
      tile.normal = face.plane.normal;
      tile.area_m2 = face.area_m2 / static_cast<double>(inside.size());
      tile.centroid = p;
      ScanPlane& plane = evidence.planes[face.plane_index];
      plane.centroid += tile.area_m2 * p;
      plane.area_m2 += tile.area_m2;
      evidence.area_m2 += tile.area_m2;
      evidence.tiles.push_back(tile);
    }
  }
  for (ScanPlane& plane : evidence.planes)
    if (plane.area_m2 > 0) plane.centroid /= plane.area_m2;
  std::erase_if(evidence.planes, [](const ScanPlane& plane) { return !(plane.area_m2 > 0); });
  evidence.reach_m = model.box.diagonal().norm() / 2;
  return evidence;
}

}  // namespace

SightOptions sight_options(const AutomaticOptions& options) {
  SightOptions sight;
  sight.tolerance_m = options.tolerance_m;
  sight.clear_m = std::max(options.clear_m, 2 * options.tolerance_m);
  sight.offset_m = options.face_offset_m;
  sight.backs = !options.of_scan;
  return sight;
}

Search search_poses(SightCaster& caster, const ScanEvidence& scan, const ModelShapes& model, double scale,
                    const AutomaticOptions& options) {
  Search search;
  const auto rotations = guess_rotations(scan, model, options.levelled);
  search.rotations = static_cast<int>(rotations.size());
  std::vector<std::vector<PoseGuess>> by_rotation(rotations.size());
  parallel_for(rotations.size(), [&](std::size_t r) {
    by_rotation[r] = guess_offsets(scan, model, rotations[r].world_from_scan, scale, kGuessesPerRotation);
  });
  std::vector<PoseGuess> guesses;
  for (const auto& some : by_rotation) guesses.insert(guesses.end(), some.begin(), some.end());
  sort_by_score(guesses);
  while (!guesses.empty() &&
         (guesses.size() > kMostGuesses || guesses.back().score < kGuessShare * guesses.front().score))
    guesses.pop_back();
  search.guesses = static_cast<int>(guesses.size());
  look_coarsely(caster, scan, options, guesses);
  if (guesses.size() > kMostFits) guesses.resize(kMostFits);
  std::vector<Pose> starts;
  for (const PoseGuess& guess : guesses) starts.push_back(guess.world_from_scan);
  add_finalists(caster, scan, model, starts, options, search.finalists);
  sort_by_score(search.finalists);
  if (search.finalists.size() > kMostFinalists) search.finalists.resize(kMostFinalists);
  return search;
}

std::vector<Pose> motions_onto_itself(const ModelShapes& model, bool levelled) {
  const ScanEvidence itself = as_evidence(model);
  const Vec3 centre = model.box.center();
  const auto turns = guess_rotations(itself, model, levelled);
  std::vector<std::vector<Pose>> by_turn(turns.size());
  parallel_for(turns.size(), [&](std::size_t t) {
    for (const PoseGuess& guess :
         guess_offsets(itself, model, turns[t].world_from_scan, 1, kMotionsPerRotation)) {
      if (guess.score < kSymmetricShare * itself.area_m2 && !by_turn[t].empty()) break;
      Pose motion = guess.world_from_scan;  // of points relative to the centre
      motion.translation -= motion.rotation * centre;
      by_turn[t].push_back(motion);
    }
  });
  std::vector<Pose> motions;
  for (const auto& some : by_turn) motions.insert(motions.end(), some.begin(), some.end());
  return motions;
}

void add_symmetric_rivals(SightCaster& caster, const ScanEvidence& scan, const ModelShapes& model,
                          const std::vector<Pose>& motions, const Pose& pose, const AutomaticOptions& options,
                          Search& search) {
  std::vector<Pose> starts;
  for (const Pose& motion : motions) starts.push_back(motion * pose);
  add_finalists(caster, scan, model, starts, options, search.finalists);
  sort_by_score(search.finalists);
}

}  // namespace hybrid::stages
