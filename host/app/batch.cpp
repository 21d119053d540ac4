#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <iostream>
#include <map>

#include "app/batch_nightly.hpp"
#include "app/commands.hpp"
#include "archive/audit.hpp"
#include "archive/engine.hpp"
#include "archive/plan.hpp"
#include "archive/plan_loss.hpp"
#include "archive/store_lock.hpp"
#include "archive/worker.hpp"
#include "core/fail_point.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "io/output.hpp"

namespace hybrid::app {
namespace {

using archive::Manifest;
using archive::Store;
using archive::StoreLock;
namespace fs = std::filesystem;

// Options that every batch command has.
struct BatchOptions {
  fs::path store;
  std::string device, log_level = "info";
  bool json = false, quiet = false, wait = false;
};

std::shared_ptr<BatchOptions> add_options(CLI::App& command) {
  auto options = std::make_shared<BatchOptions>();
  command.add_flag("--json", options->json, "print one JSON document on stdout");
  command.add_flag("--quiet", options->quiet, "no progress; warnings and errors only");
  command.add_option("--log-level", options->log_level, "debug, info, warning, error or off");
  return options;
}

void add_store(CLI::App& command, const std::shared_ptr<BatchOptions>& options) {
  command.add_option("--out", options->store, "the store")->required();
}
void add_store_argument(CLI::App& command, const std::shared_ptr<BatchOptions>& options) {
  command.add_option("store", options->store, "the store");
  command.add_option("--out", options->store, "the store");
}
void add_wait(CLI::App& command, const std::shared_ptr<BatchOptions>& options) {
  command.add_flag("--wait", options->wait, "where another process uses the store, wait for it");
}

void apply(const BatchOptions& options) {
  log::set_level(options.quiet && options.log_level == "info" ? "warning" : options.log_level);
  if (options.store.empty()) fail(ErrorKind::usage, "expected a store, found none; hybrid batch ... STORE");
}

void print(const BatchOptions& options, const nlohmann::ordered_json& json, const std::string& text) {
  std::cout << (options.json ? json_text(json) + "\n" : text);
}

// --- plan -------------------------------------------------------------------------------------------------

void write_manifest(const Store& store, const std::string& text) {
  std::error_code code;
  const fs::path kept = store.folder() / "manifests" / (archive::hash_of(text) + ".json");
  if (fs::exists(kept, code))
    fs::last_write_time(kept, fs::file_time_type::clock::now(), code);  // the latest again
  else
    io::write_text(kept, text);
  if (fs::exists(store.manifest_file(), code) && io::read_text(store.manifest_file()) == text) return;
  io::write_text(store.manifest_file(), text);
  fail_point("manifest-written");
}

void add_plan(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand("plan", "walks an archive and writes what is to be done into a store");
  auto options = add_options(*command);
  auto request = std::make_shared<archive::PlanRequest>();
  auto profile = std::make_shared<fs::path>();
  auto dry_run = std::make_shared<bool>(false), rehash = std::make_shared<bool>(false);
  command->add_option("archive", request->archive, "folder with scenes and scans")->required();
  add_store(*command, options);
  command->add_option("--profile", *profile, "TOML file with options for all scenes, and for single ones");
  command->add_option("--device", options->device, "cpu, gpu or an index of `hybrid devices`");
  command->add_flag("--dry-run", *dry_run,
                    "print the units that would be planned, with --json the manifest, and write nothing");
  command->add_flag("--verify", *rehash, "read every input again, whatever its size and time say");
  add_wait(*command, options);
  command->callback([=, &exit_code] {
    apply(*options);
    if (!profile->empty()) request->profile = *profile;
    request->build = archive::build_identity(options->device);
    std::optional<Store> store;
    std::optional<StoreLock> lock;
    const auto take_store = [&] {
      store = Store::create(options->store);
      if (!*dry_run) lock.emplace(*store, StoreLock::Sharing::alone, "a plan", options->wait);
    };
    Store::expect_free(options->store);
    if (Store::exists(options->store)) take_store();
    archive::InputCache cache(options->store / "inputs.json", request->build.planes_sources, *rehash);
    const Manifest manifest = archive::make_plan(*request, cache);
    for (const auto& file : cache.changed_unseen())
      log::warning("{}: another content under the same size and time; its units are made again", file);
    archive::expect_units(manifest);
    archive::PlanLoss loss;
    if (store) loss = archive::loss_since_last_night(*store, manifest);
    if (!*dry_run) {
      if (!store) take_store();  // nothing was wrong so far that would leave an empty one
      cache.save();
      write_manifest(*store, archive::to_text(manifest));
    }
    auto summary = archive::summary(manifest);
    if (loss.is_most()) {
      summary["gone"] = {{"of", loss.before}, {"units", loss.gone}};
      log::warning("{}", archive::describe(loss, manifest));
    }
    if (*dry_run && options->json)
      std::cout << archive::to_text(manifest);
    else
      print(*options, summary, (*dry_run ? archive::list_units(manifest) : "") + archive::describe(manifest));
    if (!manifest.problems.empty() || loss.is_most()) exit_code = 3;
  });
}

// --- run --------------------------------------------------------------------------------------------------

std::size_t parse_number(const std::string& text, const std::string& option) {
  std::size_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    fail(ErrorKind::usage, "{} {}: expected numbers of units such as 7 or 3,8-12", option, text);
  return value;
}

// "3,8-12" of so many units.
std::vector<std::size_t> parse_units(const std::string& text, const std::string& option, std::size_t count) {
  std::vector<std::size_t> units;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, comma - at);
    const auto dash = part.find('-');
    const std::size_t first = parse_number(part.substr(0, dash), option);
    const std::size_t last = dash == std::string::npos ? first : parse_number(part.substr(dash + 1), option);
    if (last < first || last >= count)
      fail(ErrorKind::usage, "{} {}: expected units from 0 to {}", option, part, count - 1);
    for (std::size_t unit = first; unit <= last; ++unit) units.push_back(unit);
    at = comma + 1;
  }
  return units;
}

