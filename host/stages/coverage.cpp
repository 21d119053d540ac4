#include "stages/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "geometry/face_frame.hpp"
#include "stages/free_space.hpp"

namespace hybrid::stages {
namespace {

constexpr double kClearance_m = 0.3;  // around a suggested camera

constexpr double kMostTexels = 1e6, kFinest_m = 0.02;
constexpr std::size_t kMostTargets = 8192;  // unseen texels that candidates are asked of
constexpr std::size_t kMostPlaces = 24;     // groups of unseen texels that candidates stand before
constexpr double kSlantedCosine = 0.26;     // 75 degrees
constexpr double kLeastGain_m2 = 0.1, kLeastGainShare = 0.005;

struct Texel {
  SurfacePoint point;
  std::size_t face;
  double area_m2;
};

std::vector<Texel> sample_faces(const PolygonModel& model, double texel_m) {
  std::vector<Texel> texels;
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const FaceFrame frame = face_frame(model, model.faces[f]);
    const auto rings = flat_rings(frame, model, model.faces[f]);
    const std::size_t first = texels.size();
    for (double v = texel_m / 2; v < frame.size.y(); v += texel_m)
      for (double u = texel_m / 2; u < frame.size.x(); u += texel_m)
        if (on_face(rings, {u, v})) texels.push_back({{frame.world({u, v}), frame.plane.normal}, f, 0});
    if (texels.size() == first)  // smaller than a texel
      texels.push_back({{frame.world(0.5 * frame.size), frame.plane.normal}, f, 0});
    const double area = face_area_m2(model, model.faces[f]) / static_cast<double>(texels.size() - first);
    for (std::size_t i = first; i < texels.size(); ++i) texels[i].area_m2 = area;
  }
  return texels;
}

std::vector<SurfacePoint> points_of(const std::vector<Texel>& texels) {
  std::vector<SurfacePoint> points;
  for (const Texel& texel : texels) points.push_back(texel.point);
  return points;
}

// At most kMostTargets of them, evenly, each standing for the area of those left out.
std::vector<Texel> thinned(const std::vector<Texel>& unseen) {
  const std::size_t step = (unseen.size() + kMostTargets - 1) / kMostTargets;
  std::vector<Texel> targets;
  for (std::size_t i = 0; i < unseen.size(); i += std::max<std::size_t>(1, step)) {
    targets.push_back(unseen[i]);
    for (std::size_t k = i + 1; k < std::min(unseen.size(), i + step); ++k)
      targets.back().area_m2 += unseen[k].area_m2;
  }
  return targets;
}

// Groups of one face within a cell of the given side, the largest first.
struct Place {
  Vec3 centre = Vec3::Zero(), normal = Vec3::UnitZ();
  double area_m2 = 0;
};
std::vector<Place> places_of(const std::vector<Texel>& targets, double cell_m) {
  std::map<std::tuple<std::size_t, int, int, int>, Place> groups;
  for (const Texel& t : targets) {
    const Vec3 cell = t.point.position / cell_m;
    Place& place = groups[{t.face, static_cast<int>(std::floor(cell.x())),
                           static_cast<int>(std::floor(cell.y())), static_cast<int>(std::floor(cell.z()))}];
    place.centre += t.area_m2 * t.point.position;
    place.normal = t.point.normal;
    place.area_m2 += t.area_m2;
  }
  std::vector<Place> places;
  for (auto& [key, place] : groups) {
    place.centre /= place.area_m2;
    places.push_back(place);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.area_m2 > b.area_m2; });
  places.resize(std::min(places.size(), kMostPlaces));
  return places;
}

// The photograph whose kind of camera most of the scene's have.
const Photograph& typical_photograph(const std::vector<Photograph>& photographs) {
  const auto same = [](const Photograph& a, const Photograph& b) {
    return a.camera.width == b.camera.width && a.camera.height == b.camera.height &&
           std::abs(a.camera.fx / b.camera.fx - 1) < 0.05;
  };
  std::size_t best = 0;
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const auto count = std::count_if(photographs.begin(), photographs.end(),
                                     [&](const Photograph& other) { return same(other, photographs[i]); });
    if (count > most) {
      most = count;
      best = i;
    }
  }
  return photographs[best];
}

Photograph aimed(const Photograph& like, const Vec3& eye, const Vec3& target) {
  const Vec3 up = std::abs((target - eye).normalized().z()) > 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
  Photograph camera = look_at(eye, target, up, 60, like.camera.width, like.camera.height);
  camera.camera = like.camera;
  return camera;
}

