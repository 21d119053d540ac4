#include "stages/rendering/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "core/parallel.hpp"
#include "geometry/face_frame.hpp"
#include "stages/rendering/free_space.hpp"

namespace hybrid::stages {
namespace {

constexpr double kClearance_m = 0.3;  // around a suggested camera

constexpr double kMostTexels = 1e6, kFinest_m = 0.02;
constexpr std::size_t kTexelsAtATime = 1 << 18;
constexpr std::size_t kMostTargets = 8192;  // unseen texels that candidates are asked of
constexpr std::size_t kMostPlaces = 48;     // groups of unseen texels that candidates stand before
constexpr double kSlantedCosine = 0.26;     // 75 degrees
constexpr double kLeastGain_m2 = 0.1, kLeastGainShare = 0.005;
constexpr double kNear_m = 2;             // from which rooms are photographed whatever the scene's extent
constexpr double kLevel = 0.9;            // cosine to the vertical of what one can stand on
constexpr double kLeastHeight_m = 1;      // no camera lies on the ground
constexpr double kStep_m = 0.3;           // that one climbs
constexpr double kFaceSaturation_m2 = 1;  // of a face's area a shown, sqrt(1 + a / this) - 1 counts

struct Texel {
  SurfacePoint point;
  std::size_t face;
  double area_m2;
};

// The faces' fronts in a grid, face by face, row by row.
class FaceTexels {
 public:
  FaceTexels(const PolygonModel& model, double texel_m) : texel_m_(texel_m) {
    std::vector<Row> rows;
    for (std::size_t f = 0; f < model.faces.size(); ++f) {
      frames_.push_back(face_frame(model, model.faces[f]));
      rings_.push_back(flat_rings(frames_[f], model, model.faces[f]));
      for (std::size_t k = 0; k < along(frames_[f].size.y()); ++k) rows.push_back({f, middle(k), {}});
    }
    parallel_for(rows.size(), [&](std::size_t r) {
      Row& row = rows[r];
      for (std::size_t k = 0; k < along(frames_[row.face].size.x()); ++k)
        if (on_face(rings_[row.face], {middle(k), row.v})) row.u.push_back(middle(k));
    });
    for (std::size_t f = 0, r = 0; f < model.faces.size(); ++f) {
      const std::size_t before = count();
      for (; r < rows.size() && rows[r].face == f; ++r) add(std::move(rows[r]));
      if (count() == before)  // smaller than a texel
        add({f, 0.5 * frames_[f].size.y(), {0.5 * frames_[f].size.x()}});
      area_m2_.push_back(face_area_m2(model, model.faces[f]) / static_cast<double>(count() - before));
    }
  }

  std::size_t rows() const { return rows_.size(); }
  std::size_t count_in(std::size_t row) const { return rows_[row].u.size(); }
  std::size_t face(std::size_t row) const { return rows_[row].face; }
  double area_m2(std::size_t face) const { return area_m2_[face]; }  // of one of its texels

  struct Index {
    std::uint32_t row, place;  // in it
  };
  Texel at(const Index& i) const { return {point(i.row, i.place), face(i.row), area_m2_[face(i.row)]}; }
  std::vector<SurfacePoint> points(std::size_t first_row, std::size_t last_row) const {
    std::vector<SurfacePoint> points(first_[last_row] - first_[first_row]);
    parallel_for(last_row - first_row, [&](std::size_t k) {
      const std::size_t row = first_row + k;
      for (std::size_t i = 0; i < rows_[row].u.size(); ++i)
        points[first_[row] - first_[first_row] + i] = point(row, i);
    });
    return points;
  }

 private:
  struct Row {
    std::size_t face;
    double v;
    std::vector<double> u;  // on the face
  };
  std::size_t count() const { return first_.back(); }
  std::size_t along(double length_m) const {  // texels whose middles lie on it
    return static_cast<std::size_t>(std::max(0.0, std::ceil(length_m / texel_m_ - 0.5)));
  }
  double middle(std::size_t k) const { return (static_cast<double>(k) + 0.5) * texel_m_; }
  void add(Row row) {
    first_.push_back(count() + row.u.size());
    rows_.push_back(std::move(row));
  }
  SurfacePoint point(std::size_t row, std::size_t i) const {
    const FaceFrame& frame = frames_[face(row)];
    return {frame.world({rows_[row].u[i], rows_[row].v}), frame.plane.normal};
  }

