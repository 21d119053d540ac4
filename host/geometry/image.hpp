#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hybrid {

// Row-major, interleaved channels, row 0 at the top. T = std::uint8_t: sRGB-encoded; T = float: linear light
// or values.
template <typename T>
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<T> pixels;

  Image() = default;
  Image(int w, int h, int c, T value = T{})
      : width(w),
        height(h),
        channels(c),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c),
               value) {}

  T* at(int x, int y) { return pixels.data() + offset(x, y); }
  const T* at(int x, int y) const { return pixels.data() + offset(x, y); }

 private:
  std::size_t offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(channels);
  }
};

using Image8 = Image<std::uint8_t>;
using ImageF = Image<float>;

}  // namespace hybrid
