#pragma once
#include <string>

#include "io/e57/e57_model.hpp"

namespace hybrid::io {

// Reads an E57 file's XML section. Elements of extensions are kept by name; what is missing (images2D, a
// namespace) is a note. Throws ErrorKind::input naming the line: XML that does not parse, is too large or too
// deep, or holds a document type (the way to entities that grow without end); values that make no sense.
// With `salvage` XML that breaks off gives what came before.
E57Contents parse_e57_xml(const std::string& file, const std::string& text, bool salvage);

// One table's element alone: "points", or one of an extension.
E57Table parse_e57_table(const std::string& file, const std::string& element, std::string what);

}  // namespace hybrid::io
