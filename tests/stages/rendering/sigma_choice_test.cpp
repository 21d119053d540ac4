#include <gtest/gtest.h>

#include <algorithm>

#include "cases/room_scene.hpp"
#include "device.hpp"
#include "stages/rendering/render_requests.hpp"

namespace hybrid::testing::sigma_choice_test {
namespace {

using stages::Renderer;
using stages::RenderOptions;

const RoomScene& room() {
  static const RoomScene instance = RoomScene::make(4, 120, 90);
  return instance;
}

}  // namespace

TEST(SigmaChoice, takes_the_best_of_what_it_tried_and_renders_with_it) {
  for (const char* blend : {"dual", "multi-band"}) {
    SCOPED_TRACE(blend);
    const Renderer renderer(queue(), room().scene, {.blend = blend, .auto_sigma = true});
    const auto& choice = renderer.sigma_choice();
    ASSERT_TRUE(choice);
    std::vector<double> sigmas;
    for (const auto& trial : choice->tried) sigmas.push_back(trial.sigma_px);
    EXPECT_EQ(sigmas, (std::vector<double>{1, 2, 4, 8, 16}));
    const auto best = std::max_element(choice->tried.begin(), choice->tried.end(),
                                       [](const auto& a, const auto& b) { return a.psnr_db < b.psnr_db; });
    EXPECT_EQ(choice->sigma_px, best->sigma_px);
    EXPECT_EQ(renderer.options().sigma_px, choice->sigma_px);
    EXPECT_GT(best->psnr_db, 20);
  }
}

TEST(SigmaChoice, gives_the_picture_of_that_sigma_again_and_again) {
  stages::ViewRequest request;
  request.camera = look_at({1, 1, 1.5}, {4, 3, 1}, Vec3::UnitZ(), 60, 80, 60);
  Renderer renderer(queue(), room().scene, {.blend = "dual", .auto_sigma = true, .photograph_mb = 1});
  const double sigma_px = renderer.sigma_choice()->sigma_px;
  const auto told = render(room().scene, request, {.blend = "dual", .sigma_px = sigma_px});
  EXPECT_TRUE(same_bits(renderer.render(request).colour.pixels, told.colour.pixels));
  EXPECT_TRUE(same_bits(renderer.render(request).colour.pixels, told.colour.pixels));
}

TEST(SigmaChoice, there_is_none_without_bands_or_with_one_photograph) {
  EXPECT_FALSE(Renderer(queue(), room().scene, {.blend = "linear", .auto_sigma = true}).sigma_choice());
  EXPECT_FALSE(Renderer(queue(), room().scene, {.blend = "dual"}).sigma_choice());
  stages::RenderScene alone = room().scene;
  alone.photographs.resize(1);
  alone.photograph_pixels.resize(1);
  EXPECT_FALSE(Renderer(queue(), alone, {.blend = "dual", .auto_sigma = true}).sigma_choice());
}

// Gaussians are no wider than 64 px: the widest of seven bands are 32 times the narrowest.
TEST(SigmaChoice, many_bands_leave_few_candidates) {
  const Renderer renderer(queue(), room().scene, {.blend = "multi-band", .auto_sigma = true, .bands = 7});
  EXPECT_EQ(renderer.sigma_choice()->tried.size(), 2u);
}

TEST(SigmaChoice, nothing_that_others_see_leaves_sigma_as_it_was) {
  stages::RenderScene apart = room().scene;
  apart.photographs.resize(2);
  apart.photograph_pixels.resize(2);
  for (Photograph& photograph : apart.photographs)  // out of the room, which has no outside
    photograph.cam_from_world.translation += Vec3(0, 0, 1000);
  const Renderer renderer(queue(), apart, {.blend = "dual", .sigma_px = 3, .auto_sigma = true});
  EXPECT_TRUE(renderer.sigma_choice()->tried.empty());
  EXPECT_EQ(renderer.options().sigma_px, 3);
}

}  // namespace hybrid::testing::sigma_choice_test
