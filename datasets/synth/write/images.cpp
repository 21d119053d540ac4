#include "write/images.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <OpenImageIO/imageio.h>

#include <limits>
#include <stdexcept>

#include "write/files.hpp"

namespace synth {

void write_jpeg_or_png(const std::filesystem::path& path, const Picture8& picture) {
  write_by_rename(path, [&](const std::filesystem::path& temporary) {
    auto file = OIIO::ImageOutput::create(temporary.string());
    if (!file) throw std::runtime_error("OpenImageIO cannot write this format: " + OIIO::geterror());
    OIIO::ImageSpec spec(picture.width_px, picture.height_px, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (path.extension() == ".jpg") {
      spec.attribute("Compression", "jpeg:95");
      spec.attribute("jpeg:subsampling", "4:4:4");
    }
    if (!file->open(temporary.string(), spec) ||
        !file->write_image(OIIO::TypeDesc::UINT8, picture.rgb.data()) || !file->close())
      throw std::runtime_error(file->geterror());
  });
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
  write_by_rename(path, [&](const std::filesystem::path& temporary) {
    Imf::OutputFile file(temporary.c_str(), header);
    file.setFrameBuffer(pixels);
    file.writePixels(static_cast<int>(height));
  });
}

}  // namespace synth
