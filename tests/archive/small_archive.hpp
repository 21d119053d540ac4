#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "../e2e/program.hpp"

namespace hybrid::e2e {

// An archive of the smallest scenes, in folders of their own: "a", "b", ... Each has one scan, "s", in which
// one sample is another than in the others'.
void write_small_archive(const std::filesystem::path& archive, int scenes);

// Such an archive of three scenes with a store after its first night, made once per process; the test's own
// copy. Keys know no paths: the store is good for the copy.
struct FirstNight {
  Scratch scratch;
  const std::filesystem::path archive = scratch / "archive", store = scratch / "store";
  FirstNight();
};

// Another scan in the place of that of a scene: the same room, one sample moved by a millimetre.
void change_scan(const std::filesystem::path& scene);

Outcome plan(const std::filesystem::path& archive, const std::filesystem::path& store,
             const std::string& options = "");
Outcome run_store(const std::filesystem::path& store, const std::string& options = "");
nlohmann::json json_of(const Outcome& outcome);
nlohmann::json status_of(const std::filesystem::path& store);

// What must be the same after every way to the same end: path and content of each object's files and each
// result's link, without what tells of the run itself.
std::string results_of(const std::filesystem::path& store);
// The same of the object that a scene's link leads to.
std::string made_for(const std::filesystem::path& store, const std::string& scene);

// Inode, modification and change times of every file: equal only where nothing was written.
std::map<std::string, std::string> stamps_of(const std::filesystem::path& store);

}  // namespace hybrid::e2e
