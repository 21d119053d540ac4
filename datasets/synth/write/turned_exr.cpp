#include "write/turned_exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfThreading.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "write/exr_stream.hpp"

namespace synth {
namespace {

constexpr std::size_t kTile = 256, kTilesAtATime = 8, kColumnsAtATime = 16;

std::size_t side(int first, int last) {
  return static_cast<std::size_t>(last - first) + 1;
}

}  // namespace

TurnedExr::TurnedExr(const std::filesystem::path& path, const Imf::Header& header, std::size_t record_bytes,
                     const std::vector<Channel>& channels)
    : path_(path),
      header_(header),
      channels_(channels),
      record_bytes_(record_bytes),
      rows_(side(header.dataWindow().min.y, header.dataWindow().max.y)),
      columns_(side(header.dataWindow().min.x, header.dataWindow().max.x)),
      bands_((rows_ + kTile - 1) / kTile),
      file_(path.string() + ".pixels") {
  header_.compression() = Imf::PIZ_COMPRESSION;
  header_.setTileDescription(Imf::TileDescription(kTile, kTile));
  for (const Channel& channel : channels_)
    header_.channels().insert(channel.name, Imf::Channel(channel.type));
}

std::size_t TurnedExr::band_rows(std::size_t band) const {
  return std::min(kTile, rows_ - band * kTile);
}

void TurnedExr::add_column(const void* records) {
  const auto* bytes = static_cast<const char*>(records);
  waiting_.insert(waiting_.end(), bytes, bytes + rows_ * record_bytes_);
  if (waiting_.size() == kColumnsAtATime * rows_ * record_bytes_) spill();
}

// Band after band of 256 rows from the top; in a band, column after column; in a column, from the top: every
// tile lies in one piece.
void TurnedExr::spill() {
  const std::size_t columns = waiting_.size() / (rows_ * record_bytes_);
  std::vector<char> piece;
  for (std::size_t band = 0; band < bands_; ++band) {
    const std::size_t rows = band_rows(band), top = band * kTile;
    piece.resize(columns * rows * record_bytes_);
    for (std::size_t c = 0; c < columns; ++c)
      for (std::size_t r = 0; r < rows; ++r)
        std::memcpy(&piece[(c * rows + r) * record_bytes_],
                    &waiting_[(c * rows_ + rows_ - 1 - top - r) * record_bytes_], record_bytes_);
    file_.seek((top * columns_ + spilled_ * rows) * record_bytes_);
    file_.write(piece.data(), piece.size());
  }
  spilled_ += columns;
  waiting_.clear();
}

std::vector<char> TurnedExr::read_back(std::size_t band, std::size_t first_column, std::size_t columns) {
  const std::size_t rows = band_rows(band);
  std::vector<char> pixels(columns * rows * record_bytes_);
  spilled_file_.seekg(
      static_cast<std::streamoff>((band * kTile * columns_ + first_column * rows) * record_bytes_));
  spilled_file_.read(pixels.data(), static_cast<std::streamsize>(pixels.size()));
  if (!spilled_file_) throw std::runtime_error("cannot read back " + file_.temporary().string());
  return pixels;
}

void TurnedExr::finish() {
  if (!waiting_.empty()) spill();
  if (spilled_ != columns_)
    throw std::logic_error(fmt::format("{}: {} columns of {}", path_.string(), spilled_, columns_));
  file_.flush();
  spilled_file_.open(file_.temporary(), std::ios::binary);
  const int threads = tbb::this_task_arena::max_concurrency();
  if (Imf::globalThreadCount() != threads) Imf::setGlobalThreadCount(threads);
  OutputFile file(path_);
  {
    ExrStream stream(file);
    Imf::TiledOutputFile image(stream, header_, threads);
    for (int tile_row = 0; tile_row < image.numYTiles(); ++tile_row)
      for (int tile = 0; tile < image.numXTiles(); tile += static_cast<int>(kTilesAtATime)) {
        const auto band = static_cast<std::size_t>(tile_row);
        const std::size_t first = static_cast<std::size_t>(tile) * kTile,
                          columns = std::min(kTilesAtATime * kTile, columns_ - first),
                          column_bytes = band_rows(band) * record_bytes_;
        const std::vector<char> pixels = read_back(band, first, columns);
        const Imath::V2i corner(static_cast<int>(first), tile_row * static_cast<int>(kTile));
        Imf::FrameBuffer buffer;
        for (const Channel& channel : channels_)
          buffer.insert(channel.name, Imf::Slice::Make(channel.type, pixels.data() + channel.offset, corner,
                                                       static_cast<std::int64_t>(columns),
                                                       static_cast<std::int64_t>(band_rows(band)),
                                                       column_bytes, record_bytes_));
        image.setFrameBuffer(buffer);
        image.writeTiles(tile, tile + static_cast<int>((columns - 1) / kTile), tile_row, tile_row);
      }
  }  // which writes the table of its tiles
  file.commit();
}

}  // namespace synth
