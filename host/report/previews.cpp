#include "report/previews.hpp"

#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "io/picture.hpp"

namespace hybrid::report {
namespace fs = std::filesystem;
namespace {

constexpr int kPreviewWidth = 1200, kQuality = 88;

// Linear light of a byte in steps of 2^-20: sums of whole numbers are the same in any order.
std::array<std::uint32_t, 256> light_of_bytes() {
  std::array<std::uint32_t, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] =
        static_cast<std::uint32_t>(std::lround(linear_from_srgb(static_cast<double>(i) / 255) * (1 << 20)));
  return light;
}

}  // namespace

Image8 shrink(const Image8& picture, int largest_width) {
  const int factor = (picture.width + largest_width - 1) / largest_width;
  if (factor <= 1) return picture;
  static const auto light = light_of_bytes();
  Image8 small((picture.width + factor - 1) / factor, (picture.height + factor - 1) / factor,
               picture.channels);
  parallel_for(static_cast<std::size_t>(small.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const int y_end = std::min((y + 1) * factor, picture.height);
    for (int x = 0; x < small.width; ++x) {
      const int x_end = std::min((x + 1) * factor, picture.width);
      std::array<std::uint64_t, 4> sum{};
      for (int v = y * factor; v < y_end; ++v)
        for (int u = x * factor; u < x_end; ++u)
          for (int k = 0; k < picture.channels; ++k)
            sum[static_cast<std::size_t>(k)] += light[picture.at(u, v)[k]];
      const double count = static_cast<double>(y_end - y * factor) * (x_end - x * factor) * (1 << 20);
      for (int k = 0; k < picture.channels; ++k)
        small.at(x, y)[k] =
            srgb_byte_from_linear(static_cast<double>(sum[static_cast<std::size_t>(k)]) / count);
    }
  });
  return small;
}

std::string write_preview(const fs::path& out, const std::string& picture) {
  std::error_code ignored;
  if (!fs::is_regular_file(out / picture, ignored)) return "";
  const std::string preview = "pictures/" + fs::path(picture).replace_extension(".jpg").generic_string();
  io::write_jpeg(out / "report" / preview, shrink(io::read_photograph(out / picture, 0, 0), kPreviewWidth),
                 kQuality);
  return preview;
}

}  // namespace hybrid::report
