#pragma once
#include <ImfHeader.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose.hpp"

namespace hybrid::io {

// The attributes of a range image's header, by whatever program. Numbers may be text (separated by blanks or
// commas, in brackets or not), a floatvector, or a single float, double or int.
namespace range_attribute {
inline constexpr const char* kPrefix = "hybrid:";
inline constexpr const char* kFormat = "hybrid:format";
inline constexpr const char* kFormatName = "range image 3";  // 2 had all channels in one part
// Per row and per column; or the first angle and the step.
inline constexpr const char* kElevation = "hybrid:elevation_rad";
inline constexpr const char* kAzimuth = "hybrid:azimuth_rad";
inline constexpr const char* kElevationFirst = "hybrid:elevation_first_rad";
inline constexpr const char* kElevationStep = "hybrid:elevation_step_rad";
inline constexpr const char* kAzimuthFirst = "hybrid:azimuth_first_rad";
inline constexpr const char* kAzimuthStep = "hybrid:azimuth_step_rad";
inline constexpr const char* kWraps = "hybrid:wraps";
inline constexpr const char* kPose = "hybrid:world_from_scan";
inline constexpr const char* kExtra = "hybrid:extra_samples";
inline constexpr const char* kChecksum = "hybrid:xxh3";
}  // namespace range_attribute

// Whether the value of kFormat is one that read_range_exr() reads.
bool is_range_format(const std::string& name);

// Whether the format gives this attribute a meaning; the others are text for people.
bool is_range_attribute(const std::string& name);

// The attribute's text; empty without it.
std::string text_attribute(const Imf::Header& header, const char* name);

// Radians; empty when the header has neither the table nor first angle and step. Throws ErrorKind::input
// naming file and attribute: another number of angles than `count`, no number, an angle beyond `most_rad`.
struct AngleAttributes {
  const char *table, *first, *step;
};
inline constexpr AngleAttributes kElevationAttributes{
    range_attribute::kElevation, range_attribute::kElevationFirst, range_attribute::kElevationStep};
inline constexpr AngleAttributes kAzimuthAttributes{range_attribute::kAzimuth, range_attribute::kAzimuthFirst,
                                                    range_attribute::kAzimuthStep};
std::vector<double> angle_attribute(const std::string& file, const Imf::Header& header,
                                    const AngleAttributes& names, int count,
                                    double most_rad = std::numeric_limits<double>::max());

// 16 numbers, row-major. Throws as above.
std::optional<Pose> pose_attribute(const std::string& file, const Imf::Header& header);

// A single whole number; absent: nothing.
std::optional<std::int64_t> whole_attribute(const std::string& file, const Imf::Header& header,
                                            const char* name);

}  // namespace hybrid::io
