#include "power_disk.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include "power/power_cut.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

struct Entry {
  char kind = '?';
  std::string id, target;
};
using Entries = std::map<std::string, Entry>;  // by name

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Entries parse(const std::string& text) {
  Entries entries;
  for (std::size_t at = 0; at < text.size();) {
    const auto id_at = at + 2, name_at = text.find(' ', id_at) + 1, end = text.find('\0', name_at);
    const auto target_end = text.find('\0', end + 1);
    entries[text.substr(name_at, end - name_at)] = {text[at], text.substr(id_at, name_at - 1 - id_at),
                                                    text.substr(end + 1, target_end - end - 1)};
    at = target_end + 1;
  }
  return entries;
}

Entries entries_now(const fs::path& folder) {
  std::string text;
  for (const auto& entry : fs::directory_iterator(folder)) text += power::describe(entry.path());
  return parse(text);
}

// The disk after a restart, made anew in another place.
class Restart {
 public:
  Restart(fs::path state, Loss loss, std::uint32_t seed)
      : state_(std::move(state)), loss_(loss), random_(seed) {}

  void make(const fs::path& from, const fs::path& to) {
    note_places(from);
    make_folder(power::id_of(from), to);
  }

 private:
  void note_places(const fs::path& folder) {
    places_[power::id_of(folder)] = folder;
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_directory() && !entry.is_symlink())
        note_places(entry.path());
      else
        places_[power::id_of(entry.path())] = entry.path();
  }

  bool chance() { return loss_ == Loss::by_chance && random_() % 2 == 0; }

  void make_folder(const std::string& id, const fs::path& to) {
    fs::create_directory(to);
    const Entries known = parse(read(state_ / ("folder-" + id)));
    const auto place = places_.find(id);
    const Entries now = place == places_.end() ? Entries() : entries_now(place->second);
    Entries all = known;
    all.insert(now.begin(), now.end());
    for (const auto& [name, unused] : all) {
      const bool same = known.count(name) && now.count(name) && known.at(name).id == now.at(name).id;
      const Entries& which = !same && chance() ? now : known;
      if (const auto entry = which.find(name); entry != which.end()) make_entry(entry->second, to / name);
    }
  }

  void make_entry(const Entry& entry, const fs::path& to) {
    if (entry.kind == 'd') return make_folder(entry.id, to);
    if (entry.kind == 'l') return fs::create_symlink(entry.target, to);
    std::string bytes = read(state_ / ("file-" + entry.id));
    if (const auto place = places_.find(entry.id); place != places_.end())
      if (std::string now = read(place->second); now != bytes && chance()) {
        bytes = std::move(now);
        if (chance()) bytes.resize(bytes.size() / 2);
      }
    std::ofstream(to, std::ios::binary) << bytes;
  }

  const fs::path state_;
  const Loss loss_;
  std::mt19937 random_;
  std::map<std::string, fs::path> places_;  // by id
};

}  // namespace

PowerDisk::PowerDisk(fs::path folder, fs::path state) : folder_(std::move(folder)), state_(std::move(state)) {
  fs::create_directories(folder_);
  fs::create_directories(state_);
  std::ofstream(state_ / "operations", std::ios::binary) << std::string(sizeof(unsigned long), '\0');
}

// The lock on `alive` is every started process's; a group of its own can die as one.
std::string PowerDisk::environment(unsigned long cut_at, const std::string& ignore) const {
  return "exec 9>" + (state_ / "alive").string() +
         "; flock 9; LD_PRELOAD=" HYBRID_POWER_CUT " POWER_FOLDER=" + folder_.string() +
         " POWER_STATE=" + state_.string() +
         " POWER_CUT_AT=" + std::to_string(cut_at ? operations() + cut_at : 0) + " POWER_IGNORE=" + ignore +
         " setsid --wait ";
}

unsigned long PowerDisk::operations() const {
  const std::string bytes = read(state_ / "operations");
  unsigned long count = 0;
  std::memcpy(&count, bytes.data(), std::min(bytes.size(), sizeof count));
  return count;
}

void PowerDisk::restart(Loss loss, std::uint32_t seed) const {
  const int alive = open((state_ / "alive").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  flock(alive, LOCK_EX);
  close(alive);
  if (loss == Loss::nothing) return;
  const fs::path made = folder_.string() + "-restarted";
  Restart(state_, loss, seed).make(folder_, made);
  fs::remove_all(folder_);
  fs::rename(made, folder_);
}

}  // namespace hybrid::e2e
