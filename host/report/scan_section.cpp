#include "report/scan_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/json_text.hpp"
#include "io/output.hpp"
#include "report/histogram.hpp"

namespace hybrid::report {
namespace fs = std::filesystem;
namespace {

// A nested JSON object as rows "a / b / c : value"; without lists, which have tables or plots of their own.
void figure_rows(const Json& value, const std::string& name, std::string& rows) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      figure_rows(inner, name.empty() ? key : name + " / " + key, rows);
    return;
  }
  if (value.is_array() && (value.size() > 12 || (!value.empty() && value[0].is_object()))) return;
  const std::string text = value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                           : value.is_string()     ? value.get<std::string>()
                                                   : json_text(value, -1);
  rows += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape(name), escape(text));
}

// Degrees between a plane and the horizontal; null without a pose.
Json slope_deg(const Json& plane, const Json& pose) {
  if (!pose.is_object() || !pose.contains("world_from_scan") || !pose["world_from_scan"].is_array())
    return nullptr;
  const auto rows = pose["world_from_scan"].get<std::vector<double>>();
  const auto normal = plane["normal"].get<std::vector<double>>();
  if (rows.size() != 16 || normal.size() != 3) return nullptr;
  double z = 0, scale = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    z += rows[8 + k] * normal[k];
    scale += rows[8 + k] * rows[8 + k];
  }
  return std::acos(std::min(1.0, std::abs(z) / std::sqrt(scale))) * 180 / M_PI;
}

std::map<std::int64_t, Json> unexplained(const Json& scan) {
  std::map<std::int64_t, Json> planes;
  if (scan.contains("unexplained_planes"))
    for (const auto& plane : scan["unexplained_planes"]) planes[plane["id"].get<std::int64_t>()] = plane;
  return planes;
}

std::string supercluster_table(const fs::path& out, const std::string& folder, const Json& scan,
                               const Json& planes, const Json& pose) {
  if (!planes.is_object()) return "";
  const auto strangers = unexplained(scan);
  Table table;
  table.number("id", "", 0)
      .number("area", "m\u00b2", 3)
      .number("rms", "mm", 2, "of its samples' distances to the plane")
      .number("samples", "", 0)
      .number("squares", "", 0)
      .number("slope", "deg", 1, "0 = level, 90 = upright, in the world; none without a pose")
      .number("offset", "m", 3, "normal . x = offset, scan frame")
      .text("normal", "scan frame, towards the scanner")
      .number("outlines", "", 0, "outer and inner rings of its contour")
      .number("unexplained", "%", 1, "share of its samples without a face of the proxy")
      .text("shown as", "what stands for it in views when no face of the proxy does");
  for (const auto& plane : planes["superclusters"]) {
    const auto stranger = strangers.find(plane["id"].get<std::int64_t>());
    const bool explained = stranger == strangers.end();
    const auto normal = plane["normal"].get<std::vector<double>>();
    Json id = {{"value", plane["id"]}};
    const std::string image = fmt::format("{}planes/{:04}.png", folder, plane["id"].get<std::int64_t>());
    std::error_code ignored;
    if (fs::exists(out / image, ignored)) id["href"] = link("../" + image);
    table.add({id, plane["area_m2"], cell(plane, "/rms_m", 1000), plane["samples"], plane["squares"],
               slope_deg(plane, pose), plane["offset_m"],
               fmt::format("{:.3f} {:.3f} {:.3f}", normal.at(0), normal.at(1), normal.at(2)),
               plane["contours"].size(),
               explained ? Json(nullptr) : cell(stranger->second, "/unexplained_share", 100),
               explained ? Json(nullptr) : stranger->second["shown_as"]});
  }
  return fmt::format("<details><summary>{} superclusters, {} lines in which they meet</summary>\n",
                     planes["superclusters"].size(), planes["intersections"].size()) +
         table.sorted_by("area", true).html() + "</details>\n";
}

