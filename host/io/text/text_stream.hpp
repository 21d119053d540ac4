#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/built_stream.hpp"
#include "io/input_file.hpp"
#include "io/text/number_rows.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {

// What the numbers of a line are: x y z [intensity] [red green blue].
struct TextColumns {
  std::size_t count = 3;
  bool intensity() const { return count == 4 || count == 7; }
  bool colour() const { return count >= 6; }
  ScanSample sample(const double* row) const {
    ScanSample sample{row[0], row[1], row[2], intensity() ? row[3] : 0, {}};
    if (colour()) sample.rgb = {row[count - 3], row[count - 2], row[count - 1]};
    return sample;
  }
};

// The samples of a scan in a text, one per line, streamed: parsed again at every pass, from places that the
// first pass remembers. In memory: what NumberRows has, one block, and 16 bytes per kBlock samples.
class TextStream : public BuiltStream {
 protected:
  // What the format makes of its lines.
  struct Lines {
    TextPlace start;
    std::uint64_t count = 0;
    std::size_t columns = 0;  // numbers on each
    bool intensity = false;
    ColourKind colour = ColourKind::none;
    bool zero_is_no_return = false;
  };
  TextStream(const std::filesystem::path& file, const ScanEntry& entry) : BuiltStream(entry), input_(file) {}

  InputFile& input() { return input_; }
  // Chooses the origin and measures all samples; to be called when the head has its grid. Throws for what is
  // no sample, as ScanBuilder does and read_line(). The notes of ScanBuilder.
  std::vector<std::string> take(const Lines& lines);
  // Of a line's numbers.
  virtual ScanSample sample(const double* row) const = 0;
  // The line at the cursor, which is no row of numbers that NumberRows reads: reads it or throws, the end of
  // the text too. `done`: samples before.
  virtual void read_line(TextCursor& cursor, std::span<double> values, std::uint64_t done) const = 0;
  bool commas_seen() const { return commas_; }
  TextPlace after() const { return after_; }  // the last sample

 private:
  void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const override;
  void seek(std::uint64_t first) const;  // to the last place before it
  template <typename Builder>
  void add_next(std::uint64_t count, Builder& builder) const;

  mutable InputFile input_;
  Lines lines_;
  TextPlace after_;
  mutable std::optional<NumberRows> rows_;
  mutable std::uint64_t next_ = 0;         // the sample that rows_ gives next
  mutable std::vector<TextPlace> places_;  // of samples 0, kBlock, 2 kBlock ...
  mutable bool commas_ = false;
};

}  // namespace hybrid::io
