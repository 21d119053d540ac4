// Samples put into their nodes while they are decoded give the range image that a list of samples gives.
#include "io/grid_scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "io/e57_scans.hpp"
#include "io/exr/range_exr.hpp"
#include "io/files.hpp"
#include "io/foreign_exr.hpp"
#include "io/output.hpp"
#include "io/read_scan.hpp"
#include "stages/scan/organised_grid.hpp"

namespace hybrid::testing::grid_scan_test {
namespace {
namespace fs = std::filesystem;

constexpr int kRows = 121, kCols = 580;  // more than one strip of GridScatter

struct Case {
  const char* name;
  bool rows_rise = true, cols_turn_left = true, row_by_row = false, shuffled = false;
  double kept = 1;  // share of the nodes that have a record
  int spare = 0;    // rows and columns that the bounds declare and no record has
  double half_width_rad = 3.1;
  bool intensity = true, colour = false, states = true, spherical = false;
};

const Case kCases[] = {
    {.name = "every node, columns"},
    {.name = "downwards, clockwise", .rows_rise = false, .cols_turn_left = false},
    {.name = "row by row", .row_by_row = true},
    {.name = "some nodes", .kept = 0.9, .colour = true},
    {.name = "some nodes, clockwise", .cols_turn_left = false, .kept = 0.7, .intensity = false},
    {.name = "declared larger", .rows_rise = false, .kept = 0.8, .spare = 9},
    {.name = "any order", .shuffled = true, .kept = 0.9, .colour = true, .states = false},
    {.name = "a small part of the turn", .half_width_rad = 0.2},
    {.name = "angles", .kept = 0.9, .spherical = true},
};

struct Sample {
  int row, col;
  double range, elevation, azimuth;
};

std::vector<Sample> samples_of(const Case& c) {
  std::mt19937 random(3);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Sample> samples;
  for (int slow = 0; slow < (c.row_by_row ? kRows : kCols); ++slow)
    for (int fast = 0; fast < (c.row_by_row ? kCols : kRows); ++fast) {
      const int row = c.row_by_row ? slow : fast, col = c.row_by_row ? fast : slow;
      if (c.kept < 1 && share() > c.kept) continue;
      const double up = (row - kRows / 2) * 1.2 / kRows, left = (2.0 * col / kCols - 1) * c.half_width_rad;
      samples.push_back({row, col, 2 + 8 * share(), c.rows_rise ? up : -up, c.cols_turn_left ? left : -left});
    }
  if (c.shuffled) std::shuffle(samples.begin(), samples.end(), random);
  return samples;
}

std::filesystem::path write_case(const TemporaryFolder& folder, const Case& c,
                                 const std::vector<Sample>& samples) {
  io::E57Scan scan{.guid = "{s}", .name = "scan"};
  auto& fields = scan.points.fields;
  E57Columns columns;
  const auto add = [&](const io::E57Field& field, const auto& value) {
    fields.push_back(field);
    auto& whole = columns.integers.emplace_back();
    auto& real = columns.reals.emplace_back();
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (field.is_integer())
        whole.push_back(static_cast<std::int64_t>(value(samples[i], i)));
      else
        real.push_back(static_cast<double>(static_cast<float>(value(samples[i], i))));
  };
  if (c.spherical) {
    add(real_field("sphericalRange"), [](const Sample& s, std::size_t) { return s.range; });
    add(real_field("sphericalAzimuth"), [](const Sample& s, std::size_t) { return s.azimuth; });
    add(real_field("sphericalElevation"), [](const Sample& s, std::size_t) { return s.elevation; });
  } else {
    const auto axis = [](int k) {
      return [k](const Sample& s, std::size_t) {
        const double level = s.range * std::cos(s.elevation);
        return std::round(1e4 * (k == 0   ? level * std::cos(s.azimuth)
                                 : k == 1 ? level * std::sin(s.azimuth)
                                          : s.range * std::sin(s.elevation)));
      };
    };
    add(scaled_field("cartesianX", -200'000, 200'000, 1e-4), axis(0));
    add(scaled_field("cartesianY", -200'000, 200'000, 1e-4), axis(1));
    add(scaled_field("cartesianZ", -200'000, 200'000, 1e-4), axis(2));
  }
  if (c.states)
    add(integer_field(c.spherical ? "sphericalInvalidState" : "cartesianInvalidState", 0, 2),
        [](const Sample&, std::size_t i) { return i % 17 == 3 ? 2 : 0; });
  add(integer_field("rowIndex", 0, 4000), [&](const Sample& s, std::size_t) { return s.row + c.spare; });
  add(integer_field("columnIndex", 0, 4000), [&](const Sample& s, std::size_t) { return s.col + c.spare; });
  scan.rows = io::E57Limits{0, static_cast<double>(kRows - 1 + 2 * c.spare)};
  scan.columns = io::E57Limits{0, static_cast<double>(kCols - 1 + 2 * c.spare)};
  if (c.intensity) {
    add(real_field("intensity"),
        [](const Sample&, std::size_t i) { return 0.001 * static_cast<double>(i % 999); });
    scan.intensity = io::E57Limits{0, 1};
  }
  if (c.colour) {
    for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
      add(integer_field(name, 0, 255), [&](const Sample&, std::size_t i) { return (i + name[5]) % 256; });
    scan.colour.emplace().fill({0, 255});
  }
  const auto file = folder.path() / "in.e57";
  write_e57(file, scan, columns);
  return file;
}

io::ScanEntry entry_of(const std::filesystem::path& file) {
  return io::list_scans(file).at(0);
}

template <typename T>
void expect_same(const std::vector<T>& a, const std::vector<T>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if constexpr (std::is_floating_point_v<T>)
      if (std::isnan(a[i]) && std::isnan(b[i])) continue;
    ASSERT_EQ(a[i], b[i]) << what << ' ' << i;
  }
}

void expect_same(const RangeImage& a, const RangeImage& b) {
  ASSERT_EQ(a.rows, b.rows);
  ASSERT_EQ(a.cols, b.cols);
  EXPECT_EQ(a.wraps, b.wraps);
  expect_same(a.elevation_rad, b.elevation_rad, "elevation");
  expect_same(a.azimuth_rad, b.azimuth_rad, "azimuth");
  expect_same(a.range_m, b.range_m, "range");
  expect_same(a.x, b.x, "x");
  expect_same(a.y, b.y, "y");
  expect_same(a.z, b.z, "z");
  expect_same(a.mask, b.mask, "mask");
  expect_same(a.source, b.source, "source");
  expect_same(a.intensity, b.intensity, "intensity");
  expect_same(a.rgb, b.rgb, "rgb");
  expect_same(a.extra, b.extra, "extra");
}

}  // namespace

