#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "archive/night.hpp"

namespace hybrid::archive {

// DIR/index.html and DIR/pictures/: the figures of compare_nights() in a table that sorts and filters, and
// every picture that changed beside its older self with their difference, four times as strong.
// Self-contained as a scene's report is. At most `most_pictures` pairs, the page says how many there are.
void write_comparison_page(const std::filesystem::path& folder, const nlohmann::ordered_json& comparison,
                           const Night& a, const Night& b, std::size_t most_pictures);

}  // namespace hybrid::archive
