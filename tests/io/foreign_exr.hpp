#pragma once
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <half.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hybrid::testing {

// A range image as another program would write it.
class ForeignExr {
 public:
  ForeignExr(int width, int height) : width_(width), height_(height) {}

  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  int tile = 0;  // 0: scan lines
  Imath::V2i corner{0, 0};

  // Some values between 1 and 3.
  void add(const std::string& name, Imf::PixelType type) {
    types_[name] = type;
    std::vector<float>& values = values_[name];
    for (int i = 0; i < width_ * height_; ++i)
      values.push_back(2 + static_cast<float>(std::sin(1.3 * i + double(name[0]))));
  }
  std::vector<float>& channel(const std::string& name) { return values_.at(name); }
  void attribute(const std::string& name, double value) {
    attributes_.insert(name, Imf::DoubleAttribute(value));
  }
  void attribute(const std::string& name, const std::string& value) {
    attributes_.insert(name, Imf::StringAttribute(value));
  }
  Imf::Header& attributes() { return attributes_; }  // for other types

  void write(const std::filesystem::path& file) const {
    Imf::Header header = attributes_;
    header.dataWindow() = {corner, corner + Imath::V2i(width_ - 1, height_ - 1)};
    header.displayWindow() = header.dataWindow();
    header.compression() = compression;
    Imf::FrameBuffer buffer;
    std::map<std::string, std::vector<char>> bytes;
    for (const auto& [name, type] : types_) {
      const std::size_t size = type == Imf::HALF ? 2 : 4;
      for (const float value : values_.at(name)) {
        const half small(value);
        const auto whole = static_cast<std::uint32_t>(type == Imf::UINT ? value : 0);
        const void* at = type == Imf::HALF   ? static_cast<const void*>(&small)
                         : type == Imf::UINT ? static_cast<const void*>(&whole)
                                             : &value;
        bytes[name].insert(bytes[name].end(), static_cast<const char*>(at),
                           static_cast<const char*>(at) + size);
      }
      header.channels().insert(name, Imf::Channel(type));
      buffer.insert(name, Imf::Slice::Make(type, bytes[name].data(), header.dataWindow(), size,
                                           size * static_cast<std::size_t>(width_)));
    }
    if (tile == 0) {
      Imf::OutputFile out(file.c_str(), header);
      out.setFrameBuffer(buffer);
      out.writePixels(height_);
    } else {
      header.setTileDescription(
          Imf::TileDescription(static_cast<unsigned>(tile), static_cast<unsigned>(tile)));
      Imf::TiledOutputFile out(file.c_str(), header);
      out.setFrameBuffer(buffer);
      out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
    }
  }

 private:
  int width_, height_;
  Imf::Header attributes_;
  std::map<std::string, Imf::PixelType> types_;
  std::map<std::string, std::vector<float>> values_;
};

}  // namespace hybrid::testing
