// The manifest's text. A JSON document for any reader, and one that a process may read in parts:
//
//   {"format":"hybrid manifest 2","archive":...,"build":...,"problems":...,"notes":...,
//   "units":[
//   {"number":0, ... what the schedule needs,
//   "settings":..., "inputs":..., "from":...},
//   ...
//   ],
//   "offsets":[
//   "00000000000001f3",                 where each unit's first line begins, 20 bytes a line
//   ...
//   ],
//   "count":"0000000000000002","offsets_at":"00000000000004d0"}
//
// The last line has one size, too: a process reads that, its unit's entry, and its unit.
#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "archive/manifest.hpp"
#include "core/error.hpp"
#include "io/input_file.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kManifestFormat = "hybrid manifest 2";
constexpr std::string_view kUnits = "\n\"units\":[\n", kEnd = "],\n\"offsets\":[\n";
constexpr std::size_t kEntry_bytes = 20, kNumber_bytes = 16;
constexpr std::string_view kCount = "\"count\":\"", kOffsetsAt = "\",\"offsets_at\":\"", kLast = "\"}\n";
constexpr std::size_t kFooter_bytes =
    kCount.size() + kNumber_bytes + kOffsetsAt.size() + kNumber_bytes + kLast.size();

std::string number_text(std::uint64_t number) {
  return fmt::format("{:016x}", number);
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : file_(path) {
    if (text(0, std::min<std::uint64_t>(file_.size(), kStart().size())) != kStart() ||
        file_.size() < kFooter_bytes)
      fail_input("{}: expected \"{}\", found something else; make the plan again", file_.name(),
                 kManifestFormat);
    const std::string footer = text(file_.size() - kFooter_bytes, kFooter_bytes);
    count_ = number_at(footer, kCount.size());
    offsets_at_ = number_at(footer, kCount.size() + kNumber_bytes + kOffsetsAt.size());
    if (offsets_at_ > file_.size() || count_ > (file_.size() - offsets_at_) / kEntry_bytes ||
        offsets_at_ < kEnd.size())
      not_whole("its table of units");
  }

  static std::string kStart() { return fmt::format("{{\"format\":\"{}\",", kManifestFormat); }
  std::size_t count() const { return count_; }

  Manifest head() {
    const std::uint64_t end = begin_of(0);
    std::string json = text(0, end);
    if (json.size() < kUnits.size() || !std::string_view(json).ends_with(kUnits)) not_whole("its head");
    json.replace(json.size() - kUnits.size(), kUnits.size(), "\"units\":[]}");
    const Json parsed = parse(json, "its head");
    return guarded([&] {
      Manifest manifest;
      manifest.archive = parsed.at("archive").get<std::string>();
      manifest.build = identity_from_json(parsed.at("build"));
      manifest.problems = remarks_from(parsed.at("problems"));
      manifest.notes = remarks_from(parsed.at("notes"));
      return manifest;
    });
  }

  Unit unit(std::size_t number, Detail detail) {
    const std::string place = fmt::format("unit {}", number);
    const std::uint64_t begin = begin_of(number), end = begin_of(number + 1);
    if (begin >= end || end > offsets_at_) not_whole(place);
    // Lines of `head,` and `"settings": ... },` or, of the last one, `}`.
    std::string json = text(begin, end - begin);
    const std::size_t line = json.find('\n');
    const std::size_t last = json.find_last_of('}');
    if (line == json.npos || line < 2 || last == json.npos || last < line) not_whole(place);
    json.resize(last + 1);
    std::string head_text(json, 0, line);
    head_text.back() = '}';  // for the comma
    json[line] = '{';        // for the line's end
    json.erase(0, line);
    const Json head = parse(head_text, place);
    const Json rest = detail == Detail::all ? parse(json, place) : Json::object();
    return guarded([&] {
      Unit unit = unit_from(head, rest);
      if (unit.number != number || unit.key.size() != 32)
        fail_input("{}: unit {}: no such number or key; make the plan again", file_.name(), number);
      for (const std::size_t need : unit.needs)
        if (need >= number)
          fail_input("{}: unit {}: needs a later one; make the plan again", file_.name(), number);
      return unit;
    });
  }

 private:
  // Of a unit; of the one after the last, where they end.
  std::uint64_t begin_of(std::size_t number) {
    if (number == count_) return offsets_at_ - kEnd.size();
    const std::string entry = text(offsets_at_ + number * kEntry_bytes, kEntry_bytes);
    return std::min(number_at(entry, 1), file_.size());
  }

  std::string text(std::uint64_t offset, std::uint64_t bytes) {
    std::string text(static_cast<std::size_t>(bytes), '\0');
    file_.read(offset, text);
    return text;
  }

  std::uint64_t number_at(const std::string& text, std::size_t at) const {
    std::uint64_t number = 0;
    const char* end = text.data() + at + kNumber_bytes;
    if (std::from_chars(text.data() + at, end, number, 16).ptr != end) not_whole("its table of units");
    return number;
  }

  Json parse(const std::string& text, const std::string& place) const {
    Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) not_whole(place);
    return json;
  }

  template <typename Body>
  auto guarded(const Body& body) const -> decltype(body()) {
    try {
      return body();
    } catch (const nlohmann::json::exception& error) {
      fail_input("{}: not a whole manifest ({}); make the plan again", file_.name(), error.what());
    }
  }

  [[noreturn]] void not_whole(const std::string& place) const {
    fail_input("{}: not a whole manifest ({}); make the plan again", file_.name(), place);
  }

  io::InputFile file_;
  std::uint64_t count_ = 0, offsets_at_ = 0;
};

}  // namespace

