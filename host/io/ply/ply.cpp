#include "io/ply/ply.hpp"

#include <algorithm>
#include <optional>

#include "core/error.hpp"
#include "io/built_stream.hpp"
#include "io/fixed_records.hpp"
#include "io/ply/ply_elements.hpp"
#include "io/salvage.hpp"
#include "io/text/text_samples.hpp"
#include "io/text/text_stream.hpp"

namespace hybrid::io {
namespace {

std::string note_unused(const PlyVertex& vertex) {
  return "properties not used: " + vertex.unused();
}

// The elements that are not used, for a note.
class Others {
 public:
  void add(const PlyElement& element) {
    text_ +=
        fmt::format("{}{} {}", text_.empty() ? "elements not used: " : ", ", element.count, element.name);
  }
  const std::string& note() const { return text_; }

 private:
  std::string text_;
};

// To a sample from where a binary record without lists lies in memory.
class FromRecord {
 public:
  FromRecord(const PlyVertex& vertex, const PlyElement& element, bool swapped)
      : vertex_(vertex), swapped_(swapped) {
    std::size_t at = 0;
    for (const PlyProperty& property : element.properties) {
      properties_.push_back({at, property.type});
      at += size_of(property.type);
    }
  }
  ScanSample operator()(const char* record) const {
    return vertex_.sample([&](std::size_t i) {
      return load_scalar(record + properties_[i].at, properties_[i].type, swapped_);
    });
  }

 private:
  struct Property {
    std::size_t at;
    ScalarType type;
  };
  const PlyVertex& vertex_;
  bool swapped_;
  std::vector<Property> properties_;
};

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& file, const ReadOptions& options)
      : elements_(file, options.salvage),
        file_(elements_.file()),
        salvage_(options.salvage),
        exact_(options.exact),
        damage_(file_),
        name_(file.stem().string()) {}

  Scan read() {
    std::optional<ScanBuilder> builder;
    Others others;
    for (const PlyElement& element : elements_.header().elements) {
      if (salvage_ && element.name == "vertex") {
        builder.emplace(salvage_vertices(element));
        continue;
      }
      if (salvage_ && builder && cut_short_) continue;  // what follows the points cannot be found
      elements_.check_fits(element);
      if (element.name == "vertex") {
        builder.emplace(read_vertices(element));
      } else {
        elements_.skip(element);
        others.add(element);
      }
    }
    if (!builder)
      fail_input(
          "{}: line {}: expected an element named vertex before end_header, found none; this PLY file has no "
          "points",
          file_, elements_.header().data_line - 1);
    if (!others.note().empty()) builder->add_note(others.note());
    if (!cut_short_)
      for (const std::string& note : elements_.notes_of_rest(commas_)) builder->add_note(note);
    return builder->finish();
  }

 private:
  // As many of them as there are; lines that are none are no-returns.
  ScanBuilder salvage_vertices(PlyElement vertex) {
    const std::uint64_t announced = vertex.count;
    const std::uint64_t room = (elements_.rest() + (elements_.ascii() ? 1 : 0)) /
                               std::max<std::uint64_t>(elements_.least_bytes(vertex), 1);
    vertex.count = std::min(vertex.count, room);
    ScanBuilder builder = read_vertices(vertex);
    if (builder.size() < announced) {
      cut_short_ = true;
      damage_.add(announced - builder.size(),
                  !list_problem_.empty() ? list_problem_
                                         : fmt::format("byte {}: the points that line {} announces end",
                                                       elements_.place().offset, vertex.line));
    }
    if (damage_.records() > 0) builder.add_note(damage_.note(announced));
    return builder;
  }

  // Reads a record; what is wrong with it when salvage is to pass it by.
  std::string problem_of(const PlyElement& vertex, std::uint64_t row) {
    try {
      elements_.read(vertex, row);
    } catch (const Error& error) {
      if (!salvage_ || error.kind() != ErrorKind::input) throw;
      return error.what();
    }
    return {};
  }

  ScanBuilder read_vertices(const PlyElement& element) {
    const PlyVertex vertex(file_, element);
    // Single precision holds what was written in it; text may have more digits than its header says.
    ScanBuilder builder(file_, name_, element.count,
                        {.intensity = vertex.intensity(),
                         .colour = vertex.colour(),
                         .salvage = salvage_,
                         .exact = exact_ && (elements_.ascii() || vertex.rounds())});
    if (!vertex.unused().empty()) builder.add_note(note_unused(vertex));
    if (!element.has_lists())
      elements_.ascii() ? read_number_rows(element, vertex, builder) : read_records(element, vertex, builder);
    else
      elements_.ascii() ? read_lines(element, vertex, builder) : read_lists(element, vertex, builder);
    return builder;
  }

