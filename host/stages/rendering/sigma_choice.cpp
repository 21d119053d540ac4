#include "stages/rendering/sigma_choice.hpp"

#include <algorithm>

namespace hybrid::stages {
namespace {

constexpr double kCandidates_px[] = {1, 2, 4, 8, 16};
constexpr double kWidest_px = 64;
constexpr std::size_t kMostLeftOut = 8;
constexpr int kMostSide_px = 512;  // of a photograph's middle

// The middle of a photograph, at most half as wide and high.
struct Middle {
  ViewRequest request;
  Image8 pixels;
  std::vector<std::uint8_t> part;  // 0: masked
};

Middle middle_of(const RenderScene& scene, std::size_t index) {
  Middle middle;
  const auto image = photograph_image(scene, index);
  middle.request.camera = scene.photographs[index];
  middle.request.leave_out = {middle.request.camera.name};
  Camera& camera = middle.request.camera.camera;
  const int width = std::clamp(camera.width / 2, 1, kMostSide_px),
            height = std::clamp(camera.height / 2, 1, kMostSide_px);
  const int left = (camera.width - width) / 2, top = (camera.height - height) / 2;
  camera.cx -= left, camera.cy -= top;
  camera.width = width, camera.height = height;
  middle.pixels = Image8(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* from = image->at(left + x, top + y);
      std::copy_n(from, 3, middle.pixels.at(x, y));
      middle.part.push_back(image->channels < 4 || from[3] != 0);
    }
  return middle;
}

std::vector<Middle> left_out(const RenderScene& scene) {
  std::vector<std::size_t> flat;  // a part of a panorama is no panorama
  for (std::size_t i = 0; i < scene.photographs.size(); ++i)
    if (!scene.photographs[i].camera.panorama()) flat.push_back(i);
  const std::size_t count = std::min(flat.size(), kMostLeftOut);
  std::vector<Middle> middles;
  for (std::size_t k = 0; k < count; ++k) middles.push_back(middle_of(scene, flat[k * flat.size() / count]));
  return middles;
}

// Mean over the photographs that others see; nothing where there is none. Which pixels are seen does not
// depend on sigma.
std::optional<double> mean_psnr_db(Renderer& renderer, const std::vector<Middle>& middles) {
  double sum = 0;
  int count = 0;
  for (const Middle& middle : middles) {
    const RenderedView view = renderer.render(middle.request);
    std::vector<std::uint8_t> mask = middle.part;
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = mask[i] && view.coverage[i] > 0;
    const ImageQuality quality = compare_images(view.colour, middle.pixels, mask);
    if (quality.share_seen <= 0) continue;
    sum += quality.psnr_db;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace

SigmaChoice choose_sigma(Renderer& renderer, RenderState& state) {
  SigmaChoice choice{state.options.sigma_px, {}};
  const std::vector<Middle> middles = left_out(state.scene);
  double best_db = 0;
  for (const double sigma_px : kCandidates_px) {
    state.use_sigma(sigma_px);
    if (band_sigmas(state.options).back() > kWidest_px) break;
    const auto psnr_db = mean_psnr_db(renderer, middles);
    if (!psnr_db) break;
    if (choice.tried.empty() || *psnr_db > best_db) choice.sigma_px = sigma_px, best_db = *psnr_db;
    choice.tried.push_back({sigma_px, *psnr_db});
  }
  return choice;
}

}  // namespace hybrid::stages
