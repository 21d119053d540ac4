#pragma once
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/error.hpp"

namespace hybrid {

// One user-settable value of the options struct T. The table of a struct feeds the scene file's reader
// (names, types, ranges), `--help` and the documentation, so that each fact about an option stands in one
// place.
template <typename T>
struct OptionRow {
  using Member = std::variant<double T::*, int T::*, bool T::*, std::string T::*>;

  OptionRow(std::string_view name_, std::string_view unit_, Member member_, double minimum_, double maximum_,
            std::string_view help_, std::vector<std::string_view> choices_ = {})
      : name(name_),
        unit(unit_),
        member(member_),
        minimum(minimum_),
        maximum(maximum_),
        help(help_),
        choices(std::move(choices_)) {}

  std::string_view name;  // key in the scene file
  std::string_view unit;  // "m", "rad", "deg", "samples", "" ...
  Member member;
  double minimum, maximum;  // numbers only, inclusive
  std::string_view help;
  std::vector<std::string_view> choices;  // strings only: the values allowed; empty = any
};

using OptionValue = std::variant<bool, std::int64_t, double, std::string>;

// Sets options.*row.member from `value`; throws ErrorKind::input naming the key, what was expected and what
// was found.
template <typename T>
void set_option(T& options, const OptionRow<T>& row, const OptionValue& value);

template <typename T>
const OptionRow<T>* find_option(const std::vector<OptionRow<T>>& table, std::string_view name) {
  for (const auto& row : table)
    if (row.name == name) return &row;
  return nullptr;
}

// In the order of the table: for the error that rejects an unknown key.
template <typename T>
std::vector<std::string_view> option_names(const std::vector<OptionRow<T>>& table) {
  std::vector<std::string_view> names;
  for (const auto& row : table) names.push_back(row.name);
  return names;
}

namespace detail {
double checked_number(std::string_view name, std::string_view unit, double minimum, double maximum,
                      const OptionValue& value, bool integer);
bool checked_flag(std::string_view name, const OptionValue& value);
std::string checked_text(std::string_view name, const std::vector<std::string_view>& choices,
                         const OptionValue& value);
}  // namespace detail

template <typename T>
void set_option(T& options, const OptionRow<T>& row, const OptionValue& value) {
  if (auto number = std::get_if<double T::*>(&row.member))
    options.** number = detail::checked_number(row.name, row.unit, row.minimum, row.maximum, value, false);
  else if (auto integer = std::get_if<int T::*>(&row.member))
    options.** integer =
        static_cast<int>(detail::checked_number(row.name, row.unit, row.minimum, row.maximum, value, true));
  else if (auto flag = std::get_if<bool T::*>(&row.member))
    options.** flag = detail::checked_flag(row.name, value);
  else
    options.*std::get<std::string T::*>(row.member) = detail::checked_text(row.name, row.choices, value);
}

// The value as it would be written in a scene file: for summary.json and `--help`.
template <typename T>
OptionValue get_option(const T& options, const OptionRow<T>& row) {
  if (auto number = std::get_if<double T::*>(&row.member)) return options.**number;
  if (auto integer = std::get_if<int T::*>(&row.member)) return static_cast<std::int64_t>(options.**integer);
  if (auto flag = std::get_if<bool T::*>(&row.member)) return options.**flag;
  return options.*std::get<std::string T::*>(row.member);
}

}  // namespace hybrid
