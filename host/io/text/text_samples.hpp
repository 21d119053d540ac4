#pragma once
#include <vector>

#include "core/error.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text/number_rows.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {

// Adds `count` samples, one per line of numbers from where `rows` is on, read on all threads:
// to_sample(numbers) makes a ScanSample. What is no such line goes to read_line(cursor, values, done), which
// reads it or throws, the end of the text too. With `damage` (salvage) a line that read_line refuses becomes
// a no-return and is counted there, and the samples end where the text does.
template <typename Builder, typename ToSample, typename ReadLine>
void add_text_samples(InputFile& input, NumberRows& rows, std::uint64_t count, Builder& builder,
                      bool& commas_seen, const ToSample& to_sample, const ReadLine& read_line,
                      Damage* damage = nullptr) {
  const std::size_t columns = rows.columns();
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
    if (damage && cursor.at_end()) break;
    const TextPlace line{cursor.offset(), cursor.line()};
    bool refused = false;
    const auto pass_damage = [&](std::string_view problem) {
      damage->add(1, problem);
      cursor.move_to(line.offset, line.line);
      cursor.next_line();
      refused = true;
    };
    try {
      // Of later damage only the number of lines is told: an error for each costs more than many lines.
      if (!damage || damage->records() == 0)
        read_line(cursor, values, done);
      else if (cursor.try_numbers(values) != columns)
        pass_damage("");
    } catch (const Error& error) {
      if (!damage || error.kind() != ErrorKind::input) throw;
      pass_damage(error.what());
    }
    commas_seen |= cursor.commas_seen();
    if (refused)
      builder.add_lost(1);
    else
      builder.add(to_sample(values.data()));
    rows.go_on({cursor.offset(), cursor.line()});
    ++done;
  }
  commas_seen |= rows.commas_seen();
}

// The same from `place` on, with `columns` numbers a line. Returns the place behind the last sample.
template <typename ToSample, typename ReadLine>
TextPlace add_text_samples(InputFile& input, TextPlace place, std::uint64_t count, std::size_t columns,
                           ScanBuilder& builder, bool& commas_seen, const ToSample& to_sample,
                           const ReadLine& read_line, Damage* damage = nullptr) {
  NumberRows rows(input, place, input.size(), columns);
  add_text_samples(input, rows, count, builder, commas_seen, to_sample, read_line, damage);
  return rows.place();
}

}  // namespace hybrid::io
