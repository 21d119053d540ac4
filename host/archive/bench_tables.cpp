// What people read of a bench: a table on the terminal, a page in the browser.
#include <fmt/format.h>

#include "archive/profile_bench.hpp"
#include "io/output.hpp"
#include "report/html.hpp"

namespace hybrid::archive {
namespace {

using report::Json;

// Those that tell quality, in this order, with their unit and the factor to it.
struct Quality {
  const char *name, *title;
  double factor;
};
constexpr Quality kQualities[] = {
    {"score/planes/planar_samples_right_share", "planar samples right, %", 100},
    {"score/planes/planes_found", "planes found per scan", 1},
    {"score/planes/curved_called_planar_share", "curved called planar, %", 100},
    {"score/planes/boundary/displaced/share_beyond_1_sample", "borders displaced, %", 100},
    {"score/pose/translation_mm", "pose error, mm", 1},
    {"score/pose/rotation_deg", "pose error, deg", 1},
    {"score/psnr_db", "views, PSNR dB", 1},
    {"score/ssim", "views, SSIM", 1},
    {"score/red_though_seen_share", "red though seen, %", 100},
    {"score/bleeding_share", "bleeding, %", 100},
    {"registration/icp_rms_m", "ICP rms, mm", 1000},
    {"registration/residuals/median_m", "distance from model, median mm", 1000},
    {"superclusters", "superclusters per scan", 1},
    {"decimation/discarded_share", "discarded, %", 100},
    {"left_out/psnr_db", "left-out photographs, PSNR dB", 1},
    {"left_out/ssim", "left-out photographs, SSIM", 1},
    {"failures", "failed parts per scene", 1},
};

const Json* find(const Json& bench, const std::string& name) {
  for (const auto& row : bench["figures"])
    if (row["name"] == name) return &row;
  return nullptr;
}

// {"title", "values"}: quality, then time and what failed.
std::vector<std::pair<std::string, std::vector<double>>> chosen_rows(const Json& bench) {
  std::vector<std::pair<std::string, std::vector<double>>> rows;
  for (const Quality& quality : kQualities)
    if (const Json* row = find(bench, quality.name)) {
      rows.emplace_back(quality.title, (*row)["mean"].get<std::vector<double>>());
      for (double& value : rows.back().second) value *= quality.factor;
    }
  const auto fact = [&](const char* key, const char* title, double factor) {
    rows.emplace_back(title, std::vector<double>());
    for (const auto& profile : bench["profiles"])
      rows.back().second.push_back(factor * profile[key].get<double>());
  };
  fact("failures", "units not done", 1);
  fact("cpu_s", "CPU seconds", 1);
  fact("seconds", "seconds of all units", 1);
  fact("peak_memory_bytes", "peak memory of a unit, MB", 1e-6);
  return rows;
}

}  // namespace

std::string bench_text(const Json& bench) {
  std::string text = fmt::format("{:<34}", "mean over scenes");
  for (const auto& profile : bench["profiles"])
    text += fmt::format(" {:>14}", profile["name"].get<std::string>());
  text += "\n";
  for (const auto& [title, values] : chosen_rows(bench)) {
    text += fmt::format("{:<34}", title);
    for (const double value : values) text += fmt::format(" {:>14.5g}", value);
    text += "\n";
  }
  return text;
}

void write_bench_page(const std::filesystem::path& folder, const Json& bench) {
  report::Table chosen, all, scenes;
  chosen.text("mean over scenes");
  all.text("figure").number("scenes", "", 0);
  scenes.text("scene").text("figure");
  const auto number = [](double value) {
    return Json{{"value", value}, {"text", fmt::format("{:.6g}", value)}};
  };
  for (const auto& profile : bench["profiles"]) {
    const auto name = profile["name"].get<std::string>();
    chosen.number(name, "", 4);
    all.number(name, "mean", 6).number(name + " ", "least", 6).number(name + "  ", "most", 6);
    scenes.number(name, "", 6);
  }
  for (const auto& [title, values] : chosen_rows(bench)) {
    Json row = {title};
    for (const double value : values) row.push_back(number(value));
    chosen.add(row);
  }
  for (const auto& figure : bench["figures"]) {
    Json row = {figure["name"], figure["scenes"]};
    for (std::size_t i = 0; i < figure["mean"].size(); ++i)
      for (const char* which : {"mean", "least", "most"})
        row.push_back(number(figure[which][i].get<double>()));
    all.add(row);
  }
  for (const auto& one : bench["scenes"]) {
    Json row = {one["result"], one["figure"]};
    for (const auto& value : one["values"])
      row.push_back(value.is_null() ? value : number(value.get<double>()));
    scenes.add(row);
  }
  std::string body = chosen.html();
  if (!all.empty()) body += "<h2>All figures</h2>\n" + all.html();
  if (!scenes.empty())
    body += "<h2>Scene by scene</h2>\n<details><summary>every figure of every scene</summary>\n" +
            scenes.html() + "</details>\n";
  io::write_text(folder / "index.html",
                 report::page("Profiles compared on " + bench["archive"].get<std::string>(), body, ""));
}

}  // namespace hybrid::archive
