#include "report/scene_page.hpp"

#include <fmt/format.h>
#include <map>

#include <algorithm>
#include <cmath>

#include "core/json_text.hpp"
#include "io/output.hpp"
#include "report/model_sections.hpp"
#include "report/scan_section.hpp"

namespace hybrid::report {
namespace fs = std::filesystem;
namespace {

bool has_status(const Json& scan, const char* status) {
  return scan.contains("registration") && scan["registration"].value("status", "") == status;
}

bool is_leave_one_out(const Json& view) {
  return view["name"].get<std::string>().rfind("leave-one-out/", 0) == 0;
}

std::string fact(const std::string& text, const char* state = "") {
  return fmt::format("<li class=\"{}\">{}</li>\n", state, escape(text));
}

std::string counted(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// What one wants to know first.
std::string facts(const ScenePage& page) {
  const auto& scans = page.summary["scans"];
  const auto with = [&](const char* status) {
    return static_cast<std::size_t>(std::count_if(
        scans.begin(), scans.end(), [&](const Json& scan) { return has_status(scan, status); }));
  };
  const std::size_t accepted = with("accepted"), abstained = with("abstained");
  std::string html = "<ul class=\"facts\">\n" + fact(counted(scans.size(), "scan"));
  if (accepted > 0) html += fact(fmt::format("{} registered", accepted), "good");
  if (abstained > 0) html += fact(fmt::format("{} abstained", abstained), "warn");
  html += fact(page.failures.empty() ? "no failures" : counted(page.failures.size(), "failure"),
               page.failures.empty() ? "good" : "bad");
  if (page.summary.contains("warnings"))
    html += fact(counted(page.summary["warnings"].size(), "warning"), "warn");
  const auto& views = page.summary["views"];
  if (const auto shown = std::count_if(views.begin(), views.end(), std::not_fn(is_leave_one_out)); shown > 0)
    html += fact(counted(static_cast<std::size_t>(shown), "view"));
  if (page.summary.contains("leave_one_out")) {
    const auto& mean = page.summary["leave_one_out"]["mean"];
    html += fact(fmt::format("left-out photographs: PSNR {:.2f} dB, SSIM {:.3f}",
                             mean["psnr_db"].get<double>(), mean["ssim"].get<double>()));
  }
  return html + "</ul>\n";
}

std::string warning_list(const Json& summary) {
  if (!summary.contains("warnings")) return "";
  std::string html = "<ul class=\"warn\">\n";
  for (const auto& warning : summary["warnings"])
    html += "<li>" + escape(warning.get<std::string>()) + "</li>\n";
  return html + "</ul>\n";
}

std::string failure_section(const std::vector<PageFailure>& failures) {
  if (failures.empty()) return "";
  std::string html = "<h2 id=\"failures\">Failures</h2>\n<ul>\n";
  for (const auto& failure : failures)
    html += fmt::format(
        "<li><span class=\"bad\">{}</span><br>run it again: <code data-unit=\"{}\">hybrid run SCENE.toml "
        "--out "
        "DIR</code></li>\n",
        escape(failure.error), escape(failure.unit));
  return html + "</ul>\n";
}

std::string abstained_sections(const ScenePage& page, Previews& previews) {
  std::string html;
  for (const auto& scan : page.summary["scans"])
    if (has_status(scan, "abstained")) html += abstained_section(previews, scan);
  return html.empty() ? "" : "<h2 id=\"abstained\">Scans without a pose</h2>\n" + html;
}

// One standard deviation of the position, from the covariance's translation part (the last three).
Json position_sigma_mm(const Json& pose) {
  if (!pose.is_object() || !pose.contains("covariance") || pose["covariance"].size() != 36) return nullptr;
  double sum = 0;
  for (const std::size_t k : {21, 28, 35}) sum += pose["covariance"][k].get<double>();
  return 1000 * std::sqrt(std::max(sum, 0.0));
}

Json joined(const Json& list) {
  std::string text;
  if (list.is_array())
    for (const auto& entry : list) {
      if (!text.empty()) text += ", ";
      text += entry.is_string() ? entry.get<std::string>() : json_text(entry, -1);
    }
  return text.empty() ? Json(nullptr) : Json(text);
}

Table registration_columns(bool truth) {
  Table table;
  table.text("scan").text("status").text("how", "where the start came from");
  if (truth) table.number("pose error", "mm", 3, "against the scene's truth");
  table.number("ICP rms", "mm", 2)
      .number("median", "mm", 2, "distance of planar samples from the model")
      .number("95 %", "mm", 1, "of planar samples are within")
      .number("overlap", "%", 1,
              "of the samples chosen for ICP that found their face, without a model other scans")
      .number("seen through", "%", 1, "by other scans, of what can be compared with them")
      .number("walls before", "%", 1, "of wall samples within 5 cm of the model before ICP")
      .number("walls after", "%", 1, "the same after ICP")
      .number("moved", "mm", 1, "by ICP")
      .number("turned", "deg", 3, "by ICP")
      .number("position sigma", "mm", 3, "one standard deviation, from the covariance")
      .number("landmarks rms", "mm", 1)
      .number("iterations", "", 0)
      .text("degenerate", "directions that the planes of the model, or of other scans, do not fix");
  return table;
}

Json open_directions(const Json& figures) {
  Json open = figures.value("degenerate", Json::array());
  if (figures.value("/slide/status"_json_pointer, "") == "accepted")
    open.push_back("other scans hold it there");
  return joined(open);
}

std::string registration_table(const ScenePage& page) {
  const auto& scans = page.summary["scans"];
  const bool truth = std::any_of(scans.begin(), scans.end(), [](const Json& scan) {
    return scan.contains("/truth/pose_error_mm"_json_pointer);
  });
  Table table = registration_columns(truth);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const auto& scan = scans[i];
    if (!scan.contains("registration")) continue;
    const std::string id = scan["id"].get<std::string>();
    const auto& figures = scan["registration"];
    const Json pose = read_document(page.out / "scans" / id / "pose.json");
    const std::string status = figures.value("status", "");
    const bool converged = figures.value("icp_converged", true);
    Json row = {{{"text", id}, {"href", fmt::format("#{}", scan_anchor(i))}},
                {{"text", status == "accepted" && !converged ? "not converged" : status},
                 {"state", status == "accepted" && converged ? "good" : "bad"}},
                figures.value("how", "")};
    if (truth) row.push_back(cell(scan, "/truth/pose_error_mm"));
    for (Json value :
         {cell(figures, "/icp_rms_m", 1000), cell(figures, "/residuals/median_m", 1000),
          cell(figures, "/residuals/p95_m", 1000), cell(figures, "/overlap", 100),
          cell(figures, "/seen_through", 100), cell(figures, "/wall_before_icp/within_5cm", 100),
          cell(figures, "/wall_after_icp/within_5cm", 100), cell(figures, "/moved_by_icp/m", 1000),
          cell(figures, "/moved_by_icp/deg"), position_sigma_mm(pose), cell(figures, "/landmark_rms_m", 1000),
          cell(figures, "/icp_iterations"), open_directions(figures)})
      row.push_back(std::move(value));
    table.add(std::move(row));
  }
  return table.empty() ? "" : table.html();
}

std::string landmark_table(const ScenePage& page) {
  Table table;
  table.text("scan")
      .number("landmark", "", 0, "in the scene file's order")
      .number("residual", "mm", 1)
      .number("left out", "mm", 1, "its residual when the fit is made from the others");
  for (const auto& scan : page.summary["scans"]) {
    const std::string id = scan["id"].get<std::string>();
    const Json pose = read_document(page.out / "scans" / id / "pose.json");
    if (!pose.is_object() || !pose.contains("landmarks")) continue;
    const auto& residuals = pose["landmarks"]["residual_m"];
    const auto& left_out = pose["landmarks"]["leave_one_out_m"];
    for (std::size_t i = 0; i < residuals.size(); ++i)
      table.add({id, i + 1, 1000 * residuals[i].get<double>(),
                 i < left_out.size() && left_out[i].is_number() ? Json(1000 * left_out[i].get<double>())
                                                                : Json(nullptr)});
  }
  return table.empty() ? "" : "<details><summary>Landmarks</summary>\n" + table.html() + "</details>\n";
}

// How each two scans lie against each other.
std::string pair_table(const Json& joint) {
  Table table;
  table.text("scan")
      .text("and")
      .number("overlap", "%", 0, "share of the planar area of one on planes of the other, the larger of both")
      .number("planes", "", 0)
      .number("before", "mm", 2, "rms distance over the overlap before the refinement")
      .number("after", "mm", 2, "the same after it")
      .number("median", "mm", 2)
      .number("strength", "%", 0, "100: held alike in all directions, 0: free to slide along one");
  for (const auto& pair : joint["pairs"])
    table.add({pair["a"], pair["b"], cell(pair, "/overlap", 100), pair["planes"],
               cell(pair, "/distance_before_m", 1000), cell(pair, "/distance_m", 1000),
               cell(pair, "/median_m", 1000), cell(pair, "/strength", 100)});
  return table.empty() ? "" : table.html();
}

// The tables of registration reports.
std::string pair_tables(const ScenePage& page) {
  if (!page.summary.contains("joint")) return "";
  const Json& joint = page.summary["joint"];
  const std::string all = pair_table(joint);
  std::string html = all.empty() ? "" : "<h3>Scan to scan, all poses refined together</h3>\n" + all;
  for (const Json& island : joint.value("islands", Json::array()))
    html += fmt::format("<h3>{} scans that hang together with none of these, in the frame of {}</h3>\n",
                        island["scans"].size(), escape(island["frame"].get<std::string>())) +
            pair_table(island);
  return html;
}

std::string registration_section(const ScenePage& page, Previews& previews) {
  const std::string figures = registration_table(page);
  if (figures.empty()) return "";
  // One of them is there: the second without a model.
  const std::string before = picture(previews, "report/registration-before.png",
                                     "Before ICP: retained samples of every scan, each in its colour, on the "
                                     "proxy");
  const std::string after = picture(
      previews, "report/registration-after.png",
      before.empty() ? "The registered scans, each in its colour; what faces away is left out" : "After ICP");
  const std::string plan = picture(previews, "report/registration-plan.png", "The same from above");
  return "<h2 id=\"registration\">Registration</h2>\n" + figures + pair_tables(page) + landmark_table(page) +
         "<div class=\"row\">\n" + before + after + plan + "</div>\n";
}

std::string pair_picture(Previews& previews, const Json& view) {
  const auto& score = view["left_out"];
  return picture(previews, fmt::format("views/{}-pair.png", view["name"].get<std::string>()),
                 fmt::format("{} (left), the same view from the other photographs (middle), four times their "
                             "difference (right): PSNR {:.2f} dB, SSIM {:.3f} on {:.1f} % of its pixels",
                             score["photograph"].get<std::string>(), score["psnr_db"].get<double>(),
                             score["ssim"].get<double>(), 100 * score["share_seen"].get<double>()));
}

std::string view_section(const ScenePage& page, Previews& previews) {
  std::string single, pairs;
  std::map<std::string, std::size_t> frames;
  for (const auto& view : page.summary["views"])
    if (view.contains("path")) ++frames[view["path"].get<std::string>()];
  for (const auto& view : page.summary["views"]) {
    if (is_leave_one_out(view)) continue;
    const std::string name = view["name"].get<std::string>();
    std::string caption = name;
    if (view.contains("path")) {  // its first frame stands for all
      auto& left = frames[view["path"].get<std::string>()];
      if (left == 0) continue;
      caption = fmt::format("{}: the first of {} frames", name, left);
      left = 0;
    }
    if (view.contains("red_share"))
      caption +=
          fmt::format("; red = seen by no photograph: {:.1f} %", 100 * view["red_share"].get<double>());
    single += picture(previews, fmt::format("views/{}.png", name), caption);
    if (view.contains("left_out")) pairs += pair_picture(previews, view);
  }
  if (single.empty() && pairs.empty()) return "";
  return "<h2 id=\"views\">Views</h2>\n<div class=\"row\">\n" + single +
         "</div>\n<div class=\"row wide\">\n" + pairs + "</div>\n";
}

std::string leave_one_out_section(const ScenePage& page, Previews& previews) {
  if (!page.summary.contains("leave_one_out")) return "";
  Table table;
  table.text("photograph").number("PSNR", "dB", 2).number("SSIM", "", 3).number("seen", "%", 1);
  const auto add = [&](const std::string& name, const Json& score) {
    table.add({name, score["psnr_db"], score["ssim"], cell(score, "/share_seen", 100)});
  };
  const auto& scores = page.summary["leave_one_out"];
  for (const auto& score : scores["photographs"]) add(score["photograph"].get<std::string>(), score);
  add("mean", scores["mean"]);
  std::string html = "<h2 id=\"leave-one-out\">Every photograph from the others</h2>\n" + table.html() +
                     "<div class=\"row wide\">\n";
  for (const auto& view : page.summary["views"])
    if (is_leave_one_out(view) && view.contains("left_out")) html += pair_picture(previews, view);
  return html + "</div>\n";
}

// Every scan on a line, each a link to its section.
std::string scan_table(const ScenePage& page) {
  const auto& scans = page.summary["scans"];
  if (scans.empty()) return "";
  Table table;
  table.text("scan")
      .number("samples", "", 0, "of the input that are returns")
      .number("rows", "", 0)
      .number("columns", "", 0)
      .number("noise", "mm", 2, "sigma of the range, as measured on the planes")
      .number("square", "", 0, "side of the squares in samples")
      .number("superclusters", "", 0)
      .number("discarded", "%", 1, "of the samples: the planes' interiors")
      .number("unexplained", "", 0, "superclusters that no face of the model explains")
      .number("notes", "", 0);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const auto& scan = scans[i];
    table.add({{{"text", scan["id"]}, {"href", fmt::format("#{}", scan_anchor(i))}},
               cell(scan, "/input_returns"),
               cell(scan, "/grid/rows"),
               cell(scan, "/grid/cols"),
               cell(scan, "/sigma_m", 1000),
               cell(scan, "/square"),
               cell(scan, "/superclusters"),
               cell(scan, "/decimation/discarded_share", 100),
               scan.contains("unexplained_planes") ? Json(scan["unexplained_planes"].size()) : Json(),
               scan.contains("notes") ? Json(scan["notes"].size()) : Json()});
  }
  return "<h2 id=\"scans\">Scans</h2>\n" + table.html();
}

std::string input_section(const ScenePage& page) {
  Table table;
  table.text("file").number("size", "MB", 3).text("XXH3-128");
  for (const auto& input : page.summary["inputs"])
    table.add({input["file"], cell(input, "/bytes", 1e-6), input["xxh3"]});
  const auto& program = page.summary["program"];
  return "<h2>Inputs and options</h2>\n<details><summary>" +
         escape(counted(page.summary["inputs"].size(), "input file")) + "</summary>" + table.html() +
         "</details>\n<details><summary>options</summary><pre>" + escape(json_text(page.summary["options"])) +
         "</pre></details>\n<p class=\"soft\">" +
         escape(program["name"].get<std::string>() + " " + program["version"].get<std::string>()) +
         "; all figures: <a href=\"../summary.json\">summary.json</a></p>\n";
}

}  // namespace

