#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace score {

// Three values a pixel, rows from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgb;
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

// A PNG, JPEG or TIFF: sRGB-encoded, 0..255.
Picture read_picture(const std::filesystem::path& file);

// DIR/views/<name>.exr.
struct ViewResult {
  Picture linear;                       // light
  std::vector<std::uint32_t> id;        // 0: no surface
  std::vector<std::uint32_t> coverage;  // photographs that see the pixel's surface
  std::vector<std::uint32_t> best;      // the heaviest photograph's index; kNoPhotograph
  std::vector<float> depth_m;           // of the drawn surface, along the viewing axis; empty: not written
};
inline constexpr std::uint32_t kNoPhotograph = 0xffffffffu;
ViewResult read_view_result(const std::filesystem::path& file);

}  // namespace score
