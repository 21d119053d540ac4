#include "stages/rendering/equalise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/room_scene.hpp"
#include "core/parallel.hpp"
#include "device.hpp"
#include "stages/rendering/bake_atlas.hpp"

namespace hybrid::testing::equalise_test {
namespace {

using stages::PhotographOverlap;
using stages::Renderer;
using stages::RenderOptions;
using stages::RenderScene;
using stages::ViewRequest;

// Darkens a photograph's linear light by factors per channel.
void darken(Image8& image, const std::array<double, 3>& factors) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint8_t>(
        std::lround(255 * srgb_from_linear(factors[i % 3] * linear_from_srgb(image.pixels[i] / 255.0))));
}

constexpr std::array<double, 3> kDark{0.35, 0.25, 0.3};

// Five photographs, of which 2 and 3 are much darker than the others.
RoomScene unevenly_exposed() {
  RoomScene room = RoomScene::make(5, 320, 240);
  for (const std::size_t i : {2, 3}) darken(room.scene.photograph_pixels[i], kDark);
  return room;
}

ViewRequest view_of(const RenderScene& scene, std::size_t photograph) {
  ViewRequest request;
  request.camera = scene.photographs[photograph];
  return request;
}

// Mean light of a view over that of its photograph, where one is seen, per channel.
std::array<double, 3> brightness(const stages::RenderedView& view, const Image8& photograph) {
  std::array<double, 3> ours{}, its{};
  for (std::size_t i = 0; i < view.coverage.size(); ++i)
    for (std::size_t k = 0; k < 3 && view.coverage[i] > 0; ++k) {
      ours[k] += static_cast<double>(view.colour.pixels[3 * i + k]);
      its[k] += linear_from_srgb(photograph.pixels[3 * i + k] / 255.0);
    }
  return {ours[0] / its[0], ours[1] / its[1], ours[2] / its[2]};
}

}  // namespace

TEST(Equalise, gains_make_overlaps_agree_and_have_mean_1) {
  // 1 is twice as bright as 0, 2 half as bright as 1 in red; 3 overlaps nothing.
  const double two = std::log(2.0);
  const std::vector<PhotographOverlap> overlaps = {{0, 1, 100000, {two, two, two}, 1},
                                                   {1, 2, 100000, {-two, 0, 0}, 1}};
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

TEST(Equalise, photographs_agree_where_cameras_are_right_whatever_their_exposure) {
  const RoomScene room = unevenly_exposed();
  const Renderer renderer(queue(), room.scene, {.equalise = true});
  ASSERT_EQ(renderer.agreements().size(), 5u);
  for (const auto& agreement : renderer.agreements()) {
    EXPECT_GT(agreement.points, 1000u);
    ASSERT_TRUE(agreement.correlation);
    EXPECT_GT(*agreement.correlation, 0.9);
  }
  const Renderer plain(queue(), room.scene, {.equalise = false});
  EXPECT_TRUE(plain.agreements().empty());
}

TEST(Equalise, a_photograph_with_the_camera_of_another_agrees_with_none) {
  RoomScene room = RoomScene::make(5, 320, 240);
  auto& pixels = room.scene.photograph_pixels[2].pixels;
  std::reverse(pixels.begin(), pixels.end());  // as if it hung head down
  const Renderer renderer(queue(), room.scene, {.equalise = true});
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(renderer.agreements()[i].correlation);
    if (i == 2)
      EXPECT_LT(*renderer.agreements()[i].correlation, 0.5);
    else
      EXPECT_GT(*renderer.agreements()[i].correlation, 0.8) << i;
  }
}

TEST(Equalise, nothing_is_said_of_what_is_of_one_tone_and_of_what_sees_nothing) {
  RoomScene room = RoomScene::make(5, 320, 240);
  for (Image8& image : room.scene.photograph_pixels)
    std::fill(image.pixels.begin(), image.pixels.end(), std::uint8_t{128});
  room.scene.photographs[4].cam_from_world.translation -= Vec3(0, 0, 500);  // all of it behind
  const Renderer renderer(queue(), room.scene, {.equalise = true});
  for (const auto& agreement : renderer.agreements()) EXPECT_FALSE(agreement.correlation);
  EXPECT_GT(renderer.agreements()[0].points, 1000u);
  EXPECT_EQ(renderer.agreements()[4].points, 0u);
}