std::vector<Photograph> candidates_before(const std::vector<Place>& places, const Photograph& like,
                                          double cell_m) {
  std::vector<Photograph> cameras;
  const double tilt = 35 * M_PI / 180;
  for (const Place& place : places) {
    const Vec3 u = place.normal.unitOrthogonal(), v = place.normal.cross(u);
    for (const double distance_m : {1.5 * cell_m, 3 * cell_m})
      for (int k = 0; k < 5; ++k) {
        const Vec3 side = k == 0 ? Vec3(Vec3::Zero()) : Vec3(k < 3 ? (k == 1 ? u : -u) : (k == 3 ? v : -v));
        const Vec3 away =
            (k == 0 ? place.normal : std::cos(tilt) * place.normal + std::sin(tilt) * side).normalized();
        cameras.push_back(aimed(like, place.centre + distance_m * away, place.centre));
      }
  }
  return cameras;
}

std::vector<Photograph> free_ones(Renderer& renderer, const RenderScene& scene,
                                  const std::vector<Photograph>& candidates) {
  std::vector<Vec3> places;
  for (const Photograph& camera : candidates) places.push_back(camera.centre());
  const auto free = in_free_space(renderer, scene, places, kClearance_m);
  std::vector<Photograph> cameras;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (free[i]) cameras.push_back(candidates[i]);
  return cameras;
}

std::vector<NextCamera> choose(const std::vector<Photograph>& cameras, const std::vector<Texel>& targets,
                               const std::vector<std::vector<std::uint32_t>>& seen, int wanted) {
  double total = 0;
  for (const Texel& t : targets) total += t.area_m2;
  std::vector<double> left(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) left[i] = targets[i].area_m2;
  std::vector<NextCamera> chosen;
  while (static_cast<int>(chosen.size()) < wanted) {
    std::size_t best = cameras.size();
    double most = std::max(kLeastGain_m2, kLeastGainShare * total);
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      double gain = 0;
      for (const std::uint32_t i : seen[c]) gain += left[i];
      if (gain > most * (1 + 1e-9)) {
        most = gain;
        best = c;
      }
    }
    if (best == cameras.size()) break;
    const Pose world_from_cam = cameras[best].cam_from_world.inverse();
    chosen.push_back({world_from_cam.translation, world_from_cam.rotate(Vec3::UnitZ()), most});
    for (const std::uint32_t i : seen[best]) left[i] = 0;
  }
  return chosen;
}

void suggest_cameras(Renderer& renderer, const RenderScene& scene, const std::vector<Texel>& unseen,
                     int wanted, Coverage& coverage) {
  const Photograph& like = typical_photograph(scene.photographs);
  coverage.next_camera = like.name;
  const auto targets = thinned(unseen);
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : scene.proxy.vertices) box.extend(vertex);
  const double cell_m = std::max(0.5, box.diagonal().norm() / 16);
  const auto cameras =
      free_ones(renderer, scene, candidates_before(places_of(targets, cell_m), like, cell_m));
  auto seen = renderer.seen_from(cameras, points_of(targets));
  for (std::size_t c = 0; c < cameras.size(); ++c)
    std::erase_if(seen[c], [&](std::uint32_t i) {
      const SurfacePoint& p = targets[i].point;
      return p.normal.dot((cameras[c].centre() - p.position).normalized()) < kSlantedCosine;
    });
  coverage.next = choose(cameras, targets, seen, wanted);
}

}  // namespace

const std::vector<OptionRow<CoverageOptions>>& coverage_option_table() {
  using O = CoverageOptions;
  static const std::vector<OptionRow<O>> table = {
      {"coverage_texel_m", "m", &O::coverage_texel_m, 0, 100,
       "what photographs see of the faces is sampled at this distance; 0: a million places"},
      {"next_cameras", "", &O::next_cameras, 0, 100, "positions suggested for more photographs"},
  };
  return table;
}

Coverage measure_coverage(Renderer& renderer, const RenderScene& scene, const CoverageOptions& options) {
  Coverage coverage;
  double area = 0;
  for (const Face& face : scene.proxy.faces) area += face_area_m2(scene.proxy, face);
  coverage.texel_m = options.coverage_texel_m > 0
                         ? std::max(options.coverage_texel_m, std::sqrt(area / (16 * kMostTexels)))
                         : std::max(kFinest_m, std::sqrt(area / kMostTexels));
  const auto texels = sample_faces(scene.proxy, coverage.texel_m);
  const auto seen = renderer.count_seen(points_of(texels));
  coverage.faces.resize(scene.proxy.faces.size());
  std::vector<Texel> unseen;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    FaceCoverage& face = coverage.faces[texels[i].face];
    face.face = texels[i].face;
    face.area_m2 += texels[i].area_m2;
    if (seen[i] > 0) continue;
    face.unseen_m2 += texels[i].area_m2;
    unseen.push_back(texels[i]);
  }
  for (const FaceCoverage& face : coverage.faces) {
    coverage.area_m2 += face.area_m2;
    coverage.unseen_m2 += face.unseen_m2;
  }
  if (options.next_cameras > 0 && !unseen.empty() && !scene.photographs.empty())
    suggest_cameras(renderer, scene, unseen, options.next_cameras, coverage);
  return coverage;
}

}  // namespace hybrid::stages
