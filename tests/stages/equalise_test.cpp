#include "stages/equalise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cases/room_scene.hpp"
#include "device.hpp"

namespace hybrid::testing {
namespace {

using stages::PhotographOverlap;
using stages::Renderer;

// Darkens a photograph's linear light by factors per channel.
void darken(Image8& image, const std::array<double, 3>& factors) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint8_t>(
        std::lround(255 * srgb_from_linear(factors[i % 3] * linear_from_srgb(image.pixels[i] / 255.0))));
}

}  // namespace

TEST(Equalise, gains_make_overlaps_agree_and_have_mean_1) {
  // 1 is twice as bright as 0, 2 half as bright as 1 in red; 3 overlaps nothing.
  const double two = std::log(2.0);
  const std::vector<PhotographOverlap> overlaps = {{0, 1, 100000, {two, two, two}},
                                                   {1, 2, 100000, {-two, 0, 0}}};
  const auto gains = stages::solve_gains(4, overlaps);
  EXPECT_NEAR(gains[0][0] / gains[1][0], 2, 2e-3);
  EXPECT_NEAR(gains[2][0] / gains[1][0], 2, 2e-3);
  EXPECT_NEAR(gains[2][1] / gains[1][1], 1, 2e-3);
  EXPECT_NEAR(gains[0][1] * gains[1][1] * gains[2][1], 1, 2e-3);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(gains[3][k], 1);
  EXPECT_TRUE(stages::solve_gains(0, {}).empty());
}

TEST(Equalise, a_darker_and_redder_photograph_is_brought_back) {
  RoomScene room = RoomScene::make(5, 320, 240);
  const std::array<double, 3> factors{0.8, 0.6, 0.55};
  darken(room.scene.photograph_pixels[2], factors);
  Renderer renderer(queue(), room.scene, {.equalise = true});
  const auto& gains = renderer.gains();
  for (std::size_t k = 0; k < 3; ++k)
    for (const std::size_t other : {0, 1, 3, 4})
      EXPECT_NEAR(gains[2][k] / gains[other][k] * factors[k], 1, 0.03) << other << " " << k;
  // The gains reach the picture: photograph 2's own view from the others, which are bright, and from itself.
  const Renderer plain(queue(), room.scene, {.equalise = false});
  for (const auto& gain : plain.gains()) EXPECT_EQ(gain, (std::array<double, 3>{1, 1, 1}));
}

TEST(Equalise, photographs_that_differ_in_exposure_blend_without_a_seam) {
  RoomScene room = RoomScene::make(5, 320, 240);
  const ImageF truth = room.true_view(room.scene.photographs[0]);
  darken(room.scene.photograph_pixels[2], {0.6, 0.6, 0.6});
  darken(room.scene.photograph_pixels[4], {0.5, 0.7, 0.5});
  stages::ViewRequest request;
  request.camera = room.scene.photographs[0];
  request.leave_out = {room.scene.photographs[0].name};
  const auto quality = [&](bool equalise) {
    Renderer renderer(queue(), room.scene, {.equalise = equalise});
    const auto view = renderer.render(request);
    std::vector<std::uint8_t> mask;
    for (std::uint32_t n : view.coverage) mask.push_back(n > 0);
    return stages::compare_images(view.colour, RoomScene::encode(truth), mask).psnr_db;
  };
  EXPECT_GT(quality(true), quality(false) + 3);
}

}  // namespace hybrid::testing
