#include "io/exr/exr_scan_band.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>

#include <algorithm>
#include <limits>
#include <span>

#include "core/error.hpp"

namespace hybrid::io {
namespace {

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
    found.notes.emplace_back("compression PXR24 kept 16 significant bits of every float: 0.1 mm at 8 m");
  found.mask = has_mask(file, header);
  found.source = has_whole(header, "source");
  found.intensity = has_whole(header, "intensity");
  found.colour = has_light(header, "R") && has_light(header, "G") && has_light(header, "B");
  if (!found.colour && (has_whole(header, "R") || has_whole(header, "G") || has_whole(header, "B")))
    found.notes.emplace_back("colours are not used: expected R, G and B as half or float, linear light");
  return found;
}

ExrScanBand::ExrScanBand(const ExrScanChannels& channels, const ExrParts& file)
    : channels_(channels),
      corner_(file.header().dataWindow().min),
      rows_(file.band_rows()),
      width_(static_cast<std::size_t>(file.cols())) {
  const std::size_t most = width_ * static_cast<std::size_t>(std::min(rows_, file.rows()));
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

void ExrScanBand::read(ExrParts& file, int first_row, int rows, bool checked) {
  file.read(buffer(first_row, rows), first_row, rows, checked);
}

std::uint64_t ExrScanBand::salvage(ExrParts& file, int first_row, int rows, std::string& problem) {
  for (auto* values : {&x, &y, &z, &range})
    std::ranges::fill(*values, std::numeric_limits<float>::quiet_NaN());
  std::ranges::fill(intensity, 0.0f);
  for (auto* values : {&mask, &source}) std::ranges::fill(*values, 0);
  std::ranges::fill(colour, half(0.0f));
  return file.salvage(buffer(first_row, rows), first_row, rows, problem);
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
