#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hybrid::testing {

// A part of a file replaced by another, which must be there exactly as given.
struct Edit {
  std::string from, to;
};

// A reader of files, and a small file that it accepts and that stops being acceptable wherever it is cut.
// The table of bad input, the mutations and the fuzz targets run over all rows.
struct ReaderRow {
  std::string name;
  std::filesystem::path file;  // the one that is damaged, in a folder that may hold others
  // The bytes of that file; writes the others.
  std::function<std::string(const std::filesystem::path& folder)> good{};
  // Reads, and tells in text every value that came of it, so that two results can be compared.
  std::function<std::string(const std::filesystem::path& file)> read{};

  bool free_name = true;              // the file may have any name with its extension
  bool text = false;                  // lines of UTF-8
  std::string header_end{};           // what ends the lines of a header before binary data
  std::size_t most_bytes = 16 << 20;  // that a single request for memory may have while refusing a file
  bool checked = true;                // bytes added here and there cannot pass unseen
  bool lone_cr = true;                // CR may end lines
  // What the damage of that name changes, where the format has such a thing; each must be refused.
  std::vector<Edit> counts_too_high{}, counts_too_low{}, absurd_sizes{}, non_finite{};
  std::optional<Edit> non_finite_no_return{};  // legal: becomes a no-return and a note
};

const std::vector<ReaderRow>& reader_table();

// `bytes` with the edit made; throws std::logic_error where `from` is not found.
std::string edited(std::string bytes, const Edit& edit);

}  // namespace hybrid::testing
