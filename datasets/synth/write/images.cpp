#include "write/images.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <limits>
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

void write_truth_exr(const std::filesystem::path& path, const Scan& scan) {
  constexpr std::size_t width = 1024;
  const std::size_t height = std::max<std::size_t>(1, (scan.samples.size() + width - 1) / width);
  std::vector<std::uint32_t> plane(width * height, 0), kind(width * height, 0);
  std::vector<float> range(width * height, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < scan.samples.size(); ++i) {
    plane[i] = scan.samples[i].plane_id;
    kind[i] = static_cast<std::uint32_t>(scan.samples[i].kind);
    range[i] = scan.samples[i].true_range_m;
  }
  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer pixels;
  const auto channel = [&](const char* name, Imf::PixelType type, void* data) {
    header.channels().insert(name, Imf::Channel(type));
    pixels.insert(name, Imf::Slice(type, static_cast<char*>(data), 4, 4 * width));
  };
  channel("plane", Imf::UINT, plane.data());
  channel("range", Imf::FLOAT, range.data());
  channel("kind", Imf::UINT, kind.data());
  Imf::StdOSStream encoded;
  {
    Imf::OutputFile file(encoded, header);
    file.setFrameBuffer(pixels);
    file.writePixels(static_cast<int>(height));
  }  // which writes the table of its lines
  write_bytes(path, encoded.str());
}

}  // namespace synth
