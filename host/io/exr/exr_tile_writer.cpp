#include "io/exr/exr_tile_writer.hpp"

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>
#include <libdeflate.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace hybrid::io {
namespace {

static_assert(std::endian::native == std::endian::little, "OpenEXR files are little-endian");

constexpr int kTileLevel = 1;                  // libdeflate's: what is left is mostly noise
constexpr std::size_t kLongestShortName = 31;  // of what is no file of long names

constexpr int kPerThread = 4;  // tiles in memory

using Bytes = std::vector<char>;

std::size_t bytes_of(Imf::PixelType type) {
  return type == Imf::HALF ? 2 : 4;
}

bool has_long_names(const Imf::Header& header) {
  for (auto at = header.begin(); at != header.end(); ++at)
    if (std::strlen(at.name()) > kLongestShortName ||
        std::strlen(at.attribute().typeName()) > kLongestShortName)
      return true;
  for (auto at = header.channels().begin(); at != header.channels().end(); ++at)
    if (std::strlen(at.name()) > kLongestShortName) return true;
  return false;
}

std::vector<Imf::Header> headers_of(const Imf::Header& header, const std::vector<ExrPart>& parts) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : parts) {
    Imf::ChannelList channels;
    for (const std::string& name : part.channels)
      if (const Imf::Channel* channel = header.channels().findChannel(name)) channels.insert(name, *channel);
    if (channels.begin() == channels.end()) continue;
    Imf::Header own(header.displayWindow(), header.dataWindow());
    if (headers.empty()) own = header;
    own.setTileDescription(header.tileDescription());
    own.setType(Imf::TILEDIMAGE);
    if (!part.name.empty()) own.setName(part.name);
    own.compression() = part.compression;
    own.channels() = channels;
    headers.push_back(own);
  }
  return headers;
}

void write_number(ExrStream& stream, std::uint32_t value) {
  stream.write(reinterpret_cast<const char*>(&value), sizeof value);
}

// As OpenEXR has it before deflating: the even bytes before the odd ones, then each as the difference to the
// one before.
Bytes predicted(std::span<const char> pixels) {
  Bytes apart(pixels.size()), result(pixels.size());
  const std::size_t even = (pixels.size() + 1) / 2;
  for (std::size_t i = 0; i < even; ++i) apart[i] = pixels[2 * i];
  for (std::size_t i = even; i < pixels.size(); ++i) apart[i] = pixels[2 * (i - even) + 1];
  result[0] = apart[0];
  for (std::size_t i = 1; i < result.size(); ++i)
    result[i] = static_cast<char>(apart[i] - apart[i - 1] + 128);
  return result;
}

// What follows the head of so many bytes, deflated where that is shorter.
void deflate(Bytes& chunk, std::size_t head) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(kTileLevel), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  const Bytes pixels = predicted(std::span(chunk).subspan(head));
  Bytes shorter(pixels.size() - 1);
  const std::size_t size = libdeflate_zlib_compress(compressor.get(), pixels.data(), pixels.size(),
                                                    shorter.data(), shorter.size());
  if (size == 0) return;
  chunk.resize(head);
  chunk.insert(chunk.end(), shorter.begin(), shorter.begin() + static_cast<std::ptrdiff_t>(size));
}

}  // namespace

ExrTileWriter::ExrTileWriter(ExrStream& stream, const Imf::Header& header, const std::vector<ExrPart>& parts)
    : stream_(stream), side_(static_cast<int>(header.tileDescription().ySize)) {
  const Imath::Box2i& window = header.dataWindow();
  const auto tiles = [&](int size) { return (size + side_ - 1) / side_; };
  across_ = tiles(window.max.x - window.min.x + 1);
  const int count = across_ * tiles(window.max.y - window.min.y + 1);
  std::vector<Imf::Header> headers = headers_of(header, parts);
  const bool many = headers.size() > 1;
  std::uint32_t version = Imf::EXR_VERSION | (many ? Imf::MULTI_PART_FILE_FLAG : Imf::TILED_FLAG);
  for (Imf::Header& own : headers) {
    if (many) own.setChunkCount(count);
    own.sanityCheck(true, many);
    if (has_long_names(own)) version |= Imf::LONG_NAMES_FLAG;
    parts_.push_back({std::move(own), std::vector<std::uint64_t>(static_cast<std::size_t>(count), 0)});
  }
  write_number(stream_, Imf::MAGIC);
  write_number(stream_, version);
  for (const Part& part : parts_) part.header.writeTo(stream_, true);
  if (many) stream_.write("", 1);  // no more headers
  table_at_ = stream_.tellp();
  write_table();
}

