#include "io/e57/e57_source.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "io/e57/e57_xml.hpp"
#include "io/salvage.hpp"

namespace hybrid::io {
namespace {

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
  tables_.clear();
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

std::unique_ptr<E57RecordReader> E57Source::open(std::size_t part) const {
  auto reader = open_stored(part);
  if (kept_.empty() || !kept_.at(part)) return reader;
  return std::make_unique<KeptRecords>(std::move(reader), table(part), *kept_[part]);
}

std::vector<std::string> E57Source::notes(std::size_t scan) const {
  return kept_.empty() ? std::vector<std::string>() : kept_.at(points(scan))->notes;
}

std::uint64_t E57Source::stored_count(std::size_t part) const {
  if (kept_.empty() || !kept_.at(part)) return table(part).count;
  return kept_[part]->count + kept_[part]->lost;
}

// A picture goes with its mask, and the other way round.
void E57Source::cut_damaged_blobs(std::vector<TextEdit>& edits) {
  for (std::size_t part = 0; part < outline_.parts.size(); ++part) {
    const TextRange element = outline_.parts[part].element;
    if (!outline_.parts[part].blob || within(element, edits)) continue;
    try {
      blob(part);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      TextRange all_of_it = element;
      std::string what = outline_.parts[part].name;
      for (std::size_t k = 0; k < outline_.images.size(); ++k)
        if (within(element, {{outline_.images[k], {}}})) {
          all_of_it = outline_.images[k];
          what = fmt::format("photograph {}", contents_.images[k].name);
        }
      drop(fmt::format("{} (damaged: {})", what, Damage(name_).shortened(error.what())));
      edits.push_back({all_of_it, {}});
    }
  }
}

// Nothing for a table that is left out.
std::optional<KeptRanges> E57Source::find_kept_records(std::size_t part, std::vector<TextEdit>& edits) {
  const E57Part& described = outline_.parts[part];
  const E57Table& stored = table(part);
  std::optional<KeptRanges> kept;
  try {
    kept = find_kept(*open_stored(part), all_fields(stored));
  } catch (const Error& error) {
    if (described.points || error.kind() != ErrorKind::input) throw;
  }
  if (kept && kept->count == stored.count) return kept;
  if (!described.points) {
    drop("table " + described.name);
    edits.push_back({described.element, {}});
    return {};
  }
  edits.push_back({described.count_text, std::to_string(kept->count)});
  for (const auto& grouping : outline_.groupings)
    if (grouping.scan == described.scan) {
      drop(fmt::format("groups of points of {}, as some points are lost", stored.what));
      edits.push_back({grouping.element, {}});
    }
  return kept;
}

void E57Source::leave_out_damage() {
  std::vector<TextEdit> edits;
  cut_damaged_blobs(edits);
  std::vector<std::optional<KeptRanges>> kept(outline_.parts.size());
  for (const bool points : {true, false})  // first: groups of points go with them
    for (std::size_t part = 0; part < outline_.parts.size(); ++part)
      if (const E57Part& one = outline_.parts[part];
          !one.blob && one.points == points && !within(one.element, edits))
        kept[part] = find_kept_records(part, edits);
  std::vector<std::size_t> left;
  for (std::size_t part = 0; part < outline_.parts.size(); ++part)
    if (!within(outline_.parts[part].element, edits)) {
      left.push_back(part);
      kept_.push_back(std::move(kept[part]));
    }
  keep_parts(left);
  describe(name_, edited(xml_, std::move(edits)));
}

E57FileSource::E57FileSource(const std::filesystem::path& file,
                             const std::optional<std::set<std::size_t>>& scans, const E57Options& options)
    : file_(file, options) {
  bool whole = true;
  const std::string original = file_.xml(&whole);
  if (!whole)
    fail_input("{}: XML section: expected it undamaged, found damaged pages; convert to another format",
               file_.name());
  if (options.salvage) parse_e57_xml(file_.name(), original, false);  // an outline needs all to be in order
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
  if (options.salvage) leave_out_damage();
}

std::unique_ptr<E57RecordReader> E57FileSource::open_stored(std::size_t part) const {
  return std::make_unique<NumberFields>(file_.pages(), stored_.at(part));
}

std::vector<char> E57FileSource::blob(std::size_t part) const {
  const E57Part& blob = outline().parts.at(part);
  std::vector<std::string> problems;
  auto bytes = file_.read_blob({blob.offset, blob.length}, blob.name, &problems);
  if (!problems.empty()) fail_input("{}: {}", file_.name(), problems[0]);
  return bytes;
}

void E57FileSource::keep_parts(std::span<const std::size_t> parts) {
  std::vector<E57Table> kept;
  for (const std::size_t part : parts) kept.push_back(std::move(stored_[part]));
  stored_ = std::move(kept);
}

std::vector<std::string> E57FileSource::notes(std::size_t scan) const {
  auto notes = E57Source::notes(scan);
  notes.insert(notes.end(), file_.notes().begin(), file_.notes().end());
  return notes;
}

}  // namespace hybrid::io
