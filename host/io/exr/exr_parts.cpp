#include "io/exr/exr_parts.hpp"

#include <ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>

#include "core/parallel.hpp"
#include "core/parallel_blocks.hpp"
#include "io/exr/exr_pixels.hpp"
#include "io/scalar_type.hpp"

namespace hybrid::io {
namespace {

constexpr int kLinesAtOnce = 256;  // of every compression, a whole number of blocks of lines

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

// Whether tiles or blocks of this part are ours to unpack.
bool ExrParts::puts(const Part& part, const Imf::FrameBuffer& own) {
  return (part.tiles || tile_rows(part.header) == 0) &&
         can_put_exr_pixels(part.header.compression(), part.header.channels(), own);
}

ExrParts::ExrParts(const std::filesystem::path& file, int threads)
    : path_(file), input_(file), facts_(check_exr_header(input_)), threads_(threads) {
  open();
  if (!facts_.several) find_chunks(parts_[0].header);
}

void ExrParts::open() {
  parts_.clear();
  file_ = std::make_unique<Imf::MultiPartInputFile>(path_.c_str(), threads_);
  header_ = file_->header(0);
  const Imath::Box2i window = header_.dataWindow();  // the library looks it up by its name each time
  first_ = window.min.y;
  last_ = window.max.y;
  cols_ = window.max.x - window.min.x + 1;
  band_rows_ = kLinesAtOnce;
  if (const int rows = tile_rows(header_); rows > 0) band_rows_ = rows * std::max(1, kLinesAtOnce / rows);
  Imf::ChannelList seen;
  for (int i = 0; i < file_->parts(); ++i) {
    const Imf::Header& header = file_->header(i);
    Part part;
    part.header = header;
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

// Of tiles those of the finest level, row by row. Where an offset is missing, as in a file whose writing was
// cut off, they are looked for one behind the other, as the library does.
void ExrParts::find_chunks(const Imf::Header& header) {
  const int high = tile_rows(header);
  const auto wide = high > 0 ? header.tileDescription().xSize : static_cast<unsigned>(cols());
  const auto step = static_cast<std::uint64_t>(high > 0 ? high : exr_block_lines(header.compression()));
  const auto across = static_cast<std::uint64_t>(cols() - 1) / wide + 1,
             down = static_cast<std::uint64_t>(rows() - 1) / step + 1;
  head_bytes_ = high > 0 ? 20 : 8;  // column, row and two numbers of the level, or the first line; size
  const auto fits = [&](std::uint64_t at, std::uint64_t bytes) {
    return at > 0 && at <= input_.size() && bytes <= input_.size() - at;
  };
  chunk_at_.resize(across * down);
  bool all = true;
  for (std::size_t i = 0; i < chunk_at_.size(); ++i) {
    const std::uint64_t entry = facts_.end + 8 * i;
    if (fits(entry, 8)) chunk_at_[i] = load_as<std::uint64_t>(input_.at(entry, 8), false);
    all &= chunk_at_[i] != 0;
  }
  if (all || (high > 0 && header.tileDescription().mode != Imf::ONE_LEVEL)) return;
  std::ranges::fill(chunk_at_, 0);
  for (std::uint64_t at = facts_.end + 8 * chunk_at_.size(); fits(at, head_bytes_);) {
    const auto number = [&](std::uint64_t k) {
      return load_as<std::int32_t>(input_.at(at + 4 * k, 4), false);
    };
    const std::int64_t column = high > 0 ? number(0) : 0, size = number(head_bytes_ / 4 - 1),
                       row = high > 0 ? number(1)
                             : number(0) < first_
                                 ? -1
                                 : (std::int64_t{number(0)} - first_) / static_cast<std::int64_t>(step);
    if (column < 0 || row < 0 || size < 0 || (high > 0 && (number(2) != 0 || number(3) != 0)) ||
        static_cast<std::uint64_t>(column) >= across || static_cast<std::uint64_t>(row) >= down)
      return;
    chunk_at_[static_cast<std::uint64_t>(row) * across + static_cast<std::uint64_t>(column)] = at;
    at += head_bytes_ + static_cast<std::uint64_t>(size);
  }
}

std::vector<char> ExrParts::chunk_bytes(std::size_t number, std::span<const std::int32_t> place) const {
  const std::uint64_t at = chunk_at_.at(number), end = input_.size();
  if (at == 0 || at > end || end - at < head_bytes_) throw std::runtime_error("a tile or block is missing");
  std::vector<char> head(head_bytes_);
  input_.read(at, head);
  const auto field = [&](std::size_t k) { return load_as<std::int32_t>(head.data() + 4 * k, false); };
  for (std::size_t k = 0; k < place.size(); ++k)
    if (field(k) != place[k])
      throw std::runtime_error(
          fmt::format("a tile or block calls itself {} where {} is expected", field(k), place[k]));
  const std::int32_t size = field(place.size());
  if (size < 0 || static_cast<std::uint64_t>(size) > end - at - head_bytes_)
    throw std::runtime_error("a tile or block reaches beyond the end of file");
  std::vector<char> bytes(static_cast<std::size_t>(size));
  input_.read(at + head_bytes_, bytes);
  return bytes;
}

std::vector<ExrParts::Chunk> ExrParts::chunks(Part& part, int row, int end, int left, int right) {
  std::vector<Chunk> found;
  const Imath::Box2i window = part.header.dataWindow();
  const bool tiled = tile_rows(part.header) > 0;
  const int high = tiled ? tile_rows(part.header) : exr_block_lines(part.header.compression()),
            wide = tiled ? static_cast<int>(part.header.tileDescription().xSize) : cols(),
            across = (cols() - 1) / wide + 1;
  for (int r = row / high; r * high < end; ++r)
    for (int c = left / wide; c * wide < right; ++c) {
      const int x = window.min.x + c * wide, y = window.min.y + r * high;
      Chunk chunk{{x, y, std::min(x + wide - 1, window.max.x), std::min(y + high - 1, window.max.y)}, {}};
      if (!facts_.several) {
        const std::size_t number =
            static_cast<std::size_t>(r) * static_cast<std::size_t>(across) + static_cast<std::size_t>(c);
        chunk.bytes =
            tiled ? chunk_bytes(number, std::array{c, r, 0, 0}) : chunk_bytes(number, std::array{y});
      } else {
        const char* bytes = nullptr;
        int size = 0, column = c, line = r, level_x = 0, level_y = 0;
        if (part.tiles)
          part.tiles->rawTileData(column, line, level_x, level_y, bytes, size);
        else if (tiled)
          part.lines->rawTileData(column, line, level_x, level_y, bytes, size);
        else
          part.lines->rawPixelData(y, bytes, size);
        chunk.bytes.assign(bytes, bytes + size);
      }
      found.push_back(std::move(chunk));
    }
  return found;
}

template <typename Body>
void ExrParts::with_library(const Body& body) {
  if (spent_) open();
  spent_ = true;
  body();
  spent_ = false;
}

std::vector<ExrParts::Chunk> ExrParts::chunks_of(std::size_t number, int row, int end, int left, int right) {
  if (!facts_.several) return chunks(parts_[number], row, end, left, right);
  std::vector<Chunk> those;
  with_library([&] { those = chunks(parts_[number], row, end, left, right); });
  return those;
}

void ExrParts::check(std::size_t number, int row, int end, int left, int right) {
  const auto those = chunks_of(number, row, end, left, right);
  const Part& part = parts_[number];
  std::vector<std::string> problems(those.size());
  parallel_for(those.size(), [&](std::size_t k) {
    problems[k] =
        exr_chunk_problem(part.header.compression(), part.header.channels(), those[k].box, those[k].bytes);
  });
  for (const std::string& problem : problems)
    if (!problem.empty()) throw std::runtime_error(problem);
}

void ExrParts::check() {
  for (int row = 0; row < rows(); row += band_rows())
    for (std::size_t i = 0; i < parts_.size(); ++i)
      check(i, row, std::min(row + band_rows(), rows()), 0, cols());
}

// Of the part's tiles or blocks as they lie in the file; "" where all of them are put.
std::string ExrParts::put(std::size_t number, const Imf::FrameBuffer& own, int row, int end, int left,
                          int right) {
  const Part& part = parts_[number];
  const auto those = chunks_of(number, row, end, left, right);
  std::vector<std::string> problems(those.size());
  for_blocks(those.size(), 1, [&](std::size_t, std::size_t begin, std::size_t stop) {
    std::vector<char> room;
    for (std::size_t k = begin; k < stop; ++k)
      problems[k] = put_exr_pixels(part.header.compression(), part.header.channels(), those[k].box,
                                   those[k].bytes, own, room);
  });
  for (const std::string& problem : problems)
    if (!problem.empty()) return problem;
  return {};
}

void ExrParts::read(const Imf::FrameBuffer& buffer, int row, int count, bool checked) {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Imf::FrameBuffer own = only(parts_[i].channels, buffer);
    if (own.begin() == own.end()) continue;
    if (puts(parts_[i], own)) {
      for (int top = row; top < row + count; top += band_rows_)
        if (const std::string problem = put(i, own, top, std::min(top + band_rows_, row + count), 0, cols());
            !problem.empty())
          throw std::runtime_error(problem);
      continue;
    }
    if (!checked) check(i, row, row + count, 0, cols());
    with_library([&] {
      Part& part = parts_[i];
      if (part.tiles) {
        const int side = static_cast<int>(part.tiles->tileYSize());
        part.tiles->setFrameBuffer(own);
        part.tiles->readTiles(0, part.tiles->numXTiles() - 1, row / side, (row + count - 1) / side);
      } else {
        part.lines->setFrameBuffer(own);
        part.lines->readPixels(first_ + row, first_ + row + count - 1);
      }
    });
  }
}

std::uint64_t ExrParts::salvage(const Imf::FrameBuffer& buffer, int row, int count, std::string& problem) {
  std::vector<bool> lost(static_cast<std::size_t>(count) * static_cast<std::size_t>(cols()));
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Imf::FrameBuffer own = only(parts_[i].channels, buffer);
    if (own.begin() == own.end()) continue;
    // Rows [top, end) of columns [left, right), counted from the data window's corner.
    const auto attempt = [&](int top, int end, int left, int right, const auto& body) {
      try {
        if (puts(parts_[i], own)) {
          if (const std::string damage = put(i, own, top, end, left, right); !damage.empty())
            throw std::runtime_error(damage);
          return;
        }
        check(i, top, end, left, right);
        with_library([&] { body(parts_[i]); });
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {
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
      // The lines of a block are lost together.
      const Imf::Header& header = parts_[i].header;
      const int high = tile_rows(header) > 0 ? 1 : exr_block_lines(header.compression());
      for (int r = row; r < row + count; r += high) {
        const int end = std::min(r + high, row + count);
        attempt(r, end, 0, cols(), [&](Part& part) {
          part.lines->setFrameBuffer(own);
          part.lines->readPixels(first_ + r, first_ + end - 1);
        });
      }
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
