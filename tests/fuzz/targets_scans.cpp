// Text and binary scans and range images, each from files that other programs or our writers make.
#include <ImfChannelList.h>
#include <xxhash.h>

#include <cstring>
#include <numeric>

#include "fuzz/check_scan.hpp"
#include "fuzz/check_stream.hpp"
#include "fuzz/targets.hpp"
#include "io/e57_scans.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/exr/exr_records.hpp"
#include "io/exr/range_exr.hpp"
#include "io/file_in_memory.hpp"
#include "io/foreign_exr.hpp"
#include "io/grid_scan.hpp"
#include "io/las/las_records.hpp"
#include "io/las_samples.hpp"
#include "io/read_scan.hpp"
#include "io/reader_rows.hpp"
#include "io/samples/sample_file.hpp"
#include "io/scan_samples.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;
using Seeds = std::vector<std::string>;

struct Found {
  std::vector<io::ScanEntry> entries{};
  std::vector<std::optional<Scan>> scans{};

  bool any_refused() const {
    return std::ranges::any_of(scans, [](const auto& scan) { return !scan; });
  }
};

Found read_all(const fs::path& file, const io::ReadOptions& options) {
  Found found;
  if (auto entries = unless_refused([&] { return io::list_scans(file, options); }))
    found.entries = std::move(*entries);
  for (const io::ScanEntry& entry : found.entries)
    found.scans.push_back(unless_refused([&] { return io::read_scan(file, entry); }));
  return found;
}

// Range images without records are read whole: in blocks they are what read_scan() reads, once more.
bool reads_in_blocks(const fs::path& file) {
  return file.extension() != ".exr" || io::holds_exr_records(file);
}

// Strictly with exact coordinates, with salvage without them: what is compared is the same with and without.
// Where nothing is compared, with both. What reads strictly is read in blocks, too.
void read_both_ways(const fs::path& file, std::string_view) {
  Found strict = read_all(file, {.exact = true});
  const bool refused = strict.entries.empty() || strict.any_refused();
  const Found salvaged = read_all(file, {.salvage = true, .exact = refused});
  if (!refused && strict.scans[0]->range_grid)
    if (const auto grid = io::read_grid_scan(file, strict.entries[0])) check_grid(*grid, strict.scans[0]);
  // Of a file with a damaged scan salvage may tell the scans apart in another way.
  for (const auto& scan : strict.scans)
    if (scan) check_scan(*scan);
  for (std::size_t i = 0; i < std::max(strict.scans.size(), salvaged.scans.size()); ++i)
    check_salvage(i < strict.scans.size() && !refused ? strict.scans[i] : std::nullopt,
                  i < salvaged.scans.size() ? salvaged.scans[i] : std::nullopt);
  if (strict.scans.empty() || !reads_in_blocks(file)) return;
  for (std::size_t i = 0; i < strict.scans.size(); ++i)
    check_stream(file, strict.entries[i], std::move(strict.scans[i]));
}

const std::string kPtxHead = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

Seeds ptx(const fs::path&) {
  const std::string one = sample_file("ptx", "");
  const std::string four = "1\n3\n" + kPtxHead + "1 2 3 0.5\n0 0 0 0\n-1e3 2.25 600000.125 1\n";
  std::string windows;
  for (const char c : four) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return {one, four, one + four, four + one + four, windows, "1\n1\n" + kPtxHead + "nan inf 1e99 0\n"};
}

Seeds pts(const fs::path&) {
  const std::string counted = sample_file("pts", ""), rows = counted.substr(2);
  return {counted,
          rows,
          counted + counted,
          "2\n1 2 3\n4 5 6\n",
          "1 2 3 -2048\n4,5,6,2047\n",
          "0\n",
          "1\n1 2 3 4 5 6\n2\n0 0 0\n1 1 1e7\n"};
}

Seeds xyz(const fs::path&) {
  return {"1 2 3\n4 5 6\n",
          "//X Y Z R G B Intensity\n2\n1 2 3 4 5 6 0.5\n4 5 600000.125 7 8 255 1\n",
          "# by\n\"x\";\"y\";\"z\";\"red\";\"green\";\"blue\"\n1;2;3;0;0.5;1\n-1e3;2.25;0;1;1;1\n",
          "1,2,3,0.5,300,20,30\r\n4,5,6,0.25,1,2,65535\r\n",
          "b g r z y x t\n1 2 300 3 2 1 9\n0 0 0 nan inf 1e99 0\n",
          "0\n",
          "1 2 3 10 20 30 0.25\n1 2 3 10 20 30 4\n"};
}

