#include <algorithm>
#include <cmath>

#include "io/intensity_map.hpp"
#include "io/las/las_crs.hpp"
#include "io/las/las_header.hpp"
#include "io/las/las_steps.hpp"
#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/text/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint16_t kWktIsUsed = 16;  // of the global encoding

struct Layout {
  bool wkt = false;  // LAS 1.4 with its point formats; else 1.2
  int format = 0;
  std::vector<CrsRecord> records;
};

Layout choose_layout(const ScanStream& stream) {
  const Scan& scan = stream.head();
  Layout layout;
  layout.records = scan.crs_records.empty() ? las_crs_records(scan.crs) : scan.crs_records;
  layout.wkt =
      std::any_of(layout.records.begin(), layout.records.end(), [](const auto& r) { return r.id == kWkt; });
  layout.format = layout.wkt ? (stream.has_colour() ? 7 : 6) : (stream.has_colour() ? 2 : 0);
  return layout;
}

void append_text(std::string& bytes, std::string text, std::size_t length) {
  text.resize(length, '\0');
  bytes += text;
}

std::string records_of(const Layout& layout) {
  std::string bytes;
  for (const CrsRecord& record : layout.records) {
    append_raw(bytes, std::uint16_t{0});
    append_text(bytes, kLasCrsUser, 16);
    append_raw(bytes, record.id);
    append_raw(bytes, static_cast<std::uint16_t>(record.bytes.size()));
    append_text(bytes, "coordinate system", 32);
    bytes += record.bytes;
  }
  return bytes;
}

// No dates: the same scan gives the same bytes.
std::string header(const Layout& layout, const LasSteps& steps, std::uint64_t points) {
  const std::string records = records_of(layout);
  const std::uint16_t header_bytes = layout.wkt ? 375 : 227;
  std::string bytes = "LASF";
  append_raw(bytes, std::uint16_t{0});  // file source
  append_raw(bytes, layout.wkt ? kWktIsUsed : std::uint16_t{0});
  append_text(bytes, "", 16);  // project
  bytes += '\1';
  bytes += layout.wkt ? '\4' : '\2';
  append_text(bytes, "conversion", 32);
  append_text(bytes, "hybrid", 32);
  append_raw(bytes, std::uint32_t{0});  // day and year
  append_raw(bytes, header_bytes);
  append_raw(bytes, static_cast<std::uint32_t>(header_bytes + records.size()));
  append_raw(bytes, static_cast<std::uint32_t>(layout.records.size()));
  bytes += static_cast<char>(layout.format);
  append_raw(bytes, static_cast<std::uint16_t>(las_point_format(layout.format).bytes));
  const auto few = static_cast<std::uint32_t>(layout.wkt ? 0 : points);
  append_raw(bytes, few);
  append_raw(bytes, few);  // first returns
  append_text(bytes, "", 16);
  for (int axis = 0; axis < 3; ++axis) append_raw(bytes, steps.scale[axis]);
  for (int axis = 0; axis < 3; ++axis) append_raw(bytes, steps.offset[axis]);
  for (int axis = 0; axis < 3; ++axis) {
    append_raw(bytes, steps.maximum[axis]);
    append_raw(bytes, steps.minimum[axis]);
  }
  if (layout.wkt) {
    append_text(bytes, "", 20);  // no waveforms, no extended records
    append_raw(bytes, points);
    append_raw(bytes, points);  // first returns
    append_text(bytes, "", 112);
  }
  return bytes + records;
}

}  // namespace

void write_las(const std::filesystem::path& file, const ScanSource& next) {
  const auto scan = next();
  if (!scan) return;
  const LasSteps& steps = scan->las_steps();
  const Layout layout = choose_layout(*scan);
  const LasPointFormat& format = las_point_format(layout.format);
  const IntensityMap map = map_intensity(*scan, kLasIntensity, true);
  const std::string head = header(layout, steps, scan->facts().returns);
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    out.write(head.data(), head.size());
    write_blocks(out, *scan, [&](const SampleBlock& block, std::size_t i, std::string& bytes) {
      if (!is_return(block.points[i])) return;
      const std::size_t start = bytes.size();
      const Vec3 point = block.exact_point(i);
      for (int axis = 0; axis < 3; ++axis) append_raw(bytes, steps.whole(point[axis], axis));
      const double intensity = block.intensity.empty() ? 0 : map(block.intensity[i]);
      append_raw(bytes, static_cast<std::uint16_t>(std::lround(std::clamp(intensity, 0.0, 65535.0))));
      bytes += layout.wkt ? '\x11' : '\x09';  // the first return of one
      bytes.resize(start + static_cast<std::size_t>(format.bytes), '\0');
      if (block.rgb.empty()) return;
      bytes.resize(start + static_cast<std::size_t>(format.red));
      for (const std::uint8_t value : block.rgb[i])
        append_raw(bytes, static_cast<std::uint16_t>(257 * value));
    });
    out.close();
  });
}

}  // namespace hybrid::io
