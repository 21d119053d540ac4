#include "stages/registration/automatic_words.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace hybrid::stages {

std::string vector_in_words(const Vec3& v) {
  const Vec3 shown = (v.array().abs() < 0.005).select(0.0, v);  // no "-0.00"
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", shown.x(), shown.y(), shown.z());
}

namespace {

std::string about(const Vec3& axis) {
  const double cosine = std::cos(5 * std::numbers::pi / 180);
  if (std::abs(axis.z()) > cosine) return "the vertical";
  if (std::abs(axis.x()) > cosine) return "the x axis (upside down)";
  if (std::abs(axis.y()) > cosine) return "the y axis (upside down)";
  return "the axis " + vector_in_words(axis);
}

}  // namespace

std::string motion_in_words(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn(to.rotation * from.rotation.conjugate());
  const double degrees = turn.angle() * 180 / std::numbers::pi;
  const Vec3 moved = to.translation - from.translation;
  std::string words;
  const auto add = [&](const std::string& part) { words += (words.empty() ? "" : ", ") + part; };
  if (degrees > 1) {
    Vec3 axis = turn.axis();
    double signed_degrees = degrees;
    // About the vertical: counter-clockwise from above, but for half a turn.
    if (axis.z() < 0 && degrees < 175) signed_degrees = -degrees;
    std::string name = about(axis);
    if (name.find("upside") != std::string::npos && degrees < 135) name = name.substr(0, name.find(" ("));
    add(fmt::format("turned by {:.0f} degrees about {}", name == "the vertical" ? signed_degrees : degrees,
                    name));
  }
  if (std::abs(to.scale / from.scale - 1) > 0.005)
    add(fmt::format("{:.3f} times as large", to.scale / from.scale));
  if (moved.norm() > 0.01)
    add(fmt::format("the scanner moved by {:.2f} m to {}", moved.norm(), vector_in_words(to.translation)));
  return words.empty() ? "the same place" : words;
}

}  // namespace hybrid::stages