Seeds ply_ascii(const fs::path&) {
  return {sample_file("ply", "ascii"),
          "ply\nformat ascii 1.0\ncomment \xc3\xa4\nelement face 1\nproperty list uchar int vertex_indices\n"
          "element vertex 2\nproperty double x\nproperty double y\nproperty double z\nproperty float red\n"
          "property float green\nproperty float blue\nproperty list uchar float odd\nend_header\n3 0 1 2\n"
          "1 2 3 0.5 1 0 2 7 8\n600000 2 3 0 0 0 0\n"};
}

Seeds ply_binary(const fs::path&) {
  const std::string head =
      "element face 1\nproperty list uchar int vertex_indices\nelement vertex 1\nproperty double x\n"
      "property double y\nproperty double z\nproperty ushort red\nproperty ushort green\n"
      "property ushort blue\nend_header\n";
  const std::string body = '\2' + raw(0) + raw(1) + raw(1.0) + raw(2.0) + raw(3e6) + raw(std::uint16_t{256}) +
                           raw(std::uint16_t{1}) + raw(std::uint16_t{65535});
  return {sample_file("ply", "binary_little_endian"), sample_file("ply", "binary_big_endian"),
          "ply\nformat binary_little_endian 1.0\n" + head + body};
}

const std::string kPcdGrid =
    "VERSION 0.7\nFIELDS x y z red green blue _ n\nSIZE 8 8 8 4 4 4 1 2\nTYPE F F F F F F U I\n"
    "COUNT 1 1 1 1 1 1 3 2\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS 4\nDATA ";

std::string pcd_grid_rows() {
  std::string rows;
  for (int i = 0; i < 4; ++i) {
    for (const double value : {1.0 * i, 2.0, 3e6}) rows += raw(value);
    for (const float value : {0.0f, 0.5f, 1.0f}) rows += raw(value);
    rows += std::string(3, '\0') + raw(std::int16_t{1}) + raw(std::int16_t{-1});
  }
  return rows;
}

Seeds pcd_ascii(const fs::path&) {
  std::string rows;
  for (int i = 0; i < 4; ++i) rows += fmt::format("{} nan 2.5 0 0.5 1 0 0 0 1 -1\n", i);
  return {sample_file("pcd", "ascii"), kPcdGrid + "ascii\n" + rows};
}

Seeds pcd_binary(const fs::path&) {
  return {sample_file("pcd", "binary"), kPcdGrid + "binary\n" + pcd_grid_rows() + std::string(40, '\0')};
}

Seeds pcd_compressed(const fs::path&) {
  const std::string rows = pcd_grid_rows();
  std::string packed = lzf_literals(rows.substr(0, 8));
  // The rest as copies of what stands 8 bytes before, of 8 bytes (length 6 + 2) each.
  std::string expanded = rows.substr(0, 8);
  while (expanded.size() < rows.size()) {
    packed += "\xc0\x07";
    expanded += expanded.substr(expanded.size() - 8);
  }
  const auto sized = [](const std::string& data, std::size_t size) {
    return raw(static_cast<std::uint32_t>(data.size())) + raw(static_cast<std::uint32_t>(size)) + data;
  };
  return {sample_file("pcd", "binary_compressed"),
          kPcdGrid + "binary_compressed\n" + sized(packed, expanded.size()),
          kPcdGrid + "binary_compressed\n" + sized(lzf_literals(rows), rows.size())};
}

Seeds las(const fs::path&) {
  return {las_sample(2), las_sample(3), las_sample(4)};
}

// Its samples, and its records as `convert` copies them.
void read_las_both_ways(const fs::path& file, std::string_view bytes) {
  read_both_ways(file, bytes);
  unless_refused([&] {
    const io::LasAsE57 source(file);
    const io::E57Table& table = source.table(source.points(0));
    std::vector<std::size_t> fields(table.fields.size());
    std::iota(fields.begin(), fields.end(), 0);
    std::uint64_t records = 0;
    for_each_block(*source.open(source.points(0)), table, fields, 1 << 16,
                   [&](const io::E57Records& block) { records += block.count; });
    expect(records == table.count, "every record");
    return true;
  });
}

