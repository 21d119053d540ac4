// The report of the tiny room in a browser: its script builds the tables and the plots, and nothing is
// complained about. Needs Chromium; skipped without.
#include <gtest/gtest.h>

#include "browser.hpp"
#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

}  // namespace

TEST(Report, opens_from_the_disk_without_a_complaint) {
  const auto page = open_in_browser(result() / "report/index.html");
  if (!page) GTEST_SKIP() << "no Chromium on this machine (package chromium)";
  EXPECT_EQ(page->console, "");
  EXPECT_NE(page->dom.find(">room-synthetic</h1>"), std::string::npos) << page->dom.substr(0, 500);
  EXPECT_EQ(count(page->dom, "href=\"#scan-"), 4u);          // two tables name two scans each
  EXPECT_NE(page->dom.find("Stages, "), std::string::npos);  // timing.js was loaded
  EXPECT_GE(count(page->dom, "<svg"), 4u);                   // two histograms, two plots of times
  EXPECT_GE(count(page->dom, "<rect"), 2 * 23u + 10);
}

TEST(Report, whatever_it_loads_lies_beside_it) {
  const auto html = io::read_text(result() / "report/index.html");
  std::size_t files = 0;
  for (std::size_t at = html.find("src=\""); at != std::string::npos; at = html.find("src=\"", at + 1)) {
    const std::string name = html.substr(at + 5, html.find('"', at + 5) - at - 5);
    EXPECT_TRUE(std::filesystem::exists(result() / "report" / name)) << name;
    ++files;
  }
  EXPECT_GT(files, 15u);  // pictures of scans, views and registration; timing.js
}

TEST(Report, a_request_to_the_outside_is_refused_and_complained_about) {
  const Scratch copy;
  auto html = io::read_text(result() / "report/index.html");
  html.insert(html.find("<main>"), "<img src=\"http://127.0.0.1:9/outside.png\">");
  io::write_text(copy / "index.html", html);
  const auto page = open_in_browser(copy / "index.html");
  if (!page) GTEST_SKIP() << "no Chromium on this machine (package chromium)";
  EXPECT_NE(page->console.find("Content Security Policy"), std::string::npos) << page->console;
}

}  // namespace hybrid::e2e
