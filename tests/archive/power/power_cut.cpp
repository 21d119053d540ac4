// A disk that forgets what was not brought to it, and a power cut at the n-th operation: preloaded into a
// program (LD_PRELOAD), it watches what the program and its children do below one folder.
//
//   POWER_FOLDER   the folder, absolute; all else is left alone
//   POWER_STATE    a folder for what the disk knows (below), outside of it
//   POWER_CUT_AT   before this operation (from 1, counted over all processes) the process group is killed; a
//                  write is torn in the middle first. 0: never
//   POWER_IGNORE   "files" or "folders": their fsync does nothing, as if the program had forgotten it
//
// Operations: creating, writing, truncating, renaming, linking and removing files, making and removing
// folders, fsync. Library calls inside the C library (stdio) are not seen; they only make fewer moments to
// choose from.
//
// What the disk knows, by the inode and its time of birth (numbers are used again):
//   state/operations        8 bytes: how many operations there have been
//   state/file-<id>         the file's bytes at its last fsync
//   state/folder-<id>       its entries at its last fsync: <kind f|d|l> <id> <name>\0, a link's target after
//   another \0
// A real fsync is left out: the machine stays on.
#include "power_cut.hpp"

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

struct Disk {
  std::string folder, state;
  unsigned long cut_at = 0;
  bool ignore_files = false, ignore_folders = false;
  std::atomic<unsigned long>* operations = nullptr;
};

template <typename F>
F real(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

int real_open(const char* path, int flags, mode_t mode = 0) {
  static const auto call = real<int (*)(const char*, int, ...)>("open");
  return call(path, flags, mode);
}
ssize_t real_write(int descriptor, const void* bytes, std::size_t count) {
  static const auto call = real<ssize_t (*)(int, const void*, std::size_t)>("write");
  return call(descriptor, bytes, count);
}

std::string environment(const char* name) {
  const char* const text = getenv(name);
  return text ? text : "";
}

const Disk& disk() {
  static const Disk made = [] {
    Disk disk;
    disk.folder = environment("POWER_FOLDER");
    disk.state = environment("POWER_STATE");
    disk.cut_at = strtoul(environment("POWER_CUT_AT").c_str(), nullptr, 10);
    disk.ignore_files = environment("POWER_IGNORE") == "files";
    disk.ignore_folders = environment("POWER_IGNORE") == "folders";
    if (disk.folder.empty()) return disk;
    const int descriptor = real_open((disk.state + "/operations").c_str(), O_RDWR | O_CLOEXEC);
    void* const shared =
        mmap(nullptr, sizeof(unsigned long), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    close(descriptor);
    if (shared == MAP_FAILED) abort();
    disk.operations = static_cast<std::atomic<unsigned long>*>(shared);
    return disk;
  }();
  return made;
}

bool is_below(const std::string& path) {
  const std::string& folder = disk().folder;
  return !folder.empty() && path.compare(0, folder.size(), folder) == 0 &&
         (path.size() == folder.size() || path[folder.size()] == '/');
}
bool watched(const char* path) {
  return path != nullptr && path[0] == '/' && is_below(path);
}
bool watched(int descriptor) {
  if (disk().folder.empty()) return false;
  char path[PATH_MAX];
  const auto length = readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path, sizeof path);
  return length > 0 && is_below(std::string(path, static_cast<std::size_t>(length)));
}

bool is_the_last() {
  return ++*disk().operations == disk().cut_at;
}
[[noreturn]] void cut() {
  kill(0, SIGKILL);
  for (;;) pause();
}
void operation() {
  if (is_the_last()) cut();
}

std::string read_all(int descriptor) {
  std::string bytes;
  char block[65536];
  off_t at = 0;
  for (ssize_t count; (count = pread(descriptor, block, sizeof block, at)) > 0; at += count)
    bytes.append(block, static_cast<std::size_t>(count));
  return bytes;
}

// The entries of a folder as the format above.
std::string list(const std::string& path) {
  std::string entries;
  DIR* const folder = opendir(path.c_str());
  if (!folder) return entries;
  while (const dirent* entry = readdir(folder)) {
    const std::string name = entry->d_name, file = path + "/" + name;
    if (name == "." || name == "..") continue;
    entries += power::describe(file);
  }
  closedir(folder);
  return entries;
}

// Another name first: a cut in the middle leaves what was known before.
void remember(const std::string& name, const std::string& bytes) {
  const std::string file = disk().state + "/" + name, temporary = file + "." + std::to_string(gettid());
  const int out = real_open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = real_write(out, bytes.data() + done, bytes.size() - done);
    if (count <= 0) abort();
    done += static_cast<std::size_t>(count);
  }
  close(out);
  static const auto move = real<int (*)(const char*, const char*)>("rename");
  if (move(temporary.c_str(), file.c_str()) != 0) abort();
}

