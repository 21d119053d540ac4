#include "archive/audit.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "archive/night.hpp"
#include "archive/outcome.hpp"
#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// The folders objects/<kk>/<key>, or the like below another folder, by name.
std::vector<fs::path> sharded(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code code;
  for (fs::directory_iterator shard(folder, code), end; !code && shard != end; shard.increment(code)) {
    std::error_code inner;
    for (fs::directory_iterator entry(shard->path(), inner), last; !inner && entry != last;
         entry.increment(inner))
      found.push_back(entry->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

struct Check {
  std::size_t files = 0;
  std::uintmax_t bytes = 0;
  std::vector<std::pair<fs::path, std::string>> damaged;
};

// One object: its seals, then its files against them.
void check_object(const fs::path& object, Check& check) {
  std::set<std::string> known = {"object.json", "record.json"};
  for (const char* name : {"object.json", "record.json"}) {
    Json list;
    try {
      const Json sealed = unseal(object / name);
      if (sealed.value("key", "") != object.filename().string())
        check.damaged.emplace_back(object / name, "is of another object");
      list = sealed.at("files");
    } catch (const std::exception& error) {
      check.damaged.emplace_back(object / name, error.what());
      continue;
    }
    for (const auto& file : list) {
      check_interrupted();
      const auto path = file.at("path").get<std::string>();
      known.insert(path);
      try {
        const auto print = io::fingerprint(object / path);
        ++check.files;
        check.bytes += print.bytes;
        if (print.bytes != file.at("bytes") || print.xxh3 != file.at("xxh3"))
          check.damaged.emplace_back(object / path, "its content is not what was written");
      } catch (const Error& error) {
        check.damaged.emplace_back(object / path, error.what());
      }
    }
  }
  for (const auto& entry : fs::recursive_directory_iterator(object)) {
    const std::string path = entry.path().lexically_relative(object).generic_string();
    if (!entry.is_directory() && !known.count(path))
      check.damaged.emplace_back(entry.path(), "belongs to no object");
  }
}

std::uintmax_t size_of(const fs::path& path) {
  if (!fs::is_directory(path)) return fs::file_size(path);
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file()) bytes += entry.file_size();
  return bytes;
}

}  // namespace

Json store_status(const Store& store, const Manifest& manifest) {
  Outcomes outcomes(store, manifest);
  Json counts = Json::object(), list = Json::array(), problems = Json::array();
  for (const Unit& unit : manifest.units) {
    const Outcome& outcome = outcomes.of(unit.index);
    Json& count = counts[name_of(unit.kind)][name_of(outcome.state)];
    count = count.is_null() ? 1 : count.get<int>() + 1;
    Json row = {{"unit", unit.number},
                {"id", unit.id},
                {"kind", name_of(unit.kind)},
                {"state", name_of(outcome.state)},
                {"key", outcome.key}};
    if (!unit.result.empty()) row["result"] = unit.result;
    if (!outcome.error.empty()) row["error"] = outcome.error;
    if (outcome.state == UnitState::failed || outcome.state == UnitState::quarantined)
      if (const auto failure = store.failure(outcome.key))
        for (const char* key : {"attempts", "finished", "command", "log"})
          if (failure->contains(key)) row[key] = (*failure)[key];
    list.push_back(std::move(row));
  }
  for (const auto& [path, what] : manifest.problems) problems.push_back({{"path", path}, {"what", what}});
  return {{"store", store.folder().string()},
          {"archive", manifest.archive.string()},
          {"units", counts},
          {"list", list},
          {"problems", problems}};
}

std::string status_text(const Json& status) {
  constexpr const char* kStates[] = {"done", "partial", "waiting", "failed", "quarantined"};
  std::string text = fmt::format("archive {}\n{:<8}", status["archive"].get<std::string>(), "");
  for (const char* state : kStates) text += fmt::format(" {:>11}", state);
  text += "\n";
  for (const auto& [kind, counts] : status["units"].items()) {
    text += fmt::format("{:<8}", kind);
    for (const char* state : kStates) text += fmt::format(" {:>11}", counts.value(state, 0));
    text += "\n";
  }
  for (const auto& row : status["list"]) {
    if (!row.contains("error")) continue;
    text += fmt::format("{} {}: {}\n", row["id"].get<std::string>(), row["state"].get<std::string>(),
                        row["error"].get<std::string>());
    if (row.contains("command"))
      text += fmt::format("  log: {}; again: {}\n", row["log"].get<std::string>(),
                          row["command"].get<std::string>());
  }
  for (const auto& problem : status["problems"])
    text += fmt::format("problem: {}: {}\n", problem["path"].get<std::string>(),
                        problem["what"].get<std::string>());
  return text;
}

Json verify_store(const Store& store, bool remove) {
  Json damaged = Json::array();
  Check all;
  std::size_t objects = 0;
  for (const fs::path& object : sharded(store.folder() / "objects")) {
    ++objects;
    const std::size_t before = all.damaged.size();
    check_object(object, all);
    if (remove && all.damaged.size() > before) fs::remove_all(object);
  }
  for (const fs::path& file : sharded(store.folder() / "failures"))
    if (file.extension() == ".json") try {
        unseal(file);
      } catch (const Error& error) {
        all.damaged.emplace_back(file, error.what());
        if (remove) fs::remove(file);
      }
  for (const auto& [path, what] : all.damaged)
    damaged.push_back({{"path", path.lexically_relative(store.folder()).string()}, {"what", what}});
  return {{"objects", objects}, {"files", all.files}, {"bytes", all.bytes}, {"damaged", damaged}};
}

Json prune_store(const Store& store, std::size_t keep, bool dry_run) {
  std::vector<fs::path> manifests, dropped;
  for (const NightFile& night : nights_of(store)) {
    const bool kept = keep == 0 || (count_units(night.file) > 0 && manifests.size() < keep);
    (kept ? manifests : dropped).push_back(night.file);
  }
  // Of each plan what its units have now, and what they would have with every scan in order.
  std::set<std::string> used;
  manifests.push_back(store.plan_in_force());
  for (const fs::path& file : manifests) {
    const Manifest manifest = read_manifest(file, Detail::schedule);
    Outcomes outcomes(store, manifest);
    for (const Unit& unit : manifest.units) {
      used.insert(unit.key);
      used.insert(outcomes.of(unit.index).key);
    }
  }
  std::size_t removed = 0, kept = 0;
  std::uintmax_t bytes = 0;
  const auto look = [&](const fs::path& path, const std::string& key) {
    check_interrupted();
    if (used.count(key)) {
      ++kept;
      return;
    }
    ++removed;
    bytes += size_of(path);
    if (!dry_run) fs::remove_all(path);
  };
  for (const fs::path& object : sharded(store.folder() / "objects")) look(object, object.filename().string());
  for (const fs::path& file : sharded(store.folder() / "failures")) look(file, file.stem().string());
  if (!dry_run) {
    for (const fs::path& file : dropped) fs::remove(file);
    for (const auto& entry : fs::recursive_directory_iterator(store.folder() / "results"))
      if (entry.is_symlink() && !fs::exists(entry.path())) fs::remove(entry.path());
  }
  return {{"removed", removed}, {"bytes", bytes}, {"kept", kept}, {"manifests_dropped", dropped.size()}};
}

}  // namespace hybrid::archive
