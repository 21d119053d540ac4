#pragma once
#include <ImfFrameBuffer.h>
#include <half.h>

#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"

namespace hybrid::io {

inline constexpr unsigned kRangeTile_px = 256;
inline constexpr int kRecordTile_px = static_cast<int>(kRangeTile_px);  // of records beside them

// sRGB, of linear light between 0 and 1.
std::uint8_t srgb_byte(half linear);
half linear_half(std::uint8_t srgb);  // which is that byte again

// The rows of one row of tiles on their way between a range image and a file: floats and ids go directly;
// mask and colour, whose types differ, through a buffer of that many rows.
class RangeExrBand {
 public:
  explicit RangeExrBand(RangeImage& image);

  // Moves to the band that starts at first_row. The slices hold until the next call.
  Imf::FrameBuffer slices(int first_row);
  void take_from_image();  // fills the buffer, before the band is written
  void give_to_image();    // from the buffer, after the band is read

 private:
  RangeImage& image_;
  std::size_t width_, first_ = 0, count_ = 0;  // samples
  std::vector<std::uint32_t> mask_;
  std::vector<half> colour_;
};

}  // namespace hybrid::io
