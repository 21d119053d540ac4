#include "io/exr/exr.hpp"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

struct Channels {
  std::vector<float> rgb;             // interleaved
  std::vector<std::uint32_t> labels;  // above 2^24: no float holds them
};

Channels some_channels(int width, int height) {
  const auto count = static_cast<std::size_t>(width * height);
  Channels result{std::vector<float>(3 * count), std::vector<std::uint32_t>(count)};
  for (std::size_t i = 0; i < 3 * count; ++i)
    result.rgb[i] = i % 11 == 0 ? std::numeric_limits<float>::infinity() : std::sin(static_cast<float>(i));
  for (std::size_t i = 0; i < count; ++i) result.labels[i] = 0xffffffffu - 3 * static_cast<std::uint32_t>(i);
  return result;
}

std::vector<io::ExrChannel> table(const Channels& c) {
  return {{.name = "R", .f = c.rgb.data(), .stride = 3},
          {.name = "G", .f = c.rgb.data() + 1, .stride = 3},
          {.name = "B", .f = c.rgb.data() + 2, .stride = 3},
          {.name = "id", .u = c.labels.data()}};
}

TEST(Exr, AnotherReaderFindsTheSameValues) {
  const ScanFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {65, 3}, {130, 200}}) {
    const Channels channels = some_channels(width, height);
    const auto file = folder.path("views/front.exr");
    io::write_exr(file, width, height, table(channels));

    const auto in = OIIO::ImageInput::open(file.string());
    ASSERT_TRUE(in) << OIIO::geterror();
    const OIIO::ImageSpec spec = in->spec();
    EXPECT_EQ(spec.width, width);
    EXPECT_EQ(spec.height, height);
    EXPECT_EQ(spec.nchannels, 4);
    EXPECT_GT(spec.tile_width, 0);
    EXPECT_FALSE(spec.find_attribute("DateTime"));
    const auto count = static_cast<std::size_t>(width * height);
    for (int c = 0; c < 3; ++c) {
      std::vector<float> values(count);
      const int at = spec.channelindex(std::string(1, "RGB"[c]));
      ASSERT_TRUE(in->read_image(0, 0, at, at + 1, OIIO::TypeDesc::FLOAT, values.data()));
      for (std::size_t i = 0; i < count; ++i)
        ASSERT_EQ(values[i], channels.rgb[3 * i + static_cast<std::size_t>(c)]) << i;
    }
    std::vector<std::uint32_t> labels(count);
    const int at = spec.channelindex("id");
    ASSERT_EQ(spec.channelformat(at), OIIO::TypeDesc::UINT);
    ASSERT_TRUE(in->read_image(0, 0, at, at + 1, OIIO::TypeDesc::UINT, labels.data()));
    EXPECT_EQ(labels, channels.labels);

    const std::string first = bytes_of(file);
    io::write_exr(file, width, height, table(channels));
    EXPECT_EQ(bytes_of(file), first);
  }
}

TEST(Exr, WhatCannotBeWrittenIsRefused) {
  const ScanFolder folder;
  const auto file = folder.path("no.exr");
  const Channels channels = some_channels(2, 2);
  EXPECT_THROW(io::write_exr(file, 0, 2, table(channels)), Error);
  EXPECT_THROW(io::write_exr(file, 2, 2, {}), Error);
  EXPECT_THROW(io::write_exr(file, 2, 2, {{.name = "neither"}}), Error);
  EXPECT_THROW(
      io::write_exr(file, 2, 2, {{.name = "both", .f = channels.rgb.data(), .u = channels.labels.data()}}),
      Error);
  EXPECT_THROW(io::write_exr(file, 2, 2,
                             {{.name = "id", .u = channels.labels.data()},
                              {.name = "id", .u = channels.labels.data()}}),
               Error);
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace hybrid::testing
