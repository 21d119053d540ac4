#include "core/memory_budget.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <optional>
#include <thread>
#include <vector>

#include "../e2e/program.hpp"
#include "core/memory_pause.hpp"
#include "core/paged_arrays.hpp"
#include "core/parallel.hpp"

namespace hybrid {
namespace {

constexpr std::size_t kCount = 8u << 20;  // of an array: 64 MiB
constexpr std::uint64_t kMiB = 1 << 20;

std::uint64_t value_at(std::size_t array, std::size_t i) {
  return array * 0x9e3779b97f4a7c15u + i;
}

// Waits, as another thread does the work, and says whether the process came below so many bytes.
bool comes_below(std::uint64_t bytes) {
  for (int i = 0; i < 2000; ++i) {
    if (resident_memory().bytes < bytes) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

TEST(MemoryBudget, arrays_leave_memory_and_keep_their_contents) {
  const e2e::Scratch folder;
  const std::uint64_t before = resident_memory().bytes;
  const std::uint64_t budget_bytes = before + 128 * kMiB;
  const MemoryBudget budget(budget_bytes, folder.path());
  std::vector<std::vector<std::uint64_t>> arrays(6);
  parallel_for(arrays.size(), [&](std::size_t a) {
    arrays[a].resize(kCount);
    for (std::size_t i = 0; i < kCount; ++i) arrays[a][i] = value_at(a, i);
  });
  for (const auto& array : arrays) EXPECT_TRUE(paged_arrays::is_ours(array.data()));
  EXPECT_TRUE(comes_below(budget_bytes)) << resident_memory().bytes << " of " << budget_bytes;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));  // a kill leaves nothing behind
  std::size_t wrong = 0;
  for (std::size_t a = 0; a < arrays.size(); ++a)
    for (std::size_t i = 0; i < kCount; ++i) wrong += arrays[a][i] != value_at(a, i);
  EXPECT_EQ(wrong, 0u);
  EXPECT_TRUE(comes_below(budget_bytes)) << "after reading all of it";
  arrays[2].resize(2 * kCount);  // moves it, and gives its file back
  EXPECT_EQ(arrays[2][kCount - 1], value_at(2, kCount - 1));
  EXPECT_EQ(arrays[2].back(), 0u);
}

TEST(MemoryBudget, only_large_arrays_made_under_it_are_in_files) {
  const e2e::Scratch folder;
  std::optional<std::vector<char>> outlives;
  const std::vector<char> earlier(2 * paged_arrays::kLeast_bytes);
  {
    const MemoryBudget budget(1024 * kMiB, folder.path());
    const std::vector<char> small(paged_arrays::kLeast_bytes - 1);
    EXPECT_FALSE(paged_arrays::is_ours(small.data()));
    EXPECT_FALSE(paged_arrays::is_ours(earlier.data()));
    outlives.emplace(paged_arrays::kLeast_bytes, 'x');
    EXPECT_TRUE(paged_arrays::is_ours(outlives->data()));
  }
  EXPECT_EQ(outlives->back(), 'x');
  outlives.reset();
  const std::vector<char> later(2 * paged_arrays::kLeast_bytes);
  EXPECT_FALSE(paged_arrays::is_ours(later.data()));
  EXPECT_EQ(paged_arrays::trim(kMiB), 0u);  // nothing is left
}

TEST(MemoryBudget, only_touched_pages_are_in_memory) {
  const e2e::Scratch folder;
  const MemoryBudget budget(1024 * kMiB, folder.path());
  std::vector<std::uint64_t> array(kCount);
  ASSERT_TRUE(paged_arrays::is_ours(array.data()));
  paged_arrays::trim(kCount * sizeof array[0]);
  const std::uint64_t before = resident_memory().file_bytes;
  std::size_t touched = 0;
  for (std::size_t i = 0; i < kCount; i += (64 << 10) / sizeof array[0], ++touched) array[i] += i;
  const std::uint64_t more = resident_memory().file_bytes - before;
  EXPECT_LT(more, 2 * touched * 4096) << touched << " pages";
}

TEST(MemoryBudget, threads_wait_between_bodies_while_memory_is_short) {
  memory_is_short = true;
  std::atomic<int> done = 0;
  std::thread work([&] { parallel_for(100, [&](std::size_t) { ++done; }); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(done, 0);
  memory_is_short = false;
  memory_is_short.notify_all();
  work.join();
  EXPECT_EQ(done, 100);
}

// What holds the memory is no array: to wait would be of no use.
TEST(MemoryBudget, nobody_waits_for_memory_that_no_array_holds) {
  const e2e::Scratch folder;
  std::vector<std::uint64_t> arrays(kCount, 1), more(kCount, 2);
  ASSERT_FALSE(paged_arrays::is_ours(more.data()));
  const MemoryBudget budget(64 * kMiB, folder.path());
  std::vector<std::uint64_t> array(kCount);
  ASSERT_TRUE(paged_arrays::is_ours(array.data()));
  const auto begin = std::chrono::steady_clock::now();
  parallel_for(1000, [&](std::size_t k) {
    array[k * 4096] = arrays[k] + more[k];
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  });
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_EQ(array[999 * 4096], 3u);
}

TEST(MemoryBudget, an_array_without_room_for_a_file_stays_in_memory) {
  const e2e::Scratch folder;
  const MemoryBudget budget(1024 * kMiB, folder.path());
  std::filesystem::remove_all(folder.path());
  std::vector<int> values(paged_arrays::kLeast_bytes);
  std::iota(values.begin(), values.end(), 0);
  EXPECT_FALSE(paged_arrays::is_ours(values.data()));
  EXPECT_EQ(values.back(), static_cast<int>(values.size()) - 1);
  EXPECT_EQ(paged_arrays::refused(), 1u);
}

}  // namespace
}  // namespace hybrid
