#include "batch/photographs/photograph_files.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::batch {
namespace {

namespace fs = std::filesystem;

// " (images/day1/IMG_1.jpg is there)", of a file of the same name in other letters or another folder below.
std::string like_of(const fs::path& folder, const fs::path& missing) {
  constexpr int kMostLooked = 100'000;
  const std::string name = io::lower_case(missing.filename().string());
  std::vector<fs::path> found;
  std::error_code code;
  int looked = 0;
  for (fs::recursive_directory_iterator entry(folder, code), end;
       !code && entry != end && ++looked < kMostLooked; entry.increment(code))
    if (io::lower_case(entry->path().filename().string()) == name) found.push_back(entry->path());
  if (found.empty()) return "";
  return fmt::format(" ({} is there)", std::min_element(found.begin(), found.end())->string());
}

// The file below `images` that the end of a camera's name leads to, the longest first; empty: none.
fs::path by_end_of_name(const fs::path& images, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  std::error_code code;
  for (;;) {
    for (const char* extension : {"", ".jpg", ".JPG", ".jpeg", ".JPEG"}) {
      fs::path file = images / name;
      if (*extension != '\0' && file.extension() != ".png") continue;
      if (*extension != '\0') file.replace_extension(extension);
      if (fs::is_regular_file(file, code)) return file;
    }
    const auto slash = name.find('/', 1);
    if (slash == name.npos) return {};
    name.erase(0, slash + 1);
  }
}

bool are_different(std::vector<fs::path> files) {
  std::sort(files.begin(), files.end());
  return std::adjacent_find(files.begin(), files.end()) == files.end();
}

}  // namespace

PhotographFiles find_photographs(const io::SceneFile::Photographs& section,
                                 const std::vector<Photograph>& cameras) {
  PhotographFiles files;
  std::vector<fs::path> elsewhere;
  std::error_code code;
  for (const Photograph& photograph : cameras) {
    files.all.push_back(section.images / photograph.name);
    elsewhere.push_back(files.all.back());
    if (fs::exists(files.all.back(), code)) continue;
    files.missing.push_back(files.all.back());
    elsewhere.back() = by_end_of_name(section.images, photograph.name);
  }
  const auto is_found = [](const fs::path& file) { return !file.empty(); };
  if (files.missing.empty() || !std::all_of(elsewhere.begin(), elsewhere.end(), is_found) ||
      !are_different(elsewhere))
    return files;
  const auto first = static_cast<std::size_t>(
      std::mismatch(files.all.begin(), files.all.end(), elsewhere.begin()).first - files.all.begin());
  files.note =
      fmt::format("{} of {} photographs are not where their names lead; taken by the end of these: {} for {}",
                  files.missing.size(), files.all.size(),
                  elsewhere[first].lexically_relative(section.images).generic_string(), cameras[first].name);
  files.all = std::move(elsewhere);
  files.missing.clear();
  return files;
}

PhotographFiles photograph_files(const io::SceneFile::Photographs& section,
                                 const std::vector<Photograph>& cameras, bool salvage) {
  PhotographFiles files = find_photographs(section, cameras);
  if (files.missing.empty() || salvage) return files;
  fail_input(
      "{}: no such file{}, and {} of {} photographs in all are missing; put them there, set [photographs] "
      "images to the folder that the names of {} start from, take their cameras out, or use the others with "
      "--salvage",
      files.missing.front().string(), like_of(section.images, files.missing.front()), files.missing.size(),
      files.all.size(), section.cameras.path.string());
}

}  // namespace hybrid::batch
