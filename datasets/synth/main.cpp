// hybrid-synth: scenes whose truth is known to the bit. A World (world/) is built from a seed by room/ or
// church/ out of closed solids with true planes (geometry/), painted by functions of place alone (surface/),
// scanned and photographed with Embree (trace/) and written as a user's files plus truth (write/). Nothing
// here includes host/.
//
//   hybrid-synth room    --out DIR --seed 1 --preset tiny|demo [--megapixels M]
//   hybrid-synth church  --out DIR --seed 1 --preset tiny|demo|full [--megapixels M] [--proxy-error 0.02]
//                       [--only-scan nave]          that scan alone, the same bytes
//                       [--scans 25]                more stations: before the door, round the church, along
//                       its aisles, in the door
//   hybrid-synth archive N --out DIR --seed 1        scene-0000 ...: small churches, seeds one apart
//                       [--from 101]                those that an earlier, interrupted call has made stay
//
// DIR holds scene.toml (written last), proxy.obj, scans/, photographs/, cameras/ (COLMAP), detail.ply (the
// true mesh), truth.json and truth/. The church's scans: `front` outside and `nave` as PLY without a grid,
// `chancel` as PTX with one (--format: all as PLY, PTX, EXR or E57); truth/<scan>.exr has kinds 0 planar, 1
// curved, 2 mixed, 3 ghost behind glass.
#include <ImfThreading.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "church/church.hpp"
#include "room/room.hpp"
#include "world/generate.hpp"
#include "write/files.hpp"

