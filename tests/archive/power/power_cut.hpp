#pragma once
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <climits>
#include <string>

// What the preloaded disk (power_cut.cpp) and the test that looks at it afterwards (power_disk.cpp) share.
namespace power {

// Inode and time of birth: two files never have the same. "" where there is nothing.
inline std::string id_of(const std::string& path) {
  struct statx found {};
  if (statx(AT_FDCWD, path.c_str(), AT_SYMLINK_NOFOLLOW, STATX_INO | STATX_BTIME | STATX_TYPE, &found) != 0)
    return "";
  return std::to_string(found.stx_ino) + "." + std::to_string(found.stx_btime.tv_sec) + "." +
         std::to_string(found.stx_btime.tv_nsec);
}

// An entry of a folder: <kind f|d|l> <id> <name>\0<target of a link>\0. Nothing for what is neither.
inline std::string describe(const std::string& path) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0) return "";
  const char kind = S_ISDIR(found.st_mode)   ? 'd'
                    : S_ISREG(found.st_mode) ? 'f'
                    : S_ISLNK(found.st_mode) ? 'l'
                                             : '?';
  if (kind == '?') return "";
  std::string target;
  if (kind == 'l') {
    char text[PATH_MAX];
    const auto length = readlink(path.c_str(), text, sizeof text);
    target.assign(text, static_cast<std::size_t>(length > 0 ? length : 0));
  }
  std::string entry = std::string(1, kind) + " " + id_of(path) + " " + path.substr(path.rfind('/') + 1);
  entry += '\0';
  entry += target;
  entry += '\0';
  return entry;
}

}  // namespace power
