#include "stages/rendering/render.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cases/room_scene.hpp"
#include "device.hpp"
#include "stages/rendering/render_requests.hpp"

namespace hybrid::testing::render_test {
namespace {

using stages::RenderedView;
using stages::Renderer;
using stages::RenderOptions;
using stages::RenderScene;
using stages::ViewRequest;

const RoomScene& room() {
  static const RoomScene instance = RoomScene::make(4, 240, 180);
  return instance;
}

std::vector<std::uint8_t> seen_mask(const RenderedView& image) {
  std::vector<std::uint8_t> mask;
  for (std::uint32_t photographs : image.coverage) mask.push_back(photographs > 0);
  return mask;
}

// blend and weights, every combination.
const std::array<std::array<const char*, 2>, 8> kMixes{{{"nearest", "angle"},
                                                        {"linear", "angle"},
                                                        {"dual", "angle"},
                                                        {"nearest", "ulr"},
                                                        {"linear", "ulr"},
                                                        {"dual", "ulr"},
                                                        {"multi-band", "angle"},
                                                        {"multi-band", "ulr"}}};

void expect_same(const RenderedView& a, const RenderedView& b) {
  EXPECT_TRUE(same_bits(a.colour.pixels, b.colour.pixels));
  EXPECT_TRUE(same_bits(a.depth_m, b.depth_m));
  EXPECT_TRUE(same_bits(a.normal.pixels, b.normal.pixels));
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.coverage, b.coverage);
  EXPECT_EQ(a.best, b.best);
}

bool red(const RenderedView& image, std::size_t i) {
  return image.colour.pixels[3 * i] == 1 && image.colour.pixels[3 * i + 1] == 0 &&
         image.colour.pixels[3 * i + 2] == 0;
}

}  // namespace

TEST(Render, from_a_photographs_own_pose_returns_the_photograph) {
  for (const auto& [blend, weights] : kMixes) {
    RenderOptions options;
    options.blend = blend;
    options.weights = weights;
    options.feather_px = 0;  // at its border the photograph would give way to others
    Renderer renderer(queue(), room().scene, options);
    for (std::size_t i = 0; i < 2; ++i) {
      ViewRequest request;
      request.camera = room().scene.photographs[i];
      const RenderedView image = renderer.render(request);
      const auto quality =
          stages::compare_images(image.colour, room().scene.photograph_pixels[i], seen_mask(image));
      EXPECT_GT(quality.psnr_db, 48) << blend << weights;  // others mix in with a weight of under 1 %
      EXPECT_GT(quality.ssim, 0.995) << blend << weights;
      EXPECT_GT(quality.share_seen, 0.999) << blend << weights;
      // The photograph itself is the heaviest wherever it is seen.
      EXPECT_EQ(std::count(image.best.begin(), image.best.end(), static_cast<int>(i)),
                static_cast<std::ptrdiff_t>(image.best.size()));
    }
  }
}

TEST(Render, a_photograph_left_out_is_predicted_by_the_others) {
  ViewRequest request;
  request.camera = room().scene.photographs[0];
  request.leave_out = {"photo-0"};
  const RenderedView image = render(room().scene, request);
  const auto quality =
      stages::compare_images(image.colour, room().scene.photograph_pixels[0], seen_mask(image));
  EXPECT_GT(quality.psnr_db, 32);
  EXPECT_GT(quality.share_seen, 0.5);
  EXPECT_EQ(std::count(image.best.begin(), image.best.end(), 0), 0);
}

TEST(Render, photographs_of_one_colour_give_that_colour_however_they_mix) {
  // Weights sum to one and high bands of nothing stay nothing, at borders and shadows' edges too.
  RenderScene scene = room().scene;
  for (Image8& image : scene.photograph_pixels)
    std::fill(image.pixels.begin(), image.pixels.end(), std::uint8_t{128});
  const float expected = static_cast<float>(linear_from_srgb(128 / 255.0));
  for (const auto& [blend, weights] : kMixes) {
    RenderOptions options;
    options.blend = blend;
    options.weights = weights;
    const RenderedView image = render(scene, view({5.6, 4.6, 2.6}, {2, 1, 0}), options);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < image.id.size(); ++i) {
      if (image.coverage[i] == 0) continue;
      ++seen;
      // The low band is kept in half precision, 2^-11.
      ASSERT_NEAR(image.colour.pixels[3 * i + 1], expected, 2e-4f) << blend << weights;
    }
    EXPECT_GT(seen, 5000u);
  }
}

