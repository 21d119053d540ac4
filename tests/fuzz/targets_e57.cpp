// E57 as a whole file, its description alone, and its bit decoder alone.
#include <atomic>

#include "fuzz/check_scan.hpp"
#include "fuzz/check_stream.hpp"
#include "fuzz/targets.hpp"
#include "io/e57/bit_decoder.hpp"
#include "io/e57/e57_source.hpp"
#include "io/e57/e57_xml.hpp"
#include "io/e57/streams.hpp"
#include "io/e57_scans.hpp"
#include "io/reader_rows.hpp"
#include "io/scan_samples.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;
using Seeds = std::vector<std::string>;

std::vector<std::optional<Scan>> read_all(const fs::path& path, bool salvage, bool exact) {
  std::vector<std::optional<Scan>> scans;
  unless_refused([&] {
    const io::E57File file(path, {.salvage = salvage});
    for (std::size_t i = 0; i < file.contents().scans.size(); ++i)
      scans.push_back(unless_refused([&] { return io::read_e57(file, i, exact); }));
    for (std::size_t i = 0; i < scans.size() && !salvage; ++i)
      unless_refused([&] {
        if (const auto grid = io::read_e57_grid(file, i)) check_grid(*grid, scans[i]);
        return true;
      });
    for (const io::E57Image& image : file.contents().images) {
      unless_refused([&] { return file.read_blob(image.picture, "picture"); });
      if (image.mask) unless_refused([&] { return file.read_blob(*image.mask, "mask"); });
    }
    return true;
  });
  return scans;
}

// What is left of a file, as it would be copied.
void read_copy(const fs::path& path) {
  unless_refused([&] {
    const io::E57FileSource source(path, {}, {.salvage = true});
    for (std::size_t part = 0; part < source.outline().parts.size(); ++part) {
      if (source.outline().parts[part].blob) {
        source.blob(part);
        continue;
      }
      const io::E57Table& table = source.table(part);
      const auto reader = source.open(part);
      expect(reader->count() == table.count, "as many records as the description says");
      std::atomic<std::uint64_t> read{0};
      reader->read(io::all_fields(table), 0, reader->count(), [&](const io::E57Records& records) {
        expect(records.lost.empty(), "only records that can be read");
        read += records.count;
      });
      expect(read == table.count, "all of them");
    }
    return true;
  });
}

// In salvage a scan whose description makes no sense is left out, so that numbers differ only then. Exact
// coordinates come on top: what is compared is the same with and without them.
void read_e57_both_ways(const fs::path& file, std::string_view) {
  auto strict = read_all(file, false, true);
  const bool refused = strict.empty() || std::ranges::any_of(strict, [](const auto& scan) { return !scan; });
  auto salvaged = read_all(file, true, refused);
  for (std::size_t i = 0; i < strict.size(); ++i)
    check_salvage(strict[i], i < salvaged.size() ? salvaged[i] : std::nullopt);
  for (const auto& scan : salvaged) check_salvage({}, scan);
  if (refused) {
    read_copy(file);
    const auto entries =
        unless_refused([&] { return io::list_scans(file, {.salvage = true, .exact = true}); });
    for (std::size_t i = 0; i < salvaged.size() && entries; ++i)
      check_stream(file, entries->at(i), std::move(salvaged[i]));
  }
  if (strict.empty()) return;
  const std::vector<io::ScanEntry> entries = io::list_scans(file, {.exact = true});
  expect(entries.size() == strict.size(), "an entry per scan");
  for (std::size_t i = 0; i < strict.size(); ++i) check_stream(file, entries[i], std::move(strict[i]));
}

std::string written(const fs::path& file, const io::E57WriterOptions& options,
                    const std::vector<std::pair<io::E57Scan, std::size_t>>& scans, bool image = false) {
  io::E57Writer writer(file, options);
  for (const auto& [scan, count] : scans) {
    writer.begin_scan(scan);
    writer.write(random_columns(scan.points.fields, count).records());
    writer.end_scan();
  }
  if (image)
    writer.add_image({.name = "north",
                      .world_from_image = Pose{},
                      .projection = io::E57Projection::pinhole,
                      .width = 4,
                      .height = 3,
                      .focal_length_m = 0.05,
                      .pixel_width = 1e-5,
                      .pixel_height = 1e-5},
                     std::string(40, 'p'), std::string(30, 'm'));
  writer.close();
  return file_bytes(file);
}

