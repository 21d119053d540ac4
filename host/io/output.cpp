#include "io/output.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "io/output_file.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

// The folder's file system has no room left: tells a full disk from other failures of a writer that hides
// errno.
bool disk_is_full(const fs::path& folder) {
  std::error_code code;
  const auto space = fs::space(folder, code);
  return !code && space.available < 64 * 1024;
}

// A file in the making is called .part-<host>-<process>-<number><extension>, the host as a short hash.
constexpr std::string_view kPartMark = ".part-";

std::string host_hash() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return fmt::format("{:08x}", XXH3_64bits(name.data(), std::strlen(name.data())) & 0xffffffffu);
}

fs::path temporary_name(const fs::path& folder, const fs::path& extension) {
  static std::atomic<unsigned> counter{0};
  return folder /
         fmt::format("{}{}-{}-{}{}", kPartMark, host_hash(), getpid(), counter++, extension.string());
}

// What processes of this host that were killed in the middle of a write (kill -9, power cut) left in the
// folder. Another host's processes cannot be asked whether they live: theirs stays.
void remove_left_parts(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> done;
  const std::lock_guard lock(mutex);
  if (!done.insert(folder).second) return;
  const std::string own = std::string(kPartMark) + host_hash() + "-";
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(own)) continue;
    int process = 0;
    std::from_chars(name.data() + own.size(), name.data() + name.size(), process);
    if (process > 0 && kill(process, 0) != 0 && errno == ESRCH) fs::remove(entry.path(), code);
  }
}

// The folder of BroughtTogether, with a separator at its end; empty without one.
std::mutex brought_together_mutex;
std::string brought_together;

std::string absolute_folder(const fs::path& folder) {
  return (fs::absolute(folder) / "").lexically_normal().string();
}

bool is_brought_together(const fs::path& folder) {
  const std::lock_guard lock(brought_together_mutex);
  return !brought_together.empty() && absolute_folder(folder).starts_with(brought_together);
}

// A file that a library may have written and closed.
void bring_to_disk(const fs::path& temporary, const fs::path& file) {
  if (is_brought_together(file.parent_path())) return;
  const int descriptor = open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_output(file, errno);
  const int reason = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  if (reason != 0) fail_output(file, reason);
}

// The new name. Folders that cannot be read or synchronised (some network file systems) are left alone.
void bring_names_to_disk(const fs::path& folder) {
  if (is_brought_together(folder)) return;
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  const int reason = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  if (reason != 0 && reason != EINVAL) fail_output(folder, reason);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

const char* kind_of(const fs::file_status& status) {
  switch (status.type()) {
    case fs::file_type::directory:
      return "a folder";
    case fs::file_type::fifo:
      return "a pipe";
    case fs::file_type::socket:
      return "a socket";
    default:
      return "a device";
  }
}

}  // namespace

BroughtTogether::BroughtTogether(const fs::path& folder) {
  const std::lock_guard lock(brought_together_mutex);
  brought_together = absolute_folder(folder);
}
BroughtTogether::~BroughtTogether() {
  const std::lock_guard lock(brought_together_mutex);
  brought_together.clear();
}

void create_output_folder(const fs::path& folder) {
  std::error_code code;
  std::vector<fs::path> parents;  // of those that are not there yet
  for (fs::path made = fs::absolute(folder, code).lexically_normal(); !code && !fs::exists(made, code);
       made = parents.back())
    parents.push_back(made.parent_path());
  fs::create_directories(folder, code);
  if (!code)
    for (const auto& parent : parents) bring_names_to_disk(parent);
  if (code.value() == ENOSPC || code.value() == EDQUOT) fail_output(folder, code.value());
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown))
    fail(ErrorKind::failed, "{}: expected a writable output folder, found {}; choose another --out",
         folder.string(), code ? code.message() : "a file");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    fail(ErrorKind::failed,
         "{}: expected a writable output folder ({}); choose another --out or change its permissions",
         folder.string(), std::strerror(errno));
}

void write_atomically(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  check_interrupted();
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  create_output_folder(folder);
  remove_left_parts(folder);
  const fs::path temporary = temporary_name(folder, file.extension());
  std::error_code ignored;
  try {
    write(temporary);
    bring_to_disk(temporary, file);
    if (std::rename(temporary.c_str(), file.c_str()) != 0) fail_output(file, errno);
    bring_names_to_disk(folder);
  } catch (const std::exception& error) {
    const auto* known = dynamic_cast<const Error*>(&error);
    const std::string text = replaced(error.what(), temporary.string(), file.string());
    const bool full = disk_is_full(folder);
    fs::remove(temporary, ignored);
    if (known && known->kind() != ErrorKind::failed) throw Error(known->kind(), text);
    if (full)
      fail(ErrorKind::temporary, "{}: the disk is full; free space and run again ({})", file.string(), text);
    if (known) throw Error(known->kind(), text);
    fail(ErrorKind::failed, "{}: cannot write: {}", file.string(), text);
  }
}

void write_text(const fs::path& file, const std::string& text) {
  write_atomically(file, [&](const fs::path& temporary) {
    OutputFile out(temporary);
    out.write(text.data(), text.size());
    out.close();
  });
}

void check_readable(const fs::path& file) {
  std::error_code code;
  const auto status = fs::status(file, code);
  if (status.type() == fs::file_type::not_found)
    fail_input("{}: no such file; check the path", file.string());
  if (code) fail_input("{}: cannot be found ({}); check the path", file.string(), code.message());
  if (!fs::is_regular_file(status))
    fail_input("{}: expected a regular file, found {}; save it to a file first", file.string(),
               kind_of(status));
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
