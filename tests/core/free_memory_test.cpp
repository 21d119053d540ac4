#include "core/free_memory.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <vector>

namespace hybrid {
namespace {

// Freed in small pieces below one that stays: malloc keeps it, and it was touched.
TEST(FreeMemory, what_malloc_holds_free_between_what_is_in_use_goes_back) {
  constexpr std::size_t kPieces = 1500, kPiece_bytes = 100'000;
  std::vector<std::unique_ptr<std::vector<char>>> pieces;
  for (std::size_t k = 0; k < kPieces; ++k)
    pieces.push_back(std::make_unique<std::vector<char>>(kPiece_bytes, 'x'));
  const auto resident = [] {
    std::size_t total = 0, pages = 0;
    std::FILE* file = std::fopen("/proc/self/statm", "r");
    if (file == nullptr || std::fscanf(file, "%zu %zu", &total, &pages) != 2) pages = 0;
    if (file != nullptr) std::fclose(file);
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  };
  const auto last = std::move(pieces.back());
  pieces.clear();
  const std::size_t before = resident();
  ASSERT_GT(before, kPieces * kPiece_bytes);
  give_back_free_memory();
  EXPECT_LT(resident(), before - kPieces * kPiece_bytes / 2);
  EXPECT_EQ(last->at(kPiece_bytes - 1), 'x');
}

}  // namespace
}  // namespace hybrid
