#include "io/exr_parts.hpp"

#include <ImfPartType.h>

#include <algorithm>

namespace hybrid::io {
namespace {

constexpr int kBandRows = 256;  // of every compression, a whole number of blocks of lines

int tile_rows(const Imf::Header& header) {
  return static_cast<int>(header.tileDescription().ySize);
}

// What a part reads of the buffer. Slices of other channels would be filled with zeros.
Imf::FrameBuffer only(const Imf::ChannelList& channels, const Imf::FrameBuffer& buffer) {
  Imf::FrameBuffer own;
  for (auto at = buffer.begin(); at != buffer.end(); ++at)
    if (channels.findChannel(at.name())) own.insert(at.name(), at.slice());
  return own;
}

}  // namespace

ExrParts::ExrParts(const std::filesystem::path& file, int threads)
    : file_(std::make_unique<Imf::MultiPartInputFile>(file.c_str(), threads)), header_(file_->header(0)) {
  first_ = header_.dataWindow().min.y;
  last_ = header_.dataWindow().max.y;
  band_rows_ = kBandRows;
  if (header_.hasTileDescription())
    band_rows_ = tile_rows(header_) * std::max(1, kBandRows / tile_rows(header_));
  Imf::ChannelList seen;
  for (int i = 0; i < file_->parts(); ++i) {
    const Imf::Header& header = file_->header(i);
    Part part;
    for (auto at = header.channels().begin(); at != header.channels().end(); ++at)
      if (!seen.findChannel(at.name())) {
        seen.insert(at.name(), at.channel());
        part.channels.insert(at.name(), at.channel());
      }
    // Tiles of several levels are read as lines: the library then takes the finest.
    if (header.hasTileDescription() && header.tileDescription().mode == Imf::ONE_LEVEL &&
        band_rows_ % tile_rows(header) == 0)
      part.tiles.emplace(*file_, i);
    else
      part.lines.emplace(*file_, i);
    if (header.compression() == Imf::PXR24_COMPRESSION) header_.compression() = Imf::PXR24_COMPRESSION;
    parts_.push_back(std::move(part));
  }
  header_.channels() = seen;
}

bool ExrParts::complete() const {
  for (int i = 0; i < file_->parts(); ++i)
    if (!file_->partComplete(i)) return false;
  return true;
}

void ExrParts::read(const Imf::FrameBuffer& buffer, int row, int count) {
  for (Part& part : parts_) {
    const Imf::FrameBuffer own = only(part.channels, buffer);
    if (own.begin() == own.end()) continue;
    if (part.tiles) {
      const int side = static_cast<int>(part.tiles->tileYSize());
      part.tiles->setFrameBuffer(own);
      part.tiles->readTiles(0, part.tiles->numXTiles() - 1, row / side, (row + count - 1) / side);
    } else {
      part.lines->setFrameBuffer(own);
      part.lines->readPixels(first_ + row, first_ + row + count - 1);
    }
  }
}

std::vector<Imf::Header> ExrPartsWriter::headers_of(const Imf::Header& header,
                                                    const std::vector<ExrPart>& parts) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : parts) {
    Imf::ChannelList channels;
    for (const std::string& name : part.channels)
      if (const Imf::Channel* channel = header.channels().findChannel(name)) channels.insert(name, *channel);
    if (channels.begin() == channels.end()) continue;
    Imf::Header own(header.displayWindow(), header.dataWindow());
    if (headers.empty()) own = header;
    own.setTileDescription(header.tileDescription());
    own.setName(part.name);
    own.setType(Imf::TILEDIMAGE);
    own.compression() = part.compression;
    own.channels() = channels;
    headers.push_back(own);
  }
  return headers;
}

ExrPartsWriter::ExrPartsWriter(Imf::OStream& stream, const Imf::Header& header,
                               const std::vector<ExrPart>& parts, int threads)
    : headers_(headers_of(header, parts)),
      file_(stream, headers_.data(), static_cast<int>(headers_.size()), false, threads) {
  for (std::size_t i = 0; i < headers_.size(); ++i) parts_.emplace_back(file_, static_cast<int>(i));
}

void ExrPartsWriter::write(const Imf::FrameBuffer& buffer, int row, int count) {
  for (Imf::TiledOutputPart& part : parts_) {
    const int side = static_cast<int>(part.tileYSize());
    part.setFrameBuffer(buffer);
    part.writeTiles(0, part.numXTiles() - 1, row / side, (row + count - 1) / side);
  }
}

}  // namespace hybrid::io
