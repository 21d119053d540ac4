#pragma once
#include <filesystem>
#include <string>

#include "report/html.hpp"
#include "report/previews.hpp"

namespace hybrid::report {

// A file of DIR as JSON; null when it is not there or is none.
Json read_document(const std::filesystem::path& file);

// The element id of a scan's section; `index` is its place in summary.json.
std::string scan_anchor(std::size_t index);

// One scan: pictures, residuals, superclusters, all figures.
std::string scan_section(Previews& previews, const Json& scan, std::size_t index);

// Why a scan has no pose, what it could be, and the sheet for picking landmarks.
std::string abstained_section(Previews& previews, const Json& scan);

// A picture of DIR, if it is there.
std::string picture(Previews& previews, const std::string& file, const std::string& caption);

}  // namespace hybrid::report
