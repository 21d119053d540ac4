#include "io/truth.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "io/exr/exr_errors.hpp"
#include "io/exr/exr_parts.hpp"
#include "io/exr/exr_threads.hpp"
#include "io/text/plain_text.hpp"

namespace hybrid::io {
namespace {

// The first `count` values of a uint channel, in rows from the top.
std::vector<std::uint32_t> read_uint_channel(const std::filesystem::path& file, const char* channel,
                                             std::size_t count) {
  std::vector<std::uint32_t> values;
  with_exr_errors(
      [&] {
        ExrParts input(file, start_exr_threads());
        const auto* found = input.header().channels().findChannel(channel);
        if (!found || found->type != Imf::UINT || found->xSampling != 1 || found->ySampling != 1)
          fail_input(
              "{}: header: expected a uint channel named {}, found none; make it again with hybrid-synth",
              file.string(), channel);
        const auto width = static_cast<std::size_t>(input.cols()),
                   height = static_cast<std::size_t>(input.rows());
        if (height != std::max<std::size_t>(1, (count + width - 1) / width))
          fail_input(
              "{}: header: expected {} samples in rows, found {} x {} pixels; make both again with "
              "hybrid-synth",
              file.string(), count, width, height);
        if (!input.complete())
          fail_input(
              "{}: tiles: expected all of them, found some missing; the file is cut short: copy it again",
              file.string());
        values.resize(width * height);
        Imf::FrameBuffer buffer;
        buffer.insert(channel, Imf::Slice::Make(Imf::UINT, values.data(), input.header().dataWindow(),
                                                sizeof(std::uint32_t), sizeof(std::uint32_t) * width));
        input.read(buffer, 0, input.rows());
      },
      [&](const char* what) {
        fail_input(
            "{}: tiles: expected an image as hybrid-synth writes it, found a damaged one ({}); copy it again",
            file.string(), what);
      });
  values.resize(count);
  return values;
}

}  // namespace

SceneTruth read_truth(const std::filesystem::path& file) {
  const std::string text = read_plain_text(file);
  return with_context(file.string(), [&] {
    SceneTruth truth;
    try {
      const auto document = nlohmann::json::parse(text);
      for (const auto& entry : document.at("scans")) {
        ScanTruth scan;
        scan.id = entry.at("id").get<std::string>();
        scan.world_from_scan = pose_from_row_major(entry.at("world_from_scan").get<std::array<double, 16>>());
        const auto& samples = entry.at("samples");
        if (!samples.is_number_unsigned())
          fail_input(
              "scan {}: samples: expected a whole number from 0, found {}; make it again with hybrid-synth",
              scan.id, samples.dump());
        const auto image = file.parent_path() / entry.at("truth_image").get<std::string>();
        scan.plane = read_uint_channel(image, "plane", samples.get<std::size_t>());
        scan.kind = read_uint_channel(image, "kind", samples.get<std::size_t>());
        truth.scans.push_back(std::move(scan));
      }
    } catch (const nlohmann::json::exception& error) {
      fail_input(
          "expected the truth of a synthetic scene, found something else ({}); make it again with "
          "hybrid-synth",
          error.what());
    }
    return truth;
  });
}

}  // namespace hybrid::io
