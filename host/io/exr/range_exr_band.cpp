#include "io/exr/range_exr_band.hpp"

#include <algorithm>
#include <array>

#include "geometry/colour.hpp"

namespace hybrid::io {
namespace {

// sRGB bytes to linear half floats; a byte differs from its neighbours by more than half's resolution
// everywhere.
const std::array<half, 256>& linear_table() {
  static const auto table = [] {
    std::array<half, 256> result;
    std::ranges::copy(linear_of_bytes<float>(), result.begin());
    return result;
  }();
  return table;
}

// By the bits of a half.
const std::vector<std::uint8_t>& srgb_table() {
  static const auto table = [] {
    std::vector<std::uint8_t> result(1 << 16);
    for (std::size_t bits = 0; bits < result.size(); ++bits) {
      half linear;
      linear.setBits(static_cast<std::uint16_t>(bits));
      result[bits] = srgb_byte_from_linear(static_cast<double>(static_cast<float>(linear)));
    }
    return result;
  }();
  return table;
}

}  // namespace

std::uint8_t srgb_byte(half linear) {
  return srgb_table()[linear.bits()];
}

half linear_half(std::uint8_t srgb) {
  return linear_table()[srgb];
}

RangeExrBand::RangeExrBand(RangeImage& image)
    : image_(image), width_(static_cast<std::size_t>(image.cols)), mask_(width_ * kRangeTile_px) {
  if (!image.rgb.empty()) colour_.resize(3 * width_ * kRangeTile_px);
}

Imf::FrameBuffer RangeExrBand::slices(int first_row) {
  first_ = width_ * static_cast<std::size_t>(first_row);
  count_ = std::min(width_ * kRangeTile_px, image_.count() - first_);
  const Imath::V2i origin(0, first_row);
  const auto rows = static_cast<std::int64_t>(count_ / width_);
  Imf::FrameBuffer buffer;
  const auto add = [&](const char* name, Imf::PixelType type, const void* at, std::size_t step) {
    buffer.insert(name, Imf::Slice::Make(type, at, origin, image_.cols, rows, step, step * width_));
  };
  add("range", Imf::FLOAT, &image_.range_m[first_], 4);
  add("x", Imf::FLOAT, &image_.x[first_], 4);
  add("y", Imf::FLOAT, &image_.y[first_], 4);
  add("z", Imf::FLOAT, &image_.z[first_], 4);
  add("source", Imf::UINT, &image_.source[first_], 4);
  add("mask", Imf::UINT, mask_.data(), 4);
  if (!image_.intensity.empty()) add("intensity", Imf::FLOAT, &image_.intensity[first_], 4);
  if (!colour_.empty()) {
    add("R", Imf::HALF, &colour_[0], 3 * sizeof(half));
    add("G", Imf::HALF, &colour_[1], 3 * sizeof(half));
    add("B", Imf::HALF, &colour_[2], 3 * sizeof(half));
  }
  return buffer;
}

void RangeExrBand::take_from_image() {
  for (std::size_t i = 0; i < count_; ++i) mask_[i] = image_.mask[first_ + i];
  for (std::size_t i = 0; i < count_ && !colour_.empty(); ++i)
    for (std::size_t c = 0; c < 3; ++c) colour_[3 * i + c] = linear_table()[image_.rgb[first_ + i][c]];
}

void RangeExrBand::give_to_image() {
  for (std::size_t i = 0; i < count_; ++i) image_.mask[first_ + i] = static_cast<std::uint8_t>(mask_[i]);
  for (std::size_t i = 0; i < count_ && !colour_.empty(); ++i)
    for (std::size_t c = 0; c < 3; ++c) image_.rgb[first_ + i][c] = srgb_byte(colour_[3 * i + c]);
}

}  // namespace hybrid::io
