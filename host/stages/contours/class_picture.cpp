#include "stages/contours/class_picture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/scan/node_lookup.hpp"

namespace hybrid::stages {
namespace {

constexpr double kCylinderSigmas = 3.5;  // of its scatter: samples shown as a cylinder's

using Colour = std::array<std::uint8_t, 3>;

// Golden-ratio steps in hue keep successive ids apart; three levels of paleness tell those that come round
// again.
Colour pastel(std::uint32_t id) {
  const double hue = std::fmod(static_cast<double>(id) * 0.6180339887498949, 1.0) * 6;
  const double saturation = 0.30 + 0.12 * (id / 5 % 3), value = 0.98 - 0.10 * (id / 3 % 3);
  Colour colour;
  const double phase[3] = {5, 3, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = std::fmod(phase[k] + hue, 6.0);
    const double chroma = std::clamp(std::min(x, 4 - x), 0.0, 1.0);
    colour[k] = static_cast<std::uint8_t>(std::lround(255 * value * (1 - saturation * chroma)));
  }
  return colour;
}

Colour class_colour(std::uint8_t square_class) {
  switch (square_class) {
    case kUndersampled:
      return {0, 0, 0};
    case kPlanarTooSmall:
      return {20, 30, 110};
    default:
      return {15, 75, 30};
  }
}

// A monotone function of a positive float whose values are bytes: from a table by the float's upper bits,
// where it does not change between the floats that share them.
class MonotoneBytes {
 public:
  template <typename Function>
  explicit MonotoneBytes(const Function& function) : first_(kEntries), last_(kEntries) {
    parallel_for(
        kEntries,
        [&](std::size_t k) {
          const auto bits = static_cast<std::uint32_t>(k << kShift);
          first_[k] = k == 0 ? function(std::numeric_limits<float>::denorm_min())
                             : function(std::bit_cast<float>(bits));
          last_[k] = function(std::bit_cast<float>(bits | ((1u << kShift) - 1)));
        },
        1 << 10);
  }

  template <typename Function>
  std::uint8_t at(float value, const Function& function) const {
    const std::size_t k = std::bit_cast<std::uint32_t>(value) >> kShift;
    return first_[k] == last_[k] ? first_[k] : function(value);
  }

 private:
  static constexpr unsigned kShift = 12;
  static constexpr std::size_t kEntries = 0x7f800000u >> kShift;  // below infinity

  std::vector<std::uint8_t> first_, last_;
};

// Rows, and columns on from one that may lie beyond the last, that hold what a scanner sees of a cylinder.
struct Window {
  int top, bottom, left, columns;
};

Window window_of(const RangeImage& image, const NodeLookup& lookup, const Cylinder& cylinder) {
  const Vec3 a = cylinder.axis.unitOrthogonal(), b = cylinder.axis.cross(a);
  const int first = lookup.towards(cylinder.foot + 0.5 * cylinder.length_m * cylinder.axis).col;
  int top = image.rows - 1, bottom = 0, left = 0, right = 0;
  for (int k = 0; k <= 32; ++k)
    for (int side = 0; side < 16; ++side) {
      const double along = cylinder.length_m * k / 32, turn = side * 3.14159265358979 / 8;
      const auto node =
          lookup.towards(cylinder.foot + along * cylinder.axis +
                         1.1 * cylinder.radius_at(along) * (std::cos(turn) * a + std::sin(turn) * b));
      int off = node.col - first;
      if (image.wraps && 2 * std::abs(off) > image.cols) off -= off > 0 ? image.cols : -image.cols;
      top = std::min(top, node.row);
      bottom = std::max(bottom, node.row);
      left = std::min(left, off);
      right = std::max(right, off);
    }
  // About the scanner's own axis the nodes beside it are not beside each other.
  if (2 * (right - left) > image.cols) return {top, bottom, 0, image.cols};
  return {std::max(top - 1, 0), std::min(bottom + 1, image.rows - 1), first + left - 1,
          std::min(right - left + 3, image.cols)};
}

void colour_cylinders(const RangeImage& image, const PlaneSegmentation& segmentation, Image8& picture) {
  if (segmentation.cylinders.empty()) return;
  constexpr Colour orange = {235, 130, 30}, brown = {150, 95, 40};
  const NodeLookup lookup(image);
  for (const Cylinder& cylinder : segmentation.cylinders) {
    const Window window = window_of(image, lookup, cylinder);
    const Colour& colour = cylinder.inside ? brown : orange;
    parallel_for(static_cast<std::size_t>(std::max(window.bottom + 1 - window.top, 0)), [&](std::size_t r) {
      const int row = window.top + static_cast<int>(r);
      for (int k = 0; k < window.columns; ++k) {
        const int col = image.wrapped(window.left + k);
        if (col < 0 || col >= image.cols) continue;
        const std::size_t i = image.index(row, col);
        if (image.mask[i] == kEmpty || segmentation.sample_label[i] != 0) continue;
        const Vec3 point = image.point(i);
        const double along = cylinder.along(point);
        if (along >= 0 && along <= cylinder.length_m &&
            std::abs(cylinder.distance(point)) <= kCylinderSigmas * cylinder.rms_m)
          std::copy(colour.begin(), colour.end(), picture.at(col, row));
      }
    });
  }
}

// Black, with a byte to spare for each row: io::write_png filters large pictures in place then.
Image8 black_picture(const RangeImage& image, int channels) {
  Image8 picture;
  picture.width = image.cols;
  picture.height = image.rows;
  picture.channels = channels;
  const std::size_t count = image.count() * static_cast<std::size_t>(channels);
  picture.pixels.reserve(count + static_cast<std::size_t>(image.rows));
  picture.pixels.resize(count);
  return picture;
}

}  // namespace

Image8 class_picture(const RangeImage& image, const PlaneSegmentation& segmentation) {
  if (segmentation.sample_label.size() != image.count())
    fail(ErrorKind::failed, "class_picture: {} sample labels for an image of {} samples",
         segmentation.sample_label.size(), image.count());
  Image8 picture = black_picture(image, 3);
  const auto& labels = segmentation.sample_label;
  std::vector<Colour> pastels(
      labels.empty() ? 1 : *std::max_element(labels.begin(), labels.end()) + std::size_t{1});
  for (std::size_t id = 1; id < pastels.size(); ++id) pastels[id] = pastel(static_cast<std::uint32_t>(id));
  parallel_for(static_cast<std::size_t>(image.rows), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] == kEmpty) continue;
      const std::size_t square = static_cast<std::size_t>(row / segmentation.square) *
                                     static_cast<std::size_t>(segmentation.square_cols) +
                                 static_cast<std::size_t>(col / segmentation.square);
      const std::uint32_t label = segmentation.sample_label[i];
      const Colour colour = label != 0 ? pastels[label] : class_colour(segmentation.square_class[square]);
      std::copy(colour.begin(), colour.end(), picture.at(col, row));
    }
  });
  colour_cylinders(image, segmentation, picture);
  return picture;
}

