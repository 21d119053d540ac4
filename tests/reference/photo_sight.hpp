#pragma once
#include <optional>

#include "cases/blend_photos_case.hpp"

namespace hybrid::testing {

// How photograph number `photo` sees point `i` of the input, in double.
struct PhotoSight {
  Vec2 pixel;
  double distance, facing;  // cosine, 1 without a normal
  double angle;             // to the ray from the eye
  double eye_distance, eye_facing;
  double feather;
};
// Nothing when it does not see the point.
std::optional<PhotoSight> photo_sight(const BlendPhotosCase::Input& input, std::size_t photo, std::size_t i);

// Light and low band of a photograph at a position: bilinear between pixel centres, the border repeated.
Vec3 photo_light(const BlendPhotosCase::Photo& photo, const Vec2& position);
Vec3 photo_low(const BlendPhotosCase::Photo& photo, const Vec2& position, std::size_t gaussian);
// Light split into mix.bands bands, the highest first; they sum to the light.
std::vector<Vec3> photo_bands(const BlendPhotosCase::Photo& photo, const Vec2& position,
                              const BlendMode& mix);

// One photograph's contribution to a point.
struct WeighedLight {
  std::int32_t photograph;
  double weight;
  Vec3 light;
  std::vector<Vec3> bands;
};
// Writes the planes of sums and the best photograph of point `i` of `count` from all contributions at
// once.
void write_sums(const std::vector<WeighedLight>& lights, const BlendMode& mix, std::size_t count,
                std::size_t i, std::vector<float>& sums, std::vector<std::int32_t>& best);

}  // namespace hybrid::testing
