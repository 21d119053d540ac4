#include "stages/rendering/photograph_store.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "shared/params_blur_photo.h"
#include "stages/rendering/blend_bands.hpp"
#include "stages/rendering/photograph_levels.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::stages {
namespace {

// A surface as steep as this against the viewing ray (72 degrees) is still followed across neighbouring
// pixels.
constexpr float kSteepestSlope = 3;

void check(const RenderScene& scene) {
  if (scene.photographs.size() != scene.photograph_pixels.size())
    fail_input("render: expected an image per photograph, found {} photographs and {} images",
               scene.photographs.size(), scene.photograph_pixels.size());
  for (std::size_t i = 0; i < scene.photographs.size(); ++i) {
    const Camera& camera = scene.photographs[i].camera;
    const Image8& image = scene.photograph_pixels[i];
    if (image.width != camera.width || image.height != camera.height || image.width < 1 || image.height < 1)
      fail_input(
          "photograph {}: its camera says {} x {} pixels, its image has {} x {}; use the image the camera "
          "was "
          "calibrated on, at full size",
          scene.photographs[i].name, camera.width, camera.height, image.width, image.height);
    if (image.channels != 3 && image.channels != 4)
      fail_input("photograph {}: expected 3 or 4 channels, found {}; convert it to RGB",
                 scene.photographs[i].name, image.channels);
  }
}

std::vector<std::uint8_t> rgba(const Image8& image) {
  const auto width = static_cast<std::size_t>(image.width),
             channels = static_cast<std::size_t>(image.channels);
  std::vector<std::uint8_t> out(4 * width * static_cast<std::size_t>(image.height));
  parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      for (std::size_t k = 0; k < 3; ++k) out[4 * i + k] = image.pixels[channels * i + k];
      out[4 * i + 3] = channels == 4 && image.pixels[4 * i + 3] == 0 ? 0 : 255;
    }
  });
  return out;
}

bool has_mask(const Image8& image) {
  if (image.channels != 4) return false;
  for (std::size_t i = 3; i < image.pixels.size(); i += 4)
    if (image.pixels[i] == 0) return true;
  return false;
}

std::vector<float> linear_table(const std::array<double, 3>& gains) {
  std::vector<float> table;
  for (const double gain : gains)
    for (const double light : linear_of_bytes<double>()) table.push_back(static_cast<float>(gain * light));
  return table;
}

}  // namespace

std::shared_ptr<const Image8> photograph_image(const RenderScene& scene, std::size_t index) {
  const Image8& image = scene.photograph_pixels[index];
  if (!image.pixels.empty() || !scene.decode) return {std::shared_ptr<const Image8>(), &image};
  return scene.decode(index);
}

std::vector<float> gaussian_weights(double sigma_px) {
  const int radius = static_cast<int>(std::ceil(3 * sigma_px));
  std::vector<float> weights;
  for (int i = 0; i <= radius; ++i)
    weights.push_back(i == 0 ? 1.0f : static_cast<float>(std::exp(-0.5 * i * i / (sigma_px * sigma_px))));
  return weights;
}

PhotographStore::PhotographStore(device::Queue& queue, const RenderScene& scene, const RenderOptions& options,
                                 const Vec3& origin, bool low_bands, std::optional<std::size_t> budget_bytes)
    : queue_(queue),
      scene_(scene),
      options_(options),
      origin_(origin),
      sigmas_(low_bands ? band_sigmas(options) : std::vector<double>()),
      budget_bytes_(budget_bytes.value_or(
          std::min<std::size_t>(queue.device().global_memory_bytes / 2,
                                (std::size_t{1} << 20) * static_cast<std::size_t>(options.photograph_mb)))),
      levels_(scene.photographs.size(), 0) {
  check(scene);
  set_gains(std::vector<std::array<double, 3>>(scene.photographs.size(), {1, 1, 1}));
  resident_.resize(scene.photographs.size());
  for (const Image8& image : scene.photograph_pixels) masked_.push_back(has_mask(image));
}

void PhotographStore::set_gains(const std::vector<std::array<double, 3>>& gains) {
  linear_.clear();
  for (const auto& gain : gains) linear_.push_back(queue_.array(linear_table(gain)));
}

