// Night after night: the catalogue, what differs between two nights, the archive's page, profiles compared.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "../e2e/browser.hpp"
#include "archive/figures.hpp"
#include "archive/slurm.hpp"
#include "archive/verdict.hpp"
#include "io/output.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The first column of the only row.
std::string ask(const fs::path& catalogue, const std::string& question) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(catalogue.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::string answer;
  char* error = nullptr;
  sqlite3_exec(
      database, question.c_str(),
      [](void* to, int, char** values, char**) {
        *static_cast<std::string*>(to) += (values[0] ? values[0] : "null") + std::string(" ");
        return 0;
      },
      &answer, &error);
  EXPECT_EQ(error, nullptr) << error;
  sqlite3_close(database);
  if (!answer.empty()) answer.pop_back();
  return answer;
}

void cut_short(const fs::path& scan) {
  io::write_text(scan, io::read_text(scan).substr(0, 5000));
}

class Nightly : public testing::Test {
 protected:
  void night(int expected_code) {
    const auto planned = plan(archive, store);
    ASSERT_TRUE(planned.exit_code == 0 || planned.exit_code == 3) << planned.err;
    const auto ran = run_store(store);
    ASSERT_EQ(ran.exit_code, expected_code) << ran.err << ran.out;
  }
  Outcome diff(const std::string& words) { return run("hybrid batch diff " + words); }
  // Between two nights of which a scan has changed a little.
  void check_thresholds() {
    const auto code = [&](const std::string& text) {
      io::write_text(scratch / "limits.toml", text);
      return diff(store.string() + " --thresholds " + (scratch / "limits.toml").string()).exit_code;
    };
    EXPECT_EQ(code("[[figure]]\nname = \"*\"\nworse = \"never\"\n"), 0);
    const int higher = code("defaults = false\n[[figure]]\nname = \"*\"\nworse = \"higher\"\n");
    const int lower = code("defaults = false\n[[figure]]\nname = \"*\"\nworse = \"lower\"\n");
    EXPECT_TRUE(higher == 3 || lower == 3);  // something moved
    EXPECT_EQ(code("defaults = false\n[[figure]]\nname = \"*\"\nworse = \"higher\"\nabsolute = 1e9\n"), 0);
    EXPECT_EQ(code("[[figure]]\nname = \"*\"\nworse = \"sideways\"\n"), 4);
    EXPECT_EQ(code("[[figure]]\nworse = \"lower\"\n"), 4);
    const auto nowhere = diff(store.string() + "@7 " + store.string());
    EXPECT_EQ(nowhere.exit_code, 4);
    EXPECT_NE(nowhere.err.find("@0 = @"), std::string::npos) << nowhere.err;  // those that there are
  }
  Json diff_json(const std::string& words) { return Json::parse(diff(words + " --json").out); }

  Scratch scratch;
  const fs::path archive = scratch / "archive", store = scratch / "store";
};

}  // namespace

