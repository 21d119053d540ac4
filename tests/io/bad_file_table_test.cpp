// Every reader x every damage: one clear ErrorKind::input that names the file, the place, what was expected
// and what to do, before memory is taken on a header's word; or, where the damage is legal, the right data. A
// new reader is one row of reader_rows_*.cpp.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <regex>

#include "io/allocation_watch.hpp"
#include "io/files.hpp"
#include "io/reader_table.hpp"

namespace hybrid::testing::bad_file_table_test {
namespace {
namespace fs = std::filesystem;

// One reader with its intact file in a folder whose name has blanks and letters outside ASCII.
class Case {
 public:
  explicit Case(const ReaderRow& reader)
      : row(reader), good(reader.good(folder_.path())), file(folder_.path() / row.file) {}

  fs::path write(const std::string& bytes) const { return folder_.write(row.file, bytes); }
  const fs::path& folder() const { return folder_.path(); }

  // The error of reading `path`, which says all that an error has to say.
  std::string expect_error(const fs::path& path) const {
    const AllocationWatch watch;
    const std::string message = error_of(ErrorKind::input, [&] { row.read(path); });
    EXPECT_LE(watch.largest_bytes(), row.most_bytes) << message;
    EXPECT_TRUE(holds(message, path.string()));
    return message;
  }

  // Damage within the file: the error also names the place.
  std::string expect_damage(const std::string& bytes) const {
    const fs::path path = write(bytes);
    std::string message = expect_error(path);
    static const std::regex place(
        R"(:\d+: |: line \d|: lines \d|: byte \d| at line \d+| parsing '|: scan \w+: |: header: |: tiles: |: content: |FIELDS: |frames\[\d+\]: |pixels|no picture)");
    EXPECT_TRUE(std::regex_search(message, place)) << message;
    EXPECT_TRUE(
        std::regex_search(message, std::regex("expected|found|empty|occurs|cut short|not|no picture")))
        << message;
    return message;
  }

  void expect_refused(const std::vector<Edit>& edits) const {
    for (const Edit& edit : edits) {
      SCOPED_TRACE(edit.from + " -> " + edit.to);
      expect_damage(edited(good, edit));
    }
  }

  void expect_good(const std::string& bytes) const {
    const std::string intact = row.read(write(good));
    EXPECT_EQ(row.read(write(bytes)), intact);
  }

  // Text in lines that may end otherwise: all, the header, or nothing.
  std::size_t line_bytes() const {
    if (row.text) return good.size();
    return row.header_end.empty() ? 0 : good.find(row.header_end) + row.header_end.size();
  }

  // The text with every line end turned into the next of `ends`, over and over.
  std::string with_line_ends(const std::vector<std::string>& ends) const {
    std::string result;
    std::size_t lines = 0;
    for (std::size_t i = 0; i < line_bytes(); ++i)
      result += good[i] == '\n' ? ends[lines++ % ends.size()] : std::string(1, good[i]);
    return result + good.substr(line_bytes());
  }

 private:
  TemporaryFolder folder_;

