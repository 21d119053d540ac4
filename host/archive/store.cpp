#include "archive/store.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.hpp"
#include "core/fail_point.hpp"
#include "core/log.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kStoreFormat = "hybrid store 1";

// Names of files that an object's folder holds about itself.
bool is_seal(const std::string& path) {
  return path == "object.json" || path == "record.json";
}

// The content of a file, the names in a folder.
void bring_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) io::fail_output(path, errno);
  const int reason = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  if (reason != 0 && reason != EINVAL)
    io::fail_output(path, reason);  // EINVAL: no folders, on some file systems
}

// Path, size and hash of the files below `folder` that are volatile or not, by path.
Json list_files(const fs::path& folder, bool volatile_ones) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::vector<std::pair<std::string, fs::path>> named;
  for (const auto& file : files) {
    const std::string name = file.lexically_relative(folder).generic_string();
    if (!is_seal(name) && is_volatile(name) == volatile_ones) named.emplace_back(name, file);
  }
  std::sort(named.begin(), named.end());
  Json list = Json::array();
  for (const auto& [name, file] : named) {
    const auto print = io::fingerprint(file);
    list.push_back({{"path", name}, {"bytes", print.bytes}, {"xxh3", print.xxh3}});
  }
  return list;
}

// The system begins to write the file; it is not waited for.
void begin_writing(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE);
  close(descriptor);
}

// Whoever wrote the files. All are begun before the first is waited for.
void bring_all_to_disk(const fs::path& folder) {
  std::vector<fs::path> paths = {folder};
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory() || entry.is_regular_file()) paths.push_back(entry.path());
    if (entry.is_regular_file()) begin_writing(entry.path());
  }
  for (const auto& path : paths) bring_to_disk(path);
}

fs::path in_shard(const fs::path& folder, const std::string& key) {
  return folder / key.substr(0, 2) / key;
}

}  // namespace

bool is_volatile(const std::string& path) {
  return path == "timing.json" || path == "report/timing.js" || path == "log.txt";
}

