#include "write/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
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

void write_bytes(const fs::path& path, const std::string& bytes) {
  const fs::path temporary =
      path.parent_path() / fmt::format(".tmp-{}-{}", ::getpid(), path.filename().string());
  try {
    errno = 0;
    std::ofstream file(temporary, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw std::system_error(errno != 0 ? errno : EIO, std::generic_category());
    fs::rename(temporary, path);
  } catch (const std::system_error& problem) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw std::system_error(problem.code(), fmt::format("writing {}", path.string()));
  }
}

}  // namespace synth
