#include "io/truth.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {

// The first `count` values of a uint channel, in rows from the top.
std::vector<std::uint32_t> read_uint_channel(const std::filesystem::path& file, const char* channel,
                                             std::size_t count) {
  check_readable(file);
  return with_context(file.string(), [&] {
    Imf::InputFile input(file.c_str());
    const auto* found = input.header().channels().findChannel(channel);
    if (!found || found->type != Imf::UINT) fail_input("expected a uint channel named {}", channel);
    const auto window = input.header().dataWindow();
    const std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    const std::size_t height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
    if (width * height < count) fail_input("expected {} values, found {} x {} pixels", count, width, height);
    std::vector<std::uint32_t> values(width * height);
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice::Make(Imf::UINT, values.data(), window, sizeof(std::uint32_t),
                                            sizeof(std::uint32_t) * width));
    input.setFrameBuffer(buffer);
    input.readPixels(window.min.y, window.max.y);
    values.resize(count);
    return values;
  });
}

}  // namespace

SceneTruth read_truth(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  return with_context(file.string(), [&] {
    SceneTruth truth;
    try {
      const auto document = nlohmann::json::parse(text);
      for (const auto& entry : document.at("scans")) {
        ScanTruth scan;
        scan.id = entry.at("id").get<std::string>();
        scan.world_from_scan = pose_from_row_major(entry.at("world_from_scan").get<std::array<double, 16>>());
        const auto samples = entry.at("samples").get<std::size_t>();
        const auto image = file.parent_path() / entry.at("truth_image").get<std::string>();
        scan.plane = read_uint_channel(image, "plane", samples);
        scan.kind = read_uint_channel(image, "kind", samples);
        truth.scans.push_back(std::move(scan));
      }
    } catch (const nlohmann::json::exception& error) {
      fail_input("not the truth of a synthetic scene ({}); make it again with hybrid-synth", error.what());
    }
    return truth;
  });
}

}  // namespace hybrid::io
