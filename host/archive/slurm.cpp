#include "archive/slurm.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "archive/child_program.hpp"
#include "archive/outcome.hpp"
#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::string trimmed(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  return text;
}

// One line, for messages.
std::string words_of(const ProgramEnd& end) {
  std::string text = trimmed(end.err.empty() ? end.out : end.err);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

struct ClusterLimits {
  std::size_t array = 1001, jobs = 10000;
  std::size_t memory_mib = 0;  // of the largest host; 0: the cluster does not count memory
};

// Tasks of one array at most: what follows waits for whole arrays.
constexpr std::size_t kMostTasks = 200;

// Estimates may be wrong, and hosts slower: a task that asks for too little is killed, which costs more.
constexpr double kMemoryReserve = 1.5, kTimeReserve = 10;
constexpr int kLeastTime_min = 10;

// "MaxArraySize            = 1001"
std::size_t setting(const std::string& text, const std::string& name, std::size_t fallback) {
  const auto at = text.find(name);
  if (at == std::string::npos) return fallback;
  const auto digit = text.find_first_of("0123456789", at + name.size());
  if (digit == std::string::npos) return fallback;
  std::size_t value = 0;
  std::from_chars(text.data() + digit, text.data() + text.size(), value);
  return value;
}

ClusterLimits cluster_limits() {
  const auto end = run_program({"scontrol", "show", "config"});
  if (end.exit_code == 127)
    fail(ErrorKind::usage,
         "--engine slurm: expected Slurm's scontrol and sbatch on this host, found none; submit from a host "
         "of the cluster, or use --engine local");
  if (end.exit_code != 0)
    fail(ErrorKind::failed, "--engine slurm: scontrol show config: {}; is the cluster up?", words_of(end));
  ClusterLimits limits;
  limits.array = setting(end.out, "MaxArraySize", limits.array);
  limits.jobs = setting(end.out, "MaxJobCount", limits.jobs);
  if (limits.array < 2)
    fail(ErrorKind::failed, "--engine slurm: this cluster has no job arrays (MaxArraySize = {})",
         limits.array);
  const auto hosts =
      run_program({"sinfo", "--noheader", "--format=%m"});  // a line per kind of host: "64000", "64000+"
  std::istringstream lines(hosts.exit_code == 0 ? hosts.out : "");
  for (std::string line; std::getline(lines, line);)
    limits.memory_mib = std::max(limits.memory_mib, setting(line, "", 0));
  if (limits.memory_mib <= 1) limits.memory_mib = 0;  // 1: not configured
  return limits;
}

std::vector<bool> wanted_units(const Store& store, const Manifest& manifest, bool retry) {
  Outcomes outcomes(store, manifest);
  std::vector<bool> wanted(manifest.units.size(), false);
  for (const Unit& unit : manifest.units) {
    const Outcome& outcome = outcomes.of(unit.index);
    const bool lasting = outcome.state == UnitState::quarantined ||
                         (outcome.state == UnitState::failed && outcome.kind == ErrorKind::input);
    const bool made = outcome.state == UnitState::done || outcome.state == UnitState::partial;
    wanted[unit.index] =
        (!made && (retry || !lasting)) ||
        std::any_of(unit.needs.begin(), unit.needs.end(), [&](std::size_t need) { return wanted[need]; });
  }
  return wanted;
}

std::vector<Bundle> bundles_of(const Manifest& manifest, UnitKind kind, const std::vector<bool>& wanted,
                               double least_s) {
  std::vector<Bundle> bundles;
  double filled_s = least_s;
  for (const Unit& unit : manifest.units) {
    if (unit.kind != kind || !wanted[unit.index]) continue;
    if (filled_s >= least_s) {
      bundles.emplace_back();
      filled_s = 0;
    }
    bundles.back().push_back(unit.index);
    filled_s += unit.estimate_s;
  }
  return bundles;
}

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  text += "'";
  return text;
}

// Tasks have folders of their own.
std::string absolute_folder(const Store& store) {
  return fs::absolute(store.folder()).lexically_normal().string();
}

// Slurm gives % a meaning in the names of logs.
std::string log_file(const fs::path& folder, const std::string& name) {
  std::string text = "--output=";
  for (const char c : folder.string()) text += c == '%' ? std::string("%%") : std::string(1, c);
  return text + "/" + name;
}

