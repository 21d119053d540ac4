#include "io/scene/scene_table.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/suggest.hpp"
#include "geometry/pose.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

// The value as the file has it, for "found ...".
std::string describe(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* array = node.as_array()) return fmt::format("an array of {}", array->size());
  return node.is_table() ? "a table" : "a date or time";
}

bool has_control_characters(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; });
}

bool is_variable_name(std::string_view name) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
  return !name.empty() && name.find_first_not_of(kLetters) == std::string_view::npos;
}

}  // namespace

SceneTable::SceneTable(const fs::path& file, std::string place, const toml::table& table, const Names& known)
    : file_(file), place_(std::move(place)), table_(&table) {
  if (known.empty()) return;
  for (const auto& [key, value] : table)
    if (std::find(known.begin(), known.end(), key.str()) == known.end())
      fail_at(file_, static_cast<int>(key.source().begin.line), "{}{}", before(),
              unknown_name("key", key.str(), known));
}

std::vector<std::string> SceneTable::keys() const {
  std::vector<std::string> result;
  for (const auto& [key, value] : *table_) result.emplace_back(key.str());
  return result;
}

int SceneTable::line_of(std::string_view key) const {
  for (const auto& [name, value] : *table_)
    if (name == key) return static_cast<int>(name.source().begin.line);
  return line();
}

std::optional<std::string> SceneTable::text(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (!node) return std::nullopt;
  const auto* text = node->as_string();
  if (!text) fail_key(key, "expected a string, found {}", describe(*node));
  if (has_control_characters(text->get())) fail_key(key, "expected a string without control characters");
  return text->get();
}

std::string SceneTable::required_text(std::string_view key) const {
  auto value = text(key);
  if (!value) fail_table("expected the key {}, found none", key);
  if (value->empty()) fail_key(key, "expected a string that is not empty");
  return *value;
}

std::string SceneTable::choice(std::string_view key, const Names& choices, std::string_view fallback) const {
  const std::string value = text(key).value_or(std::string(fallback));
  if (std::find(choices.begin(), choices.end(), value) == choices.end())
    fail_key(key, "expected one of {}, found \"{}\"", fmt::join(choices, ", "), value);
  return value;
}

std::vector<std::string> SceneTable::texts(std::string_view key) const {
  const toml::node* node = table_->get(key);
  std::vector<std::string> result;
  if (!node) return result;
  const auto* array = node->as_array();
  if (!array) fail_key(key, "expected an array of strings, found {}", describe(*node));
  for (const toml::node& element : *array) {
    if (!element.is_string())
      fail_key(key, "expected an array of strings, found {} in it", describe(element));
    result.push_back(element.as_string()->get());
  }
  return result;
}

std::optional<std::string> SceneTable::folder_name(std::string_view key) const {
  constexpr std::size_t kLongest = 200;  // bytes; file systems allow 255 and some outputs append to it
  auto name = text(key);
  if (name && (name->empty() || *name == "." || *name == ".." || name->size() > kLongest ||
               name->find_first_of("/\\") != std::string::npos))
    fail_key(key, "expected a name usable as a folder (1 to {} bytes, no slashes, not . or ..), found \"{}\"",
             kLongest, *name);
  return name;
}

std::optional<fs::path> SceneTable::path(std::string_view key) const {
  const auto written = text(key);
  if (!written) return std::nullopt;
  return resolved(key, *written);
}

fs::path SceneTable::resolved(std::string_view key, const std::string& written) const {
  std::string expanded;
  std::string_view rest = written;
  for (std::size_t begin = rest.find("${"); begin != std::string_view::npos; begin = rest.find("${")) {
    const std::size_t end = rest.find('}', begin);
    if (end == std::string_view::npos) fail_key(key, "expected }} after ${{ in \"{}\"", written);
    const std::string_view inside = rest.substr(begin + 2, end - begin - 2);
    const std::size_t split = inside.find(":-");
    const std::string name(inside.substr(0, split));
    if (!is_variable_name(name))
      fail_key(key, "expected ${{NAME}} or ${{NAME:-default}}, found ${{{}}}", inside);
    expanded += rest.substr(0, begin);
    const char* value = std::getenv(name.c_str());
    if (split != std::string_view::npos && (!value || !*value))
      expanded += inside.substr(split + 2);
    else if (value)
      expanded += value;
    else
      fail_key(key, "the environment variable {} is not set; set it or write ${{{}:-default}}", name, name);
    rest.remove_prefix(end + 1);
  }
  expanded += rest;
  if (expanded.empty()) fail_key(key, "expected a path that is not empty, found \"{}\"", written);
  return (file_.parent_path() / expanded).lexically_normal();
}

fs::path SceneTable::required_path(std::string_view key) const {
  auto value = path(key);
  if (!value) fail_table("expected the key {}, found none", key);
  return *value;
}

std::vector<fs::path> SceneTable::paths(std::string_view key) const {
  const auto* array = table_->get(key) ? table_->get(key)->as_array() : nullptr;
  if (!array) return {required_path(key)};
  std::vector<fs::path> result;
  for (const toml::node& element : *array) {
    if (!element.is_string() || has_control_characters(element.as_string()->get()))
      fail_key(key, "expected a path or an array of paths, found {} in it", describe(element));
    result.push_back(resolved(key, element.as_string()->get()));
  }
  if (result.empty()) fail_key(key, "expected at least one path, found an empty array");
  return result;
}