void write_scene_page(const ScenePage& given) {
  ScenePage page = given;  // scans that abstained have a section of their own
  std::erase_if(page.failures, [&](const PageFailure& failure) {
    const auto& scans = page.summary["scans"];
    return std::any_of(scans.begin(), scans.end(), [&](const Json& scan) {
      return has_status(scan, "abstained") && failure.unit == "scan " + scan["id"].get<std::string>();
    });
  });
  const fs::path folder = page.out / "report";
  std::error_code ignored;
  fs::remove_all(folder / "pictures", ignored);
  Previews previews(page.out);
  std::string body = facts(page) + warning_list(page.summary) + failure_section(page.failures) +
                     abstained_sections(page, previews) + registration_section(page, previews) +
                     edit_section(previews, page.summary) + view_section(page, previews) +
                     leave_one_out_section(page, previews) + photograph_section(page.summary) +
                     coverage_section(page.summary) + export_section(previews, page.summary);
  body += scan_table(page);
  const auto& scans = page.summary["scans"];
  for (std::size_t i = 0; i < scans.size(); ++i) body += scan_section(previews, scans[i], i);
  body +=
      "<h2>Times</h2>\n<div id=\"timing\"><p class=\"soft\">In timing.js, which is not beside this page."
      "</p></div>\n" +
      input_section(page);
  previews.finish();
  io::write_text(folder / "index.html",
                 report::page(page.summary["scene"].get<std::string>(), body, "timing.js"));
}

}  // namespace hybrid::report