TEST(Equalise, agreement_is_the_median_of_overlaps_by_their_points) {
  stages::PhotographOverlaps overlaps;
  overlaps.points = {10, 20, 30, 40};
  overlaps.pairs = {{0, 1, 100, {}, 0.9}, {0, 2, 300, {}, 0.2}, {1, 2, 50, {}, NAN}};
  const auto agreements = stages::agreements_of(overlaps);
  ASSERT_EQ(agreements.size(), 4u);
  EXPECT_EQ(agreements[0].correlation, 0.2);
  EXPECT_EQ(agreements[1].correlation, 0.9);
  EXPECT_EQ(agreements[2].correlation, 0.2);
  EXPECT_FALSE(agreements[3].correlation);
  EXPECT_EQ(agreements[3].points, 40u);
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

TEST(ViewExposure, a_view_from_a_photograph_s_place_has_that_photograph_s_exposure) {
  const RoomScene room = unevenly_exposed();
  for (const std::string blend : {"nearest", "linear", "dual", "multi-band"}) {
    RenderOptions options;
    options.blend = blend;
    Renderer renderer(queue(), room.scene, options);
    EXPECT_GT(renderer.gains()[2][1] / renderer.gains()[0][1], 3);
    for (const std::size_t photograph : {0, 2}) {
      const auto view = renderer.render(view_of(room.scene, photograph));
      const auto ratio = brightness(view, room.scene.photograph_pixels[photograph]);
      for (std::size_t k = 0; k < 3; ++k) {
        // Others mix in at its border only; without this the ratios are the gains, about 0.6 and 2.
        EXPECT_NEAR(ratio[k], 1, 0.06) << blend << " " << photograph << " " << k;
        EXPECT_NEAR(view.exposure[k] * renderer.gains()[photograph][k], 1, 0.06);
      }
    }
  }
}

TEST(ViewExposure, only_scales_what_photographs_show) {
  const RoomScene room = unevenly_exposed();
  Renderer renderer(queue(), room.scene);
  ViewRequest request = view_of(room.scene, 2);
  request.cameras = true;
  for (const std::size_t i : {0, 1, 2, 4}) request.leave_out.push_back(room.scene.photographs[i].name);
  const auto view = renderer.render(request);
  const auto plain = Renderer(queue(), room.scene, {.equalise = false}).render(request);
  EXPECT_EQ(plain.exposure, (std::array<double, 3>{1, 1, 1}));
  EXPECT_NE(view.exposure, plain.exposure);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(view.exposure[k] * renderer.gains()[3][k], 1, 1e-6);
  EXPECT_EQ(view.coverage, plain.coverage);
  std::size_t unseen = 0, markers = 0;
  for (std::size_t i = 0; i < view.coverage.size(); ++i) {
    if (view.coverage[i] > 0) {  // by the one photograph that is left
      EXPECT_NEAR(view.colour.pixels[3 * i] / plain.colour.pixels[3 * i], 1, 1e-4);
      continue;
    }
    ++(view.id[i] >= 0x40000000u ? markers : unseen);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(view.colour.pixels[3 * i + k], plain.colour.pixels[3 * i + k]);
  }
  EXPECT_GT(unseen, 100u);
  EXPECT_GT(markers, 100u);
  request.texture = false;
  EXPECT_EQ(renderer.render(request).exposure, plain.exposure);
}

TEST(Tone, one_exposure_of_all_photographs_burns_nothing_out) {
  // One wall is three times as bright, which photographs 2 and 3, with a third of the others' exposure, show.
  RoomScene room = RoomScene::make(5, 320, 240);
  constexpr std::uint32_t kBright = 4;  // its id
  for (std::size_t p = 0; p < room.scene.photographs.size(); ++p) {
    const Photograph& photograph = room.scene.photographs[p];
    ImageF light = room.true_view(photograph);
    for (int y = 0; y < light.height; ++y)
      for (int x = 0; x < light.width; ++x) {
        const Vec3 ray =
            photograph.cam_from_world.rotation.conjugate() * photograph.camera.ray(Vec2(x + 0.5, y + 0.5));
        const float factor = (p == 2 || p == 3 ? 0.33f : 1.0f) *
                             (room.hit(photograph.centre(), ray).first == kBright ? 3.0f : 1.0f);
        for (int k = 0; k < 3; ++k) light.at(x, y)[k] *= factor;
      }
    room.scene.photograph_pixels[p] = RoomScene::encode(light);
  }
  // Of all that the photographs show, the share of texels with a channel at 255.
  const auto burnt = [&](const std::string& tone) {
    Renderer renderer(queue(), room.scene, {.tone = tone});
    stages::AtlasOptions options;
    options.texel_m = 0.04;
    const auto atlas = stages::plan_atlas(renderer, room.scene, options);
    const auto page = stages::bake_page(renderer, room.scene, atlas, 0);
    std::size_t at_white = 0;
    for (std::size_t i = 0; i < page.colour.pixels.size(); i += 3) {
      if (page.coverage.pixels[i] == 0 || page.coverage.pixels[i] != page.coverage.pixels[i + 1]) continue;
      at_white += *std::max_element(page.colour.pixels.begin() + static_cast<std::ptrdiff_t>(i),
                                    page.colour.pixels.begin() + static_cast<std::ptrdiff_t>(i + 3)) == 255;
    }
    EXPECT_GT(page.seen, 10000u);
    return static_cast<double>(at_white) / static_cast<double>(page.seen);
  };
  EXPECT_GT(burnt("linear"), 0.03);
  EXPECT_LT(burnt("auto"), 0.01);
}

TEST(Tone, of_views_is_a_choice) {
  const RoomScene room = unevenly_exposed();
  ViewRequest request = view_of(room.scene, 0);
  const auto of = [&](const std::string& tone) {
    return Renderer(queue(), room.scene, {.tone = tone}).render(request);
  };
  const auto automatic = of("auto"), toned = of("shoulder");
  EXPECT_EQ(automatic.shoulder.level(1.5), 1.5);
  EXPECT_LT(toned.shoulder.level(1.5), 1.5);
  EXPECT_EQ(automatic.colour.pixels, toned.colour.pixels);  // light is light: pictures alone change
}

TEST(ViewExposure, of_photographs_left_out_does_not_count) {
  const RoomScene room = unevenly_exposed();
  Renderer renderer(queue(), room.scene);
  ViewRequest request = view_of(room.scene, 2);
  request.leave_out = {room.scene.photographs[2].name, room.scene.photographs[3].name};
  const auto& gains = renderer.gains();
  const auto view = renderer.render(request);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(view.exposure[k] * gains[0][k], 1, 0.05);
  request.leave_out.clear();
  for (const auto& photograph : room.scene.photographs) request.leave_out.push_back(photograph.name);
  EXPECT_EQ(renderer.render(request).exposure, (std::array<double, 3>{1, 1, 1}));
}

TEST(ViewExposure, changes_slowly_along_a_path_from_dark_to_bright_photographs) {
  const RoomScene room = unevenly_exposed();
  Renderer renderer(queue(), room.scene);
  constexpr int kFrames = 50;
  double last = 0, first = 0, largest = 0;
  for (int frame = 0; frame <= kFrames; ++frame) {
    const double t = static_cast<double>(frame) / kFrames;
    ViewRequest request;
    request.camera = look_at(Vec3(3.6, 0.4, 1.5) + t * Vec3(-3, 0.1, 0.1), Vec3(2, 4, 1) + t * Vec3(1, -1, 0),
                             {0, 0, 1}, 65, 96, 72);
    const double now = std::log(renderer.render(request).exposure[1]);
    if (frame == 0) first = now;
    if (frame > 0) largest = std::max(largest, std::abs(now - last));
    last = now;
  }
  const double change = std::abs(last - first);
  EXPECT_GT(change, 0.5);
  EXPECT_LT(largest, 0.2 * change);
}

TEST(ViewExposure, same_bytes_for_any_tile_and_thread_count) {
  const RoomScene room = unevenly_exposed();
  ViewRequest request = view_of(room.scene, 2);
  request.leave_out = {room.scene.photographs[2].name};
  const auto rendered = [&](int tile) {
    RenderOptions options;
    options.tile = tile;
    options.samples_per_axis = 2;
    return Renderer(queue(), room.scene, options).render(request);
  };
  const auto whole = rendered(1024);
  const int threads = thread_count();
  for (const int count : {1, 3}) {
    set_thread_count(count);
    const auto tiled = rendered(64);
    EXPECT_EQ(whole.exposure, tiled.exposure);
    EXPECT_TRUE(same_bits(whole.colour.pixels, tiled.colour.pixels));
  }
  set_thread_count(threads);
}

}  // namespace hybrid::testing::equalise_test
