#pragma once
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfTiledInputPart.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/exr/exr_chunks.hpp"
#include "io/exr/exr_header.hpp"

namespace hybrid::io {

// One flat image whose channels lie in one or several parts of an OpenEXR file, in tiles or scan lines, read
// as if they lay in one. Lets the library's exceptions pass.
class ExrParts {
 public:
  // Throws what check_exr_header() throws, too.
  ExrParts(const std::filesystem::path& file, int threads);

  // The first part's attributes, every part's channels (of two with one name the first).
  const Imf::Header& header() const { return header_; }
  bool complete() const;
  int rows() const { return last_ - first_ + 1; }
  int cols() const { return cols_; }
  // So many rows at once are read fastest: whole tiles or blocks of lines of the first part.
  int band_rows() const { return band_rows_; }
  // Fills the buffer's slices with rows from `row` on, counted from the top of the data window; `row` is a
  // multiple of band_rows(), and so is `count` but at the image's end. Uncompressed and deflated data are
  // unpacked here, in a fraction of the library's time. Throws std::runtime_error where the data of a tile or
  // block end too early; with `checked`, as a checksum will tell, of those that the library unpacks it does
  // not: then pixels are not what was written, nor the same each time.
  void read(const Imf::FrameBuffer& buffer, int row, int count, bool checked = false);
  // Throws as read() does.
  void check();
  // read() of a damaged file, tile by tile or block by block, each checked. Leaves the slices of what cannot
  // be read as they are; returns how many nodes lack a channel, and in `problem` where the first lie and why.
  std::uint64_t salvage(const Imf::FrameBuffer& buffer, int row, int count, std::string& problem);

 private:
  void open();

  struct Part {
    Imf::Header header;
    Imf::ChannelList channels;                 // that no part before it has
    std::optional<Imf::TiledInputPart> tiles;  // of tiles that fit into a band; else:
    std::optional<Imf::InputPart> lines;
  };
  struct Chunk {
    ExrChunkBox box;
    std::vector<char> bytes;
  };
  // Of tiles or blocks that have some of rows [row, end), columns [left, right), counted from the data
  // window's corner.
  std::vector<Chunk> chunks(Part& part, int row, int end, int left, int right);
  // Of a file that is not in parts: the library would give the next one in the file. `place`: the column, row
  // and level that a tile, or the first line that a block is to call its own.
  std::vector<char> chunk_bytes(std::size_t number, std::span<const std::int32_t> place) const;
  void find_chunks(const Imf::Header& header);
  std::vector<Chunk> chunks_of(std::size_t number, int row, int end, int left, int right);
  void check(std::size_t number, int row, int end, int left, int right);
  static bool puts(const Part& part, const Imf::FrameBuffer& own);
  std::string put(std::size_t number, const Imf::FrameBuffer& own, int row, int end, int left, int right);
  // Calls body(), which lets the library read: after a failure its stream stays at its end, so that the next
  // time the file is opened anew, and so are its parts.
  template <typename Body>
  void with_library(const Body& body);

  std::filesystem::path path_;
  InputFile input_;
  ExrHeaderFacts facts_;
  int threads_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  std::vector<Part> parts_;
  Imf::Header header_;
  std::vector<std::uint64_t> chunk_at_;  // of a file that is not in parts; 0: nowhere
  std::uint64_t head_bytes_ = 0;         // before a chunk's own
  int first_ = 0, last_ = 0, cols_ = 0, band_rows_ = 0;
  bool spent_ = false;  // the library's stream
};

}  // namespace hybrid::io
