#pragma once
#include <string>

#include "geometry/scan.hpp"

namespace hybrid::io {

// A scan whose points are in some other frame (a site's, a map's) becomes one whose frame has its origin
// where the scanner stood, its axes as they were: `scanner`, metres, in the file's coordinates (Scan::origin
// included). world_from_scan then leads back to the file's coordinates. Points at the file's own origin were
// no-returns and stay so. Sets Scan::scanner_is_known. Throws ErrorKind::input when the file says itself
// where the scanner stood: a range image, or a pose that is not the identity.
void place_scanner(Scan& scan, const Vec3& scanner);

// Why a scan's origin cannot well be where its scanner stood, or "": a cloud without grid and pose that is
// farther away from the origin than it is large.
std::string doubt_of_scanner(const Scan& scan);

}  // namespace hybrid::io
