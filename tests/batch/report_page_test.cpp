// The report's page from made-up figures: everything escaped, nothing from outside, the same bytes, and what
// is not there is left out. tests/e2e/report_browser_test.cpp looks at it in a browser.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "report/previews.hpp"
#include "report/scene_page.hpp"
#include "stages/registration/residual_histogram.hpp"

namespace hybrid::report::report_page_test {
namespace {
namespace fs = std::filesystem;

const std::string kHostile = "</script><script>alert(1)</script><img src=x onerror=alert(2)> & \"quoted\" '";

Json summary() {
  return {{"program", {{"name", "hybrid"}, {"version", "1"}}},
          {"scene", kHostile},
          {"inputs", {{{"file", kHostile}, {"bytes", 12}, {"xxh3", "00"}}}},
          {"options", {{"text", kHostile}}},
          {"scans",
           {{{"id", "one #1"},
             {"input_returns", 1234},
             {"notes", {kHostile}},
             {"registration",
              {{"status", "abstained"},
               {"reason", kHostile},
               {"rivals",
                {{{"how", kHostile}, {"speaks_for_the_best", 0.5}, {"speaks_for_the_rival", 0.4}}}}}}}}},
          {"views", Json::array()}};
}

class ReportPage : public ::testing::Test {
 protected:
  ReportPage() {
    std::string name = (fs::temp_directory_path() / "hybrid-report-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~ReportPage() override { fs::remove_all(folder_); }

  std::string write(const ScenePage& page) {
    write_scene_page(page);
    return io::read_text(folder_ / "report/index.html");
  }
  ScenePage page() {
    ScenePage made;
    made.out = folder_;
    made.summary = summary();
    made.failures = {{kHostile, "scan west: " + kHostile}};
    return made;
  }
  fs::path folder_;
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

}  // namespace

TEST_F(ReportPage, escapes_whatever_names_and_messages_hold) {
  const std::string html = write(page());
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<img src=x"), std::string::npos);
  // Title, heading, failure (unit and error), abstention (reason, rival), note, options; all figures of the
  // scan (reason, note).
  EXPECT_EQ(count(html, "&lt;/script&gt;&lt;script&gt;alert(1)"), 10u);
  EXPECT_EQ(count(html, "<script"), count(html, "</script>"));
  EXPECT_EQ(script_json({{"a", "</script>"}}), "{\"a\":\"\\u003c/script>\"}");
  EXPECT_EQ(script_json("\xff"), "\"\xef\xbf\xbd\"");
  EXPECT_EQ(link("scans/a b#1%?/x.png"), "scans/a%20b%231%25%3F/x.png");
}

TEST_F(ReportPage, asks_nothing_from_outside_and_is_the_same_every_time) {
  const std::string html = write(page());
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  for (const char* outside : {"src=\"http", "href=\"http", "src=\"//", "href=\"//", "@import", "url("})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  EXPECT_EQ(html, write(page()));
}

TEST_F(ReportPage, failures_name_their_unit_for_the_command_in_timing_js) {
  auto made = page();
  made.failures = {{"scan west", "scan west: west.ply: is cut short"}};
  const std::string html = write(made);
  EXPECT_NE(html.find("scan west: west.ply: is cut short"), std::string::npos);
  EXPECT_NE(html.find("<code data-unit=\"scan west\">"), std::string::npos);
  made.failures = {{"scan one #1", "scan one #1: the automatic alignment abstains"}};  // said elsewhere
  EXPECT_EQ(write(made).find("data-unit=\"scan"), std::string::npos);
}

TEST_F(ReportPage, shows_the_pictures_that_are_there_and_removes_older_ones) {
  io::write_png(folder_ / "scans/one #1/classes.png", Image8(30, 10, 3, 200));
  io::write_text(folder_ / "report/pictures/scans/gone/classes.jpg", "of an older run");
  const std::string html = write(page());
  EXPECT_NE(html.find("src=\"pictures/scans/one%20%231/classes.jpg\""), std::string::npos);
  EXPECT_EQ(html.find("range.jpg"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "report/pictures/scans/one #1/classes.jpg"));
  EXPECT_FALSE(fs::exists(folder_ / "report/pictures/scans/gone"));
}

TEST_F(ReportPage, superclusters_come_from_planes_json_and_their_slope_from_the_pose) {
  const Json planes = {{"superclusters",
                        {{{"id", 7},
                          {"normal", {0, 0, 1}},
                          {"offset_m", -1.5},
                          {"rms_m", 0.00125},
                          {"area_m2", 2.25},
                          {"squares", 4},
                          {"samples", 99},
                          {"contours", Json::array()}}}},
                       {"intersections", Json::array()}};
  io::write_text(folder_ / "scans/one #1/planes.json", planes.dump());
  EXPECT_NE(write(page()).find("[{\"value\":7},2.25,1.25,99,4,null,-1.5,"), std::string::npos);
  const Json pose = {{"world_from_scan", {2, 0, 0, 0, 0, 0, -2, 0, 0, 2, 0, 0, 0, 0, 0, 1}}};  // scaled by 2
  io::write_text(folder_ / "scans/one #1/pose.json", pose.dump());
  EXPECT_NE(write(page()).find("[{\"value\":7},2.25,1.25,99,4,90.0,-1.5,"), std::string::npos);
}

TEST_F(ReportPage, shows_what_was_edited_what_no_photograph_sees_and_what_was_exported) {
  auto made = page();
  const std::string before = write(made);
  for (const char* section : {"id=\"edits\"", "id=\"coverage\"", "id=\"export\""})
    EXPECT_EQ(before.find(section), std::string::npos) << section;
  made.summary["edit"] = {
      {"removed_faces", {kHostile}},
      {"openings", {{"found", 1}, {"cut", 1}}},
      {"displacement", {{{"face", "west"}, {"texel_m", 0.01}, {"size", {30, 20}}, {"measured_m2", 1.5}}}},
      {"scans", {{"one #1", {{"clips", {{{"line", 3}, {"samples", 40}}}}, {"depth_edited_samples", 7}}}}}};
  made.summary["coverage"] = {
      {"texel_m", 0.02},
      {"area_m2", 20},
      {"unseen_m2", 5},
      {"faces", {{{"face", "west"}, {"area_m2", 4}, {"unseen_m2", 1}}}},
      {"next_camera_like", "0.jpg"},
      {"next_cameras", {{{"position", {1, 2, 3}}, {"direction", {0, 1, 0}}, {"gained_m2", 0.75}}}}};
  made.summary["export"] = {{"files", {{{"file", "atlas-0.png"}, {"bytes", 1'000'000}}}},
                            {"notes", {kHostile}}};
  const Json openings = {{"openings",
                          {{{"face", "west"},
                            {"kind", "glass"},
                            {"cut", true},
                            {"area_m2", 2},
                            {"rays", 900},
                            {"confidence", 0.5},
                            {"depth_m", 3}}}}};
  io::write_text(folder_ / "model/openings.json", openings.dump());
  io::write_text(folder_ / "model/displacement/003-west.exr", "");
  for (const char* name : {"model/edited.png", "model/openings/003-west.png", "scans/one #1/clipped.png",
                           "scans/one #1/depth-edits.png", "export/atlas-0.png"})
    io::write_png(folder_ / name, Image8(30, 10, 3, 200));
  const std::string html = write(made);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  for (const char* part :
       {"src=\"pictures/model/edited.jpg\"", "src=\"pictures/model/openings/003-west.jpg\"",
        "src=\"pictures/scans/one%20%231/clipped.jpg\"", "src=\"pictures/scans/one%20%231/depth-edits.jpg\"",
        "src=\"pictures/export/atlas-0.jpg\"", "href=\"../model/displacement/003-west.exr\"",
        "[\"west\",10.0,30,20,1.5]", "[\"one #1\",40,7]", "[\"west\",\"glass\",{\"text\":\"cut\"",
        "5.00 of 20.00 m\u00b2 (25.0 %)", "[\"west\",4.0,1,25.0]", "[1,2,3,\"0.000 1.000 0.000\",0.75]",
        "{\"text\":\"atlas-0.png\",\"href\":\"../export/atlas-0.png\"},1.0]"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

// Each is made once, however often it is asked for; of those that are no pictures the first asked for is
// named.
TEST_F(ReportPage, previews_are_made_once_in_their_order_and_the_first_error_is_told) {
  Image8 picture(6, 4, 3);
  std::fill(picture.pixels.begin(), picture.pixels.end(), std::uint8_t{90});
  for (const char* name : {"a.png", "b.png"}) io::write_png(folder_ / name, picture);
  {
    Previews previews(folder_);
    EXPECT_EQ(previews.of("a.png"), "pictures/a.jpg");
    EXPECT_EQ(previews.of("none.png"), "");
    EXPECT_EQ(previews.of("b.png"), "pictures/b.jpg");
    EXPECT_EQ(previews.of("a.png"), "pictures/a.jpg");
    previews.finish();
  }
  EXPECT_EQ(io::read_photograph(folder_ / "report/pictures/b.jpg", 6, 4).width, 6);
  for (const char* name : {"y.png", "x.png"}) io::write_text(folder_ / name, "no picture");
  Previews previews(folder_);
  for (const char* name : {"a.png", "y.png", "x.png"}) previews.of(name);
  try {
    previews.finish();
    FAIL() << "text was taken for pictures";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("y.png"), std::string::npos) << error.what();
  }
}

TEST(Previews, mean_light_of_blocks_the_last_ones_cut) {
  Image8 picture(5, 3, 1);
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 3; ++y) *picture.at(x, y) = x % 2 == 0 ? 0 : 255;
  const Image8 small = shrink(picture, 3);
  ASSERT_EQ(small.width, 3);
  ASSERT_EQ(small.height, 2);
  EXPECT_EQ(*small.at(0, 0), 188);  // sRGB of half the light
  EXPECT_EQ(*small.at(1, 1), 188);
  EXPECT_EQ(*small.at(2, 0), 0);
  EXPECT_EQ(shrink(picture, 5).pixels, picture.pixels);
}

TEST(ResidualHistogram, counts_by_the_distance) {
  RangeImage image;
  image.rows = 1;
  image.cols = 6;
  image.mask = {kMeasured, kMeasured, kMeasured, kMeasured, kEmpty, kMeasured};
  PlaneSegmentation segmentation;
  segmentation.sample_label = {1, 1, 1, 1, 0, 0};
  const std::vector<float> distance = {0.00005f, 0.0011f, 2.0f, NAN, NAN, NAN};
  const auto histogram = stages::residual_histogram(image, segmentation, distance);
  EXPECT_EQ(histogram.counts.front(), 1);
  EXPECT_EQ(histogram.counts[6], 1);  // 1 mm to 1.58 mm: a decade of 5 above 0.1 mm
  EXPECT_EQ(histogram.counts.back(), 1);
  EXPECT_EQ(histogram.without_face, 1);
  EXPECT_FLOAT_EQ(static_cast<float>(histogram.median_m), 0.0011f);
  EXPECT_THROW(stages::residual_histogram(image, segmentation, {}), Error);
}

}  // namespace hybrid::report::report_page_test