TEST(GridScan, IsTheRangeImageOfTheListOfSamples) {
  const TemporaryFolder folder;
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    const auto samples = samples_of(c);
    const auto file = write_case(folder, c, samples);
    const Scan scan = io::read_scan(file, 0);
    const RangeImage expected = stages::arrange_grid(scan);
    auto grid = io::read_grid_scan(file, entry_of(file));
    ASSERT_TRUE(grid);
    stages::orient_grid(grid->image, grid->rows_reversed, grid->cols_reversed);
    expect_same(expected, grid->image);
    EXPECT_EQ(grid->samples, samples.size());
    EXPECT_EQ(grid->returns, static_cast<std::uint64_t>(std::ranges::count_if(
                                 scan.points, [](const auto& p) { return std::isfinite(p[0]); })));
    EXPECT_EQ(grid->scan.notes, scan.notes);
    EXPECT_EQ(grid->scan.name, scan.name);
    EXPECT_EQ(grid->scan.grid_rows, scan.grid_rows);
    EXPECT_EQ(grid->scan.grid_cols, scan.grid_cols);
    EXPECT_EQ(grid->scan.intensity_limits, scan.intensity_limits);
  }
}

// Which way rows and columns go is guessed from the first records: a wrong guess changes nothing.
TEST(GridScan, IsTheSameHoweverItWasTurnedFirst) {
  const TemporaryFolder folder;
  const Case c{.name = "turned", .kept = 0.9, .colour = true};
  const auto file = write_case(folder, c, samples_of(c));
  const RangeImage expected = stages::arrange_grid(io::read_scan(file, 0));
  for (const bool rows : {false, true})
    for (const bool cols : {false, true}) {
      auto grid = io::read_grid_scan(file, entry_of(file));
      ASSERT_TRUE(grid);
      stages::orient_grid(grid->image, grid->rows_reversed, grid->cols_reversed);
      RangeImage& image = grid->image;
      const auto turn = [&](auto& values) {
        for (int row = 0; rows && row < image.rows / 2; ++row)
          for (int col = 0; col < image.cols; ++col)
            std::swap(values[image.index(row, col)], values[image.index(image.rows - 1 - row, col)]);
        for (int row = 0; cols && row < image.rows; ++row)
          for (int col = 0; col < image.cols / 2; ++col)
            std::swap(values[image.index(row, col)], values[image.index(row, image.cols - 1 - col)]);
      };
      turn(image.range_m), turn(image.x), turn(image.y), turn(image.z), turn(image.mask);
      turn(image.source), turn(image.intensity), turn(image.rgb);
      stages::orient_grid(image, grid->rows_reversed != rows, grid->cols_reversed != cols);
      expect_same(expected, image);
    }
}

