// Text parsed in pieces on all threads against the same text read line by line.
#include "io/text/number_rows.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "io/files.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io::number_rows_test {
namespace {
using testing::TemporaryFolder;

struct Text {
  std::string bytes;
  std::vector<double> values;  // three per row
};

// Several pieces long: line ends of all kinds, blank lines, lines longer than the overlap of pieces.
Text make_text(std::size_t rows, const std::vector<std::string>& ends) {
  std::mt19937 random(7);
  Text text;
  for (std::size_t row = 0; row < rows; ++row) {
    for (int i = 0; i < 3; ++i) {
      const double value = static_cast<double>(static_cast<int>(random() % 2'000'001) - 1'000'000) / 1000;
      text.values.push_back(value);
      text.bytes += fmt::format("{}{}", i > 0 ? " " : "", value);
    }
    if (random() % 9 == 0) text.bytes += " ";
    if (random() % 20'000 == 0) text.bytes += std::string(9000, ' ');
    text.bytes += ends[random() % ends.size()];
    if (random() % 50 == 0) text.bytes += "  " + ends[0];
    if (random() % 30'000 == 0) text.bytes += std::string(9000, '\t') + ends[0];
  }
  return text;
}

std::uint64_t lines_in(const std::string& bytes) {
  std::uint64_t lines = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    lines += bytes[i] == '\n' || (bytes[i] == '\r' && (i + 1 == bytes.size() || bytes[i + 1] != '\n'));
  return lines;
}

// All rows by NumberRows, and a TextCursor where that stops.
std::vector<double> read_all(InputFile& file, std::uint64_t most, TextPlace& place) {
  NumberRows rows(file, {}, file.size(), 3);
  std::vector<double> values;
  while (values.size() < 3 * most) {
    const auto& parts = rows.next(most - values.size() / 3);
    for (const auto& part : parts) values.insert(values.end(), part.begin(), part.end());
    if (!parts.empty()) continue;
    TextCursor cursor(file, rows.place().offset, rows.place().line);
    cursor.skip_blank_lines();
    if (cursor.at_end()) break;
    std::vector<double> line;
    cursor.read_all_numbers(line);
    values.insert(values.end(), line.begin(), line.end());
    rows.go_on({cursor.offset(), cursor.line()});
  }
  place = rows.place();
  return values;
}

TEST(NumberRows, GiveWhatLinesHold) {
  const TemporaryFolder folder;
  for (const auto& ends :
       std::vector<std::vector<std::string>>{{"\n"}, {"\r\n"}, {"\r"}, {"\n", "\r\n", "\r"}}) {
    const Text text = make_text(100'000, ends);
    InputFile file(folder.write("a.txt", text.bytes));
    TextPlace place;
    EXPECT_EQ(read_all(file, ~std::uint64_t{0} / 3, place), text.values);

    // Some of them, and where the next one starts.
    const std::size_t most = 77'777;
    const auto some = read_all(file, most, place);
    EXPECT_EQ(some, std::vector<double>(text.values.begin(), text.values.begin() + 3 * most));
    EXPECT_EQ(place.line, 1 + lines_in(text.bytes.substr(0, place.offset)));
    TextCursor cursor(file, place.offset, place.line);
    cursor.skip_blank_lines();
    std::vector<double> line;
    cursor.read_all_numbers(line);
    EXPECT_EQ(line, std::vector<double>(text.values.begin() + 3 * most, text.values.begin() + 3 * most + 3));
  }
}

TEST(NumberRows, LinesArePassedAsTheyAreRead) {
  const TemporaryFolder folder;
  for (const auto& ends : std::vector<std::vector<std::string>>{{"\n"}, {"\n", "\r\n", "\r"}}) {
    const Text text = make_text(100'000, ends);
    InputFile file(folder.write("a.txt", text.bytes));
    for (const std::uint64_t rows : {std::uint64_t{1}, std::uint64_t{12'345}, std::uint64_t{99'999}}) {
      TextPlace place;
      read_all(file, rows, place);
      const PassedRows passed = pass_rows(file, {}, file.size(), rows);
      EXPECT_EQ(passed.rows, rows);
      EXPECT_EQ(passed.after.offset, place.offset);
      EXPECT_EQ(passed.after.line, place.line);
    }
    const PassedRows all = pass_rows(file, {}, file.size(), ~std::uint64_t{0});
    EXPECT_EQ(all.rows, 100'000u);
    EXPECT_EQ(all.after.offset, file.size());
    EXPECT_EQ(all.after.line, 1 + lines_in(text.bytes));
  }
}

TEST(NumberRows, StopAtTheFirstLineThatIsNoSuchRow) {
  const TemporaryFolder folder;
  std::string text;
  for (int row = 0; row < 60'000; ++row) text += fmt::format("{} 2.5 -{}\n", row, row);
  const std::size_t at = text.find('\n', text.size() / 2) + 1;
  for (const char* wrong : {"1 2\n", "1 2 3 4\n", "1 two 3\n", ",\n", "1 2 3x\n"}) {
    std::string bytes = text;
    InputFile file(folder.write("a.txt", bytes.insert(at, wrong)));
    NumberRows rows(file, {}, file.size(), 3);
    while (!rows.next(~std::uint64_t{0}).empty()) {
    }
    EXPECT_EQ(rows.place().offset, at) << wrong;
    EXPECT_EQ(rows.place().line, 1 + lines_in(text.substr(0, at)));
  }
}

}  // namespace
}  // namespace hybrid::io::number_rows_test