Photograph PhotographStore::halved(std::size_t index) const {
  Photograph photograph = scene_.photographs[index];
  photograph.camera = half_camera(photograph.camera, levels_[index]);
  return photograph;
}

std::size_t PhotographStore::bytes(std::size_t index) const {
  const Camera camera = halved(index).camera;
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height) *
         (4 + 8 * sigmas_.size());
}

void PhotographStore::use_levels(std::vector<int> levels) {
  levels.resize(scene_.photographs.size(), 0);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (levels[i] == levels_[i]) continue;
    if (resident_[i]) resident_bytes_ -= bytes(i);
    resident_[i].reset();
    if (visitor_ == i) visiting_.reset();
  }
  levels_ = std::move(levels);
}

void PhotographStore::use_sigmas(std::vector<double> sigmas) {
  for (auto& entry : resident_) entry.reset();
  visiting_.reset();
  resident_bytes_ = 0;
  sigmas_ = std::move(sigmas);
}

CameraRecord PhotographStore::camera(std::size_t index) const {
  CameraRecord record = camera_record(scene_.photographs[index], origin_);
  if (masked_[index]) record.flags |= CAMERA_HAS_MASK;
  return record;
}

float PhotographStore::pixel_rad(std::size_t index) const {
  return pixel_angle_rad(scene_.photographs[index].camera);
}

const PhotographStore::Entry& PhotographStore::get(std::size_t index, const DeviceBvh& everything) {
  if (resident_[index]) return *resident_[index];
  if (resident_bytes_ + bytes(index) <= budget_bytes_) {
    resident_bytes_ += bytes(index);
    resident_[index] = load(index, everything);
    return *resident_[index];
  }
  if (visiting_ && visitor_ == index) return *visiting_;
  visiting_.reset();  // before its successor needs the memory
  visiting_ = load(index, everything);
  visitor_ = index;
  return *visiting_;
}

PhotographStore::Entry PhotographStore::load(std::size_t index, const DeviceBvh& everything) {
  auto image = photograph_image(scene_, index);
  for (int level = 0; level < levels_[index]; ++level)
    image = std::make_shared<const Image8>(half_size(*image));
  CameraRecord record = camera_record(halved(index), origin_);
  if (masked_[index]) record.flags |= CAMERA_HAS_MASK;
  Entry entry{record, queue_.array(rgba(*image)), std::ldexp(1.0f, -levels_[index]),
              queue_.array<std::uint16_t>(0)};
  image.reset();
  if (!sigmas_.empty()) blur(entry, index, everything);
  return entry;
}

void PhotographStore::blur(Entry& entry, std::size_t index, const DeviceBvh& everything) {
  const std::size_t width = entry.camera.width, height = entry.camera.height;
  const DistanceMap map = cast_distances(queue_, everything, entry.camera, options_.surface_tolerance_m);
  const auto rows = queue_.array<std::uint16_t>(4 * width * height);
  entry.low = queue_.array<std::uint16_t>(4 * width * height * sigmas_.size());
  const auto& kernel = queue_.kernel(
      "blur_photo",
      {{"BLUR_FLAGS", static_cast<int>(entry.camera.flags & (CAMERA_WRAPS | CAMERA_HAS_MASK))}});
  for (std::size_t band = 0; band < sigmas_.size(); ++band) {
    const std::vector<float> gaussian = gaussian_weights(sigmas_[band]);
    const auto weights = queue_.array(gaussian);
    BlurPhotoParams params{};
    params.width = entry.camera.width;
    params.height = entry.camera.height;
    params.radius = static_cast<std::uint32_t>(gaussian.size() - 1);
    params.tolerance_m = static_cast<float>(options_.surface_tolerance_m);
    params.slope = kSteepestSlope;
    params.pixel_rad = pixel_rad(index) / entry.pixel_scale;
    queue_.launch("blur_photo", kernel, device::grid(width, height), params, entry.pixels, entry.low,
                  linear_[index], weights, map.distance, map.id, rows);
    params.vertical = 1;
    params.first = static_cast<std::uint32_t>(band * width * height);
    queue_.launch("blur_photo", kernel, device::grid(width, height), params, entry.pixels, rows,
                  linear_[index], weights, map.distance, map.id, entry.low);
    queue_.finish();  // the arrays of this scope are in use until then
  }
}

}  // namespace hybrid::stages
