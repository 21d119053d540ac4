#pragma once
#include <filesystem>

#include "io/camera_file.hpp"

namespace hybrid::io {

// A folder of *.camera files (Strecha et al., "On Benchmarking Camera Calibration and Multi-View Stereo for
// High Resolution Imagery", CVPR 2008); "0000.jpg.camera" belongs to the photograph "0000.jpg". Lines of one
// file: K (3), distortion (1), R (3), C (1), width and height (1). A world point X is seen at
// x = K R^T (X - C): cam_from_world = R^T (X - C), x right, y down, z forward.
// K counts pixels from the centre of the top left one (0, 0), as computer vision's calibration tools do, so
// half a pixel is added to the principal point. The distortion row is documented only as zeros: anything else
// is refused, and so is skew. Throws ErrorKind::input naming file and line.
CameraFile read_strecha(const std::filesystem::path& folder);

}  // namespace hybrid::io
