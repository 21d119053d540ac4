#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace hybrid::peers {

// labels.exr as hybrid-score reads it: one uint channel `id`, rows x cols, 0 = no plane. Throws
// std::runtime_error naming the file.
void write_labels_exr(const std::filesystem::path& file, int rows, int cols,
                      const std::vector<std::uint32_t>& labels);
// The same back, for what continues from labels; width and height must be the grid's.
std::vector<std::uint32_t> read_labels_exr(const std::filesystem::path& file, int rows, int cols);

// OUT/scans/<id>/: labels.exr and a link to the range.exr they belong to, <id> being the name of the folder
// that holds range.exr. A result folder of the kind hybrid-score takes.
void write_result_folder(const std::filesystem::path& out, const std::filesystem::path& range_exr, int rows,
                         int cols, const std::vector<std::uint32_t>& labels);

}  // namespace hybrid::peers
