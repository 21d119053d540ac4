#include "stages/rendering/unseen_polygon.hpp"

#include <algorithm>

namespace hybrid::stages {
namespace {

constexpr double kPlaces_m = 0.03;                        // of the places that are asked about
constexpr int kMostSteps = 16;                            // across a polygon
constexpr double kMostEmpty = 0.1, kLeastUnknown = 0.25;  // of them
constexpr double kSamePlane_m = 0.05;

}  // namespace

bool may_be_there(const ScanSight& sight, const FlatPolygon& polygon,
                  const std::vector<FlatPolygon>& others) {
  const auto places = polygon.places(kPlaces_m, kMostSteps);
  std::size_t empty = 0, unknown = 0;
  SightWalk walk(sight);
  for (const Vec3& place : places) {
    const auto known = walk.known(place);
    empty += known == ScanSight::Known::empty;
    unknown += known == ScanSight::Known::no &&
               std::none_of(others.begin(), others.end(),
                            [&](const FlatPolygon& other) { return other.covers(place, kSamePlane_m); });
  }
  const auto all = static_cast<double>(places.size());
  return !places.empty() && static_cast<double>(empty) <= kMostEmpty * all &&
         static_cast<double>(unknown) >= kLeastUnknown * all;
}

}  // namespace hybrid::stages
