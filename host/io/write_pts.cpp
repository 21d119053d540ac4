#include <cmath>

#include "io/intensity_map.hpp"
#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {

void write_pts(const std::filesystem::path& file, const ScanSource& next) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    while (const auto scan = next()) {
      const auto returns = returns_of(*scan);
      const IntensityMap map = map_intensity(*scan, kPtsIntensity);
      const std::string count = fmt::format("{}\n", returns.size());
      out.write(count.data(), count.size());
      write_records(out, returns.size(), [&](std::size_t i, std::string& text) {
        const std::size_t at = returns[i];
        append_point(text, *scan, at);
        if (!scan->intensity.empty()) text += fmt::format(" {}", std::lround(map(scan->intensity[at])));
        if (!scan->rgb.empty()) append_colour(text, scan->rgb[at]);
        text += '\n';
      });
    }
    out.close();
  });
}

}  // namespace hybrid::io
