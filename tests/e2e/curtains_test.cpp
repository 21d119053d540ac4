// [render] unseen_m through the program: curtains reach views and exports, and nothing else decides about
// them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// The tiny room rendered and exported into `out`; its summary.
nlohmann::json rendered(const fs::path& out, const std::string& options) {
  const auto made =
      run("hybrid run " + (room() / "scene.toml").string() +
          " --only render,export --quiet --set export.texel_m=0.1 " + options + " --out " + out.string());
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return nlohmann::json::parse(io::read_text(out / "summary.json"));
}

double red_share(const nlohmann::json& summary, const std::string& name) {
  for (const auto& view : summary["views"])
    if (view["name"] == name) return view["red_share"];
  ADD_FAILURE() << "no view " << name;
  return 0;
}

}  // namespace

TEST(Curtains, hide_things_in_views_and_exports_with_the_same_bytes_for_any_tile_and_thread_count) {
  const Scratch scratch;
  const auto open = rendered(scratch / "open", "--set render.unseen_m=0");
  const auto closed = rendered(scratch / "closed", "");  // 0.1
  // measured: 0.0443, 0.0517
  EXPECT_GT(red_share(closed, "leave-one-out"), red_share(open, "leave-one-out") + 0.003);
  // 0.78501, 0.78534
  EXPECT_GT(closed["export"]["atlas"]["red_share"], open["export"]["atlas"]["red_share"]);
  rendered(scratch / "tiled", "--set render.tile=64 --threads 1");
  EXPECT_EQ(content_list(scratch / "tiled/views"), content_list(scratch / "closed/views"));
  EXPECT_NE(content_list(scratch / "tiled/views"), content_list(scratch / "open/views"));
}

}  // namespace hybrid::e2e
