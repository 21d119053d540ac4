#pragma once
#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace hybrid::archive {

// A SQLite database being written, in one transaction and without a journal: the file is a temporary until
// it is complete.
class SqlFile {
 public:
  // Throws ErrorKind::failed or, when the disk is full, temporary, as all of its functions do.
  explicit SqlFile(const std::filesystem::path& file);
  ~SqlFile();
  SqlFile(const SqlFile&) = delete;
  SqlFile& operator=(const SqlFile&) = delete;

  void run(const std::string& statements);
  void commit();

 private:
  friend class SqlInsert;
  [[noreturn]] void fail_with(const std::string& what) const;
  std::filesystem::path file_;
  sqlite3* database_ = nullptr;
};

// Rows into one table; a row is a JSON array of numbers, texts and nulls.
class SqlInsert {
 public:
  SqlInsert(SqlFile& file, const std::string& table, int columns);
  ~SqlInsert();
  SqlInsert(const SqlInsert&) = delete;
  SqlInsert& operator=(const SqlInsert&) = delete;
  void add(const nlohmann::ordered_json& row);
  std::int64_t rows() const { return rows_; }

 private:
  SqlFile& file_;
  sqlite3_stmt* statement_ = nullptr;
  int columns_;
  std::int64_t rows_ = 0;
};

}  // namespace hybrid::archive
