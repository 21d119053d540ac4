#include "core/error.hpp"

namespace hybrid {

void Error::add_context(std::string context) {
  chain_.insert(chain_.begin(), std::move(context));
  compose();
}

void Error::compose() {
  text_ = fmt::format("{}", fmt::join(chain_, ": "));
}

bool ends_the_run(ErrorKind kind) {
  return kind == ErrorKind::device || kind == ErrorKind::temporary || kind == ErrorKind::interrupted;
}

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::failed:
      return 1;
    case ErrorKind::usage:
      return 2;
    case ErrorKind::input:
      return 4;
    case ErrorKind::device:
      return 5;
    case ErrorKind::temporary:
      return 75;
    case ErrorKind::interrupted:
      return 130;
  }
  return 1;
}

}  // namespace hybrid
