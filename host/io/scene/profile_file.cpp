#include "io/scene/profile_file.hpp"

#include <fnmatch.h>

#include "io/scene/scene_table.hpp"

namespace hybrid::io {
namespace {

std::string written(const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  return std::get<std::string>(value);
}

void read_settings(const SceneTable& table, ProfileSettings& settings) {
  if (table.has("salvage")) settings.salvage = table.flag("salvage", false);
  if (table.has("leave_one_out")) settings.leave_one_out = table.flag("leave_one_out", false);
  settings.seed = table.index("seed");
  static const SceneTable::Names kGroups = {"auto", "folder", "file", "none"};  // in the order of Group
  if (!table.has("group")) return;
  const std::string group = table.choice("group", kGroups, "auto");
  settings.group = static_cast<Group>(std::find(kGroups.begin(), kGroups.end(), group) - kGroups.begin());
}

void read_sections(const SceneTable& table, const SceneTable::Names& own, ProfileSettings& settings) {
  for (const std::string& section : table.keys()) {
    if (std::find(own.begin(), own.end(), section) != own.end()) continue;
    const auto options = table.table(section, {});
    if (section == "export" && options->keys().empty())  // which would be nothing to assign
      options->fail_table("expected what is to be exported, found no keys; write formats = \"all\"");
    for (const std::string& key : options->keys()) {
      settings.assignments.push_back(section + "." + key + "=" + written(options->option(key)));
      settings.lines.push_back(options->line_of(key));
    }
  }
}

void merge(const ProfileSettings& over, ProfileSettings& settings) {
  if (over.salvage) settings.salvage = over.salvage;
  if (over.leave_one_out) settings.leave_one_out = over.leave_one_out;
  if (over.seed) settings.seed = over.seed;
  if (over.group) settings.group = over.group;
  settings.assignments.insert(settings.assignments.end(), over.assignments.begin(), over.assignments.end());
  settings.lines.insert(settings.lines.end(), over.lines.begin(), over.lines.end());
}

ProfileFile read_profile(const std::filesystem::path& file, const toml::table& document) {
  static const SceneTable::Names kOwn = {"run", "scene"};
  static const SceneTable::Names kSections = {"planes", "register", "edit", "render", "export"};
  static const SceneTable::Names kSettings = {"salvage", "leave_one_out", "seed", "group"};
  static const SceneTable::Names kScene = {"match", "salvage", "leave_one_out", "seed", "group"};
  const auto with_sections = [](SceneTable::Names names) {
    names.insert(names.end(), kSections.begin(), kSections.end());
    return names;
  };
  const SceneTable root(file, "", document, with_sections(kOwn));
  ProfileFile profile;
  if (const auto run = root.table("run", kSettings)) read_settings(*run, profile.all);
  read_sections(root, kOwn, profile.all);
  for (const SceneTable& table : root.tables("scene", with_sections(kScene))) {
    ProfileFile::Override one;
    one.line = table.line();
    one.match = table.required_text("match");
    read_settings(table, one.settings);
    read_sections(table, kScene, one.settings);
    profile.overrides.push_back(std::move(one));
  }
  return profile;
}

}  // namespace

bool ProfileFile::Override::matches(const std::string& scene) const {
  return fnmatch(match.c_str(), scene.c_str(), 0) == 0;
}

ProfileSettings ProfileFile::settings_of(const std::string& scene) const {
  ProfileSettings settings = all;
  for (const Override& one : overrides)
    if (one.matches(scene)) merge(one.settings, settings);
  return settings;
}

ProfileFile read_profile_file(const std::filesystem::path& file) {
  const std::string text = read_plain_text(file);
  try {
    const toml::table document = toml::parse(text, file.string());
    return read_profile(file, document);
  } catch (const toml::parse_error& error) {
    fail_input("{}:{}:{}: no valid TOML: {}", file.string(), error.source().begin.line,
               error.source().begin.column, error.description());
  }
}

}  // namespace hybrid::io