TEST_F(Nightly, three_nights_in_catalogue_diff_and_page) {
  write_small_archive(archive, 3);
  night(0);
  change_scan(archive / "b");
  night(0);
  check_thresholds();
  cut_short(archive / "c/s.ply");
  night(3);

  // The catalogue tells of all.
  const auto gathered = run("hybrid batch gather " + store.string());
  ASSERT_EQ(gathered.exit_code, 0) << gathered.err;
  const fs::path catalogue = store / "catalogue.sqlite";
  EXPECT_EQ(ask(catalogue, "SELECT count(*) FROM nights"), "3");
  EXPECT_EQ(ask(catalogue, "SELECT state FROM units WHERE result = 'c/scene' ORDER BY night"),
            "partial done done");
  EXPECT_EQ(ask(catalogue, "SELECT count(DISTINCT object) FROM units WHERE result = 'a/scene'"), "1");
  EXPECT_EQ(ask(catalogue,
                "SELECT count(*) FROM history WHERE result = 'b/scene' AND subject = 'scan s' AND "
                "name = 'decimation/discarded_share'"),
            "3");
  EXPECT_NE(ask(catalogue, "SELECT count(*) FROM failures WHERE error LIKE '%s.ply%'"), "0");
  EXPECT_EQ(ask(catalogue, "SELECT count(*) FROM objects WHERE cpu_s IS NULL OR host IS NULL"), "0");
  const auto bytes = io::read_text(catalogue);
  ASSERT_EQ(run("hybrid batch gather " + store.string()).exit_code, 0);
  EXPECT_EQ(bytes, io::read_text(catalogue));

  // What changed, why, and that the damaged scan is a regression.
  const auto told = diff(store.string() + "@2 --out " + (scratch / "page").string());
  EXPECT_EQ(told.exit_code, 3) << told.out << told.err;
  const auto found = diff_json(store.string() + "@2 " + store.string());
  EXPECT_EQ(found["counts"]["same"], 1u);  // a
  EXPECT_EQ(found["counts"]["changed"], 2u);
  ASSERT_EQ(found["results"].size(), 2u);
  const auto& b = found["results"][0];
  EXPECT_EQ(b["result"], "b/scene");
  EXPECT_EQ(b["because"], Json::array({"input s.ply"}));
  EXPECT_FALSE(b["figures"].empty());
  const auto& c = found["results"][1];
  EXPECT_EQ(c["state"], Json::array({"done", "partial"}));
  EXPECT_EQ(c["verdict"], "worse");
  EXPECT_EQ(c["figures"][0]["of"], "scan s");  // one row for a scan that is gone
  EXPECT_EQ(c["figures"][0]["after"], nullptr);
  EXPECT_FALSE(c["pictures"].empty());  // those of the scan are gone
  EXPECT_NE(told.out.find("c/scene: changed, done -> partial: worse"), std::string::npos) << told.out;
  // The other way round it is better; a night with itself is the same.
  EXPECT_EQ(diff_json(store.string() + " " + store.string() + "@2")["results"][1]["verdict"], "better");
  EXPECT_EQ(diff(store.string() + " " + store.string()).exit_code, 0);

  // Pages: complaints of the browser aside, the failure and its command are there.
  const std::string page = io::read_text(store / "results/report/index.html");
  EXPECT_NE(page.find("s.ply"), std::string::npos);
  EXPECT_NE(page.find("hybrid batch run --out STORE --unit 2,5 --retry"), std::string::npos);
  EXPECT_NE(page.find("../a/scene/report/index.html"), std::string::npos);
  EXPECT_NE(page.find("src=\"../a/scene/report/pictures/scans/s/classes.jpg\""), std::string::npos);
  EXPECT_TRUE(fs::exists(store / "results/a/scene/report/pictures/scans/s/classes.jpg"));
  EXPECT_EQ(page.find("src=\"../c/"), std::string::npos);  // its scan is damaged
  EXPECT_NE(io::read_text(store / "results/report/report/timing.js").find("\"scene a\": "),
            std::string::npos);
  for (const fs::path& file : {store / "results/report/index.html", scratch / "page/index.html"}) {
    const auto opened = open_in_browser(file);
    if (!opened) continue;
    EXPECT_EQ(opened->console, "") << file;
    EXPECT_NE(opened->dom.find("aria-label=\"filter the rows\""), std::string::npos) << file;
    // Where the store lies the page knows when it is opened.
    const bool named = opened->dom.find("hybrid batch run --out " + store.string() + " --unit 2,5 --retry") !=
                       std::string::npos;
    EXPECT_EQ(opened->dom.find(" s of CPU time when they were made") != std::string::npos, named)
        << opened->dom;
    EXPECT_EQ(named, file.parent_path().filename() == "report") << opened->dom;
  }
}

