// What a plan says of itself.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "archive/plan.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;

struct Work {
  std::size_t units = 0;
  double cpu_s = 0;
  std::uint64_t most_bytes = 0;
  std::size_t implied = 0;  // scenes of loose scans
};

std::map<UnitKind, Work> work_of(const Manifest& manifest) {
  std::map<UnitKind, Work> work;
  for (const Unit& unit : manifest.units) {
    Work& of_kind = work[unit.kind];
    ++of_kind.units;
    of_kind.cpu_s += unit.estimate_s;
    of_kind.implied += unit.implied && unit.kind == UnitKind::scene;
    of_kind.most_bytes = std::max(of_kind.most_bytes, unit.estimate_bytes);
  }
  return work;
}

// "3, 7-12"; "-" for none.
std::string ranges_of(const std::vector<std::size_t>& ascending) {
  std::string text;
  for (std::size_t i = 0; i < ascending.size();) {
    std::size_t last = i;
    while (last + 1 < ascending.size() && ascending[last + 1] == ascending[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", ascending[i]);
    if (last > i) text += fmt::format("-{}", ascending[last]);
    i = last + 1;
  }
  return text.empty() ? "-" : text;
}

// The file that a unit is about.
std::string subject_of(const Unit& unit) {
  if (unit.kind == UnitKind::planes) return fmt::format("{} scan {}", unit.file.string(), unit.scan_index);
  if (unit.kind != UnitKind::scene) return "all of these";
  return unit.scene.string() + (unit.implied ? fmt::format(" ({} loose scan files)", unit.scans.size()) : "");
}

}  // namespace

std::string describe(const Manifest& manifest) {
  std::string text = fmt::format("archive {}\n", manifest.archive.string());
  for (const auto& [kind, work] : work_of(manifest)) {
    text += fmt::format("{:<8} {:>7} units, about {:.0f} CPU s, at most {:.1f} GiB each\n", name_of(kind),
                        work.units, work.cpu_s, static_cast<double>(work.most_bytes) / (1 << 30));
    if (work.implied > 0)
      text += fmt::format("         {:>7} of them loose scans that lie together\n", work.implied);
  }
  for (const auto& [path, what] : manifest.notes) text += fmt::format("note: {}: {}\n", path, what);
  for (const auto& [path, what] : manifest.problems) text += fmt::format("problem: {}: {}\n", path, what);
  return text;
}

Json summary(const Manifest& manifest) {
  Json json = {{"archive", manifest.archive.string()}, {"build", to_json(manifest.build)}};
  for (const auto& [kind, work] : work_of(manifest)) {
    json["units"][name_of(kind)] = {
        {"count", work.units}, {"cpu_s", work.cpu_s}, {"most_memory_bytes", work.most_bytes}};
    if (work.implied > 0) json["units"][name_of(kind)]["of_loose_scans"] = work.implied;
  }
  for (const auto* list : {&manifest.problems, &manifest.notes}) {
    Json& remarks = json[list == &manifest.problems ? "problems" : "notes"] = Json::array();
    for (const auto& [path, what] : *list) remarks.push_back({{"path", path}, {"what", what}});
  }
  return json;
}

std::string list_units(const Manifest& manifest) {
  std::string text = fmt::format("{:>6}  {:<6}  {:>9}  {:>8}  {:<10}  {}\n", "unit", "kind", "CPU s", "GiB",
                                 "needs", "id: what");
  for (const Unit& unit : manifest.units)
    text += fmt::format("{:>6}  {:<6}  {:>9.1f}  {:>8.2f}  {:<10}  {}: {}\n", unit.number, name_of(unit.kind),
                        unit.estimate_s, static_cast<double>(unit.estimate_bytes) / (1 << 30),
                        ranges_of(unit.needs), unit.id, subject_of(unit));
  return text;
}

}  // namespace hybrid::archive
