#pragma once
#include <filesystem>
#include <memory>

#include "io/e57/e57_source.hpp"

namespace hybrid::io {

// The point records of a LAS file as those of an E57 file, streamed: coordinates as the whole numbers that
// they are, with the file's scale and offset; intensity; colour; and what E57 has no name for as fields of
// the extension `las`, where any record has it set (las:classification, las:gpsTime, ...). Waveforms and
// extra bytes are named in dropped(). Reads the file once to know the least and greatest value of every
// field. Throws as read_las() does without salvage.
class LasAsE57 : public E57Source {
 public:
  explicit LasAsE57(const std::filesystem::path& file);
  ~LasAsE57() override;
  std::vector<char> blob(std::size_t part) const override;

 private:
  std::unique_ptr<E57RecordReader> open_stored(std::size_t part) const override;
  class Records;
  class Reader;
  std::shared_ptr<const Records> records_;
};

}  // namespace hybrid::io
