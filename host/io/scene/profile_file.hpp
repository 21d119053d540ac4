#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hybrid::io {

// How a batch processes its scenes, as a TOML file says it:
//
//   [run]                       all optional
//   salvage = true              of damaged scans what is good
//   leave_one_out = true        every photograph's view from the others
//   seed = 1
//   group = "auto"              loose scans of a folder or file as a scene, registered to each other (Group)
//   [planes] ... [register] ... [edit] ... [render] ... [export]   options over those of every scene file
//   [[scene]]                   and again for the scenes whose name in the archive matches
//   match = "abbey/*"           * and ? as in a shell; * also takes slashes
//   salvage = false
//   render.blend = "nearest"

// Which loose scans, those that no scene file names, are a scene: those of a folder, where they are not too
// many (see the plan), else those of a file with several; those of a folder, however many; those of a file
// with several; none.
enum class Group { automatic, folder, file, none };

struct ProfileSettings {
  std::optional<bool> salvage, leave_one_out;
  std::optional<int> seed;
  std::optional<Group> group;            // of the folder that has this name in the archive
  std::vector<std::string> assignments;  // SECTION.KEY=VALUE as --set takes them, in the file's order
  std::vector<int> lines;                // of each assignment in the file; empty once it is in a manifest
};
struct ProfileFile {
  ProfileSettings all;
  struct Override {
    int line = 0;
    std::string match;
    ProfileSettings settings;

    bool matches(const std::string& scene) const;
  };
  std::vector<Override> overrides;

  // Of the scene of this name: `all`, then every override that matches, in order.
  ProfileSettings settings_of(const std::string& scene) const;
};

// Throws ErrorKind::input naming file, line and key: unknown keys of its own, wrong types. Keys of options
// are checked by who applies them.
ProfileFile read_profile_file(const std::filesystem::path& file);

}  // namespace hybrid::io
