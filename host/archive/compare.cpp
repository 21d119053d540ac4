#include "archive/compare.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "archive/figures.hpp"
#include "archive/outcome.hpp"
#include "archive/verdict.hpp"
#include "core/interrupt.hpp"
#include "core/json_text.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Where a unit stands on a night.
struct Stand {
  const Store* store = nullptr;
  const Unit* unit = nullptr;
  Outcome outcome;
  bool has_object() const { return outcome.state == UnitState::done || outcome.state == UnitState::partial; }
};

// By result: the names that mean the same on both sides. The report tells of the others.
std::map<std::string, Stand> stands(const Night& night) {
  std::map<std::string, Stand> found;
  Outcomes outcomes(night.store, night.manifest);
  for (const Unit& unit : night.manifest.units)
    if (!unit.result.empty() && unit.kind != UnitKind::report)
      found[unit.result] = {&night.store, &unit, outcomes.of(unit.index)};
  return found;
}

// Leaves of what a key was made from, by path; elements that name a file or an id under that name. Keys of
// other units are left out: their own inputs say more.
void leaves(const Json& value, const std::string& path, std::map<std::string, std::string>& found) {
  const auto below = [&](const std::string& name) { return path.empty() ? name : path + "/" + name; };
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      if (key != "planes" || !inner.is_array()) leaves(inner, below(key), found);
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      std::string name = std::to_string(i);
      if (value[i].is_object() && value[i].contains("file")) name = value[i]["file"].get<std::string>();
      leaves(value[i], below(name), found);
    }
  } else {
    found[path] = json_text(value, -1);
  }
}

std::string in_words(const std::string& path) {
  for (const char* list : {"inputs/", "scans/"})
    if (path.starts_with(list) && path.ends_with("/xxh3"))
      return "input " + path.substr(std::string(list).size(), path.size() - std::string(list).size() - 5);
  if (path == "scene") return "the scene file";
  if (path == "scan/xxh3") return "the scan";
  return path;
}

Json differences(const Json& a, const Json& b) {
  std::map<std::string, std::string> before, after;
  leaves(a, "", before);
  leaves(b, "", after);
  Json list = Json::array();
  const auto note = [&](const std::string& path) {
    const std::string words = in_words(path);
    if (std::find(list.begin(), list.end(), words) == list.end() && !path.ends_with("/file"))
      list.push_back(words);
  };
  for (const auto& [path, value] : before)
    if (const auto other = after.find(path); other == after.end() || other->second != value) note(path);
  for (const auto& [path, value] : after)
    if (!before.count(path)) note(path);
  return list;
}

Json summary_of(const Stand& stand) {
  if (!stand.has_object()) return Json::object();
  const fs::path file = stand.store->object(stand.outcome.key) / "summary.json";
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return Json::object();
  const Json summary = Json::parse(io::read_text(file), nullptr, false);
  return summary.is_discarded() ? Json::object() : summary;
}

using Figures = std::map<FigureName, Json>;

std::map<std::string, std::size_t> subjects_of(const Figures& figures) {
  std::map<std::string, std::size_t> counts;
  for (const auto& [name, value] : figures) ++counts[name.first];
  return counts;
}

Json moved_figure(const FigureName& name, const Json& before, const Json& after,
                  const io::ThresholdFile& thresholds) {
  Json row = {{"of", name.first}, {"figure", name.second}, {"before", before}, {"after", after}};
  if (before.is_number() && after.is_number()) {
    const double a = before.get<double>(), change = after.get<double>() - a;
    row["change"] = change;
    row["relative"] = a != 0 ? Json(change / std::abs(a)) : Json(nullptr);
  }
  row["verdict"] = name_of(judge(thresholds, name.second, before, after));
  return row;
}

