// Every photograph of the tiny room from the others, and options given on the command line.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

std::string scene() {
  return (room() / "scene.toml").string();
}

}  // namespace

TEST(LeaveOneOut, scores_every_photograph_and_their_mean_and_shows_the_pairs) {
  const Scratch scratch;
  const auto made = run("hybrid run " + scene() + " --leave-one-out --set render.weights=ulr --quiet --out " +
                        scratch.path().string());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto document = nlohmann::json::parse(io::read_text(scratch / "summary.json"));
  EXPECT_EQ(document["options"]["render"]["weights"], "ulr");
  const auto& scores = document["leave_one_out"];
  ASSERT_EQ(scores["photographs"].size(), 6u);
  const std::string page = io::read_text(scratch / "report/index.html");
  double psnr = 0, seen = 0;
  for (const auto& score : scores["photographs"]) {
    const std::string name = std::filesystem::path(score["photograph"].get<std::string>()).stem().string();
    EXPECT_GT(score["psnr_db"], 15.0) << name;
    EXPECT_GT(score["ssim"], 0.3) << name;
    psnr += score["psnr_db"].get<double>() / 6;
    seen += score["share_seen"].get<double>() / 6;
    EXPECT_TRUE(std::filesystem::exists(scratch / ("views/leave-one-out/" + name + "-pair.png")));
    EXPECT_NE(page.find("leave-one-out/" + name + "-pair.png"), std::string::npos);
  }
  EXPECT_NEAR(scores["mean"]["psnr_db"].get<double>(), psnr, 1e-9);
  EXPECT_NEAR(scores["mean"]["share_seen"].get<double>(), seen, 1e-9);
  EXPECT_NE(made.out.find("mean of 6 photographs left out"), std::string::npos) << made.out;
}

TEST(LeaveOneOut, shows_the_proxy_or_the_scans_alone_where_the_command_says_so) {
  const Scratch scratch;
  std::map<std::string, nlohmann::json> means;
  for (const std::string show : {"proxy", "scan", "both"}) {
    const auto made = run("hybrid render " + scene() + " --leave-one-out --show " + show + " --quiet --out " +
                          (scratch / show).string());
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const auto document = nlohmann::json::parse(io::read_text(scratch / show / "summary.json"));
    for (const auto& view : document["views"]) EXPECT_EQ(view["show"], show);
    means[show] = document["leave_one_out"]["mean"];
  }
  // What the scans alone show has holes where planes were; what the proxy lacks is painted on its walls.
  EXPECT_LT(means["scan"]["share_seen"], 0.8 * means["both"]["share_seen"].get<double>());
  EXPECT_LT(means["proxy"]["psnr_db"], means["both"]["psnr_db"].get<double>() - 1);
  const auto wrong = run("hybrid render " + scene() + " --show roof --out " + (scratch / "roof").string());
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("roof"), std::string::npos) << wrong.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "roof"));
}

TEST(LeaveOneOut, chooses_sigma_where_it_is_asked_to_and_says_what_it_tried) {
  const Scratch scratch;
  const auto made =
      run("hybrid render " + scene() +
          " --view both-textured --set render.blend=dual --set render.sigma_px=auto --quiet --out " +
          scratch.path().string());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto document = nlohmann::json::parse(io::read_text(scratch / "summary.json"));
  EXPECT_EQ(document["options"]["render"]["sigma_px"], "auto");
  const auto& sigma = document["sigma"];
  ASSERT_EQ(sigma["tried"].size(), 5u);
  double best_db = 0, best_px = 0;
  for (const auto& trial : sigma["tried"])
    if (trial["psnr_db"].get<double>() > best_db) best_db = trial["psnr_db"], best_px = trial["sigma_px"];
  EXPECT_EQ(sigma["sigma_px"], best_px);
  EXPECT_GT(best_db, 15);
}

TEST(SetOption, a_wrong_assignment_is_a_usage_error_that_names_the_key) {
  const Scratch scratch;
  for (const char* command : {"run", "register", "render"}) {
    const auto wrong = run(std::string("hybrid ") + command + " " + scene() +
                           " --set render.blnd=dual --out " + scratch.path().string());
    EXPECT_EQ(wrong.exit_code, 2) << command;
    EXPECT_NE(wrong.err.find("blnd"), std::string::npos) << wrong.err;
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path())) << command;
  }
  const auto planes =
      run("hybrid planes nothing.ply --set planes.min_squares=none --out " + scratch.path().string());
  EXPECT_EQ(planes.exit_code, 2);
  EXPECT_NE(planes.err.find("min_squares"), std::string::npos) << planes.err;
}

}  // namespace hybrid::e2e
