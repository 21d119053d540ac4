// Times listing and reading of scan files, their way to a range image, and of a text file's numbers alone, by
// our parser and by std::from_chars on one thread. Prints JSON. CPU seconds tell what a busy machine's wall
// clock does not.
#include <sys/resource.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "io/exr/exr_parts.hpp"
#include "io/exr/exr_threads.hpp"
#include "io/grid_scan.hpp"
#include "io/input_file.hpp"
#include "io/read_scan.hpp"
#include "io/text/decimal.hpp"
#include "stages/scan/organised_grid.hpp"

namespace {
using Json = nlohmann::ordered_json;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

long peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss >> 10;
}

struct Seconds {
  double wall = 0, cpu = 0;
};

// The fastest of some runs.
template <typename Body>
Seconds fastest(int runs, const Body& body) {
  Seconds best{1e9, 1e9};
  for (int i = 0; i < runs; ++i) {
    const double before = cpu_seconds();
    const hybrid::Timer timer;
    body();
    best = {std::min(best.wall, timer.seconds()), std::min(best.cpu, cpu_seconds() - before)};
  }
  return best;
}

// Organised scans alone: an unorganised one needs the device. The way that `hybrid planes` takes, or with
// `by_list` the one of other formats, by a list of samples.
Json image_figures(const std::filesystem::path& file, int runs, bool by_list) {
  std::size_t samples = 0;
  const Seconds time = fastest(runs, [&] {
    samples = 0;
    for (const auto& entry : hybrid::io::list_scans(file)) {
      if (auto grid = by_list ? std::nullopt : hybrid::io::read_grid_scan(file, entry)) {
        if (!grid->has_tables)
          hybrid::stages::orient_grid(grid->image, grid->rows_reversed, grid->cols_reversed);
        samples += grid->samples;
        continue;
      }
      const hybrid::Scan scan = hybrid::io::read_scan(file, entry);
      samples += scan.points.size();
      hybrid::stages::arrange_grid(scan);
    }
  });
  return {{"file", file.filename().string()},
          {"samples", samples},
          {"image_s", time.wall},
          {"image_cpu_s", time.cpu},
          {"million_samples_per_s", 1e-6 * static_cast<double>(samples) / time.wall},
          {"peak_mib", peak_mib()}};
}

// The ranges of a range image alone, as a preview or a change detection needs them.
Json range_figures(const std::filesystem::path& file, int runs) {
  std::size_t samples = 0;
  const Seconds time = fastest(runs, [&] {
    hybrid::io::ExrParts image(file, hybrid::io::start_exr_threads());
    samples = static_cast<std::size_t>(image.rows()) * static_cast<std::size_t>(image.cols());
    std::vector<float> range(samples);
    const auto cols = static_cast<std::size_t>(image.cols());
    Imf::FrameBuffer buffer;
    buffer.insert("range", Imf::Slice::Make(Imf::FLOAT, range.data(), image.header().dataWindow(),
                                            sizeof(float), sizeof(float) * cols));
    image.read(buffer, 0, image.rows());
  });
  return {{"file", file.filename().string()},
          {"samples", samples},
          {"range_s", time.wall},
          {"range_cpu_s", time.cpu},
          {"million_samples_per_s", 1e-6 * static_cast<double>(samples) / time.wall}};
}

Json read_figures(const std::filesystem::path& file, int runs) {
  std::vector<hybrid::io::ScanEntry> entries;
  const Seconds list = fastest(runs, [&] { entries = hybrid::io::list_scans(file); });
  std::size_t samples = 0;
  const Seconds read = fastest(runs, [&] {
    samples = 0;
    for (const auto& entry : entries) samples += hybrid::io::read_scan(file, entry).points.size();
  });
  return {{"file", file.filename().string()},
          {"scans", entries.size()},
          {"samples", samples},
          {"list_s", list.wall},
          {"list_cpu_s", list.cpu},
          {"read_s", read.wall},
          {"read_cpu_s", read.cpu},
          {"million_samples_per_s", 1e-6 * static_cast<double>(samples) / read.wall},
          {"million_samples_per_cpu_s", 1e-6 * static_cast<double>(samples) / read.cpu},
          {"peak_mib", peak_mib()}};
}

// One line, as programs of bench/peers report.
Json report_of(const Json& figures, int threads) {
  return {{"seconds", figures["list_s"].get<double>() + figures["read_s"].get<double>()},
          {"samples", figures["samples"]},
          {"package", "hybrid"},
          {"settings", fmt::format("all samples in memory with their grid, {} threads",
                                   threads > 0 ? std::to_string(threads) : "all")}};
}

// Numbers per second of the text's first MiB's, parsed by parse(at, end, value).
template <typename Parse>
double numbers_per_cpu_s(const std::string& text, int runs, const Parse& parse) {
  std::size_t count = 0;
  double sum = 0;
  const Seconds time = fastest(runs, [&] {
    count = 0;
    const char *at = text.data(), *end = at + text.size();
    while (at != end) {
      double value = 0;
      const char* next = static_cast<unsigned char>(*at) > ' ' ? parse(at, end, value) : nullptr;
      count += next != nullptr;
      sum += value;
      at = next != nullptr ? next : at + 1;
    }
  });
  if (sum == 0.5) std::cerr << "\n";  // so that nothing is left out
  return static_cast<double>(count) / time.cpu;
}

Json parser_figures(const std::filesystem::path& file, int runs) {
  const hybrid::io::InputFile input(file);
  std::string text(std::min<std::uint64_t>(input.size(), 64 << 20), '\0');
  input.read(0, text);
  const auto library = [](const char* at, const char* end, double& value) {
    const auto [next, code] = std::from_chars(at, end, value);
    return code == std::errc{} ? next : nullptr;
  };
  return {{"file", file.filename().string()},
          {"parse_number_million_per_s", 1e-6 * numbers_per_cpu_s(text, runs, hybrid::io::parse_number)},
          {"from_chars_million_per_s", 1e-6 * numbers_per_cpu_s(text, runs, library)}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Times the reading of scan files; prints JSON, the fastest of --runs"};
  std::vector<std::filesystem::path> files;
  int runs = 5, threads = 0;
  bool numbers = false, report = false, image = false, range = false, by_list = false;
  app.add_option("files", files, "scan files")->required();
  app.add_option("--runs", runs, "counted runs")->check(CLI::Range(1, 1000));
  app.add_option("--threads", threads, "threads, 0 = all cores");
  app.add_flag("--numbers", numbers, "of text files: their numbers alone, on one thread");
  app.add_flag("--image", image, "of organised scans: the whole way to a range image in memory");
  app.add_flag("--by-list", by_list, "with --image: by a list of samples, as formats other than E57 go");
  app.add_flag("--range", range, "of range images: their channel range alone");
  app.add_flag("--report", report, "of one file: a line for bench/peers instead");
  CLI11_PARSE(app, argc, argv);
  try {
    hybrid::set_thread_count(threads);
    if (report) {
      std::cout << report_of(read_figures(files.at(0), runs), threads).dump() << "\n";
      return 0;
    }
    Json rows = Json::array();
    for (const auto& file : files)
      rows.push_back(numbers ? parser_figures(file, runs)
                     : image ? image_figures(file, runs, by_list)
                     : range ? range_figures(file, runs)
                             : read_figures(file, runs));
    std::cout << rows.dump(1) << "\n";
  } catch (const hybrid::Error& error) {
    std::cerr << error.what() << "\n";
    return hybrid::exit_code(error.kind());
  }
}
