#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <stdexcept>

#include "io/e57_scans.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/exr/exr_scan.hpp"
#include "io/exr/range_exr.hpp"
#include "io/foreign_exr.hpp"
#include "io/picture.hpp"
#include "io/reader_rows.hpp"
#include "io/scan_samples.hpp"
#include "io/truth.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

// truth.json and the image beside it: 1500 samples in rows of 1024.

constexpr const char* kTruthImage = "truth/west wall.exr";

void write_truth_image(const fs::path& file) {
  fs::create_directories(file.parent_path());
  std::vector<std::uint32_t> values(2048);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<std::uint32_t>(i * 2654435761u) >> 20;
  Imf::Header header(1024, 2);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer pixels;
  for (const char* name : {"kind", "plane"}) {
    header.channels().insert(name, Imf::Channel(Imf::UINT));
    pixels.insert(name, Imf::Slice(Imf::UINT, reinterpret_cast<char*>(values.data()), 4, 4096));
  }
  Imf::OutputFile out(file.c_str(), header);
  out.setFrameBuffer(pixels);
  out.writePixels(2);
}

const std::string kTruth =
    "{\n  \"scans\": [\n    {\"id\": \"west\", \"truth_image\": \"truth/west wall.exr\", \"samples\": 1500,\n"
    "     \"world_from_scan\": [1, 0, 0, 2.5, 0, 1, 0, 3.5, 0, 0, 1, 4.5, 0, 0, 0, 1]}\n  ]\n}";

std::string tell_truth(const fs::path& file) {
  std::string text;
  for (const io::ScanTruth& scan : io::read_truth(file).scans) {
    tell(text, scan.id, row_major(scan.world_from_scan));
    tell(text, "plane", scan.plane);
    tell(text, "kind", scan.kind);
  }
  return text;
}

ReaderRow truth_row() {
  ReaderRow row{.name = "truth", .file = "truth.json"};
  row.good = [](const fs::path& folder) {
    write_truth_image(folder / kTruthImage);
    return kTruth;
  };
  row.read = tell_truth;
  row.text = true;
  row.counts_too_high = {{"1500", "2049"}};
  row.counts_too_low = {{"1500", "1024"}, {"1500", "-1"}};
  row.absurd_sizes = {{"1500", "18000000000000000000"}, {"1500", "1e300"}};
  row.non_finite = {{"2.5", "NaN"}, {"2.5", "1e999"}};
  return row;
}

// The corners of a data window of an OpenEXR file.
std::string window(int width, int height) {
  return std::string("dataWindow\0box2i\0", 17) + raw(16) + raw(0) + raw(0) + raw(width - 1) +
         raw(height - 1);
}

std::string tiles(std::uint32_t size) {
  return std::string("tiledesc\0", 9) + raw(9) + raw(size) + raw(size);
}

