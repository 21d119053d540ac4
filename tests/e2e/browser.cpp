#include "browser.hpp"

#include <sstream>

#include "program.hpp"

namespace hybrid::e2e {

std::optional<BrowserPage> open_in_browser(const std::filesystem::path& page) {
  if (run("command -v chromium").exit_code != 0) return std::nullopt;
  const Scratch profile;
  const auto outcome =
      run("timeout 120 chromium --headless --no-sandbox --disable-gpu --disable-background-networking "
          "--enable-logging=stderr --virtual-time-budget=3000 --user-data-dir=" +
          profile.path().string() + " --dump-dom 'file://" + page.string() + "'");
  BrowserPage result{outcome.out, ""};
  std::istringstream lines(outcome.err);
  for (std::string line; std::getline(lines, line);)
    if (line.find("CONSOLE") != std::string::npos) result.console += line + "\n";
  return result;
}

}  // namespace hybrid::e2e