TEST(Render, dual_is_multi_band_of_two_bands_and_four_mix_otherwise) {
  RenderOptions options;
  options.blend = "dual";
  const ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0});
  const RenderedView dual = render(room().scene, request, options);
  options.blend = "multi-band";
  options.bands = 2;
  expect_same(dual, render(room().scene, request, options));
  options.bands = 4;
  EXPECT_FALSE(same_bits(dual.colour.pixels, render(room().scene, request, options).colour.pixels));
}

TEST(Render, every_mix_sees_the_same_surface) {
  const ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0});
  const RenderedView first = render(room().scene, request);
  for (const auto& [blend, weights] : kMixes) {
    RenderOptions options;
    options.blend = blend;
    options.weights = weights;
    const RenderedView image = render(room().scene, request, options);
    EXPECT_EQ(image.coverage, first.coverage) << blend << weights;
    EXPECT_EQ(image.id, first.id) << blend << weights;
  }
}

TEST(Render, only_k_photographs_mix_by_unstructured_lumigraph_weights) {
  // With k = 1 linear is nearest, wherever another photograph ends the best one's weight.
  RenderOptions one;
  one.weights = "ulr";
  one.ulr_k = 1;
  one.blend = "linear";
  const ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0});
  const RenderedView linear = render(room().scene, request, one);
  one.blend = "nearest";
  const RenderedView nearest = render(room().scene, request, one);
  EXPECT_TRUE(same_bits(linear.best, nearest.best));
  for (std::size_t i = 0; i < linear.colour.pixels.size(); ++i)
    ASSERT_NEAR(linear.colour.pixels[i], nearest.colour.pixels[i], 1e-5f);
}

TEST(Render, nothing_bleeds_behind_an_occluder_and_what_no_photograph_sees_is_red) {
  // Every face has a paint of its own: a colour from the wrong surface is far off.
  const ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0});
  const ImageF truth = room().true_view(request.camera);
  for (const char* blend : {"linear", "dual", "multi-band"}) {
    RenderOptions options;
    options.blend = blend;
    const RenderedView image = render(room().scene, request, options);
    std::size_t unseen = 0, wrong = 0, seen = 0;
    for (std::size_t i = 0; i < image.id.size(); ++i) {
      if (image.coverage[i] == 0) {
        ++unseen;
        EXPECT_TRUE(red(image, i));
        EXPECT_EQ(image.best[i], -1);
        continue;
      }
      ++seen;
      double error = 0;
      for (std::size_t k = 0; k < 3; ++k)
        error = std::max(error, std::abs(double{image.colour.pixels[3 * i + k]} - truth.pixels[3 * i + k]));
      wrong += error > 0.08;
    }
    EXPECT_GT(unseen, 100u);
    EXPECT_GT(seen, 5000u);
    // Only pixels next to an edge, where the photographs themselves mix both sides.
    EXPECT_LT(static_cast<double>(wrong), 0.03 * static_cast<double>(seen)) << blend;
  }
}

TEST(Render, depth_normal_and_id_are_those_of_the_nearest_face) {
  const ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0}, 80, 60);
  const RenderedView image = render(room().scene, request);
  const Pose& cam = request.camera.cam_from_world;
  std::size_t other_face = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const auto i = static_cast<std::size_t>(80 * y + x);
      const Vec3 direction = cam.rotation.conjugate() * request.camera.camera.ray(Vec2(x + 0.5, y + 0.5));
      const auto [id, distance] = room().hit(request.camera.centre(), direction);
      if (image.id[i] != id) {
        ++other_face;  // a ray along an edge
        continue;
      }
      EXPECT_NEAR(image.depth_m[i], distance * cam.rotate(direction).z(), 1e-4);
      const Plane plane = face_plane(room().scene.proxy, room().scene.proxy.faces[id - 1]);
      const Vec3 normal(image.normal.at(x, y)[0], image.normal.at(x, y)[1], image.normal.at(x, y)[2]);
      EXPECT_NEAR(std::abs(normal.dot(plane.normal)), 1, 1e-5);
      EXPECT_LT(normal.dot(direction), 0);
    }
  EXPECT_LE(other_face, 2u);
}

