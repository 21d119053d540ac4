#include <random>

#include "marks.hpp"
#include "score/measure/true_mesh.hpp"

namespace score_tests {
namespace {

const std::string kView = "/views/0/";
const std::vector<std::string> kQuality = {kView + "psnr_db", kView + "ssim", kView + "sharpness",
                                           kView + "detail_agreement", kView + "gain/*"};

}  // namespace

TEST_F(PerfectRoom, another_exposure_costs_nothing) {
  Results results = perfect();
  auto& rgb = results.views[0].image.linear.rgb;
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] *= i % 3 == 0 ? 0.5f : i % 3 == 1 ? 0.8f : 0.6f;
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["views"][0]["gain"][0], 2, 1e-3);
  expect_others_hold(marks, {kView + "gain/*"});
}

TEST_F(PerfectRoom, a_blurred_view_is_less_sharp) {
  Results results = perfect();
  auto& picture = results.views[0].image.linear;
  const auto before = picture.rgb;
  const int width = picture.width;
  for (int row = 1; row + 1 < picture.height; ++row)
    for (int k = 3; k < 3 * (width - 1); ++k) {
      float sum = 0;
      for (int down = -1; down <= 1; ++down)
        for (int right = -1; right <= 1; ++right)
          sum += before[static_cast<std::size_t>((row + down) * 3 * width + k + 3 * right)];
      picture.rgb[static_cast<std::size_t>(row * 3 * width + k)] = sum / 9;
    }
  const auto marks = marks_of(results);
  EXPECT_LT(marks["views"][0]["sharpness"], 0.7);
  EXPECT_LT(marks["views"][0]["psnr_db"], 40);
  EXPECT_LT(marks["views"][0]["ssim"], 0.98);
  expect_others_hold(marks, kQuality);
}

TEST_F(PerfectRoom, a_grainy_view_is_sharp_and_does_not_agree) {
  Results results = perfect();
  std::mt19937 random(7);
  std::uniform_real_distribution<float> grain(0.6f, 1.4f);
  auto& rgb = results.views[0].image.linear.rgb;
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const float factor = grain(random);
    for (std::size_t k = 0; k < 3; ++k) rgb[i + k] *= factor;
  }
  const auto marks = marks_of(results);
  EXPECT_GT(marks["views"][0]["sharpness"], 1.05);
  EXPECT_LT(marks["views"][0]["detail_agreement"], 0.9);
  expect_others_hold(marks, kQuality);
}

TEST_F(PerfectRoom, red_where_photographs_see_is_wrong_red) {
  Results results = perfect();
  auto& image = results.views[0].image;
  for (std::size_t i = 0; i < 2000; ++i) {
    image.coverage[i] = 0;
    image.best[i] = score::kNoPhotograph;
  }
  const auto marks = marks_of(results);
  const double pixels = static_cast<double>(image.linear.pixels());
  EXPECT_GT(marks["views"][0]["red_though_seen_share"], 1000 / pixels);
  EXPECT_GT(marks["views"][0]["red_share"],
            perfect_marks()["views"][0]["red_share"].get<double>() + 1000 / pixels);
  expect_others_hold(marks, {kView + "red*", kView + "share_seen"});
}

TEST_F(PerfectRoom, a_photograph_that_cannot_see_the_point_bleeds) {
  Results results = perfect();
  auto& image = results.views[0].image;
  const score::TrueMesh mesh(score::read_ply(truth().folder / "detail.ply"));
  const auto& camera = truth().views[0].camera;
  std::size_t damaged = 0;
  for (std::size_t i = 0; i < image.best.size(); i += 7) {
    if (image.coverage[i] == 0) continue;
    const auto column = static_cast<double>(i % static_cast<std::size_t>(camera.width_px));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(camera.width_px));
    const auto hit = mesh.first_hit(camera.eye, camera.ray(column + 0.5, row + 0.5));
    for (std::size_t j = 0; j < truth().cameras.size(); ++j)
      if (!mesh.sees(truth().cameras[j], *hit)) {
        image.best[i] = static_cast<std::uint32_t>(j);
        ++damaged;
        break;
      }
  }
  ASSERT_GT(damaged, 1000u);
  const auto marks = marks_of(results);
  const double painted =
      perfect_marks()["views"][0]["share_seen"].get<double>() * static_cast<double>(image.best.size());
  EXPECT_NEAR(marks["views"][0]["bleeding_at_centre_share"], static_cast<double>(damaged) / painted, 1e-9);
  // At outlines and shadow borders a corner of the pixel may be seen.
  EXPECT_GT(marks["views"][0]["bleeding_share"], 0.9 * static_cast<double>(damaged) / painted);
  EXPECT_EQ(marks["views"][0]["bleeding_wrong_surface_share"], 0.0);
  expect_others_hold(marks, {kView + "bleeding*"});
  // The same photographs on a surface that is not the true one: those of the left half are of a wrong
  // surface.
  const auto width = static_cast<std::size_t>(camera.width_px);
  for (std::size_t i = 0; i < image.depth_m.size(); ++i)
    if (i % width < width / 2) image.depth_m[i] += 1;
  const auto behind = marks_of(results)["views"][0];
  EXPECT_EQ(behind["bleeding_share"], marks["views"][0]["bleeding_share"]);
  EXPECT_GT(behind["bleeding_wrong_surface_share"], 0.2 * behind["bleeding_share"].get<double>());
  EXPECT_LT(behind["bleeding_wrong_surface_share"], 0.8 * behind["bleeding_share"].get<double>());
}

}  // namespace score_tests