void draw_intersections(const RangeImage& image, const std::vector<Intersection>& intersections,
                        Image8& picture) {
  if (image.count() == 0) return;
  const NodeLookup lookup(image);
  for (const Intersection& segment : intersections) {
    const Colour colour = segment.angle_deg < 180 ? Colour{200, 0, 0} : Colour{0, 0, 200};
    // Halved until the ends of a piece are neighbours.
    std::vector<std::array<double, 2>> pieces = {{0, 1}};
    const auto at = [&](double t) { return lookup.towards(segment.from + t * (segment.to - segment.from)); };
    while (!pieces.empty()) {
      const auto [from, to] = pieces.back();
      pieces.pop_back();
      const auto a = at(from), b = at(to);
      std::copy(colour.begin(), colour.end(), picture.at(a.col, a.row));
      std::copy(colour.begin(), colour.end(), picture.at(b.col, b.row));
      int cols = std::abs(a.col - b.col);
      if (image.wraps) cols = std::min(cols, image.cols - cols);
      if (std::max(std::abs(a.row - b.row), cols) <= 1 || to - from < 1e-6) continue;
      pieces.push_back({(from + to) / 2, to});
      pieces.push_back({from, (from + to) / 2});
    }
  }
}

Image8 range_picture(const RangeImage& image) {
  Image8 picture = black_picture(image, 1);
  std::vector<float> ranges;
  for (std::size_t i = 0; i < image.count(); i += 1 + image.count() / kManySamples)
    if (const float range = image.range_m[i]; range > 0 && std::isfinite(range)) ranges.push_back(range);
  if (ranges.empty()) return picture;
  const auto percentile = [&](std::size_t percent) {
    const auto at = ranges.begin() + static_cast<std::ptrdiff_t>((ranges.size() - 1) * percent / 100);
    std::nth_element(ranges.begin(), at, ranges.end());
    return std::log(static_cast<double>(*at));
  };
  const double near = percentile(1), far = std::max(percentile(99), near + 1e-6);
  const auto grey = [&](float range) {
    const double depth = std::clamp((std::log(static_cast<double>(range)) - near) / (far - near), 0.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(250 - 215 * depth));
  };
  const MonotoneBytes greys(grey);
  parallel_for(
      image.count(),
      [&](std::size_t i) {
        if (image.range_m[i] > 0 && std::isfinite(image.range_m[i]))
          picture.pixels[i] = greys.at(image.range_m[i], grey);
      },
      1 << 14);
  return picture;
}

}  // namespace hybrid::stages
