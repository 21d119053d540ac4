#pragma once
#include <array>
#include <string>
#include <string_view>

#include "geometry/scan.hpp"

namespace hybrid::io {

// A scan whose points are in some other frame (a site's, a map's) becomes one whose frame has its origin
// where the scanner stood, its axes as they were: `scanner`, metres, in the file's coordinates (Scan::origin
// included). world_from_scan then leads back to the file's coordinates. Points at the file's own origin were
// no-returns and stay so. Sets Scan::scanner_is_known. Throws ErrorKind::input when the file says itself
// where the scanner stood: a range image, or a pose that is not the identity and stands elsewhere. Where it
// stands there the points are not in the scanner's frame, as some programs write PCD.
void place_scanner(Scan& scan, const Vec3& scanner);

// Metres of a length unit of a scan's file; all else is in metres.
struct ScanUnit {
  std::string_view name;
  double metres;
};
inline constexpr std::array<ScanUnit, 5> kScanUnits = {
    {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"ft", 0.3048}, {"us-ft", 1200.0 / 3937}}};
// Throws ErrorKind::input when it is no name of these.
double metres_of_unit(std::string_view name);

// Brings a scan's points and the place of its pose to metres. Throws ErrorKind::input of a range image, which
// is in metres.
void scale_lengths(Scan& scan, double metres);

// How the axes of a file lie that cameras wrote; the scanner's own are x forward, y left, z up.
enum class ScanAxes {
  z_up,    // the scanner's
  camera,  // x right, y down, z forward
  opengl   // x right, y up, z backward
};
inline constexpr std::array<std::string_view, 3> kScanAxesNames = {"z-up", "camera", "opengl"};
ScanAxes scan_axes_of(std::string_view name);

// Between the scanner's frame and the file's: a rotation.
Pose file_from_scanner(ScanAxes axes);

// Brings a scan's points and pose into the scanner's frame. Throws ErrorKind::input of a range image, which
// is in that frame.
void turn_axes(Scan& scan, ScanAxes axes);

// Why a scan's origin cannot well be where its scanner stood, or "": a cloud without grid and pose that is
// farther away from the origin than it is large.
std::string doubt_of_scanner(const Scan& scan);

}  // namespace hybrid::io