std::string cylinder_table(const Json& planes) {
  if (!planes.is_object() || !planes.contains("cylinders") || planes["cylinders"].empty()) return "";
  Table table;
  table.number("id", "", 0)
      .text("seen from", "outside: a column or pipe, inside: a barrel vault")
      .number("radius", "mm", 1, "half-way along")
      .number("sigma", "mm", 2, "of the radius, of chance alone")
      .number("length", "m", 2)
      .number("taper", "mm/m", 1, "by how much the radius grows upwards")
      .number("arc", "deg", 0, "of the circumference that the scan sees")
      .number("rms", "mm", 2, "of its samples' distances")
      .number("samples", "", 0)
      .text("axis", "scan frame");
  for (const auto& cylinder : planes["cylinders"]) {
    const auto axis = cylinder["axis"].get<std::vector<double>>();
    table.add({cylinder["id"], cylinder["seen_from"], cell(cylinder, "/radius_m", 1000),
               cell(cylinder, "/sigma_radius_m", 1000), cylinder["length_m"], cell(cylinder, "/taper", 1000),
               cylinder["arc_deg"], cell(cylinder, "/rms_m", 1000), cylinder["samples"],
               fmt::format("{:.3f} {:.3f} {:.3f}", axis.at(0), axis.at(1), axis.at(2))});
  }
  return fmt::format("<details><summary>{} columns, pipes and vaults</summary>\n",
                     planes["cylinders"].size()) +
         table.sorted_by("samples", true).html() + "</details>\n";
}

bool is_to_scans(const Json& scan) {
  return scan.value("/registration/residuals/to"_json_pointer, "") == "scans";
}

std::string residual_section(const Json& scan) {
  if (!scan.contains("/registration/residuals"_json_pointer)) return "";
  const auto& residuals = scan["registration"]["residuals"];
  return fmt::format(
      "<figure>{}<figcaption>Distance of planar samples from {}: half are within {:.2f} mm, 95 % within "
      "{:.1f} mm of those that have a {}; none: no {} of a similar direction is "
      "near.</figcaption></figure>\n",
      residual_plot(residuals), is_to_scans(scan) ? "the other scans" : "the model after ICP",
      1000 * residuals["median_m"].get<double>(), 1000 * residuals["p95_m"].get<double>(),
      is_to_scans(scan) ? "surface" : "face", is_to_scans(scan) ? "surface" : "face");
}

// Per proxy face where the scan lies.
std::string face_table(const Json& scan) {
  if (!scan.contains("/registration/faces/faces"_json_pointer)) return "";
  const auto& faces = scan["registration"]["faces"];
  if (faces.contains("note")) return fmt::format("<p>{}.</p>\n", escape(faces["note"].get<std::string>()));
  Table table;
  table.text("face")
      .number("offset", "mm", 1, "above 0 the scan lies in front of the face, below 0 behind it")
      .number("sigma", "mm", 1)
      .number("tilt", "deg", 2)
      .number("area", "m\u00b2", 1)
      .number("samples", "", 0);
  for (const auto& face : faces["faces"])
    table.add({face["face"], cell(face, "/offset_m", 1000), cell(face, "/sigma_m", 1000), face["tilt_deg"],
               face["area_m2"], face["samples"]});
  return fmt::format(
      "<details><summary>the proxy's faces against the scan</summary>\n{}<p>{}; {}.</p></details>\n",
      table.html(),
      faces["solved_with_the_pose"].get<bool>()
          ? "The faces do not agree, so that the pose was solved with their offsets"
          : "The faces agree",
      escape(faces["unobservable"].get<std::string>()));
}

std::string notes_section(const Json& scan) {
  std::string html;
  for (const char* list : {"/notes", "/registration/warnings"})
    if (const Json::json_pointer at(list); scan.contains(at))
      for (const auto& note : scan[at]) html += fmt::format("<li>{}</li>\n", escape(note.get<std::string>()));
  return html.empty() ? "" : "<ul class=\"warn\">\n" + html + "</ul>\n";
}

}  // namespace

Json read_document(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return nullptr;
  const Json document = Json::parse(io::read_text(file), nullptr, false);
  return document.is_discarded() ? Json(nullptr) : document;
}

std::string scan_anchor(std::size_t index) {
  return fmt::format("scan-{}", index + 1);
}