  double texel_m_;
  std::vector<FaceFrame> frames_;
  std::vector<std::vector<Ring2>> rings_;
  std::vector<double> area_m2_;
  std::vector<Row> rows_;
  std::vector<std::size_t> first_ = {0};
};

std::vector<SurfacePoint> points_of(const std::vector<Texel>& texels) {
  std::vector<SurfacePoint> points;
  for (const Texel& texel : texels) points.push_back(texel.point);
  return points;
}

// At most kMostTargets of these, evenly, each standing for the area of those left out.
std::vector<Texel> thinned(const FaceTexels& texels, const std::vector<FaceTexels::Index>& unseen) {
  const std::size_t step = (unseen.size() + kMostTargets - 1) / kMostTargets;
  std::vector<Texel> targets;
  for (std::size_t i = 0; i < unseen.size(); i += std::max<std::size_t>(1, step)) {
    targets.push_back(texels.at(unseen[i]));
    for (std::size_t k = i + 1; k < std::min(unseen.size(), i + step); ++k)
      targets.back().area_m2 += texels.area_m2(texels.face(unseen[k].row));
  }
  return targets;
}

// Groups of one face within a cell of the given side: the largest first, each one's area counting as many
// times less as there are larger ones of its face, so that no face has them all.
struct Place {
  std::size_t face = 0;
  Vec3 centre = Vec3::Zero(), normal = Vec3::UnitZ();
  double area_m2 = 0, counts_m2 = 0;
};
std::vector<Place> places_of(const std::vector<Texel>& targets, double cell_m) {
  std::map<std::tuple<std::size_t, int, int, int>, Place> groups;
  for (const Texel& t : targets) {
    const Vec3 cell = t.point.position / cell_m;
    Place& place = groups[{t.face, static_cast<int>(std::floor(cell.x())),
                           static_cast<int>(std::floor(cell.y())), static_cast<int>(std::floor(cell.z()))}];
    place.face = t.face;
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
                   [](const Place& p, const Place& q) { return p.area_m2 > q.area_m2; });
  std::map<std::size_t, int> larger;
  for (Place& place : places) place.counts_m2 = place.area_m2 / ++larger[place.face];
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& p, const Place& q) { return p.counts_m2 > q.counts_m2; });
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

// What one can stand on: the model's level faces, but for those above all that a scanner or a photograph was
// above, as roofs are.
class Ground {
 public:
  explicit Ground(const RenderScene& scene) {
    const PolygonModel& model = scene.proxy;
    for (const Vec3& vertex : model.vertices) lowest_m_ = std::min(lowest_m_, vertex.z());
    for (const Face& face : model.faces)
      if (FaceFrame frame = face_frame(model, face); frame.plane.normal.z() > kLevel)
        floors_.push_back({frame, flat_rings(frame, model, face)});
    double walked_m = lowest_m_;
    for (const Vec3& scanner : scene.scanners) walked_m = std::max(walked_m, below(scanner));
    for (const Photograph& photograph : scene.photographs)
      walked_m = std::max(walked_m, below(photograph.centre()));
    highest_m_ = walked_m + kStep_m;
  }
  // Height of the highest below a point; where there is none, of the model's lowest vertex.
  double below(const Vec3& point) const {
    double height_m = lowest_m_;
    for (const Floor& floor : floors_) {
      const Vec3& n = floor.frame.plane.normal;
      const double up_m = -floor.frame.plane.distance(point) / n.z();  // along the vertical, to its plane
      const double floor_m = point.z() + up_m;
      if (up_m <= 0 && floor_m > height_m && floor_m < highest_m_ &&
          on_face(floor.rings, floor.frame.flat(Vec3(point.x(), point.y(), floor_m))))
        height_m = floor_m;
    }
    return height_m;
  }

