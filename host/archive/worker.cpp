#include "archive/worker.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <unistd.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "archive/unit_run.hpp"
#include "core/error.hpp"
#include "core/fail_point.hpp"
#include "core/interrupt.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "core/memory_budget.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

void answer(const Json& json) {
  const std::string line = json_text(json, -1) + "\n";
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t count = write(kAnswerDescriptor, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) std::_Exit(exit_code(ErrorKind::failed));  // nobody listens any more
    done += static_cast<std::size_t>(count);
  }
}

Json failure_of(const Error& error) {
  return {{"ok", false}, {"error_kind", name_of(error.kind())}, {"error", error.what()}};
}

// stderr is this file while the object lives.
class Log {
 public:
  explicit Log(const fs::path& file) : saved_(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 10)) {
    const int opened = open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (opened < 0) fail(ErrorKind::failed, "{}: cannot be written", file.string());
    dup2(opened, STDERR_FILENO);
    close(opened);
  }
  ~Log() {
    dup2(saved_, STDERR_FILENO);
    close(saved_);
  }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

 private:
  int saved_;
};

class Worker {
 public:
  Worker(const fs::path& store, const std::string& device)
      : store_(Store::open(store)), head_(read_manifest_head(store_.plan_in_force())), queue_(device) {
    if (const auto build = build_identity(device); build != head_.build)
      fail(ErrorKind::failed,
           "the plan is for another program or machine ({} {} {}), this one is {} {} {}; make the plan again "
           "here",
           head_.build.all_sources, head_.build.kind, head_.build.device, build.all_sources, build.kind,
           build.device);
  }

  Json run(const Json& job) {
    const auto number = job.at("unit").get<std::size_t>();
    const fs::path work = job.at("work").get<std::string>();
    Json result = {{"ok", true}};
    try {
      const Log log(work / "log.txt");
      fail_point("unit-begun");
      std::unique_ptr<MemoryBudget> budget;
      if (job.contains("memory")) budget = std::make_unique<MemoryBudget>(job["memory"], work);
      const Manifest manifest = read_units(store_.plan_in_force(), {number});
      const Unit& unit = manifest.units.back();  // it needs only earlier ones
      Outcomes outcomes(store_, manifest);       // the store goes on changing
      try {
        with_context(unit.id, [&] {
          try {
            run_unit(queue_, store_, manifest, unit, outcomes, job.at("key"), work,
                     job.at("keep").get<std::uint64_t>());
          } catch (const Error& error) {
            result = failure_of(error);  // without the context: a scene's scan fails in the run's own words
            throw;
          }
        });
      } catch (const Error& error) {
        log::error("{}", error.what());
        if (result["ok"]) result = failure_of(error);
      }
    } catch (const Error& error) {
      result = failure_of(error);
    }
    result["unit"] = number;
    return result;
  }

 private:
  Store store_;
  Manifest head_;  // no units: of thousands this process reads those that it runs
  device::Queue queue_;
};

// What a unit has freed stays for the next one only where that comes at once.
void give_back_when_idle() {
  constexpr int kAtOnce_ms = 100;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, kAtOnce_ms) == 0) malloc_trim(0);
}

}  // namespace

int run_worker(const fs::path& store, const std::string& device) {
  std::unique_ptr<Worker> worker;
  try {
    worker = std::make_unique<Worker>(store, device);
  } catch (const Error& error) {
    Json json = failure_of(error);
    json["ready"] = false;
    answer(json);
    return exit_code(error.kind());
  }
  fail_point("worker-made");
  answer({{"ready", true}});
  for (std::string line; std::getline(std::cin, line);) {
    const Json job = Json::parse(line, nullptr, false);
    if (!job.is_object()) return exit_code(ErrorKind::usage);
    const Json result = worker->run(job);
    answer(result);
    if (result.value("error_kind", "") == name_of(ErrorKind::interrupted))
      return exit_code(ErrorKind::interrupted);
    give_back_when_idle();
  }
  return 0;
}

}  // namespace hybrid::archive
