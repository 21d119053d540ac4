#include "core/option_table.hpp"

#include <fmt/ranges.h>

namespace hybrid::detail {
namespace {

std::string describe(const OptionValue& value) {
  if (auto flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (auto integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
  if (auto number = std::get_if<double>(&value)) return fmt::format("{:#}", *number);  // 16.0 is not 16
  return fmt::format("\"{}\"", std::get<std::string>(value));
}

}  // namespace

double checked_number(std::string_view name, std::string_view unit, double minimum, double maximum,
                      const OptionValue& value, bool integer) {
  double number = NAN;
  if (auto whole = std::get_if<std::int64_t>(&value))
    number = static_cast<double>(*whole);
  else if (auto real = std::get_if<double>(&value); real && !integer)
    number = *real;
  if (!(number >= minimum && number <= maximum))
    fail_input("{}: expected {} from {} to {}{}{}, found {}", name, integer ? "a whole number" : "a number",
               minimum, maximum, unit.empty() ? "" : " ", unit, describe(value));
  return number;
}

bool checked_flag(std::string_view name, const OptionValue& value) {
  if (auto flag = std::get_if<bool>(&value)) return *flag;
  fail_input("{}: expected true or false, found {}", name, describe(value));
}

std::string checked_text(std::string_view name, const std::vector<std::string_view>& choices,
                         const OptionValue& value) {
  auto text = std::get_if<std::string>(&value);
  if (!text) fail_input("{}: expected a string, found {}", name, describe(value));
  if (choices.empty()) return *text;
  for (auto choice : choices)
    if (*text == choice) return *text;
  fail_input("{}: expected one of {}, found \"{}\"", name, fmt::join(choices, ", "), *text);
}

}  // namespace hybrid::detail