TEST(Render, all_photographs_left_out_is_all_red) {
  ViewRequest request = view({1, 1, 1.5}, {3, 3, 1}, 40, 30);
  for (const auto& photograph : room().scene.photographs) request.leave_out.push_back(photograph.name);
  const RenderedView image = render(room().scene, request);
  for (std::size_t i = 0; i < image.id.size(); ++i) EXPECT_TRUE(red(image, i) && image.coverage[i] == 0);
}

TEST(Render, an_empty_scene_is_black_and_infinitely_far) {
  for (const char* show : {"proxy", "scan", "both"}) {
    ViewRequest request = view({1, 1, 1.5}, {3, 3, 1}, 5, 1);
    request.show = show;
    const RenderedView image = render({}, request);
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_TRUE(std::isinf(image.depth_m[i]));
      EXPECT_EQ(image.id[i] + image.coverage[i], 0u);
      EXPECT_EQ(image.colour.pixels[3 * i], 0);
    }
  }
}

TEST(Render, a_camera_inside_a_closed_block_sees_its_inner_sides) {
  ViewRequest request = view({2.5, 2.5, 0.6}, {3, 2.5, 0.6}, 20, 20);
  request.texture = false;
  const RenderedView image = render(room().scene, request);
  for (std::size_t i = 0; i < image.id.size(); ++i) {
    EXPECT_GE(image.id[i], 7u);
    EXPECT_LE(image.id[i], 12u);
    EXPECT_GT(image.colour.pixels[3 * i], 0);
  }
}

TEST(Render, a_concave_face_with_a_hole_shows_what_is_behind_it) {
  RenderScene scene;
  // An L in the plane y = 0 with a hole, before a wall at y = 1.
  for (const auto& [x, z] : {std::pair(0, 0), {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}})
    scene.proxy.vertices.emplace_back(x, 0, z);
  for (const auto& [x, z] : {std::pair(0.3, 0.3), {0.3, 0.7}, {0.7, 0.7}, {0.7, 0.3}})
    scene.proxy.vertices.emplace_back(x, 0, z);
  for (const auto& [x, z] : {std::pair(-9, -9), {9, -9}, {9, 9}, {-9, 9}})
    scene.proxy.vertices.emplace_back(x, 1, z);
  scene.proxy.faces.push_back({"l", {0, 1, 2, 3, 4, 5}, {{6, 7, 8, 9}}});
  scene.proxy.faces.push_back({"wall", {10, 11, 12, 13}, {}});
  ViewRequest request = view({1.5, -6, 1.5}, {1.5, 0, 1.5}, 64, 64);
  const RenderedView image = render(scene, request);
  const auto id_at = [&](double x, double z) {
    const Vec2 pixel = *request.camera.camera.project(request.camera.cam_from_world * Vec3(x, 0, z));
    return image.id[static_cast<std::size_t>(pixel.y()) * 64 + static_cast<std::size_t>(pixel.x())];
  };
  EXPECT_EQ(id_at(3, 0.5), 1u);
  EXPECT_EQ(id_at(0.5, 3), 1u);
  EXPECT_EQ(id_at(0.5, 0.5), 2u);
  EXPECT_EQ(id_at(2.5, 2.5), 2u);
}

TEST(Render, the_same_bytes_at_any_tile_and_work_group_size) {
  const ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0}, 101, 67);
  for (const auto& [blend, weights] :
       {std::pair("linear", "ulr"), {"dual", "angle"}, {"dual", "ulr"}, {"multi-band", "ulr"}}) {
    RenderOptions large, small;
    large.blend = small.blend = blend;
    large.weights = small.weights = weights;
    small.tile = 17;
    const RenderedView whole = render(room().scene, request, large);
    expect_same(whole, render(room().scene, request, small));
    const auto [a, b] = at_two_work_group_sizes([&] { return render(room().scene, request, large); });
    expect_same(whole, a);
    expect_same(whole, b);
  }
}

