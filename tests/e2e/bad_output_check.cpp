#include "bad_output_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bad_mini_scene.hpp"
#include "io/output.hpp"
#include "io/ply/ply.hpp"

namespace hybrid::e2e {
namespace fs = std::filesystem;

void expect_complete_files(const fs::path& out) {
  if (!fs::exists(out)) return;
  const auto known = mini_outputs();
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    if (entry.is_directory()) continue;
    const std::string name = fs::relative(entry.path(), out).string();
    EXPECT_NE(std::find(known.begin(), known.end(), name), known.end()) << name << " is no output";
    if (name == "report/timing.js") {
      EXPECT_TRUE(io::read_text(entry.path()).ends_with("});\n")) << io::read_text(entry.path());
    } else if (name == "timing.json") {
      EXPECT_TRUE(nlohmann::json::accept(io::read_text(entry.path()))) << io::read_text(entry.path());
    } else if (name == "scans/s/detail.ply") {  // written twice, the second time with colours
      EXPECT_NO_THROW(io::read_ply(entry.path()));
    } else {
      EXPECT_EQ(io::fingerprint(entry.path()).xxh3, io::fingerprint(mini_result() / name).xxh3) << name;
    }
  }
}

void expect_failure(const Outcome& outcome, int code, const std::vector<std::string>& parts) {
  EXPECT_EQ(outcome.exit_code, code) << outcome.err;
  for (const auto& part : parts)
    EXPECT_NE(outcome.err.find(part), std::string::npos)
        << "expected: " << part << "\nfound: " << outcome.err;
}

}  // namespace hybrid::e2e
