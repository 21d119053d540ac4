#include "batch/registration/registration_unit.hpp"

#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "batch/registration/recorded_poses.hpp"
#include "batch/registration/registration_json.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "core/parallel_blocks.hpp"
#include "geometry/angles.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "stages/registration/automatic_checks.hpp"
#include "stages/registration/face_sides.hpp"
#include "stages/registration/landmark_check.hpp"
#include "stages/registration/pose_evidence.hpp"

namespace hybrid::batch {
namespace {

// Normals of a scan plane and a face that may be one surface differ by at most this.
constexpr double kCompatibleDeg = 30;

Vec3 picked_point(const io::SceneLandmark& landmark, const RangeImage& image) {
  if (landmark.scan) return *landmark.scan;
  const auto [row, col] = *landmark.pixel;
  if (row < 0 || col < 0 || row >= image.rows || col >= image.cols)
    fail_input("pixel [{}, {}]: outside the range image of {} rows x {} columns", row, col, image.rows,
               image.cols);
  const std::size_t i = image.index(row, col);
  if (image.mask[i] != kMeasured)
    fail_input("pixel [{}, {}]: no measured sample there; pick a pixel with a return", row, col);
  return image.point(i);
}

std::string place_of(const io::SceneLandmark& landmark) {
  if (landmark.pixel) return fmt::format("pixel [{}, {}]", (*landmark.pixel)[0], (*landmark.pixel)[1]);
  const Vec3& p = *landmark.scan;
  return fmt::format("scan [{:.3f}, {:.3f}, {:.3f}]", p.x(), p.y(), p.z());
}

Vec3 model_point(const io::SceneLandmark& landmark, const PolygonModel& model) {
  if (landmark.model) return *landmark.model;
  const int vertex = *landmark.vertex;
  if (vertex < 0 || static_cast<std::size_t>(vertex) >= model.vertices.size())
    fail_input("vertex {}: the model has {} vertices (0-based, in file order)", vertex,
               model.vertices.size());
  return model.vertices[static_cast<std::size_t>(vertex)];
}

stages::CheckedLandmarks check_start(const io::SceneScan& entry, const PolygonModel& model,
                                     const ScanProduct& product, const StageOptions& options) {
  std::vector<stages::LandmarkPair> pairs;
  for (std::size_t i = 0; i < entry.landmarks.size(); ++i) {
    const auto& landmark = entry.landmarks[i];
    const std::string name = fmt::format("landmark {} (line {})", i + 1, landmark.line);
    pairs.push_back(with_context(name, [&] {
      return stages::LandmarkPair{name, picked_point(landmark, product.image), model_point(landmark, model),
                                  landmark.snap, place_of(landmark)};
    }));
  }
  return stages::check_landmarks(model, pairs, options.landmarks);
}

// A supercluster within 30 degrees of vertical is a wall from this area on; below it stands furniture.
constexpr double kLeastWallM2 = 1;
constexpr float kNear_m = 0.10f, kNearer_m = 0.05f;  // of a face: shares of the walls' samples
constexpr std::size_t kBlock = 1 << 18;              // samples, looked at together

// Per label, whether it is a wall's.
std::vector<std::uint8_t> walls(const ScanProduct& product, const Pose& world_from_scan) {
  std::vector<std::uint8_t> wall(product.segmentation.superclusters.size() + 1, 0);
  for (const auto& supercluster : product.segmentation.superclusters)
    wall[supercluster.id] =
        supercluster.area_m2 >= kLeastWallM2 &&
        std::abs(world_from_scan.rotate(supercluster.plane.normal).z()) < std::sin(M_PI / 6);
  return wall;
}

// `near_steps(i)`: within how many of kNear_m and kNearer_m a face is.
template <typename NearSteps>
WallShare wall_share(const ScanProduct& product, const std::vector<std::uint8_t>& wall,
                     const NearSteps& near_steps) {
  struct Counts {
    std::int64_t samples = 0, near = 0, nearer = 0;
    Counts& operator+=(const Counts& other) {
      samples += other.samples;
      near += other.near;
      nearer += other.nearer;
      return *this;
    }
  };
  const Counts counts = sum_blocks<Counts>(product.image.count(), [&](std::size_t begin, std::size_t end) {
    Counts own;
    for (std::size_t i = begin; i < end; ++i) {
      if (product.image.mask[i] != kMeasured || !wall[product.segmentation.sample_label[i]]) continue;
      ++own.samples;
      own.near += near_steps(i) >= 1;
      own.nearer += near_steps(i) >= 2;
    }
    return own;
  });
  WallShare share;
  share.samples = counts.samples;
  if (counts.samples > 0) {
    share.within_10cm = static_cast<double>(counts.near) / static_cast<double>(counts.samples);
    share.within_5cm = static_cast<double>(counts.nearer) / static_cast<double>(counts.samples);
  }
  return share;
}

WallShare share_before(device::Queue& queue, const stages::ProxyModel& model, const ScanProduct& product,
                       const Pose& start) {
  const auto wall = walls(product, start);
  std::vector<std::uint8_t> of_wall(product.image.count());
  for_blocks(of_wall.size(), kBlock, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) of_wall[i] = wall[product.segmentation.sample_label[i]];
  });
  const auto near = stages::near_faces(queue, product.image, product.segmentation, model, start,
                                       kCompatibleDeg, {kNear_m, kNearer_m}, of_wall);
  return wall_share(product, wall, [&](std::size_t i) { return near[i]; });
}

