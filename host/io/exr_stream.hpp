#pragma once
#include <ImfIO.h>

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
    if (std::string_view(bytes, static_cast<std::size_t>(count)) == placeholder) placeholder_at_ = tellp();
    file_.write(bytes, static_cast<std::size_t>(count));
  }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }
  void finish() { file_.close(); }

  // An attribute's text that is known only when all else is written: say it before, put another of its length
  // in its place after the library's output object has ended.
  std::string placeholder{};
  void replace_placeholder(const std::string& by) {
    seekp(placeholder_at_);
    write(by.data(), static_cast<int>(by.size()));
  }

 private:
  OutputFile file_;
  std::uint64_t placeholder_at_ = 0;
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
