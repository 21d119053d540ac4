#pragma once
#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace score {

// A file or folder that is not what it should be: names it, what was expected, what was found, the remedy.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <typename... Args>
[[noreturn]] void bad_input(fmt::format_string<Args...> format, Args&&... args) {
  throw InputError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace score
