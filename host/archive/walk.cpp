#include "archive/walk.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <utility>

#include "core/error.hpp"
#include "io/read_scan.hpp"
#include "io/scene/implied_scene.hpp"

namespace hybrid::archive {
namespace {

namespace fs = std::filesystem;
using FolderId = std::pair<dev_t, ino_t>;

bool is_utf8(const std::string& text) {
  std::size_t follow = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (follow > 0) {
      if ((byte & 0xc0) != 0x80) return false;
      --follow;
    } else if (byte >= 0x80) {
      follow = byte >= 0xf0 && byte < 0xf5 ? 3 : byte >= 0xe0 ? 2 : byte >= 0xc2 ? 1 : 0;
      if (follow == 0 || byte >= 0xf5) return false;
    }
  }
  return follow == 0;
}

// For messages: bytes that are no text as ?.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) >= 0x80 || static_cast<unsigned char>(c) < 0x20) c = '?';
  return text;
}

class Walk {
 public:
  explicit Walk(fs::path root) : root_(std::move(root)) {}

  ArchiveContent go() {
    const auto id = id_of(root_);
    if (!id || !fs::is_directory(root_))
      fail_input("{}: expected an archive's folder, found {}; check the path", root_.string(),
                 id ? "a file" : "nothing");
    std::error_code code;
    fs::directory_iterator readable(root_, code);
    if (code) fail_input("{}: cannot be read ({}); change its permissions", root_.string(), code.message());
    folder(root_, *id, false);
    return std::move(content_);
  }

 private:
  static std::optional<FolderId> id_of(const fs::path& path) {
    struct stat found {};
    if (stat(path.c_str(), &found) != 0) return std::nullopt;
    return FolderId{found.st_dev, found.st_ino};
  }

  std::string named(const fs::path& path) const { return path.lexically_relative(root_).generic_string(); }
  void problem(const fs::path& path, const std::string& what) {
    content_.problems.push_back({named(path), what});
  }
  void note(const fs::path& path, const std::string& what) { content_.notes.push_back({named(path), what}); }

  void folder(const fs::path& path, const FolderId& id, bool below_scene) {
    const std::string name = named(path);
    if (std::find(above_.begin(), above_.end(), id) != above_.end())
      return problem(path, "a link to a folder above it; remove the link");
    if (const auto [first, fresh] = visited_.emplace(id, name); !fresh)
      return note(path, fmt::format("the same folder as {}: used once", first->second));
    std::vector<fs::path> entries;
    std::error_code code;
    for (fs::directory_iterator entry(path, code), end; !code && entry != end; entry.increment(code))
      entries.push_back(entry->path());
    if (code)
      return problem(path, fmt::format("cannot be read ({}); change its permissions", code.message()));
    std::sort(entries.begin(), entries.end());
    const auto has = [&](const char* file) {
      return std::binary_search(entries.begin(), entries.end(), path / file);
    };
    if (has("store.json") && has("manifest.json")) return note(path, "a store: left out");
    if (has("timing.json") && has("summary.json")) return note(path, "results of a run: left out");
    below_scene = below_scene || std::any_of(entries.begin(), entries.end(), io::has_scene_name);
    above_.push_back(id);
    for (const auto& entry : entries) visit(entry, below_scene);
    above_.pop_back();
  }

  void visit(const fs::path& path, bool below_scene) {
    const std::string name = path.filename().string();
    if (name.starts_with(".")) return;
    if (!is_utf8(name)) {
      content_.problems.push_back({printable(named(path)), "its name is not in UTF-8; rename it"});
      return;
    }
    std::error_code code;
    const auto status = fs::status(path, code);
    if (status.type() == fs::file_type::not_found || code) {
      if (code.value() == ELOOP) return problem(path, "a link to itself; remove the link");
      if (io::has_scene_name(path) || io::has_scan_extension(path))
        problem(path, "a link to nothing; restore what it points to, or remove it");
      return;
    }
    if (fs::is_directory(status)) {
      if (path.extension() == ".parts") return;  // of the range image beside it
      if (const auto id = id_of(path)) folder(path, *id, below_scene);
      return;
    }
    if (!fs::is_regular_file(status)) return;
    if (io::has_scene_name(path))
      content_.scenes.push_back(path);
    else if (!below_scene && io::is_scene_by_another_name(path))
      note(path, "a scene file by another name: left out; call it scene.toml or *.scene.toml");
    else if (io::has_scan_extension(path))
      (below_scene ? content_.beside_scenes : content_.loose).push_back(path);
  }

  fs::path root_;
  ArchiveContent content_;
  std::vector<FolderId> above_;
  std::map<FolderId, std::string> visited_;
};

}  // namespace

ArchiveContent walk_archive(const fs::path& archive) {
  return Walk(fs::absolute(archive).lexically_normal()).go();
}

}  // namespace hybrid::archive