 public:
  const ReaderRow& row;
  const std::string good;
  const fs::path file;
};

std::string noise(std::size_t count, bool zeros) {
  std::string bytes;
  std::uint32_t state = 12345;
  while (bytes.size() < count) {
    state = state * 1664525u + 1013904223u;
    const char byte = static_cast<char>(state >> 24);
    if (byte != 0 || zeros) bytes.push_back(byte);
  }
  return bytes;
}

std::string to_utf16(const std::string& text, bool big_endian) {
  std::string wide;
  for (const char c : text) wide += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return wide;
}

void missing(const Case& c) {
  fs::remove(c.file);
  EXPECT_TRUE(holds(c.expect_error(c.file), "no such file"));
}

void folder(const Case& c) {
  fs::remove(c.file);
  fs::create_directories(c.file);
  EXPECT_TRUE(holds(c.expect_error(c.file), "found a folder"));
}

void pipe_or_device(const Case& c) {
  c.write("");
  fs::remove(c.file);
  ASSERT_EQ(mkfifo(c.file.c_str(), 0600), 0);
  EXPECT_TRUE(holds(c.expect_error(c.file), "regular file"));
}

// In a process of its own, which gives up the super-user's right to read everything.
void unreadable(const Case& c) {
  fs::permissions(c.write(c.good), fs::perms::none);
  const pid_t child = fork();
  if (child == 0) {  // _exit: the destructors of static objects belong to the parent
    if (geteuid() == 0 && setuid(65534) != 0) _exit(2);
    try {
      c.row.read(c.file);
    } catch (const Error& error) {
      const bool named =
          std::string(error.what()).find(c.file.string() + ": cannot be read") != std::string::npos;
      _exit(named && error.kind() == ErrorKind::input ? 0 : 1);
    } catch (...) {
      _exit(4);
    }
    _exit(3);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

void empty(const Case& c) {
  c.expect_error(c.write(""));
  if (c.row.text) c.expect_damage("\n\n  \n");
}

// Text cut within its last number cannot be told from another number: the last cut takes whole ones.
void cut_at_ten_places(const Case& c) {
  for (std::size_t tenth = 1; tenth <= 10; ++tenth) {
    SCOPED_TRACE(c.good.size() * tenth / 11);
    c.expect_error(c.write(c.good.substr(0, c.good.size() * tenth / 11)));
  }
}

void wrong_magic(const Case& c) {
  c.expect_error(c.write("GIF89a\r\n\x1a\n" + noise(3000, true)));
  c.expect_error(c.write(noise(4000, true)));
  c.expect_error(c.write(noise(4000, false)));
}

void counts_too_high(const Case& c) {
  c.expect_refused(c.row.counts_too_high);
}

void counts_too_low(const Case& c) {
  c.expect_refused(c.row.counts_too_low);
}

void absurd_sizes(const Case& c) {
  c.expect_refused(c.row.absurd_sizes);
}

void not_finite(const Case& c) {
  c.expect_refused(c.row.non_finite);
  if (!c.row.non_finite_no_return) return;
  const std::string result = c.row.read(c.write(edited(c.good, *c.row.non_finite_no_return)));
  EXPECT_TRUE(holds(result, "point nan nan nan\n"));
  EXPECT_TRUE(holds(result, "1 of 4 points are not finite"));
  EXPECT_TRUE(holds(result, "point 0 2 -0.5\n"));
}

void mixed_line_ends(const Case& c) {
  if (c.line_bytes() > 0) {
    c.expect_good(c.with_line_ends({"\r\n"}));
    c.expect_good(c.with_line_ends({"\n", "\r\n"}));
    if (c.row.lone_cr) c.expect_good(c.with_line_ends({"\r"}));
    if (c.row.lone_cr && c.row.text) c.expect_good(c.with_line_ends({"\n", "\r\n", "\r"}));
  }
  if (c.row.text || !c.row.checked) return;
  // A transfer "as text" spoils binary data.
  std::string spoilt;
  for (const char byte : c.good) spoilt += byte == '\n' ? std::string("\r\n") : std::string(1, byte);
  if (c.good.find('\n', c.line_bytes()) != std::string::npos) c.expect_error(c.write(spoilt));
}

void utf8_mark(const Case& c) {
  if (c.line_bytes() > 0)
    c.expect_good("\xef\xbb\xbf" + c.good);
  else
    c.expect_error(c.write("\xef\xbb\xbf" + c.good));
}

void utf16(const Case& c) {
  for (const std::string mark : {"\xff\xfe", "\xfe\xff", ""}) {
    const std::string message = c.expect_error(c.write(mark + to_utf16(c.good, mark == "\xfe\xff")));
    if (c.line_bytes() > 0) {
      EXPECT_TRUE(holds(message, "UTF-16"));
      EXPECT_TRUE(holds(message, "UTF-8"));
    }
  }
}

void odd_path(const Case& c) {
  const std::string intact = c.row.read(c.write(c.good));
  const fs::path file =
      c.folder() / ("a 'b' \xc3\xbc\xe8\xb7\xaf\xf0\x9f\x8f\x9b $(c);#%s{}" + c.file.extension().string());
  std::ofstream(file, std::ios::binary) << c.good;
  EXPECT_EQ(c.row.read(file), intact);
  std::ofstream(file, std::ios::binary) << "?";
  c.expect_error(file);
}

using Damage = std::pair<const char*, void (*)(const Case&)>;
const Damage kDamages[] = {{"missing", missing},
                           {"folder", folder},
                           {"pipe_or_device", pipe_or_device},
                           {"unreadable", unreadable},
                           {"empty", empty},
                           {"cut_at_ten_places", cut_at_ten_places},
                           {"wrong_magic", wrong_magic},
                           {"counts_too_high", counts_too_high},
                           {"counts_too_low", counts_too_low},
                           {"absurd_sizes", absurd_sizes},
                           {"not_finite", not_finite},
                           {"mixed_line_ends", mixed_line_ends},
                           {"utf8_mark", utf8_mark},
                           {"utf16", utf16},
                           {"odd_path", odd_path}};

struct Cell {
  std::size_t reader, damage;
  const ReaderRow& row() const { return reader_table()[reader]; }
};

void PrintTo(const Cell& cell, std::ostream* out) {
  *out << cell.row().name << " x " << kDamages[cell.damage].first;
}

// All but those that a format cannot have: no counts in it, no number that could be infinite, a fixed name.
std::vector<Cell> cells() {
  std::vector<Cell> result;
  for (std::size_t reader = 0; reader < reader_table().size(); ++reader) {
    const ReaderRow& row = reader_table()[reader];
    for (std::size_t damage = 0; damage < std::size(kDamages); ++damage) {
      const auto apply = kDamages[damage].second;
      if ((apply == counts_too_high && row.counts_too_high.empty()) ||
          (apply == counts_too_low && row.counts_too_low.empty()) ||
          (apply == absurd_sizes && row.absurd_sizes.empty()) ||
          (apply == not_finite && row.non_finite.empty() && !row.non_finite_no_return) ||
          (apply == odd_path && !row.free_name))
        continue;
      result.push_back({reader, damage});
    }
  }
  return result;
}

class BadFileTable : public ::testing::TestWithParam<Cell> {};

TEST_P(BadFileTable, cell) {
  kDamages[GetParam().damage].second(Case(GetParam().row()));
}

INSTANTIATE_TEST_SUITE_P(readers, BadFileTable, ::testing::ValuesIn(cells()), [](const auto& cell) {
  return cell.param.row().name + "_" + kDamages[cell.param.damage].first;
});

}  // namespace
}  // namespace hybrid::testing::bad_file_table_test
