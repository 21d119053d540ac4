#include "io/e57/e57_source.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "io/e57/e57_xml.hpp"

namespace hybrid::io {
namespace {

std::string_view text_at(std::string_view xml, TextRange range) {
  return xml.substr(range.begin, range.end - range.begin);
}

bool is_text(const E57Field& field) {
  return field.type == E57Type::text;
}

// A table without its fields of text.
class NumberFields : public E57RecordReader {
 public:
  NumberFields(const PagedFile& pages, const E57Table& table) {
    if (table.count > 0) reader_.emplace(pages, table);  // an empty one need not be anywhere
    for (std::size_t k = 0; k < table.fields.size(); ++k)
      if (!is_text(table.fields[k])) numbers_.push_back(k);
  }
  std::uint64_t count() const override { return reader_ ? reader_->count() : 0; }
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const override {
    std::vector<std::size_t> stored;
    for (const std::size_t field : fields) stored.push_back(numbers_.at(field));
    if (reader_) reader_->read(stored, first, count, body);
  }

 private:
  std::optional<E57TableReader> reader_;
  std::vector<std::size_t> numbers_;
};

bool within(TextRange inner, const std::vector<TextEdit>& cuts) {
  return std::ranges::any_of(cuts, [&](const TextEdit& cut) {
    return cut.range.begin <= inner.begin && inner.end <= cut.range.end;
  });
}

}  // namespace

void E57Source::describe(const std::string& name, std::string xml) {
  name_ = name;
  xml_ = std::move(xml);
  contents_ = parse_e57_xml(name_, xml_, false);
  outline_ = outline_e57_xml(name_, xml_);
  if (outline_.scans.size() != contents_.scans.size() || outline_.images.size() != contents_.images.size())
    fail_input(
        "{}: XML section: expected one element data3D and one images2D, found more; export the file again",
        name_);
  for (const E57Part& part : outline_.parts) {
    E57Table& table = tables_.emplace_back();
    if (part.points)
      table = contents_.scans[*part.scan].points;
    else if (!part.blob)
      table = parse_e57_table(name_, std::string(text_at(xml_, part.element)), "table " + part.name);
  }
}

std::size_t E57Source::points(std::size_t scan) const {
  const auto is_its = [&](const E57Part& part) { return part.points && part.scan == scan; };
  return static_cast<std::size_t>(std::ranges::find_if(outline_.parts, is_its) - outline_.parts.begin());
}

E57FileSource::E57FileSource(const std::filesystem::path& file,
                             const std::optional<std::set<std::size_t>>& scans)
    : file_(file) {
  const std::string original = file_.xml();
  const E57Outline all = outline_e57_xml(file_.name(), original);
  const E57Contents& contents = file_.contents();
  if (all.scans.size() != contents.scans.size() || all.images.size() != contents.images.size())
    fail_input(
        "{}: XML section: expected one element data3D and one images2D, found more; export the file again",
        file_.name());
  std::vector<TextEdit> cuts;
  std::set<std::string> cut_guids;
  for (std::size_t k = 0; k < all.scans.size(); ++k)
    if (scans && !scans->contains(k)) {
      cuts.push_back({all.scans[k], {}});
      cut_guids.insert(contents.scans[k].guid);
    }
  std::size_t photographs = 0;
  for (std::size_t k = 0; k < all.images.size(); ++k)
    if (const std::string& guid = contents.images[k].scan_guid; !guid.empty() && cut_guids.contains(guid)) {
      cuts.push_back({all.images[k], {}});
      ++photographs;
    }
  if (photographs > 0) drop(fmt::format("photographs of the other scans ({})", photographs));
  for (const E57Part& part : all.parts) {
    if (within(part.element, cuts)) continue;
    if (part.blob || part.points) {
      stored_.push_back(part.points ? contents.scans[*part.scan].points : E57Table{});
      continue;
    }
    try {
      E57Table table =
          parse_e57_table(file_.name(), std::string(text_at(original, part.element)), "table " + part.name);
      if (!std::ranges::all_of(table.fields, is_text)) {
        stored_.push_back(std::move(table));
        continue;
      }
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
    }
    drop("table " + part.name);
    cuts.push_back({part.element, {}});
  }
  for (const auto& text : all.texts)
    if (!within(text.element, cuts)) {
      drop("field of text " + text.name);
      cuts.push_back({text.element, {}});
    }
  describe(file_.name(), edited(original, std::move(cuts)));
}

std::unique_ptr<E57RecordReader> E57FileSource::open(std::size_t part) const {
  return std::make_unique<NumberFields>(file_.pages(), stored_.at(part));
}

std::vector<char> E57FileSource::blob(std::size_t part) const {
  const E57Part& blob = outline().parts.at(part);
  return file_.read_blob({blob.offset, blob.length}, blob.name);
}

}  // namespace hybrid::io
