#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace hybrid::io {

// A file being written, every failure reported: standard streams and the destructors of libraries swallow
// what goes wrong when their last buffer is flushed, and a file cut short would count as complete. Throws
// as fail_output() does. Call close() at the end; without it the destructor leaves the file as it is.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* bytes, std::size_t count);
  // The next byte goes to `position`, from the start.
  void seek(std::uint64_t position);
  std::uint64_t position() const { return flushed_ + buffer_.size(); }
  // Flushes; write_atomically() brings the content to the disk. Throws also what an earlier write() threw, so
  // that an error which a library's destructor caught is not lost.
  void close();

 private:
  void flush();
  void write_through(const char* bytes, std::size_t count);
  [[noreturn]] void fail(int reason);

  std::filesystem::path file_;
  int descriptor_ = -1;
  int failure_ = 0;            // errno of the first failure
  std::uint64_t flushed_ = 0;  // position in the file of buffer_'s first byte
  std::vector<char> buffer_;
};

// Throws the error for a failed write with this errno: ErrorKind::temporary when the disk or quota is full
// (free space, run again), ErrorKind::failed otherwise, with the remedy.
[[noreturn]] void fail_output(const std::filesystem::path& file, int reason);

}  // namespace hybrid::io
