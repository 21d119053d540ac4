#pragma once
#include <fmt/format.h>

#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace hybrid {

// What went wrong decides what the caller can do about it; each kind has its exit code (exit_code()).
enum class ErrorKind { failed, usage, input, device, temporary, interrupted };

// An error with a chain of context, outermost first: "scene church: scan west.ply: header: expected ...".
// The innermost message names what was expected, what was found and what to do.
class Error : public std::exception {
 public:
  Error(ErrorKind kind, std::string message) : kind_(kind), chain_{std::move(message)} { compose(); }

  ErrorKind kind() const { return kind_; }
  const char* what() const noexcept override { return text_.c_str(); }
  void add_context(std::string context);

 private:
  void compose();

  ErrorKind kind_;
  std::vector<std::string> chain_;  // outermost first
  std::string text_;
};

// No other unit of the same run can succeed after such an error: device, temporary (a full disk),
// interrupted.
bool ends_the_run(ErrorKind kind);

// Process exit code of SCENE.md: 1 failed, 2 usage, 4 input, 5 device, 75 temporary, 130 interrupted.
int exit_code(ErrorKind kind);

template <typename... Args>
[[noreturn]] void fail(ErrorKind kind, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(kind, fmt::format(format, std::forward<Args>(args)...));
}

template <typename... Args>
[[noreturn]] void fail_input(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ErrorKind::input, fmt::format(format, std::forward<Args>(args)...));
}

inline constexpr const char* kOutOfMemory =
    "out of memory; use fewer or smaller scans at a time, or a smaller --tile";

// Runs `body`; an Error that leaves it gets `context` in front. Running out of memory becomes
// ErrorKind::device, other exceptions ErrorKind::failed.
template <typename Body>
auto with_context(const std::string& context, Body&& body) -> std::invoke_result_t<Body> {
  try {
    return body();
  } catch (Error& error) {
    error.add_context(context);
    throw;
  } catch (const std::bad_alloc&) {
    Error error(ErrorKind::device, kOutOfMemory);
    error.add_context(context);
    throw error;
  } catch (const std::exception& other) {
    Error error(ErrorKind::failed, other.what());
    error.add_context(context);
    throw error;
  }
}

}  // namespace hybrid