int SceneTable::whole(std::string_view key, const toml::node& node) const {
  const auto* integer = node.as_integer();
  if (!integer || integer->get() < 0 || integer->get() > std::numeric_limits<int>::max())
    fail_key(key, "expected a whole number from 0, found {}", describe(node));
  return static_cast<int>(integer->get());
}

std::optional<int> SceneTable::index(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return node ? std::optional<int>(whole(key, *node)) : std::nullopt;
}

std::optional<double> SceneTable::number(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (!node) return std::nullopt;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value)) fail_key(key, "expected a finite number, found {}", describe(*node));
  return value;
}

bool SceneTable::flag(std::string_view key, bool fallback) const {
  const toml::node* node = table_->get(key);
  if (!node) return fallback;
  if (!node->is_boolean()) fail_key(key, "expected true or false, found {}", describe(*node));
  return node->as_boolean()->get();
}

std::vector<double> SceneTable::numbers(std::string_view key, std::size_t count) const {
  return numbers(key, *table_->get(key), count);
}

std::vector<std::vector<double>> SceneTable::points(std::string_view key, std::size_t dimension,
                                                    std::size_t least) const {
  const toml::node& node = *table_->get(key);
  const auto* array = node.as_array();
  if (!array || array->size() < least)
    fail_key(key, "expected an array of at least {} points of {} numbers, found {}", least, dimension,
             describe(node));
  std::vector<std::vector<double>> result;
  for (const toml::node& element : *array) result.push_back(numbers(key, element, dimension));
  return result;
}

std::vector<double> SceneTable::numbers(std::string_view key, const toml::node& node,
                                        std::size_t count) const {
  const auto* array = node.as_array();
  if (!array || array->size() != count)
    fail_key(key, "expected an array of {} numbers, found {}", count, describe(node));
  std::vector<double> result;
  for (const toml::node& element : *array) {
    const auto value = element.is_number() ? element.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value))
      fail_key(key, "expected {} finite numbers, found {} in place {}", count, describe(element),
               result.size() + 1);
    result.push_back(*value);
  }
  return result;
}

std::optional<Vec3> SceneTable::point(std::string_view key) const {
  if (!has(key)) return std::nullopt;
  const auto values = numbers(key, 3);
  return Vec3(values[0], values[1], values[2]);
}

std::optional<std::array<int, 2>> SceneTable::index_pair(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (!node) return std::nullopt;
  const auto* array = node->as_array();
  if (!array || array->size() != 2)
    fail_key(key, "expected an array of 2 whole numbers, found {}", describe(*node));
  return std::array{whole(key, *array->get(0)), whole(key, *array->get(1))};
}

std::optional<std::array<double, 16>> SceneTable::pose(std::string_view key) const {
  if (!has(key)) return std::nullopt;
  const auto values = numbers(key, 16);
  std::array<double, 16> matrix{};
  std::copy(values.begin(), values.end(), matrix.begin());
  with_context(fmt::format("{}:{}: {}{}", file_.string(), line_of(key), before(), key),
               [&] { pose_from_row_major(matrix); });
  return matrix;
}

OptionValue SceneTable::scalar(std::string_view key) const {
  return scalar(key, *table_->get(key));
}

bool SceneTable::holds_tables(std::string_view key) const {
  const toml::node& node = *table_->get(key);
  return node.is_table() || node.is_array_of_tables();
}

OptionValue SceneTable::option(std::string_view key) const {
  const toml::node& node = *table_->get(key);
  const auto* array = node.as_array();
  if (!array || array->empty() || !array->is_homogeneous<std::string>()) return scalar(key, node);
  std::string joined;
  for (const toml::node& element : *array)
    joined += (joined.empty() ? "" : ", ") + element.as_string()->get();
  return joined;
}

std::vector<OptionValue> SceneTable::scalars(std::string_view key) const {
  const toml::node& node = *table_->get(key);
  const auto* array = node.as_array();
  if (!array) fail_key(key, "expected an array, found {}", describe(node));
  std::vector<OptionValue> result;
  for (const toml::node& element : *array) result.push_back(scalar(key, element));
  return result;
}

OptionValue SceneTable::scalar(std::string_view key, const toml::node& node) const {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* flag = node.as_boolean()) return flag->get();
  fail_key(key, "expected a number, a string, true or false, found {}", describe(node));
}

std::optional<SceneTable> SceneTable::table(std::string_view key, const Names& known) const {
  const toml::node* node = table_->get(key);
  if (!node) return std::nullopt;
  if (!node->is_table()) fail_key(key, "expected one table [{}], found {}", key, describe(*node));
  return SceneTable(file_, fmt::format("[{}]", key), *node->as_table(), known);
}

std::vector<SceneTable> SceneTable::tables(std::string_view key, const Names& known) const {
  const toml::node* node = table_->get(key);
  std::vector<SceneTable> result;
  if (!node) return result;
  const auto* array = node->as_array();
  const bool nested = place_.starts_with("[[");
  // "[edit]" and "holes" make "[[edit.holes]]".
  const std::string full = place_.empty() || nested
                               ? std::string(key)
                               : fmt::format("{}.{}", place_.substr(1, place_.size() - 2), key);
  if (!array) fail_key(key, "expected tables [[{}]], found {}", full, describe(*node));
  for (const toml::node& element : *array) {
    if (!element.is_table()) fail_key(key, "expected an array of tables, found {} in it", describe(element));
    const std::string place = nested ? fmt::format("{}: {} {}", place_, key, result.size() + 1)
                                     : fmt::format("[[{}]] {}", full, result.size() + 1);
    result.emplace_back(file_, place, *element.as_table(), known);
  }
  return result;
}

}  // namespace hybrid::io
