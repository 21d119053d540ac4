#include "cases/blur_photo_case.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/colour.hpp"
#include "geometry/vectors.hpp"
#include "stages/rendering/photograph_store.hpp"

namespace hybrid::testing {
namespace {

constexpr double kGains[3] = {1, 0.8, 1.25};  // of the channels

}  // namespace

BlurPhotoCase::Input BlurPhotoCase::make(std::size_t size, std::uint32_t seed, double sigma_px) {
  Input input;
  input.sigma_px = sigma_px;
  input.width = static_cast<std::uint32_t>(size > 128 ? std::sqrt(static_cast<double>(size)) : size);
  input.height = input.width ? static_cast<std::uint32_t>(size) / input.width : 0;
  for (const double gain : kGains)
    for (int i = 0; i < 256; ++i)
      input.linear.push_back(static_cast<float>(gain * linear_from_srgb(i / 255.0)));
  input.weights = stages::gaussian_weights(sigma_px);
  std::mt19937 random(seed);
  for (std::uint32_t y = 0; y < input.height; ++y)
    for (std::uint32_t x = 0; x < input.width; ++x) {
      for (int k = 0; k < 4; ++k) input.pixels.push_back(static_cast<std::uint8_t>(random() % 256));
      // Strips: sky, a steep face of one id, and rough samples of an id each on steps 3 cm apart.
      const std::uint32_t strip = (x / 17 + y / 23) % 3;
      const auto i = static_cast<std::uint32_t>(input.id.size());
      input.id.push_back(strip == 0 ? 0 : strip == 1 ? 5 : 0x80000000u + i);
      const float rough = static_cast<float>(random() % 100) * 1e-4f;
      input.distance.push_back(strip == 0   ? INFINITY
                               : strip == 1 ? 2 + 0.5f * static_cast<float>(x)
                                            : 3 + 0.03f * static_cast<float>(x / 5 % 7) + rough);
    }
  return input;
}

BlurPhotoCase::Output BlurPhotoCase::reference(const Input& input) {
  const int width = static_cast<int>(input.width), height = static_cast<int>(input.height);
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * input.width + static_cast<std::size_t>(x);
  };
  using Light = Eigen::Vector4d;  // the fourth is how much of the others there is
  std::vector<Light> image;
  for (std::size_t i = 0; i < input.count(); ++i) {
    const std::uint8_t* p = input.pixels.data() + 4 * i;
    const bool masked = (input.flags & CAMERA_HAS_MASK) && p[3] == 0;
    image.emplace_back(kGains[0] * linear_from_srgb(p[0] / 255.0), kGains[1] * linear_from_srgb(p[1] / 255.0),
                       kGains[2] * linear_from_srgb(p[2] / 255.0), 1);
    if (masked) image.back().setZero();
  }
  const int radius = static_cast<int>(input.weights.size()) - 1;
  for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1)}) {
    std::vector<Light> next(image.size());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        Light sum = Light::Zero();
        for (const int side : {-1, 1})
          for (int k = 0; k <= radius; ++k) {
            const auto at = [&](int apart) {
              int u = x + side * apart * dx;
              if (input.flags & CAMERA_WRAPS) u = (u + width) % width;
              return std::pair(u, y + side * apart * dy);
            };
            const auto [u, v] = at(k);
            if (k >= width && dx == 1) break;  // once around
            if (u < 0 || v < 0 || u >= width || v >= height) break;
            if (k > 0) {
              const auto [pu, pv] = at(k - 1);
              const double last = input.distance[index(pu, pv)];
              const double limit = input.tolerance_m + double{input.slope} * input.pixel_rad * last;
              const bool same = input.id[index(u, v)] == input.id[index(pu, pv)];
              if (!same && !(std::abs(input.distance[index(u, v)] - last) < limit)) break;
            } else if (side == 1) {
              continue;
            }
            const double w = std::exp(-0.5 * k * k / (input.sigma_px * input.sigma_px));
            sum += w * image[index(u, v)];
          }
        next[index(x, y)] = sum.w() > 0 ? Light(sum / sum.w()) : sum;
      }
    image = next;
  }
  Output out;
  for (const Light& light : image)
    for (int k = 0; k < 4; ++k) out.low.push_back(static_cast<float>(light[k]));
  return out;
}

}  // namespace hybrid::testing