TEST(Render, more_rays_per_pixel_smooth_edges_and_keep_the_rest) {
  RenderOptions options;
  options.samples_per_axis = 3;
  ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0}, 64, 48);
  request.texture = false;
  const RenderedView one = render(room().scene, request), nine = render(room().scene, request, options);
  EXPECT_EQ(one.id, nine.id);  // the middle ray decides
  double largest = 0, mean = 0;
  for (std::size_t i = 0; i < one.colour.pixels.size(); ++i) {
    const double difference = std::abs(one.colour.pixels[i] - nine.colour.pixels[i]);
    largest = std::max(largest, difference);
    mean += difference / static_cast<double>(one.colour.pixels.size());
  }
  EXPECT_GT(largest, 0.02);
  EXPECT_LT(mean, 0.02);
}

TEST(Render, far_from_the_origin_the_picture_stays) {
  const ViewRequest request = view({5.6, 4.6, 2.6}, {2, 1, 0}, 80, 60);
  const Vec3 shift(530000, 180000, 40);
  RenderScene moved = room().scene;
  for (Vec3& vertex : moved.proxy.vertices) vertex += shift;
  const auto move = [&](Photograph& p) { p.cam_from_world.translation -= p.cam_from_world.rotate(shift); };
  for (Photograph& photograph : moved.photographs) move(photograph);
  ViewRequest there = request;
  move(there.camera);
  const RenderedView a = render(room().scene, request), b = render(moved, there);
  std::size_t other = 0;
  for (std::size_t i = 0; i < a.id.size(); ++i)
    other += a.id[i] != b.id[i] || std::abs(a.colour.pixels[3 * i + 1] - b.colour.pixels[3 * i + 1]) > 0.02f;
  EXPECT_LT(other, 20u);  // rays along edges
}

TEST(Render, samples_win_over_the_face_they_lie_on_and_show_selects) {
  RenderScene scene = room().scene;
  // A patch of samples 1 cm behind the wall x = 0, and one 10 cm behind it, hidden.
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 40; ++k)
      for (float x : {-0.01f, -0.1f})
        scene.splats.push_back(
            {{x, 2 + 0.02f * static_cast<float>(i), 1 + 0.02f * static_cast<float>(k) + (x < -0.05f ? 1 : 0)},
             0.015f,
             {1, 0, 0},
             3});
  ViewRequest request = view({2, 2.5, 1.8}, {0, 2.5, 1.8}, 120, 120);
  const auto ids = [&](const char* show) {
    request.show = show;
    const RenderedView image = render(scene, request);
    return std::array<std::ptrdiff_t, 3>{
        std::count(image.id.begin(), image.id.end(), 0u),
        std::count_if(image.id.begin(), image.id.end(), [](auto id) { return id != 0 && id < 0x80000000u; }),
        std::count_if(image.id.begin(), image.id.end(), [](auto id) { return id >= 0x80000000u; })};
  };
  const auto proxy = ids("proxy"), scan = ids("scan"), both = ids("both");
  EXPECT_EQ(proxy[1], 120 * 120);
  EXPECT_EQ(scan[1], 0);
  EXPECT_GT(scan[0], 0);
  EXPECT_EQ(both[0], 0);
  EXPECT_GT(both[2], 1000);
  EXPECT_LT(both[2], scan[2]);  // the farther patch is hidden
  // Neither patch nor wall darken each other: what the photographs see of the wall they see of the samples.
  request.show = "both";
  const RenderedView image = render(scene, request);
  request.show = "proxy";
  const RenderedView bare = render(room().scene, request);
  std::size_t lost = 0;
  for (std::size_t i = 0; i < image.id.size(); ++i) lost += image.coverage[i] < bare.coverage[i];
  EXPECT_LT(lost, 150u);
}

