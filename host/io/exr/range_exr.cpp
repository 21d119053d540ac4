#include "io/exr/range_exr.hpp"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <charconv>
#include <memory>

#include "core/error.hpp"
#include "io/exr/exr_errors.hpp"
#include "io/exr/exr_header.hpp"
#include "io/exr/exr_parts.hpp"
#include "io/exr/exr_stream.hpp"
#include "io/exr/exr_threads.hpp"
#include "io/exr/exr_tile_writer.hpp"
#include "io/exr/range_checksum.hpp"
#include "io/exr/range_exr_band.hpp"
#include "io/exr/range_exr_header.hpp"
#include "io/input_file.hpp"
#include "io/output.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

// A part for each way of reading and compressing. Measured on a noisy 5 MP church scan
// (bench/read/README.md): one part with PIZ, or PIZ in tiles of 512, ZIP, nothing: 18.2, 16.9, 19.5, 28.0
// bytes per sample, written at 2.5, 4.6, 1.7, 38 and read at 6.2, 5.8, 6.7, 19 million samples per CPU
// second. Measured floats hardly compress; mask and source shrink from 8 bytes to 0.6. So does what follows,
// at 20.6 bytes, and the ranges alone are read without the rest.
const std::vector<ExrPart>& parts() {
  static const std::vector<ExrPart> list = {
      {"range", Imf::NO_COMPRESSION, {"range"}},           {"points", Imf::NO_COMPRESSION, {"x", "y", "z"}},
      {"marks", Imf::ZIP_COMPRESSION, {"mask", "source"}}, {"intensity", Imf::NO_COMPRESSION, {"intensity"}},
      {"colour", Imf::ZIP_COMPRESSION, {"R", "G", "B"}},
  };
  return list;
}

using namespace range_attribute;

std::string to_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) {
    char digits[32];
    const auto [end, code] = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, end);
    text += ' ';
  }
  return text;
}

// Everything the file stores.
std::string checksum(const RangeImage& image) {
  RangeChecksum sum(image.rows, image.cols, image.wraps, image.elevation_rad, image.azimuth_rad);
  const auto add = [&](RangeChecksum::Channel channel, const auto& values) {
    sum.add(channel, std::span(values));
  };
  add(RangeChecksum::range, image.range_m);
  add(RangeChecksum::x, image.x);
  add(RangeChecksum::y, image.y);
  add(RangeChecksum::z, image.z);
  add(RangeChecksum::intensity, image.intensity);
  add(RangeChecksum::mask, image.mask);
  add(RangeChecksum::source, image.source);
  add(RangeChecksum::colour, image.rgb);
  return sum.text();
}