std::string picture(Previews& previews, const std::string& file, const std::string& caption) {
  const std::string preview = previews.of(file);
  const std::string own = "report/";  // the page's folder
  const std::string full = file.rfind(own, 0) == 0 ? file.substr(own.size()) : "../" + file;
  return preview.empty() ? "" : figure(preview, full, caption);
}

std::string scan_section(Previews& previews, const Json& scan, std::size_t index) {
  const fs::path& out = previews.out();
  const std::string id = scan["id"].get<std::string>(), folder = "scans/" + id + "/";
  // First, for they are made while the planes are read.
  const std::string pictures =
      picture(previews, folder + "classes.png",
              "Superclusters (pastel), columns and pipes (orange), vaults (brown), locally planar but too "
              "small (dark blue), "
              "non-planar (dark green), "
              "undersampled (black)") +
      picture(previews, folder + "residuals.png",
              is_to_scans(scan) ? "Signed distances to the other scans: blue behind their surfaces, red in "
                                  "front, grey where none is near, black no return"
                                : "Signed distances to the proxy: blue behind its faces, red in front, grey "
                                  "farther than 10 cm, black no return") +
      picture(previews, folder + "range.png", "Range image: near is bright") +
      picture(previews, folder + "intersections.png",
              "Lines in which planes meet: corners red, edges that stand out blue");
  const Json planes = read_document(out / folder / "planes.json");
  const Json pose = read_document(out / folder / "pose.json");
  std::string rows;
  figure_rows(scan, "", rows);
  return fmt::format("<h2 id=\"{}\">Scan {}</h2>\n", scan_anchor(index), escape(id)) + notes_section(scan) +
         "<div class=\"row\">\n" + pictures + residual_section(scan) + "</div>\n" + face_table(scan) +
         supercluster_table(out, folder, scan, planes, pose) + cylinder_table(planes) +
         "<details><summary>all figures</summary><div class=\"scroll\"><table>\n" + rows +
         "</table></div></details>\n";
}

std::string abstained_section(Previews& previews, const Json& scan) {
  const fs::path& out = previews.out();
  const std::string id = scan["id"].get<std::string>(), folder = "scans/" + id + "/sheet/";
  const auto& registration = scan["registration"];
  std::string html = fmt::format(
      "<h3>Scan {}</h3>\n<p>{}{}.</p>\n", escape(id),
      registration.value("how", "") == "automatic" ? "The automatic alignment abstains: " : "No pose: ",
      escape(registration.value("reason", "no reason given")));
  if (registration.contains("rivals") && !registration["rivals"].empty()) {
    html += "<p>Against the best pose it could be:</p>\n<ul>\n";
    for (const auto& rival : registration["rivals"])
      html += fmt::format(
          "<li>{}; {:.2f} % of the planar area speak for the best pose, {:.2f} % for this one</li>\n",
          escape(rival["how"].get<std::string>()), 100 * rival["speaks_for_the_best"].get<double>(),
          100 * rival["speaks_for_the_rival"].get<double>());
    html += "</ul>\n";
  }
  if (registration.contains("places")) {
    html += "<p>Where it may stand:</p>\n<ol>\n";
    for (const auto& place : registration["places"])
      html += fmt::format("<li>{}</li>\n", escape(place["how"].get<std::string>()));
    html += "</ol>\n";
  }
  html += "<div class=\"row wide\">\n" +
          picture(previews, folder + "scan.png", "The scan, planes in colours, with rows and columns") +
          picture(previews, folder + "model.png", "The model from two sides with numbered vertices") +
          picture(previews, folder + "places.png",
                  "Where it may stand, from above: the scan blue, others grey, the model black, the scanner "
                  "red with columns of the scan") +
          "</div>\n";
  const auto stanza = [&](const std::string& file, const char* what) {
    std::error_code ignored;
    const fs::path path = out / folder / file;
    if (!fs::is_regular_file(path, ignored)) return std::string();
    return fmt::format("<details><summary>scans/{}/sheet/{}: {}</summary><pre>{}</pre></details>\n",
                       escape(id), file, what, escape(io::read_text(path)));
  };
  return html +
         stanza("landmarks.toml",
                "fill in four corners that both pictures show, copy it into the scene file, run again") +
         stanza("places.toml", "copy the pose of the place that is right into the scene file, run again");
}

}  // namespace hybrid::report
