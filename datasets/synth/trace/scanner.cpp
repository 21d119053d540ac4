// A time-of-flight scanner of about 2004 (Lamond and Watson, section 2.1): a rotating mirror sweeps the beam
// up one column while the housing turns by even steps in azimuth; where a column starts, and so how many
// samples it holds, varies.
#include "trace/scanner.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "surface/material.hpp"

namespace synth {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLowestRad = -60 * kDegree;  // the tripod hides what is below
constexpr double kHighestRad = 89.5 * kDegree;
constexpr double kBeamRadiusM = 0.003;    // at the mirror
constexpr double kBeamSpreadRad = 0.001;  // half angle
constexpr double kMixedJumpM = 0.01;      // sub-rays farther than this from the centre's surface: mixed
constexpr int kSubRays = 8;

struct Beam {
  const Room& room;
  const Tracer& tracer;
  Vec3 mirror;  // world

  double reflectance(const Hit& hit, const Vec3& direction) const {
    const Rgb albedo = finish(room, hit.surface, hit.point, 2 * kBeamRadiusM).albedo;
    const double lambert = std::abs(hit.normal.dot(direction));
    return (0.6 * albedo.x() + 0.3 * albedo.y() + 0.1 * albedo.z()) * (0.25 + 0.75 * lambert);
  }

  struct Return {
    double range_m, true_range_m, reflectance;
    std::uint32_t plane_id;
    SampleKind kind;
  };

  // The sub-rays lie on a ring at 0.7 of the beam's radius. A bend between surfaces that meet leaves the
  // return on the centre's surface; a jump in depth averages the parts by what each sends back.
  std::optional<Return> measure(const Vec3& direction) const {
    const std::optional<Hit> centre = tracer.nearest(mirror, direction);
    if (!centre) return std::nullopt;
    const Surface& surface = room.mesh.surfaces[centre->surface];
    const double strength = reflectance(*centre, direction);
    Return result{centre->distance_m, centre->distance_m, strength,
                  static_cast<std::uint32_t>(surface.plane_id),
                  surface.shape == Shape::plane ? SampleKind::planar : SampleKind::curved};

    const Vec3 side =
        direction.cross(std::abs(direction.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized();
    const Vec3 up = side.cross(direction);
    const double radius = 0.7 * (kBeamRadiusM / std::max(0.5, centre->distance_m) + kBeamSpreadRad);
    double sum = 0, weights = 0;
    bool jumps = false;
    const auto add = [&](const Hit& hit, const Vec3& ray) {
      const double weight = reflectance(hit, ray);
      sum += weight * hit.distance_m;
      weights += weight;
    };
    std::array<std::optional<Hit>, kSubRays> hits;
    std::array<Vec3, kSubRays> rays;
    for (int k = 0; k < kSubRays; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSubRays;
      rays[k] = (direction + radius * (std::cos(angle) * side + std::sin(angle) * up)).normalized();
      hits[k] = tracer.nearest(mirror, rays[k]);
      if (!hits[k]) continue;
      const double expected = (centre->normal.dot(centre->point - mirror)) / centre->normal.dot(rays[k]);
      jumps |= !(std::abs(hits[k]->distance_m - expected) < kMixedJumpM);
    }
    if (!jumps) return result;
    add(*centre, direction);
    for (int k = 0; k < kSubRays; ++k)
      if (hits[k]) add(*hits[k], rays[k]);
    result.range_m = sum / weights;
    result.reflectance = weights / (kSubRays + 1);
    result.plane_id = 0;
    result.kind = SampleKind::mixed;
    return result;
  }
};

std::vector<Sample> sweep_column(const Beam& beam, const Eigen::Matrix3d& world_from_scan_rotation,
                                 const RoomOptions& options, std::uint64_t scan_index, int column) {
  const int columns = options.preset.scan_columns;
  Random random(options.seed, purpose::scan_column + 100 * (scan_index + 1),
                static_cast<std::uint64_t>(column));
  const double step = (kHighestRad - kLowestRad) / options.preset.scan_rows;
  const double azimuth = 2 * std::numbers::pi * (column + 0.5 + 0.004 * random.normal()) / columns;
  const double start = kLowestRad + step * random.uniform(0, 2.5),
               end = kHighestRad - step * random.uniform(0, 3);
  std::vector<Sample> samples;
  for (int k = 0;; ++k) {
    const double jitter = std::clamp(0.04 * random.normal(), -0.2, 0.2);
    const double elevation = start + step * (k + jitter);
    // Every sample draws the same count whatever it hits, so one change in the room leaves the others' noise
    // alone.
    const double range_noise = options.noise_m * random.normal(), intensity_noise = 0.012 * random.normal();
    const bool dropped = random.uniform() < options.dropout_share;
    if (elevation > end) return samples;
    const Vec3 in_scan(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                       std::sin(elevation));
    const auto hit = dropped ? std::nullopt : beam.measure(world_from_scan_rotation * in_scan);
    if (!hit) continue;
    const double fading = 1.0 / (1.0 + 0.01 * hit->range_m * hit->range_m);
    samples.push_back(
        {((hit->range_m + range_noise) * in_scan).cast<float>(),
         static_cast<float>(std::clamp(hit->reflectance * fading * 1.3 + intensity_noise, 0.0, 1.0)),
         hit->plane_id, static_cast<float>(hit->true_range_m), hit->kind});
  }
}

}  // namespace

Scan simulate_scan(const Room& room, const Tracer& tracer, const ScannerPose& pose,
                   const RoomOptions& options, std::uint64_t scan_index) {
  const Beam beam{room, tracer, pose.world_from_scan.translation()};
  std::vector<std::vector<Sample>> columns(static_cast<std::size_t>(options.preset.scan_columns));
  tbb::parallel_for(0, options.preset.scan_columns, [&](int column) {
    columns[static_cast<std::size_t>(column)] =
        sweep_column(beam, pose.world_from_scan.rotation(), options, scan_index, column);
  });
  Scan scan{pose, {}, {}};
  for (const auto& column : columns) {
    scan.samples.insert(scan.samples.end(), column.begin(), column.end());
    scan.samples_of_column.push_back(static_cast<std::uint32_t>(column.size()));
  }
  return scan;
}

}  // namespace synth
