#include "report/archive_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "io/output.hpp"

namespace hybrid::report {
namespace {

const char* css_of(const std::string& state) {
  return state == "done" ? "good" : state == "waiting" || state == "partial" ? "warn" : "bad";
}

std::size_t with_status(const Json& summary, const char* status) {
  if (!summary.contains("scans")) return 0;
  return static_cast<std::size_t>(
      std::count_if(summary["scans"].begin(), summary["scans"].end(), [&](const Json& scan) {
        return scan.contains("registration") && scan["registration"].value("status", "") == status;
      }));
}

// Of all scans of a scene the worst or the mean of a figure; null when none has it.
enum class Of { worst_high, worst_low, mean, sum };
Json over_scans(const Json& summary, const char* pointer, double factor, Of how) {
  Json result;
  double total = 0;
  int count = 0;
  if (!summary.contains("scans")) return nullptr;
  for (const auto& scan : summary["scans"]) {
    const Json value = cell(scan, pointer, factor);
    if (value.is_null()) continue;
    const double number = value.get<double>();
    total += number;
    ++count;
    if (result.is_null() || (how == Of::worst_high && number > result.get<double>()) ||
        (how == Of::worst_low && number < result.get<double>()))
      result = number;
  }
  if (count == 0 || how == Of::worst_high || how == Of::worst_low) return result;
  return how == Of::mean ? total / count : total;
}

Json named(const Json& row) {
  Json name = {{"text", row["result"]}};
  if (row["page"].is_string()) name["href"] = link(row["page"].get<std::string>());
  return name;
}

Json state_cell(const Json& row) {
  const std::string state = row["state"].get<std::string>();
  return {{"text", state}, {"state", css_of(state)}};
}

std::string scene_table(const Json& archive) {
  Table table;
  table.text("scene")
      .text("state")
      .number("scans", "", 0)
      .number("registered", "", 0)
      .number("abstained", "", 0)
      .number("failures", "", 0)
      .number("samples", "million", 3)
      .number("superclusters", "", 0)
      .number("discarded", "%", 1, "mean of the scans")
      .number("ICP rms", "mm", 2, "of the worst scan")
      .number("median", "mm", 2, "distance of planar samples from the model, worst scan")
      .number("95 %", "mm", 1, "of planar samples are within, worst scan")
      .number("overlap", "%", 1, "of the worst scan")
      .number("pose error", "mm", 3, "against truth, worst scan")
      .number("planar right", "%", 2, "against truth, worst scan")
      .number("views", "", 0)
      .number("PSNR", "dB", 2, "mean of photographs left out")
      .number("SSIM", "", 3, "mean of photographs left out");
  for (const auto& row : archive["results"]) {
    if (row["kind"] != "scene") continue;
    const Json& summary = row["summary"];
    table.add({named(row), state_cell(row),
               summary.contains("scans") ? Json(summary["scans"].size()) : Json(),
               with_status(summary, "accepted"), with_status(summary, "abstained"),
               summary.contains("failures") ? Json(summary["failures"].size()) : Json(),
               over_scans(summary, "/input_returns", 1e-6, Of::sum),
               over_scans(summary, "/superclusters", 1, Of::sum),
               over_scans(summary, "/decimation/discarded_share", 100, Of::mean),
               over_scans(summary, "/registration/icp_rms_m", 1000, Of::worst_high),
               over_scans(summary, "/registration/residuals/median_m", 1000, Of::worst_high),
               over_scans(summary, "/registration/residuals/p95_m", 1000, Of::worst_high),
               over_scans(summary, "/registration/overlap", 100, Of::worst_low),
               over_scans(summary, "/truth/pose_error_mm", 1, Of::worst_high),
               over_scans(summary, "/truth/planar_samples_right_share", 100, Of::worst_low),
               summary.contains("views") ? Json(summary["views"].size()) : Json(),
               cell(summary, "/leave_one_out/mean/psnr_db"), cell(summary, "/leave_one_out/mean/ssim")});
  }
  return table.empty() ? "" : "<h2 id=\"scenes\">Scenes</h2>\n" + table.html();
}

std::string loose_table(const Json& archive) {
  Table table;
  table.text("scan")
      .text("state")
      .number("samples", "", 0)
      .number("noise", "mm", 2)
      .number("superclusters", "", 0)
      .number("discarded", "%", 1)
      .number("notes", "", 0)
      .text("picture");
  for (const auto& row : archive["results"]) {
    if (row["kind"] != "planes") continue;
    const Json& summary = row["summary"];
    const Json scan = summary.contains("scans") && !summary["scans"].empty() ? summary["scans"][0] : Json();
    Json shown;
    if (!row["pictures"].empty())
      shown = {{"text", "planes"}, {"href", link(row["pictures"][0]["file"].get<std::string>())}};
    table.add({named(row), state_cell(row), cell(scan, "/input_returns"), cell(scan, "/sigma_m", 1000),
               cell(scan, "/superclusters"), cell(scan, "/decimation/discarded_share", 100),
               scan.contains("notes") ? Json(scan["notes"].size()) : Json(), shown});
  }
  return table.empty() ? "" : "<h2 id=\"loose\">Scans without a scene</h2>\n" + table.html();
}

// Closed at first: the pictures, which are those of the scenes' own pages, are loaded when they are looked
// at.
std::string class_pictures(const Json& archive) {
  std::string html;
  std::size_t count = 0;
  for (const auto& row : archive["results"]) {
    if (row["kind"] != "scene" || !row["page"].is_string()) continue;
    for (const auto& picture : row["pictures"]) {
      ++count;
      html += figure(picture["file"].get<std::string>(), row["page"].get<std::string>(),
                     row["result"].get<std::string>() + ": scan " + picture["scan"].get<std::string>());
    }
  }
  if (html.empty()) return "";
  return fmt::format(
      "<details><summary>pictures of {} scans: planes pastel, what is none dark</summary>"
      "<div class=\"row small\">\n{}</div></details>\n",
      count, html);
}

std::string abstained_table(const Json& archive) {
  Table table;
  table.text("scene").text("scan").text("why");
  for (const auto& row : archive["results"]) {
    if (!row["summary"].contains("scans")) continue;
    for (const auto& scan : row["summary"]["scans"])
      if (scan.contains("registration") && scan["registration"].value("status", "") == "abstained") {
        Json name = named(row);
        if (name.contains("href")) name["href"] = name["href"].get<std::string>() + "#abstained";
        table.add({name, scan["id"], scan["registration"].value("reason", "")});
      }
  }
  return table.empty()
             ? ""
             : "<h2 id=\"abstained\">Scans without a pose</h2>\n<p>Why stands "
               "beside each; where the scene has a model, its page shows the landmark sheet to fill "
               "in.</p>\n" +
                   table.html();
}

std::string failure_list(const Json& archive) {
  std::string html;
  for (const auto& row : archive["results"]) {
    if (!row.contains("error")) continue;
    html += fmt::format("<li><strong>{}</strong> <span class=\"{}\">{}: {}</span>",
                        escape(row["result"].get<std::string>()), css_of(row["state"].get<std::string>()),
                        escape(row["state"].get<std::string>()), escape(row["error"].get<std::string>()));
    if (row.contains("command"))
      html += fmt::format("<br>run it again: <code data-store>{}</code>",
                          escape(row["command"].get<std::string>()));
    else
      html +=
          "<br>again once its input is mended: <code>hybrid batch plan</code>, <code>hybrid batch run</code>";
    html += "</li>\n";
  }
  if (!html.empty())
    html =
        "<h2 id=\"failures\">Failures</h2>\n<p id=\"store\">STORE stands for the folder that holds "
        "results/report/, where this page is.</p>\n<ul>\n" +
        html + "</ul>\n";
  std::string problems;
  for (const auto& problem : archive["problems"])
    problems += fmt::format("<li><strong>{}</strong>: {}</li>\n", escape(problem["path"].get<std::string>()),
                            escape(problem["what"].get<std::string>()));
  if (!problems.empty())
    html += "<h2 id=\"problems\">What the plan could not use</h2>\n<ul>\n" + problems + "</ul>\n";
  return html;
}

std::string facts(const Json& archive) {
  std::map<std::string, std::size_t> states;
  std::size_t scans = 0, registered = 0, abstained = 0;
  for (const auto& row : archive["results"]) {
    ++states[row["state"].get<std::string>()];
    scans += row["summary"].contains("scans") ? row["summary"]["scans"].size() : 0;
    registered += with_status(row["summary"], "accepted");
    abstained += with_status(row["summary"], "abstained");
  }
  std::string html = "<ul class=\"facts\">\n";
  for (const auto& [state, count] : states)
    html += fmt::format("<li class=\"{}\">{} {}</li>\n", css_of(state), count, state);
  html += fmt::format("<li>{} scans</li>\n", scans);
  if (registered > 0) html += fmt::format("<li class=\"good\">{} registered</li>\n", registered);
  if (abstained > 0) html += fmt::format("<li class=\"warn\">{} abstained</li>\n", abstained);
  return html + "</ul>\n";
}

}  // namespace

void write_archive_page(const std::filesystem::path& folder, const std::string& title, const Json& archive) {
  io::write_text(folder / "index.html",
                 page(title,
                      facts(archive) + failure_list(archive) + scene_table(archive) +
                          class_pictures(archive) + abstained_table(archive) + loose_table(archive) +
                          "<h2>Times</h2>\n<div id=\"timing\"></div>\n",
                      "report/timing.js"));
}

}  // namespace hybrid::report
