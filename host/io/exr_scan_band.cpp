#include "io/exr_scan_band.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <span>

#include "core/error.hpp"
#include "io/exr_threads.hpp"

namespace hybrid::io {
namespace {

constexpr int kBandRows = 256;  // of every compression, a whole number of blocks of lines

const char* name_of(Imf::PixelType type) {
  return type == Imf::FLOAT ? "float" : type == Imf::HALF ? "half" : "uint";
}

// A channel of measurements, which half would coarsen: 11 bits are 4 mm at 8 m.
bool has_measurement(const std::string& file, const Imf::Header& header, const char* name) {
  const Imf::Channel* channel = header.channels().findChannel(name);
  if (!channel) return false;
  if (channel->type == Imf::HALF)
    fail_input(
        "{}: header: channel {}: expected 32-bit float, found half, whose 11 bits are 4 mm at 8 m; write it "
        "as float",
        file, name);
  if (channel->type != Imf::FLOAT || channel->xSampling != 1 || channel->ySampling != 1)
    fail_input(
        "{}: header: channel {}: expected float at every pixel, found {} at every {} x {}; write it as float",
        file, name, name_of(channel->type), channel->xSampling, channel->ySampling);
  return true;
}

// A channel that the library may convert.
bool has_whole(const Imf::Header& header, const char* name) {
  const Imf::Channel* channel = header.channels().findChannel(name);
  return channel && channel->xSampling == 1 && channel->ySampling == 1;
}

// Programs that convert whole numbers to reals scale them: a 1 is 2.3e-10 then.
bool has_mask(const std::string& file, const Imf::Header& header) {
  if (!has_whole(header, "mask")) return false;
  const Imf::PixelType type = header.channels().findChannel("mask")->type;
  if (type != Imf::UINT)
    fail_input("{}: header: channel mask: expected uint, found {}; write it as uint, or leave it out", file,
               name_of(type));
  return true;
}

bool has_light(const Imf::Header& header, const char* name) {
  return has_whole(header, name) && header.channels().findChannel(name)->type != Imf::UINT;
}

}  // namespace

ExrScanChannels find_exr_scan_channels(const std::string& file, const Imf::Header& header) {
  ExrScanChannels found;
  std::string present, missing;
  for (const char* name : {"x", "y", "z"})
    (has_measurement(file, header, name) ? present : missing) += std::string(" ") + name;
  found.points = missing.empty();
  found.range = has_measurement(file, header, "range");
  if (!found.points && !found.range)
    fail_input(
        "{}: header: expected the channel range (float, metres) or x y z (float, metres, scan frame), found "
        "no{}; "
        "is this a range image?",
        file, present.empty() ? " such channel" : missing);
  if (!found.points && !present.empty())
    found.notes.push_back("channel" + present + " without" + missing + ": not used, range is");
  if (header.compression() == Imf::PXR24_COMPRESSION)
    found.notes.push_back("compression PXR24 kept 16 significant bits of every float: 0.1 mm at 8 m");
  found.mask = has_mask(file, header);
  found.source = has_whole(header, "source");
  found.intensity = has_whole(header, "intensity");
  found.colour = has_light(header, "R") && has_light(header, "G") && has_light(header, "B");
  if (!found.colour && (has_whole(header, "R") || has_whole(header, "G") || has_whole(header, "B")))
    found.notes.push_back("colours are not used: expected R, G and B as half or float, linear light");
  return found;
}

ExrScanBand::ExrScanBand(const ExrScanChannels& channels, int cols, const Imf::Header& header)
    : channels_(channels),
      corner_(header.dataWindow().min),
      rows_(kBandRows),
      width_(static_cast<std::size_t>(cols)) {
  if (header.hasTileDescription()) {
    const int tile = static_cast<int>(header.tileDescription().ySize);
    rows_ = tile * std::max(1, kBandRows / tile);
  }
  const int height = header.dataWindow().max.y - corner_.y + 1;
  const std::size_t most = width_ * static_cast<std::size_t>(std::min(rows_, height));
  if (channels_.points)
    for (auto* values : {&x, &y, &z}) values->resize(most);
  if (channels_.range) range.resize(most);
  if (channels_.intensity) intensity.resize(most);
  if (channels_.mask) mask.resize(most);
  if (channels_.source) source.resize(most);
  if (channels_.colour) colour.resize(3 * most);
}

Imf::FrameBuffer ExrScanBand::buffer(int first_row, int rows) {
  count_ = width_ * static_cast<std::size_t>(rows);
  const Imath::V2i origin(corner_.x, corner_.y + first_row);
  Imf::FrameBuffer result;
  const auto add = [&](const char* name, Imf::PixelType type, void* at, std::size_t step) {
    result.insert(name, Imf::Slice::Make(type, at, origin, static_cast<std::int64_t>(width_), rows, step,
                                         step * width_));
  };
  if (channels_.points) {
    add("x", Imf::FLOAT, x.data(), 4);
    add("y", Imf::FLOAT, y.data(), 4);
    add("z", Imf::FLOAT, z.data(), 4);
  }
  if (channels_.range) add("range", Imf::FLOAT, range.data(), 4);
  if (channels_.intensity) add("intensity", Imf::FLOAT, intensity.data(), 4);
  if (channels_.mask) add("mask", Imf::UINT, mask.data(), 4);
  if (channels_.source) add("source", Imf::UINT, source.data(), 4);
  if (channels_.colour) {
    add("R", Imf::HALF, &colour[0], 3 * sizeof(half));
    add("G", Imf::HALF, &colour[1], 3 * sizeof(half));
    add("B", Imf::HALF, &colour[2], 3 * sizeof(half));
  }
  return result;
}

void ExrScanBand::read(Imf::InputFile& file, int first_row, int rows) {
  file.setFrameBuffer(buffer(first_row, rows));
  file.readPixels(corner_.y + first_row, corner_.y + first_row + rows - 1);
}

std::uint64_t ExrScanBand::salvage(const std::string& file, bool tiled, int first_row, int rows,
                                   std::string& problem) {
  for (auto* values : {&x, &y, &z, &range})
    std::ranges::fill(*values, std::numeric_limits<float>::quiet_NaN());
  std::ranges::fill(intensity, 0.0f);
  for (auto* values : {&mask, &source}) std::ranges::fill(*values, 0);
  std::ranges::fill(colour, half(0.0f));
  std::uint64_t lost = 0;
  // Opened again after each failure, which leaves the library's stream at its end.
  std::unique_ptr<Imf::InputFile> by_line;
  std::unique_ptr<Imf::TiledInputFile> by_tile;
  const auto open = [&] {
    if (tiled && !by_tile) {
      by_tile = std::make_unique<Imf::TiledInputFile>(file.c_str(), start_exr_threads());
      by_tile->setFrameBuffer(buffer(first_row, rows));
    } else if (!tiled && !by_line) {
      by_line = std::make_unique<Imf::InputFile>(file.c_str(), start_exr_threads());
      by_line->setFrameBuffer(buffer(first_row, rows));
    }
  };
  const auto attempt = [&](const Imath::Box2i& nodes, const auto& body) {
    try {
      open();
      body();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      by_line.reset();
      by_tile.reset();
      if (problem.empty())
        problem = fmt::format("rows {} to {}, columns {} to {}: expected pixels, found damage ({})",
                              nodes.min.y, nodes.max.y, nodes.min.x, nodes.max.x, error.what());
      lost += static_cast<std::uint64_t>(nodes.max.y - nodes.min.y + 1) *
              static_cast<std::uint64_t>(nodes.max.x - nodes.min.x + 1);
    }
  };
  const int cols = static_cast<int>(width_);
  if (!tiled) {
    for (int row = first_row; row < first_row + rows; ++row)
      attempt({{0, row}, {cols - 1, row}}, [&] { by_line->readPixels(corner_.y + row, corner_.y + row); });
    return lost;
  }
  open();
  const int high = static_cast<int>(by_tile->tileYSize()), wide = static_cast<int>(by_tile->tileXSize());
  for (int row = first_row; row < first_row + rows; row += high)
    for (int col = 0; col < cols; col += wide)
      attempt({{col, row}, {std::min(col + wide, cols) - 1, std::min(row + high, first_row + rows) - 1}},
              [&] { by_tile->readTile(col / wide, row / high); });
  return lost;
}

void ExrScanBand::add_to(RangeChecksum& sum) const {
  const auto part = [&](const auto& values, std::size_t per_node = 1) {
    return std::span(values).first(values.empty() ? 0 : per_node * count_);
  };
  sum.add(RangeChecksum::range, part(range));
  sum.add(RangeChecksum::x, part(x));
  sum.add(RangeChecksum::y, part(y));
  sum.add(RangeChecksum::z, part(z));
  sum.add(RangeChecksum::intensity, part(intensity));
  sum.add(RangeChecksum::source, part(source));
  std::vector<std::uint8_t> bytes(mask.empty() ? 0 : count_);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(mask[i]);
  sum.add(RangeChecksum::mask, std::span<const std::uint8_t>(bytes));
  bytes.resize(colour.empty() ? 0 : 3 * count_);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = srgb_byte(colour[i]);
  sum.add(RangeChecksum::colour, std::span<const std::uint8_t>(bytes));
}

}  // namespace hybrid::io