// As other programs write range images: every compression, lines and tiles.
Seeds foreign_exr(const fs::path& scratch) {
  Seeds seeds;
  for (int compression = 0; compression < 10; ++compression)
    for (const int tile : {0, 8}) {
      ForeignExr exr(9, 7);
      exr.compression = static_cast<Imf::Compression>(compression);
      exr.tile = tile;
      exr.corner = {compression - 3, 2};
      if (compression % 2 == 0) {
        exr.add("range", Imf::FLOAT);
        exr.attribute("hybrid:elevation_rad", std::string("0.5 0.4 0.3 0.2 0.1 0 -0.1"));
        exr.attribute("hybrid:azimuth_first_rad", 0.0);
        exr.attribute("hybrid:azimuth_step_rad", 0.125);
      } else {
        for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
        exr.add("mask", Imf::UINT);
        exr.attribute("hybrid:world_from_scan", std::string("1 0 0 4 0 1 0 5 0 0 1 6 0 0 0 1"));
      }
      exr.add("intensity", Imf::HALF);
      if (compression == 3)
        for (const char* name : {"R", "G", "B"}) exr.add(name, Imf::HALF);
      exr.write(scratch / "foreign.exr");
      seeds.push_back(file_bytes(scratch / "foreign.exr"));
    }
  return seeds;
}

// The same pixels in one smaller tile: the library's buffers for tiles of 256 x 256 took most of an
// execution of every descendant, so one seed has them.
std::string with_small_tiles(std::string file) {
  const std::string large = raw(std::uint32_t{256}) + raw(std::uint32_t{256}),
                    small = raw(std::uint32_t{16}) + raw(std::uint32_t{16});
  const std::string_view name("tiles\0tiledesc\0", 15);
  for (std::size_t at = file.find(name); at != file.npos; at = file.find(name, at + 1))
    if (file.compare(at + 19, 8, large) == 0) file.replace(at + 19, 8, small);
  return file;
}

Seeds range_exr(const fs::path& scratch) {
  Seeds seeds;
  for (const int rows : {1, 5}) {
    RangeImage image = make_range_image(rows, 6);
    for (std::size_t i = 0; i < image.elevation_rad.size(); ++i)
      image.elevation_rad[i] = 0.5 - 0.125 * double(i);
    for (std::size_t i = 0; i < image.azimuth_rad.size(); ++i) image.azimuth_rad[i] = 0.0625 * double(i);
    for (std::size_t i = 0; i < image.count(); ++i) {
      image.mask[i] = static_cast<std::uint8_t>(i % 3);
      image.source[i] = static_cast<std::uint32_t>(i);
      image.range_m[i] = image.x[i] = 1 + static_cast<float>(i);
      image.y[i] = image.z[i] = 0.5f;
    }
    if (rows == 5) {
      image.intensity.assign(image.count(), 0.25f);
      image.rgb.assign(image.count(), {1, 128, 255});
    }
    io::write_range_exr(scratch / "range.exr", image, {{"source", "west.ptx"}});
    if (rows == 1) seeds.push_back(file_bytes(scratch / "range.exr"));
    seeds.push_back(with_small_tiles(file_bytes(scratch / "range.exr")));
  }
  return seeds;
}

// An E57 file's records as a grid, and as a list; with the tiles' checksums, and without as older images: in
// these, damage reaches what decodes the tiles.
Seeds records_exr(const fs::path& scratch) {
  Seeds seeds;
  for (const bool grid : {true, false}) {
    io::E57Scan scan;
    for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
      scan.points.fields.push_back(scaled_field(axis, -70'000, 70'000, 1e-3));
    scan.points.fields.push_back(real_field("intensity", io::E57Type::double_real));
    for (const char* name : {"rowIndex", "columnIndex"})
      if (grid) scan.points.fields.push_back(integer_field(name, 0, 7));
    E57Columns columns = random_columns(scan.points.fields, 30);
    for (std::size_t i = 0; grid && i < 30; ++i) {
      columns.integers[4][i] = static_cast<std::int64_t>(i % 5);
      columns.integers[5][i] = static_cast<std::int64_t>(i / 5);
    }
    write_e57(scratch / "records.e57", scan, columns);
    io::write_exr_scan(io::E57FileSource(scratch / "records.e57"), 0, scratch / "records.exr", {});
    seeds.push_back(file_bytes(scratch / "records.exr"));
    std::string older = seeds.back();
    const std::string_view sums(io::records_attribute::kTileSums);
    older.at(older.find(sums) + sums.size() - 1) = '?';
    seeds.push_back(older);
  }
  return seeds;
}

