// How fast an E57 scan as scanners write them (scaled-integer XYZ of 20 bits, intensity, row and column: 97
// bits a point) is read from a warm file: columns as stored, and a whole Scan with its grid. Prints wall and
// processor time, since machines are shared, and the peak memory.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "core/parallel.hpp"
#include "io/e57/e57.hpp"
#include "io/e57/e57_writer.hpp"
#include "io/output.hpp"

namespace {
namespace fs = std::filesystem;
using namespace hybrid;

constexpr std::int64_t kHalf = 1 << 19;
constexpr std::size_t kRows = 4000, kColumnsAtOnce = 50;

struct Clock {
  std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
  double cpu = processor_s();
  double wall_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  }
  double cpu_s() const { return processor_s() - cpu; }
  static double processor_s() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
};

void write_scan(const fs::path& file, std::size_t columns) {
  io::E57Scan scan{.name = "church"};
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.points.fields.push_back({.name = name,
                                  .type = io::E57Type::scaled_integer,
                                  .minimum = -kHalf,
                                  .maximum = kHalf - 1,
                                  .scale = 1e-4});
  scan.points.fields.push_back({.name = "intensity", .minimum = 0, .maximum = 4095});
  scan.points.fields.push_back({.name = "rowIndex", .minimum = 0, .maximum = 4095});
  scan.points.fields.push_back({.name = "columnIndex", .minimum = 0, .maximum = 8191});
  io::write_atomically(file, [&](const fs::path& temporary) {
    io::E57Writer writer(temporary);
    writer.begin_scan(scan);
    std::vector<std::vector<std::int64_t>> values(6);
    for (std::size_t first = 0; first < columns; first += kColumnsAtOnce) {
      for (auto& column : values) column.clear();
      for (std::size_t i = 0; i < kColumnsAtOnce * kRows; ++i) {
        const std::uint64_t noise = (first * kRows + i) * 0x9E3779B97F4A7C15ull;
        for (std::size_t k = 0; k < 3; ++k)
          values[k].push_back(static_cast<std::int64_t>(noise >> (4 + 20 * k) & 0xfffff) - kHalf);
        values[3].push_back(static_cast<std::int64_t>(noise >> 52));
        values[4].push_back(static_cast<std::int64_t>(i % kRows));
        values[5].push_back(static_cast<std::int64_t>(first + i / kRows));
      }
      io::E57Records records{.count = values[0].size()};
      for (const auto& column : values) records.integers.emplace_back(column);
      records.reals.resize(values.size());
      writer.write(records);
    }
    writer.end_scan();
    writer.close();
  });
}

void report(const char* what, const Clock& clock, double points) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%-22s %7.3f s wall, %7.3f s processor: %6.1f M points/s, peak %ld MiB\n", what, clock.wall_s(),
              clock.cpu_s(), points / clock.wall_s() * 1e-6, usage.ru_maxrss >> 10);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Speed of the E57 reader");
  std::string folder = fs::temp_directory_path();
  double millions = 20;
  int threads = 2, runs = 5;
  app.add_option("--folder", folder, "where the file is written");
  app.add_option("--millions", millions, "of points");
  app.add_option("--threads", threads);
  app.add_option("--runs", runs);
  CLI11_PARSE(app, argc, argv);
  set_thread_count(threads);
  const fs::path file = fs::path(folder) / "hybrid-e57-speed.e57";
  Clock writing;
  write_scan(file, static_cast<std::size_t>(millions * 1e6) / (kRows * kColumnsAtOnce) * kColumnsAtOnce);
  std::string load;
  std::getline(std::ifstream("/proc/loadavg"), load);
  std::printf("%.1f MB, %d threads, load %s\n", static_cast<double>(fs::file_size(file)) * 1e-6, threads,
              load.c_str());
  const io::E57File opened(file);
  const io::E57Table& table = opened.contents().scans[0].points;
  report("writing", writing, static_cast<double>(table.count));
  for (int run = 0; run < runs; ++run) {
    const Clock columns;
    const std::array<std::size_t, 6> fields = {0, 1, 2, 3, 4, 5};
    std::atomic<std::int64_t> sum{0};
    const io::E57TableReader reader = opened.open(table);
    reader.read(fields, 0, reader.count(),
                [&](const io::E57Records& records) { sum += records.integers[5].back(); });
    report("columns as stored", columns, static_cast<double>(table.count));
  }
  for (int run = 0; run < runs; ++run) {
    const Clock scan;
    const std::size_t points = io::read_e57(opened, 0).points.size();
    report("a scan with its grid", scan, static_cast<double>(points));
  }
  fs::remove(file);
}
