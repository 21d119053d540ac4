#pragma once
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "io/reader_table.hpp"

namespace hybrid::testing {

// The rows of reader_table(), by kind.
std::vector<ReaderRow> scan_reader_rows();
std::vector<ReaderRow> text_reader_rows();
std::vector<ReaderRow> camera_reader_rows();
std::vector<ReaderRow> image_reader_rows();

// What rows are made of: a file that is always the same, files beside it, values told in text.

inline std::function<std::string(const std::filesystem::path&)> fixed_file(std::string bytes) {
  return [bytes = std::move(bytes)](const std::filesystem::path&) { return bytes; };
}

inline void write_file_beside(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

inline std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <typename Values>
void tell(std::string& text, const std::string& name, const Values& values) {
  text += name;
  for (const auto& value : values) text += fmt::format(" {}", value);
  text += '\n';
}

}  // namespace hybrid::testing
