#include <cmath>
#include <limits>

#include "io/node_blocks.hpp"
#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/text/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {
namespace {

std::uint64_t nodes_of(const ScanStream& scan) {
  if (!scan.head().organised()) return scan.count();
  return static_cast<std::uint64_t>(scan.head().grid_rows) *
         static_cast<std::uint64_t>(scan.head().grid_cols);
}

bool holds_doubles(const ScanStream& scan) {
  return !scan.head().origin.isZero() || scan.has_exact();
}

std::string header(const ScanStream& stream) {
  const Scan& scan = stream.head();
  const bool large = holds_doubles(stream), intensity = stream.has_intensity(), colour = stream.has_colour();
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
      fields, sizes, types, counts, organised ? static_cast<std::uint64_t>(scan.grid_cols) : stream.count(),
      organised ? scan.grid_rows : 1, viewpoint, nodes_of(stream));
}

}  // namespace

void write_pcd(const std::filesystem::path& file, const ScanSource& next) {
  const auto scan = next();
  if (!scan) return;
  const std::string head = header(*scan);
  const bool large = holds_doubles(*scan);
  const auto append = [&](const SampleBlock& block, std::size_t i, std::string& bytes) {
    const auto point = block.points[i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (large && is_return(point))
        append_raw(bytes, block.exact_point(i)[static_cast<int>(axis)]);
      else if (large)
        append_raw(bytes, std::numeric_limits<double>::quiet_NaN());
      else
        append_raw(bytes, point[axis]);
    }
    if (!block.intensity.empty()) append_raw(bytes, block.intensity[i]);
    if (!block.rgb.empty()) {
      const auto [red, green, blue] = block.rgb[i];
      append_raw(bytes, static_cast<std::uint32_t>(red << 16 | green << 8 | blue));
    }
  };
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    out.write(head.data(), head.size());
    if (!scan->head().organised())
      write_blocks(out, *scan, append);
    else
      for_each_node_block(*scan, false, [&](const SampleBlock& block) {
        write_records(out, block.size(), [&](std::size_t i, std::string& bytes) { append(block, i, bytes); });
      });
    out.close();
  });
}

}  // namespace hybrid::io