// The lines of one shard's tasks are in the file that it gets as its argument. A full disk (75) may have
// room later: such a task goes back into the queue, three times.
std::string task_script(const Store& store, const SlurmOptions& options) {
  std::string command = quoted(own_program().string()) + " batch run --out " +
                        quoted(absolute_folder(store)) + " --unit \"$units\" --jobs " +
                        std::to_string(options.cpus) + " --threads " + std::to_string(options.cpus) +
                        " ${SLURM_MEM_PER_NODE:+--memory ${SLURM_MEM_PER_NODE}M}";
  for (const auto& option : options.run_options) command += fmt::format(" {}", quoted(option));
  return "#!/bin/sh\n"
         "# A task of a job array: the units on its line of the list.\n"
         "units=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" \"$1\")\n"
         "[ -n \"$units\" ] || { echo \"$1: no line $((SLURM_ARRAY_TASK_ID + 1))\" >&2; exit 2; }\n"
         "echo \"task $SLURM_ARRAY_TASK_ID on $(hostname), start ${SLURM_RESTART_COUNT:-0}: units "
         "$units\"\n" +
         command +
         "\ncode=$?\n"
         "if [ $code -eq 75 ] && [ \"${SLURM_RESTART_COUNT:-0}\" -lt 3 ]; then\n"
         "  scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\"\n"
         "fi\n"
         "exit $code\n";
}

std::string gather_script(const Store& store) {
  return "#!/bin/sh\nexec " + quoted(own_program().string()) + " batch gather --wait " +
         quoted(absolute_folder(store)) + "\n";
}

// The next free number.
fs::path submission_folder(const Store& store) {
  const fs::path root = fs::path(absolute_folder(store)) / "slurm";
  io::create_output_folder(root);
  for (int number = 1;; ++number) {
    std::error_code code;
    const fs::path folder = root / std::to_string(number);
    if (fs::create_directory(folder, code)) return folder;
    if (code && code != std::errc::file_exists)
      fail(ErrorKind::failed, "{}: cannot be made: {}", folder.string(), code.message());
  }
}

class Submission {
 public:
  explicit Submission(const SlurmOptions& options) : options_(options) {}

  // One sbatch, which waits for the jobs `after`; returns the job's number.
  std::string submit(const std::string& name, const std::vector<std::string>& own, const std::string& after,
                     const std::vector<std::string>& script) {
    std::vector<std::string> words = {"sbatch",
                                      "--parsable",
                                      "--requeue",
                                      "--open-mode=append",
                                      "--job-name=hybrid-" + name,
                                      "--cpus-per-task=" + std::to_string(options_.cpus)};
    if (!after.empty()) words.push_back("--dependency=afterany:" + after);
    words.insert(words.end(), own.begin(), own.end());
    words.insert(words.end(), options_.arguments.begin(), options_.arguments.end());
    words.insert(words.end(), script.begin(), script.end());
    const auto end = run_program(words);
    if (end.exit_code != 0)
      fail(ErrorKind::failed, "--engine slurm: sbatch refuses {}: {}; jobs submitted before it: {}", name,
           words_of(end), jobs_.empty() ? "none" : jobs_.dump());
    const std::string job = trimmed(end.out);
    return job.substr(0, job.find(';'));  // of several clusters: "number;cluster"
  }

  void add(const std::string& kind, const std::string& job, const std::string& after, std::size_t tasks,
           std::size_t units) {
    jobs_.push_back({{"job", job}, {"kind", kind}, {"tasks", tasks}, {"units", units}, {"after", after}});
    names_.push_back(job);
  }
  void add_unit(std::size_t unit) { place_[unit] = names_.size() - 1; }

  // The jobs that make what these units need.
  std::string jobs_before(const Manifest& manifest, const std::vector<Bundle>& bundles) const {
    std::set<std::size_t> places;
    for (const Bundle& bundle : bundles)
      for (const std::size_t unit : bundle)
        for (const std::size_t need : manifest.units[unit].needs)
          if (const auto place = place_.find(need); place != place_.end()) places.insert(place->second);
    std::string text;
    for (const std::size_t place : places) text += (text.empty() ? "" : ":") + names_[place];
    return text;
  }
  std::string all_jobs() const { return fmt::format("{}", fmt::join(names_, ":")); }
  const Json& jobs() const { return jobs_; }

 private:
  const SlurmOptions& options_;
  Json jobs_ = Json::array();
  std::vector<std::string> names_;            // of the jobs, in order
  std::map<std::size_t, std::size_t> place_;  // per unit: of its job in names_
};

// What the most demanding of these tasks needs, by the estimates.
std::vector<std::string> demands(const Manifest& manifest, const std::vector<Bundle>& bundles,
                                 const SlurmOptions& options, const ClusterLimits& limits) {
  double bytes = 0, seconds = 0;
  for (const Bundle& bundle : bundles) {
    double largest = 0, sum_s = 0;
    for (const std::size_t unit : bundle) {
      largest = std::max(largest, static_cast<double>(manifest.units[unit].estimate_bytes));
      sum_s += manifest.units[unit].estimate_s;
    }
    const auto in_flight = std::min<std::size_t>(bundle.size(), static_cast<std::size_t>(options.cpus));
    bytes = std::max(bytes, largest * static_cast<double>(in_flight));
    seconds = std::max(seconds, sum_s);
  }
  std::vector<std::string> words = {
      fmt::format("--time={}", kLeastTime_min + static_cast<int>(std::ceil(kTimeReserve * seconds / 60)))};
  // One larger than every host runs on the largest, where the engine sees how far it gets.
  if (limits.memory_mib > 0)
    words.push_back(fmt::format(
        "--mem={}M", std::min(static_cast<std::size_t>(std::ceil(kMemoryReserve * bytes / (1 << 20))),
                              limits.memory_mib)));
  return words;
}

