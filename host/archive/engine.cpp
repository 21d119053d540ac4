#include "archive/engine.hpp"

#include <poll.h>

#include <algorithm>
#include <csignal>
#include <list>
#include <memory>
#include <set>

#include "archive/machine.hpp"
#include "archive/outcome.hpp"
#include "archive/run_progress.hpp"
#include "archive/slot.hpp"
#include "core/error.hpp"
#include "core/fail_point.hpp"
#include "core/interrupt.hpp"
#include "core/log.hpp"
#include "core/shell_words.hpp"
#include "core/timer.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int kTick_ms = 100;                              // between looks at time and memory
constexpr double kPatience_s = 15;                         // for units to end after an interrupt
constexpr double kLongUnit_s = 5;                          // worth a new process with more threads
constexpr std::uint64_t kFatWorker_bytes = 1'500'000'000;  // what a process may keep between units

class Engine {
 public:
  Engine(const Store& store, const Manifest& manifest, const EngineOptions& options)
      : store_(store), manifest_(manifest), options_(options), outcomes_(store, manifest) {}

  EngineResult go() {
    choose_limits();
    choose_units();
    RunProgress progress(options_.quiet, todo_count_, todo_estimate_s_);
    progress_ = &progress;
    try {
      while (!pending_.empty()) {
        check_interrupted();
        start_units();
        wait_for_answers();
        watch();
      }
    } catch (const Error&) {
      end_all();
      throw;
    }
    slots_.clear();
    return result();
  }

 private:
  // --- before -------------------------------------------------------------------------------------------

  void choose_limits() {
    cores_ = options_.threads > 0 ? options_.threads : usable_cores();
    memory_ = options_.memory_bytes ? options_.memory_bytes : free_memory_bytes() / 5 * 4;
    // A unit whose memory is kept near all that there is may be over it for a moment.
    unit_memory_ = options_.unit_memory_bytes ? options_.unit_memory_bytes : memory_ + memory_ / 8;
    jobs_ = options_.jobs > 0 ? options_.jobs : cores_;
    keep_ = std::min(kFatWorker_bytes / 2, memory_ / 8 / static_cast<unsigned>(jobs_));
  }

  // What the store lacks of what was asked for. A unit that needs one of these is looked at again when they
  // are settled.
  void choose_units() {
    const std::size_t count = manifest_.units.size();
    wanted_.assign(count, !options_.units);
    if (options_.units)
      for (const std::size_t unit : *options_.units) wanted_[unit] = true;
    users_.resize(count);
    missing_.assign(count, 0);
    for (const Unit& unit : manifest_.units) {
      if (!wanted_[unit.index]) continue;
      for (const std::size_t need : unit.needs)
        if (pending_.count(need)) {
          ++missing_[unit.index];
          users_[need].push_back(unit.index);
        }
      if (missing_[unit.index] == 0) {
        if (!is_to_run(unit)) {
          link(unit);
          continue;
        }
        ready_.push_back(unit.index);
      }
      pending_.insert(unit.index);
      outcomes_.set(unit.index, {});
      ++todo_count_;
      todo_estimate_s_ += unit.estimate_s;
    }
  }

  bool is_to_run(const Unit& unit) {
    const Outcome& outcome = outcomes_.of(unit.index);
    switch (outcome.state) {
      case UnitState::waiting:
        if (outcome.key.empty()) fail_for_needs(unit);
        return true;
      case UnitState::failed:
        return options_.retry || outcome.kind != ErrorKind::input;
      case UnitState::quarantined:
        return options_.retry;
      default:
        return false;
    }
  }

  [[noreturn]] void fail_for_needs(const Unit& unit) {
    for (const std::size_t need : unit.needs)
      if (outcomes_.of(need).state == UnitState::waiting)
        fail(ErrorKind::temporary, "unit {} ({}) needs unit {} ({}), which nobody has made yet: run it first",
             unit.number, unit.id, manifest_.units[need].number, manifest_.units[need].id);
    fail(ErrorKind::failed, "unit {} ({}) waits for nothing", unit.number, unit.id);
  }

  // --- starting -----------------------------------------------------------------------------------------

  std::size_t running() const {
    return static_cast<std::size_t>(std::ranges::count_if(slots_, [](const Slot& s) { return !!s.unit; }));
  }
  std::uint64_t memory_in_use() const {
    std::uint64_t bytes = 0;
    for (const Slot& slot : slots_)
      if (slot.unit) bytes += is_large(*slot.unit) ? memory_ : manifest_.units[*slot.unit].estimate_bytes;
    return bytes;
  }

  void start_units() {
    if (pause_.seconds() < pause_s_) return;
    ready_.splice(ready_.end(), elsewhere_);
    while (static_cast<int>(running()) < jobs_) {
      const auto unit = take_next();
      if (!unit) return;
      start(*unit);
    }
  }

