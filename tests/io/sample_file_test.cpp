#include "io/samples/sample_file.hpp"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <random>

#include "core/parallel.hpp"
#include "io/files.hpp"
#include "io/read_scan.hpp"
#include "io/samples/columns.hpp"
#include "io/samples/number_code.hpp"
#include "io/samples/sample_header.hpp"
#include "io/scan_samples.hpp"

namespace hybrid::testing::sample_file_test {
namespace {

constexpr int kRows = 150, kCols = 90;  // three bands, the last of 22 rows

// A corner of two walls with 1 mm of noise along the rays, holes, and clutter that no plane explains.
struct Corner {
  RangeImage image = make_range_image(kRows, kCols);
  std::vector<Supercluster> planes{2};
  std::vector<std::uint32_t> label = std::vector<std::uint32_t>(image.count());
  std::vector<std::uint8_t> discarded = std::vector<std::uint8_t>(image.count());
  Scan scan;  // when georeferenced

  // Coordinates are multiples of the step; 0: any float.
  explicit Corner(double step_m, double deviation_rad = 0) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    planes[0].plane = {{-1, 0, 0}, -4};
    planes[1].plane = {{0, -1, 0}, -3};
    for (int row = 0; row < kRows; ++row)
      image.elevation_rad[static_cast<std::size_t>(row)] = 0.4 - 0.005 * row;
    for (int col = 0; col < kCols; ++col) image.azimuth_rad[static_cast<std::size_t>(col)] = 0.3 + 0.01 * col;
    image.intensity.assign(image.count(), 0);
    image.rgb.assign(image.count(), {});
    for (int row = 0; row < kRows; ++row)
      for (int col = 0; col < kCols; ++col) {
        const std::size_t node = image.index(row, col);
        if ((row * 7 + col * 3) % 31 == 0) continue;
        const double e = image.elevation_rad[static_cast<std::size_t>(row)] + deviation_rad * normal(random),
                     a = image.azimuth_rad[static_cast<std::size_t>(col)] + deviation_rad * normal(random);
        const Vec3 ray(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        const double wall = std::min(4 / ray.x(), 3 / ray.y());
        const bool clutter = row > 40 && row < 60 && col > 20 && col < 40;
        const double range = clutter ? 2 + 0.3 * normal(random) : wall + 0.001 * normal(random);
        for (int axis = 0; axis < 3; ++axis) {
          const double value = range * ray[axis];
          (axis == 0   ? image.x
           : axis == 1 ? image.y
                       : image.z)[node] =
              step_m > 0 ? static_cast<float>(step_m * static_cast<double>(std::llround(value / step_m)))
                         : static_cast<float>(value);
        }
        image.mask[node] = kMeasured;
        image.source[node] = static_cast<std::uint32_t>(image.count() - 1 - node);
        image.intensity[node] = static_cast<float>((100 + (row + 2 * col) % 50) / 255.0);
        image.rgb[node] = {static_cast<std::uint8_t>(row), static_cast<std::uint8_t>(3 * col), 7};
        if (clutter) continue;
        label[node] = 4 / ray.x() < 3 / ray.y() ? 1 : 2;
        discarded[node] = 1;
      }
  }
  io::SampleFileInput input() const { return {image, planes, label, discarded}; }
};

bool same(float a, float b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Every node's sample, bit for bit; no-returns elsewhere.
void expect_exact(const Corner& corner, const Scan& scan) {
  ASSERT_GE(scan.points.size(), corner.image.count());
  const auto& image = corner.image;
  for (std::size_t node = 0; node < image.count(); ++node) {
    if (image.mask[node] != kMeasured) {
      ASSERT_TRUE(std::isnan(scan.points[node][0])) << node;
      continue;
    }
    ASSERT_TRUE(same(scan.points[node][0], image.x[node]) && same(scan.points[node][1], image.y[node]) &&
                same(scan.points[node][2], image.z[node]))
        << node;
    ASSERT_TRUE(same(scan.intensity[node], image.intensity[node])) << node;
    ASSERT_EQ(scan.rgb[node], image.rgb[node]) << node;
  }
}

TEST(SampleFile, gives_every_sample_back_bit_for_bit) {
  const TemporaryFolder folder;
  for (const double step_m : {0.001, 0.0001, 0.0})
    for (const double deviation_rad : {0.0, 0.001}) {
      Corner corner(step_m, deviation_rad);
      const auto file = folder.path() / "samples.hsf";
      const auto size = io::write_sample_file(file, corner.input());
      SCOPED_TRACE(::testing::Message() << step_m << " m, " << deviation_rad << " rad");
      expect_exact(corner, io::read_scan(file, std::size_t{0}));
      EXPECT_EQ(size.bytes, std::filesystem::file_size(file));
      EXPECT_EQ(size.samples, std::ranges::count(corner.image.mask, kMeasured));
      EXPECT_EQ(size.discarded, std::ranges::count(corner.discarded, 1));
    }
}

// Noise of 1 mm has 5.4 bits of entropy at steps of 0.1 mm; the two other coordinates and the label follow.
TEST(SampleFile, a_discarded_point_on_the_grid_takes_little_more_than_its_noise) {
  const TemporaryFolder folder;
  const Corner corner(0.0001);
  const auto size = io::write_sample_file(folder.path() / "samples.hsf", corner.input());
  EXPECT_LT(8.0 * static_cast<double>(size.discarded_bytes) / static_cast<double>(size.discarded), 5.4 + 6);
}

TEST(SampleFile, floats_that_are_no_multiples_keep_their_bits) {
  const TemporaryFolder folder;
  Corner corner(0.001);
  std::size_t node = 100;
  for (const float odd : {-0.0f, 1e-30f, 3e38f, 0.1f + 1e-7f, std::numeric_limits<float>::denorm_min()}) {
    ASSERT_EQ(corner.image.mask[node], kMeasured);
    corner.image.z[node] = corner.image.intensity[node] = odd;
    ++node;
  }
  io::write_sample_file(folder.path() / "samples.hsf", corner.input());
  expect_exact(corner, io::read_sample_file(folder.path() / "samples.hsf"));
}

TEST(SampleFile, planes_that_say_nothing_of_the_range_cost_bytes_only) {
  const TemporaryFolder folder;
  Corner corner(0.001);
  corner.planes[0].plane = {{0, 0, 1}, 0};       // through the scanner
  corner.planes[1].plane = {{1e-200, 0, 0}, 1};  // not finite along most rays
  io::write_sample_file(folder.path() / "samples.hsf", corner.input());
  expect_exact(corner, io::read_sample_file(folder.path() / "samples.hsf"));
}

TEST(SampleFile, georeferenced_points_and_samples_beside_the_grid_are_kept) {
  const TemporaryFolder folder;
  Corner corner(0.001);
  corner.scan.origin = {530000.25, -180000.5, 12};
  corner.scan.points.assign(corner.image.count(), {});
  for (std::size_t node = 0; node < corner.image.count(); ++node)
    if (corner.image.mask[node] == kMeasured)
      corner.scan.points[corner.image.source[node]] = {corner.image.x[node] - 1.5f,
                                                       corner.image.y[node] + 0.125f, corner.image.z[node]};
  auto input = corner.input();
  input.georeferenced = &corner.scan;
  input.extra = {{530001.5, -179999.25, 13}, {530000.25, -180000.5, 12.0625}};
  input.extra_intensity = {0.5f, 0.25f};
  input.crs = "EPSG:27700";
  input.world_from_scan = Pose{.translation = {1, 2, 3}};
  io::write_sample_file(folder.path() / "samples.hsf", input);
  const Scan scan = io::read_sample_file(folder.path() / "samples.hsf");
  EXPECT_EQ(scan.origin, corner.scan.origin);
  EXPECT_EQ(scan.crs, "EPSG:27700");
  EXPECT_EQ(scan.world_from_scan.value().translation, Vec3(1, 2, 3));
  EXPECT_EQ(scan.range_grid.value().azimuth_rad, corner.image.azimuth_rad);
  for (std::size_t node = 0; node < corner.image.count(); ++node)
    if (corner.image.mask[node] == kMeasured) {
      ASSERT_EQ(scan.points[node], corner.scan.points[corner.image.source[node]]) << node;
    }
  ASSERT_EQ(scan.points.size(), corner.image.count() + 2);
  EXPECT_EQ(scan.points.back(), (std::array<float, 3>{0, 0, 0.0625f}));
  EXPECT_EQ(scan.intensity.back(), 0.25f);
}

TEST(SampleFile, the_same_bytes_for_any_number_of_threads) {
  const TemporaryFolder folder;
  const Corner corner(0.0001, 0.001);
  std::string first;
  const int threads = thread_count();
  for (const int count : {1, 2, 5}) {
    set_thread_count(count);
    io::write_sample_file(folder.path() / "samples.hsf", corner.input());
    const std::string bytes = bytes_of(folder.path() / "samples.hsf");
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first) << count;
  }
  set_thread_count(threads);
}

TEST(SampleFile, every_damaged_byte_and_every_cut_is_found) {
  const TemporaryFolder folder;
  io::write_sample_file(folder.path() / "samples.hsf", Corner(0.001).input());
  const std::string whole = bytes_of(folder.path() / "samples.hsf");
  for (std::size_t at = 0; at < whole.size(); at += 1 + at / 64) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const auto file = folder.write("damaged.hsf", damaged);
    const auto message = error_of(ErrorKind::input, [&] { io::read_sample_file(file); });
    EXPECT_TRUE(holds(message, file.string())) << at;
    const auto cut = folder.write("cut.hsf", whole.substr(0, at));
    error_of(ErrorKind::input, [&] { io::read_sample_file(cut); });
  }
  error_of(ErrorKind::input, [&] { io::read_sample_file(folder.write("longer.hsf", whole + "x")); });
}

std::string block(const std::string& bytes) {
  return raw(static_cast<std::uint64_t>(bytes.size())) +
         raw(static_cast<std::uint64_t>(XXH3_64bits(bytes.data(), bytes.size()))) + bytes;
}

// Files whose checksums are right and whose content lies.
TEST(SampleFile, lies_under_a_right_checksum_are_found) {
  const TemporaryFolder folder;
  const auto read = [&](const io::SampleHeader& header, const std::string& band) {
    const auto file =
        folder.write("lie.hsf", "HYBRIDSF" + raw(std::uint32_t{1}) + block(io::header_bytes(header)) +
                                    block(band) + block(io::compress("")));
    return error_of(ErrorKind::input, [&] { io::read_sample_file(file); });
  };
  io::SampleHeader header;
  header.rows = 2;
  header.cols = 3;
  header.elevation_rad = {0.1, 0};
  header.azimuth_rad = {0, 0.1, 0.2};
  header.elevation_ray.assign(2, {1, 0});
  header.azimuth_ray.assign(3, {1, 0});
  header.planes = {{{-1, 0, 0}, -2}};
  const std::vector<std::uint32_t> one = {0};
  const auto columns = [](const std::vector<std::vector<std::uint32_t>>& list) {
    std::string bytes;
    for (const auto& column : list) io::append_column(column, bytes);
    return bytes;
  };
  // Label 2 of one plane; a state that is none; too many values; a missing column.
  EXPECT_TRUE(holds(read(header, columns({{1, 0, 0, 0, 0, 0}, {io::fold(2)}, one, one, one, {}, {}, {}})),
                    "expected a plane from 1 to 1, found 2"));
  EXPECT_TRUE(
      holds(read(header, columns({{9, 0, 0, 0, 0, 0}, {}, {}, {}, {}, {}, {}, {}})), "states 0 to 2"));
  EXPECT_TRUE(holds(read(header, columns({{1, 0, 0, 0, 0, 0, 0}, {}, {}, {}, {}, {}, {}, {}})), "damaged"));
  EXPECT_TRUE(
      holds(read(header, columns({{1, 0, 0, 0, 0, 0}, {io::fold(1)}, one, one})), "expected a column"));
  EXPECT_TRUE(holds(read(header, columns({{1, 0, 0, 0, 0, 0}, {io::fold(1)}, one, one, one, {}, {}, {}})),
                    "expected 0 samples, as its header says, found 1"));
  header.rows = 3;
  EXPECT_TRUE(holds(read(header, ""), "an angle per row and column of 3 x 3"));
  header.rows = 0;
  EXPECT_TRUE(holds(read(header, ""), "0 x 3"));
  header.rows = 2;
  header.extra = std::uint64_t{1} << 60;
  EXPECT_TRUE(holds(read(header, ""), "samples beside the grid"));
}

TEST(SampleColumns, any_numbers_come_back) {
  std::vector<std::uint32_t> values = {0, 1, 255, 256, 0xffffffffu, 0x80000000u, 77};
  std::string bytes;
  for (const std::uint32_t value : values) EXPECT_EQ(io::unfold(io::fold(value)), value);
  const std::size_t taken = io::append_column(values, bytes);
  EXPECT_EQ(taken, bytes.size());
  io::append_column({}, bytes);
  io::ColumnReader reader(bytes, "here");
  EXPECT_EQ(reader.take(values.size()), values);
  EXPECT_TRUE(reader.take(0).empty());
  reader.finish();
}

TEST(SampleNumberCode, neighbouring_codes_are_neighbouring_floats) {
  const io::NumberCode bits;
  float before = -1e-38f;
  for (int i = 0; i < 100'000; ++i) {
    const float next = std::nextafter(before, 1.0f);
    if (before != 0 || std::signbit(before)) {
      ASSERT_EQ(bits.decode(bits.encode(before)), before);
      ASSERT_LT(bits.encode(before), bits.encode(next));
    }
    before = next;
  }
  EXPECT_TRUE(io::NumberCode(0.001).holds(1.234f));
  EXPECT_FALSE(io::NumberCode(0.001).holds(1.2341f));
  EXPECT_FALSE(io::NumberCode(0.001).holds(3e38f));
}

}  // namespace
}  // namespace hybrid::testing::sample_file_test
