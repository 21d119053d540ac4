#pragma once
#include <ImfIO.h>

#include <deque>
#include <string>
#include <string_view>

#include "io/output_file.hpp"

namespace hybrid::io {

// OpenEXR writing through an OutputFile. The library's own file stream loses errors: its output classes write
// the tile offsets in their destructors, which must not throw, and close the file without a look. Call
// write_exr_stream().
class ExrStream : public Imf::OStream {
 public:
  explicit ExrStream(const std::filesystem::path& file) : Imf::OStream(file.c_str()), file_(file) {}

  void write(const char bytes[], int count) override {
    for (Placeholder& one : placeholders_)
      if (std::string_view(bytes, static_cast<std::size_t>(count)) == one.text) one.at = tellp();
    file_.write(bytes, static_cast<std::size_t>(count));
  }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }
  void finish() { file_.close(); }

  // Texts of attributes that are known only when all else is written: say them before, each another, and put
  // others of their length in their places after the library's output object has ended.
  const std::string& add_placeholder(std::size_t length) {
    placeholders_.push_back({std::string(length, static_cast<char>('!' + placeholders_.size()))});
    return placeholders_.back().text;
  }
  void replace_placeholder(std::size_t number, const std::string& by) {
    seekp(placeholders_.at(number).at);
    file_.write(by.data(), by.size());
  }

 private:
  struct Placeholder {
    std::string text{};
    std::uint64_t at = 0;
  };
  OutputFile file_;
  std::deque<Placeholder> placeholders_{};
};

// Calls body(stream), in which the library's output object lives and dies; throws what went wrong with the
// file, which the library's worker threads only pass on as text.
template <typename Body>
void write_exr_stream(const std::filesystem::path& file, const Body& body) {
  ExrStream stream(file);
  try {
    body(stream);
  } catch (const std::exception&) {
    stream.finish();  // throws the file's own error, if it had one
    throw;
  }
  stream.finish();
}

}  // namespace hybrid::io
