#include <cmath>
#include <limits>

#include "io/las_samples.hpp"
#include "io/read_scans.hpp"
#include "io/reader_rows.hpp"
#include "io/scan_samples.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

// Scans: the four points of scan_samples.hpp.

std::string tell_scan(const Scan& scan) {
  std::string text = fmt::format("{} x {}\n", scan.grid_rows, scan.grid_cols);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    tell(text, "point", scan.points[i]);
    if (!scan.rgb.empty()) tell(text, "colour", scan.rgb[i]);
  }
  tell(text, "intensity", scan.intensity);
  tell(text, "notes", scan.notes);
  if (scan.world_from_scan) tell(text, "pose", row_major(*scan.world_from_scan));
  return text;
}

std::string read_scan_file(const fs::path& file) {
  std::string text;
  for (const Scan& scan : read_scans(file)) text += tell_scan(scan);
  return text;
}

ReaderRow scan_row(const std::string& name, const std::string& format, const std::string& data) {
  ReaderRow row{.name = name, .file = "west wall." + format, .good = fixed_file(sample_file(format, data))};
  row.read = read_scan_file;
  row.text = data.empty() || data == "ascii";
  const bool big = data == "binary_big_endian";
  row.non_finite_no_return = row.text
                                 ? Edit{"1.5 0 0.25", "inf 0 0.25"}
                                 : Edit{raw(1.5f, big), raw(std::numeric_limits<float>::infinity(), big)};
  return row;
}

ReaderRow pcd_row(const std::string& name, const std::string& data) {
  ReaderRow row = scan_row(name, "pcd", data);
  const auto counts = [](std::uint64_t width, std::uint64_t height) {
    return Edit{"WIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4",
                fmt::format("WIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}", width, height,
                            width * height)};
  };
  if (!row.text) row.header_end = "DATA " + data + "\n";
  row.lone_cr = row.text;  // a LF after CR could be the first byte of binary data
  row.counts_too_high = {counts(5, 1), counts(4, 2), counts(1000, 1)};
  row.counts_too_low = {counts(3, 1), counts(1, 1), counts(0, 1)};
  row.absurd_sizes = {counts(4'000'000'000, 1),
                      counts(2'000'000'000, 2'000'000'000),
                      counts(18'000'000'000'000'000'000u, 1),
                      {"COUNT 1 1 1 1 1", "COUNT 1 1 1 4000000000 1"},
                      {"COUNT 1 1 1 1 1\nWIDTH 4", "COUNT 1 1 1 4000000000 1\nWIDTH 0"}};
  row.non_finite = {{"VIEWPOINT 0 0 0", "VIEWPOINT 0 nan 0"}};
  return row;
}

ReaderRow ply_row(const std::string& name, const std::string& data) {
  ReaderRow row = scan_row(name, "ply", data);
  if (!row.text) row.header_end = "end_header\n";
  row.counts_too_high = {{"vertex 4", "vertex 5"}, {"vertex 4", "vertex 400"}};
  row.counts_too_low = {{"vertex 4", "vertex 3"}, {"vertex 4", "vertex 0"}};
  row.absurd_sizes = {
      {"vertex 4", "vertex 4000000000"},
      {"vertex 4", "vertex 18000000000000000000"},
      {"element vertex 4", "element face 9000000000000000000\nproperty double a\nelement vertex 4"},
      {"property uchar red\n", "property list uint double red\n"}};
  return row;
}

ReaderRow ptx_row() {
  ReaderRow row = scan_row("ptx", "ptx", "");
  row.counts_too_high = {{"2\n2\n", "2\n3\n"}, {"2\n2\n", "20\n2\n"}};
  row.counts_too_low = {{"2\n2\n", "1\n2\n"}, {"2\n2\n", "1\n1\n"}};
  // 65536 x 65537 points would be 65536 in 32 bits.
  row.absurd_sizes = {
      {"2\n2\n", "2000000000\n2000000000\n"}, {"2\n2\n", "65536\n65537\n"}, {"2\n2\n", "1e300\n2\n"}};
  row.non_finite = {{"5 6 7 1\n", "5 nan 7 1\n"}, {"5 6 7 1\n", "5 6 inf 1\n"}, {"2\n2\n", "nan\n2\n"}};
  return row;
}

ReaderRow pts_row() {
  ReaderRow row = scan_row("pts", "pts", "");
  row.counts_too_high = {{"4\n1.5", "5\n1.5"}, {"4\n1.5", "14\n1.5"}};
  row.counts_too_low = {{"4\n1.5", "3\n1.5"}, {"4\n1.5", "0\n1.5"}};
  row.absurd_sizes = {{"4\n1.5", "4000000000\n1.5"}, {"4\n1.5", "1e300\n1.5"}, {"4\n1.5", "-4\n1.5"}};
  row.non_finite = {{"4\n1.5", "nan\n1.5"}};
  return row;
}

ReaderRow xyz_row() {
  ReaderRow row = pts_row();
  row.name = "xyz";
  row.file = "west wall.xyz";
  return row;
}

// Point format 2 (LAS 1.2) or 7 (1.4, with a coordinate system).
ReaderRow las_row(const std::string& name, int minor) {
  ReaderRow row{.name = name, .file = "west wall.las", .good = fixed_file(las_sample(minor))};
  row.read = read_scan_file;
  row.checked = false;
  const auto count = [&](std::uint64_t points) {
    if (minor == 4) return raw(std::uint32_t{0}) + raw(points) + raw(points);
    return raw(static_cast<std::uint32_t>(points)) + raw(static_cast<std::uint32_t>(points));
  };
  const double infinity = std::numeric_limits<double>::infinity();
  row.counts_too_high = {{count(4), count(5)}, {count(4), count(1000)}};
  row.counts_too_low = {{count(4), count(3)}, {count(4), count(0)}};
  row.absurd_sizes = {{count(4), count(4'000'000'000)}};
  row.non_finite = {{raw(0.125), raw(std::nan(""))}, {raw(-1.0), raw(infinity)}};
  return row;
}

}  // namespace

std::vector<ReaderRow> scan_reader_rows() {
  return {pcd_row("pcd_ascii", "ascii"),
          pcd_row("pcd_binary", "binary"),
          pcd_row("pcd_compressed", "binary_compressed"),
          ply_row("ply_ascii", "ascii"),
          ply_row("ply_little_endian", "binary_little_endian"),
          ply_row("ply_big_endian", "binary_big_endian"),
          ptx_row(),
          pts_row(),
          xyz_row(),
          las_row("las_1_2", 2),
          las_row("las_1_4", 4)};
}

}  // namespace hybrid::testing
