#pragma once
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "io/e57/e57.hpp"

namespace hybrid::io {

// One of a file's images (images2D) as a photograph with a camera.
struct E57Photograph {
  Photograph photograph;            // its world is the file's own frame, in which the scans' poses are, too
  std::size_t image = 0;            // index in E57Contents::images
  std::optional<std::size_t> scan;  // index of the scan it was taken with (associatedData3DGuid)
};

struct E57Photographs {
  std::vector<E57Photograph> photographs;  // in file order; names are file names, each occurs once
  std::vector<std::string> notes;          // which images are none, and why; what was assumed
};

// The pinhole, spherical and cylindrical images of a file. ASTM E2807's image frames: a pinhole image looks
// along -z with y up, a panorama's centre column lies on +x with z up. Visual references have no camera.
// Images whose numbers make no camera are left out with a note.
E57Photographs e57_photographs(const E57Contents& contents);

// Decodes a photograph; with a mask 4 channels, alpha 0 where it is none. Throws ErrorKind::input naming
// file, image and byte: blobs outside the file, pictures that do not decode or have another size than said.
// In salvage damaged pages are noted.
Image8 read_e57_photograph(const E57File& file, const E57Photograph& photograph,
                           std::vector<std::string>& notes);

// An image's place for messages: "scans/a.e57: image 3 (west)".
std::string place_of(const E57File& file, std::size_t image);

// A name that can be a file's: slashes and control characters become _, at most 100 bytes, never empty.
std::string safe_name(const std::string& name, const std::string& fallback);

}  // namespace hybrid::io