  // More than all there is, or than a unit may have: it runs when nothing else does, on all cores, with its
  // arrays in files where they are too many (core/memory_budget.hpp).
  bool is_large(std::size_t unit) const {
    return alone_.count(unit) || manifest_.units[unit].estimate_bytes > std::min(memory_, unit_memory_);
  }

  // Off the list of ready units, the first for which there is memory.
  std::optional<std::size_t> take_next() {
    const std::uint64_t used = memory_in_use();
    const bool idle = running() == 0;
    for (auto unit = ready_.begin(); unit != ready_.end(); ++unit) {
      const bool fits = !is_large(*unit) && used + manifest_.units[*unit].estimate_bytes <= memory_;
      if (!fits && !idle) continue;
      const std::size_t taken = *unit;
      ready_.erase(unit);
      return taken;
    }
    return std::nullopt;
  }

  std::optional<std::size_t> unit_in_flight(const std::string& key) const {
    for (const Slot& slot : slots_)
      if (slot.unit && slot.key == key) return slot.unit;
    return std::nullopt;
  }

  // Null: another run makes it, so that it is looked at again at the next tick.
  std::unique_ptr<KeyLock> lock_key(const Unit& unit) {
    const std::string key = outcomes_.of(unit.index).key;
    auto lock = KeyLock::try_lock(store_, key);
    if (lock) return lock;
    elsewhere_.push_back(unit.index);
    if (said_.insert(key).second) log::info("unit {} ({}): another run makes it", unit.number, unit.id);
    return nullptr;
  }

  void start(std::size_t index) {
    const Unit& unit = manifest_.units[index];
    outcomes_.forget(index);
    const Outcome outcome = outcomes_.of(index);
    if (!is_to_run(unit)) {  // what it needs came out as before
      settle(index, outcome, 0);
      return;
    }
    if (const auto same = unit_in_flight(outcome.key)) {  // its object will be this one's, too
      missing_[index] = 1;
      users_[*same].push_back(index);
      return;
    }
    std::unique_ptr<KeyLock> lock;
    if (options_.units) {
      lock = lock_key(unit);
      if (!lock) return;
      outcomes_.forget(index);
      if (!is_to_run(unit)) return settle(index, outcomes_.of(index), 0);  // made since
    }
    Slot& slot = slot_for(unit);
    slot.key = outcome.key;
    slot.lock = std::move(lock);
    slot.work = store_.begin_object(outcome.key);
    slot.unit = index;
    slot.timer = Timer();
    slot.killed_for.clear();
    slot.requeue = false;
    slot.budget = is_large(index);  // before its process is ready: that may be over the limit by itself
    if (slot.ready) send(slot);
  }

  void send(Slot& slot) {
    slot.timer = Timer();
    Json job = {{"unit", manifest_.units[*slot.unit].number}, {"key", slot.key}, {"keep", keep_}};
    job["work"] = slot.work.string();
    if (slot.budget) job["memory"] = std::min(memory_, unit_memory_);
    slot.worker->send(job);
    fail_point("unit-sent");
  }

  // Threads for a unit: its share of the cores among all that could run now. Short ones take the process that
  // is there.
  int threads_for(const Unit& unit) const {
    if (is_large(unit.index)) return cores_;
    const int usual = std::max(1, cores_ / jobs_);
    if (unit.estimate_s < kLongUnit_s) return usual;
    const std::size_t others = running() + ready_.size() + 1;
    return std::max(usual, cores_ / static_cast<int>(std::min<std::size_t>(others, 1024)));
  }

  Slot& slot_for(const Unit& unit) {
    const int threads = threads_for(unit);
    const auto is_idle = [](const Slot& slot) { return !slot.unit; };
    for (Slot& slot : slots_)
      if (is_idle(slot) && slot.worker->threads() == threads) return slot;
    if (static_cast<int>(slots_.size()) >= jobs_)  // one with other threads goes
      slots_.erase(std::find_if(slots_.begin(), slots_.end(), is_idle));
    slots_.emplace_back();
    slots_.back().worker = std::make_unique<WorkerProcess>(WorkerProcess::Start{
        store_.folder(), options_.device, threads, options_.quiet ? "warning" : options_.log_level});
    return slots_.back();
  }

  // --- while they run -----------------------------------------------------------------------------------

  void wait_for_answers() {
    std::vector<pollfd> waits;
    for (const Slot& slot : slots_) waits.push_back({slot.worker->answers(), POLLIN, 0});
    poll(waits.data(), waits.size(), kTick_ms);
    for (auto slot = slots_.begin(); slot != slots_.end();) {
      bool ended = false;
      for (const Json& line : slot->worker->read(ended)) take(*slot, line);
      if (ended) {
        const int status = slot->worker->wait();
        if (slot->unit) died(*slot, status);
        slot = slots_.erase(slot);
      } else if (!slot->unit && slot->worker->resident_bytes() > kFatWorker_bytes) {
        slot = slots_.erase(slot);
      } else {
        ++slot;
      }
    }
  }

