#include "archive/sql.hpp"

#include "core/error.hpp"
#include "core/json_text.hpp"

namespace hybrid::archive {

SqlFile::SqlFile(const std::filesystem::path& file) : file_(file) {
  if (sqlite3_open(file.c_str(), &database_) != SQLITE_OK) fail_with("cannot be opened");
  run("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN;");
}

SqlFile::~SqlFile() {
  sqlite3_close(database_);
}

void SqlFile::fail_with(const std::string& what) const {
  const bool full = sqlite3_errcode(database_) == SQLITE_FULL;
  const std::string reason = sqlite3_errmsg(database_);
  if (full) fail(ErrorKind::temporary, "{}: the disk is full; free space and run again", file_.string());
  fail(ErrorKind::failed, "{}: {}: {}", file_.string(), what, reason);
}

void SqlFile::run(const std::string& statements) {
  if (sqlite3_exec(database_, statements.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    fail_with("cannot be written");
}

void SqlFile::commit() {
  run("COMMIT;");
}

SqlInsert::SqlInsert(SqlFile& file, const std::string& table, int columns) : file_(file), columns_(columns) {
  std::string sql = "INSERT INTO " + table + " VALUES (?";
  for (int i = 1; i < columns; ++i) sql += ", ?";
  sql += ")";
  if (sqlite3_prepare_v2(file_.database_, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK)
    file_.fail_with("cannot be prepared");
}

SqlInsert::~SqlInsert() {
  sqlite3_finalize(statement_);
}

void SqlInsert::add(const nlohmann::ordered_json& row) {
  if (row.size() != static_cast<std::size_t>(columns_))
    fail(ErrorKind::failed, "catalogue: a row of {} values for {} columns", row.size(), columns_);
  for (int i = 0; i < columns_; ++i) {
    const auto& value = row[static_cast<std::size_t>(i)];
    if (value.is_null()) {
      sqlite3_bind_null(statement_, i + 1);
    } else if (value.is_boolean()) {
      sqlite3_bind_int64(statement_, i + 1, value.get<bool>() ? 1 : 0);
    } else if (value.is_number_integer()) {
      sqlite3_bind_int64(statement_, i + 1, value.get<std::int64_t>());
    } else if (value.is_number()) {
      sqlite3_bind_double(statement_, i + 1, value.get<double>());
    } else {
      const std::string text = value.is_string() ? value.get<std::string>() : json_text(value, -1);
      sqlite3_bind_text(statement_, i + 1, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
    }
  }
  if (sqlite3_step(statement_) != SQLITE_DONE) file_.fail_with("a row cannot be written");
  sqlite3_reset(statement_);
  ++rows_;
}

}  // namespace hybrid::archive
