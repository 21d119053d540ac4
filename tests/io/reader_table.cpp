#include "io/reader_table.hpp"

#include <stdexcept>

#include "io/reader_rows.hpp"

namespace hybrid::testing {

const std::vector<ReaderRow>& reader_table() {
  static const std::vector<ReaderRow> table = [] {
    std::vector<ReaderRow> rows;
    for (const auto& part :
         {scan_reader_rows(), text_reader_rows(), camera_reader_rows(), image_reader_rows()})
      rows.insert(rows.end(), part.begin(), part.end());
    return rows;
  }();
  return table;
}

std::string edited(std::string bytes, const Edit& edit) {
  const std::size_t at = bytes.find(edit.from);
  if (at == bytes.npos) throw std::logic_error("the sample has no \"" + edit.from + "\"");
  return bytes.replace(at, edit.from.size(), edit.to);
}

}  // namespace hybrid::testing