TEST(Render, a_contour_polygon_is_a_surface_of_the_scan_and_stands_in_for_its_samples) {
  RenderScene scene = room().scene;
  const auto faces = scene.proxy.faces.size();
  // A door leaf that the proxy lacks, in the middle of the room, as two scans measured it 2 mm apart; and
  // samples that a proxy face stands for.
  for (const double x : {2.0, 2.002}) {
    const auto base = static_cast<std::uint32_t>(scene.contours.vertices.size());
    for (const auto& [y, z] :
         {std::pair{2.0, 0.8}, std::pair{3.0, 0.8}, std::pair{3.0, 2.6}, std::pair{2.0, 2.6}})
      scene.contours.vertices.emplace_back(x, y, z);
    scene.contours.faces.push_back({"leaf", {base, base + 1, base + 2, base + 3}, {}});
    scene.contour_scan.push_back(static_cast<std::uint32_t>(scene.contour_scan.size()));
  }
  scene.splats.push_back({{0.005f, 2.5f, 1.8f}, 0.1f, {1, 0, 0}, 0, true});
  ViewRequest request = view({0.6, 2.5, 1.7}, {2, 2.5, 1.7}, 120, 120);
  const auto count = [&](const char* show, std::uint32_t first, std::uint32_t end) {
    request.show = show;
    const RenderedView image = render(scene, request);
    return std::count_if(image.id.begin(), image.id.end(), [&](auto id) { return id >= first && id < end; });
  };
  constexpr std::uint32_t kContour = 0x20000000u;
  EXPECT_GT(count("both", kContour, kContour + 1), 5000);  // the nearer of the two
  EXPECT_GT(count("scan", kContour, kContour + 1), 5000);
  EXPECT_EQ(count("proxy", kContour, kContour + 2), 0);
  EXPECT_EQ(count("both", 1, static_cast<std::uint32_t>(faces) + 1) + count("both", kContour, kContour + 2),
            120 * 120);  // no hole, and no splat on a face
  // The two do not shadow each other, from either side: every pixel of a leaf is seen by as many photographs
  // as when it hangs there alone.
  for (const double eye_x : {0.6, 3.4}) {
    request = view({eye_x, 2.5, 1.7}, {2, 2.5, 1.7}, 120, 120);
    const RenderedView two = render(scene, request);
    RenderScene alone = scene;
    alone.contours.faces.pop_back();
    const RenderedView one = render(alone, request);
    std::size_t less = 0;
    for (std::size_t i = 0; i < two.id.size(); ++i)
      less += two.id[i] >= kContour && two.id[i] == one.id[i] && two.coverage[i] < one.coverage[i];
    EXPECT_EQ(less, 0u) << eye_x;
  }
  // From behind it has the colour of the side it was scanned from, as samples have: here that towards +x.
  const auto& photographs = scene.photographs;
  const auto in_front = std::count_if(photographs.begin(), photographs.end(),
                                      [](const Photograph& p) { return p.centre().x() > 2; });
  request = view({0.6, 2.5, 1.7}, {2, 2.5, 1.7}, 120, 120);
  const RenderedView behind = render(scene, request);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < behind.id.size(); ++i) {
    if (behind.id[i] < kContour) continue;
    seen += behind.coverage[i] > 0;
    EXPECT_LE(behind.coverage[i], static_cast<std::uint32_t>(in_front));
  }
  EXPECT_GT(seen, 1000u);
  request = view({1.5, 2.5, 1.8}, {0, 2.5, 1.8}, 120, 120);
  EXPECT_EQ(count("both", 0x80000000u, 0x80000001u), 0);
  EXPECT_GT(count("scan", 0x80000000u, 0x80000001u), 0);
}

