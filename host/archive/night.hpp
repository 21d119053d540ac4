#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "archive/manifest.hpp"
#include "archive/store.hpp"

namespace hybrid::archive {

// A plan that was in force in a store, and what the store has of it.
struct Night {
  Store store;
  std::string name;  // the hash that names its manifest
  Manifest manifest;
};

// The manifests that a store has kept, the latest first: STORE/manifests/<hash>.json.
struct NightFile {
  std::string name;
  std::filesystem::path file;
  std::filesystem::file_time_type planned;
};
std::vector<NightFile> nights_of(const Store& store);

// "STORE": the plan in force. "STORE@1": the one before it, "STORE@2" the one before that; "STORE@3f2a": the
// one whose name begins so. Throws ErrorKind::input when there is none, listing those that there are.
Night open_night(const std::string& text);

}  // namespace hybrid::archive