int bring_to_disk(int descriptor) {
  operation();
  const std::string self = "/proc/self/fd/" + std::to_string(descriptor);
  char path[PATH_MAX];
  const auto length = readlink(self.c_str(), path, sizeof path);
  const std::string file(path, static_cast<std::size_t>(length > 0 ? length : 0));
  struct stat found {};
  if (fstat(descriptor, &found) != 0) return -1;
  if (S_ISDIR(found.st_mode)) {
    if (!disk().ignore_folders) remember("folder-" + power::id_of(file), list(file));
    return 0;
  }
  if (disk().ignore_files) return 0;
  const int in = real_open(self.c_str(), O_RDONLY | O_CLOEXEC);  // the program's may be for writing only
  if (in < 0) return -1;
  remember("file-" + power::id_of(file), read_all(in));
  close(in);
  return 0;
}

int open_watched(const char* name, const char* path, int flags, mode_t mode) {
  if ((flags & (O_CREAT | O_TRUNC)) != 0 && watched(path)) operation();
  return real<int (*)(const char*, int, ...)>(name)(path, flags, mode);
}
mode_t mode_of(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_watched("open", path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_watched("open64", path, flags, mode);
}

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  if (watched(descriptor) && is_the_last()) {
    real_write(descriptor, bytes, count / 2);
    cut();
  }
  return real_write(descriptor, bytes, count);
}
ssize_t writev(int descriptor, const iovec* parts, int count) {
  if (watched(descriptor)) operation();
  return real<ssize_t (*)(int, const iovec*, int)>("writev")(descriptor, parts, count);
}
int ftruncate(int descriptor, off_t size) noexcept {
  if (watched(descriptor)) operation();
  return real<int (*)(int, off_t)>("ftruncate")(descriptor, size);
}

int fsync(int descriptor) {
  if (watched(descriptor)) return bring_to_disk(descriptor);
  return real<int (*)(int)>("fsync")(descriptor);
}
int fdatasync(int descriptor) {
  if (watched(descriptor)) return bring_to_disk(descriptor);
  return real<int (*)(int)>("fdatasync")(descriptor);
}

int rename(const char* from, const char* to) noexcept {
  if (watched(to)) operation();
  return real<int (*)(const char*, const char*)>("rename")(from, to);
}
int symlink(const char* target, const char* path) noexcept {
  if (watched(path)) operation();
  return real<int (*)(const char*, const char*)>("symlink")(target, path);
}
int mkdir(const char* path, mode_t mode) noexcept {
  if (watched(path)) operation();
  return real<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}
int unlink(const char* path) noexcept {
  if (watched(path)) operation();
  return real<int (*)(const char*)>("unlink")(path);
}
int unlinkat(int folder, const char* path, int flags) noexcept {
  if (watched(folder)) operation();
  return real<int (*)(int, const char*, int)>("unlinkat")(folder, path, flags);
}
int remove(const char* path) noexcept {
  if (watched(path)) operation();
  return real<int (*)(const char*)>("remove")(path);
}

}  // extern "C"
