#include "stages/rendering/equalise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/median.hpp"
#include "core/parallel.hpp"
#include "stages/rendering/light_cells.hpp"
#include "stages/rendering/photo_blend.hpp"

namespace hybrid::stages {
namespace {

// Coarse pixels a photograph is cut into, along its longer side, and all photographs' points together.
constexpr double kCells = 160;
constexpr double kPoints = 400'000;
// Overlaps of fewer points say nothing; the prior counts as this many.
constexpr std::size_t kFewest = 30;
constexpr double kPriorPoints = 30;

// The camera with pixels `factor` times as large.
Photograph coarse(const Photograph& photograph, double factor) {
  Photograph out = photograph;
  Camera& c = out.camera;
  c.width = std::max(1, static_cast<int>(c.width / factor));
  c.height = std::max(1, static_cast<int>(c.height / factor));
  const double x = static_cast<double>(c.width) / photograph.camera.width,
               y = static_cast<double>(c.height) / photograph.camera.height;
  c.fx *= x, c.cx *= x;
  c.fy *= y, c.cy *= y;
  return out;
}

double coarse_factor(const Photograph& photograph, std::size_t photographs) {
  const double width = photograph.camera.width, height = photograph.camera.height;
  const double cells = std::min(kCells, std::sqrt(kPoints / static_cast<double>(photographs)));
  return std::max(1.0, std::max(width, height) / cells);
}

// Where the photograph's coarse pixels lie on the surface.
void add_points(RenderState& state, const Photograph& photograph, std::vector<SurfacePoint>& points) {
  const Camera& camera = photograph.camera;
  SurfaceTile tile(state.queue,
                   static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  cast_tile(state.queue, state.geometry("both"), camera_record(photograph, state.origin),
            {0, 0, camera.height, camera.width}, {0.5f, 0.5f}, state.options.surface_tolerance_m, tile);
  const std::vector<float> surface = state.queue.read(tile.surface);
  const std::size_t count = tile.count();
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(surface[SURFACE_X * count + i])) continue;
    SurfacePoint point;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      point.position[axis] = state.origin[axis] + static_cast<double>(surface[(SURFACE_X + k) * count + i]);
      point.normal[axis] = static_cast<double>(surface[(SURFACE_NORMAL_X + k) * count + i]);
    }
    points.push_back(point);
  }
}

double mean_log(const LogLight& light) {
  return (static_cast<double>(light[0]) + static_cast<double>(light[1]) + static_cast<double>(light[2])) / 3;
}

// Logarithms of light that vary by less are of one tone, and noise.
constexpr double kLeastVariation = 0.05;

// Pearson's, of pairs; NaN where either hardly varies.
double correlation_of(const std::vector<std::array<double, 2>>& pairs) {
  std::array<double, 2> mean{};
  for (const auto& pair : pairs)
    for (std::size_t k = 0; k < 2; ++k) mean[k] += pair[k] / static_cast<double>(pairs.size());
  double aa = 0, bb = 0, ab = 0;
  for (const auto& pair : pairs) {
    const double a = pair[0] - mean[0], b = pair[1] - mean[1];
    aa += a * a, bb += b * b, ab += a * b;
  }
  const double least = kLeastVariation * kLeastVariation * static_cast<double>(pairs.size());
  return aa > least && bb > least ? ab / std::sqrt(aa * bb) : NAN;
}

// Of two photographs' points in ascending order, those of both.
PhotographOverlap overlap(std::size_t first, std::size_t second,
                          const std::vector<std::vector<std::uint32_t>>& seen,
                          const std::vector<std::vector<LogLight>>& lights) {
  std::array<std::vector<double>, 3> ratios;
  std::vector<std::array<double, 2>> means;
  const auto &a = seen[first], &b = seen[second];
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i] != b[j]) {
      a[i] < b[j] ? ++i : ++j;
      continue;
    }
    const LogLight &from = lights[first][i++], &to = lights[second][j++];
    if (std::isnan(from[0]) || std::isnan(to[0])) continue;
    for (std::size_t k = 0; k < 3; ++k)
      ratios[k].push_back(static_cast<double>(to[k]) - static_cast<double>(from[k]));
    means.push_back({mean_log(from), mean_log(to)});
  }
  PhotographOverlap found{first, second, ratios[0].size(), {}, correlation_of(means)};
  for (std::size_t k = 0; k < 3 && found.points > 0; ++k) found.log_ratio[k] = median(ratios[k]);
  return found;
}

// Blended by these, a point's colour is the weighted mean of its photographs' logarithms of gains.
std::vector<device::Array<float>> log_gain_tables(const RenderState& state) {
  std::vector<device::Array<float>> tables;
  for (const auto& gain : state.gains) {
    std::vector<float> table;
    for (const double factor : gain) table.insert(table.end(), 256, static_cast<float>(std::log(factor)));
    tables.push_back(state.queue.array(table));
  }
  return tables;
}

}  // namespace

