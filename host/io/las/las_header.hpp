#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/input_file.hpp"

namespace hybrid::io {

// Where the fields of a point record lie, in bytes from its start; 0: the format has none.
struct LasPointFormat {
  int bytes = 0;  // extra bytes of the file's own follow
  int gps_time = 0, red = 0, infrared = 0, waveform = 0;
  bool extended = false;  // 6 to 10: other returns, flags, classes and angles
};
inline constexpr int kLasPointFormats = 11;
const LasPointFormat& las_point_format(int format);

struct LasHeader {
  int minor = 2;
  int point_format = 0;
  std::uint64_t record_bytes = 0, points = 0;
  std::uint64_t announced = 0;  // points as the header counts them; in salvage there may be fewer
  std::uint64_t data_offset = 0, data_end = 0;  // what lies between may be point records
  std::array<double, 3> scale{}, offset{}, minimum{}, maximum{};
  std::string crs, unit;
  std::vector<CrsRecord> crs_records;
  std::vector<std::string> notes;
};

inline constexpr const char* kLasCrsUser = "LASF_Projection";
enum LasCrsRecord : std::uint16_t {
  kGeoKeys = 34735,
  kGeoDoubles = 34736,
  kGeoTexts = 34737,
  kMathWkt = 2111,
  kWkt = 2112
};

// The header and variable length records of LAS 1.0 to 1.4, all sizes and offsets checked against the file.
// Throws ErrorKind::input naming the byte: LAZ, other versions or point formats, scales that are no scales,
// counts that the file cannot hold. In salvage what does not concern the points becomes a note, and so does a
// count, bounded by what is there.
LasHeader read_las_header(InputFile& file, bool salvage = false);

// Of the bytes that follow the last point: a note, or nothing where they are none or zeros. A further record
// means that the count is wrong: throws ErrorKind::input, not in salvage.
std::optional<std::string> check_las_rest(InputFile& file, const LasHeader& header, bool salvage);

}  // namespace hybrid::io
