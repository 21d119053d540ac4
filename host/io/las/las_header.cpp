#include "io/las/las_header.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/las/las_crs.hpp"
#include "io/salvage.hpp"
#include "io/scalar_type.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kLasHeader_bytes = 227, kHeader14_bytes = 375;
constexpr std::uint64_t kRecordHead_bytes = 54, kExtendedHead_bytes = 60;
constexpr const char* kCompressed =
    "the file is compressed (LAZ), which is not read; decompress it first: laszip -i a.laz -o a.las, or pdal "
    "translate a.laz a.las";

template <typename T>
T get(InputFile& file, std::uint64_t at) {
  return load_as<T>(file.at(at, sizeof(T)), false);
}

std::string padded_text(InputFile& file, std::uint64_t at, std::uint64_t most) {
  const std::string_view text(file.at(at, most), most);
  return std::string(text.substr(0, text.find('\0')));
}

void check_signature(InputFile& file) {
  if (file.size() < kLasHeader_bytes)
    fail_input(
        "{}: byte 0: expected a LAS header of {} bytes, found {}; the file is cut short: copy it again",
        file.name(), kLasHeader_bytes, file.size());
  if (std::string_view(file.at(0, 4), 4) != "LASF")
    fail_input("{}: byte 0: expected \"LASF\", found {}; is this a LAS file?", file.name(),
               in_quotes({file.at(0, 4), 4}));
  const int major = get<std::uint8_t>(file, 24), minor = get<std::uint8_t>(file, 25);
  if (major != 1 || minor > 4)
    fail_input("{}: byte 24: expected LAS version 1.0 to 1.4, found {}.{}; export it as 1.2 or 1.4",
               file.name(), major, minor);
}

void read_points_layout(InputFile& file, LasHeader& header) {
  const int format = get<std::uint8_t>(file, 104);
  if ((format & 0xc0) != 0 && (format & 0x3f) < kLasPointFormats)
    fail_input("{}: byte 104: expected a point format from 0 to 10, found {}: {}", file.name(), format,
               kCompressed);
  if (format >= kLasPointFormats)
    fail_input(
        "{}: byte 104: expected a point format from 0 to 10, found {}; the file is damaged: copy or export "
        "it again",
        file.name(), format);
  header.point_format = format;
  header.record_bytes = get<std::uint16_t>(file, 105);
  const auto least = static_cast<std::uint64_t>(las_point_format(format).bytes);
  if (header.record_bytes < least)
    fail_input(
        "{}: byte 105: expected point records of at least {} bytes (point format {}), found {}; the header "
        "is wrong: export the file again",
        file.name(), least, format, header.record_bytes);
}

void read_transform(InputFile& file, LasHeader& header) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.scale[axis] = get<double>(file, 131 + 8 * axis);
    header.offset[axis] = get<double>(file, 155 + 8 * axis);
    header.maximum[axis] = get<double>(file, 179 + 16 * axis);
    header.minimum[axis] = get<double>(file, 187 + 16 * axis);
    if (!(header.scale[axis] > 0 && header.scale[axis] * 0x1p31 <= kFarthest_m * 1000))
      fail_input(
          "{}: byte {}: expected a scale factor above 0 (0.001 is usual), found {}; the header is wrong: "
          "export the file again",
          file.name(), 131 + 8 * axis, header.scale[axis]);
    if (!(std::abs(header.offset[axis]) <= kFarthest_m))
      fail_input(
          "{}: byte {}: expected an offset within {} m, found {}; the header is wrong: export the file "
          "again",
          file.name(), 155 + 8 * axis, kFarthest_m, header.offset[axis]);
  }
}

// A record that says what the coordinates refer to; others are passed.
void take_record(InputFile& file, std::uint64_t at, const std::string& user, std::uint16_t id,
                 std::uint64_t bytes, LasHeader& header) {
  if (user == "laszip encoded")
    fail_input("{}: byte {}: expected no record of a compressor, found \"laszip encoded\": {}", file.name(),
               at, kCompressed);
  const bool known = id == kGeoKeys || id == kGeoDoubles || id == kGeoTexts || id == kMathWkt || id == kWkt;
  if (user != kLasCrsUser || !known) return;
  CrsRecord record{id, std::string(bytes, '\0')};
  file.read(at, record.bytes);
  header.crs_records.push_back(std::move(record));
}

// `count` records from `at` on, which end before `end`. Their heads differ in the size of one number.
void read_records(InputFile& file, std::uint64_t at, std::uint64_t end, std::uint64_t count, bool extended,
                  LasHeader& header) {
  const std::uint64_t head = extended ? kExtendedHead_bytes : kRecordHead_bytes;
  for (std::uint64_t i = 0; i < count; ++i) {
    const bool fits = at <= end && end - at >= head;
    const std::uint64_t bytes = !fits      ? 0
                                : extended ? get<std::uint64_t>(file, at + 20)
                                           : get<std::uint16_t>(file, at + 20);
    if (!fits || end - at - head < bytes)
      fail_input(
          "{}: byte {}: expected variable length record {} of {} ({} bytes), found {} bytes left; the header "
          "is wrong, or the file cut short: copy or export it again, {}",
          file.name(), at, i + 1, count, head + bytes, end - std::min(at, end), kSalvageRemedy);
    const std::string user = padded_text(file, at + 2, 16);
    const auto id = get<std::uint16_t>(file, at + 18);
    take_record(file, at + head, user, id, bytes, header);
    at += head + bytes;
  }
}

