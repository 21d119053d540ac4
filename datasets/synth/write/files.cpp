#include "write/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace synth {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem)
    throw std::runtime_error(fmt::format("cannot create the folder {}: {}. Give another --out.",
                                         folder.string(), problem.message()));
  if (!fs::is_directory(folder))
    throw std::runtime_error(fmt::format("{} is a file, not a folder. Give another --out.", folder.string()));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw std::runtime_error(
        fmt::format("cannot write into the folder {}. Give another --out.", folder.string()));
}

void check_free_space(const fs::path& folder, double bytes) {
  fs::path there = fs::absolute(folder);
  std::error_code problem;
  while (!fs::exists(there, problem) && there.has_relative_path()) there = there.parent_path();
  const fs::space_info space = fs::space(there, problem);
  if (problem || static_cast<double>(space.available) >= bytes) return;
  throw std::system_error(
      ENOSPC, std::generic_category(),
      fmt::format("{}: what is to be made needs about {:.0f} MB, its disk has {:.0f} MB free",
                  folder.string(), bytes / 1e6, static_cast<double>(space.available) / 1e6));
}

OutputFile::OutputFile(const fs::path& path)
    : path_(path),
      temporary_(path.parent_path() / fmt::format(".tmp-{}-{}", ::getpid(), path.filename().string())) {
  errno = 0;
  file_.open(temporary_, std::ios::binary);
  if (!file_) fail();
}

OutputFile::~OutputFile() {
  if (temporary_.empty()) return;
  file_.close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void OutputFile::fail() {
  throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(),
                          fmt::format("writing {}", path_.string()));
}

void OutputFile::write(const void* bytes, std::size_t count) {
  errno = 0;
  file_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  if (!file_) fail();
}

std::uint64_t OutputFile::position() {
  return static_cast<std::uint64_t>(file_.tellp());
}

void OutputFile::seek(std::uint64_t position) {
  errno = 0;
  file_.seekp(static_cast<std::streamoff>(position));
  if (!file_) fail();
}

void OutputFile::flush() {
  errno = 0;
  file_.flush();
  if (!file_) fail();
}

void OutputFile::commit() {
  errno = 0;
  file_.close();
  if (!file_) fail();
  std::error_code problem;
  fs::rename(temporary_, path_, problem);
  if (problem) throw std::system_error(problem, fmt::format("writing {}", path_.string()));
  temporary_.clear();
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace synth