// METHOD 4: what no face explains keeps its samples, or is its contour polygon where that is faithful.
void give_back_unexplained(const ScanRegistration& registration, const StageOptions& options,
                           ScanProduct& product) {
  std::vector<std::uint8_t> explained(product.image.count());
  for_blocks(explained.size(), kBlock, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      explained[i] = std::abs(registration.signed_distance_m[i]) <= options.explain_m;
  });
  stages::keep_unexplained(explained, product.decimation);
  product.contour_faces = stages::unexplained_contours(
      product.image, product.segmentation, product.intersections, explained, product.stray, product.sigma_m,
      options.contour_faces, registration.world_from_scan());
  stages::discard_covered(product.contour_faces.covered, product.decimation);
}

// From the planes alone; whether that is accepted.
bool found_automatically(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                         ScanRegistration& result) {
  result.automatic = stages::align_automatically(queue, result.evidence, model, options.alignment);
  if (!result.automatic->accepted) return false;
  result.how = "automatic";
  result.start = result.automatic->world_from_scan;
  return true;
}

// Landmarks that do not belong together leave the start to the planes alone, where these may try.
void start_from_landmarks(device::Queue& queue, const io::SceneScan& entry, const stages::ProxyModel& model,
                          const StageOptions& options, const ScanProduct& product, ScanRegistration& result) {
  if (result.automatic) log::info("scan {}: landmarks decide: {}", product.id, result.automatic->reason);
  result.how = "landmarks";
  auto checked = check_start(entry, model.polygons(), product, options);
  result.landmarks = std::move(checked.fit);
  result.start = result.landmarks->world_from_scan;
  if (!checked.warning.empty()) warn(product, checked.warning, result);
  if (checked.refusal.empty()) return;
  if (options.automatic == "missing" && found_automatically(queue, model, options, result)) {
    warn(product, checked.refusal + "; the scan is placed by its planes alone", result);
    return;
  }
  result.refusal = std::move(checked.refusal);
  result.abstained = true;
}