void read_counts(InputFile& file, LasHeader& header, bool salvage) {
  header.points = get<std::uint32_t>(file, 107);
  if (header.minor < 4) return;
  const auto points = get<std::uint64_t>(file, 247);
  if (salvage && points != 0 && header.points != 0 && header.points != points) {
    header.notes.push_back(
        fmt::format("byte 107: expected {} points as at byte 247 (or 0), found {}: as many as "
                    "there are, up to the greater",
                    points, header.points));
    header.points = std::max(header.points, points);
    return;
  }
  if (points == 0 && header.points > 0)
    header.notes.emplace_back("byte 247: no point count of 64 bits; the one of 32 bits is used");
  else if (header.points != 0 && header.points != points)
    fail_input(
        "{}: byte 107: expected {} points as at byte 247 (or 0), found {}; the header is wrong: export the "
        "file again, {}",
        file.name(), points, header.points, kSalvageRemedy);
  else
    header.points = points;
}

// What follows the points: waveforms (1.3) and extended records (1.4), each checked to lie behind the header.
std::uint64_t end_of_points(InputFile& file, LasHeader& header, bool salvage) {
  std::uint64_t end = file.size();
  const auto follows = [&](std::uint64_t at, const char* what) {
    const auto start = get<std::uint64_t>(file, at);
    if (start == 0) return;
    if (start < header.data_offset || start > file.size()) {
      const auto problem = fmt::format(
          "byte {}: expected the {} behind the points, in a file of {} bytes, found them at byte {}", at,
          what, file.size(), start);
      if (!salvage)
        fail_input("{}: {}; the header is wrong, or the file cut short: copy or export it again, {}",
                   file.name(), problem, kSalvageRemedy);
      header.notes.push_back(problem + ": they are lost");
      return;
    }
    end = std::min(end, start);
  };
  const bool waveforms_inside = (get<std::uint16_t>(file, 6) & 2) != 0;
  if (header.minor >= 3 && waveforms_inside) follows(227, "waveforms");
  if (header.minor >= 4 && get<std::uint32_t>(file, 243) > 0) follows(235, "extended records");
  return end;
}

}  // namespace

const LasPointFormat& las_point_format(int format) {
  static constexpr LasPointFormat kFormats[kLasPointFormats] = {
      {20, 0, 0, 0, 0, false},   {28, 20, 0, 0, 0, false},   {26, 0, 20, 0, 0, false},
      {34, 20, 28, 0, 0, false}, {57, 20, 0, 0, 28, false},  {63, 20, 28, 0, 34, false},
      {30, 22, 0, 0, 0, true},   {36, 22, 30, 0, 0, true},   {38, 22, 30, 36, 0, true},
      {59, 22, 0, 0, 30, true},  {67, 22, 30, 36, 38, true},
  };
  return kFormats[format];
}

LasHeader read_las_header(InputFile& file, bool salvage) {
  check_signature(file);
  LasHeader header;
  header.minor = get<std::uint8_t>(file, 25);
  const std::uint64_t header_bytes = get<std::uint16_t>(file, 94);
  const std::uint64_t least = header.minor == 4   ? kHeader14_bytes
                              : header.minor == 3 ? kLasHeader_bytes + 8
                                                  : kLasHeader_bytes;
  header.data_offset = get<std::uint32_t>(file, 96);
  if (header_bytes < least || header_bytes > file.size())
    fail_input(
        "{}: byte 94: expected a header of at least {} bytes (LAS 1.{}), found {} in a file of {} bytes; the "
        "header is wrong, or the file cut short: copy or export it again",
        file.name(), least, header.minor, header_bytes, file.size());
  if (header.data_offset < header_bytes || header.data_offset > file.size())
    fail_input(
        "{}: byte 96: expected the points between byte {} and the end, byte {}, found byte {}; the header is "
        "wrong, or the file cut short: copy or export it again",
        file.name(), header_bytes, file.size(), header.data_offset);
  read_points_layout(file, header);
  read_transform(file, header);
  read_counts(file, header, salvage);
  const auto records = [&](std::uint64_t at, std::uint64_t end, std::uint64_t count, bool extended) {
    try {
      read_records(file, at, end, count, extended, header);
    } catch (const Error& error) {
      if (!salvage || error.kind() != ErrorKind::input) throw;
      header.notes.push_back(Damage(file.name()).shortened(error.what()) + ": what follows it is lost");
    }
  };
  records(header_bytes, header.data_offset, get<std::uint32_t>(file, 100), false);
  header.data_end = end_of_points(file, header, salvage);
  if (header.minor == 4)
    records(get<std::uint64_t>(file, 235), file.size(), get<std::uint32_t>(file, 243), true);
  header.announced = header.points;
  const std::uint64_t room = header.data_end - header.data_offset;
  if (salvage)
    header.points = std::min(header.points, room / header.record_bytes);
  else
    check_count_fits(file.name(), "byte 107", "points", header.points, header.record_bytes, room, true);
  describe_las_crs(header);
  return header;
}

std::optional<std::string> check_las_rest(InputFile& file, const LasHeader& header, bool salvage) {
  const std::uint64_t end = header.data_offset + header.points * header.record_bytes;
  const std::uint64_t rest = header.data_end - end;
  if (rest == 0 || file.only_zeros_from(end)) return {};
  if (rest >= header.record_bytes && !salvage)
    fail_input(
        "{}: byte {}: expected the end of the points after {}, found {} more bytes, room for {} points; "
        "correct the count in the header (byte 107, of LAS 1.4 byte 247), {}",
        file.name(), end, header.points, rest, rest / header.record_bytes, kSalvageRemedy);
  return fmt::format("byte {}: {} bytes after the last point are ignored", end, rest);
}

}  // namespace hybrid::io