 private:
  struct Floor {
    FaceFrame frame;
    std::vector<Ring2> rings;
  };
  std::vector<Floor> floors_;
  double lowest_m_ = std::numeric_limits<double>::infinity(),
         highest_m_ = std::numeric_limits<double>::infinity();
};

// Directions from a place to those who look at it: from before it and to the sides; to floors and ceilings,
// before which is above or below, from all around.
std::vector<Vec3> ways_from(const Place& place) {
  const bool level = std::abs(place.normal.z()) > kLevel;
  const double tilt = (level ? 55 : 35) * M_PI / 180;
  const Vec3 u = level ? Vec3(Vec3::UnitX()) : place.normal.unitOrthogonal(), v = place.normal.cross(u);
  const int sides = level ? 6 : 4;
  std::vector<Vec3> ways = {place.normal};
  for (int k = 0; k < sides; ++k) {
    const double turn = 2 * M_PI * k / sides;
    const Vec3 side = std::cos(turn) * u + std::sin(turn) * v;
    ways.push_back((std::cos(tilt) * place.normal + std::sin(tilt) * side).normalized());
  }
  return ways;
}

std::vector<Photograph> candidates_before(const std::vector<Place>& places, const Photograph& like,
                                          const Ground& ground, double cell_m, double most_height_m) {
  std::vector<Photograph> cameras;
  for (const Place& place : places)
    for (const double distance_m : {kNear_m, 2 * kNear_m, 1.5 * cell_m, 3 * cell_m})
      for (const Vec3& way : ways_from(place)) {
        Vec3 eye = place.centre + distance_m * way;
        const double ground_m = ground.below(eye);
        eye.z() =
            std::clamp(eye.z(), ground_m + std::min(kLeastHeight_m, most_height_m), ground_m + most_height_m);
        cameras.push_back(aimed(like, eye, place.centre));
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

// What a choice of cameras shows so far.
class Shown {
 public:
  // `saturates`: of a face counts the less the more of it is shown; else all area alike.
  Shown(const std::vector<Texel>& targets, bool saturates)
      : targets_(targets), saturates_(saturates), shown_(targets.size(), 0) {}

  struct Gain {
    double area_m2 = 0, value = 0;
  };
  Gain gain(const std::vector<std::uint32_t>& seen) const {
    Gain gain;
    std::map<std::size_t, double> faces;
    for (const std::uint32_t i : seen)
      if (!shown_[i]) faces[targets_[i].face] += targets_[i].area_m2;
    for (const auto& [face, area_m2] : faces) {
      const auto before = face_m2_.find(face);
      const double had_m2 = before == face_m2_.end() ? 0 : before->second;
      gain.area_m2 += area_m2;
      gain.value += saturates_ ? worth(had_m2 + area_m2) - worth(had_m2) : area_m2;
    }
    return gain;
  }
  void add(const std::vector<std::uint32_t>& seen) {
    for (const std::uint32_t i : seen) {
      if (!shown_[i]) face_m2_[targets_[i].face] += targets_[i].area_m2;
      shown_[i] = 1;
    }
  }

 private:
  static double worth(double area_m2) { return std::sqrt(1 + area_m2 / kFaceSaturation_m2) - 1; }

  const std::vector<Texel>& targets_;
  bool saturates_;
  std::vector<std::uint8_t> shown_;
  std::map<std::size_t, double> face_m2_;
};

// Of the cameras, given by index, at most `wanted` one by one, each adding the most to those before it.
std::vector<std::pair<std::size_t, double>> choose(const std::vector<std::size_t>& cameras,
                                                   const std::vector<Texel>& targets,
                                                   const std::vector<std::vector<std::uint32_t>>& seen,
                                                   int wanted, bool saturates) {
  double total = 0;
  for (const Texel& t : targets) total += t.area_m2;
  const double least_m2 = std::max(kLeastGain_m2, kLeastGainShare * total);
  Shown shown(targets, saturates);
  std::vector<std::pair<std::size_t, double>> chosen;  // camera and the area that it adds
  while (static_cast<int>(chosen.size()) < wanted) {
    std::pair<std::size_t, double> best{0, 0};
    double most = 0;
    for (const std::size_t c : cameras) {
      const auto gain = shown.gain(seen[c]);
      if (gain.area_m2 < least_m2 || !(gain.value > most * (1 + 1e-9))) continue;
      most = gain.value;
      best = {c, gain.area_m2};
    }
    if (most == 0) break;
    chosen.push_back(best);
    shown.add(seen[best.first]);
  }
  return chosen;
}

void suggest_cameras(Renderer& renderer, const RenderScene& scene, const std::vector<Texel>& targets,
                     const CoverageOptions& options, Coverage& coverage) {
  const Photograph& like = typical_photograph(scene.photographs);
  coverage.next_camera = like.name;
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : scene.proxy.vertices) box.extend(vertex);
  const double cell_m = std::max(0.5, box.diagonal().norm() / 16);
  const auto cameras = free_ones(renderer, scene,
                                 candidates_before(places_of(targets, cell_m), like, Ground(scene), cell_m,
                                                   options.next_camera_height_m));
  auto seen = renderer.seen_from(cameras, points_of(targets));
  for (std::size_t c = 0; c < cameras.size(); ++c)
    std::erase_if(seen[c], [&](std::uint32_t i) {
      const SurfacePoint& p = targets[i].point;
      return p.normal.dot((cameras[c].centre() - p.position).normalized()) < kSlantedCosine;
    });
  std::vector<std::size_t> all(cameras.size()), spread;
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (const auto& [camera, area_m2] : choose(all, targets, seen, options.next_cameras, true))
    spread.push_back(camera);
  for (const auto& [camera, area_m2] : choose(spread, targets, seen, options.next_cameras, false)) {
    const Pose world_from_cam = cameras[camera].cam_from_world.inverse();
    coverage.next.push_back({world_from_cam.translation, world_from_cam.rotate(Vec3::UnitZ()), area_m2});
  }
}

}  // namespace

const std::vector<OptionRow<CoverageOptions>>& coverage_option_table() {
  using O = CoverageOptions;
  static const std::vector<OptionRow<O>> table = {
      {"coverage_texel_m", "m", &O::coverage_texel_m, 0, 100,
       "what photographs see of the faces is sampled at this distance; 0: a million places"},
      {"next_cameras", "", &O::next_cameras, 0, 100, "positions suggested for more photographs"},
      {"next_camera_height_m", "m", &O::next_camera_height_m, 0.3, 1000,
       "how high above the ground they stand at most"},
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
  const FaceTexels texels(scene.proxy, coverage.texel_m);
  for (std::size_t f = 0; f < scene.proxy.faces.size(); ++f)
    coverage.faces.push_back({f, face_area_m2(scene.proxy, scene.proxy.faces[f]), 0});
  std::vector<FaceTexels::Index> unseen;
  for (std::size_t row = 0, from = 0; row < texels.rows(); from = row) {
    for (std::size_t count = 0; row < texels.rows() && count < kTexelsAtATime; ++row)
      count += texels.count_in(row);
    const auto seen = renderer.count_seen(texels.points(from, row));
    for (std::size_t r = from, i = 0; r < row; ++r)
      for (std::uint32_t place = 0; place < texels.count_in(r); ++place, ++i) {
        if (seen[i] > 0) continue;
        coverage.faces[texels.face(r)].unseen_m2 += texels.area_m2(texels.face(r));
        unseen.push_back({static_cast<std::uint32_t>(r), place});
      }
  }
  for (const FaceCoverage& face : coverage.faces) {
    coverage.area_m2 += face.area_m2;
    coverage.unseen_m2 += face.unseen_m2;
  }
  if (options.next_cameras > 0 && !unseen.empty() && !scene.photographs.empty())
    suggest_cameras(renderer, scene, thinned(texels, unseen), options, coverage);
  return coverage;
}

}  // namespace hybrid::stages
