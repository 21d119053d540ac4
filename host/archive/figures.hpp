#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace hybrid::archive {

// A figure of a summary.json: of what ("scan west", "view front", "left out 000.jpg", "scene"), and which
// ("registration/icp_rms_m").
using FigureName = std::pair<std::string, std::string>;

// All numbers (true is 1), and the texts (a status, how a pose was found), of a summary.json, in the order
// of their names; "scene" "failures" is their number. Without inputs, options and lists (histograms,
// directions), which are no figures.
std::map<FigureName, nlohmann::ordered_json> figures_of(const nlohmann::ordered_json& summary);

}  // namespace hybrid::archive