// From --unit, else from a scheduler that runs one task per unit.
std::optional<std::vector<std::size_t>> chosen_units(const std::string& text, std::size_t count) {
  if (text == "all") return std::nullopt;
  if (!text.empty()) return parse_units(text, "--unit", count);
  for (const char* name : {"SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"})
    if (const char* value = std::getenv(name)) {
      log::info("unit {} by {}; --unit says otherwise", value, name);
      return parse_units(value, name, count);
    }
  return std::nullopt;
}

// Where the units of these numbers stand in a part of the plan.
std::vector<std::size_t> places_of(const std::vector<std::size_t>& numbers, const Manifest& manifest) {
  std::map<std::size_t, std::size_t> place;
  for (const archive::Unit& unit : manifest.units) place[unit.number] = unit.index;
  std::vector<std::size_t> places;
  for (const std::size_t number : numbers) places.push_back(place.at(number));
  return places;
}

void add_run_command(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand("run", "makes what a store's plan asks for and the store lacks");
  auto options = add_options(*command);
  auto engine = std::make_shared<archive::EngineOptions>();
  auto unit = std::make_shared<std::string>(), memory = std::make_shared<std::string>(),
       unit_memory = std::make_shared<std::string>();
  add_store(*command, options);
  command->add_option("--unit", *unit,
                      "these units of the plan alone: 7 or 3,8-12, or all; default: SLURM_ARRAY_TASK_ID or "
                      "JOB_COMPLETION_INDEX where set, else all");
  command->add_option("--jobs", engine->jobs, "units in flight, 0 = one per core")
      ->check(CLI::Range(0, 4096));
  command->add_option("--threads", engine->threads, "cores for all units together, 0 = all")
      ->check(CLI::Range(0, 4096));
  command->add_option("--memory", *memory,
                      "for all units in flight, such as 8G (default: 4/5 of what is free)");
  command->add_option("--unit-memory", *unit_memory, "a unit that takes more is ended (default: --memory)");
  command->add_option("--unit-time", engine->unit_seconds, "seconds after which a unit is ended")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--retries", engine->retries, "of a unit whose process died, or that found the disk full")
      ->check(CLI::Range(0, 100));
  command->add_flag("--retry", engine->retry, "again what failed by its input, and what is in quarantine");
  command->add_option("--device", options->device, "cpu, gpu or an index of `hybrid devices`");
  const auto choice = add_engine_options(*command);
  add_wait(*command, options);
  command->callback([=, &exit_code] {
    apply(*options);
    const Store store = Store::open(options->store);
    if (choice->slurm_asked()) {
      submit_batch(*command, *choice, store, *unit, engine->retry, options->json);
      exit_code = 0;
      return;
    }
    if (!memory->empty()) engine->memory_bytes = parse_bytes(*memory, "--memory");
    if (!unit_memory->empty()) engine->unit_memory_bytes = parse_bytes(*unit_memory, "--unit-memory");
    engine->device = options->device;
    engine->quiet = options->quiet;
    engine->log_level = options->log_level;
    const fs::path plan = store.plan_in_force();
    const std::size_t count = archive::count_units(plan);
    if (count == 0)
      fail_input(
          "{}: the plan has no units: no scene and no scan was in {}; check that it is there and make "
          "the plan again",
          plan.string(), archive::read_manifest_head(plan).archive.string());
    const auto single = chosen_units(*unit, count);
    const StoreLock lock(store, single ? StoreLock::Sharing::with_units : StoreLock::Sharing::alone, "a run",
                         options->wait);
    // As it is under the lock. Of a plan of thousands of units one that runs a few reads these.
    const auto schedule = archive::Detail::schedule;
    const Manifest manifest =
        single ? archive::read_units(plan, *single, schedule) : archive::read_manifest(plan, schedule);
    if (single)
      engine->units = places_of(*single, manifest);
    else
      store.clear_work();
    const auto result = archive::run_units(store, manifest, *engine);
    print(*options, result.summary, archive::text_of(result));
    exit_code = result.exit_code;
  });
}

