#include "shared/range_exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

namespace hybrid::peers {
namespace {

// The part of the file that holds the channel.
int find_part(const Imf::MultiPartInputFile& file, const std::string& name, Imf::PixelType type) {
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Channel* channel = file.header(part).channels().findChannel(name.c_str());
    if (!channel) continue;
    if (channel->type != type)
      throw std::runtime_error("channel \"" + name + "\" has another type than expected");
    return part;
  }
  throw std::runtime_error("no channel \"" + name + "\"; expected a range.exr of hybrid planes");
}

RangeScan read(const std::filesystem::path& file) {
  Imf::MultiPartInputFile input(file.c_str());
  const auto window = input.header(0).dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1),
             height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
  RangeScan scan;
  scan.rows = static_cast<int>(height);
  scan.cols = static_cast<int>(width);
  std::vector<std::uint32_t> mask(width * height);
  std::map<int, Imf::FrameBuffer> pixels;  // of each part
  const auto add = [&](const char* name, Imf::PixelType type, void* data) {
    const int part = find_part(input, name, type);
    if (input.header(part).dataWindow() != window) throw std::runtime_error("parts of several sizes");
    // Slices count from pixel (0, 0), which the data window need not hold.
    char* origin =
        static_cast<char*>(data) - 4 * (window.min.x + static_cast<std::ptrdiff_t>(width) * window.min.y);
    pixels[part].insert(name, Imf::Slice(type, origin, 4, 4 * width));
  };
  const std::pair<const char*, std::vector<float>*> axes[] = {{"x", &scan.x}, {"y", &scan.y}, {"z", &scan.z}};
  for (const auto& [name, values] : axes) {
    values->resize(width * height);
    add(name, Imf::FLOAT, values->data());
  }
  add("mask", Imf::UINT, mask.data());
  for (const auto& [number, buffer] : pixels) {
    Imf::InputPart part(input, number);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
  }
  scan.mask.assign(mask.begin(), mask.end());
  return scan;
}

void empty_node(RangeScan& scan, std::size_t i) {
  scan.x[i] = scan.y[i] = scan.z[i] = std::numeric_limits<float>::quiet_NaN();
  scan.mask[i] = 0;
}

float range_m(const RangeScan& scan, std::size_t i) {
  return std::hypot(scan.x[i], scan.y[i], scan.z[i]);
}

void bridge(RangeScan& scan, std::size_t before, std::size_t after) {
  const float a = range_m(scan, before), b = range_m(scan, after);
  if (std::abs(a - b) > 0.05f * std::min(a, b)) return;
  for (std::size_t i = before + 1; i < after; ++i) {
    const float t = static_cast<float>(i - before) / static_cast<float>(after - before);
    for (auto* axis : {&scan.x, &scan.y, &scan.z})
      (*axis)[i] = (1 - t) * (*axis)[before] + t * (*axis)[after];
    scan.mask[i] = 2;
  }
}

}  // namespace

std::size_t RangeScan::measured() const {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
}

RangeScan read_range_exr(const std::filesystem::path& file) {
  try {
    return read(file);
  } catch (const std::exception& problem) {
    throw std::runtime_error(file.string() + ": " + problem.what());
  }
}

RangeScan with_holes(RangeScan scan) {
  for (std::size_t i = 0; i < scan.count(); ++i)
    if (scan.mask[i] != 1) empty_node(scan, i);
  return scan;
}

RangeScan with_holes_filled(RangeScan scan, int longest) {
  const auto cols = static_cast<std::size_t>(scan.cols);
  for (std::size_t row = 0; row < static_cast<std::size_t>(scan.rows); ++row) {
    std::size_t last = cols;  // column of the last valid node, cols = none yet
    for (std::size_t col = 0; col < cols; ++col) {
      if (scan.mask[row * cols + col] == 0) continue;
      if (last < cols && col - last > 1 && col - last <= static_cast<std::size_t>(longest) + 1)
        bridge(scan, row * cols + last, row * cols + col);
      last = col;
    }
  }
  return scan;
}

}  // namespace hybrid::peers
