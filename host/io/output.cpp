#include "io/output.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include "core/error.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

// The folder's file system still has room? Writers of libraries hide errno; this tells a full disk from other
// failures.
bool disk_is_full(const fs::path& folder) {
  std::error_code code;
  const auto space = fs::space(folder, code);
  return !code && space.available < 64 * 1024;
}

void create_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (!fs::is_directory(folder, code) || access(folder.c_str(), W_OK) != 0)
    fail(ErrorKind::failed,
         "{}: expected a writable output folder; choose another --out or change its permissions",
         folder.string());
}

void sync_file(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(ErrorKind::failed, "{}: {}", file.string(), std::strerror(errno));
  const int result = fsync(descriptor);
  const int reason = errno;
  close(descriptor);
  if (result != 0)
    fail(reason == ENOSPC ? ErrorKind::temporary : ErrorKind::failed, "{}: {}", file.string(),
         std::strerror(reason));
}

}  // namespace

void write_atomically(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  static std::atomic<unsigned> counter{0};
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  create_folder(folder);
  const fs::path temporary = folder / fmt::format(".{}.{}.{}{}", file.stem().string(), getpid(), counter++,
                                                  file.extension().string());
  std::error_code ignored;
  try {
    write(temporary);
    sync_file(temporary);
    fs::rename(temporary, file);
  } catch (const std::exception& error) {
    const bool full = disk_is_full(folder);
    fs::remove(temporary, ignored);
    if (full)
      fail(ErrorKind::temporary, "{}: the disk is full; free space and run again ({})", file.string(),
           error.what());
    if (auto known = dynamic_cast<const Error*>(&error)) throw Error(*known);
    fail(ErrorKind::failed, "{}: cannot write: {}", file.string(), error.what());
  }
}

void write_text(const fs::path& file, const std::string& text) {
  write_atomically(file, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.flush();
    if (!out) fail(ErrorKind::failed, "{}: cannot write {} bytes", file.string(), text.size());
  });
}

void check_readable(const fs::path& file) {
  std::error_code code;
  const auto status = fs::status(file, code);
  if (!fs::exists(status)) fail_input("{}: no such file; check the path", file.string());
  if (fs::is_directory(status)) fail_input("{}: expected a file, found a folder", file.string());
  if (!fs::is_regular_file(status))  // a pipe would be waited for
    fail_input("{}: expected a regular file, found a device or pipe; save it to a file first", file.string());
  if (access(file.c_str(), R_OK) != 0)
    fail_input("{}: cannot be read ({}); change its permissions", file.string(), std::strerror(errno));
}

std::string read_text(const fs::path& file) {
  check_readable(file);
  std::ifstream in(file, std::ios::binary);
  std::string text(static_cast<std::size_t>(fs::file_size(file)), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (static_cast<std::size_t>(in.gcount()) != text.size())
    fail_input("{}: expected {} bytes, could read {}", file.string(), text.size(), in.gcount());
  return text;
}

FileFingerprint fingerprint(const fs::path& file) {
  check_readable(file);
  std::ifstream in(file, std::ios::binary);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_128bits_reset(state.get());
  std::string block(1 << 20, '\0');
  FileFingerprint result;
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    XXH3_128bits_update(state.get(), block.data(), static_cast<std::size_t>(in.gcount()));
    result.bytes += static_cast<std::uintmax_t>(in.gcount());
  }
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  result.xxh3 = fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  return result;
}

}  // namespace hybrid::io