  void take(Slot& slot, const Json& line) {
    if (line.contains("ready")) {
      if (!line["ready"])
        throw Error(error_kind_from(line.value("error_kind", "")), line.value("error", "a worker failed"));
      slot.ready = true;
      if (slot.unit) send(slot);
      return;
    }
    Ending ending;
    ending.ok = line.value("ok", false);
    ending.kind = error_kind_from(line.value("error_kind", ""));
    ending.error = line.value("error", "");
    ended(slot, ending);
  }

  void died(Slot& slot, int status) {
    Ending ending;
    ending.error = slot.killed_for;
    ending.worker_died = slot.killed_for.empty();
    if (ending.error.empty()) ending.error = describe_end(status);
    ended(slot, ending);
  }

  void ended(Slot& slot, const Ending& ending) {
    const std::size_t unit = *slot.unit;
    const auto lock = std::move(slot.lock);  // until all is noted
    slot.unit.reset();
    if (ending.ok) {
      ++computed_;
      store_.forget_failure(slot.key);
      outcomes_.forget(unit);
      settle(unit, outcomes_.of(unit), slot.timer.seconds());
      return;
    }
    if (ending.kind == ErrorKind::interrupted) {
      drop(slot);
      throw Error(ErrorKind::interrupted, ending.error);
    }
    if (slot.requeue) {
      again(unit, ending.error + "; it waits for the others");
      alone_.insert(unit);
      drop(slot);
      return;
    }
    const bool passing = ending.worker_died || ending.kind == ErrorKind::temporary;
    if (passing && attempts_[unit]++ < options_.retries) {
      again(unit, ending.error);
      // A process that died may have been the machine's fault, a full disk may be cleared: wait a little.
      if (ending.kind == ErrorKind::temporary) {
        pause_s_ = attempts_[unit];
        pause_ = Timer();
      }
      drop(slot);
      return;
    }
    if (ending.kind == ErrorKind::temporary) {  // nobody else will fare better
      drop(slot);
      throw Error(ending.kind, ending.error);
    }
    note_failure(slot, unit, ending);
  }

  void again(std::size_t unit, const std::string& why) {
    progress_->unit_again(manifest_.units[unit], why);
    ready_.push_front(unit);
  }

  void drop(const Slot& slot) {
    std::error_code code;
    fs::remove_all(slot.work, code);
  }

  void note_failure(const Slot& slot, std::size_t unit, const Ending& ending) {
    ++computed_;
    const auto before = store_.failure(slot.key);
    const int attempts = 1 + (before && !options_.retry ? before->value("attempts", 0) : 0) +
                         (ending.worker_died ? options_.retries : 0);
    const bool lasting = ending.kind == ErrorKind::input;
    std::error_code code;
    const fs::path log = slot.work / "log.txt";
    if (fs::exists(log, code)) io::write_text(store_.failure_log(slot.key), io::read_text(log));
    store_.write_failure(
        slot.key, {{"key", slot.key},
                   {"unit", manifest_.units[unit].id},
                   {"index", manifest_.units[unit].number},
                   {"error", ending.error},
                   {"error_kind", name_of(ending.kind)},
                   {"exit_code", exit_code(ending.kind)},
                   {"attempts", attempts},
                   {"quarantined", !lasting && attempts >= kMostAttempts},
                   {"command", as_typed({"hybrid", "batch", "run", "--out", store_.folder().string(),
                                         "--unit", std::to_string(manifest_.units[unit].number), "--retry"})},
                   {"log", store_.failure_log(slot.key).lexically_relative(store_.folder()).string()},
                   {"host", host_name()},
                   {"finished", utc_now()},
                   {"seconds", slot.timer.seconds()}});
    drop(slot);
    outcomes_.forget(unit);
    settle(unit, outcomes_.of(unit), slot.timer.seconds());
  }

  // Nothing more is to be done for the unit in this run.
  void settle(std::size_t unit, const Outcome& outcome, double seconds) {
    pending_.erase(unit);
    link(manifest_.units[unit]);
    progress_->unit_ended(manifest_.units[unit], outcome, seconds);
    for (const std::size_t user : users_[unit])
      if (--missing_[user] == 0) ready_.push_front(user);  // what can be finished is
  }

  void link(const Unit& unit) {
    const Outcome& outcome = outcomes_.of(unit.index);
    if (unit.result.empty() || (outcome.state != UnitState::done && outcome.state != UnitState::partial))
      return;
    store_.link_result(unit.result, outcome.key);
  }

