#include "pictures/functions.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "core/error.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"

namespace hybrid::pictures {
using namespace io;
namespace fs = std::filesystem;
namespace {

// Encoded in memory: OpenImageIO does not look whether the last bytes of a file reached the disk.
void write_encoded(const fs::path& file, const char* format, const OIIO::ImageSpec& spec,
                   const void* pixels) {
  OIIO::Filesystem::IOVecOutput encoded;
  const auto output = OIIO::ImageOutput::create(format, &encoded);
  if (!output || !output->open(std::string("memory.") + format, spec) ||
      !output->write_image(spec.format, pixels) || !output->close())
    fail(ErrorKind::failed, "{}: cannot encode: {}", file.string(),
         output ? output->geterror() : OIIO::geterror());
  write_atomically(file, [&](const fs::path& temporary) {
    OutputFile out(temporary);
    out.write(encoded.buffer().data(), encoded.buffer().size());
    out.close();
  });
}

// The library would write the time of day.
constexpr const char* kNoDate = "1970:01:01 00:00:00";

OIIO::ImageSpec picture_spec(const fs::path& file, const Image8& image, bool grey_too) {
  if (image.width < 1 || image.height < 1 || (image.channels != 3 && !(grey_too && image.channels == 1)))
    fail(ErrorKind::failed, "{}: expected a picture of {}3 channels, found {} x {} with {}", file.string(),
         grey_too ? "1 or " : "", image.width, image.height, image.channels);
  OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeUInt8);
  spec["oiio:ColorSpace"] = "sRGB";
  return spec;
}

}  // namespace

void write_jpeg(const fs::path& file, const Image8& image, int quality) {
  OIIO::ImageSpec spec = picture_spec(file, image, true);
  spec["Compression"] = fmt::format("jpeg:{}", quality);
  write_encoded(file, "jpg", spec, image.pixels.data());
}

void write_best_jpeg(const fs::path& file, const Image8& image) {
  OIIO::ImageSpec spec = picture_spec(file, image, false);
  spec["Compression"] = "jpeg:95";
  spec["jpeg:subsampling"] = "4:4:4";
  write_encoded(file, "jpg", spec, image.pixels.data());
}

void write_tiff(const fs::path& file, const Image8& image) {
  OIIO::ImageSpec spec = picture_spec(file, image, false);
  spec["compression"] = "zip";
  spec["DateTime"] = kNoDate;
  write_encoded(file, "tif", spec, image.pixels.data());
}

void write_values_tiff(const fs::path& file, int width, int height, const std::vector<float>& values) {
  OIIO::ImageSpec spec(width, height, 1, OIIO::TypeFloat);
  spec["compression"] = "zip";
  spec["DateTime"] = kNoDate;
  write_encoded(file, "tif", spec, values.data());
}

}  // namespace hybrid::pictures