std::string hash_of(const std::string& text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string seal(Json document) {
  document.erase("xxh3");
  document["xxh3"] = hash_of(document.dump());
  return document.dump(1) + "\n";
}

Json unseal(const fs::path& file) {
  Json document = Json::parse(io::read_text(file), nullptr, false);
  if (!document.is_object() || !document.contains("xxh3"))
    fail_input("{}: expected a sealed JSON document, found something else; remove it and run again",
               file.string());
  const Json found = document["xxh3"];
  document.erase("xxh3");
  if (found != hash_of(document.dump()))
    fail_input("{}: its checksum is not that of its content; remove it and run again", file.string());
  return document;
}

bool Store::exists(const fs::path& folder) {
  std::error_code code;
  return fs::exists(folder / "store.json", code);
}

Store Store::open(const fs::path& folder) {
  if (!exists(folder))
    fail_input("{}: expected a store, found no store.json; make one by hybrid batch plan ARCHIVE --out {}",
               folder.string(), folder.string());
  const Json document = Json::parse(io::read_text(folder / "store.json"), nullptr, false);
  if (!document.is_object() || document.value("format", "") != kStoreFormat)
    fail_input("{}: expected \"{}\", found something else; use a store of this version",
               (folder / "store.json").string(), kStoreFormat);
  return Store(fs::absolute(folder).lexically_normal());
}

void Store::expect_free(const fs::path& folder) {
  std::error_code code;
  if (exists(folder) || !fs::is_directory(folder, code)) return;
  const auto foreign = [](const fs::directory_entry& entry) {  // not a killed plan's
    const auto name = entry.path().filename().string();
    return name != "lock" && !name.starts_with(".part-");
  };
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
    if (foreign(*entry))
      fail_input("{}: expected a store or an empty folder, found {}; choose another --out", folder.string(),
                 entry->path().filename().string());
}

Store Store::create(const fs::path& folder) {
  expect_free(folder);
  if (!exists(folder)) io::write_text(folder / "store.json", Json{{"format", kStoreFormat}}.dump(1) + "\n");
  return open(folder);
}

fs::path Store::plan_in_force() const {
  std::error_code code;
  if (!fs::exists(manifest_file(), code))
    fail_input("{}: expected a plan, found no manifest.json; make one by hybrid batch plan ARCHIVE --out {}",
               folder_.string(), folder_.string());
  return manifest_file();
}

fs::path Store::object(const std::string& key) const {
  return in_shard(folder_ / "objects", key);
}
fs::path Store::failure_file(const std::string& key) const {
  return in_shard(folder_ / "failures", key) += ".json";
}
fs::path Store::failure_log(const std::string& key) const {
  return in_shard(folder_ / "failures", key) += ".log";
}
fs::path Store::result_link(const std::string& result) const {
  return folder_ / "results" / result;
}

bool Store::has(const std::string& key) const {
  std::error_code code;
  return fs::exists(object(key) / "object.json", code);
}

Json Store::object_json(const std::string& key) const {
  return unseal(object(key) / "object.json");
}
Json Store::record_json(const std::string& key) const {
  return unseal(object(key) / "record.json");
}

std::optional<Json> Store::failure(const std::string& key) const {
  std::error_code code;
  if (!fs::exists(failure_file(key), code)) return std::nullopt;
  try {
    return unseal(failure_file(key));
  } catch (const Error& error) {
    log::warning("{}", error.what());
    return std::nullopt;
  }
}

void Store::write_failure(const std::string& key, const Json& failure) const {
  io::write_text(failure_file(key), seal(failure));
  fail_point("failure-written");
}

void Store::forget_failure(const std::string& key) const {
  std::error_code code;
  if (!fs::exists(failure_file(key), code)) return;
  fs::remove(failure_file(key), code);
  fs::remove(failure_log(key), code);
}

fs::path Store::begin_object(const std::string& key) const {
  io::create_output_folder(folder_ / "work");
  std::string name = (folder_ / "work" / (key + "-XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr) io::fail_output(name, errno);
  fs::permissions(name, fs::perms::all & ~fs::perms::group_write & ~fs::perms::others_write);
  fail_point("object-begun");
  return name;
}

void Store::commit_object(const fs::path& work, const std::string& key, Json object, Json record) const {
  object["files"] = list_files(work, false);
  record["files"] = list_files(work, true);
  fail_point("object-made");
  io::write_text(work / "record.json", seal(std::move(record)));
  io::write_text(work / "object.json", seal(std::move(object)));
  bring_all_to_disk(work);
  fail_point("object-sealed");
  const fs::path target = this->object(key);
  io::create_output_folder(target.parent_path());
  if (std::rename(work.c_str(), target.c_str()) != 0) {
    const int reason = errno;
    std::error_code code;
    if (reason != EEXIST && reason != ENOTEMPTY) io::fail_output(target, reason);
    fs::remove_all(work, code);  // another run's is as good
    return;
  }
  fail_point("object-named");
  bring_to_disk(target.parent_path());
  bring_to_disk(folder_ / "objects");
  fail_point("object-committed");
}

void Store::link_result(const std::string& result, const std::string& key) const {
  const fs::path link = result_link(result), folder = link.parent_path();
  const fs::path target = object(key).lexically_relative(folder);
  std::error_code code;
  if (fs::read_symlink(link, code) == target) return;
  io::create_output_folder(folder);
  const fs::path temporary = folder / fmt::format(".part-{}", key);
  fs::remove(temporary, code);
  fs::create_symlink(target, temporary, code);
  if (code) io::fail_output(link, code.value());
  fail_point("result-linked");
  if (std::rename(temporary.c_str(), link.c_str()) != 0) io::fail_output(link, errno);
  bring_to_disk(folder);
}

void Store::clear_work() const {
  std::error_code code;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder_ / "work", code), end; !code && entry != end;
       entry.increment(code))
    left.push_back(entry->path());
  for (const auto& path : left) {
    fs::remove_all(path, code);
    if (code) log::warning("{}: a killed run's, cannot be removed ({})", path.string(), code.message());
  }
}

}  // namespace hybrid::archive
