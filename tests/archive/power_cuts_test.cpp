// Power cuts at moments chosen at random among all that a night does to its store, with and without the loss
// of what was not brought to the disk. A few here; HYBRID_POWER_CUTS=200 makes so many of each kind,
// HYBRID_POWER_SEED=2 others.
#include <gtest/gtest.h>

#include <csignal>
#include <random>
#include <set>
#include <sstream>

#include "io/output.hpp"
#include "power_disk.hpp"
#include "small_archive.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

constexpr int kUnits = 3;  // one scene: its scan, itself, the report

int number_from_environment(const char* name, int otherwise) {
  const char* const text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

// The night that nobody disturbed, and how many moments there are in it.
struct CleanNight {
  Scratch scratch;
  const fs::path archive = scratch / "archive";
  std::string results, manifest;
  unsigned long operations = 0;

  CleanNight() {
    write_small_archive(archive, 1);
    const PowerDisk disk(scratch / "store", scratch / "state");
    EXPECT_EQ(night(disk, 0, "").exit_code, 0);
    results = results_of(disk.folder());
    manifest = io::read_text(disk.folder() / "manifest.json");
    operations = disk.operations();
  }

  Outcome night(const PowerDisk& disk, unsigned long cut_at, const std::string& ignore) const {
    const std::string store = disk.folder().string();
    return run(disk.environment(cut_at, ignore) + "sh -c 'hybrid batch plan " + archive.string() + " --out " +
               store + " >/dev/null && hybrid batch run --out " + store + " --jobs 2 --json'");
  }
};
const CleanNight& clean() {
  static const CleanNight made;
  return made;
}

// Units whose end was told.
std::set<int> told_ended(const std::string& progress) {
  std::set<int> units;
  std::istringstream lines(progress);
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_object() && json.value("event", "") == "unit") units.insert(json["unit"].get<int>());
  }
  return units;
}

struct Tally {
  int cuts = 0, whole = 0, ended = 0, computed_again = 0;
};

// What is wrong after a cut before that operation, a restart and a second run; "" when nothing is.
std::string cut_and_resume(unsigned long cut_at, Loss loss, const std::string& ignore, std::uint32_t seed,
                           Tally& tally) {
  const Scratch scratch;
  const PowerDisk disk(scratch / "store", scratch / "state");
  const std::string store = disk.folder().string();
  const Outcome first = clean().night(disk, cut_at, ignore);
  disk.restart(loss, seed);
  const auto ended = told_ended(first.err);
  tally.ended += static_cast<int>(ended.size());
  if (first.exit_code == 128 + SIGKILL)
    ++tally.cuts;
  else if (first.exit_code == 0)
    ++tally.whole;  // it needed fewer operations than the clean night: that differs by the order of its
                    // threads
  else
    return "the first run ended with " + std::to_string(first.exit_code) + ": " + first.err;

  if (fs::exists(disk.folder() / "store.json"))
    if (const auto verified = run("hybrid batch verify " + store); verified.exit_code != 0)
      return verified.out + verified.err;
  if (const auto planned = plan(clean().archive, disk.folder()); planned.exit_code != 0) return planned.err;
  if (io::read_text(disk.folder() / "manifest.json") != clean().manifest) return "another plan";
  const Outcome second = run_store(disk.folder());
  if (second.exit_code != 0) return "the second run: " + second.err;
  const int computed = json_of(second)["computed"];
  for (const int unit : told_ended(second.err))
    if (ended.count(unit)) return "unit " + std::to_string(unit) + " had ended and was made again";
  if (computed > kUnits - static_cast<int>(ended.size())) return "more was made again than was in flight";
  tally.computed_again += computed;
  if (results_of(disk.folder()) != clean().results) return "other bytes";
  if (!fs::is_empty(disk.folder() / "work")) return "something is left in work/";
  return "";
}

// How many cuts after the first `from` of the night showed something wrong; the first few are told.
int campaign(Loss loss, const std::string& ignore, double from, std::string& told) {
  const int cuts = number_from_environment("HYBRID_POWER_CUTS", 1);
  const auto seed = static_cast<std::uint32_t>(number_from_environment("HYBRID_POWER_SEED", 1));
  std::mt19937 random(seed + 1000 * static_cast<std::uint32_t>(loss));
  Tally tally;
  int wrong = 0;
  for (int i = 0; i < cuts; ++i) {
    // One in each of so many equal parts of the night.
    const double part = from + (1 - from) * (i + std::uniform_real_distribution<>(0, 1)(random)) / cuts;
    const auto cut_at = 1 + static_cast<unsigned long>(part * static_cast<double>(clean().operations));
    const std::string problem = cut_and_resume(cut_at, loss, ignore, random(), tally);
    if (problem.empty()) continue;
    if (++wrong <= 5) told += "operation " + std::to_string(cut_at) + ": " + problem + "\n";
  }
  std::printf(
      "%d of %lu moments, %d runs cut, %d ended before; %d units had ended, %d computed by the second runs; "
      "%d wrong\n",
      cuts, clean().operations, tally.cuts, tally.whole, tally.ended, tally.computed_again, wrong);
  return wrong;
}

void expect_none_wrong(Loss loss) {
  std::string told;
  EXPECT_EQ(campaign(loss, "", 0, told), 0) << told;
}

}  // namespace

TEST(ArchivePower, cut_anywhere_resumes_to_the_same_bytes) {
  expect_none_wrong(Loss::nothing);
}
TEST(ArchivePower, cut_with_all_unsynced_writes_lost) {
  expect_none_wrong(Loss::everything);
}
TEST(ArchivePower, cut_with_some_unsynced_writes_lost) {
  expect_none_wrong(Loss::by_chance);
}

// The checks see what they are for: a program that forgets one kind of fsync fails them.
TEST(ArchivePower, without_fsync_the_checks_fail) {
  for (const char* ignore : {"files", "folders"}) {
    std::string told;
    EXPECT_GT(campaign(Loss::everything, ignore, 0.8, told), 0)
        << ignore;  // late: much has been said to be done
    std::printf("without fsync of %s: %s", ignore, told.substr(0, told.find('\n') + 1).c_str());
  }
}

}  // namespace hybrid::e2e
