#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "io/e57/scan_columns.hpp"
#include "io/e57/scan_grid.hpp"
#include "io/exr/exr_records.hpp"
#include "io/exr/range_exr_band.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

constexpr int kListCols = 4 * kRecordTile_px;
constexpr std::uint64_t kMostPixels = std::numeric_limits<std::uint32_t>::max() - 1;
constexpr std::size_t kLongestChannel = 200;

int up_to_tile(int rows) {
  return (rows + kRecordTile_px - 1) / kRecordTile_px * kRecordTile_px;
}

RecordLayout list_of(std::uint64_t samples) {
  if (samples > kMostPixels - kListCols)
    fail_input("expected at most {} points, found {}; split the file", kMostPixels - kListCols, samples);
  RecordLayout layout{.samples = samples};
  layout.cols = static_cast<int>(std::clamp<std::uint64_t>(samples, 1, kListCols));
  const auto cols = static_cast<std::uint64_t>(layout.cols);
  layout.rows = static_cast<int>(std::max<std::uint64_t>((samples + cols - 1) / cols, 1));
  return layout;
}

// What a range of records tells of the grid; sums of these do not depend on threads.
struct Votes {
  std::int64_t row_low = std::numeric_limits<std::int64_t>::max(),
               row_high = std::numeric_limits<std::int64_t>::min(), column_low = row_low,
               column_high = row_high;
  std::int64_t upward = 0, eastward = 0, along_columns = 0;

  void add(const Votes& other) {
    row_low = std::min(row_low, other.row_low);
    row_high = std::max(row_high, other.row_high);
    column_low = std::min(column_low, other.column_low);
    column_high = std::max(column_high, other.column_high);
    upward += other.upward;
    eastward += other.eastward;
    along_columns += other.along_columns;
  }
};

int sign(double value) {
  return (value > 0) - (value < 0);
}

std::optional<std::size_t> field_named(const E57Table& table, const char* name) {
  for (std::size_t k = 0; k < table.fields.size(); ++k)
    if (table.fields[k].name == name && table.fields[k].is_integer()) return k;
  return {};
}

// Rows and columns, and whether elevation rises with the rows and azimuth with the columns.
Votes count_votes(const E57Table& table, const E57RecordReader& reader, std::size_t row, std::size_t column) {
  std::optional<ScanColumns> columns;
  std::vector<std::size_t> fields = {row, column};
  try {
    columns = ScanColumns::of("", table);
    for (const std::size_t place : columns->place) fields.push_back(columns->fields[place]);
  } catch (const Error&) {  // no coordinates
  }
  std::vector<Votes> votes(reader.count() / E57RecordReader::kRange + 1);
  reader.read(fields, 0, reader.count(), [&](const E57Records& records) {
    Votes& vote = votes[records.first / E57RecordReader::kRange];
    std::array<std::vector<double>, 3> axis;
    for (std::size_t k = 0; k < 3 && columns; ++k) {
      axis[k].resize(records.count);
      values_of(table.fields[fields[2 + k]], records, 2 + k, axis[k]);
    }
    if (columns && columns->spherical) to_cartesian(axis[0], axis[1], axis[2]);
    for (std::size_t i = 0; i < records.count; ++i) {
      const std::int64_t r = records.integers[0][i], c = records.integers[1][i];
      vote.add({r, r, c, c, 0, 0, 0});
      if (i == 0) continue;
      const std::int64_t last_r = records.integers[0][i - 1], last_c = records.integers[1][i - 1];
      const int down = (r > last_r) - (r < last_r), right = (c > last_c) - (c < last_c);
      vote.along_columns += (down != 0 && right == 0) - (right != 0 && down == 0);
      if (!columns) continue;
      const auto& [x, y, z] = axis;
      vote.eastward += right * sign(x[i - 1] * y[i] - y[i - 1] * x[i]);
      vote.upward += down * sign(z[i] * std::hypot(x[i - 1], y[i - 1]) - z[i - 1] * std::hypot(x[i], y[i]));
    }
  });
  Votes sum;
  for (const Votes& vote : votes) sum.add(vote);
  return sum;
}

std::optional<RecordLayout> grid_of(const E57Table& table, const E57RecordReader& reader) {
  const auto row = field_named(table, "rowIndex"), column = field_named(table, "columnIndex");
  const std::uint64_t count = reader.count();
  if (!row || !column || count == 0) return {};
  const Votes votes = count_votes(table, reader, *row, *column);
  const auto extent = [](std::int64_t low, std::int64_t high) {
    return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
  };
  const std::uint64_t rows = extent(votes.row_low, votes.row_high),
                      cols = extent(votes.column_low, votes.column_high);
  const std::uint64_t most = std::min(kMostNodesPerSample * count + kFreeNodes, kMostPixels);
  if (rows < 2 || cols < 2 || rows > most / cols) return {};
  RecordLayout layout{.samples = count};
  layout.rows = layout.grid_rows = layout.list_row = static_cast<int>(rows);
  layout.cols = static_cast<int>(cols);
  layout.by_columns = votes.along_columns > 0;
  // Row 0 is the highest, columns go with increasing azimuth.
  const bool rising = votes.upward > 0, falling_azimuth = votes.eastward < 0;
  layout.row_step = rising ? -1 : 1;
  layout.row_first = rising ? votes.row_high : votes.row_low;
  layout.column_step = falling_azimuth ? -1 : 1;
  layout.column_first = falling_azimuth ? votes.column_high : votes.column_low;
  return layout;
}

