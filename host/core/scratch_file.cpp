#include "core/scratch_file.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace hybrid {
namespace {

// Calls transfer(at, left, offset) until all bytes are through.
template <typename Byte, typename Transfer>
bool whole(std::uint64_t offset, std::span<Byte> bytes, const Transfer& transfer) {
  while (!bytes.empty()) {
    const ssize_t done = transfer(bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return true;
}

}  // namespace

int open_nameless_file(const std::string& folder) {
  int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) {  // a file system without such files
    std::string name = folder + "/memory-XXXXXX";
    file = mkostemp(name.data(), O_CLOEXEC);
    if (file >= 0) unlink(name.c_str());
  }
  return file;
}

std::filesystem::path scratch_folder() {
  const char* given = std::getenv("TMPDIR");
  return given != nullptr && *given != '\0' ? given : "/var/tmp";
}

std::unique_ptr<ScratchFile> ScratchFile::make(std::uint64_t bytes, const std::filesystem::path& folder) {
  struct statfs system = {};
  if (statfs(folder.c_str(), &system) != 0 || system.f_type == TMPFS_MAGIC || system.f_type == RAMFS_MAGIC)
    return nullptr;
  const std::uint64_t block = static_cast<std::uint64_t>(system.f_bsize);
  if (bytes / block > system.f_bavail / 4) return nullptr;
  const int descriptor = open_nameless_file(folder.string());
  return descriptor < 0 ? nullptr : std::unique_ptr<ScratchFile>(new ScratchFile(descriptor));
}

ScratchFile::~ScratchFile() {
  close(descriptor_);
}

bool ScratchFile::write(std::uint64_t offset, std::span<const char> bytes) noexcept {
  return whole(offset, bytes, [&](const char* from, std::size_t count, off_t at) {
    return pwrite(descriptor_, from, count, at);
  });
}

bool ScratchFile::read(std::uint64_t offset, std::span<char> bytes) const noexcept {
  return whole(offset, bytes,
               [&](char* to, std::size_t count, off_t at) { return pread(descriptor_, to, count, at); });
}

}  // namespace hybrid
