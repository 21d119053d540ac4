#include "io/cameras/colmap_model.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "io/text/plain_text.hpp"

namespace hybrid::io {
namespace {

const std::vector<ColmapLens>& lenses() {
  using C = Camera;
  constexpr auto kFisheye = Lens::fisheye;
  static const std::vector<ColmapLens> kLenses = {
      {0, "SIMPLE_PINHOLE", {&C::fx, &C::cx, &C::cy}, true},
      {1, "PINHOLE", {&C::fx, &C::fy, &C::cx, &C::cy}},
      {2, "SIMPLE_RADIAL", {&C::fx, &C::cx, &C::cy, &C::k1}, true},
      {3, "RADIAL", {&C::fx, &C::cx, &C::cy, &C::k1, &C::k2}, true},
      {4, "OPENCV", {&C::fx, &C::fy, &C::cx, &C::cy, &C::k1, &C::k2, &C::p1, &C::p2}},
      {5,
       "OPENCV_FISHEYE",
       {&C::fx, &C::fy, &C::cx, &C::cy, &C::k1, &C::k2, &C::k3, &C::k4},
       false,
       kFisheye},
      {6,
       "FULL_OPENCV",
       {&C::fx, &C::fy, &C::cx, &C::cy, &C::k1, &C::k2, &C::p1, &C::p2, &C::k3, &C::k4, &C::k5, &C::k6}},
      {8, "SIMPLE_RADIAL_FISHEYE", {&C::fx, &C::cx, &C::cy, &C::k1}, true, kFisheye},
      {9, "RADIAL_FISHEYE", {&C::fx, &C::cx, &C::cy, &C::k1, &C::k2}, true, kFisheye},
  };
  return kLenses;
}

// COLMAP has these; no stage can project through them.
struct Unsupported {
  int id;
  std::string_view name;
};
constexpr std::array kUnsupported = {Unsupported{7, "FOV"}, Unsupported{10, "THIN_PRISM_FISHEYE"},
                                     Unsupported{11, "RAD_TAN_THIN_PRISM_FISHEYE"}};

[[noreturn]] void refuse(const std::string& place, const std::string& found, bool known) {
  std::vector<std::string_view> names;
  for (const ColmapLens& lens : lenses()) names.push_back(lens.name);
  fail_input(
      "{}: camera model: expected one of {}, found {}{}; undistort the photographs (colmap "
      "image_undistorter) "
      "or estimate one of these",
      place, fmt::join(names, ", "), found, known ? ", which is not supported" : "");
}

}  // namespace

const ColmapLens& colmap_lens(const std::string& place, std::string_view name) {
  for (const ColmapLens& lens : lenses())
    if (lens.name == name) return lens;
  refuse(place, excerpt(name),
         std::any_of(kUnsupported.begin(), kUnsupported.end(),
                     [&](const Unsupported& lens) { return lens.name == name; }));
}

const ColmapLens& colmap_lens(const std::string& place, std::int64_t id) {
  for (const ColmapLens& lens : lenses())
    if (lens.id == id) return lens;
  for (const Unsupported& lens : kUnsupported)
    if (lens.id == id) refuse(place, std::string(lens.name), true);
  refuse(place, fmt::format("number {}", id), false);
}

void ColmapCollector::add_camera(const std::string& place, std::int64_t id, const ColmapLens& lens,
                                 std::int64_t width, std::int64_t height,
                                 const std::vector<double>& parameters) {
  Camera camera;
  camera.lens = lens.lens;
  camera.width = checked_image_size(place, "width", width);
  camera.height = checked_image_size(place, "height", height);
  for (std::size_t i = 0; i < lens.parameters.size(); ++i) camera.*lens.parameters[i] = parameters.at(i);
  if (lens.one_focal_length) camera.fy = camera.fx;
  check_focal_length(place, camera);
  if (!cameras_.emplace(id, camera).second) fail_input("{}: camera id {} occurs twice", place, id);
  file_.cameras.push_back({std::to_string(id), std::string(lens.name), camera});
}

void ColmapCollector::add_image(const std::string& place, std::int64_t id, const Eigen::Quaterniond& rotation,
                                const Vec3& translation, std::int64_t camera, std::string_view name) {
  constexpr double kTolerance = 0.01;  // decimal places were cut; more is another number altogether
  if (!ids_.insert(id).second) fail_input("{}: image id {} occurs twice", place, id);
  if (!(std::abs(rotation.norm() - 1) <= kTolerance))
    fail_input("{}: QW QX QY QZ: expected a quaternion of length 1, found length {:.6g}", place,
               rotation.norm());
  const auto found = cameras_.find(camera);
  if (found == cameras_.end())
    fail_input("{}: camera id: expected one of the model's {} cameras, found {}", place, cameras_.size(),
               camera);
  if (name.empty()) fail_input("{}: expected the image's name, found none: cut short?", place);
  if (!names_.insert(std::string(name)).second)
    fail_input("{}: image name {} occurs twice", place, excerpt(name));
  file_.photographs.push_back({std::string(name), found->second, {1, rotation.normalized(), translation}});
}

}  // namespace hybrid::io