TEST(Render, a_splat_and_a_contour_take_colour_from_the_side_they_are_seen_from) {
  // A scan sees one side of what stands there; on the other side is a back that it knows nothing of, and what
  // a photograph shows of the front does not belong on it.
  RenderScene scene;
  scene.splats = {{{0, 0, 0}, 0.2f, {0, -1, 0}, 0}, {{1, 0, 0}, 0.2f, {0, 0, 0}, 0}};
  scene.contours.vertices = {{-1.2, 0, -0.2}, {-0.8, 0, -0.2}, {-0.8, 0, 0.2}, {-1.2, 0, 0.2}};
  scene.contours.faces = {Face{}};
  scene.contours.faces[0].outer = {0, 1, 2, 3};  // its front towards -y
  scene.contour_scan = {0};
  Photograph front = look_at({0.5, -3, 0}, {0, 0, 0}, {0, 0, 1}, 60, 32, 32);
  front.name = "front";
  scene.photographs = {front};
  scene.photograph_pixels = {Image8(32, 32, 3, 255)};
  for (const double side : {-1.0, 1.0})
    for (const float scanned_from : {-1.0f, 1.0f}) {
      scene.splats[0].normal = {0, scanned_from, 0};
      const RenderedView image = render(scene, view({0, 3 * side, 0.1}, {0, 0, 0}, 64, 64));
      std::size_t splat = 0, contour = 0;
      for (std::size_t i = 0; i < image.id.size(); ++i) {
        if (image.id[i] != 0x80000000u && image.id[i] != 0x20000000u) continue;
        ++(image.id[i] == 0x80000000u ? splat : contour);
        EXPECT_EQ(image.coverage[i], side < 0 ? 1u : 0u) << side << " " << scanned_from;
        EXPECT_EQ(image.normal.pixels[3 * i + 1], static_cast<float>(side));  // towards the viewer
      }
      EXPECT_GT(splat, 20u);
      EXPECT_GT(contour, 20u);
    }
}

TEST(Render, plain_views_colour_scans_apart_and_camera_markers_can_be_shown) {
  RenderScene scene = room().scene;
  scene.splats = {{{2, 0.5, 1.5}, 0.1f, {0, -1, 0}, 0}, {{2.5, 0.5, 1.5}, 0.1f, {0, 0, 0}, 1}};
  ViewRequest request = view({2.2, 4.5, 1.6}, {2.2, 0.3, 1.5}, 160, 120);
  request.texture = false;
  request.cameras = true;
  const RenderedView image = render(scene, request);
  const auto colour_of = [&](std::uint32_t id) {
    const auto at = std::find(image.id.begin(), image.id.end(), id) - image.id.begin();
    EXPECT_LT(static_cast<std::size_t>(at), image.id.size()) << id;
    return std::array<float, 2>{image.colour.pixels[static_cast<std::size_t>(3 * at)],
                                image.colour.pixels[static_cast<std::size_t>(3 * at + 2)]};
  };
  EXPECT_NE(colour_of(0x80000000u), colour_of(0x80000001u));
  const auto marker = colour_of(0x40000000u);  // of photo-0, before us
  EXPECT_GT(marker[0], 3 * marker[1]);         // orange
  request.cameras = false;
  const RenderedView without = render(scene, request);
  EXPECT_EQ(std::count(without.id.begin(), without.id.end(), 0x40000000u), 0);
}

TEST(Render, wrong_requests_name_what_is_wrong) {
  const auto message = [](const auto& body) -> std::string {
    try {
      body();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "";
  };
  Renderer renderer(queue(), room().scene);
  ViewRequest request = view({1, 1, 1}, {2, 2, 1}, 4, 4);
  request.leave_out = {"nobody.jpg"};
  EXPECT_NE(message([&] { renderer.render(request); }).find("nobody.jpg"), std::string::npos);
  request.leave_out.clear();
  request.show = "all";
  EXPECT_NE(message([&] { renderer.render(request); }).find("\"all\""), std::string::npos);
  RenderScene broken = room().scene;
  broken.photograph_pixels[1] = Image8(3, 2, 3);
  EXPECT_NE(message([&] { Renderer(queue(), broken); }).find("photo-1"), std::string::npos);
  broken.photograph_pixels.pop_back();
  EXPECT_NE(message([&] { Renderer(queue(), broken); }).find("4 photographs"), std::string::npos);
}

}  // namespace hybrid::testing::render_test
