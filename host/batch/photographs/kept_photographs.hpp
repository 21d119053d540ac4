#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/error.hpp"
#include "core/scratch_file.hpp"
#include "geometry/image.hpp"

namespace hybrid::batch {

// The pixels of a scene's photographs. Every file is decoded once when it is added, so that what is wrong
// with it is said at the start; as many as the budget holds stay in memory, the others on disk, in a file
// without a name (core/scratch_file.hpp), and where that has no room they are decoded again whenever they are
// asked for.
class KeptPhotographs {
 public:
  // `all_bytes`: what all of them will take, decoded.
  explicit KeptPhotographs(std::size_t budget_bytes = std::size_t{1} << 30, std::uint64_t all_bytes = 0);
  struct File {
    std::filesystem::path path;
    int width, height;  // as the camera model says
  };
  // Decoded side by side as far as half the budget holds them. What io::read_photograph throws of an input
  // goes to `lost` with the file's index, in order, and the file is left out; without `lost` the first of
  // them is thrown.
  using Lost = std::function<void(std::size_t, const Error&)>;
  void add(const std::vector<File>& files, const Lost& lost = {});
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
    std::shared_ptr<const Image8> pixels;  // null: elsewhere
    std::optional<std::uint64_t> on_disk;  // where in the scratch file; none: decoded when asked for
  };
  void keep(const std::filesystem::path& file, Image8 image);

  std::size_t budget_bytes_, kept_bytes_ = 0;
  std::unique_ptr<ScratchFile> scratch_;
  std::uint64_t scratch_bytes_ = 0;
  std::vector<Kept> photographs_;
};

}  // namespace hybrid::batch
