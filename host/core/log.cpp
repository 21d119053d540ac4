#include "core/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <string_view>

#include "core/error.hpp"

namespace hybrid::log {
namespace {

spdlog::logger& logger() {
  static const auto instance = [] {
    const auto colours = escapes_allowed() ? spdlog::color_mode::automatic : spdlog::color_mode::never;
    auto made = spdlog::stderr_color_mt("hybrid", colours);
    made->set_pattern("%^%l%$ %v");
    return made;
  }();
  return *instance;
}

spdlog::level::level_enum native(Level level) {
  switch (level) {
    case Level::debug:
      return spdlog::level::debug;
    case Level::info:
      return spdlog::level::info;
    case Level::warning:
      return spdlog::level::warn;
    case Level::error:
      return spdlog::level::err;
    case Level::off:
      return spdlog::level::off;
  }
  return spdlog::level::info;
}

}  // namespace

bool escapes_allowed() {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return !(no_colour && *no_colour) && terminal && std::string_view(terminal) != "dumb";
}

void set_level(const std::string& level) {
  if (level == "debug") return logger().set_level(native(Level::debug));
  if (level == "info") return logger().set_level(native(Level::info));
  if (level == "warning") return logger().set_level(native(Level::warning));
  if (level == "error") return logger().set_level(native(Level::error));
  if (level == "off") return logger().set_level(native(Level::off));
  fail(ErrorKind::usage, "log level '{}' is unknown; use debug, info, warning, error or off", level);
}

void write(Level level, const std::string& line) {
  logger().log(native(level), "{}", line);
}

}  // namespace hybrid::log
