#include "batch/photographs/kept_photographs.hpp"

#include <exception>

#include "core/parallel.hpp"
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

std::span<const char> bytes_of(const Image8& image) {
  return {reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size()};
}

std::uint64_t decoded_bytes(const KeptPhotographs::File& file) {
  return 3 * static_cast<std::uint64_t>(file.width) * static_cast<std::uint64_t>(file.height);
}

}  // namespace

KeptPhotographs::KeptPhotographs(std::size_t budget_bytes, std::uint64_t all_bytes)
    : budget_bytes_(budget_bytes),
      scratch_(all_bytes > budget_bytes ? ScratchFile::make(all_bytes) : nullptr) {}

void KeptPhotographs::add(const std::vector<File>& files, const Lost& lost) {
  for (std::size_t first = 0, last = 0; first < files.size(); first = last) {
    for (std::uint64_t bytes = 0; last < files.size(); ++last) {
      bytes += decoded_bytes(files[last]);
      if (last > first && bytes > budget_bytes_ / 2) break;
    }
    std::vector<Image8> images(last - first);
    std::vector<std::exception_ptr> errors(last - first);
    parallel_for(last - first, [&](std::size_t i) {
      const File& file = files[first + i];
      try {
        images[i] = io::read_photograph(file.path, file.width, file.height);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    });
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (!errors[i]) {
        keep(files[first + i].path, std::move(images[i]));
        continue;
      }
      try {
        std::rethrow_exception(errors[i]);
      } catch (const Error& error) {
        if (!lost || error.kind() != ErrorKind::input) throw;
        lost(first + i, error);
      }
    }
  }
}

void KeptPhotographs::keep(const std::filesystem::path& file, Image8 pixels) {
  auto image = std::make_shared<Image8>(std::move(pixels));
  Kept kept{file, without_pixels(*image), {}, {}};
  if (kept_bytes_ + image->pixels.size() <= budget_bytes_) {
    kept_bytes_ += image->pixels.size();
    kept.pixels = std::move(image);
  } else if (scratch_ && scratch_->write(scratch_bytes_, bytes_of(*image))) {
    kept.on_disk = scratch_bytes_;
    scratch_bytes_ += image->pixels.size();
  }
  photographs_.push_back(std::move(kept));
}

void KeptPhotographs::add(Image8 image) {
  kept_bytes_ += image.pixels.size();
  Kept kept{{}, without_pixels(image), {}, {}};
  kept.pixels = std::make_shared<const Image8>(std::move(image));
  photographs_.push_back(std::move(kept));
}

std::shared_ptr<const Image8> KeptPhotographs::get(std::size_t index) const {
  const Kept& kept = photographs_[index];
  if (kept.pixels) return kept.pixels;
  if (kept.on_disk) {
    auto image = std::make_shared<Image8>(kept.size.width, kept.size.height, kept.size.channels);
    const std::span<char> bytes(reinterpret_cast<char*>(image->pixels.data()), image->pixels.size());
    if (scratch_->read(*kept.on_disk, bytes)) return image;
  }
  return std::make_shared<const Image8>(io::read_photograph(kept.file, kept.size.width, kept.size.height));
}

}  // namespace hybrid::batch
