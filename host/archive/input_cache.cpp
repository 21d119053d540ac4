#include "archive/input_cache.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <optional>

#include "core/error.hpp"
#include "core/fail_point.hpp"
#include "core/parallel.hpp"
#include "io/output.hpp"
#include "io/read_scan.hpp"

namespace hybrid::archive {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInputsFormat = "hybrid inputs 1";

nlohmann::json read_cache(const std::string& text) {
  nlohmann::json document = nlohmann::json::parse(text, nullptr, false);
  if (!document.is_object() || document.value("format", "") != kInputsFormat ||
      !document["files"].is_object())
    return {{"files", nlohmann::json::object()}};
  return document;
}

std::string read_if_there(const fs::path& file) {
  std::error_code code;
  if (!fs::exists(file, code)) return "";
  try {
    return io::read_text(file);
  } catch (const Error&) {
    return "";
  }
}

}  // namespace

InputCache::InputCache(fs::path file, std::string sources, bool rehash)
    : file_(std::move(file)),
      sources_(std::move(sources)),
      rehash_(rehash),
      new_({{"format", kInputsFormat}, {"files", nlohmann::json::object()}}),
      old_text_(read_if_there(file_)) {
  old_ = read_cache(old_text_);
}

InputCache::Stat InputCache::stat_of(const fs::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return {};
  return {static_cast<std::uintmax_t>(found.st_size), static_cast<std::uintmax_t>(found.st_ino),
          static_cast<std::int64_t>(found.st_mtim.tv_sec) * 1'000'000'000 + found.st_mtim.tv_nsec};
}

std::vector<std::int64_t> InputCache::numbers_of(const Stat& stat) {
  return {static_cast<std::int64_t>(stat.bytes), static_cast<std::int64_t>(stat.inode), stat.mtime_ns};
}

Input InputCache::look(const fs::path& file) {
  return look(std::vector{file}).front();
}

std::vector<Input> InputCache::look(const std::vector<fs::path>& files) {
  struct Job {
    Input input;
    Stat stat;
    bool fresh = false;
  };
  std::vector<Job> jobs(files.size());
  const nlohmann::json& known_files = old_.at("files");
  parallel_for(files.size(), [&](std::size_t i) {
    Job& job = jobs[i];
    const std::string name = files[i].string();
    if (const auto seen = seen_.find(name); seen != seen_.end()) {
      job.input = seen->second;
      return;
    }
    job.input.file = files[i];
    job.stat = stat_of(files[i]);
    job.input.bytes = job.stat.bytes;
    job.input.mtime_ns = job.stat.mtime_ns;
    const auto known = known_files.find(name);
    if (!rehash_ && known != known_files.end() && known->at("stat") == numbers_of(job.stat)) {
      job.input.xxh3 = known->at("xxh3");
      return;
    }
    job.fresh = true;
    try {
      job.input.xxh3 = io::fingerprint(files[i]).xxh3;
      if (stat_of(files[i]) != job.stat)
        fail_input("{}: changed while it was read; plan again when nobody writes it", name);
    } catch (const Error& error) {
      job.input.xxh3.clear();
      job.input.problem = error.what();
    }
  });
  std::vector<Input> inputs;
  for (Job& job : jobs) {
    const std::string name = job.input.file.string();
    if (job.fresh) {
      bytes_read_ += job.input.bytes;
      const auto known = old_["files"].find(name);
      const bool same_stat = known != old_["files"].end() && (*known)["stat"] == numbers_of(job.stat);
      if (same_stat && (*known)["xxh3"] != job.input.xxh3) changed_unseen_.push_back(name);
    }
    if (job.input.problem.empty() && seen_.emplace(name, job.input).second) {
      nlohmann::json& entry = new_["files"][name];
      entry = {{"stat", numbers_of(job.stat)}, {"xxh3", job.input.xxh3}};
      // A listing goes with the content, whatever the times say.
      const auto known = old_["files"].find(name);
      if (known != old_["files"].end() && (*known)["xxh3"] == job.input.xxh3 && known->contains("list"))
        entry["list"] = (*known)["list"];
    }
    inputs.push_back(std::move(job.input));
  }
  return inputs;
}

ScanListing InputCache::list(const fs::path& file, bool salvage) {
  look(file);
  ScanListing listing;
  const std::string name = file.string(), version = sources_ + (salvage ? " salvage" : "");
  const auto entry = new_["files"].find(name);
  if (entry != new_["files"].end() && entry->contains("list") && (*entry)["list"]["version"] == version) {
    for (const auto& one : (*entry)["list"]["scans"]) listing.scans.push_back({one[0], one[1]});
    listing.problem = (*entry)["list"]["problem"];
    return listing;
  }
  try {
    for (const auto& one : io::list_scans(file, {.salvage = salvage}))
      listing.scans.push_back({one.index, one.samples});
  } catch (const Error& error) {
    listing.problem = error.what();
  } catch (const std::exception& error) {
    listing.problem = fmt::format("{}: {}", name, error.what());
  }
  if (entry != new_["files"].end()) {
    nlohmann::json scans = nlohmann::json::array();
    for (const auto& one : listing.scans) scans.push_back({one.index, one.samples});
    (*entry)["list"] = {{"version", version}, {"scans", scans}, {"problem", listing.problem}};
  }
  return listing;
}

void InputCache::save() const {
  const std::string text = new_.dump(0, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (text == old_text_) return;
  io::write_text(file_, text);
  fail_point("cache-written");
}

void check_unchanged(const Input& input) {
  if (!input.problem.empty()) return;  // the unit says itself what is wrong with it
  struct stat found {};
  const int code = ::stat(input.file.c_str(), &found);
  const std::int64_t mtime_ns =
      static_cast<std::int64_t>(found.st_mtim.tv_sec) * 1'000'000'000 + found.st_mtim.tv_nsec;
  if (code != 0 || static_cast<std::uintmax_t>(found.st_size) != input.bytes || mtime_ns != input.mtime_ns)
    fail(ErrorKind::failed, "{}: expected the file of the plan, found {}; make the plan again",
         input.file.string(), code != 0 ? "none" : "one of another size or time");
}

nlohmann::ordered_json to_json(const Input& input) {
  nlohmann::ordered_json json = {{"file", input.file.string()},
                                 {"bytes", input.bytes},
                                 {"mtime_ns", input.mtime_ns},
                                 {"xxh3", input.xxh3}};
  if (!input.problem.empty()) json["problem"] = input.problem;
  return json;
}

Input input_from_json(const nlohmann::ordered_json& json) {
  return {json.at("file").get<std::string>(), json.at("bytes"), json.at("mtime_ns"), json.at("xxh3"),
          json.value("problem", "")};
}

}  // namespace hybrid::archive