// From the scene's pose, landmarks or the planes alone, in METHOD's order of trust.
void find_start(device::Queue& queue, const io::SceneScan& entry, const stages::ProxyModel& model,
                const StageOptions& options, const ScanProduct& product, ScanRegistration& result) {
  const bool has_landmarks = !entry.landmarks.empty();
  if (entry.pose) {
    result.how = "given";
    result.fixed = entry.fixed;
    result.start = pose_from_row_major(*entry.pose);
    return;
  }
  if (options.automatic == "first" || (options.automatic == "missing" && !has_landmarks)) {
    if (found_automatically(queue, model, options, result)) return;
    result.how = "automatic";
    result.start = result.automatic->world_from_scan;
    result.abstained = !has_landmarks;
    if (result.abstained) return;
  }
  if (!has_landmarks) {
    const std::string none =
        "no landmarks and no pose: give at least 3 landmarks (4 are better) or a pose in the scene file";
    if (!product.recorded_pose) fail_input("{}", none);
    result.refusal = none;  // unless its file's pose tells its place beside other scans
    result.no_start = true;
    result.abstained = true;
    return;
  }
  start_from_landmarks(queue, entry, model, options, product, result);
}

// Offsets go with the plane step and its robust weights: the paper's ICP, asked for, stays the paper's.
bool may_solve_faces(const StageOptions& options) {
  return options.faces.solve == "auto" && options.icp.step == "plane" && options.icp.robust == "tukey" &&
         !options.icp.free_scale;
}

// Below this share of the planar area within centimetres of a face ICP has found nothing to hold on to.
constexpr double kLeastOverlap = 0.001;

void check_overlap(const stages::ProxyModel& proxy, const StageOptions& options,
                   const ScanRegistration& result) {
  if (result.icp.overlap >= kLeastOverlap) return;
  const auto turned = stages::diagnose_turned_faces(result.evidence, proxy, result.start, options.alignment);
  if (!turned.empty())
    fail_input("registration: no plane of the scan lies on a face of the model that looks its way: {}",
               turned);
  const PolygonModel& model = proxy.polygons();
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : model.vertices) box.extend(vertex);
  fail_input(
      "registration: from its start no plane of the scan comes to lie on a face of the model that looks its "
      "way; the model is {:.4g} m across, the scan's planes lie {:.4g} m away on average: check the model's "
      "unit (unit in [model]), that it is not mirrored (faces counter-clockwise seen from the scanner), and "
      "the pose or landmarks; fixed = true keeps a given pose as it is",
      box.diagonal().norm(), result.evidence.reach_m);
}

std::string refused_in_words(const ScanRegistration& result, const std::string& contradiction,
                             const std::string& diagnosis) {
  const stages::SightShares& area = *result.planar_area;
  return fmt::format(
      "the scan's planes contradict the pose that ICP found from {}: {}; its rms is {:.4g} m, and of the "
      "planar area {:.0f} % lie on faces, {:.0f} % in front of them, {:.0f} % are seen through them, {:.0f} "
      "% "
      "behind them, {:.0f} % without a face; {}. {}; fixed = true keeps a given pose as it is",
      result.landmarks ? "the landmarks" : "the given pose", contradiction, result.icp.rms_m,
      100 * area.supported, 100 * area.in_front, 100 * area.through, 100 * area.behind, 100 * area.nothing,
      diagnosis.empty() ? "it may be the model of another place" : diagnosis,
      result.landmarks ? "Check which corners were picked, or give a pose"
                       : "Check the pose (world_from_scan, row by row, metres), or give 3 or more landmarks");
}

// From farther off ICP finds some other place, which may fit as well.
constexpr double kFarthestLed_m = 2, kFarthestLedDeg = 40;

std::string led_away(const ScanRegistration& result, const StageOptions& options) {
  const auto moved = difference(result.start, result.world_from_scan());
  const double scale = options.icp.free_scale ? result.world_from_scan().scale : 1;
  if (moved.within(kFarthestLed_m * scale, kFarthestLedDeg * kDegree)) return "";
  return fmt::format("it lies {:.2f} m and {:.1f} degrees from there, more than {:.3g} m or {} degrees",
                     moved.distance_m, moved.angle_rad / kDegree, kFarthestLed_m * scale, kFarthestLedDeg);
}

