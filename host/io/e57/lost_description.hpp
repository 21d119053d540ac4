#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "io/e57/paged_file.hpp"

namespace hybrid::io {

// A part of a file, logical.
struct E57Stretch {
  std::uint64_t offset = 0, length = 0;
};

// Salvage of a file whose header does not lead to its description (XML section), mostly because the file is
// cut, and the description stands at its end: it is sought in all pages, to its last element or the file's
// end.
std::optional<E57Stretch> find_description(const PagedFile& file);

// Where tables of points are that nothing describes any more, for the message that they cannot be read: what
// the bits of their streams mean stands in the description alone.
std::string tell_tables(const PagedFile& file);

}  // namespace hybrid::io
