#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace hybrid::e2e {

// What headless Chromium makes of a page opened from the disk.
struct BrowserPage {
  std::string dom;      // after its scripts have run
  std::string console;  // warnings and errors: of scripts, of missing files, of what its policy forbids
};

// Nothing when no Chromium is installed.
std::optional<BrowserPage> open_in_browser(const std::filesystem::path& page);

}  // namespace hybrid::e2e