io::E57Scan scan_of(std::vector<io::E57Field> fields) {
  io::E57Scan scan{.name = "hall"};
  scan.points.fields = std::move(fields);
  return scan;
}

Seeds files(const fs::path& scratch) {
  const auto file = scratch / "seed.e57";
  const auto three = [](const char* x, const char* y, const char* z, const auto& field) {
    return std::vector{field(x), field(y), field(z)};
  };
  const auto cartesian = [&](const auto& field) {
    return three("cartesianX", "cartesianY", "cartesianZ", field);
  };
  io::E57Scan reals = scan_of(cartesian([](const char* name) { return real_field(name); }));
  io::E57Scan doubles = scan_of(three("sphericalRange", "sphericalAzimuth", "sphericalElevation",
                                      [](auto name) { return real_field(name, io::E57Type::double_real); }));
  doubles.points.fields.push_back(integer_field("sphericalInvalidState", 0, 2));
  io::E57Scan grid =
      scan_of(cartesian([](const char* name) { return scaled_field(name, -70'000, 70'000, 1e-3, 0.5); }));
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
    grid.points.fields.push_back(integer_field(name, 0, 255));
  for (const char* name : {"rowIndex", "columnIndex"})
    grid.points.fields.push_back(integer_field(name, 0, 7));
  grid.points.fields.push_back(integer_field("returnIndex", 0, 1));
  grid.points.fields.push_back(integer_field("intensity", 0, 4095));
  grid.points.fields.push_back(integer_field("isIntensityInvalid", 0, 1));
  grid.intensity = io::E57Limits{0, 4095};
  grid.rows = grid.columns = io::E57Limits{0, 7};
  grid.world_from_scan = Pose{1, Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {1, 2, 3}};
  io::E57Scan same = scan_of(cartesian([](const char* name) { return integer_field(name, 7, 7); }));
  io::E57Scan wide =
      scan_of(cartesian([](const char* name) { return scaled_field(name, INT64_MIN, INT64_MAX, 1e-15); }));
  wide.points.fields.push_back(real_field("intensity", io::E57Type::double_real));
  wide.points.fields.push_back(real_field("nor:normalX"));
  return {written(file, {}, {{reals, 9}}),
          written(file, {.extensions = {{"nor", "http://x"}}, .records_per_packet = 3},
                  {{doubles, 8}, {wide, 5}}),
          written(file, {.coordinate_system = "LOCAL", .records_per_packet = 10}, {{grid, 40}}, true),
          written(file, {}, {{same, 4}, {reals, 0}})};
}

Seeds descriptions(const fs::path& scratch) {
  Seeds seeds;
  for (const std::string& file : files(scratch)) {
    const std::string content = without_checksums(file);
    const std::size_t start = content.find("<?xml");
    seeds.push_back(content.substr(start, content.find_last_not_of('\0') + 1 - start));
  }
  seeds.emplace_back("<e57Root><data3D><a><points/></a></data3D></e57Root>");
  return seeds;
}

void parse_both_ways(const fs::path&, std::string_view bytes) {
  const std::string text(bytes);
  const auto strict = unless_refused([&] { return io::parse_e57_xml("scan.e57", text, false); });
  const auto salvaged = unless_refused([&] { return io::parse_e57_xml("scan.e57", text, true); });
  if (!strict) return;
  expect(salvaged.has_value() && salvaged->scans.size() == strict->scans.size() &&
             salvaged->images.size() == strict->images.size(),
         "salvage to read what is intact");
  for (std::size_t i = 0; i < strict->scans.size(); ++i)
    expect(strict->scans[i].points.fields == salvaged->scans[i].points.fields, "the same fields");
}

// Width, first bit, minimum, the cut between two parts, then the stream. Every value is compared with one
// put together bit by bit.
constexpr std::size_t kBitHead = 12;

