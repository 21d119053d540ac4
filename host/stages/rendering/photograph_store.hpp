#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "device/queue.hpp"
#include "shared/records.h"
#include "stages/rendering/bvh.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::stages {

// The photographs on the device, each in arrays of its own, loaded when first asked for. The first ones that
// fit the budget stay; the rest are loaded again each time.
class PhotographStore {
 public:
  struct Entry {
    CameraRecord camera;                 // relative to the local origin; of the level's pixels
    device::Array<std::uint8_t> pixels;  // RGBA, sRGB; alpha 0: no photograph
    float pixel_scale;                   // its pixels over the photograph's own: 2^-level
    device::Array<std::uint16_t> low;  // half x 4, linear light: an image per Gaussian of band_sigmas(), one
                                       // after the other; empty unless they were asked for
  };

  // `everything`: the geometry whose visibility edges the low band respects. Scene and geometry must outlive
  // the store. Throws ErrorKind::input when photographs and pixels do not match, naming the photograph. The
  // budget is options.photograph_mb, at most half of the device's memory, unless given.
  PhotographStore(device::Queue& queue, const RenderScene& scene, const RenderOptions& options,
                  const Vec3& origin, bool low_bands, std::optional<std::size_t> budget_bytes = {});

  // What is known of a photograph without loading it.
  CameraRecord camera(std::size_t index) const;  // relative to the local origin
  float pixel_rad(std::size_t index) const;
  bool masked(std::size_t index) const { return masked_[index]; }
  // How often each photograph is halved before it is loaded (photograph_levels); none: never. What is loaded
  // otherwise goes. Masked photographs and panoramas that do not halve evenly must have 0.
  void use_levels(std::vector<int> levels);
  // Other low bands from now on. What is loaded goes.
  void use_sigmas(std::vector<double> sigmas);
  // Kernels: ray_cast and blur_photo when low bands are wanted.
  const Entry& get(std::size_t index, const DeviceBvh& everything);
  // Linear light of each sRGB byte of each photograph, per channel (3 x 256), on the device.
  const std::vector<device::Array<float>>& linear() const { return linear_; }
  // Factors of every photograph's linear light, per channel; before the first get(). 1 until then.
  void set_gains(const std::vector<std::array<double, 3>>& gains);

 private:
  Entry load(std::size_t index, const DeviceBvh& everything);
  void blur(Entry& entry, std::size_t index, const DeviceBvh& everything);
  Photograph halved(std::size_t index) const;  // its camera at its level
  std::size_t bytes(std::size_t index) const;

  device::Queue& queue_;
  const RenderScene& scene_;
  RenderOptions options_;
  Vec3 origin_;
  std::vector<double> sigmas_;
  std::vector<device::Array<float>> linear_;
  std::vector<std::optional<Entry>> resident_;
  std::vector<bool> masked_;  // some of its pixels are none
  std::size_t budget_bytes_ = 0, resident_bytes_ = 0;
  std::optional<Entry> visiting_;
  std::size_t visitor_ = 0;
  std::vector<int> levels_;
};

// Weights of a Gaussian by distance in pixels, out to three sigma; {1} when sigma is 0.
std::vector<float> gaussian_weights(double sigma_px);

}  // namespace hybrid::stages
