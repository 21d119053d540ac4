#include "archive/compare_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/error.hpp"
#include "core/log.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "report/html.hpp"
#include "report/previews.hpp"

namespace hybrid::archive {
namespace {

using report::Json;
namespace fs = std::filesystem;

const char* state_of(const Json& verdict) {
  return verdict == "worse" ? "bad" : verdict == "better" ? "good" : "";
}

std::string joined(const Json& list) {
  std::string text;
  for (const auto& one : list) {
    if (!text.empty()) text += ", ";
    text += one.get<std::string>();
  }
  return text;
}

std::string result_table(const Json& comparison) {
  report::Table table;
  table.text("result").text("change").text("before").text("after").text("because").text("error");
  for (const auto& row : comparison["results"])
    table.add({row["result"],
               row["change"],
               row["state"][0],
               {{"text", row["state"][1].is_null() ? "none" : row["state"][1].get<std::string>()},
                {"state", state_of(row["verdict"])}},
               joined(row["because"]),
               row.contains("error") ? row["error"] : Json(nullptr)});
  return table.empty() ? "<p>No result differs.</p>\n" : table.html();
}

// Six digits, as many as a comparison needs, with the value beside for sorting.
Json shown(const Json& value, const char* state = "") {
  if (!value.is_number()) return value;
  return {{"value", value}, {"text", fmt::format("{:.6g}", value.get<double>())}, {"state", state}};
}

std::string figure_table(const Json& comparison) {
  report::Table table;
  table.text("result")
      .text("of")
      .text("figure")
      .number("before", "", 6)
      .number("after", "", 6)
      .number("change", "", 6)
      .number("relative", "%", 2)
      .text("verdict", "worse: by more than its threshold");
  for (const char* verdict : {"worse", "better", "moved"})
    for (const auto& result : comparison["results"])
      for (const auto& row : result["figures"])
        if (row["verdict"] == verdict)
          table.add({result["result"],
                     row["of"],
                     row["figure"],
                     shown(row["before"]),
                     shown(row["after"]),
                     row.contains("change") ? shown(row["change"], state_of(verdict)) : Json(nullptr),
                     report::cell(row, "/relative", 100),
                     {{"text", verdict}, {"state", state_of(verdict)}}});
  return table.empty() ? "<p>No figure moved.</p>\n" : table.html();
}

// Four times as strong, on black; nothing when their sizes differ.
Image8 difference(const Image8& a, const Image8& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) return {};
  Image8 result(a.width, a.height, a.channels);
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    result.pixels[i] =
        static_cast<std::uint8_t>(std::min(255, 4 * std::abs(int{a.pixels[i]} - int{b.pixels[i]})));
  return result;
}

constexpr int kWidth = 800, kQuality = 88;

std::string picture_row(const fs::path& folder, const std::string& result, const std::string& path,
                        const fs::path& before, const fs::path& after) {
  const std::string place = fs::path(result + "/" + path).replace_extension(".jpg").generic_string();
  const auto write = [&](const char* side, const Image8& picture, const std::string& caption) {
    const std::string file = std::string("pictures/") + side + "/" + place;
    io::write_jpeg(folder / file, report::shrink(picture, kWidth), kQuality);
    return report::figure(file, file, caption);
  };
  const Image8 a = io::read_photograph(before, 0, 0), b = io::read_photograph(after, 0, 0);
  const Image8 changed = difference(a, b);
  std::string html = "<h3>" + report::escape(result + ": " + path) + "</h3>\n<div class=\"row three\">\n" +
                     write("before", a, "before") + write("after", b, "after");
  html += changed.width > 0 ? write("difference", changed, "four times their difference")
                            : fmt::format("<p class=\"soft\">{} x {} pixels before, {} x {} after</p>\n",
                                          a.width, a.height, b.width, b.height);
  return html + "</div>\n";
}

std::string picture_section(const fs::path& folder, const Json& comparison, const Night& a, const Night& b,
                            std::size_t most) {
  std::string html, others;
  std::size_t count = 0;
  // Pictures of single planes are many: they come after the others.
  for (const bool of_planes : {false, true})
    for (const auto& result : comparison["results"])
      for (const auto& picture : result["pictures"]) {
        if ((picture["path"].get<std::string>().find("/planes/") != std::string::npos) != of_planes) continue;
        const std::string name = result["result"].get<std::string>(),
                          path = picture["path"].get<std::string>();
        if (picture["change"] != "changed") {
          others += "<li>" +
                    report::escape(name + ": " + path + ": " + picture["change"].get<std::string>()) +
                    "</li>\n";
          continue;
        }
        if (count++ >= most) continue;
        html +=
            picture_row(folder, name, path, a.store.object(result["objects"][0].get<std::string>()) / path,
                        b.store.object(result["objects"][1].get<std::string>()) / path);
      }
  if (count > most) html += fmt::format("<p>{} more pictures changed.</p>\n", count - most);
  if (!others.empty()) html += "<h3>On one side only</h3>\n<ul>\n" + others + "</ul>\n";
  return html.empty() ? "<p>No picture differs.</p>\n" : html;
}

std::string facts(const Json& comparison) {
  const auto& counts = comparison["counts"];
  std::string html = "<ul class=\"facts\">\n";
  for (const auto& [name, state] : {std::pair{"same", ""},
                                    {"changed", ""},
                                    {"added", ""},
                                    {"removed", "bad"},
                                    {"worse", "bad"},
                                    {"better", "good"},
                                    {"moved", ""}}) {
    const auto count = counts[name].get<std::size_t>();
    html += fmt::format("<li class=\"{}\">{} {}</li>\n", count > 0 ? state : "", count, name);
  }
  html += "</ul>\n";
  for (const char* side : {"a", "b"})
    html += fmt::format("<p class=\"soft\">{}: {}, night {}</p>\n", side[0] == 'a' ? "before" : "after",
                        report::escape(comparison[side]["store"].get<std::string>()),
                        comparison[side]["night"].get<std::string>());
  if (!comparison["build"].empty())
    html += "<p>The programs differ: " + report::escape(joined(comparison["build"])) + "</p>\n";
  return html;
}

}  // namespace

void write_comparison_page(const fs::path& folder, const Json& comparison, const Night& a, const Night& b,
                           std::size_t most_pictures) {
  io::create_output_folder(folder);
  std::error_code ignored;
  fs::remove_all(folder / "pictures", ignored);
  const std::string body = facts(comparison) + "<h2>Figures</h2>\n" + figure_table(comparison) +
                           "<h2>Results</h2>\n" + result_table(comparison) + "<h2>Pictures</h2>\n" +
                           picture_section(folder, comparison, a, b, most_pictures);
  io::write_text(folder / "index.html", report::page("Two nights compared", body, ""));
}

}  // namespace hybrid::archive
