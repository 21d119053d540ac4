#pragma once
#include <filesystem>

#include "io/cameras/camera_file.hpp"

namespace hybrid::io {

// Nerfstudio's transforms.json (and instant-ngp's, its ancestor): world_from_camera matrices in OpenGL's axes
// (x right, y up, z backward), one per frame; intrinsics for all, or per frame. fl_x fl_y cx cy w h in
// pixels, the top left pixel's centre at (0.5, 0.5); fl_y defaults to fl_x, cx and cy to the image's middle;
// without fl_x the horizontal camera_angle_x (rad). camera_model: SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL,
// RADIAL, OPENCV (k1 k2 k3 p1 p2; its k4 is a term of r^8 and must be 0), OPENCV_FISHEYE (k1 to k4) or
// EQUIRECTANGULAR (full panoramas). A photograph is named by its file_path, ".png" added where it has no
// ending (Blender's sets). Missing w and h are read from the pictures in `images`; empty = leave them 0.
// applied_transform is not undone: the matrices' own frame is the cameras' world; CameraFile::frame_hint says
// how. Throws ErrorKind::input naming file and entry.
CameraFile read_nerfstudio(const std::filesystem::path& file, const std::filesystem::path& images);

}  // namespace hybrid::io