// Interpolated nodes, empty ones, and one that the mask calls measured and that has no place.
RangeImage image_of_states(bool attributes) {
  RangeImage image = make_range_image(kRows * 3, kCols);  // more than a band
  for (int row = 0; row < image.rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = 0.6 - 0.003 * row;
  for (int col = 0; col < kCols; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = 2 * std::numbers::pi * col / kCols;
  image.wraps = true;
  std::mt19937 random(6);
  if (attributes) {
    image.intensity.assign(image.count(), 0);
    image.rgb.assign(image.count(), {});
  }
  for (std::size_t i = 0; i < image.count(); ++i) {
    image.mask[i] = static_cast<std::uint8_t>(random() % 7 < 3 ? random() % 3 : 1);
    if (image.mask[i] == kEmpty) continue;
    for (float* axis : {&image.x[i], &image.y[i], &image.z[i]})
      *axis = static_cast<float>(random() % 1'000'000) / 7919 - 60;
    image.range_m[i] = static_cast<float>(image.point(i).norm());
    if (image.mask[i] == kMeasured) image.source[i] = static_cast<std::uint32_t>(i);
    if (!attributes || image.mask[i] != kMeasured) continue;
    image.intensity[i] = static_cast<float>(random() % 256) / 255;
    image.rgb[i] = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()), 7};
  }
  image.mask[9] = kMeasured;
  image.x[9] = image.y[9] = image.z[9] = 0;
  return image;
}

TEST(GridScan, OfARangeImageIsTheImageItself) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "range.exr";
  for (const bool attributes : {false, true}) {
    io::write_range_exr(file, image_of_states(attributes), {{"source", "west.ptx"}});
    const Scan scan = io::read_scan(file, 0);
    const auto grid = io::read_grid_scan(file, entry_of(file));
    ASSERT_TRUE(grid);
    EXPECT_TRUE(grid->has_tables);
    expect_same(stages::arrange_grid(scan), grid->image);
    EXPECT_EQ(grid->samples, scan.points.size());
    EXPECT_EQ(grid->returns, static_cast<std::uint64_t>(std::ranges::count_if(
                                 scan.points, [](const auto& p) { return std::isfinite(p[0]); })));
    EXPECT_EQ(grid->scan.notes, scan.notes);
    EXPECT_GE(scan.notes.size(), 2u) << "the source and the node without a place";
  }
  // A checksum that is wrong is the same error; without tables the grid is found from the points.
  std::string bytes = bytes_of(file);
  bytes[bytes.size() - 300] = static_cast<char>(bytes[bytes.size() - 300] ^ 1);
  io::write_text(file, bytes);
  EXPECT_EQ(error_of(ErrorKind::input, [&] { io::read_grid_scan(file, entry_of(file)); }),
            error_of(ErrorKind::input, [&] { io::read_scan(file, 0); }));
  EXPECT_FALSE(io::read_grid_scan(file, io::list_scans(file, {.salvage = true}).at(0)));
  ForeignExr exr(8, 4);
  for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
  exr.write(file);
  EXPECT_FALSE(io::read_grid_scan(file, entry_of(file)));
  exr.attribute("hybrid:elevation_rad", std::string("0.3 0.2 0.1 0"));
  exr.attribute("hybrid:azimuth_first_rad", 0.0);
  exr.attribute("hybrid:azimuth_step_rad", 0.125);
  exr.write(file);
  const auto grid = io::read_grid_scan(file, entry_of(file));
  ASSERT_TRUE(grid);
  expect_same(stages::arrange_grid(io::read_scan(file, 0)), grid->image);
  exr.channel("y")[5] = 1e14f;
  exr.write(file);
  EXPECT_FALSE(io::read_grid_scan(file, entry_of(file))) << "absurd: the list of samples says where";
}

TEST(GridScan, AnythingElseIsLeftToTheListOfSamples) {
  const TemporaryFolder folder;
  const Case plain{.name = "plain", .kept = 0.9};
  const auto refused = [&](const std::vector<Sample>& samples, const char* what) {
    const auto file = write_case(folder, plain, samples);
    EXPECT_FALSE(io::read_grid_scan(file, entry_of(file))) << what;
    EXPECT_FALSE(stages::arrange_grid(io::read_scan(file, 0)).x.empty()) << what;
  };
  auto samples = samples_of(plain);
  samples[701].row = samples[21].row, samples[701].col = samples[21].col;
  refused(samples, "two at one node");
  samples = samples_of(plain);
  samples[300].row = kRows + 5;
  refused(samples, "beyond the declared rows");
  const auto good = write_case(folder, plain, samples_of(plain));
  EXPECT_TRUE(io::read_grid_scan(good, entry_of(good)));
  EXPECT_FALSE(io::read_grid_scan(good, io::list_scans(good, {.salvage = true}).at(0)));
}

}  // namespace hybrid::testing::grid_scan_test