// Takes a pose back that was not found by the planes' evidence and that this contradicts.
void judge(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
           ScanRegistration& result) {
  if (result.how == "automatic") return;
  auto evidence =
      stages::judge_pose(queue, result.evidence, model, result.icp, options.icp, options.alignment);
  result.planar_area = evidence.shares;
  if (evidence.contradiction.empty()) evidence.contradiction = led_away(result, options);
  if (evidence.contradiction.empty()) return;
  auto diagnosis = stages::diagnose_turned_faces(result.evidence, model, result.start, options.alignment);
  if (diagnosis.empty())
    diagnosis = stages::diagnose_pose(queue, result.evidence, model, result.world_from_scan().scale,
                                      evidence.shares.supported, options.alignment);
  result.refusal = refused_in_words(result, evidence.contradiction, diagnosis);
  result.abstained = true;
}

// Of a pose that ICP did not end at: what is said of it, but for ICP's own course.
void describe_pose(device::Queue& queue, const stages::PlanarSamples& samples,
                   const stages::ProxyModel& model, const StageOptions& options, const Pose& pose,
                   stages::Registration& icp) {
  const bool converged = icp.converged;
  const int iterations = icp.iterations;
  icp = stages::assess_pose(queue, samples, model, pose, options.icp);
  icp.converged = converged;
  icp.iterations = iterations;
}

stages::FaceOffsets faces_under(const stages::ProxyModel& model, const StageOptions& options,
                                const ScanProduct& product, const ScanRegistration& registration) {
  auto faces = stages::measure_face_offsets(product.segmentation, registration.evidence, model,
                                            registration.world_from_scan(), options.faces);
  if (!registration.fixed) stages::add_pose_sigma(registration.icp.covariance, faces);
  return faces;
}

}  // namespace

void warn(const ScanProduct& product, const std::string& warning, ScanRegistration& registration) {
  log::warning("scan {}: {}", product.id, warning);
  registration.warnings.push_back(warning);
}

std::string reason_of(const ScanRegistration& abstained) {
  const std::string own = abstained.automatic ? abstained.automatic->reason : "";
  if (abstained.refusal.empty() && own.empty())  // without a model
    return (abstained.neighbour_reason.empty() ? "there is no other scan to align to"
                                               : abstained.neighbour_reason) +
           "; give a pose in the scene file, a [model], or a scan taken between this one and others";
  if (abstained.refusal.empty()) return own;
  return abstained.refusal + (own.empty() ? "" : "; the automatic alignment abstains, too: " + own);
}

void refine_to_model(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                     const ScanProduct& product, ScanRegistration& result) {
  const auto samples = stages::choose_planar_samples(product.image, product.segmentation,
                                                     options.icp.max_samples, options.icp.seed);
  Pose start = result.start;
  if (may_solve_faces(options))
    start = stages::solve_face_offsets(product.segmentation, result.evidence, model, start, options.faces);
  result.icp = stages::register_to_model(queue, samples, model, start, options.icp);
  result.held_by_model = true;
  result.faces = faces_under(model, options, product, result);
  if (!may_solve_faces(options) || result.faces->agree || result.faces->faces.empty()) return;
  result.solved_with_faces = true;
  describe_pose(queue, samples, model, options, start, result.icp);
  result.faces = faces_under(model, options, product, result);
}

namespace {

// Other programs show a scan's points as its file's pose has them, and picks are taken there.
bool placed_by_file_picks(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                          const ScanProduct& product, ScanRegistration& result) {
  if (!result.landmarks || !product.recorded_pose) return false;
  ScanRegistration other = result;
  other.start = result.landmarks->world_from_scan * *product.recorded_pose;
  if (is_one_place(other.start, result.start)) return false;
  refine_to_model(queue, model, options, product, other);
  const auto evidence =
      stages::judge_pose(queue, other.evidence, model, other.icp, options.icp, options.alignment);
  if (!evidence.contradiction.empty() || !led_away(other, options).empty()) return false;
  other.planar_area = evidence.shares;
  other.refusal.clear();
  other.abstained = false;
  warn(product,
       "its landmarks are not in the scan's frame, with the scanner at the origin, but in the file's "
       "coordinates, whose pose it has: they are taken so",
       other);
  result = std::move(other);
  return true;
}

}  // namespace

