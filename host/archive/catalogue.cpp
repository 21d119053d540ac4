#include "archive/catalogue.hpp"

#include <ctime>
#include <set>

#include "archive/figures.hpp"
#include "archive/night.hpp"
#include "archive/outcome.hpp"
#include "archive/sql.hpp"
#include "core/interrupt.hpp"
#include "core/log.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kTables = R"sql(
CREATE TABLE nights (night INTEGER PRIMARY KEY, name TEXT, planned TEXT, archive TEXT, sources TEXT, build TEXT,
                     device TEXT, units INTEGER, problems INTEGER);
CREATE TABLE units (night INTEGER, unit INTEGER, id TEXT, kind TEXT, result TEXT, state TEXT, object TEXT,
                    error TEXT, PRIMARY KEY (night, unit)) WITHOUT ROWID;
CREATE TABLE inputs (night INTEGER, unit INTEGER, file TEXT, bytes INTEGER, xxh3 TEXT);
CREATE TABLE objects (object TEXT PRIMARY KEY, unit TEXT, kind TEXT, status TEXT, host TEXT, finished TEXT,
                      seconds REAL, cpu_s REAL, memory_bytes INTEGER, threads INTEGER, files INTEGER,
                      bytes INTEGER) WITHOUT ROWID;
CREATE TABLE figures (object TEXT, subject TEXT, name TEXT, value REAL, text TEXT,
                      PRIMARY KEY (object, subject, name)) WITHOUT ROWID;
CREATE TABLE failures (object TEXT, part TEXT, error TEXT, kind TEXT, attempts INTEGER, quarantined INTEGER,
                       finished TEXT, command TEXT, log TEXT);
CREATE TABLE problems (night INTEGER, path TEXT, what TEXT);
CREATE VIEW history AS
  SELECT nights.night, nights.planned, units.result, figures.subject, figures.name, figures.value
  FROM figures JOIN units ON units.object = figures.object JOIN nights ON nights.night = units.night
  WHERE units.result IS NOT NULL ORDER BY units.result, figures.subject, figures.name, nights.night DESC;
)sql";

std::string utc(fs::file_time_type time) {
  const auto system =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::file_clock::to_sys(time));
  const std::time_t seconds = std::chrono::system_clock::to_time_t(system);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts);
  return text;
}

Json or_null(const Json& document, const char* key) {
  return document.contains(key) ? document[key] : Json(nullptr);
}

class Catalogue {
 public:
  Catalogue(const Store& store, const fs::path& file)
      : store_(store),
        file_(file),
        tables_((file_.run(kTables), true)),
        nights_(file_, "nights", 9),
        units_(file_, "units", 8),
        inputs_(file_, "inputs", 5),
        objects_(file_, "objects", 12),
        figures_(file_, "figures", 5),
        failures_(file_, "failures", 9),
        problems_(file_, "problems", 3) {}

  Json fill() {
    const auto nights = nights_of(store_);
    for (std::size_t i = 0; i < nights.size(); ++i) add_night(i, nights[i]);
    file_.commit();
    return {{"nights", nights_.rows()},   {"units", units_.rows()},       {"objects", objects_.rows()},
            {"figures", figures_.rows()}, {"failures", failures_.rows()}, {"problems", problems_.rows()}};
  }

 private:
  void add_night(std::size_t night, const NightFile& file) {
    const Manifest manifest = read_manifest(file.file);
    nights_.add({night, file.name, utc(file.planned), manifest.archive.string(), manifest.build.all_sources,
                 manifest.build.kind, manifest.build.device, manifest.units.size(),
                 manifest.problems.size()});
    for (const auto& [path, what] : manifest.problems) problems_.add({night, path, what});
    Outcomes outcomes(store_, manifest);
    for (const Unit& unit : manifest.units) {
      check_interrupted();
      const Outcome& outcome = outcomes.of(unit.index);
      const Json error = outcome.error.empty() ? Json(nullptr) : Json(outcome.error);
      units_.add({night, unit.number, unit.id, name_of(unit.kind),
                  unit.result.empty() ? Json(nullptr) : Json(unit.result), name_of(outcome.state),
                  outcome.key.empty() ? Json(nullptr) : Json(outcome.key), error});
      for (const Input& input : unit.inputs)
        inputs_.add({night, unit.number, input.file.string(), input.bytes, input.xxh3});
      if (!outcome.key.empty() && seen_.insert(outcome.key).second) add_outcome(unit, outcome);
    }
  }

  void add_outcome(const Unit& unit, const Outcome& outcome) {
    if (outcome.state == UnitState::done || outcome.state == UnitState::partial)
      add_object(outcome.key);
    else if (const auto failure = store_.failure(outcome.key))
      failures_.add({outcome.key, unit.id, or_null(*failure, "error"), or_null(*failure, "error_kind"),
                     or_null(*failure, "attempts"), or_null(*failure, "quarantined"),
                     or_null(*failure, "finished"), or_null(*failure, "command"), or_null(*failure, "log")});
  }

  // An object that another process removes meanwhile, or that is damaged, is left out and said.
  void add_object(const std::string& key) {
    Json object, record, summary;
    try {
      object = store_.object_json(key);
      record = store_.record_json(key);
      std::error_code ignored;
      const fs::path file = store_.object(key) / "summary.json";
      if (fs::exists(file, ignored)) summary = Json::parse(io::read_text(file), nullptr, false);
    } catch (const Error& error) {
      log::warning("{}; not in the catalogue", error.what());
      return;
    }
    std::uintmax_t bytes = 0;
    for (const auto& file : object["files"]) bytes += file.value("bytes", std::uintmax_t{0});
    objects_.add({key, or_null(record, "unit"), or_null(object, "kind"), or_null(object, "status"),
                  or_null(record, "host"), or_null(record, "finished"), or_null(record, "seconds"),
                  or_null(record, "cpu_s"), or_null(record, "memory_bytes"), or_null(record, "threads"),
                  object["files"].size(), bytes});
    for (const auto& failure : object["failures"])
      failures_.add({key, or_null(failure, "unit"), or_null(failure, "error"), nullptr, nullptr, nullptr,
                     or_null(record, "finished"), nullptr, nullptr});
    for (const auto& [name, value] : figures_of(summary))
      figures_.add({key, name.first, name.second, value.is_number() ? value : Json(nullptr),
                    value.is_number() ? Json(nullptr) : value});
  }

  const Store& store_;
  SqlFile file_;
  bool tables_;  // made before statements refer to them
  SqlInsert nights_, units_, inputs_, objects_, figures_, failures_, problems_;
  std::set<std::string> seen_;
};

}  // namespace

Json write_catalogue(const Store& store) {
  Json counts;
  const fs::path file = store.folder() / "catalogue.sqlite";
  io::write_atomically(file, [&](const fs::path& temporary) { counts = Catalogue(store, temporary).fill(); });
  counts["catalogue"] = file.string();
  return counts;
}

}  // namespace hybrid::archive
