#pragma once
#include "io/scan_writers.hpp"

// The writers of scan_writers(), one file each.
namespace hybrid::io {

inline constexpr std::array<float, 2> kPtxIntensity{0, 1}, kPtsIntensity{-2048, 2047},
    kLasIntensity{0, 65535};

// Text. Unorganised scans are a single row of columns; the pose is the 4x4 and, again, position and axes.
void write_ptx(const std::filesystem::path& file, const ScanSource& next);
// Text, returns only: x y z [intensity] [r g b] after their count.
void write_pts(const std::filesystem::path& file, const ScanSource& next);
// Text, returns only: x y z [intensity] [r g b] after their names, as CloudCompare has them.
void write_xyz(const std::filesystem::path& file, const ScanSource& next);
// Binary little endian, returns only; doubles where the scan has an origin or exact coordinates.
void write_ply_scan(const std::filesystem::path& file, const ScanSource& next);
// Binary; row by row, the pose as VIEWPOINT; doubles as in PLY.
void write_pcd(const std::filesystem::path& file, const ScanSource& next);
// LAS 1.2, with a WKT coordinate system 1.4; returns only, in steps of
// las_steps.hpp.
void write_las(const std::filesystem::path& file, const ScanSource& next);
// Single precision, doubles as in PLY; the coordinate system is the first scan's.
void write_e57(const std::filesystem::path& file, const ScanSource& next);
// A range image with records (exr_records.hpp), the same as in E57.
void write_exr_of_scan(const std::filesystem::path& file, const ScanSource& next);

}  // namespace hybrid::io
