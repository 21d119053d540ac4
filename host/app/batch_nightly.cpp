#include "app/batch_nightly.hpp"

#include <iostream>
#include <sstream>

#include "archive/catalogue.hpp"
#include "archive/compare.hpp"
#include "archive/compare_page.hpp"
#include "archive/profile_bench.hpp"
#include "archive/store_lock.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "io/output.hpp"

namespace hybrid::app {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

void print(bool json, const Json& document, const std::string& text) {
  std::cout << (json ? json_text(document) + "\n" : text);
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace

void add_gather(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand(
      "gather", "makes STORE/catalogue.sqlite: results, figures and failures of every night, for SQL");
  auto store = std::make_shared<fs::path>();
  auto json = std::make_shared<bool>(false), wait = std::make_shared<bool>(false);
  command->add_option("store", *store, "the store")->required();
  command->add_flag("--json", *json, "print one JSON document on stdout");
  command->add_flag("--wait", *wait, "where another process uses the store, wait for it");
  command->callback([=, &exit_code] {
    const auto opened = archive::Store::open(*store);
    const archive::StoreLock lock(opened, archive::StoreLock::Sharing::with_units, "a catalogue", *wait);
    const Json made = archive::write_catalogue(opened);
    const auto count = [&](const char* name) { return made[name].get<std::int64_t>(); };
    print(*json, made,
          fmt::format("{}: {} nights, {} units, {} objects, {} figures, {} failures\n"
                      "page: {}\n",
                      made["catalogue"].get<std::string>(), count("nights"), count("units"), count("objects"),
                      count("figures"), count("failures"),
                      (opened.folder() / "results" / "report" / "index.html").string()));
    exit_code = 0;
  });
}

void add_diff(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand(
      "diff", "every figure and picture that differs between two stores, or two nights of one");
  auto before = std::make_shared<std::string>(), after = std::make_shared<std::string>();
  auto thresholds = std::make_shared<fs::path>(), out = std::make_shared<fs::path>();
  auto json = std::make_shared<bool>(false);
  auto pictures = std::make_shared<std::size_t>(200);
  command->add_option("before", *before, "STORE, STORE@1 (one night back), STORE@NAME; alone: STORE@1")
      ->required();
  command->add_option("after", *after, "the same; default: the plan in force of the first");
  command->add_option("--thresholds", *thresholds,
                      "TOML file: which way is worse, and by how much (host/archive/README.md)");
  command->add_option("--out", *out, "folder for a page with the pictures side by side");
  command->add_option("--pictures", *pictures, "pairs of pictures on the page at most");
  command->add_flag("--json", *json, "print one JSON document on stdout");
  command->callback([=, &exit_code] {
    const bool alone = after->empty();
    const std::string folder = before->substr(0, before->rfind('@'));
    const bool dated = before->find('@') != std::string::npos && !fs::exists(*before);
    const auto a = archive::open_night(alone && !dated ? *before + "@1" : *before);
    const auto b = archive::open_night(alone ? (dated ? folder : *before) : *after);
    const auto limits = thresholds->empty() ? io::ThresholdFile() : io::read_threshold_file(*thresholds);
    const Json comparison = archive::compare_nights(a, b, limits);
    if (!out->empty()) {
      io::create_output_folder(*out);
      io::write_text(*out / "diff.json", json_text(comparison) + "\n");
      archive::write_comparison_page(*out, comparison, a, b, *pictures);
    }
    std::string text = archive::comparison_text(comparison);
    if (!out->empty()) text += fmt::format("page: {}\n", (*out / "index.html").string());
    print(*json, comparison, text);
    exit_code = archive::exit_code(comparison);
  });
}

void add_bench(CLI::App& batch, int& exit_code) {
  auto* command = batch.add_subcommand(
      "bench", "processes an archive with several profiles and tabulates quality and time");
  auto request = std::make_shared<archive::BenchRequest>();
  auto json = std::make_shared<bool>(false);
  auto options = std::make_shared<std::string>();
  command->add_option("archive", request->archive, "folder with scenes and scans")->required();
  command
      ->add_option("--profiles", request->profiles, "TOML files, the first is what others are compared with")
      ->delimiter(',')
      ->required();
  command->add_option("--out", request->out, "a store per profile, bench.json and index.html")->required();
  command->add_option("--run", *options, "options for every `hybrid batch run`, such as \"--jobs 1\"");
  command->add_flag("--json", *json, "print one JSON document on stdout");
  command->callback([=, &exit_code] {
    request->run_options = words_of(*options);
    const Json bench = archive::run_bench(*request);
    archive::write_bench_page(request->out, bench);
    print(*json, bench,
          archive::bench_text(bench) + fmt::format("page: {}\n", (request->out / "index.html").string()));
    exit_code = 0;
    for (const auto& profile : bench["profiles"])
      if (profile["failures"] != 0) exit_code = 3;
  });
}

std::shared_ptr<EngineChoice> add_engine_options(CLI::App& command) {
  auto choice = std::make_shared<EngineChoice>();
  command.add_option("--engine", choice->engine, "local, or slurm: submits job arrays and returns")
      ->check(CLI::IsMember({"local", "slurm"}));
  command.add_option("--bundle", choice->slurm.bundle_s, "slurm: estimated seconds of a task at least")
      ->check(CLI::Range(0.0, 1e6));
  command.add_option("--cpus", choice->slurm.cpus, "slurm: cores per task")->check(CLI::Range(1, 4096));
  command.add_option("--slurm-args", choice->slurm_arguments,
                     "slurm: options for every sbatch, such as \"--partition=long --mem=8G\"");
  return choice;
}

void submit_batch(const CLI::App& command, const EngineChoice& choice, const archive::Store& store,
                  const std::string& units, bool retry, bool json) {
  if (!units.empty() && units != "all")
    fail(ErrorKind::usage, "--unit {}: --engine slurm submits all that is to be done", units);
  auto options = choice.slurm;
  options.arguments = words_of(choice.slurm_arguments);
  options.retry = retry;
  if (retry) options.run_options.push_back("--retry");
  for (const char* name :
       {"--memory", "--unit-memory", "--unit-time", "--retries", "--device", "--log-level"})
    if (const auto* option = command.get_option(name); option->count() > 0)
      options.run_options.insert(options.run_options.end(), {name, option->as<std::string>()});
  const auto manifest = archive::read_manifest(store.plan_in_force(), archive::Detail::schedule);
  const Json submission = archive::submit_to_slurm(store, manifest, options);
  print(json, submission, archive::slurm_text(submission));
}

}  // namespace hybrid::app