// A scan or view that is on one side alone is one row, not all of its figures: worse when it had a pose.
void add_lone_subjects(const Figures& before, const Figures& after, Json& list) {
  const auto had = subjects_of(before), has = subjects_of(after);
  for (const auto& [subject, count] : had) {
    if (has.count(subject)) continue;
    const auto status = before.find({subject, "registration/status"});
    const bool posed = status != before.end() && status->second == "accepted";
    list.push_back({{"of", subject},
                    {"figure", "all figures"},
                    {"before", count},
                    {"after", nullptr},
                    {"verdict", name_of(posed ? Verdict::worse : Verdict::moved)}});
  }
  for (const auto& [subject, count] : has)
    if (!had.count(subject))
      list.push_back({{"of", subject},
                      {"figure", "all figures"},
                      {"before", nullptr},
                      {"after", count},
                      {"verdict", name_of(Verdict::moved)}});
}

Json moved_figures(const Json& a, const Json& b, const io::ThresholdFile& thresholds) {
  const auto before = figures_of(a), after = figures_of(b);
  const auto had = subjects_of(before), has = subjects_of(after);
  Json list = Json::array();
  add_lone_subjects(before, after, list);
  for (const auto& [name, value] : before) {
    if (!has.count(name.first)) continue;
    const auto other = after.find(name);
    if (other == after.end())
      list.push_back(moved_figure(name, value, nullptr, thresholds));
    else if (other->second != value)
      list.push_back(moved_figure(name, value, other->second, thresholds));
  }
  for (const auto& [name, value] : after)
    if (had.count(name.first) && !before.count(name))
      list.push_back(moved_figure(name, nullptr, value, thresholds));
  return list;
}

bool is_picture(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  return (extension == ".png" || extension == ".jpg") && path.find("report/pictures/") == std::string::npos;
}

std::map<std::string, std::string> pictures_of(const Stand& stand) {
  std::map<std::string, std::string> pictures;
  if (!stand.has_object()) return pictures;
  const Json object = stand.store->object_json(stand.outcome.key);
  for (const auto& file : object["files"])
    if (const auto path = file.at("path").get<std::string>(); is_picture(path))
      pictures[path] = file.at("xxh3").get<std::string>();
  return pictures;
}

Json changed_pictures(const Stand& a, const Stand& b) {
  const auto before = pictures_of(a), after = pictures_of(b);
  Json list = Json::array();
  for (const auto& [path, print] : before) {
    const auto other = after.find(path);
    if (other == after.end())
      list.push_back({{"path", path}, {"change", "removed"}});
    else if (other->second != print)
      list.push_back({{"path", path}, {"change", "changed"}});
  }
  for (const auto& [path, print] : after)
    if (!before.count(path)) list.push_back({{"path", path}, {"change", "added"}});
  return list;
}

// What a scene is worth: done before partial before nothing.
int rank(const Stand& stand) {
  return stand.outcome.state == UnitState::done ? 2 : stand.outcome.state == UnitState::partial ? 1 : 0;
}

Json compare_result(const std::string& result, const Stand& a, const Stand& b,
                    const io::ThresholdFile& thresholds) {
  const auto state = [](const Stand& stand) {
    return stand.unit ? Json(name_of(stand.outcome.state)) : Json(nullptr);
  };
  const auto key = [](const Stand& stand) {
    return stand.has_object() ? Json(stand.outcome.key) : Json(nullptr);
  };
  Json row = {{"result", result},
              {"change", !a.unit   ? "added"
                         : !b.unit ? "removed"
                                   : "changed"},
              {"state", {state(a), state(b)}},
              {"objects", {key(a), key(b)}}};
  if (!b.outcome.error.empty()) row["error"] = b.outcome.error;
  row["verdict"] = name_of(rank(b) < rank(a)   ? Verdict::worse
                           : rank(b) > rank(a) ? Verdict::better
                                               : Verdict::moved);
  row["because"] =
      a.unit && b.unit ? differences(Json::parse(a.unit->from), Json::parse(b.unit->from)) : Json::array();
  row["figures"] = a.has_object() && b.has_object() ? moved_figures(summary_of(a), summary_of(b), thresholds)
                                                    : Json::array();
  row["pictures"] = a.has_object() && b.has_object() ? changed_pictures(a, b) : Json::array();
  return row;
}

