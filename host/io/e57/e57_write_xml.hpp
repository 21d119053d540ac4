#pragma once
#include <string>

#include "io/e57/e57_model.hpp"

namespace hybrid::io {

// The XML section of a file with these contents; tables and blobs have their places. No date without
// `created_gps_s`.
std::string write_e57_xml(const E57Contents& contents, const std::optional<double>& created_gps_s);

// Whether XML allows it as an element's name, with at most one prefix.
bool is_xml_name(const std::string& name);

}  // namespace hybrid::io