TEST_F(Nightly, profiles_are_compared) {
  write_small_archive(archive, 1);
  io::write_text(scratch / "dual.toml", "[render]\nblend = \"dual\"\n");
  io::write_text(scratch / "nearest.toml", "[render]\nblend = \"nearest\"\n");
  const auto words = "hybrid batch bench " + archive.string() + " --profiles " +
                     (scratch / "dual.toml").string() + "," + (scratch / "nearest.toml").string() +
                     " --out " + (scratch / "bench").string() + " --run '--jobs 1 --quiet' --json";
  const auto bench = run(words);
  ASSERT_EQ(bench.exit_code, 0) << bench.err;
  const auto json = Json::parse(bench.out);
  ASSERT_EQ(json["profiles"].size(), 2u);
  EXPECT_EQ(json["profiles"][1]["name"], "nearest");
  EXPECT_GT(json["profiles"][0]["cpu_s"].get<double>(), 0);
  bool same_planes = false, other_views = false;
  for (const auto& row : json["figures"]) {
    EXPECT_EQ(row["scenes"], 1) << row;
    if (row["name"] == "superclusters") same_planes = row["mean"][0] == row["mean"][1];
    if (row["name"] == "left_out/psnr_db") other_views = row["mean"][0] != row["mean"][1];
  }
  EXPECT_TRUE(same_planes);
  EXPECT_TRUE(other_views);
  EXPECT_TRUE(fs::exists(scratch / "bench/index.html"));
  // Another blend, other views: on the page side by side.
  const auto stores = (scratch / "bench/dual").string() + " " + (scratch / "bench/nearest").string();
  const auto found = diff_json(stores + " --out " + (scratch / "page").string());
  EXPECT_EQ(found["results"][0]["because"], Json::array({"options/render/blend"}));
  int shown = 0;
  for (const auto& picture : found["results"][0]["pictures"]) {
    const fs::path name = fs::path(picture["path"].get<std::string>()).replace_extension(".jpg");
    for (const char* side : {"before", "after", "difference"})
      EXPECT_TRUE(fs::exists(scratch / "page/pictures" / side / "a/scene" / name)) << side << " " << name;
    ++shown;
  }
  EXPECT_GT(shown, 0);
  EXPECT_EQ(run("hybrid batch bench " + archive.string() + " --profiles " + (scratch / "dual.toml").string() +
                "," + (scratch / "dual.toml").string() + " --out " + (scratch / "twice").string())
                .exit_code,
            2);
  io::write_text(scratch / "bad.toml", "[planes]\nsqare = 5\n");  // told before the first one's night
  const auto bad =
      run("hybrid batch bench " + archive.string() + " --profiles " + (scratch / "dual.toml").string() + "," +
          (scratch / "bad.toml").string() + " --out " + (scratch / "bad").string());
  EXPECT_EQ(bad.exit_code, 4);
  EXPECT_NE(bad.err.find("bad.toml:2: [planes]: unknown key \"sqare\""), std::string::npos) << bad.err;
  EXPECT_FALSE(fs::exists(scratch / "bad/dual"));
}

TEST(Figures, are_named_by_what_they_are_of) {
  const auto figures = archive::figures_of(Json::parse(R"({
    "scene": "x", "options": {"a": 1}, "failures": [{}, {}],
    "scans": [{"id": "west", "sigma_m": 0.002, "notes": [1, 2], "registration": {"status": "accepted",
               "icp_converged": true, "residuals": {"median_m": 0.001, "counts": [1, 2, 3]}}}],
    "views": [{"name": "front", "red_share": 0.25}],
    "leave_one_out": {"mean": {"psnr_db": 25}, "photographs": [{"photograph": "0.jpg", "psnr_db": 24}]}})"));
  const std::map<archive::FigureName, Json> expected = {
      {{"left out 0.jpg", "psnr_db"}, 24},
      {{"scan west", "registration/icp_converged"}, 1},
      {{"scan west", "registration/residuals/median_m"}, 0.001},
      {{"scan west", "registration/status"}, "accepted"},
      {{"scan west", "sigma_m"}, 0.002},
      {{"scene", "failures"}, 2},
      {{"scene", "leave_one_out/mean/psnr_db"}, 25},
      {{"view front", "red_share"}, 0.25}};
  EXPECT_EQ(figures, expected);
  EXPECT_TRUE(archive::figures_of(nullptr).empty());
}

