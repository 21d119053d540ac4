#include "io/exr_parts.hpp"

#include <ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>
#include <new>

namespace hybrid::io {
namespace {

constexpr int kBandRows = 256;  // of every compression, a whole number of blocks of lines

// Of a part in tiles; 0 of one in lines, whatever its header says of tiles.
int tile_rows(const Imf::Header& header) {
  const bool tiled = header.hasType() ? Imf::isTiled(header.type()) : header.hasTileDescription();
  return tiled ? static_cast<int>(header.tileDescription().ySize) : 0;
}

// What a part reads of the buffer. Slices of other channels would be filled with zeros.
Imf::FrameBuffer only(const Imf::ChannelList& channels, const Imf::FrameBuffer& buffer) {
  Imf::FrameBuffer own;
  for (auto at = buffer.begin(); at != buffer.end(); ++at)
    if (channels.findChannel(at.name())) own.insert(at.name(), at.slice());
  return own;
}

}  // namespace

ExrParts::ExrParts(const std::filesystem::path& file, int threads) : path_(file), threads_(threads) {
  open();
}

void ExrParts::open() {
  parts_.clear();
  file_ = std::make_unique<Imf::MultiPartInputFile>(path_.c_str(), threads_);
  header_ = file_->header(0);
  first_ = header_.dataWindow().min.y;
  last_ = header_.dataWindow().max.y;
  band_rows_ = kBandRows;
  if (const int rows = tile_rows(header_); rows > 0) band_rows_ = rows * std::max(1, kBandRows / rows);
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
    const int rows = tile_rows(header);
    if (rows > 0 && band_rows_ % rows == 0 && header.tileDescription().mode == Imf::ONE_LEVEL)
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

std::uint64_t ExrParts::salvage(const Imf::FrameBuffer& buffer, int row, int count, std::string& problem) {
  std::vector<bool> lost(static_cast<std::size_t>(count) * static_cast<std::size_t>(cols()));
  open();  // a failure leaves the library's stream at its end
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Imf::FrameBuffer own = only(parts_[i].channels, buffer);
    if (own.begin() == own.end()) continue;
    // Rows [top, end) of columns [left, right), counted from the data window's corner.
    const auto attempt = [&](int top, int end, int left, int right, const auto& body) {
      try {
        body(parts_[i]);
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {
        open();
        if (problem.empty())
          problem = fmt::format("rows {} to {}, columns {} to {}: expected pixels, found damage ({})", top,
                                end - 1, left, right - 1, error.what());
        for (int r = top; r < end; ++r)
          for (int c = left; c < right; ++c)
            lost[static_cast<std::size_t>(r - row) * static_cast<std::size_t>(cols()) +
                 static_cast<std::size_t>(c)] = true;
      }
    };
    if (!parts_[i].tiles) {
      for (int r = row; r < row + count; ++r)
        attempt(r, r + 1, 0, cols(), [&](Part& part) {
          part.lines->setFrameBuffer(own);
          part.lines->readPixels(first_ + r, first_ + r);
        });
      continue;
    }
    const int high = static_cast<int>(parts_[i].tiles->tileYSize()),
              wide = static_cast<int>(parts_[i].tiles->tileXSize());
    for (int r = row; r < row + count; r += high)
      for (int c = 0; c < cols(); c += wide)
        attempt(r, std::min(r + high, row + count), c, std::min(c + wide, cols()), [&](Part& part) {
          part.tiles->setFrameBuffer(own);
          part.tiles->readTile(c / wide, r / high);
        });
  }
  return static_cast<std::uint64_t>(std::count(lost.begin(), lost.end(), true));
}

}  // namespace hybrid::io
