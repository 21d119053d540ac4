#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "geometry/image.hpp"

namespace hybrid::report {

// The picture made smaller by the least whole factor that brings it to `largest_width`: each pixel is the
// mean light of a block (sRGB in and out). As it is when it is no wider.
Image8 shrink(const Image8& picture, int largest_width);

// What a page shows of the pictures of a folder DIR: DIR/report/pictures/<picture>.jpg, at most 1200 pixels
// wide, so that a page with hundreds of pictures opens on a phone and report/ can be sent alone. They are
// made while the page is written, begun in their order on all threads, as many at a time as pictures of 64
// megapixels together allow.
class Previews {
 public:
  explicit Previews(std::filesystem::path out);
  ~Previews();  // waits for what has begun

  const std::filesystem::path& out() const;
  // Begins the preview of DIR/<picture>. Returns its path in report/, or nothing when there is no such
  // picture (its stage was not run, or failed).
  std::string of(const std::string& picture);
  // Waits for all. Throws what the first that failed threw; none begins after that.
  void finish();

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace hybrid::report
