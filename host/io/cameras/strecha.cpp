#include "io/cameras/strecha.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/text/text_record.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

constexpr double kCentreOfFirstPixel = 0.5;  // in our coordinates; 0 in the file's

constexpr std::string_view kExtension = ".camera";

std::vector<fs::path> camera_files(const fs::path& folder) {
  std::error_code code;
  if (!fs::exists(folder, code)) fail_input("{}: no such folder; check the path", folder.string());
  if (!fs::is_directory(folder, code))
    fail_input("{}: expected a folder of *.camera files, found a file", folder.string());
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
    if (entry->path().extension() == kExtension) files.push_back(entry->path());
  if (code) fail_input("{}: cannot be listed ({})", folder.string(), code.message());
  if (files.empty())
    fail_input("{}: expected files NAME.camera (0000.jpg.camera), found none; check the path",
               folder.string());
  std::sort(files.begin(), files.end());
  return files;
}

void check_calibration(const std::string& place, const Mat3& k) {
  const double tolerance = 1e-6 * std::abs(k(0, 0));
  if (k.row(2) != Vec3(0, 0, 1).transpose() || k(1, 0) != 0 || std::abs(k(0, 1)) > tolerance)
    fail_input(
        "{}: K: expected fx 0 cx / 0 fy cy / 0 0 1, found {} {} {} / {} {} {} / {} {} {}; skew is not "
        "supported: undistort the photograph",
        place, k(0, 0), k(0, 1), k(0, 2), k(1, 0), k(1, 1), k(1, 2), k(2, 0), k(2, 1), k(2, 2));
}

}  // namespace

Photograph read_strecha_camera(const fs::path& file) {
  const std::string bytes = read_plain_text(file);
  FilledLines text(file, bytes);
  Photograph result;
  result.name = file.stem().string();
  Camera& camera = result.camera;
  const Mat3 k = text.matrix("K");
  check_calibration(text.place(), k);
  camera.fx = k(0, 0), camera.fy = k(1, 1);
  camera.cx = k(0, 2) + kCentreOfFirstPixel, camera.cy = k(1, 2) + kCentreOfFirstPixel;
  check_focal_length(text.place(), camera);
  if (const Vec3 distortion = text.row("the distortion's 3 numbers"); !distortion.isZero(0))
    fail_input(
        "{}: distortion: expected 0 0 0 (the format defines no other), found {} {} {}; undistort the "
        "photographs",
        text.place(), distortion.x(), distortion.y(), distortion.z());
  const Mat3 world_from_cam = text.matrix("R");
  const Eigen::Quaterniond rotation = checked_rotation(text.place() + ": R", world_from_cam);
  const Vec3 centre = text.row("the camera's position C");
  result.cam_from_world.rotation = rotation.conjugate();
  result.cam_from_world.translation = -(result.cam_from_world.rotation * centre);
  TextRecord size = text.line("width and height");
  camera.width = checked_image_size(text.place(), "width", size.integer("width"));
  camera.height = checked_image_size(text.place(), "height", size.integer("height"));
  size.expect_end("width and height");
  text.expect_end("the image's size");
  return result;
}

CameraFile read_strecha(const fs::path& folder) {
  CameraFile result;
  for (const fs::path& file : camera_files(folder)) {
    result.photographs.push_back(read_strecha_camera(file));
    const Photograph& photograph = result.photographs.back();
    result.cameras.push_back({photograph.name, "PINHOLE", photograph.camera});
  }
  sort_photographs(folder, result.photographs);
  return result;
}

}  // namespace hybrid::io
