#include "report/model_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "report/scan_section.hpp"

namespace hybrid::report {
namespace fs = std::filesystem;
namespace {

// Files of DIR/<folder> with this extension, as paths from DIR, by name.
std::vector<std::string> files_in(const fs::path& out, const std::string& folder, const char* extension) {
  std::vector<std::string> files;
  std::error_code code;
  for (fs::directory_iterator entry(out / folder, code), end; !code && entry != end; entry.increment(code))
    if (entry->path().extension() == extension)
      files.push_back(folder + "/" + entry->path().filename().string());
  std::sort(files.begin(), files.end());
  return files;
}

std::string link_to(const std::string& file) {
  return fmt::format("<a href=\"{}\">{}</a>", link("../" + file), escape(file));
}

std::string removed_list(const Json& edit) {
  if (!edit.contains("removed_faces")) return "";
  std::string names;
  for (const auto& name : edit["removed_faces"])
    names += (names.empty() ? "" : ", ") + escape(name.get<std::string>());
  return fmt::format("<p>Removed faces: {}.</p>\n", names);
}

std::string opening_table(const Json& found) {
  if (!found.is_object() || found["openings"].empty()) return "";
  Table table;
  table.text("face")
      .text("kind", "open, glass (some rays return from a pane) or recess (nearly all from one plane)")
      .text("cut", "into the model; else why not")
      .number("area", "m\u00b2", 3)
      .number("rays", "", 0, "lines of sight that pass the face")
      .number("confidence", "%", 0,
              "lower bound of the share of rays that pass, times the share of the border that was seen")
      .number("depth", "m", 3, "median distance behind the face at which the rays return");
  for (const auto& opening : found["openings"]) {
    const bool cut = opening.value("cut", false);
    table.add({opening["face"],
               opening["kind"],
               {{"text", cut ? "cut" : opening.value("why_not", "")}, {"state", cut ? "good" : ""}},
               opening["area_m2"],
               opening["rays"],
               cell(opening, "/confidence", 100),
               opening["depth_m"]});
  }
  return "<h3>Openings</h3>\n" + table.html() +
         "<p class=\"soft\">All figures: " + link_to("model/openings.json") + "</p>\n";
}

std::string displacement_table(const fs::path& out, const Json& edit) {
  if (!edit.contains("displacement")) return "";
  Table table;
  table.text("face")
      .number("texel", "mm", 1)
      .number("columns", "", 0)
      .number("rows", "", 0)
      .number("measured", "m\u00b2", 2);
  for (const auto& map : edit["displacement"])
    table.add({map["face"], cell(map, "/texel_m", 1000), map["size"][0], map["size"][1], map["measured_m2"]});
  std::string files;
  for (const auto& file : files_in(out, "model/displacement", ".exr"))
    files += "<li>" + link_to(file) + "</li>\n";
  return "<h3>Displacement maps</h3>\n" + table.html() + "<details><summary>files</summary><ul>\n" + files +
         "</ul></details>\n";
}

std::string edited_scans(const Json& edit) {
  if (!edit.contains("scans")) return "";
  Table table;
  table.text("scan")
      .number("clipped", "samples", 0, "dropped by [[edit.clip]]")
      .number("moved", "samples", 0, "along their rays by [[edit.depth]]");
  for (const auto& [id, scan] : edit["scans"].items()) {
    Json clipped;
    if (scan.contains("clips")) {
      std::int64_t samples = 0;
      for (const auto& clip : scan["clips"]) samples += clip["samples"].get<std::int64_t>();
      clipped = samples;
    }
    table.add({id, clipped, cell(scan, "/depth_edited_samples")});
  }
  return table.html();
}

}  // namespace

std::string edit_section(Previews& previews, const Json& summary) {
  if (!summary.contains("edit")) return "";
  const auto& edit = summary["edit"];
  const fs::path& out = previews.out();
  std::string openings, scans;
  const std::string edited =
      picture(previews, "model/edited.png", "The model before (left) and after its edits");
  for (const auto& file : files_in(out, "model/openings", ".png"))
    openings +=
        picture(previews, file,
                fs::path(file).stem().string() +
                    ": grey samples on the face, blue lines of sight that pass it, outlines red (cut) "
                    "or orange (reported)");
  for (const auto& scan : summary["scans"]) {
    const std::string id = scan["id"].get<std::string>(), folder = "scans/" + id + "/";
    scans += picture(previews, folder + "clipped.png",
                     fmt::format("{}: before and after its clips, red what was dropped", id)) +
             picture(previews, folder + "depth-edits.png",
                     fmt::format("{}: relief before and after depths were moved", id));
  }
  const auto row = [](const std::string& pictures) {
    return pictures.empty() ? "" : "<div class=\"row\">\n" + pictures + "</div>\n";
  };
  return "<h2 id=\"edits\">Edits</h2>\n" + removed_list(edit) + row(edited) +
         opening_table(read_document(out / "model/openings.json")) + row(openings) +
         displacement_table(out, edit) + edited_scans(edit) + row(scans);
}

std::string photograph_section(const Json& summary) {
  const auto folded = [](const char* what, std::size_t rows, const std::string& table) {
    constexpr std::size_t kMostOpen = 30;
    if (rows <= kMostOpen) return table;
    return fmt::format("<details><summary>{} {}</summary>\n{}</details>\n", rows, what, table);
  };
  std::string html;
  if (summary.contains("equalisation") && !summary["equalisation"].empty()) {
    Table table;
    table.text("photograph")
        .number(
            "agreement", "", 2,
            "correlation with what other photographs show of the same surface: 0.8 and more where cameras "
            "and surfaces are right")
        .number("points", "", 0, "of the surface that it sees")
        .number("red", "", 3, "what its light is multiplied with")
        .number("green", "", 3)
        .number("blue", "", 3);
    for (const auto& row : summary["equalisation"]) {
      Json agreement = row["agreement"];
      if (row.contains("doubtful")) {
        if (agreement.is_null())
          agreement = {{"text", "sees nothing"}, {"state", "bad"}};
        else
          agreement = {{"value", agreement}, {"state", "bad"}};
      }
      table.add(
          {row["photograph"], agreement, row["points"], row["gain"][0], row["gain"][1], row["gain"][2]});
    }
    html += folded("photographs", summary["equalisation"].size(), table.html());
  }
  if (summary.contains("photograph_landmarks")) {
    const auto& landmarks = summary["photograph_landmarks"];
    Table table;
    table.number("landmark", "", 0)
        .text("photograph", "empty: a point in the cameras' frame")
        .number("residual", "pixels", 2)
        .number("residual", "mm", 1)
        .text("fit");
    for (const auto& pick : landmarks["picks"])
      table.add(
          {pick["landmark"], pick.value("photograph", ""), cell(pick, "/residual_px"),
           cell(pick, "/residual_m", 1000),
           pick.contains("left_out") ? Json({{"text", "left out"}, {"state", "bad"}}) : Json("fitted")});
    html +=
        fmt::format(
            "<h3>Landmarks</h3>\n<p>The cameras' frame in the model's: scale {:.6g}, rms {:.1f} mm.</p>\n",
            landmarks["scale"].get<double>(), 1000 * landmarks["rms_m"].get<double>()) +
        folded("landmarks", landmarks["picks"].size(), table.html());
  }
  return html.empty() ? "" : "<h2 id=\"photographs\">Photographs</h2>\n" + html;
}

std::string coverage_section(const Json& summary) {
  if (!summary.contains("coverage")) return "";
  const auto& coverage = summary["coverage"];
  const double area = coverage["area_m2"].get<double>(), unseen = coverage["unseen_m2"].get<double>();
  Table faces, next;
  faces.text("face").number("area", "m\u00b2", 2).number("unseen", "m\u00b2", 2).number("share", "%", 1);
  for (const auto& face : coverage["faces"]) {
    const double own = face["area_m2"].get<double>();
    faces.add({face["face"], own, face["unseen_m2"],
               own > 0 ? Json(100 * face["unseen_m2"].get<double>() / own) : Json()});
  }
  next.number("x", "m", 2)
      .number("y", "m", 2)
      .number("z", "m", 2)
      .text("looking", "direction")
      .number("gained", "m\u00b2", 2, "of what no photograph and none of the cameras before this one sees");
  for (const auto& camera : coverage["next_cameras"]) {
    const auto& p = camera["position"];
    const auto& d = camera["direction"];
    next.add({p[0], p[1], p[2],
              fmt::format("{:.3f} {:.3f} {:.3f}", d[0].get<double>(), d[1].get<double>(), d[2].get<double>()),
              camera["gained_m2"]});
  }
  std::string html = fmt::format(
      "<h2 id=\"coverage\">What no photograph sees</h2>\n<p>{:.2f} of {:.2f} m\u00b2 ({:.1f} %).</p>\n",
      unseen, area, area > 0 ? 100 * unseen / area : 0.0);
  if (!faces.empty())
    html += "<details><summary>face by face</summary>\n" + faces.sorted_by("unseen", true).html() +
            "</details>\n";
  if (!next.empty())
    html += fmt::format("<h3>Where to stand for more</h3>\n<p>With a camera like {}.</p>\n",
                        escape(coverage.value("next_camera_like", ""))) +
            next.html();
  return html;
}

std::string export_section(Previews& previews, const Json& summary) {
  if (!summary.contains("export")) return "";
  const auto& exported = summary["export"];
  Table files;
  files.text("file").number("size", "MB", 3);
  std::string atlas;
  for (const auto& row : exported["files"]) {
    const std::string name = row["file"].get<std::string>();
    files.add({{{"text", name}, {"href", link("../export/" + name)}}, cell(row, "/bytes", 1e-6)});
    if (name.starts_with("coverage-") || name.starts_with("atlas-"))
      atlas += picture(previews, "export/" + name,
                       name + (name[0] == 'a' ? ": red what no photograph sees"
                                              : ": the brighter, the more photographs see it; red none"));
  }
  std::string html = "<h2 id=\"export\">Export</h2>\n" + files.html();
  if (!exported["notes"].empty()) {
    html += "<ul class=\"warn\">\n";
    for (const auto& note : exported["notes"]) html += "<li>" + escape(note.get<std::string>()) + "</li>\n";
    html += "</ul>\n";
  }
  return html + (atlas.empty() ? "" : "<div class=\"row\">\n" + atlas + "</div>\n");
}

}  // namespace hybrid::report
