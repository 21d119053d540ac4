#pragma once
#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "write/files.hpp"

namespace synth {

// A tiled EXR whose pixels come column by column, rising in each, while its tiles go row by row from the top.
// The pixels wait in a file beside it, in the order of the tiles, so that memory holds 16 columns, then eight
// tiles (16 MB), whatever the image's size.
class TurnedExr {
 public:
  struct Channel {
    std::string name;
    Imf::PixelType type;
    std::size_t offset;  // in the record of a pixel; 4 bytes
  };
  // `header` has the image's size and attributes; channels, tiles and compression are added.
  TurnedExr(const std::filesystem::path&, const Imf::Header& header, std::size_t record_bytes,
            const std::vector<Channel>& channels);

  // A record per row, the lowest first.
  void add_column(const void* records);
  // After as many columns as the image has.
  void finish();

 private:
  std::size_t band_rows(std::size_t band) const;
  void spill();
  std::vector<char> read_back(std::size_t band, std::size_t first_column, std::size_t columns);

  std::filesystem::path path_;
  Imf::Header header_;
  std::vector<Channel> channels_;
  std::size_t record_bytes_, rows_, columns_, bands_, spilled_ = 0;  // spilled_: columns
  std::vector<char> waiting_;
  OutputFile file_;  // never committed: goes away by itself
  std::ifstream spilled_file_;
};

}  // namespace synth