namespace {

const std::map<std::string, synth::Preset> kRoomPresets = {
    {"tiny", {"tiny", 500, 220, 320, 240, 320, 180, 4}},
    {"demo", {"demo", 1800, 750, 1600, 1200, 1280, 720, 4}}};
const std::map<std::string, synth::Preset> kChurchPresets = {
    {"tiny", {"tiny", 480, 200, 240, 180, 240, 136, 2, 0.8, 24}},
    {"demo", {"demo", 1700, 700, 1440, 1080, 1120, 630, 3, 0.3, 96}},
    {"full", {"full", 6700, 3000, 4032, 3024, 1920, 1080, 4, 0.2, 160}}};

const std::map<std::string, synth::ScanFormat> kFormats = {{"ply", synth::ScanFormat::ply},
                                                           {"ptx", synth::ScanFormat::ptx},
                                                           {"exr", synth::ScanFormat::exr},
                                                           {"e57", synth::ScanFormat::e57}};

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

struct Request {
  synth::Options options;
  std::string folder, preset, format, only_scan;
  std::optional<double> megapixels, photograph_variation;
  int threads = 0, scenes = 0, from = 0;
  bool json = false, quiet = false;
};

void add_common(CLI::App& command, Request& r, const std::map<std::string, synth::Preset>& presets,
                const std::string& preset) {
  synth::Options& options = r.options;
  std::vector<std::string> names;
  for (const auto& [name, value] : presets) names.push_back(name);
  command.add_option("--out", r.folder, "Folder for the scene; made when it is not there")->required();
  command.add_option("--seed", options.seed, "Same seed, same bytes")->check(kSeed)->capture_default_str();
  command
      .add_option("--preset", r.preset,
                  fmt::format("tiny: for tests; demo: for people{} (default: {})",
                              presets.contains("full") ? "; full: 3 x 20 megapixels" : "", preset))
      ->check(CLI::IsMember(names));
  command.add_option("--noise-m", options.scanner.noise_m, "Range noise along the ray, standard deviation")
      ->check(within(0.0, 0.1))
      ->capture_default_str();
  command.add_option("--dropout", options.scanner.dropout_share, "Share of samples that do not return")
      ->check(within(0.0, 0.9))
      ->capture_default_str();
  command
      .add_option("--proxy-error-m,--proxy-error", options.proxy_error_m,
                  "Moves each face of the proxy along its normal, standard deviation; the corners follow")
      ->check(within(0.0, 0.5))
      ->capture_default_str();
  command
      .add_option("--camera-error", options.camera_error,
                  "How far the written cameras' directions are off, pixels, standard deviation")
      ->check(within(0.0, 50.0))
      ->capture_default_str();
  command
      .add_option("--megapixels", r.megapixels, "Samples of each scan, in millions, instead of the preset's")
      ->check(within(0.05, 400.0));
  command
      .add_option(
          "--format", r.format,
          "Of every scan's file: ply: returns in acquisition order; ptx: a grid with a row for each "
          "step of the mirror, columns that start elsewhere included; exr: the same grid as a tiled "
          "range image; e57: returns with row, column and pose, and photographs in E57 files: a panorama "
          "from every scanner, and those of the lens, which has no distortion then. Default: ptx for a "
          "scanner whose columns are even, else ply")
      ->check(CLI::IsMember({"ply", "ptx", "exr", "e57"}));
  command.add_option("--threads", r.threads, "0: as many as the machine has")->check(CLI::NonNegativeNumber);
  command.add_flag("--json", r.json, "Summary as JSON on stdout");
  command.add_flag("--quiet", r.quiet, "No summary on stderr");
}

void add_only_scan(CLI::App& command, Request& r) {
  command.add_option("--only-scan", r.only_scan,
                     "This scan and its truth, the same bytes as in the whole scene, and nothing else: no "
                     "photographs, no views");
}

void add_church_options(CLI::App& command, Request& r) {
  command
      .add_option(
          "--scans", r.options.scans,
          "front, nave, chancel, then before the door, round the church and along its aisles, in the door")
      ->check(CLI::Range(3, 25))
      ->capture_default_str();
  synth::ScannerModel& scanner = r.options.scanner;
  command
      .add_option("--noise-per-m", scanner.noise_per_m, "What the noise grows by with every metre of range")
      ->check(within(0.0, 0.01))
      ->capture_default_str();
  command
      .add_option(
          "--photograph-variation", r.photograph_variation,
          "1: exposure differs by 10 %, white balance by 4 %, corners are 25 % darker; default 1 with "
          "the preset full, else 0, as no blending evens it out")
      ->check(within(0.0, 3.0));
}

// Presets and what depends on them.
void settle(Request& r, const std::map<std::string, synth::Preset>& presets, const std::string& preset) {
  if (!r.format.empty()) r.options.scan_format = kFormats.at(r.format);
  r.options.preset = presets.at(r.preset.empty() ? preset : r.preset);
  if (r.megapixels) {
    const double factor =
        std::sqrt(*r.megapixels * 1e6 / r.options.preset.scan_columns / r.options.preset.scan_rows);
    r.options.preset.scan_columns = static_cast<int>(std::lround(r.options.preset.scan_columns * factor));
    r.options.preset.scan_rows = static_cast<int>(std::lround(r.options.preset.scan_rows * factor));
  }
  r.options.photograph_variation = r.photograph_variation.value_or(r.options.preset.name == "full" ? 1 : 0);
}

void tell(const Request& r, const synth::Summary& summary) {
  if (!r.quiet) fmt::print(stderr, "{}", summary.text);
  if (r.json) fmt::print("{}", summary.json);
}

void make_archive(Request& r) {
  const std::uint64_t first = r.options.seed;
  synth::check_free_space(r.folder, std::max(r.scenes - r.from, 0) *
                                        synth::estimate_bytes(synth::build_church(r.options), r.options));
  for (int i = r.from; i < r.scenes; ++i) {
    r.options.seed = first + static_cast<std::uint64_t>(i);
    synth::World world = synth::build_church(r.options);
    if (r.options.scan_format == synth::ScanFormat::e57) synth::remove_distortion(world);
    tell(r, synth::generate(world, r.options, fmt::format("{}/scene-{:04}", r.folder, i)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Makes synthetic scenes with known truth, traced with Embree", "hybrid-synth"};
  app.set_version_flag("--version", "hybrid-synth 0.1.0");
  app.require_subcommand(1);
  CLI::App* room = app.add_subcommand("room", "A furnished room: two scans, six photographs, a box as proxy");
  CLI::App* church = app.add_subcommand(
      "church", "A church: three scans inside and out, ten or twelve photographs, its blocks as proxy");
  CLI::App* archive =
      app.add_subcommand("archive", "Many small churches, scene-0000 and on, seeds one apart");
  Request of_room, of_church, of_archive;
  add_common(*room, of_room, kRoomPresets, "demo");
  add_only_scan(*room, of_room);
  for (Request* r : {&of_church, &of_archive})
    r->options.scanner = {.noise_m = 0.0015,
                          .noise_per_m = 0.0001,
                          .incidence_gain = 0.03,
                          .dropout_share = 0.02,
                          .optics = true};
  add_common(*church, of_church, kChurchPresets, "demo");
  add_church_options(*church, of_church);
  add_only_scan(*church, of_church);
  archive->add_option("scenes", of_archive.scenes, "How many")->required()->check(CLI::Range(1, 100000));
  archive->add_option("--from", of_archive.from, "Number of the first scene to make; those before it stay")
      ->check(CLI::Range(0, 99999));
  add_common(*archive, of_archive, kChurchPresets, "tiny");
  add_church_options(*archive, of_archive);

  const auto known = [&](const std::string& name) {
    return name == "room" || name == "church" || name == "archive";
  };
  if (argc > 1 && argv[1][0] != '-' && !known(argv[1])) {
    fmt::print(stderr,
               "hybrid-synth: unknown scene \"{}\"; Known: room, church, archive; --help explains them\n",
               argv[1]);
    return 2;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem, std::cout, std::cerr) == 0 ? 0 : 2;
  }
  const std::string what = room->parsed() ? "room" : church->parsed() ? "church" : "archive";
  Request& request = room->parsed() ? of_room : church->parsed() ? of_church : of_archive;
  try {
    std::optional<tbb::global_control> limit;
    if (request.threads > 0)
      limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(request.threads));
    // Truth images are compressed by as many threads; the bytes are the same.
    Imf::setGlobalThreadCount(request.threads > 0 ? request.threads
                                                  : static_cast<int>(std::thread::hardware_concurrency()));
    settle(request, room->parsed() ? kRoomPresets : kChurchPresets, archive->parsed() ? "tiny" : "demo");
    if (archive->parsed()) {
      make_archive(request);
      return 0;
    }
    synth::World world =
        room->parsed() ? synth::build_room(request.options) : synth::build_church(request.options);
    if (request.options.scan_format == synth::ScanFormat::e57) synth::remove_distortion(world);
    if (!request.only_scan.empty()) synth::keep_only_scan(world, request.only_scan);
    tell(request, synth::generate(world, request.options, request.folder));
    return 0;
  } catch (const std::invalid_argument& problem) {
    fmt::print(stderr, "hybrid-synth {}: {}\n", what, problem.what());
    return 2;
  } catch (const std::system_error& problem) {
    const bool full = problem.code() == std::errc::no_space_on_device;
    fmt::print(stderr, "hybrid-synth {}: {}{}\n", what, problem.what(),
               full ? "; free space and run again" : "; give another --out");
    return full ? 75 : 1;
  } catch (const std::exception& problem) {
    fmt::print(stderr, "hybrid-synth {}: {}\n", what, problem.what());
    return 1;
  }
}