// As read_both_ways(), damaged ones also in blocks; listed once, which is the same with salvage. What a
// mutation has made another image is range_exr's and foreign_exr's.
void read_records(const fs::path& file, std::string_view) {
  if (!unless_refused([&] { return io::holds_exr_records(file); }).value_or(false)) return;
  const auto entries = unless_refused([&] { return io::list_scans(file); });
  if (!entries) return;
  io::ScanEntry entry = entries->at(0);
  auto strict = unless_refused([&] { return io::read_scan(file, entry); });
  entry.salvage = true;
  auto salvaged = unless_refused([&] { return io::read_scan(file, entry); });
  check_salvage(strict, salvaged);
  entry.salvage = !strict;
  check_stream(file, entry, strict ? std::move(strict) : std::move(salvaged));
}

Seeds samples(const fs::path& scratch) {
  Seeds seeds;
  for (const int rows : {1, 70}) {
    RangeImage image = make_range_image(rows, 6);
    for (std::size_t i = 0; i < image.elevation_rad.size(); ++i)
      image.elevation_rad[i] = 0.5 - 0.01 * double(i);
    for (std::size_t i = 0; i < image.azimuth_rad.size(); ++i) image.azimuth_rad[i] = 0.0625 * double(i);
    std::vector<std::uint32_t> label(image.count());
    std::vector<std::uint8_t> discarded(image.count());
    for (std::size_t i = 0; i < image.count(); ++i) {
      image.mask[i] = static_cast<std::uint8_t>(i % 3 != 0);
      image.x[i] = 2 + 0.001f * static_cast<float>(i % 7);
      image.y[i] = image.z[i] = 0.5f;
      label[i] = static_cast<std::uint32_t>(i % 3);
      discarded[i] = i % 2 == 0;
    }
    std::vector<Supercluster> planes(2);
    planes[0].plane = {{-1, 0, 0}, -2};
    io::SampleFileInput input{image, planes, label, discarded};
    if (rows == 70) {
      image.intensity.assign(image.count(), 0.25f);
      image.rgb.assign(image.count(), {1, 128, 255});
      input.extra = {{1, 2, 3}};
      input.world_from_scan = Pose{};
    }
    io::write_sample_file(scratch / "seed.hsf", input);
    seeds.push_back(file_bytes(scratch / "seed.hsf"));
  }
  return seeds;
}

// A file whose blocks have the checksums they should: else mutations would only test these.
void read_sealed(const fs::path& file, std::string_view bytes) {
  std::string sealed(bytes);
  for (std::size_t at = 12; at + 16 <= sealed.size();) {
    std::uint64_t size = 0;
    std::memcpy(&size, sealed.data() + at, sizeof size);
    if (size > sealed.size() - at - 16) break;
    const std::uint64_t sum = XXH3_64bits(sealed.data() + at + 16, size);
    std::memcpy(sealed.data() + at + 8, &sum, sizeof sum);
    at += 16 + size;
  }
  read_both_ways(file, bytes);
  if (sealed == bytes) return;
  const fs::path twin = fs::path(file).replace_extension(".sealed.hsf");
  static std::optional<FileInMemory> memory;  // of one folder at a time; disks are slow
  if (!fs::is_symlink(twin)) memory.emplace(twin);
  memory->write(sealed);
  read_both_ways(twin, sealed);
}

}  // namespace

std::vector<FuzzTarget> scan_fuzz_targets() {
  return {{"ptx", "scan.ptx", 400, ptx, read_both_ways},
          {"pts", "scan.pts", 200, pts, read_both_ways},
          {"xyz", "scan.xyz", 200, xyz, read_both_ways},
          {"ply_ascii", "scan.ply", 512, ply_ascii, read_both_ways},
          {"ply_binary", "scan.ply", 512, ply_binary, read_both_ways},
          {"pcd_ascii", "scan.pcd", 512, pcd_ascii, read_both_ways},
          {"pcd_binary", "scan.pcd", 512, pcd_binary, read_both_ways},
          {"pcd_compressed", "scan.pcd", 512, pcd_compressed, read_both_ways},
          {"las", "scan.las", 800, las, read_las_both_ways},
          {"foreign_exr", "scan.exr", 2048, foreign_exr, read_both_ways},
          {"range_exr", "scan.exr", 3200, range_exr, read_both_ways},
          {"records_exr", "scan.exr", 6144, records_exr, read_records},
          {"samples", "scan.hsf", 3200, samples, read_sealed}};
}

}  // namespace hybrid::testing
