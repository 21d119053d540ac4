#include "exr_ids.hpp"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

namespace hybrid::e2e {

std::vector<std::uint32_t> ids_of(const std::filesystem::path& exr) {
  Imf::InputFile file(exr.c_str());
  const auto window = file.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  std::vector<std::uint32_t> ids(width * static_cast<std::size_t>(window.max.y - window.min.y + 1));
  Imf::FrameBuffer buffer;
  buffer.insert("id", Imf::Slice::Make(Imf::UINT, ids.data(), window, sizeof(std::uint32_t),
                                       width * sizeof(std::uint32_t)));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return ids;
}

}  // namespace hybrid::e2e
