#pragma once
#include <vector>

#include "io/number_rows.hpp"
#include "io/scan_builder.hpp"
#include "io/text_cursor.hpp"

namespace hybrid::io {

// Adds `count` samples, one per line of `columns` numbers from `place` on, read on all threads:
// to_sample(numbers) makes a ScanSample. What is no such line goes to read_line(cursor, values, done), which
// reads it or throws, the end of the text too. Returns the place behind the last sample.
template <typename ToSample, typename ReadLine>
TextPlace add_text_samples(InputFile& input, TextPlace place, std::uint64_t count, std::size_t columns,
                           ScanBuilder& builder, bool& commas_seen, const ToSample& to_sample,
                           const ReadLine& read_line) {
  NumberRows rows(input, place, input.size(), columns);
  std::vector<std::size_t> counts;
  std::vector<double> values(columns);
  for (std::uint64_t done = 0; done < count;) {
    const auto& parts = rows.next(count - done);
    counts.clear();
    for (const auto& part : parts) {
      counts.push_back(part.size() / columns);
      done += counts.back();
    }
    builder.add_parts(
        counts, [&](std::size_t part, std::size_t i) { return to_sample(parts[part].data() + i * columns); });
    if (done == count || !parts.empty()) continue;
    // An error, or a very long line.
    TextCursor cursor(input, rows.place().offset, rows.place().line);
    cursor.skip_blank_lines();
    read_line(cursor, values, done);
    commas_seen |= cursor.commas_seen();
    builder.add(to_sample(values.data()));
    rows.go_on({cursor.offset(), cursor.line()});
    ++done;
  }
  commas_seen |= rows.commas_seen();
  return rows.place();
}

}  // namespace hybrid::io