void submit_stage(const Manifest& manifest, const SlurmStage& stage, const SlurmOptions& options,
                  const fs::path& folder, const ClusterLimits& limits, Submission& submission) {
  const std::string kind = name_of(stage.kind);
  const std::size_t most = std::min(limits.array, kMostTasks);
  for (std::size_t first = 0, shard = 0; first < stage.bundles.size(); first += most, ++shard) {
    const std::size_t last = std::min(first + most, stage.bundles.size());
    const std::vector<Bundle> bundles(stage.bundles.begin() + static_cast<std::ptrdiff_t>(first),
                                      stage.bundles.begin() + static_cast<std::ptrdiff_t>(last));
    const std::string name = fmt::format("{}-{}", kind, shard);
    std::string lines;
    std::size_t units = 0;
    for (const Bundle& bundle : bundles) {
      lines += unit_list(bundle) + "\n";
      units += bundle.size();
    }
    io::write_text(folder / (name + ".txt"), lines);
    std::vector<std::string> own = demands(manifest, bundles, options, limits);
    own.push_back(fmt::format("--array=0-{}", bundles.size() - 1));
    own.push_back(log_file(folder, name + "-%a.log"));
    const std::string after = submission.jobs_before(manifest, bundles);
    const std::string job = submission.submit(
        name, own, after, {(folder / "task.sh").string(), (folder / (name + ".txt")).string()});
    submission.add(kind, job, after, bundles.size(), units);
    for (const Bundle& bundle : bundles)
      for (const std::size_t unit : bundle) submission.add_unit(unit);
  }
}

}  // namespace

std::string unit_list(const Bundle& bundle) {
  std::string text;
  for (std::size_t i = 0; i < bundle.size();) {
    std::size_t end = i + 1;
    while (end < bundle.size() && bundle[end] == bundle[end - 1] + 1) ++end;
    if (!text.empty()) text += ",";
    text += end - i > 1 ? fmt::format("{}-{}", bundle[i], bundle[end - 1]) : fmt::format("{}", bundle[i]);
    i = end;
  }
  return text;
}

std::vector<SlurmStage> bundle_units(const Store& store, const Manifest& manifest,
                                     const SlurmOptions& options, std::size_t most_tasks) {
  const auto wanted = wanted_units(store, manifest, options.retry);
  double least_s = options.bundle_s;
  for (;; least_s = std::max(1.0, 2 * least_s)) {
    std::vector<SlurmStage> stages;
    std::size_t tasks = 0;
    for (const UnitKind kind : {UnitKind::planes, UnitKind::scene, UnitKind::report}) {
      auto bundles = bundles_of(manifest, kind, wanted, least_s);
      tasks += bundles.size();
      if (!bundles.empty()) stages.push_back({kind, std::move(bundles)});
    }
    if (tasks <= std::max(most_tasks, stages.size())) return stages;
  }
}

Json submit_to_slurm(const Store& store, const Manifest& manifest, const SlurmOptions& options) {
  const ClusterLimits limits = cluster_limits();
  // Half of what the controller holds: others use the cluster, too.
  const auto stages = bundle_units(store, manifest, options, std::max<std::size_t>(1, limits.jobs / 2));
  if (stages.empty()) return {{"folder", nullptr}, {"jobs", Json::array()}};
  const fs::path folder = submission_folder(store);
  io::write_text(folder / "task.sh", task_script(store, options));
  io::write_text(folder / "gather.sh", gather_script(store));
  Submission submission(options);
  for (const SlurmStage& stage : stages) submit_stage(manifest, stage, options, folder, limits, submission);
  const std::string all = submission.all_jobs();
  const std::string job =
      submission.submit("gather", {log_file(folder, "gather.log")}, all, {(folder / "gather.sh").string()});
  submission.add("gather", job, all, 1, 0);
  return {{"folder", folder.string()}, {"jobs", submission.jobs()}};
}

std::string slurm_text(const Json& submission) {
  std::string text;
  for (const auto& job : submission["jobs"]) {
    text += fmt::format("job {}: {}, {} tasks", job["job"].get<std::string>(), job["kind"].get<std::string>(),
                        job["tasks"].get<std::size_t>());
    if (job["kind"] != "gather") text += fmt::format(" with {} units", job["units"].get<std::size_t>());
    if (job["after"] != "") text += ", after " + job["after"].get<std::string>();
    text += "\n";
  }
  if (text.empty()) return "nothing to do\n";
  return text + fmt::format("logs: {}\n", submission["folder"].get<std::string>());
}

}  // namespace hybrid::archive
