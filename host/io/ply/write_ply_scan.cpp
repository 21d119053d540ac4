#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/text/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {

void write_ply_scan(const std::filesystem::path& file, const ScanSource& next) {
  const auto scan = next();
  if (!scan) return;
  const bool large = !scan->head().origin.isZero() || scan->has_exact();
  const char* real = large ? "double" : "float";
  std::string head =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", scan->facts().returns);
  for (const char axis : {'x', 'y', 'z'}) head += fmt::format("property {} {}\n", real, axis);
  if (scan->has_intensity()) head += "property float intensity\n";
  if (scan->has_colour()) head += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  head += "end_header\n";
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    out.write(head.data(), head.size());
    write_blocks(out, *scan, [&](const SampleBlock& block, std::size_t i, std::string& bytes) {
      if (!is_return(block.points[i])) return;
      if (large) {
        const Vec3 point = block.exact_point(i);
        for (int axis = 0; axis < 3; ++axis) append_raw(bytes, point[axis]);
      } else {
        append_raw(bytes, block.points[i]);
      }
      if (!block.intensity.empty()) append_raw(bytes, block.intensity[i]);
      if (!block.rgb.empty()) append_raw(bytes, block.rgb[i]);
    });
    out.close();
  });
}

}  // namespace hybrid::io
