#include "archive/figures.hpp"

#include <set>

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
using Figures = std::map<FigureName, Json>;

void take(const Json& value, const std::string& subject, const std::string& name, Figures& figures) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      take(inner, subject, name.empty() ? key : name + "/" + key, figures);
    return;
  }
  if (value.is_boolean())
    figures[{subject, name}] = value.get<bool>() ? 1 : 0;
  else if (value.is_number() || value.is_string())
    figures[{subject, name}] = value;
}

void take_list(const Json& summary, const char* list, const char* key, const std::string& prefix,
               Figures& figures) {
  if (!summary.contains(list) || !summary[list].is_array()) return;
  for (Json one : summary[list]) {
    if (!one.is_object() || !one.contains(key) || !one[key].is_string()) continue;
    const std::string subject = prefix + one[key].get<std::string>();
    one.erase(key);
    take(one, subject, "", figures);
  }
}

}  // namespace

Figures figures_of(const Json& summary) {
  static const std::set<std::string> kNoFigures = {"program", "inputs", "options",  "scene",
                                                   "scans",   "views",  "failures", "photographs"};
  Figures figures;
  if (!summary.is_object()) return figures;
  take_list(summary, "scans", "id", "scan ", figures);
  take_list(summary, "views", "name", "view ", figures);
  if (summary.contains("leave_one_out"))
    take_list(summary["leave_one_out"], "photographs", "photograph", "left out ", figures);
  if (summary.contains("failures")) figures[{"scene", "failures"}] = summary["failures"].size();
  for (const auto& [key, value] : summary.items())
    if (kNoFigures.count(key) == 0) take(value, "scene", key, figures);
  return figures;
}

}  // namespace hybrid::archive
