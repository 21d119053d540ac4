#include "report/report.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>

#include "io/output.hpp"
#include "report/figures.hpp"

namespace hybrid::report {
namespace {

using Json = nlohmann::ordered_json;

std::string escape(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

// A relative path as a link: scan ids and view names may hold blanks, #, % and ?.
std::string link(const std::string& path) {
  std::string out;
  for (char c : path) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || std::strchr("/._-~", c);
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string picture(const std::string& file, const std::string& caption) {
  return fmt::format(
      "<figure><a href=\"{0}\"><img src=\"{0}\" alt=\"{1}\" "
      "loading=\"lazy\"></a><figcaption>{1}</figcaption></figure>\n",
      link(file), escape(caption));
}

// A nested JSON object as rows "a / b / c : value".
void table_rows(const Json& value, const std::string& name, std::string& rows) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      table_rows(inner, name.empty() ? key : name + " / " + key, rows);
    return;
  }
  const std::string text = value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                           : value.is_string()     ? value.get<std::string>()
                                                   : value.dump();
  rows += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", escape(name), escape(text));
}

std::string table(const Json& value) {
  std::string rows;
  table_rows(value, "", rows);
  return "<details><summary>figures</summary><table>\n" + rows + "</table></details>\n";
}

// Why a scan has no pose, what it could be, and the sheet for picking landmarks.
std::string abstained_section(const Json& scan, const std::string& folder) {
  if (!scan.contains("registration") || scan["registration"]["status"] != "abstained") return "";
  const auto& registration = scan["registration"];
  std::string html = fmt::format("<p><strong>No pose.</strong> The automatic alignment abstains: {}.</p>\n",
                                 escape(registration["reason"].get<std::string>()));
  if (registration.contains("rivals") && !registration["rivals"].empty()) {
    html += "<p>Against the best pose it could be:</p>\n<ul>\n";
    for (const auto& rival : registration["rivals"])
      html += fmt::format(
          "<li>{}; {:.2f} % of the planar area speak for the best pose, {:.2f} % for this one</li>\n",
          escape(rival["how"].get<std::string>()), 100 * rival["speaks_for_the_best"].get<double>(),
          100 * rival["speaks_for_the_rival"].get<double>());
    html += "</ul>\n";
  }
  return html + "<div class=\"row\">\n" +
         picture(folder + "sheet/scan.png",
                 "Landmark sheet: the scan, planes in colours, with rows and columns") +
         picture(folder + "sheet/model.png",
                 "The model from two sides with numbered vertices; fill in sheet/landmarks.toml with four "
                 "corners "
                 "that both pictures show and copy it into the scene file") +
         "</div>\n";
}

// Per proxy face where the scan lies.
std::string face_section(const Json& scan, const std::string& folder) {
  if (!scan.contains("registration") || !scan["registration"].contains("faces")) return "";
  const auto& faces = scan["registration"]["faces"];
  std::string html = "<div class=\"row\">\n" +
                     picture(folder + "residuals.png",
                             "Signed distances to the proxy: blue behind its faces, red in front, grey "
                             "farther than 10 cm, black no "
                             "return") +
                     "</div>\n<details><summary>the proxy's faces against the "
                     "scan</summary><table><tr><th>face</th><th>offset "
                     "mm</th><th>sigma mm</th><th>tilt deg</th><th>area m2</th><th>samples</th></tr>\n";
  for (const auto& face : faces["faces"])
    html += fmt::format(
        "<tr><th>{}</th><td>{:+.1f}</td><td>{:.1f}</td><td>{:.2f}</td><td>{:.1f}</td><td>{}</td></tr>\n",
        escape(face["face"].get<std::string>()), 1000 * face["offset_m"].get<double>(),
        1000 * face["sigma_m"].get<double>(), face["tilt_deg"].get<double>(), face["area_m2"].get<double>(),
        face["samples"].get<std::int64_t>());
  return html + fmt::format(
                    "</table><p>Above 0 the scan lies in front of the face, below 0 behind it. {}; "
                    "{}.</p></details>\n",
                    faces["solved_with_the_pose"].get<bool>()
                        ? "The faces do not agree, so that the pose was solved with their offsets"
                        : "The faces agree",
                    escape(faces["unobservable"].get<std::string>()));
}

// The table of registration reports: how each two scans lie against each other.
std::string pair_section(const Json& summary) {
  if (!summary.contains("joint")) return "";
  const auto& joint = summary["joint"];
  std::string html =
      "<h2>Scan to scan</h2>\n<table><tr><th>scans</th><th>overlap %</th><th>planes</th><th>distance mm, "
      "before</th><th>after</th><th>median mm</th><th>strength %</th></tr>\n";
  for (const auto& pair : joint["pairs"])
    html += fmt::format(
        "<tr><th>{} - "
        "{}</th><td>{:.0f}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.0f}</td>"
        "</tr>\n",
        escape(pair["a"].get<std::string>()), escape(pair["b"].get<std::string>()),
        100 * pair["overlap"].get<double>(), pair["planes"].get<int>(),
        1000 * pair["distance_before_m"].get<double>(), 1000 * pair["distance_m"].get<double>(),
        1000 * pair["median_m"].get<double>(), 100 * pair["strength"].get<double>());
  return html +
         "</table>\n<p>All poses were refined together. Overlap: share of the planar area of one scan on "
         "planes of the "
         "other, the larger of both; distance: rms over it, before and after; strength: 100 % held alike in "
         "all "
         "directions, 0 free to slide along one.</p>\n";
}

std::string scan_section(const Json& whole) {
  Json scan = whole;
  if (scan.contains("registration")) scan["registration"].erase("faces");  // a table of their own

  const std::string id = scan["id"].get<std::string>();
  const std::string folder = "../scans/" + id + "/";
  return fmt::format("<h2>Scan {}</h2>\n", escape(id)) + abstained_section(scan, folder) +
         "<div class=\"row\">\n" + picture(folder + "range.png", "Range image") +
         picture(folder + "classes.png",
                 "Superclusters (pastel), locally planar but too small (dark blue), non-planar "
                 "(dark green), undersampled (black)") +
         "</div>\n" + face_section(whole, folder) + table(scan);
}

std::string pair_picture(const Json& view) {
  const auto& score = view["left_out"];
  return picture(
      "../views/" + view["name"].get<std::string>() + "-pair.png",
      fmt::format("photograph {} (left), the same view from the others (middle), four times their difference "
                  "(right): PSNR {:.2f} dB, SSIM {:.3f} on {:.1f} % of its pixels",
                  score["photograph"].get<std::string>(), score["psnr_db"].get<double>(),
                  score["ssim"].get<double>(), 100 * score["share_seen"].get<double>()));
}

bool is_leave_one_out(const Json& view) {
  return view["name"].get<std::string>().rfind("leave-one-out/", 0) == 0;
}

std::string view_section(const Json& views) {
  std::string html = "<h2>Views</h2>\n<div class=\"row\">\n";
  for (const auto& view : views) {
    if (is_leave_one_out(view)) continue;
    const std::string name = view["name"].get<std::string>();
    std::string caption = name;
    if (view.contains("red_share"))
      caption +=
          fmt::format("; red = seen by no photograph: {:.1f} %", 100 * view["red_share"].get<double>());
    html += picture("../views/" + name + ".png", caption);
    if (view.contains("left_out")) html += pair_picture(view);
  }
  return html + "</div>\n";
}

std::string score_row(const std::string& name, const Json& score) {
  return fmt::format("<tr><th>{}</th><td>{:.2f}</td><td>{:.3f}</td><td>{:.1f}</td></tr>\n", escape(name),
                     score["psnr_db"].get<double>(), score["ssim"].get<double>(),
                     100 * score["share_seen"].get<double>());
}

std::string leave_one_out_section(const Json& summary) {
  if (!summary.contains("leave_one_out")) return "";
  const auto& scores = summary["leave_one_out"];
  std::string html =
      "<h2>Every photograph from the others</h2>\n<table><tr><th>photograph</th><th>PSNR dB</th><th>SSIM</th>"
      "<th>seen %</th></tr>\n";
  for (const auto& score : scores["photographs"])
    html += score_row(score["photograph"].get<std::string>(), score);
  html += score_row("mean", scores["mean"]) + "</table>\n";
  for (const auto& view : summary["views"])
    if (is_leave_one_out(view) && view.contains("left_out")) html += pair_picture(view);
  return html;
}

std::string failure_section(const batch::SceneRun& run) {
  if (run.failures.empty()) return "";
  std::string html = "<h2>Failures</h2>\n<ul>\n";
  for (const auto& failure : run.failures)
    html += fmt::format("<li>{}<br><code>{}</code></li>\n", escape(failure.error), escape(failure.command));
  return html + "</ul>\n";
}

constexpr const char* kStyle =
    "body{font:16px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:80rem;padding:0 "
    "1rem;color:#222;background:#fff}"
    ".row{display:flex;flex-wrap:wrap;gap:1rem}figure{margin:0;flex:1 1 28rem;max-width:100%}"
    "img{width:100%;height:auto;border:1px solid #ccc}figcaption{font-size:.9rem;color:#555}"
    "table{border-collapse:collapse;font-size:.9rem}th{text-align:left;font-weight:400;padding-right:2rem}";

}  // namespace

void write_report(device::Queue& queue, const batch::SceneRun& run, const std::filesystem::path& out) {
  const bool registered =
      run.model && std::any_of(run.registrations.begin(), run.registrations.end(),
                               [](const auto& registration) { return registration.has_value(); });
  std::string body = failure_section(run);
  if (registered) {
    write_registration_figures(queue, run, out / "report");
    body += "<h2>Registration</h2>\n<div class=\"row\">\n" +
            picture("registration-before.png",
                    "Before ICP: retained samples of every scan, each in its colour, on the proxy") +
            picture("registration-after.png", "After ICP") + "</div>\n";
  }
  body += pair_section(run.summary);
  const auto& views = run.summary["views"];
  if (!std::all_of(views.begin(), views.end(), is_leave_one_out)) body += view_section(views);
  body += leave_one_out_section(run.summary);
  for (const auto& scan : run.summary["scans"]) body += scan_section(scan);
  const std::string title = escape(run.scene.name);
  io::write_text(
      out / "report" / "index.html",
      fmt::format("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
                  "content=\"width=device-width\"><title>{0}</title><style>{1}</style></head>\n<body>\n"
                  "<h1>{0}</h1>\n{2}</body></html>\n",
                  title, kStyle, body));
}

}  // namespace hybrid::report
