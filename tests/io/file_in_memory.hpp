#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hybrid::testing {

// A file without a disk, rewritten thousands of times a second, under any name: a link to it.
class FileInMemory {
 public:
  explicit FileInMemory(const std::filesystem::path& link)
      : descriptor_(memfd_create("hybrid", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error("no file in memory");
    std::filesystem::remove(link);
    std::filesystem::create_directories(link.parent_path());
    std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(descriptor_), link);
  }
  ~FileInMemory() { close(descriptor_); }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;

  void write(std::string_view bytes) const {
    if (ftruncate(descriptor_, 0) != 0 ||
        pwrite(descriptor_, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
      throw std::runtime_error("cannot write a file in memory");
  }

 private:
  int descriptor_;
};

}  // namespace hybrid::testing
