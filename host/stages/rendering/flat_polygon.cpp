#include "stages/rendering/flat_polygon.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

constexpr double kLevelNormal = 0.9;  // of the normal's height: within 26 degrees

}  // namespace

SpacePolygon polygon_of(const PolygonModel& model, const Face& face) {
  const auto ring = [&](const std::vector<std::uint32_t>& vertices) {
    std::vector<Vec3> points;
    for (const std::uint32_t vertex : vertices) points.push_back(model.vertices[vertex]);
    return points;
  };
  SpacePolygon polygon{ring(face.outer), {}};
  for (const auto& hole : face.holes) polygon.holes.push_back(ring(hole));
  return polygon;
}

PolygonModel model_of(const SpacePolygon& polygon) {
  PolygonModel model;
  const auto add = [&](const std::vector<Vec3>& ring) {
    std::vector<std::uint32_t> vertices;
    for (const Vec3& point : ring) {
      vertices.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.push_back(point);
    }
    return vertices;
  };
  model.faces = {{"", add(polygon.outer), {}}};
  for (const auto& hole : polygon.holes) model.faces[0].holes.push_back(add(hole));
  return model;
}

PolygonBox::PolygonBox(const SpacePolygon& polygon) : low(polygon.outer[0]), high(low) {
  for (const Vec3& point : polygon.outer) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
}

bool PolygonBox::is_near(const PolygonBox& other, double distance_m) const {
  return (low.array() <= other.high.array() + distance_m).all() &&
         (other.low.array() <= high.array() + distance_m).all();
}

FlatPolygon::FlatPolygon(const SpacePolygon& polygon) : origin_(polygon.outer[0]) {
  find_axes(polygon.outer);
  flatten(polygon);
}

FlatPolygon::FlatPolygon(const SpacePolygon& polygon, const Vec3& second) : origin_(polygon.outer[0]) {
  find_axes(polygon.outer);
  v_ = (second - second.dot(normal_) * normal_).normalized();
  u_ = v_.cross(normal_);
  flatten(polygon);
}

void FlatPolygon::flatten(const SpacePolygon& polygon) {
  for (const Vec3& point : polygon.outer) outer_.push_back(flat(point));
  for (const auto& hole : polygon.holes) {
    holes_.emplace_back();
    for (const Vec3& point : hole) holes_.back().push_back(flat(point));
  }
  low_ = high_ = outer_[0];
  for (const Vec2& point : outer_) {
    low_ = low_.cwiseMin(point);
    high_ = high_.cwiseMax(point);
  }
}

void FlatPolygon::find_axes(const std::vector<Vec3>& ring) {
  Vec3 longest = Vec3::Zero();
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec3& next = ring[(k + 1) % ring.size()];
    normal_ += (ring[k] - origin_).cross(Vec3(next - origin_));
    if ((next - ring[k]).squaredNorm() > longest.squaredNorm()) longest = next - ring[k];
  }
  normal_.normalize();
  is_level_ = std::abs(normal_.z()) > kLevelNormal;
  const Vec3 along = is_level_ ? longest : Vec3(Vec3::UnitZ().cross(normal_));
  u_ = (along - along.dot(normal_) * normal_).normalized();
  v_ = normal_.cross(u_);
}

bool FlatPolygon::holds(const Vec2& at) const {
  return inside(outer_, at) &&
         std::none_of(holes_.begin(), holes_.end(), [&](const Ring2& hole) { return inside(hole, at); });
}

bool FlatPolygon::covers(const Vec3& place, double tolerance_m) const {
  return std::abs(normal_.dot(place - origin_)) <= tolerance_m && holds(flat(place));
}

std::vector<Vec3> FlatPolygon::places(double step_m, int most_steps) const {
  const double step = std::max(step_m, (high_ - low_).maxCoeff() / most_steps);
  std::vector<Vec3> found;
  for (double y = low_.y() + step / 2; y < high_.y(); y += step)
    for (double x = low_.x() + step / 2; x < high_.x(); x += step)
      if (holds({x, y})) found.push_back(lifted({x, y}));
  return found;
}

std::vector<std::pair<double, double>> FlatPolygon::spans(double y) const {
  std::vector<double> crossings;
  const auto cross = [&](const Ring2& ring) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a.y() > y) != (b.y() > y))
        crossings.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
    }
  };
  cross(outer_);
  std::for_each(holes_.begin(), holes_.end(), cross);
  std::sort(crossings.begin(), crossings.end());
  std::vector<std::pair<double, double>> spans;
  for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
    spans.emplace_back(crossings[k], crossings[k + 1]);
  return spans;
}

}  // namespace hybrid::stages