// What the engine starts: not for people.
void add_work(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand("work", "")->group("");
  auto common = std::make_shared<CommonOptions>();
  auto store = std::make_shared<fs::path>();
  command->add_option("--out", *store)->required();
  add_common_options(*command, *common);
  command->callback([=, &exit_code] {
    app::apply(*common);
    exit_code = archive::run_worker(*store, common->device);
  });
}

// --- looking after a store --------------------------------------------------------------------------------

void add_status(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand("status", "what of a store's plan is done, what failed and why");
  auto options = add_options(*command);
  add_store_argument(*command, options);
  command->callback([=, &exit_code] {
    apply(*options);
    const Store store = Store::open(options->store);
    const auto status = archive::store_status(
        store, archive::read_manifest(store.plan_in_force(), archive::Detail::schedule));
    print(*options, status, archive::status_text(status));
    exit_code = 0;
  });
}

void add_verify(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand("verify", "reads every object of a store and checks its checksums");
  auto options = add_options(*command);
  auto remove = std::make_shared<bool>(false);
  add_store_argument(*command, options);
  command->add_flag("--remove", *remove, "remove what is damaged; the next run makes it again");
  add_wait(*command, options);
  command->callback([=, &exit_code] {
    apply(*options);
    const Store store = Store::open(options->store);
    std::optional<StoreLock> lock;
    if (*remove) lock.emplace(store, StoreLock::Sharing::alone, "a verification", options->wait);
    const auto found = archive::verify_store(store, *remove);
    std::string text = fmt::format("{} objects, {} files, {} bytes: {} damaged\n",
                                   found["objects"].get<std::size_t>(), found["files"].get<std::size_t>(),
                                   found["bytes"].get<std::uintmax_t>(), found["damaged"].size());
    for (const auto& one : found["damaged"])
      text += fmt::format("{}: {}\n", one["path"].get<std::string>(), one["what"].get<std::string>());
    print(*options, found, text);
    exit_code = found["damaged"].empty() ? 0 : hybrid::exit_code(ErrorKind::failed);
  });
}

void add_prune(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand("prune", "removes objects that no plan of a store names");
  auto options = add_options(*command);
  auto keep = std::make_shared<std::size_t>(0);
  auto dry_run = std::make_shared<bool>(false);
  add_store_argument(*command, options);
  command->add_option("--keep", *keep, "drop all but so many of the newest plans first; 0 = keep all");
  command->add_flag("--dry-run", *dry_run, "say what would go, remove nothing");
  add_wait(*command, options);
  command->callback([=, &exit_code] {
    apply(*options);
    const Store store = Store::open(options->store);
    const StoreLock lock(store, StoreLock::Sharing::alone, "a pruning", options->wait);
    const auto found = archive::prune_store(store, *keep, *dry_run);
    print(*options, found,
          fmt::format("{} {} objects and notes of failures, {} bytes; {} in use, {} plans dropped\n",
                      *dry_run ? "would remove" : "removed", found["removed"].get<std::size_t>(),
                      found["bytes"].get<std::uintmax_t>(), found["kept"].get<std::size_t>(),
                      found["manifests_dropped"].get<std::size_t>()));
    exit_code = 0;
  });
}

}  // namespace

void add_batch(CLI::App& program, int& exit_code) {
  auto* batch = program.add_subcommand("batch", "archives of many scenes and scans, night after night");
  batch->require_subcommand(1);
  add_plan(*batch, exit_code);
  add_run_command(*batch, exit_code);
  add_work(*batch, exit_code);
  add_status(*batch, exit_code);
  add_verify(*batch, exit_code);
  add_prune(*batch, exit_code);
  add_gather(*batch, exit_code);
  add_diff(*batch, exit_code);
  add_bench(*batch, exit_code);
}

}  // namespace hybrid::app