  // Time and memory. Estimates may be wrong: what is used counts.
  void watch() {
    std::uint64_t all = 0;
    Slot* youngest = nullptr;
    std::string name;
    for (Slot& slot : slots_) {
      if (!slot.unit) continue;
      const std::uint64_t bytes = slot.worker->resident_bytes();
      all += bytes;
      if (bytes > unit_memory_) {
        slot.requeue = slot.requeue || (slot.killed_for.empty() && !slot.budget);  // more than was thought
        end(slot, fmt::format("took more than {} MiB of memory, which is what {} leaves one unit; give more",
                              unit_memory_ >> 20, options_.unit_memory_bytes ? "--unit-memory" : "--memory"));
      }
      if (slot.timer.seconds() > options_.unit_seconds)
        end(slot, fmt::format("took longer than {} s (--unit-time); give it more, or see its log",
                              options_.unit_seconds));
      if (!youngest || slot.timer.seconds() < youngest->timer.seconds()) youngest = &slot;
      name = manifest_.units[*slot.unit].id;
    }
    if (all > memory_ + memory_ / 10 && running() > 1) {
      youngest->requeue = true;
      end(*youngest, "took more memory than is free");
    }
    progress_->show(running(), name);
  }

  void end(Slot& slot, const std::string& why) {
    if (!slot.killed_for.empty()) return;
    slot.killed_for = why;
    slot.worker->signal(SIGKILL);
  }

  // Lets units in flight end by themselves, then ends them.
  void end_all() {
    const Timer timer;
    for (Slot& slot : slots_) slot.worker->signal(SIGTERM);
    while (!slots_.empty() && timer.seconds() < kPatience_s) {
      std::vector<pollfd> waits;
      for (const Slot& slot : slots_) waits.push_back({slot.worker->answers(), POLLIN, 0});
      poll(waits.data(), waits.size(), kTick_ms);
      slots_.remove_if([&](Slot& slot) {
        bool gone = false;
        slot.worker->read(gone);
        if (!gone) return false;
        slot.worker->wait();
        if (slot.unit) drop(slot);
        return true;
      });
    }
    for (Slot& slot : slots_) {
      slot.worker->signal(SIGKILL);
      slot.worker->wait();
      if (slot.unit) drop(slot);
    }
    slots_.clear();
  }

  // --- after --------------------------------------------------------------------------------------------

  EngineResult result() {
    std::map<std::string, std::size_t> counts;
    Json failed = Json::array();
    EngineResult result;
    ErrorKind first = ErrorKind::failed;
    for (const Unit& unit : manifest_.units) {
      if (!wanted_[unit.index]) continue;
      const Outcome& outcome = outcomes_.of(unit.index);
      ++counts[name_of(outcome.state)];
      if (outcome.state == UnitState::done) continue;
      if (failed.empty()) first = outcome.kind;
      failed.push_back({{"unit", unit.number},
                        {"id", unit.id},
                        {"state", name_of(outcome.state)},
                        {"error", outcome.error}});
    }
    result.summary = {{"store", store_.folder().string()},
                      {"units", counts},
                      {"computed", computed_},
                      {"seconds", timer_.seconds()},
                      {"failed", failed}};
    if (!failed.empty() || !manifest_.problems.empty()) result.exit_code = 3;
    const bool nothing = counts.count("done") == 0 && counts.count("partial") == 0;
    if (!failed.empty() && nothing) result.exit_code = exit_code(first);
    return result;
  }

  const Store& store_;
  const Manifest& manifest_;
  const EngineOptions& options_;
  Outcomes outcomes_;
  Timer timer_, pause_;
  double pause_s_ = 0;
  int cores_ = 1, jobs_ = 1;
  std::uint64_t memory_ = 0, unit_memory_ = 0, keep_ = 0;  // keep_: a process between units
  std::vector<bool> wanted_;
  std::set<std::size_t> pending_;                // not settled; some of them in flight
  std::set<std::size_t> alone_;                  // run with no other beside them
  std::list<std::size_t> ready_;                 // of pending_: need nothing more
  std::list<std::size_t> elsewhere_;             // of pending_: another run makes them
  std::set<std::string> said_;                   // keys of these, told already
  std::vector<std::vector<std::size_t>> users_;  // per unit: pending units that need it, or have its key
  std::vector<std::size_t> missing_;             // per unit: pending units that it needs
  std::map<std::size_t, int> attempts_;          // in this run
  std::size_t todo_count_ = 0, computed_ = 0;
  double todo_estimate_s_ = 0;
  std::list<Slot> slots_;
  RunProgress* progress_ = nullptr;
};

}  // namespace

EngineResult run_units(const Store& store, const Manifest& manifest, const EngineOptions& options) {
  return Engine(store, manifest, options).go();
}

}  // namespace hybrid::archive