TEST(Verdict, by_the_direction_and_the_larger_threshold) {
  using archive::judge;
  using archive::Verdict;
  const io::ThresholdFile none;
  EXPECT_EQ(judge(none, "truth/pose_error_mm", 1.0, 1.09), Verdict::moved);  // 0.05 mm and 10 %
  EXPECT_EQ(judge(none, "truth/pose_error_mm", 1.0, 1.2), Verdict::worse);
  EXPECT_EQ(judge(none, "truth/pose_error_mm", 0.01, 0.05), Verdict::moved);
  EXPECT_EQ(judge(none, "truth/pose_error_mm", 1.0, 0.5), Verdict::better);
  EXPECT_EQ(judge(none, "left_out/psnr_db", 25.0, 24.8), Verdict::worse);
  EXPECT_EQ(judge(none, "truth/planes_found", 12, 11), Verdict::worse);
  EXPECT_EQ(judge(none, "superclusters", 12, 40), Verdict::moved);  // nobody knows which is better
  EXPECT_EQ(judge(none, "registration/status", "accepted", "abstained"), Verdict::worse);
  EXPECT_EQ(judge(none, "registration/status", "abstained", "accepted"), Verdict::better);
  EXPECT_EQ(judge(none, "truth/pose_error_mm", 1.0, nullptr), Verdict::moved);
  io::ThresholdFile file;
  file.figures = {{"superclusters", io::Threshold::Worse::higher, 5, 0},
                  {"truth/*", io::Threshold::Worse::never, 0, 0}};
  EXPECT_EQ(judge(file, "superclusters", 12, 18), Verdict::worse);
  EXPECT_EQ(judge(file, "superclusters", 12, 17), Verdict::moved);
  EXPECT_EQ(judge(file, "truth/pose_error_mm", 1.0, 9.0), Verdict::moved);
  EXPECT_EQ(judge(file, "left_out/psnr_db", 25.0, 24.8), Verdict::worse);  // the built-in one still
  file.defaults = false;
  EXPECT_EQ(judge(file, "left_out/psnr_db", 25.0, 24.8), Verdict::moved);
}

TEST_F(Nightly, slurm_tasks_are_bundles_of_what_is_lacking) {
  EXPECT_EQ(archive::unit_list({3}), "3");
  EXPECT_EQ(archive::unit_list({3, 4}), "3-4");
  EXPECT_EQ(archive::unit_list({0, 3, 4, 5, 9, 11, 12}), "0,3-5,9,11-12");

  write_small_archive(archive, 5);
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  const auto opened = archive::Store::open(store);
  auto manifest = archive::read_manifest(opened.manifest_file());
  for (auto& unit : manifest.units) unit.estimate_s = 12;
  const auto sizes = [&](double bundle_s, std::size_t most) {
    archive::SlurmOptions options;
    options.bundle_s = bundle_s;
    std::string text;
    std::size_t next = 0;
    for (const auto& stage : archive::bundle_units(opened, manifest, options, most)) {
      for (const auto& bundle : stage.bundles) {
        text += std::to_string(bundle.size()) + " ";
        for (const std::size_t unit : bundle) EXPECT_EQ(unit, next++);  // each once, in order
      }
      text += "/ ";
    }
    EXPECT_EQ(next, manifest.units.size());
    return text;
  };
  EXPECT_EQ(sizes(30, 100), "3 2 / 3 2 / 1 / ");
  EXPECT_EQ(sizes(0, 100), "1 1 1 1 1 / 1 1 1 1 1 / 1 / ");
  EXPECT_EQ(sizes(0, 5), "3 2 / 3 2 / 1 / ");  // more would not be taken
  EXPECT_EQ(sizes(0, 1), "5 / 5 / 1 / ");

  // Of a store that has all but one scene: that scene and the report.
  night(0);
  change_scan(archive / "c");
  ASSERT_EQ(plan(archive, store).exit_code, 0);
  const auto changed = archive::read_manifest(opened.manifest_file());
  archive::SlurmOptions options;
  const auto stages = archive::bundle_units(opened, changed, options, 100);
  ASSERT_EQ(stages.size(), 3u);
  for (const auto& stage : stages)
    EXPECT_EQ(stage.bundles, std::vector<archive::Bundle>(1, stage.bundles[0]));
  EXPECT_EQ(stages[0].bundles[0], archive::Bundle{2});
  EXPECT_EQ(stages[1].bundles[0], archive::Bundle{7});
  EXPECT_EQ(stages[2].bundles[0], archive::Bundle{10});
}

}  // namespace hybrid::e2e
