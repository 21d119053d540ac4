#pragma once
#include <filesystem>

#include "io/cameras/camera_file.hpp"

namespace hybrid::io {

// A folder of *.camera files (Strecha et al., "On Benchmarking Camera Calibration and Multi-View Stereo for
// High Resolution Imagery", CVPR 2008); "0000.jpg.camera" belongs to the photograph "0000.jpg". Lines of one
// file: K (3), distortion (1), R (3), C (1), width and height (1). A world point X is seen at
// x = K R^T (X - C): cam_from_world = R^T (X - C), x right, y down, z forward.
// The format does not say where K counts pixels from. The 400 points of datasets/herz-jesus, each matched in
// four or more photographs, reproject best (rms 0.391 px) when K counts from about 0.45 px inside the top
// left corner, so K is taken to count from that pixel's centre: (0.5, 0.5) in this program's coordinates.
// From the corner itself it is 0.396 px. The distortion row is documented only as zeros: anything else is
// refused, and so is skew. Throws ErrorKind::input naming file and line.
CameraFile read_strecha(const std::filesystem::path& folder);
// One of its files.
Photograph read_strecha_camera(const std::filesystem::path& file);

}  // namespace hybrid::io