Seeds streams(const fs::path&) {
  Seeds seeds;
  for (const int width : {1, 7, 8, 13, 24, 31, 33, 57, 63, 64})
    seeds.push_back(std::string{static_cast<char>(width - 1), static_cast<char>(width % 5), '\0',
                                static_cast<char>(width)} +
                    raw(std::int64_t{-5}) + "The quick brown fox jumps over the lazy dog: 0123456789");
  return seeds;
}

void decode_bits(const fs::path&, std::string_view bytes) {
  if (bytes.size() < kBitHead + 1) return;
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i]));
  };
  const int width = 1 + static_cast<int>(byte(0) % 64);
  std::int64_t minimum;
  std::memcpy(&minimum, bytes.data() + 4, 8);
  const std::string stream(bytes.substr(kBitHead));
  const std::uint64_t step = static_cast<std::uint64_t>(width);
  const std::uint64_t first_value = byte(1) % 32, held = 8 * stream.size() / step;
  const std::uint64_t count = held > first_value ? held - first_value : 0;
  const auto right = [&](std::uint64_t value) {
    std::uint64_t bits = 0;
    for (std::uint64_t i = 0; i < step; ++i) {
      const std::uint64_t at = value * step + i;
      bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(stream[at / 8]) >> at % 8 & 1) << i;
    }
    return static_cast<std::int64_t>(bits + static_cast<std::uint64_t>(minimum));
  };
  // On the heap with no more room than promised, so that a read beyond is seen.
  std::vector<char> slack(stream.begin(), stream.end());
  slack.resize(stream.size() + io::kBitSlack_bytes);
  slack.shrink_to_fit();
  std::vector<std::int64_t> values(count);
  io::unpack_bits(slack.data(), first_value * step, width, minimum, values);
  for (std::uint64_t i = 0; i < count; ++i) expect(values[i] == right(first_value + i), "the right value");

  // The same in two parts with a gap of some bytes: values are right or lost.
  const std::uint64_t cut = byte(3) % (stream.size() + 1), gap = std::min(byte(2) % 8, stream.size() - cut);
  io::E57Field field{.name = "x", .minimum = minimum, .maximum = minimum};
  const std::uint64_t most = width == 64 ? ~0ull : (1ull << width) - 1;
  if (static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) -
          static_cast<std::uint64_t>(minimum) <
      most)
    field.minimum = std::numeric_limits<std::int64_t>::min();
  field.maximum = static_cast<std::int64_t>(static_cast<std::uint64_t>(field.minimum) + most);
  expect(field.bits() == width, "the width of the field");
  io::StreamParts parts;
  if (cut > 0) parts.push_back({0, slack.data(), cut});
  if (cut + gap < stream.size())
    parts.push_back({cut + gap, slack.data() + cut + gap, stream.size() - cut - gap});
  std::vector<io::E57Records::Lost> lost;
  io::decode(field, parts, first_value, std::span(values), lost);
  std::vector<char> is_lost(count, 0);
  for (const auto& range : lost)
    for (std::uint64_t i = range.first; i < range.end; ++i) is_lost.at(i - first_value) = 1;
  const std::uint64_t shift = static_cast<std::uint64_t>(field.minimum) - static_cast<std::uint64_t>(minimum);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t begin = (first_value + i) * step / 8, end = ((first_value + i + 1) * step + 7) / 8;
    expect(is_lost[i] == (gap > 0 && begin < cut + gap && end > cut), "lost where the gap is");
    const auto expected =
        static_cast<std::int64_t>(static_cast<std::uint64_t>(right(first_value + i)) + shift);
    expect(values[i] == (is_lost[i] ? 0 : expected), "the right value beside a gap");
  }
}

}  // namespace

std::vector<FuzzTarget> e57_fuzz_targets() {
  return {{"e57", "scan.e57", 6144, files, read_e57_both_ways, true},
          {"e57_xml", "", 6144, descriptions, parse_both_ways},
          {"e57_bits", "", 192, streams, decode_bits}};
}

}  // namespace hybrid::testing
