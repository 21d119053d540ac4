// Two thousand random damages of each reader's sample, always the same ones: each is read or refused. The
// fuzz targets of tests/fuzz look further.
#include <fcntl.h>
#include <gtest/gtest.h>

#include <random>

#include "io/allocation_watch.hpp"
#include "io/file_in_memory.hpp"
#include "io/files.hpp"
#include "io/reader_table.hpp"

namespace hybrid::testing {
namespace {

constexpr int kMutations = 2000;
constexpr std::size_t kMostBytes = 256 << 20;  // any single request for memory, for files of a few kilobytes

class Mutator {
 public:
  explicit Mutator(const std::string& good) : good_(good) {}

  std::string next() {
    std::string bytes = good_;
    for (std::size_t edits = 1 + below(4); edits > 0; --edits) edit(bytes);
    return bytes;
  }

 private:
  // Not std::uniform_int_distribution, whose numbers differ between libraries.
  std::size_t below(std::size_t bound) { return bound == 0 ? 0 : random_() % bound; }

  void edit(std::string& bytes) {
    static const std::string kWords[] = {"-1",
                                         "0",
                                         "nan",
                                         "1e999",
                                         "4294967296",
                                         "18446744073709551615",
                                         "\n",
                                         "\r",
                                         " ",
                                         "\\",
                                         "\"",
                                         "{",
                                         "[",
                                         "\xff\xff\xff\x7f",
                                         std::string(4, '\0'),
                                         "\xff\xff\xff\xff",
                                         std::string("\0\0\0\x80", 4)};
    const std::size_t at = below(bytes.size()), length = 1 + below(below(2) ? 8 : bytes.size());
    switch (below(7)) {
      case 0:
        if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ 1 << below(8));
        break;
      case 1:
        if (!bytes.empty()) bytes[at] = static_cast<char>(below(256));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size()), length));
        break;
      case 4:
        bytes.insert(at, kWords[below(std::size(kWords))]);
        break;
      case 5: {
        const std::string& word = kWords[below(std::size(kWords))];
        bytes.replace(at, word.size(), word);
        break;
      }
      default:
        bytes.resize(below(bytes.size() + 1));
    }
  }

  const std::string good_;
  std::mt19937 random_{20041117};
};

// The libraries of pictures write a line about every damage.
class QuietErrors {
 public:
  QuietErrors() : kept_(dup(STDERR_FILENO)) {
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nothing, STDERR_FILENO);
    close(nothing);
  }
  ~QuietErrors() {
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }

 private:
  int kept_;
};

class Mutations : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Mutations, EachIsReadOrRefused) {
  const ReaderRow& row = reader_table()[GetParam()];
  const TemporaryFolder folder;
  Mutator mutator(row.good(folder.path()));
  const FileInMemory file(folder.path() / row.file);
  int refused = 0;
  const QuietErrors quiet;
  const AllocationWatch watch;
  for (int i = 0; i < kMutations; ++i) {
    const std::string bytes = mutator.next();
    file.write(bytes);
    try {
      row.read(folder.path() / row.file);
    } catch (const Error& error) {
      ++refused;
      ASSERT_EQ(error.kind(), ErrorKind::input) << i << ": " << error.what();
      ASSERT_TRUE(holds(error.what(), folder.path().string())) << i;
    }
    ASSERT_LE(watch.largest_bytes(), kMostBytes) << i;
  }
  EXPECT_GT(refused, kMutations / 10);
}

INSTANTIATE_TEST_SUITE_P(readers, Mutations, ::testing::Range(std::size_t{0}, reader_table().size()),
                         [](const auto& reader) { return reader_table()[reader.param].name; });

}  // namespace
}  // namespace hybrid::testing