void ExrTileWriter::write_table() {
  for (const Part& part : parts_)
    stream_.write(reinterpret_cast<const char*>(part.tile_at.data()),
                  static_cast<int>(part.tile_at.size() * sizeof part.tile_at[0]));
}

void ExrTileWriter::finish() {
  stream_.seekp(table_at_);
  write_table();
}

Bytes ExrTileWriter::encode(const Imf::FrameBuffer& buffer, const Tile& tile) const {
  const Imf::Header& header = parts_[tile.part].header;
  const Imath::Box2i& window = header.dataWindow();
  const int left = window.min.x + tile.x * side_, top = window.min.y + tile.y * side_,
            right = std::min(left + side_ - 1, window.max.x),
            bottom = std::min(top + side_ - 1, window.max.y);
  // Part, tile, level, size, of which the first only where there are several.
  const std::array<std::int32_t, 6> numbers = {static_cast<int>(tile.part), tile.x, tile.y, 0, 0, 0};
  const std::size_t without = of_parts() ? 0 : 1, head = (numbers.size() - without) * sizeof numbers[0];
  Bytes chunk(head);
  std::memcpy(chunk.data(), &numbers[without], head);
  const auto cols = static_cast<std::size_t>(right - left + 1);
  for (int y = top; y <= bottom; ++y)
    for (auto at = header.channels().begin(); at != header.channels().end(); ++at) {
      const Imf::Slice* slice = buffer.findSlice(at.name());
      if (slice == nullptr || slice->type != at.channel().type)
        fail(ErrorKind::failed, "{}: channel {}: no values of its type to write", stream_.fileName(),
             at.name());
      const std::size_t bytes = bytes_of(slice->type), begin = chunk.size();
      chunk.resize(begin + cols * bytes);
      const char* from = slice->base +
                         static_cast<std::ptrdiff_t>(left) * static_cast<std::ptrdiff_t>(slice->xStride) +
                         static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(slice->yStride);
      if (slice->xStride == bytes)
        std::memcpy(&chunk[begin], from, cols * bytes);
      else
        for (std::size_t x = 0; x < cols; ++x)
          std::memcpy(&chunk[begin + x * bytes], from + x * slice->xStride, bytes);
    }
  if (header.compression() == Imf::ZIP_COMPRESSION) deflate(chunk, head);
  const auto size = static_cast<std::int32_t>(chunk.size() - head);
  std::memcpy(&chunk[head - sizeof size], &size, sizeof size);
  return chunk;
}

void ExrTileWriter::write(const Imf::FrameBuffer& buffer, int row, int count) {
  std::vector<Tile> tiles;
  for (std::size_t part = 0; part < parts_.size(); ++part)
    for (int y = row / side_; y * side_ < row + count; ++y)
      for (int x = 0; x < across_; ++x) tiles.push_back({part, x, y});
  // By tile, those being written only: what a pipeline passes on is lost for good when a write fails.
  std::vector<Bytes> chunks(tiles.size());
  std::size_t next = 0;
  tbb::parallel_pipeline(
      static_cast<std::size_t>(kPerThread * thread_count()),
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
        if (next < tiles.size()) return next++;
        control.stop();
        return next;
      }) & tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, [&](std::size_t k) {
        chunks[k] = encode(buffer, tiles[k]);
        return k;
      }) & tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order, [&](std::size_t k) {
        const Tile& tile = tiles[k];
        const Bytes chunk = std::move(chunks[k]);
        parts_[tile.part].tile_at[static_cast<std::size_t>(tile.y * across_ + tile.x)] = stream_.tellp();
        stream_.write(chunk.data(), static_cast<int>(chunk.size()));
      }));
}

}  // namespace hybrid::io
