#include "io/pcd/pcd_file.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "core/error.hpp"
#include "io/pcd/lzf.hpp"
#include "io/salvage.hpp"

namespace hybrid::io {
namespace {

PcdUsedFields find_fields(const std::string& file, const PcdHeader& header, std::string& unused) {
  PcdUsedFields used;
  for (const PcdField& field : header.fields) {
    const PcdField** slot = nullptr;
    if (field.count == 1) {
      if (field.name == "x") slot = &used.x;
      if (field.name == "y") slot = &used.y;
      if (field.name == "z") slot = &used.z;
      if (names_intensity(field.name)) slot = &used.intensity;
      if ((field.name == "rgb" || field.name == "rgba") && size_of(field.type) == 4) slot = &used.packed;
      if (field.name == "red") slot = &used.red;
      if (field.name == "green") slot = &used.green;
      if (field.name == "blue") slot = &used.blue;
    }
    if (slot && *slot)
      fail_input("{}: FIELDS: expected {} once, found it again; correct the header", file,
                 in_quotes(field.name));
    if (slot)
      *slot = &field;
    else if (field.name != "_")  // padding
      unused += (unused.empty() ? "" : " ") + field.name;
  }
  if (!used.x || !used.y || !used.z)
    fail_input("{}: FIELDS: expected x, y and z with COUNT 1, found no {}; is this a point cloud?", file,
               !used.x ? "x" : (!used.y ? "y" : "z"));
  return used;
}

}  // namespace

ScanSample pcd_sample_of_row(const PcdUsedFields& used, const double* row) {
  const auto number = [&](const PcdField& field) { return row[field.value_offset]; };
  const auto bits = [&](const PcdField& field) {
    if (is_real(field.type)) return std::bit_cast<std::uint32_t>(static_cast<float>(number(field)));
    const bool fits = number(field) > -2147483649.0 && number(field) < 4294967296.0;
    return fits ? static_cast<std::uint32_t>(static_cast<std::int64_t>(number(field))) : 0u;
  };
  return make_pcd_sample(used, number, bits);
}

PcdFile::PcdFile(const std::filesystem::path& file, bool for_salvage)
    : input(file),
      name(input.name()),
      salvage(for_salvage),
      header(read_pcd_header(input, salvage)),
      data(header.data_offset),
      data_bytes(input.size() - data) {
  used = find_fields(name, header, unused);
}

std::vector<std::string> PcdFile::notes() const {
  std::vector<std::string> found = header.notes;
  if (!unused.empty()) found.push_back("fields not used: " + unused);
  return found;
}

bool PcdFile::rounds() const {
  return header.data == PcdData::ascii ||
         std::ranges::any_of(std::array{used.x, used.y, used.z},
                             [](const PcdField* field) { return field->type != ScalarType::f32; });
}

void PcdFile::bound_points() {
  // A value takes a digit and a separator; the last line may lack its end.
  const bool ascii = header.data == PcdData::ascii;
  const std::uint64_t least_bytes = ascii ? 2 * header.point_values : header.point_bytes,
                      available = data_bytes + (ascii ? 1 : 0);
  if (!salvage)
    check_count_fits(name, ascii ? fmt::format("line {}", header.data_line) : byte(0), "points",
                     header.points, least_bytes, available, true);
  else
    header.points = std::min(header.points, available / std::max<std::uint64_t>(least_bytes, 1));
}

PcdFile::Sizes PcdFile::compressed_sizes() {
  check_count_fits(name, byte(0), "sizes", 2, 4, data_bytes);
  std::uint64_t compressed = load_as<std::uint32_t>(input.at(data, 4), false);
  const std::uint64_t expanded = load_as<std::uint32_t>(input.at(data + 4, 4), false);
  if (salvage) compressed = std::min(compressed, data_bytes - 8);
  if (compressed > data_bytes - 8)
    fail_input(
        "{}: {}: expected {} compressed bytes, found {}; the file is cut short: copy or export it again, "
        "{}",
        name, byte(0), compressed, data_bytes - 8, kSalvageRemedy);
  // Of all counts the one that was written with the data tells where the fields lie.
  if (salvage && expanded % header.point_bytes == 0 && expanded / header.point_bytes != header.points) {
    const std::uint64_t announced = header.points;
    header.points = expanded / header.point_bytes;
    header.notes.push_back(
        fmt::format("{}: expected {} points, found an uncompressed size of {}: as many, "
                    "and as not organised",
                    byte(4), announced, header.points));
    header.height = 1;
  }
  if (header.points > expanded / header.point_bytes || header.points * header.point_bytes != expanded)
    fail_input(
        "{}: {}: expected {} points of {} bytes, found an uncompressed size of {} bytes; the header is "
        "wrong, or the file damaged: export it again",
        name, byte(4), header.points, header.point_bytes, expanded);
  if (!salvage)
    check_count_fits(name, byte(4), "uncompressed bytes", expanded, 1, compressed * kLzfLargestExpansion);
  return {compressed, expanded};
}

void PcdFile::fail_compressed(const std::string& damage) const {
  fail_input("{}: {}: expected LZF data, found {}; the file is damaged: copy or export it again, {}", name,
             byte(8), damage, kSalvageRemedy);
}

void PcdFile::read_line(TextCursor& at, std::span<double> values, std::uint64_t done) const {
  const std::uint64_t line = at.line();
  if (at.at_end())
    fail_input(
        "{}: line {}: expected {} points, found {}; the file is cut short: copy or export it again, {}", name,
        line, header.points, done, kSalvageRemedy);
  const std::size_t found = at.read_numbers(values);
  if (found != values.size())
    fail_input(
        "{}: line {}: expected {} values as FIELDS and COUNT say, found {}; correct or remove that line, "
        "{}",
        name, line, values.size(), found, kSalvageRemedy);
}

std::vector<std::string> PcdFile::notes_of_rest(const TextPlace& place, bool commas) {
  std::vector<std::string> found;
  if (commas) found.emplace_back("values are separated by commas, which PCD does not provide for");
  TextCursor cursor(input, place.offset, place.line);
  cursor.skip_blank_lines();
  if (cursor.at_end()) return found;
  const std::uint64_t line = cursor.line(), rest = cursor.remaining();
  if (!salvage && cursor.next_line_is_numbers(header.point_values))
    fail_input(
        "{}: line {}: expected the end of the file after {} points, found another point; correct WIDTH, "
        "HEIGHT and POINTS in the header, {}",
        name, line, header.points, kSalvageRemedy);
  found.push_back(fmt::format("line {}: {} bytes after the last point are ignored", line, rest));
  return found;
}

std::vector<std::string> PcdFile::notes_of_rest(std::uint64_t used_bytes) {
  const std::uint64_t rest = data_bytes - used_bytes;
  if (rest > 0) check_not_sent_as_text(input, data);
  if (input.only_zeros_from(data + used_bytes)) return {};
  if (header.data == PcdData::binary && rest >= header.point_bytes && !salvage)
    fail_input(
        "{}: {}: expected the end of the file after {} points, found {} more bytes, room for {} points; "
        "correct WIDTH, HEIGHT and POINTS in the header, {}",
        name, byte(used_bytes), header.points, rest, rest / header.point_bytes, kSalvageRemedy);
  return {fmt::format("{}: {} bytes after the last point are ignored", byte(used_bytes), rest)};
}

void PcdFile::set_grid_and_pose(Scan& scan) const {
  if (grid()) {
    scan.grid_rows = static_cast<int>(header.height);
    scan.grid_cols = static_cast<int>(header.width);
    scan.row_by_row = true;
  }
  const auto& v = header.viewpoint;
  const Pose pose{1, Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized(), {v[0], v[1], v[2]}};
  if (pose.translation.isZero(0) && pose.rotation.vec().isZero(0)) return;
  scan.world_from_scan = pose;
  scan.notes.emplace_back(
      "VIEWPOINT is taken as the scanner's pose, and the points as being in the scanner's frame");
}

}  // namespace hybrid::io
