#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "io/e57/e57_model.hpp"

namespace hybrid::testing {

// A scan of rows x cols nodes: `order` says which node each record has.
std::filesystem::path e57_of(const std::filesystem::path& file, int rows, int cols,
                             const std::vector<std::uint32_t>& order,
                             std::optional<io::E57Limits> declared_rows = {}, bool returns = false);

std::vector<std::uint32_t> all_nodes(int rows, int cols, bool by_columns);

}  // namespace hybrid::testing
