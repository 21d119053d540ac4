// Files beyond 2^32 bytes, sparse: their size is real, their disk space and the time to read them are not.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "io/allocation_watch.hpp"
#include "io/files.hpp"
#include "io/input_file.hpp"
#include "io/pcd/pcd.hpp"
#include "io/ply/ply.hpp"
#include "io/scan_samples.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::testing {
namespace {

// `header`, zeros, and pieces of data at their places after the header.
std::filesystem::path sparse_file(const TemporaryFolder& folder, const std::string& name,
                                  const std::string& header, std::uint64_t data_bytes,
                                  const std::vector<std::pair<std::uint64_t, std::string>>& pieces) {
  const auto path = folder.write(name, header);
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  EXPECT_EQ(ftruncate(file, static_cast<off_t>(header.size() + data_bytes)), 0);
  for (const auto& [at, bytes] : pieces)
    EXPECT_EQ(pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(header.size() + at)),
              static_cast<ssize_t>(bytes.size()));
  close(file);
  return path;
}

constexpr std::size_t kLittleMemory_bytes = 8 << 20;

TEST(LargeFile, PcdPointsBeyondFourGigabytes) {
  const TemporaryFolder folder;
  constexpr std::uint64_t kPoint_bytes = 4 * 300'000'000ull + 12;
  const auto xyz = [](float x, float y, float z) { return raw(x) + raw(y) + raw(z); };
  const auto file =
      sparse_file(folder, "wide.pcd",
                  "FIELDS x waveform y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 300000000 1 1\nWIDTH 5\n"
                  "HEIGHT 1\nDATA binary\n",
                  5 * kPoint_bytes,
                  {{0, raw(1.5f)},
                   {4 * kPoint_bytes, raw(-7.25f)},
                   {5 * kPoint_bytes - 8, xyz(8.5f, 9.5f, 0).substr(0, 8)}});
  const AllocationWatch watch;
  const Scan scan = io::read_pcd(file);
  EXPECT_LE(watch.largest_bytes(), kLittleMemory_bytes);
  ASSERT_EQ(scan.points.size(), 5u);
  EXPECT_EQ(scan.points[0], (std::array<float, 3>{1.5f, 0, 0}));
  EXPECT_EQ(scan.points[4], (std::array<float, 3>{-7.25f, 8.5f, 9.5f}));
}

TEST(LargeFile, PlyVerticesBeyondFourGigabytes) {
  const TemporaryFolder folder;
  for (const bool big : {false, true}) {
    const std::string header = fmt::format(
        "ply\nformat binary_{}_endian 1.0\nelement weather 1250000000\nproperty int a\nelement vertex 2\n"
        "property double x\nproperty list uchar float echoes\nproperty double y\nproperty double "
        "z\nend_header\n",
        big ? "big" : "little");
    const std::string vertices = raw(1.0, big) + '\1' + raw(5.0f, big) + raw(2.0, big) + raw(3.0, big) +
                                 raw(4.0, big) + '\0' + raw(5.0, big) + raw(6.0, big);
    const auto file =
        sparse_file(folder, "deep.ply", header, 5'000'000'000 + vertices.size(), {{5'000'000'000, vertices}});
    const AllocationWatch watch;
    const Scan scan = io::read_ply(file);
    EXPECT_LE(watch.largest_bytes(), kLittleMemory_bytes);
    EXPECT_EQ(scan.points, (std::vector<std::array<float, 3>>{{1, 2, 3}, {4, 5, 6}}));
  }
}

TEST(LargeFile, CountsBeyondFourGigabytesDoNotWrap) {
  const TemporaryFolder folder;
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty char x\nproperty char y\nproperty "
      "char "
      "z\nend_header\n";
  const auto read = [&](std::uint64_t promised, std::uint64_t there) {
    const auto file =
        sparse_file(folder, "many.ply", fmt::format(fmt::runtime(header), promised), 3 * there, {});
    const AllocationWatch watch;
    const std::string message = error_of(ErrorKind::input, [&] { io::read_ply(file); });
    EXPECT_LE(watch.largest_bytes(), kLittleMemory_bytes);
    return message;
  };
  // 2^32 + 10 would be 10 in 32 bits, and so would 2^64/3 + ... in 64 after the multiplication by 3 bytes.
  EXPECT_TRUE(
      holds(read(4'294'967'306, 4'294'967'306), "expected at most 4294967294 points, found 4294967306"));
  EXPECT_TRUE(holds(read(4'294'967'306, 10), "expected 4294967306 vertex"));
  EXPECT_TRUE(holds(read(6'148'914'691'236'517'206, 10), "found room for 10 (30 bytes)"));
}

TEST(LargeFile, TextBeyondFourGigabytesKnowsItsPlace) {
  const TemporaryFolder folder;
  const auto path = sparse_file(folder, "long.ptx", "", 5'000'000'000, {{4'999'999'990, "1 2\n3 x\n\n\n"}});
  io::InputFile file(path);
  io::TextCursor cursor(file, 4'999'999'990, 4'294'967'297);
  std::vector<double> values;
  cursor.read_all_numbers(values);
  EXPECT_EQ(values, (std::vector<double>{1, 2}));
  EXPECT_EQ(cursor.offset(), 4'999'999'994u);
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { cursor.read_all_numbers(values); }), "line 4294967298: "));
}

#if defined(__has_feature)
#define HYBRID_CLANG_ASAN __has_feature(address_sanitizer)
#else
#define HYBRID_CLANG_ASAN 0
#endif

// In a process of its own with little address space; a sanitizer needs more than that by itself.
TEST(LargeFile, MemoryThatIsNotThereIsAClearError) {
#if defined(__SANITIZE_ADDRESS__) || HYBRID_CLANG_ASAN
  GTEST_SKIP() << "the address sanitizer needs the address space";
#else
  const TemporaryFolder folder;
  const auto file =
      sparse_file(folder, "many.ply",
                  "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty char x\n"
                  "property char y\nproperty char z\nend_header\n",
                  12'000'000'000, {});
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{16ull << 30, 16ull << 30};
    if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(2);
    try {
      io::read_ply(file);
    } catch (const Error& error) {
      const std::string message = error.what();
      const bool told =
          message.find(file.string() + ": expected 45776 MiB of memory for 4000000000 points") == 0;
      if (!told) fmt::print(stderr, "{}\n", message);
      _exit(told && error.kind() == ErrorKind::device ? 0 : 1);
    } catch (...) {
      _exit(4);
    }
    _exit(3);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
#endif
}

}  // namespace
}  // namespace hybrid::testing
