#pragma once
#include <string>
#include <vector>

#include "compare/row.hpp"

namespace hybrid::compare {

// As the text of a cell: a pipe would end it.
std::string cell(std::string text);

// One Markdown table: job, size, program, seconds (median, spread, runs), rate, times ours, memory, quality,
// settings. Extrapolated figures carry a tilde; programs that did not run say why.
std::string markdown_table(const std::vector<Row>& rows);

// The table of the end-to-end jobs: median seconds of each part and of what is no part (start, end), wall
// clock and processor time of the whole process, peak memory, and how many times ours wall clock and
// processor are.
std::string parts_table(const std::vector<Row>& rows);

// The same for programs: every run, package and score.
nlohmann::ordered_json json_of(const std::vector<Row>& rows);

}  // namespace hybrid::compare