PhotographOverlaps measure_overlaps(Renderer& renderer, RenderState& state) {
  const auto& photographs = state.scene.photographs;
  std::vector<SurfacePoint> points;
  for (const Photograph& photograph : photographs)
    add_points(state, coarse(photograph, coarse_factor(photograph, photographs.size())), points);
  const auto seen = renderer.seen_from(photographs, points);

  std::vector<std::vector<LogLight>> lights(photographs.size());
  for (std::size_t p = 0; p < photographs.size(); ++p) {
    const double reach = coarse_factor(photographs[p], photographs.size()) / 2;
    const LightCells cells(*photograph_image(state.scene, p), reach);
    lights[p].resize(seen[p].size());
    parallel_for(
        seen[p].size(),
        [&](std::size_t i) {
          const auto at =
              photographs[p].camera.project(photographs[p].cam_from_world * points[seen[p][i]].position);
          lights[p][i] = at ? cells.around(*at) : LogLight{NAN, NAN, NAN};
        },
        1024);
  }
  PhotographOverlaps overlaps;
  for (const auto& list : seen) overlaps.points.push_back(list.size());
  for (std::size_t first = 0; first < photographs.size(); ++first)
    for (std::size_t second = first + 1; second < photographs.size(); ++second)
      if (const auto found = overlap(first, second, seen, lights); found.points >= kFewest)
        overlaps.pairs.push_back(found);
  return overlaps;
}

std::vector<PhotographAgreement> agreements_of(const PhotographOverlaps& overlaps) {
  struct Weighted {
    double correlation;
    std::size_t points;
  };
  std::vector<std::vector<Weighted>> each(overlaps.points.size());
  for (const PhotographOverlap& pair : overlaps.pairs)
    for (const std::size_t photograph : {pair.first, pair.second})
      if (!std::isnan(pair.correlation)) each[photograph].push_back({pair.correlation, pair.points});
  std::vector<PhotographAgreement> agreements;
  for (std::size_t i = 0; i < each.size(); ++i) {
    std::sort(each[i].begin(), each[i].end(), [](const Weighted& a, const Weighted& b) {
      return std::tie(a.correlation, a.points) < std::tie(b.correlation, b.points);
    });
    std::size_t all = 0, before = 0;
    for (const Weighted& pair : each[i]) all += pair.points;
    PhotographAgreement agreement{overlaps.points[i], std::nullopt};
    for (const Weighted& pair : each[i]) {
      before += pair.points;
      if (agreement.correlation || 2 * before < all) continue;
      agreement.correlation = pair.correlation;
    }
    agreements.push_back(agreement);
  }
  return agreements;
}

std::vector<std::array<double, 3>> solve_gains(std::size_t photographs,
                                               const std::vector<PhotographOverlap>& overlaps) {
  const auto count = static_cast<Eigen::Index>(photographs);
  Eigen::MatrixXd normal = kPriorPoints * Eigen::MatrixXd::Identity(count, count);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
  for (const PhotographOverlap& pair : overlaps) {
    const auto a = static_cast<Eigen::Index>(pair.first), b = static_cast<Eigen::Index>(pair.second);
    const auto weight = static_cast<double>(pair.points);
    normal(a, a) += weight, normal(b, b) += weight;
    normal(a, b) -= weight, normal(b, a) -= weight;
    for (Eigen::Index k = 0; k < 3; ++k) {
      right(a, k) += weight * pair.log_ratio[static_cast<std::size_t>(k)];
      right(b, k) -= weight * pair.log_ratio[static_cast<std::size_t>(k)];
    }
  }
  std::vector<std::array<double, 3>> gains(photographs, {1, 1, 1});
  if (photographs == 0) return gains;
  const Eigen::MatrixXd solved = normal.ldlt().solve(right);
  for (std::size_t i = 0; i < photographs; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      gains[i][k] = std::exp(solved(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)));
  return gains;
}

std::array<double, 3> view_exposure(RenderState& state, const ViewRequest& request,
                                    const std::vector<std::size_t>& used) {
  const Photograph grid = coarse(request.camera, coarse_factor(request.camera, 1));
  const auto capacity =
      static_cast<std::size_t>(grid.camera.width) * static_cast<std::size_t>(grid.camera.height);
  const CameraRecord camera = camera_record(grid, state.origin);
  const DeviceBvh& shown = state.geometry(request.show);
  SurfaceTile tile(state.queue, capacity);
  cast_tile(state.queue, shown, camera, {0, 0, grid.camera.height, grid.camera.width}, {0.5f, 0.5f},
            state.options.surface_tolerance_m, tile);

  RenderOptions options = state.options;
  if (options.blend != "nearest")
    options.blend = "linear";  // the lowest band's weights, which hold the light
  PhotoBlend blend(state.queue, options, capacity);
  const auto tables = log_gain_tables(state);
  const PhotoBlendView view{{camera.centre[0], camera.centre[1], camera.centre[2]},
                            pixel_angle_rad(request.camera.camera)};
  blend.blend(state.store, shown, state.everything(shown), tile, view, used, tables);
  const std::vector<float> logs = state.queue.read(blend.colour());
  const std::vector<std::uint32_t> seen = state.queue.read(blend.seen());

  std::array<double, 3> sum{}, exposure{1, 1, 1};
  double pixels = 0;
  for (std::size_t i = 0; i < tile.count(); ++i) {
    if (seen[i] == 0) continue;
    ++pixels;
    for (std::size_t k = 0; k < 3; ++k) sum[k] += static_cast<double>(logs[3 * i + k]);
  }
  for (std::size_t k = 0; k < 3 && pixels > 0; ++k) exposure[k] = std::exp(-sum[k] / pixels);
  return exposure;
}

}  // namespace hybrid::stages
