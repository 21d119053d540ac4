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

Table scene_columns() {
  Table table;
  table.text("scene")
      .text("state")
      .number("scans", "", 0)
      .number("registered", "", 0)
      .number("abstained", "", 0)
      .number("failures", "", 0)
      .number("warnings", "", 0, "of the scene, and of its scans' registration")
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
  return table;
}

Json warnings_of(const Json& summary) {
  if (!summary.contains("scans")) return nullptr;
  std::size_t count = summary.contains("warnings") ? summary["warnings"].size() : 0;
  for (const auto& scan : summary["scans"])
    if (scan.contains("registration") && scan["registration"].contains("warnings"))
      count += scan["registration"]["warnings"].size();
  return count;
}

Table loose_columns() {
  Table table;
  table.text("scan")
      .text("state")
      .number("samples", "", 0)
      .number("noise", "mm", 2)
      .number("superclusters", "", 0)
      .number("discarded", "%", 1)
      .number("notes", "", 0)
      .text("picture");
  return table;
}

Table abstained_columns() {
  Table table;
  table.text("scene").text("scan").text("why");
  return table;
}

}  // namespace

ArchivePage::ArchivePage()
    : scenes_(scene_columns()), loose_(loose_columns()), abstained_(abstained_columns()) {}

void ArchivePage::add(const Json& row) {
  const Json& summary = row["summary"];
  ++count_of_state_[row["state"].get<std::string>()];
  scan_count_ += summary.contains("scans") ? summary["scans"].size() : 0;
  registered_count_ += with_status(summary, "accepted");
  if (row["kind"] == "scene") {
    add_scene(row);
    add_pictures(row);
  } else {
    add_loose(row);
  }
  add_abstained(row);
  if (row.contains("error")) add_failure(row);
}

void ArchivePage::add_problem(const std::string& path, const std::string& what) {
  problems_ += fmt::format("<li><strong>{}</strong>: {}</li>\n", escape(path), escape(what));
}

void ArchivePage::add_scene(const Json& row) {
  const Json& summary = row["summary"];
  scenes_.add({named(row), state_cell(row),
               summary.contains("scans") ? Json(summary["scans"].size()) : Json(),
               with_status(summary, "accepted"), with_status(summary, "abstained"),
               summary.contains("failures") ? Json(summary["failures"].size()) : Json(), warnings_of(summary),
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

void ArchivePage::add_loose(const Json& row) {
  const Json& summary = row["summary"];
  const Json scan = summary.contains("scans") && !summary["scans"].empty() ? summary["scans"][0] : Json();
  Json shown;
  if (!row["pictures"].empty())
    shown = {{"text", "planes"}, {"href", link(row["pictures"][0]["file"].get<std::string>())}};
  loose_.add({named(row), state_cell(row), cell(scan, "/input_returns"), cell(scan, "/sigma_m", 1000),
              cell(scan, "/superclusters"), cell(scan, "/decimation/discarded_share", 100),
              scan.contains("notes") ? Json(scan["notes"].size()) : Json(), shown});
}

void ArchivePage::add_pictures(const Json& row) {
  if (!row["page"].is_string()) return;
  for (const auto& picture : row["pictures"]) {
    ++picture_count_;
    pictures_ += figure(picture["file"].get<std::string>(), row["page"].get<std::string>(),
                        row["result"].get<std::string>() + ": scan " + picture["scan"].get<std::string>());
  }
}

void ArchivePage::add_abstained(const Json& row) {
  if (!row["summary"].contains("scans")) return;
  for (const auto& scan : row["summary"]["scans"]) {
    if (!scan.contains("registration") || scan["registration"].value("status", "") != "abstained") continue;
    ++abstained_count_;
    Json name = named(row);
    if (name.contains("href")) name["href"] = name["href"].get<std::string>() + "#abstained";
    abstained_.add({name, scan["id"], scan["registration"].value("reason", "")});
  }
}

void ArchivePage::add_failure(const Json& row) {
  failures_ += fmt::format("<li><strong>{}</strong> <span class=\"{}\">{}: {}</span>",
                           escape(row["result"].get<std::string>()), css_of(row["state"].get<std::string>()),
                           escape(row["state"].get<std::string>()), escape(row["error"].get<std::string>()));
  if (row.contains("command"))
    failures_ += fmt::format("<br>run it again: <code data-store>{}</code>",
                             escape(row["command"].get<std::string>()));
  else
    failures_ +=
        "<br>again once its input is mended: <code>hybrid batch plan</code>, <code>hybrid batch run</code>";
  failures_ += "</li>\n";
}

std::string ArchivePage::facts() const {
  std::string html = "<ul class=\"facts\">\n";
  for (const auto& [state, count] : count_of_state_)
    html += fmt::format("<li class=\"{}\">{} {}</li>\n", css_of(state), count, state);
  html += fmt::format("<li>{} scans</li>\n", scan_count_);
  if (registered_count_ > 0)
    html += fmt::format("<li class=\"good\">{} registered</li>\n", registered_count_);
  if (abstained_count_ > 0) html += fmt::format("<li class=\"warn\">{} abstained</li>\n", abstained_count_);
  return html + "</ul>\n";
}

// Pictures closed at first: those of the scenes' own pages, loaded when they are looked at.
void ArchivePage::write(const std::filesystem::path& folder, const std::string& title) const {
  std::string html = facts();
  if (!failures_.empty())
    html +=
        "<h2 id=\"failures\">Failures</h2>\n<p id=\"store\">STORE stands for the folder that holds "
        "results/report/, where this page is.</p>\n<ul>\n" +
        failures_ + "</ul>\n";
  if (!problems_.empty())
    html += "<h2 id=\"problems\">What the plan could not use</h2>\n<ul>\n" + problems_ + "</ul>\n";
  if (!scenes_.empty()) html += "<h2 id=\"scenes\">Scenes</h2>\n" + scenes_.html();
  if (!pictures_.empty())
    html += fmt::format(
        "<details><summary>pictures of {} scans: planes pastel, what is none dark</summary>"
        "<div class=\"row small\">\n{}</div></details>\n",
        picture_count_, pictures_);
  if (!abstained_.empty())
    html +=
        "<h2 id=\"abstained\">Scans without a pose</h2>\n<p>Why stands beside each; its page shows where it "
        "may stand and, where the scene has a model, the landmark sheet to fill in.</p>\n" +
        abstained_.html();
  if (!loose_.empty()) html += "<h2 id=\"loose\">Scans without a scene</h2>\n" + loose_.html();
  io::write_text(folder / "index.html",
                 page(title, html + "<h2>Times</h2>\n<div id=\"timing\"></div>\n", "report/timing.js"));
}

}  // namespace hybrid::report
