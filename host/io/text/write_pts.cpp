#include <cmath>

#include "io/intensity_map.hpp"
#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/text/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {

void write_pts(const std::filesystem::path& file, const ScanSource& next) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    while (const auto scan = next()) {
      const IntensityMap map = map_intensity(*scan, kPtsIntensity, true);
      const std::string count = fmt::format("{}\n", scan->facts().returns);
      out.write(count.data(), count.size());
      write_blocks(out, *scan, [&](const SampleBlock& block, std::size_t i, std::string& text) {
        if (!is_return(block.points[i])) return;
        append_point(text, block, i);
        if (!block.intensity.empty()) text += fmt::format(" {}", std::lround(map(block.intensity[i])));
        if (!block.rgb.empty()) append_colour(text, block.rgb[i]);
        text += '\n';
      });
    }
    out.close();
  });
}

}  // namespace hybrid::io
