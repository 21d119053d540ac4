#pragma once
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <half.h>

#include <cstdint>
#include <string>
#include <vector>

#include "io/exr/exr_parts.hpp"
#include "io/exr/range_checksum.hpp"
#include "io/exr/range_exr_band.hpp"

namespace hybrid::io {

// Which channels of a range image by whatever program are there and used.
struct ExrScanChannels {
  bool points = false, range = false, mask = false, source = false, intensity = false, colour = false;
  std::vector<std::string> notes;  // channels that are there and cannot be used
};

// Throws ErrorKind::input naming the channel that is missing or of another kind than measurements need.
ExrScanChannels find_exr_scan_channels(const std::string& file, const Imf::Header& header);

// A band of rows in memory: whole rows of tiles, or whole blocks of lines.
class ExrScanBand {
 public:
  ExrScanBand(const ExrScanChannels& channels, const ExrParts& file);

  int rows() const { return rows_; }
  std::size_t index(int band_row, int col) const {
    return static_cast<std::size_t>(band_row) * width_ + static_cast<std::size_t>(col);
  }
  // As ExrParts::read().
  void read(ExrParts& file, int first_row, int rows, bool checked);
  // As ExrParts::salvage(); what cannot be read is NaN and empty.
  std::uint64_t salvage(ExrParts& file, int first_row, int rows, std::string& problem);
  // What was read last.
  void add_to(RangeChecksum& sum) const;

  // Of the channels that are there.
  std::vector<float> x, y, z, range, intensity;
  std::vector<std::uint32_t> mask, source;
  std::vector<half> colour;  // three per node

 private:
  Imf::FrameBuffer buffer(int first_row, int rows);

  ExrScanChannels channels_;
  Imath::V2i corner_;  // of the data window
  int rows_;
  std::size_t width_, count_ = 0;
};

}  // namespace hybrid::io