Json described(const Night& night) {
  return {{"store", night.store.folder().string()},
          {"night", night.name},
          {"archive", night.manifest.archive.string()}};
}

std::string number(const Json& value) {
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.is_null() ? "none" : json_text(value, -1);
}

std::string figure_line(const Json& row) {
  std::string text =
      fmt::format("  {:<6} {}: {}: {} -> {}", row["verdict"].get<std::string>(), row["of"].get<std::string>(),
                  row["figure"].get<std::string>(), number(row["before"]), number(row["after"]));
  if (row.contains("change"))
    text += row["relative"].is_null() ? fmt::format(" ({:+.3g})", row["change"].get<double>())
                                      : fmt::format(" ({:+.3g}, {:+.2f} %)", row["change"].get<double>(),
                                                    100 * row["relative"].get<double>());
  return text + "\n";
}

}  // namespace

Json compare_nights(const Night& a, const Night& b, const io::ThresholdFile& thresholds) {
  const auto before = stands(a), after = stands(b);
  std::map<std::string, std::pair<Stand, Stand>> pairs;
  for (const auto& [result, stand] : before) pairs[result].first = stand;
  for (const auto& [result, stand] : after) pairs[result].second = stand;
  std::map<std::string, std::size_t> counts = {{"same", 0},   {"changed", 0}, {"added", 0}, {"removed", 0},
                                               {"better", 0}, {"moved", 0},   {"worse", 0}};
  Json results = Json::array();
  for (const auto& [result, pair] : pairs) {
    check_interrupted();
    const auto& [x, y] = pair;
    if (x.unit && y.unit && x.outcome.key == y.outcome.key && x.outcome.state == y.outcome.state) {
      ++counts["same"];
      continue;
    }
    Json row = compare_result(result, x, y, thresholds);
    ++counts[row["change"].get<std::string>()];
    if (row["verdict"] != "moved") ++counts[row["verdict"].get<std::string>()];
    for (const auto& figure : row["figures"]) ++counts[figure["verdict"].get<std::string>()];
    results.push_back(std::move(row));
  }
  return {{"a", described(a)},
          {"b", described(b)},
          {"build", differences(to_json(a.manifest.build), to_json(b.manifest.build))},
          {"counts", counts},
          {"results", results}};
}

std::string comparison_text(const Json& comparison) {
  const auto& counts = comparison["counts"];
  const auto count = [&](const char* name) { return counts[name].get<std::size_t>(); };
  std::string text = fmt::format("{} results the same, {} changed, {} added, {} removed\n", count("same"),
                                 count("changed"), count("added"), count("removed"));
  for (const auto& result : comparison["results"]) {
    const auto& state = result["state"];
    text += fmt::format("{}: {}", result["result"].get<std::string>(), result["change"].get<std::string>());
    if (state[0] != state[1]) text += fmt::format(", {} -> {}", number(state[0]), number(state[1]));
    if (result["verdict"] == "worse") text += ": worse";
    if (!result["because"].empty()) {
      text += "; because of ";
      for (std::size_t i = 0; i < result["because"].size(); ++i)
        text += (i == 0 ? "" : ", ") + result["because"][i].get<std::string>();
    }
    text += "\n";
    if (result.contains("error")) text += "  " + result["error"].get<std::string>() + "\n";
    for (const char* verdict : {"worse", "better", "moved"})
      for (const auto& row : result["figures"])
        if (row["verdict"] == verdict) text += figure_line(row);
    if (!result["pictures"].empty()) text += fmt::format("  {} pictures differ\n", result["pictures"].size());
  }
  return text + fmt::format("{} figures and states better, {} worse, {} moved otherwise\n", count("better"),
                            count("worse"), count("moved"));
}

int exit_code(const Json& comparison) {
  return comparison["counts"]["worse"].get<std::size_t>() > 0 ? 3 : 0;
}

}  // namespace hybrid::archive
