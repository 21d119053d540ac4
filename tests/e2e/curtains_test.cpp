// [render] unseen_m through the program: curtains reach views and exports, and nothing else decides about
// them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// The tiny room rendered and exported into `out`; its summary. Without its columns, whose backs are drawn
// where there are curtains (column_backs.hpp), and without what makes samples at their limbs red.
nlohmann::json rendered(const fs::path& out, const std::string& options) {
  const auto made =
      run("hybrid run " + (room() / "scene.toml").string() +
          " --only render,export --quiet --set export.texel_m=0.1 --set planes.min_cylinder_samples=0 "
          "--set render.grazing_sample_deg=0 " +
          options + " --out " + out.string());
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return nlohmann::json::parse(io::read_text(out / "summary.json"));
}

nlohmann::json view_of(const nlohmann::json& summary, const std::string& name) {
  for (const auto& view : summary["views"])
    if (view["name"] == name) return view;
  ADD_FAILURE() << "no view " << name;
  return {};
}

}  // namespace

TEST(Curtains, hide_things_in_views_and_exports_with_the_same_bytes_for_any_tile_and_thread_count) {
  const Scratch scratch;
  const auto open = rendered(scratch / "open", "--set render.unseen_m=0");
  const auto closed = rendered(scratch / "closed", "");  // 0.1
  const auto with = view_of(closed, "leave-one-out"), without = view_of(open, "leave-one-out");
  // measured: 0.0703, 0.0497
  EXPECT_GT(with["red_share"], without["red_share"].get<double>() + 0.01);
  EXPECT_GT(without["left_out"]["share_seen"], 0.95);  // 0.9503
  EXPECT_GT(without["left_out"]["psnr_db"], 26.0);     // 26.10
  // What is lost was wrong: 27.03.
  EXPECT_GT(with["left_out"]["psnr_db"], without["left_out"]["psnr_db"].get<double>() + 0.5);
  // 0.78501, 0.78534
  EXPECT_GT(closed["export"]["atlas"]["red_share"], open["export"]["atlas"]["red_share"]);
  // Of every retained sample the summary says what became of it.
  std::int64_t in_the_air = 0;
  for (const auto& scan : closed["scans"]) {
    const auto count = [&](const char* which) { return scan["drawn"][which].get<std::int64_t>(); };
    EXPECT_GT(count("on_contours"), 0);
    EXPECT_GT(count("on_faces"), 0);
    EXPECT_LE(count("on_faces"), count("drawn"));
    EXPECT_GT(count("drawn"), count("retained") / 2);
    EXPECT_EQ(count("retained"),
              count("on_contours") + count("in_the_air") + count("seen_finer") + count("drawn"));
    in_the_air += count("in_the_air");
  }
  EXPECT_GT(in_the_air, 0);
  EXPECT_LT(in_the_air, 1000);
  rendered(scratch / "tiled", "--set render.tile=64 --threads 1");
  EXPECT_EQ(content_list(scratch / "tiled/views"), content_list(scratch / "closed/views"));
  EXPECT_NE(content_list(scratch / "tiled/views"), content_list(scratch / "open/views"));
}

}  // namespace hybrid::e2e
