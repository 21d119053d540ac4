#include "core/fail_point.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <string>

namespace hybrid {
namespace {

struct Wanted {
  std::string point;
  int number = 0;
  bool group = false, pause = false;
};

Wanted read_wanted() {
  const char* const text = std::getenv("HYBRID_FAIL_AT");
  if (!text) return {};
  const std::string whole = text;
  const auto colon = whole.find(':');
  if (colon == std::string::npos) return {};
  return {whole.substr(0, colon), std::atoi(whole.c_str() + colon + 1), whole.ends_with(":group"),
          whole.ends_with(":pause")};
}

}  // namespace

void fail_point(const char* point) {
  static const Wanted wanted = read_wanted();
  if (wanted.number == 0 || wanted.point != point) return;
  static std::atomic<int> count{0};
  if (++count != wanted.number) return;
  if (wanted.pause)
    usleep(500'000);
  else
    kill(wanted.group ? 0 : getpid(), SIGKILL);
}

}  // namespace hybrid
