#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compare/row.hpp"

namespace hybrid::compare {

// What ran where and when, for a reader, above the table.
std::string results_heading(const nlohmann::ordered_json& machine, const std::vector<Row>& rows);

// Names and versions of what the rows were run with, each once.
std::vector<std::string> packages_of(const std::vector<Row>& rows);

// Replaces what stands between the lines "<!-- SCRIPT: begin -->" and "<!-- SCRIPT: end -->" of a Markdown
// file. Throws std::runtime_error when it has no such lines or cannot be written.
void replace_between_marks(const std::filesystem::path& file, const std::string& script,
                           const std::string& text);

// What stands between those lines. Throws as above.
std::string between_marks(const std::filesystem::path& file, const std::string& script);

// The headings and tables of `earlier`, which between_marks() gave, without the lines of jobs and sizes that
// are among `rows`: what another run measured stays, under its own date. Tables that lose all lines go.
std::string without_rows(const std::string& earlier, const std::vector<Row>& rows);

// Through a temporary file beside it, so that a full disk leaves the old one.
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace hybrid::compare
