#pragma once
#include "io/las/las_header.hpp"

namespace hybrid::io {

// Fills crs ("EPSG:27700" from GeoTIFF keys, WKT as it is) and unit from crs_records.
void describe_las_crs(LasHeader& header);

// The records that say `crs` in a LAS file: WKT as it is, as GeoTIFF keys "EPSG:n" and
// "EPSG:n+m" with a vertical system, also in lower case, without "EPSG:" or as a URN; none where it is
// neither.
std::vector<CrsRecord> las_crs_records(const std::string& crs);
bool is_wkt(const std::string& crs);

}  // namespace hybrid::io