ScanRegistration find_pose(device::Queue& queue, const io::SceneScan& entry, const stages::ProxyModel& model,
                           const StageOptions& options, const ScanProduct& product, Progress& progress) {
  const std::string unit = "scan " + product.id;
  ScanRegistration result;
  progress.step("landmarks", unit);
  result.evidence = stages::gather_evidence(product.image, product.segmentation, options.alignment.rays,
                                            options.alignment.seed);
  find_start(queue, entry, model, options, product, result);
  if (result.abstained) return result;
  progress.step("ICP", unit);
  result.icp.world_from_scan = result.start;
  if (result.fixed) {
    result.faces = faces_under(model, options, product, result);
    return result;
  }
  refine_to_model(queue, model, options, product, result);
  const bool near = result.icp.overlap >= kLeastOverlap;
  if (near) judge(queue, model, options, result);
  if ((!near || result.abstained) && !placed_by_file_picks(queue, model, options, product, result))
    check_overlap(model, options, result);
  if (result.abstained) return result;
  if (!result.icp.converged)
    warn(product,
         fmt::format(
             "ICP did not converge in {} iterations: raise max_iterations in [register], or start nearer",
             result.icp.iterations),
         result);
  return result;
}

void assess(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
            const ScanProduct& product, const Pose& pose, ScanRegistration& registration) {
  const auto samples = stages::choose_planar_samples(product.image, product.segmentation,
                                                     options.icp.max_samples, options.icp.seed);
  describe_pose(queue, samples, model, options, pose, registration.icp);
  registration.faces = faces_under(model, options, product, registration);
}

void finish_registration(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                         ScanProduct& product, ScanRegistration& result, Progress& progress) {
  progress.step("residuals", "scan " + product.id);
  result.wall_before = share_before(queue, model, product, result.start);
  const Pose& pose = result.world_from_scan();
  result.signed_distance_m = stages::signed_distance_to_model(queue, product.image, product.segmentation,
                                                              model, pose, kCompatibleDeg, kFreeReach_m);
  result.wall_after = wall_share(product, walls(product, pose), [&](std::size_t i) {
    const float distance = std::abs(result.signed_distance_m[i]);  // comparing is false for NaN
    return (distance <= kNear_m) + (distance <= kNearer_m);
  });
  result.residuals = residual_histogram({product.image, product.segmentation, result.signed_distance_m});
  give_back_unexplained(result, options, product);
  const bool held = result.slide && result.slide->found.accepted;
  if (!result.fixed && !result.icp.degenerate.empty() && !held)
    warn(product,
         fmt::format(
             "the model leaves the pose undetermined: it is {}; there it is as its start has it, or as "
             "other scans hold it{}: give landmarks or a pose that is exact there, or add faces to the "
             "model",
             fmt::join(result.icp.degenerate, ", "),
             result.slide ? fmt::format(" (their samples do not: {})", result.slide->found.reason) : ""),
         result);
}

std::optional<RegisteredNodes> residual_nodes(const ScanProduct& product,
                                              const ScanRegistration& registration) {
  if (!registration.signed_distance_m.empty())
    return RegisteredNodes{{product.image, product.segmentation, registration.signed_distance_m}, "model"};
  if (!registration.to_scans) return std::nullopt;
  const auto& to_scans = *registration.to_scans;
  return RegisteredNodes{{to_scans.image, to_scans.segmentation, to_scans.signed_m}, "scans"};
}

void write_pose_outputs(const std::filesystem::path& folder, const ScanProduct& product,
                        const ScanRegistration& registration) {
  const auto picture = folder / "residuals.png";
  if (const auto found = residual_nodes(product, registration))
    io::write_png(picture, residual_picture(found->nodes, registration.residuals,
                                            found->to == "model" ? "the face" : "other scans"));
  else
    std::filesystem::remove(picture);  // of an earlier run
  io::write_text(folder / "pose.json", json_text(pose_json(product, registration)) + "\n");
}

}  // namespace hybrid::batch
