#include "io/e57/e57_photographs.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.hpp"
#include "geometry/angles.hpp"
#include "io/picture.hpp"
#include "io/text/plain_text.hpp"

namespace hybrid::io {
namespace {

constexpr std::size_t kLongestPictureName = 100;
// A spherical image of 2 : 1 that claims less than this has a placeholder for its pixels' size: some
// exporters of full panoramas write one.
constexpr double kLeastPanorama_rad = 0.2;

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

// Axes of this program's camera (x right, y down, z forward) in an image's frame.
Mat3 image_from_cam(E57Projection projection) {
  Mat3 axes;
  if (projection == E57Projection::pinhole)
    axes << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  else  // forward is +x, up +z
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return axes;
}

// Why an image cannot be a photograph, or nothing.
std::string problem_of(const E57Image& image) {
  if (image.width < 1 || image.height < 1)
    return fmt::format("expected a size of at least 1 x 1 pixels, found {} x {}", image.width, image.height);
  switch (image.projection) {
    case E57Projection::visual_reference:
      return "a visual reference has no camera";
    case E57Projection::pinhole:
      if (!positive(image.focal_length_m) || !positive(image.pixel_width) || !positive(image.pixel_height))
        return fmt::format("expected a focal length and pixel sizes of more than 0 m, found {}, {} and {}",
                           image.focal_length_m, image.pixel_width, image.pixel_height);
      break;
    case E57Projection::cylindrical:
      if (!positive(image.radius_m))
        return fmt::format("expected a radius of more than 0 m, found {}", image.radius_m);
      [[fallthrough]];
    case E57Projection::spherical:
      if (!positive(image.pixel_width) || !positive(image.pixel_height))
        return fmt::format("expected pixel sizes of more than 0, found {} and {}", image.pixel_width,
                           image.pixel_height);
      if (image.width * image.pixel_width > kTurn + 1.5 * image.pixel_width)
        return fmt::format("expected at most a full turn, found {} pixels of {} rad", image.width,
                           image.pixel_width);
  }
  if (!std::isfinite(image.principal_x) || !std::isfinite(image.principal_y))
    return fmt::format("expected a finite principal point, found {}, {}", image.principal_x,
                       image.principal_y);
  return "";
}

Camera camera_of(const E57Image& image) {
  Camera camera;
  camera.width = image.width;
  camera.height = image.height;
  camera.cx = 0.5 * image.width;
  camera.cy = 0.5 * image.height;
  if (image.projection == E57Projection::pinhole) {
    camera.fx = image.focal_length_m / image.pixel_width;
    camera.fy = image.focal_length_m / image.pixel_height;
    camera.cx = image.principal_x;
    camera.cy = image.principal_y;
    return camera;
  }
  camera.lens = image.projection == E57Projection::spherical ? Lens::spherical : Lens::cylindrical;
  camera.fx = 1 / image.pixel_width;
  // A full turn is one exactly, however many digits were written: else the two sides would not meet.
  if (std::abs(kTurn * camera.fx - camera.width) < 1.5) camera.fx = camera.width / kTurn;
  if (camera.lens == Lens::cylindrical) {
    camera.fy = image.radius_m / image.pixel_height;
    camera.cy = image.principal_y;
  } else {
    camera.fy = 1 / image.pixel_height;
    if (std::abs(kTurn / 2 * camera.fy - camera.height) < 1.5) camera.fy = camera.height / (kTurn / 2);
  }
  return camera;
}

std::optional<std::size_t> scan_of(const E57Contents& contents, const std::string& guid) {
  for (std::size_t i = 0; !guid.empty() && i < contents.scans.size(); ++i)
    if (contents.scans[i].guid == guid) return i;
  return {};
}

// Numbers that a writer left out or wrong, where what is meant is clear; says so.
E57Image mended(E57Image image, const std::string& what, std::vector<std::string>& notes) {
  const bool full = image.projection == E57Projection::spherical && image.width == 2 * image.height;
  if (full && !(image.width * image.pixel_width > kLeastPanorama_rad)) {
    notes.push_back(
        fmt::format("{}: its pixels of {} rad make no panorama; its sides are 2 : 1: taken as a full sphere",
                    what, image.pixel_width));
    image.pixel_width = image.pixel_height = kTurn / image.width;
  }
  if (!image.world_from_image && image.projection != E57Projection::visual_reference)
    notes.push_back(fmt::format("{}: no pose: taken as the file's frame", what));
  if (image.projection == E57Projection::pinhole)
    for (const std::string& name : image.dropped)
      if (name.find("istortion") != std::string::npos)
        notes.push_back(fmt::format("{}: {} is not used: taken as without distortion", what, name));
  return image;
}

}  // namespace

std::string place_of(const E57File& file, std::size_t image) {
  const std::string& name = file.contents().images.at(image).name;
  return name.empty() ? fmt::format("{}: image {}", file.name(), image)
                      : fmt::format("{}: image {} ({})", file.name(), image, excerpt(name));
}

std::string safe_name(const std::string& name, const std::string& fallback) {
  std::string safe;
  for (const char c : name)
    safe += c == '/' || c == '\\' || static_cast<unsigned char>(c) < 32 || c == 127 ? '_' : c;
  safe.resize(std::min(safe.size(), kLongestPictureName));
  return safe.empty() || safe == "." || safe == ".." ? fallback : safe;
}

E57Photographs e57_photographs(const E57Contents& contents) {
  E57Photographs result;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < contents.images.size(); ++i) {
    const std::string what = fmt::format("image {} ({})", i, excerpt(contents.images[i].name));
    const E57Image image = mended(contents.images[i], what, result.notes);
    if (const std::string problem = problem_of(image); !problem.empty()) {
      result.notes.push_back(fmt::format("{} is no photograph: {}", what, problem));
      continue;
    }
    E57Photograph found;
    found.image = i;
    found.scan = scan_of(contents, image.scan_guid);
    if (!image.scan_guid.empty() && !found.scan)
      result.notes.push_back(
          fmt::format("{}: its scan {} is not in the file", what, excerpt(image.scan_guid)));
    const std::string name = safe_name(image.name, fmt::format("image-{}", i));
    found.photograph.name = name;
    for (int number = 2; !taken.insert(found.photograph.name).second; ++number)
      found.photograph.name = fmt::format("{}-{}", name, number);
    found.photograph.camera = camera_of(image);
    Pose world_from_cam = image.world_from_image.value_or(Pose());
    world_from_cam.rotation =
        (world_from_cam.rotation * Eigen::Quaterniond(image_from_cam(image.projection))).normalized();
    found.photograph.cam_from_world = world_from_cam.inverse();
    result.photographs.push_back(std::move(found));
  }
  return result;
}

Image8 read_e57_photograph(const E57File& file, const E57Photograph& photograph,
                           std::vector<std::string>& notes) {
  const E57Image& image = file.contents().images.at(photograph.image);
  const std::string place = place_of(file, photograph.image);
  const Camera& camera = photograph.photograph.camera;
  const auto bytes_of = [&](const E57Blob& blob, const std::string& what) {
    return with_context(place, [&] { return file.read_blob(blob, what, &notes); });
  };
  const std::vector<char> picture = bytes_of(image.picture, "its picture");
  const std::vector<char> mask = image.mask ? bytes_of(*image.mask, "its mask") : std::vector<char>();
  return decode_photograph(
      {picture, image.png ? PictureFormat::png : PictureFormat::jpeg}, {mask, PictureFormat::png},
      fmt::format("{}, byte {}", place, image.picture.offset), camera.width, camera.height);
}

}  // namespace hybrid::io
