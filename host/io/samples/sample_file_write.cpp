#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"
#include "io/record_blocks.hpp"
#include "io/samples/columns.hpp"
#include "io/samples/sample_band.hpp"
#include "io/samples/sample_file.hpp"

namespace hybrid::io {
namespace {

template <typename Holds>
bool every_node(const RangeImage& image, const Holds& holds) {
  std::atomic<bool> all = true;
  parallel_for(static_cast<std::size_t>(image.rows), [&](std::size_t row) {
    for (int col = 0; col < image.cols && all; ++col) {
      const std::size_t node = image.index(static_cast<int>(row), col);
      if (image.mask[node] == kMeasured && !holds(node)) all = false;
    }
  });
  return all;
}

// The largest step of which every value is a multiple; 0: none.
template <typename Holds>
NumberCode find_step(const RangeImage& image, std::initializer_list<double> steps, const Holds& holds) {
  for (const double step : steps)
    if (every_node(image, [&](std::size_t node) { return holds(NumberCode(step), node); }))
      return NumberCode(step);
  return NumberCode(0);
}

std::vector<std::array<double, 2>> rays_of(const std::vector<double>& angles) {
  std::vector<std::array<double, 2>> rays;
  for (const double angle : angles) rays.push_back({std::cos(angle), std::sin(angle)});
  return rays;
}

SampleHeader make_header(const SampleFileInput& input) {
  const auto& image = input.image;
  SampleHeader header;
  header.rows = image.rows;
  header.cols = image.cols;
  header.wraps = image.wraps;
  header.elevation_rad = image.elevation_rad;
  header.azimuth_rad = image.azimuth_rad;
  header.elevation_ray = rays_of(image.elevation_rad);
  header.azimuth_ray = rays_of(image.azimuth_rad);
  for (const Supercluster& plane : input.planes) header.planes.push_back(plane.plane);
  if (input.georeferenced) header.origin = input.georeferenced->origin;
  header.point =
      find_step(image, {1e-3, 5e-4, 1e-4, 5e-5, 1e-5, 1e-6}, [&](const NumberCode& code, std::size_t node) {
        const auto point = stored_point(input, node);
        return std::ranges::all_of(point, [&](float value) { return code.holds(value); });
      });
  header.intensity = !image.intensity.empty();
  if (header.intensity)
    header.intensity_code = find_step(
        image, {1, 1.0 / 255, 1.0 / 2047, 1.0 / 2048, 1.0 / 4095, 1.0 / 65535, 1e-3, 1e-4, 1e-6},
        [&](const NumberCode& code, std::size_t node) { return code.holds(image.intensity[node]); });
  header.colour = !image.rgb.empty();
  for (std::size_t node = 0; node < image.count(); ++node) {
    if (image.mask[node] != kMeasured) continue;
    ++header.samples;
    header.discarded += input.discarded[node] != 0 && input.label[node] != 0;
  }
  header.extra = input.extra.size();
  header.world_from_scan = input.world_from_scan;
  header.crs = input.crs;
  return header;
}

void write_block(OutputFile& out, const std::string& bytes) {
  std::string front;
  append_raw(front, static_cast<std::uint64_t>(bytes.size()));
  append_raw(front, static_cast<std::uint64_t>(XXH3_64bits(bytes.data(), bytes.size())));
  out.write(front.data(), front.size());
  out.write(bytes.data(), bytes.size());
}

std::string extra_bytes(const SampleFileInput& input) {
  std::string bytes;
  for (std::size_t i = 0; i < input.extra.size(); ++i) {
    for (const double value : input.extra[i]) append_raw(bytes, value);
    if (!input.image.intensity.empty())
      append_raw(bytes, input.extra_intensity.empty() ? 0.0f : input.extra_intensity[i]);
    if (!input.image.rgb.empty())
      append_raw(bytes, input.extra_rgb.empty() ? std::array<std::uint8_t, 3>{} : input.extra_rgb[i]);
  }
  return compress(bytes);
}

}  // namespace

SampleFileSize write_sample_file(const std::filesystem::path& file, const SampleFileInput& input) {
  const SampleHeader header = make_header(input);
  SampleFileSize size{.samples = static_cast<std::int64_t>(header.samples),
                      .discarded = static_cast<std::int64_t>(header.discarded)};
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    out.write(kSampleFileMark, 8);
    out.write(&kSampleFileVersion, sizeof kSampleFileVersion);
    write_block(out, header_bytes(header));
    std::vector<EncodedBand> bands(2 * static_cast<std::size_t>(thread_count()));
    for (int first = 0; first < header.bands(); first += static_cast<int>(bands.size())) {
      check_interrupted();
      const auto count = std::min(bands.size(), static_cast<std::size_t>(header.bands() - first));
      parallel_for(count, [&](std::size_t i) {
        bands[i] = encode_band(header, input, (first + static_cast<int>(i)) * kBandRows);
      });
      for (std::size_t i = 0; i < count; ++i) {
        write_block(out, bands[i].bytes);
        size.discarded_bytes += bands[i].discarded_bytes;
      }
    }
    write_block(out, extra_bytes(input));
    size.bytes = out.position();
    out.close();
  });
  return size;
}

}  // namespace hybrid::io
