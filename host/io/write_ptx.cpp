#include "io/intensity_map.hpp"
#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {
namespace {

void append_row(std::string& text, std::initializer_list<double> values) {
  const char* before = "";
  for (const double value : values) {
    text += before;
    append_number(text, value + 0.0);  // no negative zeros
    before = " ";
  }
  text += '\n';
}

// The matrix multiplies row vectors from the right: its rows are the images of the axes.
std::string header(const Scan& scan, std::size_t cols, std::size_t rows) {
  const auto m = row_major(scan.world_from_scan.value_or(Pose{}));
  std::string text = fmt::format("{}\n{}\n", cols, rows);
  append_row(text, {m[3], m[7], m[11]});
  for (std::size_t axis = 0; axis < 3; ++axis) append_row(text, {m[axis], m[4 + axis], m[8 + axis]});
  for (std::size_t axis = 0; axis < 4; ++axis)
    append_row(text, {m[axis], m[4 + axis], m[8 + axis], axis == 3 ? 1.0 : 0.0});
  return text;
}

void append_scan(OutputFile& out, const Scan& scan) {
  const bool organised = scan.organised();
  const std::size_t rows = organised ? static_cast<std::size_t>(scan.grid_rows) : 1;
  const std::size_t cols = organised ? static_cast<std::size_t>(scan.grid_cols) : scan.points.size();
  const std::string head = header(scan, cols, rows);
  out.write(head.data(), head.size());
  const IntensityMap map = map_intensity(scan, kPtxIntensity);
  const GridSamples grid(scan);
  write_records(out, rows * cols, [&](std::size_t i, std::string& text) {
    const std::size_t at = organised ? grid.at(static_cast<int>(i % rows), static_cast<int>(i / rows)) : i;
    if (at == Scan::kNoNode) {
      text += scan.rgb.empty() ? "0 0 0 0\n" : "0 0 0 0 0 0 0\n";
      return;
    }
    append_point(text, scan, at);
    text += ' ';
    append_number(text, scan.intensity.empty() ? 0.0f : static_cast<float>(map(scan.intensity[at])));
    if (!scan.rgb.empty()) append_colour(text, scan.rgb[at]);
    text += '\n';
  });
}

}  // namespace

void write_ptx(const std::filesystem::path& file, const ScanSource& next) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    while (const auto scan = next()) {
      if (scan->points.empty())
        fail_input(
            "{}: scan {}: expected at least one sample, found none: PTX holds no empty scans; leave it out",
            file.string(), scan->name);
      append_scan(out, *scan);
    }
    out.close();
  });
}

}  // namespace hybrid::io
