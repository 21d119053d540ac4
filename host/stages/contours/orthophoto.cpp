#include "stages/contours/orthophoto.hpp"

#include <algorithm>
#include <cmath>

#include "stages/contours/class_picture.hpp"

namespace hybrid::stages {
namespace {

constexpr std::uint8_t kNothingThere = 40;
// Right and up as someone sees them who stands before a wall; on floors and ceilings up is Y.
void set_axes(const Vec3& normal, Orthophoto& photo) {
  const Vec3 above = std::abs(normal.z()) > 0.95 ? Vec3::UnitY() : Vec3::UnitZ();
  photo.right = above.cross(normal).normalized();
  photo.up = normal.cross(photo.right);
}

// Extent of the contours along an axis.
std::array<double, 2> extent(const Supercluster& plane, const Vec3& axis) {
  std::array<double, 2> range = {INFINITY, -INFINITY};
  for (const ContourRing& ring : plane.contours)
    for (const Vec3& point : ring.points) {
      range[0] = std::min(range[0], axis.dot(point));
      range[1] = std::max(range[1], axis.dot(point));
    }
  return range;
}

}  // namespace

SampleLook::SampleLook(const RangeImage& image) : image_(image), lookup_(image) {
  std::vector<float> values;
  for (std::size_t i = 0; i < image.intensity.size(); i += 1 + image.intensity.size() / kManySamples)
    if (image.mask[i] == kMeasured && std::isfinite(image.intensity[i])) values.push_back(image.intensity[i]);
  if (values.empty()) return;
  const auto percentile = [&](std::size_t percent) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * percent / 100);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  darkest_ = percentile(1);
  brightest_ = std::max(percentile(99), std::nextafter(darkest_, INFINITY));
  shoulder_ = Shoulder((percentile(100) - darkest_) / (brightest_ - darkest_));
}

std::array<std::uint8_t, 3> SampleLook::operator()(std::size_t node, const Supercluster& plane) const {
  if (!image_.rgb.empty()) return image_.rgb[node];
  double level = 0;
  if (!image_.intensity.empty())
    level = shoulder_.level((image_.intensity[node] - darkest_) / (brightest_ - darkest_));
  else if (plane.rms_m > 0)
    level = 0.5 + plane.plane.distance(image_.point(node)) / (6 * plane.rms_m);
  // Never as dark as where nothing is.
  const auto grey =
      static_cast<std::uint8_t>(std::lround(70 + 185 * (level > 0 ? std::min(level, 1.0) : 0.0)));
  return {grey, grey, grey};
}

std::optional<Orthophoto> make_orthophoto(const RangeImage& image, const PlaneSegmentation& segmentation,
                                          const Supercluster& plane, const SampleLook& look,
                                          int most_pixels) {
  if (plane.contours.empty() || plane.samples < 1 || image.count() == 0) return std::nullopt;
  Orthophoto photo;
  set_axes(plane.plane.normal, photo);
  const auto across = extent(plane, photo.right), along = extent(plane, photo.up);
  const double width = across[1] - across[0], height = along[1] - along[0];
  if (!(width > 0) || !(height > 0) || !std::isfinite(width + height) || !(plane.area_m2 > 0))
    return std::nullopt;
  constexpr int kBorder = 4;
  photo.pixel_m = std::max(std::sqrt(plane.area_m2 / static_cast<double>(plane.samples)),
                           std::max(width, height) / (most_pixels - 2 * kBorder - 1));
  photo.origin = plane.plane.offset_m * plane.plane.normal +
                 (across[0] - kBorder * photo.pixel_m) * photo.right +
                 (along[1] + kBorder * photo.pixel_m) * photo.up;
  photo.picture =
      Image8(static_cast<int>(std::ceil(width / photo.pixel_m)) + 2 * kBorder + 1,
             static_cast<int>(std::ceil(height / photo.pixel_m)) + 2 * kBorder + 1, 3, kNothingThere);
  for (int y = 0; y < photo.picture.height; ++y) {
    NodeWalk walk(look.lookup());
    for (int x = 0; x < photo.picture.width; ++x) {
      const Vec3 point = photo.origin + photo.pixel_m * (x * photo.right - y * photo.up);
      const auto [row, col, within] = walk.towards(point);
      if (!within) continue;
      const std::size_t node = image.index(row, col);
      if (segmentation.sample_label[node] != plane.id || image.mask[node] == kEmpty) continue;
      const auto colour = look(node, plane);
      std::copy(colour.begin(), colour.end(), photo.picture.at(x, y));
    }
  }
  return photo;
}

}  // namespace hybrid::stages
