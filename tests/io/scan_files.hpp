#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "io/files.hpp"
#include "io/scan_samples.hpp"

namespace hybrid::testing {

// A folder of its own, with a blank and letters outside ASCII in its name, removed at the end.
class ScanFolder {
 public:
  ScanFolder() {
    static int counter = 0;
    path_ = std::filesystem::temp_directory_path() /
            fmt::format("hybrid scans \xc3\xa9\xe8\xb7\xaf {} {}", getpid(), counter++);
    std::filesystem::create_directories(path_);
  }
  ~ScanFolder() { std::filesystem::remove_all(path_); }
  ScanFolder(const ScanFolder&) = delete;
  ScanFolder& operator=(const ScanFolder&) = delete;

  std::filesystem::path path(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

 private:
  std::filesystem::path path_;
};

// body() throws ErrorKind::input, and its message has every one of `parts`.
inline void expect_input_error(const std::function<void()>& body, const std::vector<std::string>& parts) {
  try {
    body();
    ADD_FAILURE() << "expected an error with " << parts.back();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    for (const std::string& part : parts)
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << "expected \"" << part << "\" in: " << error.what();
  }
}

}  // namespace hybrid::testing
