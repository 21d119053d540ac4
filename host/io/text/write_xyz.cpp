#include "io/output.hpp"
#include "io/record_blocks.hpp"
#include "io/text/sample_text.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {

void write_xyz(const std::filesystem::path& file, const ScanSource& next) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    const auto scan = next();
    const std::string names = std::string("//X Y Z") + (scan->has_intensity() ? " Intensity" : "") +
                              (scan->has_colour() ? " R G B" : "") + "\n";
    out.write(names.data(), names.size());
    write_blocks(out, *scan, [&](const SampleBlock& block, std::size_t i, std::string& text) {
      if (!is_return(block.points[i])) return;
      append_point(text, block, i);
      if (!block.intensity.empty()) {
        text += ' ';
        append_number(text, block.intensity[i]);
      }
      if (!block.rgb.empty()) append_colour(text, block.rgb[i]);
      text += '\n';
    });
    out.close();
  });
}

}  // namespace hybrid::io
