#include "stages/registration/face_offsets.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "stages/planes/plane_moments.hpp"
#include "stages/registration/icp_step.hpp"
#include "stages/registration/tile_icp.hpp"

namespace hybrid::stages {
namespace {

constexpr double kBesideFace_m = 1.5;  // a tile of 2 m reaches as far from its centroid
// Pieces of one plane: whole within the first, none of it beyond the second.
constexpr double kSamePlane_m = 0.01, kOtherPlane_m = 0.03;
// Of the offsets: a finer spread would lock onto floor and ceiling, which are most of the area, and drop
// walls.
constexpr double kLeastSpread_m = 0.015;
constexpr double kAgreeingShare = 0.5, kNearlyAll = 0.8;  // of the area
constexpr double kHeldShare = 0.01, kHeldOfAll = 0.3;  // of icp_step.hpp's resistance; of that of all faces
constexpr int kMaxIterations = 40;
constexpr double kOffsetsSettledAngleRad = 1e-7, kOffsetsSettledDistanceM = 1e-6;

// 1 up to `whole`, falling to 0 at `none`.
double taper(double value, double whole, double none) {
  return std::clamp((none - std::abs(value)) / (none - whole), 0.0, 1.0);
}

// Per tile the face that it lies on. A tile whose centroid lies beside its face, as of those around an
// opening, goes with the others of its supercluster.
std::vector<TilePair> find_pairs(const ScanEvidence& scan, const ModelShapes& model, const Pose& pose,
                                 double reach_m) {
  std::vector<TilePair> pairs = find_tile_pairs(scan, model, pose, reach_m);
  std::map<std::uint32_t, std::map<const FaceShape*, double>> areas;  // of superclusters on faces
  for (std::size_t t = 0; t < pairs.size(); ++t)
    if (pairs[t].face) areas[scan.tiles[t].supercluster][pairs[t].face] += scan.tiles[t].area_m2;
  for (std::size_t t = 0; t < pairs.size(); ++t) {
    const auto on = areas.find(scan.tiles[t].supercluster);
    if (pairs[t].face || on == areas.end()) continue;
    const auto larger = [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second < b.second : a.first->face > b.first->face;
    };
    const FaceShape& face = *std::ranges::max_element(on->second, larger)->first;
    const TilePair pair = pair_of(scan.tiles[t], face, pose);
    if (std::abs(pair.height_m) < reach_m && face.outside_m(pair.centroid) < kBesideFace_m) pairs[t] = pair;
  }
  return pairs;
}

// The tiles on one face, with the share of each that counts.
struct TilesOnFace {
  const FaceShape* shape = nullptr;
  std::vector<std::pair<std::size_t, double>> tiles;
  double area_m2 = 0, height = 0;  // counted area; times height
  double offset_m() const { return height / area_m2; }
};

using FaceMap = std::map<std::uint32_t, TilesOnFace>;

// Of the superclusters on one face the one with the most area.
std::uint32_t leading_plane(const ScanEvidence& scan, const TilesOnFace& on) {
  std::map<std::uint32_t, double> areas;
  for (const auto& [t, share] : on.tiles) areas[scan.tiles[t].supercluster] += scan.tiles[t].area_m2;
  std::uint32_t leading = areas.begin()->first;
  for (const auto& [supercluster, area] : areas)
    if (area > areas[leading]) leading = supercluster;
  return leading;
}

FaceMap find_faces(const PlaneSegmentation& segmentation, const ScanEvidence& scan,
                   const std::vector<TilePair>& pairs) {
  FaceMap faces;
  for (std::size_t t = 0; t < pairs.size(); ++t) {
    if (!pairs[t].face) continue;
    TilesOnFace& on = faces[pairs[t].face->face];
    on.shape = pairs[t].face;
    on.tiles.emplace_back(t, 1.0);
  }
  for (auto& [face, on] : faces) {
    const Plane& plane = segmentation.superclusters[leading_plane(scan, on)].plane;
    for (auto& [t, share] : on.tiles) {
      const PlaneTile& tile = scan.tiles[t];
      const double off = plane.distance(tile.centroid);
      // Rounding may leave a thickness just below 0.
      const double square = off * off + plane.normal.dot(tile.scatter * plane.normal) / tile.area_m2;
      const double rms = std::sqrt(std::max(square, 0.0));
      share = taper(rms, kSamePlane_m, kOtherPlane_m);
      on.area_m2 += share * tile.area_m2;
      on.height += share * tile.area_m2 * pairs[t].height_m;
    }
  }
  std::erase_if(faces, [](const auto& entry) { return !(entry.second.area_m2 > 0); });
  return faces;
}

double robust_spread(const FaceMap& faces) {
  std::vector<std::pair<double, double>> sorted;
  double total = 0, sum = 0;
  for (const auto& [face, on] : faces) {
    sorted.emplace_back(std::abs(on.offset_m()), on.area_m2);
    total += on.area_m2;
  }
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [offset, area] : sorted)
    if ((sum += area) >= total / 2) return 1.4826 * offset;
  return 0;
}

Vec3 centre_of(const ScanEvidence& scan) {
  Vec3 centre = Vec3::Zero();
  double area = 0;
  for (const PlaneTile& tile : scan.tiles) {
    centre += tile.area_m2 * tile.centroid;
    area += tile.area_m2;
  }
  return area > 0 ? Vec3(centre / area) : centre;
}

// The pose of least squares over the faces, each at its own offset from its plane; `start` where they leave
// it open.
Pose solve_jointly(const PlaneSegmentation& segmentation, const ScanEvidence& scan, const ModelShapes& model,
                   const Pose& start, Pose pose, const FaceOffsetOptions& options) {
  const Vec3 centre = centre_of(scan);
  const double radius = pose.scale * std::max(scan.reach_m, 1e-6);
  bool returned = false;
  for (int k = 0; k < kMaxIterations; ++k) {
    const auto pairs = find_pairs(scan, model, pose, options.reach_m);
    const FaceMap faces = find_faces(segmentation, scan, pairs);
    const double spread = std::max(robust_spread(faces), kLeastSpread_m);
    const Vec3 pivot = pose * centre;
    PlaneSums sums;
    for (const auto& [face, on] : faces)
      for (const auto& [t, share] : on.tiles)
        if (const double factor = share * taper(on.offset_m(), 3 * spread, 6 * spread); factor > 0)
          add_tile(scan.tiles[t], pairs[t], pose, pivot, factor, sums);
    if (!(sums.weight > 0)) break;
    StepSize step = apply_plane_step(sums, pivot, radius, false, pose);
    if (step.angle_rad >= kOffsetsSettledAngleRad || step.distance_m >= kOffsetsSettledDistanceM) continue;
    if (!returned) step = return_along_open(sums, centre, radius, start, pose);
    if (step.angle_rad < kOffsetsSettledAngleRad && step.distance_m < kOffsetsSettledDistanceM) break;
    returned = true;
  }
  return pose;
}

// Whether planes that lie on their faces within agree_m, tilt included, are most of the area and hold the
// pose.
bool faces_agree(const ScanEvidence& scan, const std::vector<TilePair>& pairs, const FaceMap& faces,
                 const Pose& pose, const FaceOffsetOptions& options) {
  PlaneSums sums, all;
  const Vec3 pivot = pose * centre_of(scan);
  for (const auto& [face, on] : faces) {
    double square = 0;
    for (const auto& [t, share] : on.tiles)
      square += share * scan.tiles[t].area_m2 * pairs[t].rms_m * pairs[t].rms_m;
    for (const auto& [t, share] : on.tiles) add_tile(scan.tiles[t], pairs[t], pose, pivot, share, all);
    if (square > on.area_m2 * options.agree_m * options.agree_m) continue;
    for (const auto& [t, share] : on.tiles) add_tile(scan.tiles[t], pairs[t], pose, pivot, share, sums);
  }
  if (!(sums.weight > 0) || sums.weight < kAgreeingShare * all.weight) return false;
  if (sums.weight >= kNearlyAll * all.weight) return true;
  const double radius = pose.scale * std::max(scan.reach_m, 1e-6);
  // Where all faces together leave a direction open, the agreeing ones may.
  return least_share(sums, radius) >= std::min(kHeldShare, kHeldOfAll * least_share(all, radius));
}

FaceOffset describe(const PlaneSegmentation& segmentation, const ScanEvidence& scan,
                    const PolygonModel& model, const Pose& pose, const TilesOnFace& on) {
  FaceOffset result;
  result.face = on.shape->face;
  result.name = model.faces[result.face].name;
  result.offset_m = on.offset_m();
  result.area_m2 = on.area_m2 * pose.scale * pose.scale;
  result.normal = on.shape->plane.normal;
  PlaneMoments moments;
  double samples = 0, noise = 0;
  for (const auto& [t, share] : on.tiles) {
    const PlaneTile& tile = scan.tiles[t];
    const Supercluster& one = segmentation.superclusters[tile.supercluster];
    moments.merge({share * tile.area_m2, tile.centroid, share * tile.scatter});
    noise += share * tile.area_m2 * one.rms_m * one.rms_m;
    if (one.area_m2 > 0) samples += share * static_cast<double>(one.samples) * tile.area_m2 / one.area_m2;
  }
  const PlaneFit fit = fit_plane(moments);
  const Vec3 n = pose.rotation.conjugate() * result.normal;
  result.centre = pose * moments.mean;
  result.tilt_deg =
      std::acos(std::clamp(std::abs(fit.plane.normal.dot(n)), 0.0, 1.0)) * 180 / std::numbers::pi;
  result.sigma_m = pose.scale * std::sqrt(std::max(n.dot(moments.scatter * n) + noise, 0.0) / moments.weight);
  result.samples = std::llround(samples);
  return result;
}

}  // namespace

