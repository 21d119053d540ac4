#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "archive/manifest.hpp"
#include "archive/store.hpp"

namespace hybrid::archive {

struct SlurmOptions {
  double bundle_s = 30;                  // estimated seconds of a task at least; starting one takes 0.2 s
  int cpus = 1;                          // per task
  std::vector<std::string> arguments;    // for every sbatch: --partition=..., --time=..., --mem=...
  std::vector<std::string> run_options;  // for every `hybrid batch run`: --retry, --device ...
  bool retry = false;                    // also what failed by its input, and what is in quarantine
};

// Units that one task of a job array runs, and all tasks of one kind of unit.
using Bundle = std::vector<std::size_t>;
struct SlurmStage {
  UnitKind kind;
  std::vector<Bundle> bundles;
};

// What the store lacks, in the manifest's order, as tasks of at least `bundle_s` estimated seconds (the last
// of a kind may be shorter), no more of them in all than `most_tasks`. Units whose failure is their input's
// are left out, with `retry` they are not; what needs a unit of these comes again, too.
std::vector<SlurmStage> bundle_units(const Store& store, const Manifest& manifest,
                                     const SlurmOptions& options, std::size_t most_tasks);

// "3,8-12": what `--unit` takes.
std::string unit_list(const Bundle& bundle);

// Submits job arrays of at most MaxArraySize tasks (as scontrol says) that run `hybrid batch run --unit`,
// planes first, scenes after the arrays that have their planes, then the report and the catalogue; each array
// starts when those that it needs have ended, however they have. Each asks for the time and memory that its
// largest task needs by the plan's estimates, with a reserve; `arguments` come after these. Tasks of a host
// that dies are queued again (--requeue); what they had done stays done. Lists, scripts and logs are in
// STORE/slurm/<number>/. Returns {"folder", "jobs": [{"job", "kind", "tasks", "units", "after"}]}, no jobs
// when nothing is to be done. Throws ErrorKind::failed with Slurm's own words when it refuses,
// ErrorKind::usage when there is no Slurm.
nlohmann::ordered_json submit_to_slurm(const Store& store, const Manifest& manifest,
                                       const SlurmOptions& options);
std::string slurm_text(const nlohmann::ordered_json& submission);

}  // namespace hybrid::archive
