#include "io/e57_grids.hpp"

#include "io/e57_scans.hpp"

namespace hybrid::testing {

std::filesystem::path e57_of(const std::filesystem::path& file, int rows, int cols,
                             const std::vector<std::uint32_t>& order,
                             std::optional<io::E57Limits> declared_rows, bool returns) {
  io::E57Scan scan;
  scan.name = "a";
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.points.fields.push_back(scaled_field(axis, -100'000, 100'000, 1e-4));
  scan.points.fields.push_back(integer_field("intensity", 0, 2047));
  scan.points.fields.push_back(integer_field("rowIndex", 0, 5000));
  scan.points.fields.push_back(integer_field("columnIndex", 0, 5000));
  if (returns) {
    scan.points.fields.push_back(integer_field("returnIndex", 0, 300));
    scan.points.fields.push_back(integer_field("cartesianInvalidState", 0, 2));
  }
  scan.intensity = io::E57Limits{0, 2047};
  scan.rows = declared_rows ? declared_rows : io::E57Limits{7, 7.0 + rows - 1};
  scan.columns = io::E57Limits{0, cols - 1.0};
  E57Columns columns = random_columns(scan.points.fields, order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    columns.integers[4][i] = 7 + order[i] / static_cast<std::uint32_t>(cols);
    columns.integers[5][i] = order[i] % static_cast<std::uint32_t>(cols);
  }
  write_e57(file, scan, columns);
  return file;
}

std::vector<std::uint32_t> all_nodes(int rows, int cols, bool by_columns) {
  std::vector<std::uint32_t> nodes;
  for (int i = 0; i < rows * cols; ++i)
    nodes.push_back(static_cast<std::uint32_t>(by_columns ? i % rows * cols + i / rows : i));
  return nodes;
}

}  // namespace hybrid::testing
