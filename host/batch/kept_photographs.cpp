#include "batch/kept_photographs.hpp"

#include "io/picture.hpp"

namespace hybrid::batch {
namespace {

Image8 without_pixels(const Image8& image) {
  Image8 size;
  size.width = image.width;
  size.height = image.height;
  size.channels = image.channels;
  return size;
}

}  // namespace

void KeptPhotographs::add(const std::filesystem::path& file, int width, int height) {
  auto image = std::make_shared<Image8>(io::read_photograph(file, width, height));
  Kept kept{file, without_pixels(*image), {}};
  if (kept_bytes_ + image->pixels.size() <= budget_bytes_) {
    kept_bytes_ += image->pixels.size();
    kept.pixels = std::move(image);
  }
  photographs_.push_back(std::move(kept));
}

void KeptPhotographs::add(Image8 image) {
  kept_bytes_ += image.pixels.size();
  Kept kept{{}, without_pixels(image), {}};
  kept.pixels = std::make_shared<const Image8>(std::move(image));
  photographs_.push_back(std::move(kept));
}

std::shared_ptr<const Image8> KeptPhotographs::get(std::size_t index) const {
  const Kept& kept = photographs_[index];
  if (kept.pixels) return kept.pixels;
  return std::make_shared<const Image8>(io::read_photograph(kept.file, kept.size.width, kept.size.height));
}

}  // namespace hybrid::batch