  void read_records(const PlyElement& element, const PlyVertex& vertex, ScanBuilder& builder) {
    const std::uint64_t offset = elements_.place().offset;
    FixedRecords(elements_.input(), offset, element.least_bytes())
        .add(0, element.count, builder, FromRecord(vertex, element, elements_.swapped()));
    elements_.move_to({offset + element.count * element.least_bytes()});
  }

  void read_lists(const PlyElement& element, const PlyVertex& vertex, ScanBuilder& builder) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
      // Behind a record whose lists make no sense nothing has a place.
      list_problem_ = problem_of(element, row);
      if (!list_problem_.empty()) break;
      builder.add(vertex.sample([&](std::size_t i) { return elements_.number(element, i); }));
    }
  }

  void read_lines(const PlyElement& element, const PlyVertex& vertex, ScanBuilder& builder) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
      elements_.skip_blank_lines();
      if (salvage_ && elements_.at_end()) break;
      const TextPlace line = elements_.place();
      const std::string problem = problem_of(element, row);
      if (problem.empty()) {
        builder.add(vertex.sample([&](std::size_t i) { return elements_.number(element, i); }));
        continue;
      }
      damage_.add(1, problem);
      builder.add_lost(1);
      elements_.move_to(line);
      elements_.next_line();
    }
  }

  // As many numbers on every line.
  void read_number_rows(const PlyElement& element, const PlyVertex& vertex, ScanBuilder& builder) {
    if (element.count == 0) return;
    elements_.move_to(add_text_samples(
        elements_.input(), elements_.place(), element.count, element.properties.size(), builder, commas_,
        [&](const double* row) { return vertex.sample([&](std::size_t i) { return row[i]; }); },
        [&](TextCursor& at, std::span<double> values, std::uint64_t done) {
          elements_.move_to({at.offset(), at.line()});
          elements_.read(element, done);
          std::ranges::copy(elements_.numbers(), values.begin());
          at.move_to(elements_.place().offset, elements_.place().line);
        },
        salvage_ ? &damage_ : nullptr));
  }

  PlyElements elements_;
  const std::string& file_;
  bool salvage_, exact_, cut_short_ = false, commas_ = false;
  Damage damage_;
  std::string list_problem_, name_;
};

// What a stream needs besides its samples: the way to the vertices, and from there to the end.
struct PlyOutline {
  explicit PlyOutline(const std::filesystem::path& file) : elements(file, false) {
    for (const PlyElement& element : elements.header().elements) {
      elements.check_fits(element);
      if (element.name == "vertex") {
        vertices = &element;
        break;
      }
      elements.skip(element);
      others.add(element);
    }
  }

  // `after`: the place behind the vertices. The notes of what is there.
  std::vector<std::string> go_on(const TextPlace& after, bool commas) {
    elements.move_to(after);
    for (const PlyElement* element = vertices + 1; element <= &elements.header().elements.back(); ++element) {
      elements.check_fits(*element);
      elements.skip(*element);
      others.add(*element);
    }
    std::vector<std::string> notes;
    if (!others.note().empty()) notes.push_back(others.note());
    for (std::string& note : elements.notes_of_rest(commas)) notes.push_back(std::move(note));
    return notes;
  }

  PlyElements elements;
  const PlyElement* vertices = nullptr;
  Others others;
};

class PlyTextStream : public TextStream {
 public:
  PlyTextStream(const std::filesystem::path& file, const ScanEntry& entry,
                std::unique_ptr<PlyOutline> outline)
      : TextStream(file, entry),
        outline_(std::move(outline)),
        vertex_(outline_->elements.file(), *outline_->vertices) {
    if (!vertex_.unused().empty()) head_.notes.push_back(note_unused(vertex_));
    const auto notes = take({.start = outline_->elements.place(),
                             .count = outline_->vertices->count,
                             .columns = outline_->vertices->properties.size(),
                             .intensity = vertex_.intensity(),
                             .colour = vertex_.colour()});
    add_notes(outline_->go_on(after(), commas_seen()));
    add_notes(notes);
  }

 private:
  ScanSample sample(const double* row) const override {
    return vertex_.sample([&](std::size_t i) { return row[i]; });
  }
  void read_line(TextCursor& cursor, std::span<double> values, std::uint64_t done) const override {
    PlyElements& elements = outline_->elements;
    elements.move_to({cursor.offset(), cursor.line()});
    elements.read(*outline_->vertices, done);
    std::ranges::copy(elements.numbers(), values.begin());
    cursor.move_to(elements.place().offset, elements.place().line);
  }

  std::unique_ptr<PlyOutline> outline_;
  PlyVertex vertex_;
};

