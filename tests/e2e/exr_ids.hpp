#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace hybrid::e2e {

// The `id` channel of a view or of labels.exr, row by row.
std::vector<std::uint32_t> ids_of(const std::filesystem::path& exr);

}  // namespace hybrid::e2e
