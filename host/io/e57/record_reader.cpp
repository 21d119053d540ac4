#include "io/e57/record_reader.hpp"

#include <algorithm>
#include <numeric>

namespace hybrid::io {

std::vector<std::size_t> all_fields(const E57Table& table) {
  std::vector<std::size_t> fields(table.fields.size());
  std::iota(fields.begin(), fields.end(), std::size_t{0});
  return fields;
}

void for_each_block(const E57RecordReader& reader, const E57Table& table, std::span<const std::size_t> fields,
                    std::size_t most, const std::function<void(const E57Records&)>& body) {
  std::vector<std::vector<std::int64_t>> integers(fields.size());
  std::vector<std::vector<double>> reals(fields.size());
  for (std::uint64_t first = 0; first < reader.count(); first += most) {
    E57Records block{
        .first = first,
        .count = static_cast<std::size_t>(std::min<std::uint64_t>(most, reader.count() - first))};
    std::vector<std::vector<E57Records::Lost>> lost(block.count / E57RecordReader::kRange + 1);
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const bool integer = table.fields.at(fields[k]).is_integer();
      integers[k].resize(integer ? block.count : 0);
      reals[k].resize(integer ? 0 : block.count);
    }
    reader.read(fields, first, block.count, [&](const E57Records& range) {
      const std::size_t at = range.first - first;
      for (std::size_t k = 0; k < fields.size(); ++k) {
        std::ranges::copy(range.integers[k], integers[k].begin() + static_cast<std::ptrdiff_t>(
                                                                       range.integers[k].empty() ? 0 : at));
        std::ranges::copy(range.reals[k],
                          reals[k].begin() + static_cast<std::ptrdiff_t>(range.reals[k].empty() ? 0 : at));
      }
      lost[at / E57RecordReader::kRange] = range.lost;
    });
    for (std::size_t k = 0; k < fields.size(); ++k) {
      block.integers.emplace_back(integers[k]);
      block.reals.emplace_back(reals[k]);
    }
    for (const auto& of_range : lost) block.lost.insert(block.lost.end(), of_range.begin(), of_range.end());
    body(block);
  }
}

E57Records selected(const E57Records& records, std::span<const std::size_t> columns) {
  E57Records some{.first = records.first, .count = records.count, .lost = records.lost};
  for (const std::size_t column : columns) {
    some.integers.push_back(records.integers[column]);
    some.reals.push_back(records.reals[column]);
  }
  return some;
}

}  // namespace hybrid::io