const std::vector<OptionRow<FaceOffsetOptions>>& face_offset_option_table() {
  using O = FaceOffsetOptions;
  static const std::vector<OptionRow<FaceOffsetOptions>> table = {
      {"face_offsets", "", &O::solve, 0, 0, "solve the faces' offsets with the pose", {"auto", "never"}},
      {"face_reach_m", "m", &O::reach_m, 0.001, 10, "a face is at most this far off", {}},
      {"face_agree_m", "m", &O::agree_m, 0, 10, "faces that agree within this are right as they are", {}},
  };
  return table;
}

Pose solve_face_offsets(const PlaneSegmentation& segmentation, const ScanEvidence& scan,
                        const ProxyModel& model, const Pose& start, const FaceOffsetOptions& options) {
  const ModelShapes& shapes = model.shapes();
  if (!shapes.has_large_faces()) return start;
  return solve_jointly(segmentation, scan, shapes, start, fit_tiles(scan, shapes, start).world_from_scan,
                       options);
}

FaceOffsets measure_face_offsets(const PlaneSegmentation& segmentation, const ScanEvidence& scan,
                                 const ProxyModel& model, const Pose& pose,
                                 const FaceOffsetOptions& options) {
  FaceOffsets result;
  const ModelShapes& shapes = model.shapes();
  if (!shapes.has_large_faces()) {
    result.note = fmt::format(
        "the model is a mesh of {} faces, too small to be measured one by one: residuals.png shows them",
        shapes.all_faces);
    return result;
  }
  const auto pairs = find_pairs(scan, shapes, pose, options.reach_m);
  const FaceMap faces = find_faces(segmentation, scan, pairs);
  result.disagreement_m = robust_spread(faces);
  result.agree = faces_agree(scan, pairs, faces, pose, options);
  for (const auto& [face, on] : faces)
    result.faces.push_back(describe(segmentation, scan, model.polygons(), pose, on));
  std::stable_sort(result.faces.begin(), result.faces.end(),
                   [](const FaceOffset& a, const FaceOffset& b) { return a.area_m2 > b.area_m2; });
  return result;
}

void add_pose_sigma(const std::array<double, 36>& covariance, FaceOffsets& offsets) {
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> c(covariance.data());
  for (FaceOffset& face : offsets.faces) {
    Eigen::Matrix<double, 6, 1> along;  // d height / d (rotation about the origin, translation)
    along << face.centre.cross(face.normal), face.normal;
    face.pose_sigma_m = std::sqrt(std::max(along.dot(c * along), 0.0));
  }
}

std::string offset_in_words(const FaceOffset& offset) {
  const double mm = 1000 * offset.offset_m;
  const std::string place = std::abs(mm) < 0.05
                                ? "on the face"
                                : fmt::format("{:.1f} mm {}", std::abs(mm), mm < 0 ? "behind" : "in front");
  return fmt::format("scan lies {}, sigma {:.1f} mm", place, 1000 * offset.sigma_m);
}

}  // namespace hybrid::stages