RecordPlan plan_of_list(std::uint64_t samples) {
  RecordPlan plan;
  plan.layout = list_of(samples);
  plan.last.assign(groups_of(plan.layout).size(), RecordPlan::kNone);
  const std::uint64_t step = kRecordTile_px * static_cast<std::uint64_t>(plan.layout.cols);
  for (std::size_t k = 0; k < plan.last.size() && samples > 0; ++k)
    plan.last[k] = std::min(samples, (k + 1) * step) - 1;
  return plan;
}

}  // namespace

std::string RecordLayout::text() const {
  if (!grid()) return fmt::format("list {} {}", rows, cols);
  return fmt::format("grid {} {} list {} rows {} {} columns {} {} order {}", grid_rows, cols,
                     has_list() ? rows - list_row : 0, row_first, row_step, column_first, column_step,
                     by_columns ? "columns" : "rows");
}

RecordLayout RecordLayout::parse(const std::string& file, const std::string& text, std::uint64_t samples) {
  RecordLayout layout{.samples = samples};
  std::vector<std::int64_t> numbers;
  std::string shape;
  for (const std::string_view word : words(text)) {
    std::int64_t number = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (code == std::errc{} && end == word.data() + word.size())
      numbers.push_back(number);
    else
      shape += std::string(word) + ' ';
  }
  const auto within = [](std::int64_t value) {
    return value >= 0 && value <= std::numeric_limits<int>::max() / 2;
  };
  bool good = false;
  if (shape == "list " && numbers.size() == 2) {
    good = within(numbers[0]) && within(numbers[1]);
    layout.rows = static_cast<int>(numbers[0]);
    layout.cols = static_cast<int>(numbers[1]);
  } else if (shape.starts_with("grid list rows columns order ") && numbers.size() == 7) {
    const auto unit = [](std::int64_t step) { return step == 1 || step == -1; };
    good = within(numbers[0]) && within(numbers[1]) && within(numbers[2]) && unit(numbers[4]) &&
           unit(numbers[6]);
    layout.grid_rows = static_cast<int>(numbers[0]);
    layout.cols = static_cast<int>(numbers[1]);
    const int listed = good ? static_cast<int>(numbers[2]) : 0;
    layout.list_row = listed > 0 ? up_to_tile(layout.grid_rows) : layout.grid_rows;
    layout.rows = layout.list_row + listed;
    layout.row_first = numbers[3];
    layout.row_step = numbers[4];
    layout.column_first = numbers[5];
    layout.column_step = numbers[6];
    layout.by_columns = shape.ends_with("columns ");
  }
  if (!good || layout.rows < 1 || layout.cols < 1 || layout.pixels() > kMostPixels ||
      samples > layout.pixels())
    fail_input("{}: header: {}: expected the layout of {} records, found {}; copy or write the file again",
               file, records_attribute::kLayout, samples, in_quotes(text));
  return layout;
}

std::vector<RecordGroup> groups_of(const RecordLayout& layout) {
  std::vector<RecordGroup> groups;
  const int across = (layout.cols + kRecordTile_px - 1) / kRecordTile_px;
  const int grid_down = (layout.grid_rows + kRecordTile_px - 1) / kRecordTile_px,
            down = (layout.rows + kRecordTile_px - 1) / kRecordTile_px;
  const int grid_end = layout.has_list() ? layout.list_row : layout.rows;
  const auto add = [&](int tile_x, int tile_y, int tiles_x, int tiles_y, int end) {
    RecordGroup group{.tile_x = tile_x, .tile_y = tile_y, .tiles_x = tiles_x, .tiles_y = tiles_y};
    group.x = tile_x * kRecordTile_px;
    group.y = tile_y * kRecordTile_px;
    group.width = std::min((tile_x + tiles_x) * kRecordTile_px, layout.cols) - group.x;
    group.height = std::min((tile_y + tiles_y) * kRecordTile_px, end) - group.y;
    groups.push_back(group);
  };
  if (layout.by_columns)
    for (int x = 0; x < across && grid_down > 0; ++x) add(x, 0, 1, grid_down, grid_end);
  else
    for (int y = 0; y < grid_down; ++y) add(0, y, across, 1, grid_end);
  if (layout.has_list())
    for (int y = layout.list_row / kRecordTile_px; y < down; ++y) add(0, y, across, 1, layout.rows);
  return groups;
}

std::size_t group_at(const RecordLayout& layout, std::uint32_t pixel) {
  const auto cols = static_cast<std::uint32_t>(layout.cols);
  const int row = static_cast<int>(pixel / cols), col = static_cast<int>(pixel % cols);
  const int across = (layout.cols + kRecordTile_px - 1) / kRecordTile_px,
            grid_down = (layout.grid_rows + kRecordTile_px - 1) / kRecordTile_px;
  const bool listed = layout.has_list() && row >= layout.list_row;
  if (listed)
    return static_cast<std::size_t>((layout.by_columns && layout.grid() ? across : grid_down) +
                                    (row - layout.list_row) / kRecordTile_px);
  return static_cast<std::size_t>((layout.by_columns ? col : row) / kRecordTile_px);
}

