#include "io/e57/e57_source.hpp"

#include <algorithm>
#include <numeric>

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
    if (reader_) notes_ = reader_->notes();
  }
  std::uint64_t count() const override { return reader_ ? reader_->count() : 0; }
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const override {
    std::vector<std::size_t> stored;
    for (const std::size_t field : fields) stored.push_back(numbers_.at(field));
    if (!reader_) return;
    reader_->read(stored, first, count, body);
    bad_pages_ = reader_->bad_pages();
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

// What is done to the description.
struct E57FileSource::Cuts {
  std::string xml;  // the original
  E57Outline all;   // of that
  std::vector<TextEdit> edits{};

  bool has(TextRange range) const { return within(range, edits); }
  void cut(TextRange range) { edits.push_back({range, {}}); }
};

E57FileSource::E57FileSource(const std::filesystem::path& file,
                             const std::optional<std::set<std::size_t>>& scans, const E57Options& options)
    : file_(file, options) {
  bool whole = true;
  Cuts cuts{.xml = file_.xml(&whole), .all = {}};
  if (!whole)
    fail_input("{}: XML section: expected it undamaged, found damaged pages; convert to another format",
               file_.name());
  cuts.all = outline_e57_xml(file_.name(), cuts.xml);
  const E57Contents& contents = file_.contents();
  if (cuts.all.scans.size() != contents.scans.size() || cuts.all.images.size() != contents.images.size())
    fail_input(
        "{}: XML section: expected one element data3D and one images2D, found more; export the file again",
        file_.name());
  if (scans) cut_other_scans(cuts, *scans);
  if (options.salvage) cut_damaged_blobs(cuts);
  for (const E57Part& part : cuts.all.parts)
    if (part.points && !cuts.has(part.element)) keep_points(cuts, part);
  // In the order of the description.
  std::vector<Stored> points = std::move(stored_);
  stored_.clear();
  auto next = points.begin();
  for (const E57Part& part : cuts.all.parts) {
    if (cuts.has(part.element)) continue;
    if (part.points)
      stored_.push_back(std::move(*next++));
    else if (part.blob)
      stored_.emplace_back();
    else if (!keep_table(cuts, part)) {
      drop("table " + part.name);
      cuts.cut(part.element);
    }
  }
  for (const auto& text : cuts.all.texts)
    if (!cuts.has(text.element)) {
      drop("field of text " + text.name);
      cuts.cut(text.element);
    }
  describe(file_.name(), edited(cuts.xml, std::move(cuts.edits)));
}

void E57FileSource::cut_other_scans(Cuts& cuts, const std::set<std::size_t>& scans) {
  const E57Contents& contents = file_.contents();
  std::set<std::string> cut_guids;
  for (std::size_t k = 0; k < cuts.all.scans.size(); ++k)
    if (!scans.contains(k)) {
      cuts.cut(cuts.all.scans[k]);
      cut_guids.insert(contents.scans[k].guid);
    }
  std::size_t photographs = 0;
  for (std::size_t k = 0; k < cuts.all.images.size(); ++k)
    if (const std::string& guid = contents.images[k].scan_guid; !guid.empty() && cut_guids.contains(guid)) {
      cuts.cut(cuts.all.images[k]);
      ++photographs;
    }
  if (photographs > 0) drop(fmt::format("photographs of the other scans ({})", photographs));
}

// A picture goes with its mask, and the other way round.
void E57FileSource::cut_damaged_blobs(Cuts& cuts) {
  for (const E57Part& part : cuts.all.parts) {
    if (!part.blob || cuts.has(part.element)) continue;
    std::vector<std::string> problems;
    try {
      file_.read_blob({part.offset, part.length}, part.name, &problems);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      problems.emplace_back(error.what());
    }
    if (problems.empty()) continue;
    TextRange all_of_it = part.element;
    std::string what = part.name;
    for (std::size_t k = 0; k < cuts.all.images.size(); ++k)
      if (within(part.element, {{cuts.all.images[k], {}}})) {
        all_of_it = cuts.all.images[k];
        what = fmt::format("photograph {}", file_.contents().images[k].name);
      }
    drop(fmt::format("{} (damaged: {})", what, problems[0]));
    cuts.cut(all_of_it);
  }
}

KeptRanges E57FileSource::kept_of(const E57Table& table) const {
  const NumberFields reader(file_.pages(), table);
  std::vector<std::size_t> fields(static_cast<std::size_t>(
      std::ranges::count_if(table.fields, [](const E57Field& field) { return !is_text(field); })));
  std::iota(fields.begin(), fields.end(), std::size_t{0});
  return find_kept(reader, fields);
}

void E57FileSource::keep_points(Cuts& cuts, const E57Part& part) {
  const E57Table& table = file_.contents().scans[*part.scan].points;
  Stored& stored = stored_.emplace_back(table);
  if (!file_.pages().salvage()) return;
  stored.kept = kept_of(table);
  if (stored.kept->count == table.count) return;
  cuts.edits.push_back({part.count_text, std::to_string(stored.kept->count)});
  for (const auto& grouping : cuts.all.groupings)
    if (grouping.scan == part.scan) {
      drop(fmt::format("groups of points of {}, as some points are lost", table.what));
      cuts.cut(grouping.element);
    }
}

// False when it cannot be read.
bool E57FileSource::keep_table(Cuts& cuts, const E57Part& part) {
  try {
    E57Table table =
        parse_e57_table(file_.name(), std::string(text_at(cuts.xml, part.element)), "table " + part.name);
    if (std::ranges::all_of(table.fields, is_text)) return false;
    if (file_.pages().salvage() && kept_of(table).count != table.count) return false;
    stored_.push_back({std::move(table), {}});
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    return false;
  }
  return true;
}

std::unique_ptr<E57RecordReader> E57FileSource::open(std::size_t part) const {
  const Stored& stored = stored_.at(part);
  auto reader = std::make_unique<NumberFields>(file_.pages(), stored.table);
  if (!stored.kept) return reader;
  return std::make_unique<KeptRecords>(std::move(reader), table(part), *stored.kept);
}

std::vector<char> E57FileSource::blob(std::size_t part) const {
  const E57Part& blob = outline().parts.at(part);
  return file_.read_blob({blob.offset, blob.length}, blob.name);
}

std::vector<std::string> E57FileSource::notes(std::size_t part) const {
  const Stored& stored = stored_.at(part);
  if (!stored.kept) return {};
  std::vector<std::string> notes = stored.kept->notes;
  notes.insert(notes.end(), file_.notes().begin(), file_.notes().end());
  return notes;
}

}  // namespace hybrid::io
