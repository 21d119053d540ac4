#include "io/e57/scan_columns.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace hybrid::io {
namespace {

class Search {
 public:
  Search(const E57Table& table, ScanColumns& columns)
      : table_(table), columns_(columns), used_(table.fields.size(), 0) {}

  bool has(const char* name) const { return find(name) < table_.fields.size(); }
  bool has_all(const std::array<const char*, 3>& names) const {
    return std::ranges::all_of(names, [&](const char* name) { return has(name); });
  }
  ScanColumns::Slot take(const char* name) {
    const std::size_t index = find(name);
    if (index == table_.fields.size()) return {};
    used_[index] = 1;
    columns_.fields.push_back(index);
    return columns_.fields.size() - 1;
  }
  std::array<std::size_t, 3> take_all(const std::array<const char*, 3>& names) {
    return {*take(names[0]), *take(names[1]), *take(names[2])};
  }
  void list_unused() {
    for (std::size_t i = 0; i < used_.size(); ++i)
      if (!used_[i]) columns_.unused.push_back(table_.fields[i].name);
  }

 private:
  // Text is no value here.
  std::size_t find(const char* name) const {
    const auto same = [&](const E57Field& field) {
      return field.name == name && field.type != E57Type::text;
    };
    return static_cast<std::size_t>(std::ranges::find_if(table_.fields, same) - table_.fields.begin());
  }

  const E57Table& table_;
  ScanColumns& columns_;
  std::vector<char> used_;
};

}  // namespace

ScanColumns ScanColumns::of(const std::string& where, const E57Table& table) {
  constexpr std::array<const char*, 3> kCartesian = {"cartesianX", "cartesianY", "cartesianZ"};
  constexpr std::array<const char*, 3> kSpherical = {"sphericalRange", "sphericalAzimuth",
                                                     "sphericalElevation"};
  constexpr std::array<const char*, 3> kColour = {"colorRed", "colorGreen", "colorBlue"};
  ScanColumns columns;
  Search search(table, columns);
  columns.spherical = !search.has_all(kCartesian);
  if (columns.spherical && !search.has_all(kSpherical))
    fail_input(
        "{}: expected cartesianX, Y and Z or sphericalRange, Azimuth and Elevation among the fields, found "
        "neither; export the scan with coordinates",
        where);
  columns.place = search.take_all(columns.spherical ? kSpherical : kCartesian);
  columns.invalid = search.take(columns.spherical ? "sphericalInvalidState" : "cartesianInvalidState");
  columns.intensity = search.take("intensity");
  if (columns.intensity) columns.intensity_invalid = search.take("isIntensityInvalid");
  if (search.has_all(kColour)) {
    columns.colour = search.take_all(kColour);
    columns.colour_invalid = search.take("isColorInvalid");
  }
  if (search.has("rowIndex") && search.has("columnIndex")) {
    columns.row = search.take("rowIndex");
    columns.column = search.take("columnIndex");
    columns.return_index = search.take("returnIndex");
  }
  search.list_unused();
  return columns;
}

void values_of(const E57Field& field, const E57Records& records, std::size_t slot, std::span<double> to) {
  if (!field.is_integer()) {
    std::ranges::copy(records.reals[slot], to.begin());
    return;
  }
  const std::span<const std::int64_t> from = records.integers[slot];
  if (field.type == E57Type::integer)
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<double>(from[i]);
  else
    for (std::size_t i = 0; i < from.size(); ++i)
      to[i] = static_cast<double>(from[i]) * field.scale + field.offset;
}

void to_cartesian(std::span<double> range_x, std::span<double> azimuth_y, std::span<double> elevation_z) {
  for (std::size_t i = 0; i < range_x.size(); ++i) {
    const double range = range_x[i], azimuth = azimuth_y[i], elevation = elevation_z[i];
    const double level = range * std::cos(elevation);
    range_x[i] = level * std::cos(azimuth);
    azimuth_y[i] = level * std::sin(azimuth);
    elevation_z[i] = range * std::sin(elevation);
  }
}

}  // namespace hybrid::io