Imf::Header make_header(const std::string& file, const RangeImage& image,
                        const std::map<std::string, std::string>& attributes) {
  Imf::Header header(image.cols, image.rows);
  header.setTileDescription(Imf::TileDescription(kRangeTile_px, kRangeTile_px));
  for (const char* name : {"range", "x", "y", "z"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  for (const char* name : {"mask", "source"}) header.channels().insert(name, Imf::Channel(Imf::UINT));
  if (!image.intensity.empty()) header.channels().insert("intensity", Imf::Channel(Imf::FLOAT));
  if (!image.rgb.empty())
    for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
  header.insert(kFormat, Imf::StringAttribute(kFormatName));
  header.insert(kElevation, Imf::StringAttribute(to_text(image.elevation_rad)));
  header.insert(kAzimuth, Imf::StringAttribute(to_text(image.azimuth_rad)));
  header.insert(kWraps, Imf::IntAttribute(image.wraps ? 1 : 0));
  header.insert(kExtra, Imf::IntAttribute(static_cast<int>(image.extra.size())));
  header.insert(kChecksum, Imf::StringAttribute(checksum(image)));
  for (const auto& [name, value] : attributes) {
    if (is_range_attribute(kPrefix + name) && kPrefix + name != kPose)
      fail(ErrorKind::failed, "{}: attribute {}: the format itself uses this name; choose another", file,
           name);
    header.insert(kPrefix + name, Imf::StringAttribute(value));
  }
  return header;
}

void check_sizes(const std::string& file, const RangeImage& image) {
  if (image.rows < 1 || image.cols < 1)
    fail(ErrorKind::failed, "{}: expected a range image of at least 1 x 1 samples, found {} x {}", file,
         image.rows, image.cols);
  const std::size_t count = image.count();
  const auto full = [&](std::size_t size) { return size == count; };
  const auto full_or_empty = [&](std::size_t size) { return size == 0 || size == count; };
  if (image.elevation_rad.size() != static_cast<std::size_t>(image.rows) ||
      image.azimuth_rad.size() != static_cast<std::size_t>(image.cols) || !full(image.range_m.size()) ||
      !full(image.x.size()) || !full(image.y.size()) || !full(image.z.size()) || !full(image.mask.size()) ||
      !full(image.source.size()) || !full_or_empty(image.intensity.size()) ||
      !full_or_empty(image.rgb.size()))
    fail(ErrorKind::failed,
         "{}: expected every channel to have {} x {} values and an angle per row and column", file,
         image.rows, image.cols);
}

// A file that write_range_exr wrote, opened; the library's errors become ours.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : file_(path.string()) {
    guarded([&] { in_ = std::make_unique<ExrParts>(path, start_exr_threads()); });
    if (!is_range_format(text(kFormat)))
      fail_input("{}: header: expected {} \"{}\", found {}; this is no range image of this version", file_,
                 kFormat, kFormatName, in_quotes(text(kFormat)));
    if (in_->band_rows() != static_cast<int>(kRangeTile_px) || header().dataWindow().min != Imath::V2i(0, 0))
      fail_input("{}: header: expected tiles of {} x {} from (0, 0), found another layout; write it again",
                 file_, kRangeTile_px, kRangeTile_px);
    if (!in_->complete())
      fail_input(
          "{}: tiles: expected all of them, found some missing; the file is cut short: copy or write it "
          "again",
          file_);
  }

  const Imf::Header& header() const { return in_->header(); }

  RangeImage read() {
    const Imath::V2i last = header().dataWindow().max;
    // The angles first: as many of them stand in the file before memory is taken for the samples.
    std::vector<double> elevation_rad = angle_attribute(file_, header(), kElevationAttributes, last.y + 1);
    std::vector<double> azimuth_rad = angle_attribute(file_, header(), kAzimuthAttributes, last.x + 1);
    if (elevation_rad.empty() || azimuth_rad.empty())
      fail_input("{}: header: expected the tables {} and {}, found none; this is no range image", file_,
                 kElevation, kAzimuth);
    RangeImage image = make_range_image(last.y + 1, last.x + 1);
    image.elevation_rad = std::move(elevation_rad);
    image.azimuth_rad = std::move(azimuth_rad);
    const auto* wraps = header().findTypedAttribute<Imf::IntAttribute>(kWraps);
    image.wraps = wraps != nullptr && wraps->value() != 0;
    for (const char* name : {"range", "x", "y", "z"}) need_channel(name, Imf::FLOAT);
    for (const char* name : {"mask", "source"}) need_channel(name, Imf::UINT);
    if (has_channel("intensity", Imf::FLOAT)) image.intensity.resize(image.count());
    if (has_channel("R", Imf::HALF) && has_channel("G", Imf::HALF) && has_channel("B", Imf::HALF))
      image.rgb.resize(image.count());
    RangeExrBand band(image);
    guarded([&] {
      for (int row = 0; row < image.rows; row += in_->band_rows()) {
        in_->read(band.slices(row), row, std::min(in_->band_rows(), image.rows - row));
        band.give_to_image();
      }
    });
    if (checksum(image) != text(kChecksum))
      fail_input("{}: content: expected checksum {}, found {}; the file is damaged: copy or write it again",
                 file_, text(kChecksum), checksum(image));
    return image;
  }

 private:
  template <typename Body>
  void guarded(const Body& body) const {
    with_exr_errors(body, [&](const char* what) {
      fail_input(
          "{}: expected a tiled range image as written to range.exr, found another or a damaged file ({})",
          file_, what);
    });
  }

  std::string text(const char* name) const { return text_attribute(header(), name); }

  bool has_channel(const char* name, Imf::PixelType type) const {
    const Imf::Channel* channel = header().channels().findChannel(name);
    return channel && channel->type == type && channel->xSampling == 1 && channel->ySampling == 1;
  }

  void need_channel(const char* name, Imf::PixelType type) const {
    if (!has_channel(name, type))
      fail_input("{}: header: expected a {} channel {}, found none; this is no range image", file_,
                 type == Imf::FLOAT ? "float" : "uint", name);
  }

  std::string file_;
  std::unique_ptr<ExrParts> in_;
};

}  // namespace

void write_range_exr(const std::filesystem::path& file, const RangeImage& image,
                     const std::map<std::string, std::string>& attributes) {
  check_sizes(file.string(), image);
  const Imf::Header header = make_header(file.string(), image, attributes);
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    write_exr_stream(temporary, [&](ExrStream& stream) {
      ExrTileWriter out(stream, header, parts());
      // OpenEXR's slices are not const; writing only reads them.
      RangeExrBand band(const_cast<RangeImage&>(image));
      constexpr int kRows = kRangeTile_px;
      for (int row = 0; row < image.rows; row += kRows) {
        const Imf::FrameBuffer slices = band.slices(row);
        band.take_from_image();
        out.write(slices, row, std::min(kRows, image.rows - row));
      }
      out.finish();
    });
  });
}

RangeImage read_range_exr(const std::filesystem::path& file) {
  return Reader(file).read();
}

std::map<std::string, std::string> read_range_exr_attributes(const std::filesystem::path& file) {
  const Reader reader(file);
  std::map<std::string, std::string> result;
  for (auto at = reader.header().begin(); at != reader.header().end(); ++at) {
    const std::string name = at.name();
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&at.attribute());
    if (text && name.starts_with(kPrefix) && (!is_range_attribute(name) || name == kPose))
      result[name.substr(std::string_view(kPrefix).size())] = text->value();
  }
  return result;
}

}  // namespace hybrid::io
