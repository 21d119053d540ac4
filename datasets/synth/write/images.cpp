#include "write/images.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>

#include "write/files.hpp"

namespace synth {

std::string encoded(const std::string& extension, const Picture8& picture) {
  const std::string name = "picture" + extension;
  // Encoded in memory: the libraries do not tell when a file's last bytes find no room on the disk.
  OIIO::Filesystem::IOVecOutput bytes;
  auto file = OIIO::ImageOutput::create(name, &bytes);
  if (!file) throw std::runtime_error("OpenImageIO cannot write this format: " + OIIO::geterror());
  OIIO::ImageSpec spec(picture.width_px, picture.height_px, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (extension == ".jpg") {
    spec.attribute("Compression", "jpeg:95");
    spec.attribute("jpeg:subsampling", "4:4:4");
  }
  if (!file->open(name, spec) || !file->write_image(OIIO::TypeDesc::UINT8, picture.rgb.data()) ||
      !file->close())
    throw std::runtime_error(file->geterror());
  return {bytes.buffer().begin(), bytes.buffer().end()};
}

void write_jpeg_or_png(const std::filesystem::path& path, const Picture8& picture) {
  write_bytes(path, encoded(path.extension().string(), picture));
}

}  // namespace synth
