#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hybrid::io {

// Bytes [begin, end) of a text.
struct TextRange {
  std::size_t begin = 0, end = 0;
};
inline std::string_view text_at(std::string_view xml, TextRange range) {
  return xml.substr(range.begin, range.end - range.begin);
}

// An element that names bytes outside the XML section: a blob or a table of records.
struct E57Part {
  std::string name{};                    // of the element: "points", "jpegImage"
  bool blob = false;                     // else a table
  std::uint64_t offset = 0, length = 0;  // fileOffset; of blobs, their length
  TextRange element{}, offset_text{};    // the element; the digits of its fileOffset
  TextRange count_text{};                // of tables: those of its recordCount
  std::optional<std::size_t> scan{};     // whose description it stands in
  bool points = false;                   // that scan's own table
};

// Where in the text of an XML section the things lie that a copy must change or leave out; everything else is
// copied as it is written, so that nothing is lost that nobody here knows.
struct E57Outline {
  std::vector<TextRange> scans{};   // children of data3D
  std::vector<TextRange> images{};  // children of images2D
  std::vector<E57Part> parts{};
  struct Text {
    std::string name{};
    TextRange element{};
    std::size_t part = 0;  // the table whose prototype it belongs to
  };
  std::vector<Text> texts{};  // fields of text, which no table here holds
  struct Grouping {
    TextRange element{};
    std::size_t scan = 0;
  };
  std::vector<Grouping> groupings{};  // pointGroupingSchemes: they name a scan's points by their numbers
};

// Of XML that parse_e57_xml() accepts. Throws ErrorKind::input naming the file for what that lets pass.
E57Outline outline_e57_xml(const std::string& file, std::string_view xml);

struct TextEdit {
  TextRange range{};
  std::string by{};
};
// Edits in any order; those within another's range vanish with it.
std::string edited(std::string_view text, std::vector<TextEdit> edits);

}  // namespace hybrid::io
