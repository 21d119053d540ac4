#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace hybrid::archive {

// The store of an archive: what every unit of the plan made, by what it was made from. Everything is a file;
// whoever can read them can tell the state, and nothing else is kept anywhere.
//
//   STORE/
//     store.json               says that the folder is a store, and its format
//     manifest.json            the plan in force (manifest.hpp)
//     manifests/<hash>.json    every plan that was in force, under the XXH3-128 of its bytes; these are the
//                              nights. Newest modification time: the latest
//     inputs.json              sizes, times and hashes of inputs, so that unchanged ones are not read again;
//                              a cache: may be deleted
//     objects/<kk>/<key>/      what one unit made. <key>: 32 hex digits, XXH3-128 of all that it was made
//                              from; <kk>: the first two. Appears by rename when complete and is never
//                              changed
//       object.json              sealed. key, kind, status ("done", or "partial": some of its scans or views
//                              failed), failures, from (what the key was made of), and files: path, bytes
//                              and xxh3 of every file below, by path. Same bytes on every run; units of one
//                              key share it
//       record.json              sealed. unit (the first that made it), host, finished (UTC), seconds, cpu_s,
//                              memory_bytes (peak of its process), kept_bytes (what that held before, of
//                              earlier units), threads, and files as above for those that differ from run
//                              to run: timing.json, report/timing.js, log.txt
//       log.txt                  what the unit said
//       scene:                   what `hybrid run` writes: summary.json, scans/, views/, report/ ...
//       planes of a loose scan:  what `hybrid planes` writes
//       planes of a scene's scan: kept.bin (kept_scan.hpp), summary.json
//       report:                  archive.json, index.html (report/archive_page.hpp), report/timing.js
//     failures/<kk>/<key>.json  sealed. The unit's last failure: unit, error, exit_code, attempts,
//                              quarantined, command (runs it again), finished. Gone when it succeeds
//     failures/<kk>/<key>.log   what it said
//     results/                 links into objects/ under the archive's own names:
//       <scene folder>/scene, <scan file>/planes-<scan id>, and report
//     work/                    units in flight; emptied by the next run
//     lock                     held by a run, a plan or a pruning (store_lock.hpp)
//     lock.keys                held, a byte for each key, by runs of single units
//
// Sealed: a JSON document whose last member "xxh3" is the XXH3-128 of its text without that member.
class Store {
 public:
  // Whether the folder says that it is a store.
  static bool exists(const std::filesystem::path& folder);
  // Of an existing store. Throws ErrorKind::input when the folder is none, or of another format.
  static Store open(const std::filesystem::path& folder);
  // Makes it where there is none. Throws as io::write_text does, and ErrorKind::input when the folder holds
  // other things.
  static Store create(const std::filesystem::path& folder);
  // Throws as create() does where it would find other things in the folder; makes nothing.
  static void expect_free(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path manifest_file() const { return folder_ / "manifest.json"; }
  // The same of a store that has a plan; else throws ErrorKind::input.
  std::filesystem::path plan_in_force() const;
  std::filesystem::path inputs_file() const { return folder_ / "inputs.json"; }
  std::filesystem::path lock_file() const { return folder_ / "lock"; }
  std::filesystem::path key_lock_file() const { return folder_ / "lock.keys"; }
  std::filesystem::path object(const std::string& key) const;
  std::filesystem::path failure_file(const std::string& key) const;
  std::filesystem::path failure_log(const std::string& key) const;
  std::filesystem::path result_link(const std::string& result) const;

  bool has(const std::string& key) const;
  // object.json and record.json, their seals checked. Throws ErrorKind::input naming the file.
  nlohmann::ordered_json object_json(const std::string& key) const;
  nlohmann::ordered_json record_json(const std::string& key) const;
  // Nothing when there was none; a damaged one counts as none.
  std::optional<nlohmann::ordered_json> failure(const std::string& key) const;
  void write_failure(const std::string& key, const nlohmann::ordered_json& failure) const;
  void forget_failure(const std::string& key) const;

  // A fresh folder under work/ for one unit in flight.
  std::filesystem::path begin_object(const std::string& key) const;
  // Seals a folder of begin_object() and gives it its name: checksums, object.json, record.json, fsync of all
  // folders, rename. `object` and `record` get "files" added. Where the object is there already, by another
  // run, the folder is dropped.
  void commit_object(const std::filesystem::path& work, const std::string& key, nlohmann::ordered_json object,
                     nlohmann::ordered_json record) const;

  // Lets the link say this object; does nothing where it does so already.
  void link_result(const std::string& result, const std::string& key) const;

  // Removes what is in work/. Only when no other run is about (store_lock.hpp).
  void clear_work() const;

 private:
  explicit Store(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
};

// Files of an object that differ from run to run.
bool is_volatile(const std::string& path);

// XXH3-128 of some text, 32 hex digits.
std::string hash_of(const std::string& text);

// A JSON text with its seal, and back. unseal throws ErrorKind::input naming the file when the seal is
// broken.
std::string seal(nlohmann::ordered_json document);
nlohmann::ordered_json unseal(const std::filesystem::path& file);

}  // namespace hybrid::archive
