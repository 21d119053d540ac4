// Kernels' programs that a process keeps in PoCL's cache folder for those after it.
#include <gtest/gtest.h>

#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

fs::path only_file(const fs::path& folder) {
  const fs::directory_iterator first(folder);
  EXPECT_EQ(std::distance(first, {}), 1) << folder;
  return fs::directory_iterator(folder)->path();
}

}  // namespace

TEST(KeptPrograms, serve_without_the_drivers_files_and_are_kept_anew_when_damaged) {
  const Scratch cache;
  const auto expect_passed = [&] {
    const auto outcome = run("POCL_CACHE_DIR=" + cache.path().string() + " hybrid devices --json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(outcome.out).at(0).at("self_test"), "passed");
  };
  expect_passed();
  const fs::path kept = only_file(cache / "hybrid");
  EXPECT_EQ(kept.filename().string().rfind("self_test-", 0), 0u) << kept;
  const std::string bytes = io::read_text(kept);
  const auto written = fs::last_write_time(kept);
  for (const auto& entry : fs::directory_iterator(cache.path()))
    if (entry.path().filename() != "hybrid") fs::remove_all(entry.path());
  expect_passed();
  EXPECT_EQ(fs::last_write_time(kept), written) << "built and kept again, not loaded";
  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  io::write_text(kept, damaged);
  expect_passed();
  EXPECT_EQ(only_file(cache / "hybrid"), kept);
  EXPECT_NE(io::read_text(kept), damaged);
}

TEST(KeptPrograms, are_none_where_the_driver_keeps_nothing) {
  const Scratch cache;
  const auto outcome =
      run("POCL_KERNEL_CACHE=0 POCL_CACHE_DIR=" + cache.path().string() + " hybrid devices --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_FALSE(fs::exists(cache / "hybrid"));
}

}  // namespace hybrid::e2e
