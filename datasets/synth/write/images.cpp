#include "write/images.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>

#include "write/files.hpp"

namespace synth {

void write_jpeg_or_png(const std::filesystem::path& path, const Picture8& picture) {
  // Encoded in memory: the libraries do not tell when a file's last bytes find no room on the disk.
  OIIO::Filesystem::IOVecOutput encoded;
  auto file = OIIO::ImageOutput::create(path.filename().string(), &encoded);
  if (!file) throw std::runtime_error("OpenImageIO cannot write this format: " + OIIO::geterror());
  OIIO::ImageSpec spec(picture.width_px, picture.height_px, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (path.extension() == ".jpg") {
    spec.attribute("Compression", "jpeg:95");
    spec.attribute("jpeg:subsampling", "4:4:4");
  }
  if (!file->open(path.filename().string(), spec) ||
      !file->write_image(OIIO::TypeDesc::UINT8, picture.rgb.data()) || !file->close())
    throw std::runtime_error(file->geterror());
  write_bytes(path, {encoded.buffer().begin(), encoded.buffer().end()});
}

}  // namespace synth
