#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {

void write_ply_scan(const std::filesystem::path& file, const ScanSource& next) {
  const auto scan = next();
  if (!scan) return;
  const auto returns = returns_of(*scan);
  const bool large = !scan->origin.isZero() || !scan->exact.empty();
  const char* real = large ? "double" : "float";
  std::string head = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", returns.size());
  for (const char axis : {'x', 'y', 'z'}) head += fmt::format("property {} {}\n", real, axis);
  if (!scan->intensity.empty()) head += "property float intensity\n";
  if (!scan->rgb.empty()) head += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  head += "end_header\n";
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    out.write(head.data(), head.size());
    write_records(out, returns.size(), [&](std::size_t i, std::string& bytes) {
      const std::size_t at = returns[i];
      if (large) {
        const Vec3 point = scan->exact_point(at);
        for (int axis = 0; axis < 3; ++axis) append_raw(bytes, point[axis]);
      } else {
        append_raw(bytes, scan->points[at]);
      }
      if (!scan->intensity.empty()) append_raw(bytes, scan->intensity[at]);
      if (!scan->rgb.empty()) append_raw(bytes, scan->rgb[at]);
    });
    out.close();
  });
}

}  // namespace hybrid::io
