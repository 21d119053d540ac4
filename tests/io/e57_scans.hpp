#pragma once
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "io/e57/e57.hpp"
#include "io/e57/e57_writer.hpp"
#include "io/files.hpp"

namespace hybrid::testing {

// A scan's columns in memory, in the order of its fields.
struct E57Columns {
  std::vector<std::vector<std::int64_t>> integers;
  std::vector<std::vector<double>> reals;

  io::E57Records records() const {
    io::E57Records records;
    for (std::size_t k = 0; k < integers.size(); ++k) {
      records.integers.emplace_back(integers[k]);
      records.reals.emplace_back(reals[k]);
      records.count = std::max({records.count, integers[k].size(), reals[k].size()});
    }
    return records;
  }
  bool operator==(const E57Columns&) const = default;
};

inline io::E57Field integer_field(const std::string& name, std::int64_t minimum, std::int64_t maximum) {
  return {.name = name, .minimum = minimum, .maximum = maximum};
}
inline io::E57Field scaled_field(const std::string& name, std::int64_t minimum, std::int64_t maximum,
                                 double scale, double offset = 0) {
  return {.name = name,
          .type = io::E57Type::scaled_integer,
          .minimum = minimum,
          .maximum = maximum,
          .scale = scale,
          .offset = offset};
}
inline io::E57Field real_field(const std::string& name, io::E57Type type = io::E57Type::single_real) {
  return {.name = name, .type = type};
}

// Any values the fields can hold, the extreme ones first.
inline E57Columns random_columns(const std::vector<io::E57Field>& fields, std::size_t count) {
  std::mt19937_64 random(count + 1);
  E57Columns columns{std::vector<std::vector<std::int64_t>>(fields.size()),
                     std::vector<std::vector<double>>(fields.size())};
  for (std::size_t k = 0; k < fields.size(); ++k)
    for (std::size_t i = 0; i < count; ++i) {
      const io::E57Field& field = fields[k];
      if (field.is_integer()) {
        const std::uint64_t most =
            static_cast<std::uint64_t>(field.maximum) - static_cast<std::uint64_t>(field.minimum);
        const std::uint64_t step = most == ~0ull ? random() : random() % (most + 1);
        columns.integers[k].push_back(
            i == 0   ? field.minimum
            : i == 1 ? field.maximum
                     : static_cast<std::int64_t>(static_cast<std::uint64_t>(field.minimum) + step));
      } else {
        const double value = std::ldexp(static_cast<double>(random() % 20'000'001) - 1e7, -10);
        columns.reals[k].push_back(field.type == io::E57Type::single_real
                                       ? static_cast<double>(static_cast<float>(value))
                                       : value / 3);
      }
    }
  return columns;
}

inline void write_e57(const std::filesystem::path& file, const io::E57Scan& scan, const E57Columns& columns,
                      const io::E57WriterOptions& options = {}) {
  io::E57Writer writer(file, options);
  writer.begin_scan(scan);
  writer.write(columns.records());
  writer.end_scan();
  writer.close();
}

// Everything a table holds, as stored. Where records are lost, `lost` counts them.
inline E57Columns read_columns(const io::E57File& file, std::size_t scan, std::size_t most = 10'000,
                               std::uint64_t* lost = nullptr) {
  const io::E57Table& table = file.contents().scans.at(scan).points;
  std::vector<std::size_t> fields;
  for (std::size_t k = 0; k < table.fields.size(); ++k) fields.push_back(k);
  E57Columns columns{std::vector<std::vector<std::int64_t>>(fields.size()),
                     std::vector<std::vector<double>>(fields.size())};
  file.for_each_block(table, fields, most, [&](const io::E57Records& block) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      columns.integers[k].insert(columns.integers[k].end(), block.integers[k].begin(),
                                 block.integers[k].end());
      columns.reals[k].insert(columns.reals[k].end(), block.reals[k].begin(), block.reals[k].end());
    }
    std::uint64_t done = block.first;
    for (const auto& range : block.lost) {
      if (lost && range.end > done) *lost += range.end - std::max(done, range.first);
      done = std::max(done, range.end);
    }
  });
  return columns;
}

// The content of a file's pages, and a file of pages with this content.
std::string without_checksums(const std::string& file);
std::string with_checksums(const std::string& content);

// A file that lies but is not damaged: `by` at the logical offset `at`.
std::string overwritten(const std::string& file, std::size_t at, const std::string& by);
// The first `from` of the XML section replaced by `to`, header and checksums to match.
std::string with_xml(const std::string& file, const std::string& from, const std::string& to);
template <typename T>
std::string little_endian(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace hybrid::testing
