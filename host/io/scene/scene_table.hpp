#pragma once
#include <toml++/toml.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/option_table.hpp"
#include "geometry/vectors.hpp"
#include "io/text/plain_text.hpp"

namespace hybrid::io {

// One table of a scene file, read by key. Every error is ErrorKind::input of the form
// "scene.toml:12: [[scan]] 2: index: expected ..., found ...". Getters return nothing (or the fallback) for
// an absent key and throw for one of the wrong type or range.
class SceneTable {
 public:
  using Names = std::vector<std::string_view>;

  // `place` is how messages call the table. Throws when it has a key that is not in `known`; `known` empty:
  // any.
  SceneTable(const std::filesystem::path& file, std::string place, const toml::table& table,
             const Names& known);

  int line() const { return static_cast<int>(table_->source().begin.line); }
  bool has(std::string_view key) const { return table_->contains(key); }
  std::vector<std::string> keys() const;

  std::optional<std::string> text(std::string_view key) const;  // without control characters
  std::string required_text(std::string_view key) const;
  std::string choice(std::string_view key, const Names& choices, std::string_view fallback) const;
  std::vector<std::string> texts(std::string_view key) const;
  // Usable as the name of a folder: not empty, "." or "..", no slashes, at most 200 bytes.
  std::optional<std::string> folder_name(std::string_view key) const;
  // ${NAME} and ${NAME:-default} expanded, relative to the scene file's folder.
  std::optional<std::filesystem::path> path(std::string_view key) const;
  std::filesystem::path required_path(std::string_view key) const;
  std::vector<std::filesystem::path> paths(
      std::string_view key) const;                       // one or an array of them, at least one
  std::optional<int> index(std::string_view key) const;  // 0 or more
  std::optional<double> number(std::string_view key) const;
  bool flag(std::string_view key, bool fallback) const;
  std::optional<Vec3> point(std::string_view key) const;
  std::optional<std::array<int, 2>> index_pair(std::string_view key) const;
  std::optional<std::array<double, 16>> pose(std::string_view key) const;  // a similarity
  OptionValue scalar(std::string_view key) const;
  OptionValue option(std::string_view key) const;  // a scalar, or the texts of an array, separated by ", "
  bool holds_tables(std::string_view key) const;   // one, or an array of them
  std::vector<OptionValue> scalars(std::string_view key) const;  // an array of them
  std::vector<double> numbers(std::string_view key, std::size_t count) const;
  // [[x, y], ...]: at least `least` points of `dimension` numbers.
  std::vector<std::vector<double>> points(std::string_view key, std::size_t dimension,
                                          std::size_t least) const;

  std::optional<SceneTable> table(std::string_view key, const Names& known) const;
  std::vector<SceneTable> tables(std::string_view key, const Names& known) const;  // [[key]] or [{...}, ...]

  int line_of(std::string_view key) const;
  template <typename... Args>
  [[noreturn]] void fail_key(std::string_view key, fmt::format_string<Args...> format, Args&&... args) const {
    fail_at(file_, line_of(key), "{}{}: {}", before(), key, fmt::format(format, std::forward<Args>(args)...));
  }
  template <typename... Args>
  [[noreturn]] void fail_table(fmt::format_string<Args...> format, Args&&... args) const {
    fail_at(file_, line(), "{}{}", before(), fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  std::vector<double> numbers(std::string_view key, const toml::node& node, std::size_t count) const;
  std::filesystem::path resolved(std::string_view key, const std::string& written) const;
  OptionValue scalar(std::string_view key, const toml::node& node) const;
  int whole(std::string_view key, const toml::node& node) const;
  std::string before() const { return place_.empty() ? "" : place_ + ": "; }  // what is said of it

  std::filesystem::path file_;
  std::string place_;
  const toml::table* table_;  // of the document, which must outlive this
};

}  // namespace hybrid::io