class PlyRecordStream : public BuiltStream {
 public:
  PlyRecordStream(const ScanEntry& entry, std::unique_ptr<PlyOutline> outline)
      : BuiltStream(entry),
        outline_(std::move(outline)),
        vertex_(outline_->elements.file(), *outline_->vertices),
        to_sample_(vertex_, *outline_->vertices, outline_->elements.swapped()),
        records_(outline_->elements.input(), outline_->elements.place().offset,
                 outline_->vertices->least_bytes()) {
    count_ = outline_->vertices->count;
    intensity_ = vertex_.intensity();
    exact_ = entry.exact && vertex_.rounds();
    const std::uint64_t start = outline_->elements.place().offset;
    if (!vertex_.unused().empty()) head_.notes.push_back(note_unused(vertex_));
    take_first(records_.first_pass(count_, vertex_.colour(), to_sample_));
    add_notes(outline_->go_on({start + count_ * outline_->vertices->least_bytes()}, false));
    add_notes(take(outline_->elements.file(), false));
  }

 private:
  void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const override {
    with_colours(builder, [&](auto& to) { records_.add(first, count, to, to_sample_); });
  }

  std::unique_ptr<PlyOutline> outline_;
  PlyVertex vertex_;
  FromRecord to_sample_;
  mutable FixedRecords records_;
};

// Records whose lists make them of different length: read one by one, from places that the first pass
// remembers.
class PlyListStream : public BuiltStream {
 public:
  PlyListStream(const ScanEntry& entry, std::unique_ptr<PlyOutline> outline)
      : BuiltStream(entry),
        outline_(std::move(outline)),
        vertex_(outline_->elements.file(), *outline_->vertices),
        places_{outline_->elements.place()} {
    count_ = outline_->vertices->count;
    intensity_ = vertex_.intensity();
    exact_ = entry.exact && (outline_->elements.ascii() || vertex_.rounds());
    if (!vertex_.unused().empty()) head_.notes.push_back(note_unused(vertex_));
    FirstPass first;
    first.colour = vertex_.colour();
    while (next_ < count_ && !first.done()) add_next(1, first);
    take_first(first);
    seek(0);
    const auto notes = take(outline_->elements.file(), false);
    add_notes(outline_->go_on(outline_->elements.place(), false));
    add_notes(notes);
  }

 private:
  template <typename Builder>
  void add_next(std::uint64_t count, Builder& builder) const {
    PlyElements& elements = outline_->elements;
    for (const std::uint64_t end = next_ + count; next_ < end; ++next_) {
      elements.read(*outline_->vertices, next_);
      builder.add(vertex_.sample([&](std::size_t i) { return elements.number(*outline_->vertices, i); }));
    }
  }

  void seek(std::uint64_t first) const {
    const std::uint64_t place = std::min<std::uint64_t>(first / kBlock, places_.size() - 1);
    outline_->elements.move_to(places_[place]);
    next_ = place * kBlock;
  }

  void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const override {
    if (first != next_) seek(first);
    for (; next_ < first; ++next_) outline_->elements.read(*outline_->vertices, next_);
    with_colours(builder, [&](auto& to) { add_next(count, to); });
    if (next_ == places_.size() * kBlock) places_.push_back(outline_->elements.place());
  }

  std::unique_ptr<PlyOutline> outline_;
  PlyVertex vertex_;
  mutable std::uint64_t next_ = 0;         // the record that comes next
  mutable std::vector<TextPlace> places_;  // of records 0, kBlock, 2 kBlock ...
};

const char* name_of(PlyFormat format) {
  return format == PlyFormat::ascii           ? "ascii"
         : format == PlyFormat::little_endian ? "binary little endian"
                                              : "binary big endian";
}

}  // namespace

Scan read_ply(const std::filesystem::path& file, const ReadOptions& options) {
  return PlyReader(file, options).read();
}

std::unique_ptr<ScanStream> stream_ply(const std::filesystem::path& file, const ScanEntry& entry) {
  if (entry.salvage) return nullptr;
  auto outline = std::make_unique<PlyOutline>(file);
  if (!outline->vertices) return nullptr;
  if (outline->vertices->has_lists()) return std::make_unique<PlyListStream>(entry, std::move(outline));
  if (outline->elements.ascii()) return std::make_unique<PlyTextStream>(file, entry, std::move(outline));
  return std::make_unique<PlyRecordStream>(entry, std::move(outline));
}

std::vector<ScanEntry> list_ply(const std::filesystem::path& file) {
  InputFile input(file);
  const PlyHeader header = read_ply_header(input);
  ScanEntry entry{.name = file.stem().string(), .structure = fmt::format("{},", name_of(header.format))};
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") continue;
    entry.samples = element.count;
    for (const PlyProperty& property : element.properties) entry.structure += " " + property.name;
  }
  entry.offset = header.data_offset;
  entry.line = header.data_line;
  entry.end = input.size();
  return {entry};
}

}  // namespace hybrid::io
