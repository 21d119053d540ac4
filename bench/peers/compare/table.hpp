#pragma once
#include <string>
#include <vector>

#include "compare/row.hpp"

namespace hybrid::compare {

// One Markdown table: job, size, program, seconds (median, spread, runs), rate, times ours, memory, quality,
// settings. Extrapolated figures carry a tilde; programs that did not run say why.
std::string markdown_table(const std::vector<Row>& rows);

// The same for programs: every run, package and score.
nlohmann::ordered_json json_of(const std::vector<Row>& rows);

}  // namespace hybrid::compare
