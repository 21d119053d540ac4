#pragma once
#include <fmt/format.h>

#include <string>
#include <utility>

namespace hybrid::log {

enum class Level { debug, info, warning, error, off };

// All log lines go to stderr; stdout is for results. `level` is one of debug, info, warning, error, off.
void set_level(const std::string& level);
// Colours and rewritten lines on a terminal: not with NO_COLOR set or TERM unset or dumb.
bool escapes_allowed();
void write(Level level, const std::string& line);

template <typename... Args>
void debug(fmt::format_string<Args...> format, Args&&... args) {
  write(Level::debug, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void info(fmt::format_string<Args...> format, Args&&... args) {
  write(Level::info, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void warning(fmt::format_string<Args...> format, Args&&... args) {
  write(Level::warning, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void error(fmt::format_string<Args...> format, Args&&... args) {
  write(Level::error, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace hybrid::log
