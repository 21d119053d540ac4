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
#include <string>
#include <vector>

namespace hybrid::io {

// One flat image whose channels lie in one or several parts of an OpenEXR file, in tiles or scan lines, read
// as if they lay in one. Check the file with check_exr_header() first. Lets the library's exceptions pass.
class ExrParts {
 public:
  ExrParts(const std::filesystem::path& file, int threads);

  // The first part's attributes, every part's channels (of two with one name the first).
  const Imf::Header& header() const { return header_; }
  bool complete() const;
  int rows() const { return last_ - first_ + 1; }
  int cols() const { return header_.dataWindow().max.x - header_.dataWindow().min.x + 1; }
  // So many rows at once are read fastest: whole tiles or blocks of lines of the first part.
  int band_rows() const { return band_rows_; }
  // Fills the buffer's slices with rows from `row` on, counted from the top of the data window; `row` is a
  // multiple of band_rows(), and so is `count` but at the image's end.
  void read(const Imf::FrameBuffer& buffer, int row, int count);
  // The same of a damaged file, tile by tile or line by line. Leaves the slices of what cannot be read as
  // they are; returns how many nodes lack a channel, and in `problem` where the first lie and why.
  std::uint64_t salvage(const Imf::FrameBuffer& buffer, int row, int count, std::string& problem);

 private:
  void open();

  struct Part {
    Imf::ChannelList channels;
    std::optional<Imf::TiledInputPart> tiles;  // of tiles that fit into a band; else:
    std::optional<Imf::InputPart> lines;
  };
  std::filesystem::path path_;
  int threads_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  std::vector<Part> parts_;
  Imf::Header header_;
  int first_ = 0, last_ = 0, band_rows_ = 0;
};

}  // namespace hybrid::io
