#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <optional>

#include "room/room.hpp"

namespace {

const std::map<std::string, synth::Preset> kPresets = {
    {"tiny", {"tiny", 500, 220, 320, 240, 320, 180, 4}},
    {"demo", {"demo", 1800, 750, 1600, 1200, 1280, 720, 4}}};

// Whole and not negative; what does not fit would be cut silently.
const CLI::Validator kSeed(
    [](const std::string& text) -> std::string {
      std::uint64_t value = 0;
      const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
      const bool whole = parsed.ec == std::errc() && parsed.ptr == text.data() + text.size();
      return whole ? "" : fmt::format("expected a whole number from 0 to 2^64 - 1, found {}", text);
    },
    "UINT");

// CLI::Range lets nan pass.
CLI::Validator within(double minimum, double maximum) {
  return CLI::Validator(
      [=](const std::string& text) -> std::string {
        double value = 0;
        const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool number = parsed.ec == std::errc() && parsed.ptr == text.data() + text.size();
        return number && value >= minimum && value <= maximum
                   ? ""
                   : fmt::format("expected a number from {} to {}, found {}", minimum, maximum, text);
      },
      fmt::format("{} to {}", minimum, maximum));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Makes synthetic scenes with known truth, traced with Embree", "hybrid-synth"};
  app.set_version_flag("--version", "hybrid-synth 0.1.0");
  app.require_subcommand(1);
  CLI::App* room = app.add_subcommand("room", "A furnished room: two scans, six photographs, a box as proxy");

  synth::RoomOptions options;
  std::string folder, preset = "demo";
  int threads = 0, scan_columns = 0, scan_rows = 0;
  bool json = false, quiet = false;
  room->add_option("--out", folder, "Folder for the scene; made when it is not there")->required();
  room->add_option("--seed", options.seed, "Same seed, same bytes")->check(kSeed)->capture_default_str();
  room->add_option("--preset", preset, "tiny: for tests; demo: for people")
      ->check(CLI::IsMember({"tiny", "demo"}))
      ->capture_default_str();
  room->add_option("--noise-m", options.noise_m, "Range noise along the ray, standard deviation")
      ->check(within(0.0, 0.1))
      ->capture_default_str();
  room->add_option("--dropout", options.dropout_share, "Share of samples that do not return")
      ->check(within(0.0, 0.9))
      ->capture_default_str();
  room->add_option("--proxy-error-m", options.proxy_error_m,
                   "Moves each face of the proxy along its normal, standard deviation; the corners follow")
      ->check(within(0.0, 0.5))
      ->capture_default_str();
  room->add_option("--scan-columns", scan_columns,
                   "Columns per scan, 0: the preset's; bench/compare.sh sets it")
      ->check(CLI::Range(0, 100000));
  room->add_option("--scan-rows", scan_rows, "Samples per column, 0: the preset's")
      ->check(CLI::Range(0, 100000));
  room->add_option("--threads", threads, "0: as many as the machine has")->check(CLI::NonNegativeNumber);
  room->add_flag("--json", json, "Summary as JSON on stdout");
  room->add_flag("--quiet", quiet, "No summary on stderr");

  if (argc > 1 && argv[1][0] != '-' && std::string(argv[1]) != room->get_name()) {
    fmt::print(stderr, "hybrid-synth: unknown scene \"{}\"; Known: room; --help explains it\n", argv[1]);
    return 2;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem, std::cout, std::cerr) == 0 ? 0 : 2;
  }
  try {
    std::optional<tbb::global_control> limit;
    if (threads > 0)
      limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    options.preset = kPresets.at(preset);
    if (scan_columns > 0) options.preset.scan_columns = scan_columns;
    if (scan_rows > 0) options.preset.scan_rows = scan_rows;
    const synth::Summary summary = synth::generate_room(options, folder);
    if (!quiet) fmt::print(stderr, "{}", summary.text);
    if (json) fmt::print("{}", summary.json);
    return 0;
  } catch (const std::exception& problem) {
    fmt::print(stderr, "hybrid-synth room: {}\n", problem.what());
    return 1;
  }
}
