#include "io/exr/exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfStringAttribute.h>

#include <set>

#include "core/error.hpp"
#include "io/exr/exr_stream.hpp"
#include "io/exr/exr_tile_writer.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {

constexpr unsigned kTile_px = 64;

void check(const std::filesystem::path& file, int width, int height,
           const std::vector<ExrChannel>& channels) {
  if (width < 1 || height < 1)
    fail(ErrorKind::failed, "{}: expected an image of at least 1 x 1, found {} x {}", file.string(), width,
         height);
  if (channels.empty())
    fail(ErrorKind::failed, "{}: expected at least one channel, found none", file.string());
  std::set<std::string> names;
  for (const ExrChannel& channel : channels) {
    if ((channel.f == nullptr) == (channel.u == nullptr))
      fail(ErrorKind::failed, "{}: channel {}: expected float or uint values, found both or neither",
           file.string(), channel.name);
    if (!names.insert(channel.name).second)
      fail(ErrorKind::failed, "{}: expected channel {} once, found it again", file.string(), channel.name);
  }
}

}  // namespace

void write_exr(const std::filesystem::path& file, int width, int height,
               const std::vector<ExrChannel>& channels,
               const std::map<std::string, std::string>& attributes) {
  check(file, width, height, channels);
  Imf::Header header(width, height);
  for (const auto& [name, text] : attributes) header.insert("hybrid:" + name, Imf::StringAttribute(text));
  header.setTileDescription(Imf::TileDescription(kTile_px, kTile_px));
  Imf::FrameBuffer buffer;
  ExrPart all{"", Imf::ZIP_COMPRESSION, {}};
  for (const ExrChannel& channel : channels) {
    const Imf::PixelType type = channel.f ? Imf::FLOAT : Imf::UINT;
    const void* values = channel.f ? static_cast<const void*>(channel.f) : channel.u;
    const std::size_t step = 4 * static_cast<std::size_t>(channel.stride);
    all.channels.push_back(channel.name);
    header.channels().insert(channel.name, Imf::Channel(type));
    // OpenEXR's slices are not const; writing only reads them.
    buffer.insert(channel.name, Imf::Slice(type, static_cast<char*>(const_cast<void*>(values)), step,
                                           step * static_cast<std::size_t>(width)));
  }
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    write_exr_stream(temporary, [&](ExrStream& stream) {
      ExrTileWriter out(stream, header, {all});
      out.write(buffer, 0, height);
      out.finish();
    });
  });
}

}  // namespace hybrid::io
