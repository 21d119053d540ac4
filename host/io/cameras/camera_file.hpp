#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.hpp"

namespace hybrid::io {

// What a file of cameras says, whatever its format: cameras in this program's conventions (x right, y down, z
// forward, the centre of the top left pixel at (0.5, 0.5)), photographs sorted by name.
struct CalibratedCamera {
  std::string id;     // the file's own: COLMAP's number, the name of the photograph elsewhere
  std::string model;  // as the format names it: "SIMPLE_RADIAL" ...
  Camera camera;      // width and height 0: neither the file nor a picture tells
};

struct CameraFile {
  std::vector<CalibratedCamera> cameras;  // in file order, used by a photograph or not
  std::vector<Photograph> photographs;
  std::vector<std::string> notes;  // what was left out, and why
  // What takes these cameras into another frame that the file tells of, or "": where they do not fit.
  std::string frame_hint;
};

// The checks that all formats share. `place` names file and line, or file and entry, in front of the message.
// All throw ErrorKind::input.

// 1 to 2^20 pixels.
int checked_image_size(const std::string& place, std::string_view field, std::int64_t value);
// More than 0 px.
void check_focal_length(const std::string& place, const Camera& camera);
// The rotation nearest to a matrix that is one up to `kRotationTolerance` per element of R R^T - 1, which
// covers files of four decimals; mirrored and sheared ones are refused.
constexpr double kRotationTolerance = 1e-3;
Eigen::Quaterniond checked_rotation(const std::string& place, const Mat3& matrix);
// Sorts by name. Two photographs of one name are an error that names `file`.
void sort_photographs(const std::filesystem::path& file, std::vector<Photograph>& photographs);

}  // namespace hybrid::io
