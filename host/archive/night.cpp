#include "archive/night.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace fs = std::filesystem;
namespace {

// Up to three digits count back; more would be the beginning of a name.
bool counts_back(const std::string& which) {
  return which.size() <= 3 &&
         std::all_of(which.begin(), which.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::string listed(const std::vector<NightFile>& nights) {
  std::string text;
  for (std::size_t i = 0; i < nights.size() && i < 10; ++i)
    text += fmt::format("{}@{} = @{}", i == 0 ? "" : ", ", i, nights[i].name.substr(0, 8));
  return text.empty() ? "none" : text;
}

}  // namespace

std::vector<NightFile> nights_of(const Store& store) {
  std::vector<NightFile> nights;
  std::error_code code;
  for (fs::directory_iterator entry(store.folder() / "manifests", code), end; !code && entry != end;
       entry.increment(code))
    if (entry->path().extension() == ".json")
      nights.push_back({entry->path().stem().string(), entry->path(), entry->last_write_time()});
  std::sort(nights.begin(), nights.end(), [](const NightFile& a, const NightFile& b) {
    return a.planned != b.planned ? a.planned > b.planned : a.name < b.name;
  });
  return nights;
}

Night open_night(const std::string& text) {
  const auto at = text.rfind('@');
  std::error_code ignored;
  if (at == std::string::npos || fs::exists(text, ignored)) {
    Store store = Store::open(text);
    const fs::path plan = store.plan_in_force();
    return {store, hash_of(io::read_text(plan)), read_manifest(plan)};
  }
  Store store = Store::open(text.substr(0, at));
  const std::string which = text.substr(at + 1);
  const auto nights = nights_of(store);
  if (!which.empty() && counts_back(which) && std::stoul(which) < nights.size()) {
    const auto& night = nights[std::stoul(which)];
    return {store, night.name, read_manifest(night.file)};
  }
  std::vector<NightFile> found;
  for (const auto& night : nights)
    if (which.size() >= 4 && night.name.starts_with(which)) found.push_back(night);
  if (found.size() == 1) return {store, found.front().name, read_manifest(found.front().file)};
  fail_input(
      "{}: expected a number of nights back, or four letters and more of a night's name; found {} of {}",
      text, found.size() > 1 ? "several" : "none", listed(nights));
}

}  // namespace hybrid::archive
