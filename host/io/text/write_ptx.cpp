#include "io/intensity_map.hpp"
#include "io/node_blocks.hpp"
#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/text/sample_text.hpp"
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
std::string header(const Scan& scan, std::uint64_t cols, std::uint64_t rows) {
  const auto m = row_major(scan.world_from_scan.value_or(Pose{}));
  std::string text = fmt::format("{}\n{}\n", cols, rows);
  append_row(text, {m[3], m[7], m[11]});
  for (std::size_t axis = 0; axis < 3; ++axis) append_row(text, {m[axis], m[4 + axis], m[8 + axis]});
  for (std::size_t axis = 0; axis < 4; ++axis)
    append_row(text, {m[axis], m[4 + axis], m[8 + axis], axis == 3 ? 1.0 : 0.0});
  return text;
}

void append_scan(OutputFile& out, const ScanStream& scan) {
  const bool organised = scan.head().organised();
  const std::string head = organised ? header(scan.head(), static_cast<std::uint64_t>(scan.head().grid_cols),
                                              static_cast<std::uint64_t>(scan.head().grid_rows))
                                     : header(scan.head(), scan.count(), 1);
  out.write(head.data(), head.size());
  const IntensityMap map = map_intensity(scan, kPtxIntensity);
  const auto append = [&](const SampleBlock& block, std::size_t i, std::string& text) {
    if (!block.node.empty() && block.node[i] == Scan::kNoNode) {
      text += block.rgb.empty() ? "0 0 0 0\n" : "0 0 0 0 0 0 0\n";
      return;
    }
    append_point(text, block, i);
    text += ' ';
    append_number(text, block.intensity.empty() ? 0.0f : static_cast<float>(map(block.intensity[i])));
    if (!block.rgb.empty()) append_colour(text, block.rgb[i]);
    text += '\n';
  };
  if (!organised) return write_blocks(out, scan, append);
  for_each_node_block(scan, true, [&](const SampleBlock& block) {
    write_records(out, block.size(), [&](std::size_t i, std::string& text) { append(block, i, text); });
  });
}

}  // namespace

void write_ptx(const std::filesystem::path& file, const ScanSource& next) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    while (const auto scan = next()) {
      if (scan->count() == 0)
        fail_input(
            "{}: scan {}: expected at least one sample, found none: PTX holds no empty scans; leave it out",
            file.string(), scan->head().name);
      append_scan(out, *scan);
    }
    out.close();
  });
}

}  // namespace hybrid::io