ReaderRow truth_image_row() {
  ReaderRow row{.name = "truth_image", .file = kTruthImage};
  row.good = [](const fs::path& folder) {
    write_file_beside(folder / "truth.json", kTruth);
    write_truth_image(folder / kTruthImage);
    return file_bytes(folder / kTruthImage);
  };
  row.read = [](const fs::path& file) { return tell_truth(file.parent_path().parent_path() / "truth.json"); };
  row.free_name = false;
  row.counts_too_high = {{window(1024, 2), window(1024, 3)}, {window(1024, 2), window(2048, 2)}};
  row.counts_too_low = {{window(1024, 2), window(1024, 1)}, {window(1024, 2), window(512, 2)}};
  row.absurd_sizes = {{window(1024, 2), window(1024, 2'000'000'000)},
                      {window(1024, 2), window(2'000'000'000, 2)},
                      {window(1024, 2), window(0, 2)}};
  return row;
}

ReaderRow range_exr_row() {
  ReaderRow row{.name = "range_exr", .file = "range.exr"};
  row.good = [](const fs::path& folder) {
    RangeImage image = make_range_image(20, 30);
    for (std::size_t i = 0; i < image.elevation_rad.size(); ++i)
      image.elevation_rad[i] = 0.5 - 0.03125 * double(i);
    for (std::size_t i = 0; i < image.azimuth_rad.size(); ++i) image.azimuth_rad[i] = 0.0625 * double(i);
    for (std::size_t i = 0; i < image.count(); i += 2) {
      image.mask[i] = kMeasured;
      image.source[i] = static_cast<std::uint32_t>(i);
      image.range_m[i] = image.x[i] = 1 + static_cast<float>(i);
      image.y[i] = image.z[i] = 0.5f;
    }
    io::write_range_exr(folder / "range.exr", image, {{"source", "west.ptx"}});
    return file_bytes(folder / "range.exr");
  };
  row.read = [](const fs::path& file) {
    const RangeImage image = io::read_range_exr(file);
    std::string text;
    tell(text, "elevation", image.elevation_rad);
    tell(text, "range", image.range_m);
    tell(text, "source", image.source);
    for (const auto& [name, value] : io::read_range_exr_attributes(file)) text += name + value;
    return text;
  };
  row.counts_too_high = {{window(30, 20), window(30, 21)}, {window(30, 20), window(300, 20)}};
  row.counts_too_low = {{window(30, 20), window(30, 19)}, {window(30, 20), window(20, 30)}};
  row.absurd_sizes = {{window(30, 20), window(2'000'000'000, 2'000'000'000)},
                      {window(30, 20), window(30'000, 30'000)},
                      {tiles(256), tiles(1'000'000)}};
  row.non_finite = {{"0.46875 ", "nan     "}};
  return row;
}

std::string tell_exr_scan(const fs::path& file) {
  const Scan scan = io::read_exr_scan(file);
  std::string text = fmt::format("{} x {}\n", scan.grid_rows, scan.grid_cols);
  for (const auto& point : scan.points) tell(text, "point", point);
  tell(text, "intensity", scan.intensity);
  tell(text, "notes", scan.notes);
  if (scan.range_grid) tell(text, "elevation", scan.range_grid->elevation_rad);
  return text;
}

// Our own range image as a scan.
ReaderRow range_exr_scan_row() {
  ReaderRow row = range_exr_row();
  row.name = "range_exr_as_scan";
  row.read = tell_exr_scan;
  return row;
}

// An E57 file's records: some nodes have none, one has two.
ReaderRow exr_records_row() {
  ReaderRow row{.name = "exr_records", .file = "west.exr"};
  row.good = [](const fs::path& folder) {
    fs::create_directories(folder);
    io::E57Scan scan{.guid = "{A}", .name = "west"};
    for (const char* name : {"cartesianX", "cartesianY"}) scan.points.fields.push_back(real_field(name));
    scan.points.fields.push_back(scaled_field("cartesianZ", -1000, 1000, 0.001));
    scan.points.fields.push_back(integer_field("rowIndex", 0, 19));
    scan.points.fields.push_back(integer_field("columnIndex", 0, 29));
    E57Columns columns = random_columns(scan.points.fields, 500);
    for (std::size_t i = 0; i < 500; ++i) {
      columns.integers[3][i] = static_cast<std::int64_t>(i % 20);
      columns.integers[4][i] = static_cast<std::int64_t>(i / 20 + i / 499);
    }
    columns.integers[3][7] = 6;
    write_e57(folder / "west.e57", scan, columns);
    io::write_exr_scan(io::E57FileSource(folder / "west.e57"), 0, folder / "west.exr", {});
    fs::remove(folder / "west.e57");
    return file_bytes(folder / "west.exr");
  };
  row.read = [](const fs::path& file) {
    const Scan scan = io::read_exr_records(file);
    std::string text = fmt::format("{} x {}\n", scan.grid_rows, scan.grid_cols);
    for (const auto& point : scan.points) tell(text, "point", point);
    tell(text, "node", scan.node);
    tell(text, "notes", scan.notes);
    return text;
  };
  row.counts_too_high = {{window(26, 257), window(26, 258)},
                         {std::string("\0\0\0"
                                      "500",
                                      6),
                          std::string("\0\0\0"
                                      "501",
                                      6)},
                         {"grid 20 26 list 1", "grid 20 26 list 2"},
                         {"recordCount=\"500\"", "recordCount=\"501\""}};
  row.counts_too_low = {{window(26, 257), window(26, 256)},
                        {std::string("\0\0\0"
                                     "500",
                                     6),
                         std::string("\0\0\0"
                                     "499",
                                     6)},
                        {"grid 20 26 list 1", "grid 20 25 list 1"},
                        {"recordCount=\"500\"", "recordCount=\"  9\""}};
  row.absurd_sizes = {{window(26, 257), window(2'000'000'000, 2'000'000'000)},
                      {window(26, 257), window(26'000, 30'000)},
                      {tiles(256), tiles(1'000'000)},
                      {"grid 20 26 list 1", "grid 9 9e9 list 1"},
                      {"hybrid:layout", "hybrid:layou?"}};
  return row;
}

// Another program's: ranges in lines, without a checksum.
ReaderRow foreign_exr_row() {
  ReaderRow row{.name = "foreign_exr", .file = "scan.exr"};
  row.good = [](const fs::path& folder) {
    ForeignExr exr(30, 20);
    exr.add("range", Imf::FLOAT);
    exr.add("intensity", Imf::HALF);
    std::string elevation, azimuth;
    for (int i = 0; i < 20; ++i) elevation += fmt::format("{} ", 0.5 - 0.03125 * i);
    for (int i = 0; i < 30; ++i) azimuth += fmt::format("{} ", 0.0625 * i);
    exr.attribute("hybrid:elevation_rad", elevation);
    exr.attribute("hybrid:azimuth_rad", azimuth);
    fs::create_directories(folder);
    exr.write(folder / "scan.exr");
    return file_bytes(folder / "scan.exr");
  };
  row.read = tell_exr_scan;
  row.checked = false;
  row.counts_too_high = {{window(30, 20), window(30, 21)}, {window(30, 20), window(300, 20)}};
  row.counts_too_low = {{window(30, 20), window(30, 19)}, {window(30, 20), window(20, 30)}};
  row.absurd_sizes = {{window(30, 20), window(2'000'000'000, 2'000'000'000)},
                      {window(30, 20), window(30'000, 30'000)}};
  row.non_finite = {{"0.46875 ", "nan     "}};
  return row;
}

// Photographs of 40 x 30 pixels.

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

// A PNG's header chunk with its checksum.
std::string png_header(int width, int height) {
  const std::string chunk = "IHDR" + raw(width, true) + raw(height, true) + std::string("\x08\x02\0\0\0", 5);
  return chunk + raw(crc32(chunk), true);
}

std::string jpeg_header(int width, int height) {
  return std::string("\xff\xc0\0\x11\x08", 5) + raw(static_cast<std::uint16_t>(height), true) +
         raw(static_cast<std::uint16_t>(width), true);
}

ReaderRow photograph_row(const std::string& format, std::string (*header)(int width, int height)) {
  ReaderRow row{.name = "photograph_" + format, .file = "door." + format};
  row.good = [format](const fs::path& folder) {
    const fs::path file = folder / ("made." + format);
    std::vector<std::uint8_t> pixels(40 * 30 * 3);
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * i >> 5);
    Image8 image(40, 30, 3);
    image.pixels.assign(pixels.begin(), pixels.end());
    if (format == "png")
      io::write_png(file, image);
    else
      io::write_jpeg(file, image, 95);
    return file_bytes(file);
  };
  row.read = [](const fs::path& file) {
    std::string text;
    tell(text, "pixels", io::read_photograph(file, 40, 30).pixels);
    return text;
  };
  row.counts_too_high = {{header(40, 30), header(40, 31)}, {header(40, 30), header(41, 30)}};
  row.counts_too_low = {{header(40, 30), header(40, 29)}, {header(40, 30), header(20, 30)}};
  row.absurd_sizes = {{header(40, 30), header(65'000, 65'000)},
                      {header(40, 30), header(20'000, 20'000)},
                      {header(40, 30), header(0, 30)}};
  row.most_bytes = 128 << 20;     // OpenImageIO takes 64 MiB to tell its first error
  row.checked = format == "png";  // JPEG has no checksum
  return row;
}

}  // namespace

std::vector<ReaderRow> image_reader_rows() {
  return {truth_row(),
          truth_image_row(),
          range_exr_row(),
          range_exr_scan_row(),
          foreign_exr_row(),
          exr_records_row(),
          photograph_row("png", png_header),
          photograph_row("jpg", jpeg_header)};
}

}  // namespace hybrid::testing
