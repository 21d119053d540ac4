#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "geometry/image.hpp"

namespace hybrid::batch {

// The pixels of a scene's photographs. Every file is decoded once when it is added, so that what is wrong
// with it is said at the start; as many as the budget holds stay in memory, the others are decoded again
// whenever they are asked for.
class KeptPhotographs {
 public:
  explicit KeptPhotographs(std::size_t budget_bytes = std::size_t{1} << 30) : budget_bytes_(budget_bytes) {}
  // Throws as io::read_photograph does.
  void add(const std::filesystem::path& file, int width, int height);
  // Pixels that no file gives again stay, whatever the budget.
  void add(Image8 image);

  std::size_t count() const { return photographs_.size(); }
  // Its extent and channels, without pixels.
  const Image8& size(std::size_t index) const { return photographs_[index].size; }
  std::shared_ptr<const Image8> get(std::size_t index) const;

 private:
  struct Kept {
    std::filesystem::path file;
    Image8 size;
    std::shared_ptr<const Image8> pixels;  // null: decoded when asked for
  };
  std::size_t budget_bytes_, kept_bytes_ = 0;
  std::vector<Kept> photographs_;
};

}  // namespace hybrid::batch
