#include "batch/export/export_points.hpp"

#include <cmath>

#include "geometry/colour.hpp"

namespace hybrid::batch {
namespace {

// Collects one scan's samples.
class Collector {
 public:
  Collector(const ScanProduct& product, const Pose& world_from_scan, const ScanRemains& remains,
            const NodeColours* colours, ExportPoints& to)
      : product_(product), pose_(world_from_scan), remains_(remains), colours_(colours), to_(to) {}

  void go() {
    const RangeImage& image = product_.image;
    for (std::size_t i = 0; i < image.count(); ++i) {
      if (product_.decimation.fate[i] <= stages::kDiscarded) continue;
      if (product_.stray[i]) {
        ++to_.stray;
        continue;
      }
      // A georeferenced scan's image is too coarse for its coordinates.
      const Vec3 point =
          remains_.georeferenced ? remains_.georeferenced->point(image.source[i]) : image.point(i);
      add(point, image.intensity.empty() ? 0 : image.intensity[i],
          image.rgb.empty() ? nullptr : &image.rgb[i],
          colours_ && colours_->coverage[i] > 0 ? std::optional(colours_->toned(i)) : std::nullopt,
          product_.drawn[i] == stages::kDrawn);
    }
    // Nothing tells what hides samples beside the grid from a photograph.
    for (const io::PlyPoint& point : kept_extra(product_, remains_))
      add({point.position[0], point.position[1], point.position[2]}, point.intensity,
          remains_.colour ? &point.rgb : nullptr, std::nullopt, false);
  }

 private:
  void add(const Vec3& point, float intensity, const std::array<std::uint8_t, 3>* own,
           const std::optional<std::array<float, 3>>& light, bool drawn) {
    std::array<std::uint8_t, 3> rgb{255, 0, 0};
    if (light)
      for (std::size_t k = 0; k < 3; ++k) rgb[k] = srgb_byte_from_linear(static_cast<double>((*light)[k]));
    else if (own)
      rgb = *own;
    else if (colours_)
      ++to_.uncoloured;
    else
      rgb = {180, 180, 180};
    to_.position.push_back(pose_ * point);
    to_.rgb.push_back(rgb);
    to_.intensity.push_back(intensity);
    to_.drawn.push_back(drawn);
  }

  const ScanProduct& product_;
  const Pose& pose_;
  const ScanRemains& remains_;
  const NodeColours* colours_;
  ExportPoints& to_;
};

}  // namespace

ExportPoints collect_points(stages::Renderer& renderer, bool photographs,
                            const std::vector<ScanProduct>& products,
                            const std::vector<std::optional<ScanRegistration>>& registrations,
                            const std::vector<ScanRemains>& remains, int tile) {
  ExportPoints points;
  bool intensity = true;
  for (std::size_t i = 0; i < products.size(); ++i) {
    if (!registrations[i]) continue;
    const Pose& pose = registrations[i]->world_from_scan();
    std::optional<NodeColours> colours;
    if (photographs)
      colours = renderer.colour_range_image(products[i].image, products[i].segmentation, pose, tile);
    Collector(products[i], pose, remains[i], colours ? &*colours : nullptr, points).go();
    intensity &= remains[i].intensity;
  }
  if (!intensity) points.intensity.clear();
  return points;
}

Scan cloud_of(const ExportPoints& points, const io::SceneFile& scene) {
  Scan cloud;
  cloud.name = scene.name;
  cloud.crs = scene.crs;
  cloud.rgb = points.rgb;
  cloud.intensity = points.intensity;
  Eigen::AlignedBox3d box;
  for (const Vec3& position : points.position) box.extend(position + scene.shift);
  if (!box.isEmpty() && box.center().norm() > kFarFromOrigin_m) cloud.origin = box.center().array().round();
  for (const Vec3& position : points.position) {
    const Vec3f point = (position + scene.shift - cloud.origin).cast<float>();
    cloud.points.push_back({point.x(), point.y(), point.z()});
  }
  return cloud;
}

void set_registered_pose(Scan& scan, const Pose& world_from_scan, const io::SceneFile& scene) {
  Pose pose = world_from_scan;
  pose.translation += scene.shift;
  if (pose.scale != 1) {
    scan.origin *= pose.scale;
    for (auto& point : scan.points)
      for (float& value : point) value = static_cast<float>(pose.scale * static_cast<double>(value));
    pose.scale = 1;
  }
  scan.world_from_scan = pose;
  scan.crs = scene.crs;
  scan.crs_records.clear();
}

}  // namespace hybrid::batch
