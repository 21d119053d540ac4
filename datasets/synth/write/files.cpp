#include "write/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

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

void write_by_rename(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path temporary =
      path.parent_path() / fmt::format(".tmp-{}-{}", ::getpid(), path.filename().string());
  try {
    write(temporary);
    fs::rename(temporary, path);
  } catch (const std::exception& problem) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw std::runtime_error(fmt::format("writing {}: {}", path.string(), problem.what()));
  }
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  write_by_rename(path, [&](const fs::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw std::runtime_error("the file could not be written whole; is the disk full?");
  });
}

}  // namespace synth
