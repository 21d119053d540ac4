// Every writer under a file size limit one byte below what it writes, and at the half: a library that flushes
// its last bytes in a destructor or at close() swallows the failure, and a file cut short would be called
// complete.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <functional>
#include <utility>

#include "io/exr/exr.hpp"
#include "io/exr/range_exr.hpp"
#include "io/files.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"
#include "io/picture.hpp"
#include "io/ply/ply.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io::full_disk_test {
namespace {
namespace fs = std::filesystem;
using testing::bytes_of;
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

struct Writer {
  const char* name;
  std::function<void(const fs::path&)> write;
};

// Noise, so that compression does not make the files tiny.
std::vector<float> noise(std::size_t count) {
  std::vector<float> values(count);
  std::uint32_t state = 1;
  for (float& value : values) {
    state = state * 1664525u + 1013904223u;
    value = static_cast<float>(state >> 8);
  }
  return values;
}

ScanSource one_scan() {
  return [given = false]() mutable -> std::unique_ptr<ScanStream> {
    if (std::exchange(given, true)) return nullptr;
    Scan scan;
    for (const float value : noise(5000)) scan.points.push_back({value * 1e-6f, 1, 2});
    return std::make_unique<ScanInMemory>(std::move(scan));
  };
}

std::vector<Writer> writers() {
  return {
      {"write_text", [](const fs::path& file) { write_text(file, std::string(300000, 'x')); }},
      {"write_ply", [](const fs::path& file) { write_ply(file, std::vector<PlyPoint>(30000), {}); }},
      {"write_png",
       [](const fs::path& file) {
         Image8 picture(200, 100, 3);
         const auto values = noise(picture.pixels.size());
         for (std::size_t i = 0; i < values.size(); ++i)
           picture.pixels[i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(values[i]) >> 8);
         write_png(file, picture);
       }},
      {"write_exr",
       [](const fs::path& file) {
         const auto values = noise(200 * 100);
         write_exr(file, 200, 100, {{"R", values.data(), nullptr, 1}});
       }},
      {"write_ptx", [](const fs::path& file) { write_ptx(file, one_scan()); }},
      {"write_pts", [](const fs::path& file) { write_pts(file, one_scan()); }},
      {"write_ply_scan", [](const fs::path& file) { write_ply_scan(file, one_scan()); }},
      {"write_pcd", [](const fs::path& file) { write_pcd(file, one_scan()); }},
      {"write_las", [](const fs::path& file) { write_las(file, one_scan()); }},
      {"write_range_exr",
       [](const fs::path& file) {
         RangeImage image = make_range_image(100, 300);
         image.range_m = image.x = image.y = image.z = noise(image.count());
         std::fill(image.mask.begin(), image.mask.end(), std::uint8_t{kMeasured});
         write_range_exr(file, image, {});
       }},
  };
}

void PrintTo(const Writer& row, std::ostream* out) {
  *out << row.name;
}

class FullDisk : public ::testing::TestWithParam<Writer> {};

}  // namespace

TEST_P(FullDisk, is_told_and_leaves_the_old_file) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.out";
  GetParam().write(file);
  const std::string before = bytes_of(file);
  ASSERT_GT(before.size(), 10000u);
  for (const std::size_t bytes : {before.size() - 1, before.size() / 2, std::size_t{0}}) {
    std::string message;
    {
      const FileSizeLimit limit(bytes);
      message = error_of(ErrorKind::failed, [&] { GetParam().write(file); });
    }
    EXPECT_TRUE(holds(message, file.string() + ": cannot write: File too large; raise the file size limit"))
        << bytes << " of " << before.size();
    EXPECT_EQ(bytes_of(file), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Writers, FullDisk, ::testing::ValuesIn(writers()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(OutputFile, a_failed_write_stays_failed) {
  OutputFile file("/dev/full");
  const std::string block(1 << 20, 'x');
  for (int i = 0; i < 2; ++i)
    EXPECT_TRUE(holds(error_of(ErrorKind::temporary, [&] { file.write(block.data(), block.size()); }),
                      "/dev/full: the disk is full; free space and run again"));
  error_of(ErrorKind::temporary, [&] { file.close(); });
}

TEST(OutputFile, the_last_bytes_count) {
  OutputFile file("/dev/full");
  file.write("x", 1);  // buffered
  error_of(ErrorKind::temporary, [&] { file.close(); });
}

TEST(OutputFile, seeks_like_a_stream) {
  const TemporaryFolder folder;
  OutputFile file(folder.path() / "a");
  file.write("0123456789", 10);
  EXPECT_EQ(file.position(), 10u);
  file.seek(3);
  EXPECT_EQ(file.position(), 3u);
  file.write("abc", 3);
  file.seek(12);
  file.write("z", 1);
  file.close();
  EXPECT_EQ(bytes_of(folder.path() / "a"), std::string("012abc6789\0\0z", 13));
}

TEST(output, what_a_killed_process_left_is_removed_once_it_is_dead) {
  const TemporaryFolder folder;
  fs::path part;
  write_atomically(folder.path() / "a.txt", [&](const fs::path& temporary) {
    part = temporary;
    std::ofstream(temporary) << "x";
  });
  const std::string own = std::to_string(getpid());
  const std::string name = part.filename().string();
  const auto of_process = [&](int process) {
    std::string text = name;
    return text.replace(text.find("-" + own + "-") + 1, own.size(), std::to_string(process));
  };
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  waitpid(dead, nullptr, 0);
  const fs::path target = folder.path() / "below";  // each folder is looked through once per process
  fs::create_directories(target);
  for (const std::string& left :
       {of_process(dead), of_process(getppid()), std::string(".part-other-host.txt")})
    std::ofstream(target / left) << "half";
  write_text(target / "b.txt", "b");
  EXPECT_FALSE(fs::exists(target / of_process(dead)));
  EXPECT_TRUE(fs::exists(target / of_process(getppid())));
  EXPECT_TRUE(fs::exists(target / ".part-other-host.txt"));
}

}  // namespace hybrid::io::full_disk_test
