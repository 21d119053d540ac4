#include <cmath>
#include <limits>

#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::size_t nodes_of(const Scan& scan) {
  if (!scan.organised()) return scan.points.size();
  return static_cast<std::size_t>(scan.grid_rows) * static_cast<std::size_t>(scan.grid_cols);
}

bool holds_doubles(const Scan& scan) {
  return !scan.origin.isZero() || !scan.exact.empty();
}

std::string header(const Scan& scan) {
  const bool large = holds_doubles(scan), intensity = !scan.intensity.empty(), colour = !scan.rgb.empty();
  const int size = large ? 8 : 4;
  std::string fields = "FIELDS x y z", sizes = fmt::format("SIZE {} {} {}", size, size, size),
              types = "TYPE F F F", counts = "COUNT 1 1 1";
  const auto add = [&](bool there, const char* name, const char* type) {
    if (!there) return;
    fields += fmt::format(" {}", name);
    sizes += " 4";
    types += fmt::format(" {}", type);
    counts += " 1";
  };
  add(intensity, "intensity", "F");
  add(colour, "rgb", "U");
  const Pose pose = scan.world_from_scan.value_or(Pose{});
  std::string viewpoint = "VIEWPOINT";
  for (const double value : {pose.translation.x(), pose.translation.y(), pose.translation.z(),
                             pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z()}) {
    viewpoint += ' ';
    append_number(viewpoint, value);
  }
  const bool organised = scan.organised();
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT {}\n{}\n"
      "POINTS {}\nDATA binary\n",
      fields, sizes, types, counts, organised ? static_cast<std::size_t>(scan.grid_cols) : scan.points.size(),
      organised ? scan.grid_rows : 1, viewpoint, nodes_of(scan));
}

}  // namespace

void write_pcd(const std::filesystem::path& file, const ScanSource& next) {
  const auto scan = next();
  if (!scan) return;
  const std::string head = header(*scan);
  const bool large = holds_doubles(*scan);
  const auto cols = static_cast<std::size_t>(scan->grid_cols);
  const GridSamples grid(*scan);
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    out.write(head.data(), head.size());
    write_records(out, nodes_of(*scan), [&](std::size_t i, std::string& bytes) {
      const std::size_t at =
          scan->organised() ? grid.at(static_cast<int>(i / cols), static_cast<int>(i % cols)) : i;
      const bool there = at != Scan::kNoNode;
      const auto point = there ? scan->points[at] : std::array{kNaN, kNaN, kNaN};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (large && there && is_return(point))
          append_raw(bytes, scan->exact_point(at)[static_cast<int>(axis)]);
        else if (large)
          append_raw(bytes, std::numeric_limits<double>::quiet_NaN());
        else
          append_raw(bytes, point[axis]);
      }
      if (!scan->intensity.empty()) append_raw(bytes, there ? scan->intensity[at] : 0.0f);
      if (!scan->rgb.empty()) {
        const auto [red, green, blue] = there ? scan->rgb[at] : std::array<std::uint8_t, 3>{};
        append_raw(bytes, static_cast<std::uint32_t>(red << 16 | green << 8 | blue));
      }
    });
    out.close();
  });
}

}  // namespace hybrid::io
