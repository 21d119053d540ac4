// The archive's page: every result of the night, its figures, what failed. A function of the units' objects,
// so that it has the same bytes whenever and wherever it is made.
#include "archive/unit_run.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "io/output.hpp"
#include "report/archive_page.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

bool has_object(const Outcome& outcome) {
  return outcome.state == UnitState::done || outcome.state == UnitState::partial;
}

Json summary_of(const Store& store, const Outcome& outcome) {
  const fs::path file = store.object(outcome.key) / "summary.json";
  std::error_code ignored;
  if (!has_object(outcome) || !fs::exists(file, ignored)) return nullptr;
  const Json summary = Json::parse(io::read_text(file), nullptr, false);
  return summary.is_discarded() ? Json(nullptr) : summary;
}

// From results/report/index.html, which is how people come to it.
Json page_of(const Unit& unit, const Outcome& outcome) {
  if (!has_object(outcome)) return nullptr;
  return unit.kind == UnitKind::scene ? "../" + unit.result + "/report/index.html"
                                      : "../" + unit.result + "/";
}

// Class pictures, where they lie: the smaller ones that a scene's page has, those of a loose scan themselves.
Json pictures_of(const Store& store, const Unit& unit, const Outcome& outcome, const Json& summary) {
  Json pictures = Json::array();
  if (!summary.is_object() || !summary.contains("scans")) return pictures;
  for (const auto& scan : summary["scans"]) {
    const std::string id = scan["id"].get<std::string>();
    const std::string file = unit.kind == UnitKind::scene ? "report/pictures/scans/" + id + "/classes.jpg"
                                                          : "scans/" + id + "/classes.png";
    std::error_code ignored;
    if (fs::exists(store.object(outcome.key) / file, ignored))
      pictures.push_back({{"scan", id}, {"file", "../" + unit.result + "/" + file}});
  }
  return pictures;
}

// CPU seconds of the units that there are, as they were when these were made: for timing.js.
Json times_of(const Store& store, const Manifest& manifest, const Unit& report, Outcomes& outcomes) {
  Json times = Json::object();
  for (const std::size_t need : report.needs) {
    const Outcome& outcome = outcomes.of(need);
    if (!has_object(outcome)) continue;
    try {
      times[manifest.units[need].id] = store.record_json(outcome.key).value("cpu_s", 0.0);
    } catch (const Error& error) {  // verify tells of it; no page fails for a time
      log::warning("{}", error.what());
    }
  }
  return times;
}

Json row_of(const Store& store, const Unit& unit, Outcomes& outcomes) {
  const Outcome& outcome = outcomes.of(unit.index);
  const Json summary = summary_of(store, outcome);
  Json row = {{"result", unit.result},
              {"kind", name_of(unit.kind)},
              {"state", name_of(outcome.state)},
              {"page", page_of(unit, outcome)},
              {"pictures", pictures_of(store, unit, outcome, summary)},
              {"summary", summary}};
  if (outcome.error.empty()) return row;
  row["error"] = outcome.error;
  // What it needs and has not got, too. The store's own place is the reader's to know.
  std::string units;
  for (const std::size_t need : unit.needs)
    if (!has_object(outcomes.of(need))) units += std::to_string(need) + ",";
  if (units.empty() && has_object(outcome)) return row;  // the same again while its inputs are
  row["command"] = fmt::format("hybrid batch run --out STORE --unit {}{} --retry", units, unit.number);
  return row;
}

}  // namespace

UnitResult run_report_unit(const Store& store, const Manifest& manifest, const Unit& unit, Outcomes& outcomes,
                           const fs::path& work) {
  Json units = Json::array(), problems = Json::array();
  report::ArchivePage page;
  for (const std::size_t need : unit.needs) {
    const Unit& one = manifest.units[need];
    const Outcome& outcome = outcomes.of(need);
    Json row = {{"index", one.number},
                {"id", one.id},
                {"kind", name_of(one.kind)},
                {"state", name_of(outcome.state)},
                {"key", outcome.key}};
    if (!one.result.empty()) row["result"] = one.result;
    if (!outcome.error.empty()) row["error"] = outcome.error;
    units.push_back(std::move(row));
    if (!one.result.empty()) page.add(row_of(store, one, outcomes));
  }
  for (const auto& [path, what] : manifest.problems) {
    problems.push_back({{"path", path}, {"what", what}});
    page.add_problem(path, what);
  }
  io::write_text(work / "archive.json", json_text(Json{{"units", units}, {"problems", problems}}) + "\n");
  const fs::path named = manifest.archive.has_filename() ? manifest.archive : manifest.archive.parent_path();
  page.write(work, "Archive " + named.filename().string());
  const Json times = {{"cpu_s_by_unit", times_of(store, manifest, unit, outcomes)}};
  io::write_text(work / "report" / "timing.js", fmt::format("hybridTiming({});\n", json_text(times)));
  return {};
}

}  // namespace hybrid::archive
