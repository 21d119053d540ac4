#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace synth {

// Creates the folder and its parents; throws an error that names it when that, or writing into it, fails.
void make_folder(const std::filesystem::path&);

// Throws std::system_error (no space on device) when the disk that will hold `folder` has less room than
// `bytes`; writes nothing.
void check_free_space(const std::filesystem::path& folder, double bytes);

// A temporary file in the same folder, renamed by commit(): a reader never sees half a file. Goes away
// without commit(). Throws std::system_error with errno's reason.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path&);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* bytes, std::size_t count);
  void write(const std::string& bytes) { write(bytes.data(), bytes.size()); }
  std::uint64_t position();
  void seek(std::uint64_t position);
  void commit();
  const std::filesystem::path& temporary() const { return temporary_; }
  void flush();

 private:
  [[noreturn]] void fail();

  std::filesystem::path path_, temporary_;
  std::ofstream file_;
};

void write_bytes(const std::filesystem::path&, const std::string& bytes);

}  // namespace synth