std::string to_text(const Manifest& manifest) {
  const Json head = {{"archive", manifest.archive.string()},
                     {"build", to_json(manifest.build)},
                     {"problems", to_json(manifest.problems)},
                     {"notes", to_json(manifest.notes)}};
  std::string text = Reader::kStart(), table;
  text.append(head.dump(), 1);
  text.back() = ',';
  text += kUnits;
  for (const Unit& unit : manifest.units) {
    const bool last = unit.index + 1 == manifest.units.size();
    table += fmt::format("\"{}\"{}\n", number_text(text.size()), last ? ' ' : ',');
    const UnitJson json = to_json(unit);
    text += json.head.dump();
    text.back() = ',';
    const std::string rest = json.rest.dump();
    text += '\n';
    text.append(rest, 1);  // without its brace
    text += last ? "\n" : ",\n";
  }
  text += kEnd;
  const std::string offsets_at = number_text(text.size());
  text += table;
  return text + "],\n" + std::string(kCount) + number_text(manifest.units.size()) + std::string(kOffsetsAt) +
         offsets_at + std::string(kLast);
}

Manifest read_manifest(const std::filesystem::path& file, Detail detail) {
  Reader reader(file);
  Manifest manifest = reader.head();
  manifest.units.reserve(reader.count());
  for (std::size_t i = 0; i < reader.count(); ++i) manifest.units.push_back(reader.unit(i, detail));
  return manifest;
}

Manifest read_units(const std::filesystem::path& file, const std::vector<std::size_t>& numbers,
                    Detail detail) {
  Reader reader(file);
  Manifest manifest = reader.head();
  std::map<std::size_t, Unit> found;
  std::vector<std::size_t> open = numbers;
  const std::set<std::size_t> chosen(numbers.begin(), numbers.end());
  for (const std::size_t number : numbers)
    if (number >= reader.count())
      fail_input("{}: unit {}: expected units from 0 to {}; the plan has changed", file.string(), number,
                 reader.count() - 1);
  while (!open.empty()) {
    const std::size_t number = open.back();
    open.pop_back();
    if (found.count(number)) continue;
    Unit& unit = found[number] = reader.unit(number, chosen.count(number) ? detail : Detail::schedule);
    for (const std::size_t need : unit.needs)
      if (!found.count(need)) open.push_back(need);
  }
  std::map<std::size_t, std::size_t> place;
  for (auto& [number, unit] : found) {
    unit.index = place.size();
    place[number] = unit.index;
    for (std::size_t& need : unit.needs) need = place.at(need);
    manifest.units.push_back(std::move(unit));
  }
  return manifest;
}

Manifest read_manifest_head(const std::filesystem::path& file) {
  return Reader(file).head();
}

std::size_t count_units(const std::filesystem::path& file) {
  return Reader(file).count();
}

}  // namespace hybrid::archive