std::vector<FieldChannels> channels_of(const E57Table& table, const RecordLayout& layout) {
  std::vector<FieldChannels> all;
  std::set<std::string> names;
  const auto named = [&](const char* name) {
    return std::ranges::any_of(table.fields, [&](const E57Field& field) { return field.name == name; });
  };
  for (std::size_t k = 0; k < table.fields.size(); ++k) {
    const E57Field& field = table.fields[k];
    FieldChannels& channels = all.emplace_back();
    if (layout.grid() && !layout.has_list() && field.is_integer()) {
      if (field.name == "rowIndex") channels.kind = FieldChannels::from_row;
      if (field.name == "columnIndex") channels.kind = FieldChannels::from_column;
      if (channels.kind != FieldChannels::constant) continue;
    }
    if (field.bits() == 0) continue;
    channels.kind = !field.is_integer()  ? field.type == E57Type::single_real ? FieldChannels::single
                                                                              : FieldChannels::double_halves
                    : field.bits() <= 32 ? FieldChannels::word
                                         : FieldChannels::two_words;
    std::string name = field.name;
    for (const char* axis : {"x", "y", "z"})
      if (name == std::string("cartesian") + static_cast<char>(*axis - 'a' + 'A') && !named(axis))
        name = axis;
    name = "raw." + name;
    const bool two =
        channels.kind == FieldChannels::two_words || channels.kind == FieldChannels::double_halves;
    const auto list = [&](const std::string& stem) {
      return two ? std::vector<std::string>{stem + ".lo", stem + ".hi"} : std::vector<std::string>{stem};
    };
    channels.names = list(name);
    const auto taken = [&](const std::string& one) { return names.contains(one); };
    if (name.size() > kLongestChannel || std::ranges::any_of(channels.names, taken))
      channels.names = list(fmt::format("raw.field {}", k));
    names.insert(channels.names.begin(), channels.names.end());
  }
  return all;
}

RecordPlaces::RecordPlaces(const RecordLayout& layout) : layout_(layout) {
  taken_.resize(static_cast<std::size_t>(layout.grid_rows) * static_cast<std::size_t>(layout.cols));
}

void RecordPlaces::next(std::span<const std::int64_t> rows, std::span<const std::int64_t> columns,
                        std::span<std::uint32_t> pixels) {
  const auto cols = static_cast<std::uint32_t>(layout_.cols);
  const std::uint32_t list = static_cast<std::uint32_t>(layout_.list_row) * cols;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (layout_.grid()) {
      const auto row = static_cast<std::uint32_t>((rows[i] - layout_.row_first) * layout_.row_step);
      const auto col = static_cast<std::uint32_t>((columns[i] - layout_.column_first) * layout_.column_step);
      pixels[i] = row * cols + col;
      if (!taken_[pixels[i]]) {
        taken_[pixels[i]] = true;
        continue;
      }
    }
    pixels[i] = list + static_cast<std::uint32_t>(listed_++);
  }
}

RecordPlan plan_records(const E57Table& table, const E57RecordReader& reader) {
  const auto grid = grid_of(table, reader);
  if (!grid) return plan_of_list(reader.count());
  RecordPlan plan;
  RecordLayout& layout = plan.layout = *grid;
  const auto cols = static_cast<std::uint64_t>(layout.cols), nodes = layout.pixels();
  plan.last.assign(groups_of(layout).size(), RecordPlan::kNone);
  std::vector<std::uint64_t> list_last;
  RecordPlaces places(layout);  // with the list right behind the grid: its place follows from its length
  const std::array<std::size_t, 2> fields = {*field_named(table, "rowIndex"),
                                             *field_named(table, "columnIndex")};
  std::vector<std::uint32_t> pixels(kBlock_records);
  for_each_block(reader, table, fields, kBlock_records, [&](const E57Records& records) {
    places.next(records.integers[0], records.integers[1], std::span(pixels).first(records.count));
    for (std::size_t i = 0; i < records.count; ++i) {
      if (pixels[i] < nodes) {
        plan.last[group_at(layout, pixels[i])] = records.first + i;
        continue;
      }
      list_last.resize((pixels[i] - nodes) / (kRecordTile_px * cols) + 1);
      list_last.back() = records.first + i;
    }
  });
  if (places.listed() == 0) return plan;
  layout.list_row = up_to_tile(layout.grid_rows);
  const std::uint64_t rows = (places.listed() + cols - 1) / cols;
  if (rows > kMostPixels / cols - static_cast<std::uint64_t>(layout.list_row))
    return plan_of_list(reader.count());
  layout.rows = layout.list_row + static_cast<int>(rows);
  plan.last.insert(plan.last.end(), list_last.begin(), list_last.end());
  return plan;
}

}  // namespace hybrid::io
