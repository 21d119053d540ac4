// Replays what fuzzing has found worth keeping (corpus/, made by run.sh minimise; finding-* are the inputs of
// faults that were mended) and every seed: each is read or refused, in memory that its size justifies.
#include <gtest/gtest.h>

#include "fuzz/e57_mutator.hpp"
#include "fuzz/targets.hpp"
#include "io/allocation_watch.hpp"
#include "io/e57/e57.hpp"
#include "io/files.hpp"
#include "places.hpp"

namespace hybrid::testing {

static void PrintTo(const FuzzTarget& target, std::ostream* out) {
  *out << target.name;
}

namespace {
namespace fs = std::filesystem;

// One request for memory: windows, blocks and tiles of a fixed size, and a multiple of the input.
constexpr std::size_t kFixed_bytes = 4 << 20, kTiles_bytes = 16 << 20, kPerByte = 100;

std::vector<FuzzTarget> replayed() {
  std::vector<FuzzTarget> targets = e57_fuzz_targets();
  for (FuzzTarget& target : scan_fuzz_targets()) targets.push_back(std::move(target));
  return targets;
}

class FuzzCorpus : public ::testing::TestWithParam<FuzzTarget> {};

TEST_P(FuzzCorpus, EachIsReadOrRefusedInLittleMemory) {
  const FuzzTarget& target = GetParam();
  const TemporaryFolder folder;
  std::vector<std::pair<std::string, std::string>> inputs;
  for (const std::string& seed : target.seeds(folder.path())) inputs.emplace_back("a seed", seed);
  const std::size_t seeds = inputs.size();
  const fs::path corpus = fs::path(HYBRID_PROJECT_DIR) / "tests/fuzz/corpus" / target.name;
  for (const auto& entry : fs::directory_iterator(corpus))
    inputs.emplace_back(entry.path().filename().string(), bytes_of(entry.path()));
  EXPECT_GT(inputs.size(), seeds);
  const FuzzRun run(target, folder.path());
  for (const auto& [name, bytes] : inputs) {
    SCOPED_TRACE(name);
    const AllocationWatch watch;
    EXPECT_NO_THROW(run(bytes));
    const bool tiles = target.file.extension() == ".exr";
    EXPECT_LE(watch.largest_bytes(), (tiles ? kTiles_bytes : kFixed_bytes) + kPerByte * bytes.size());
  }
}

INSTANTIATE_TEST_SUITE_P(targets, FuzzCorpus, ::testing::ValuesIn(replayed()),
                         [](const auto& target) { return target.param.name; });

// Mutations of E57 files must get past the checksums and lengths, or they would only test these.
TEST(FuzzE57Mutator, MostMutationsReachTheTables) {
  const TemporaryFolder folder;
  const std::vector<FuzzTarget> targets = e57_fuzz_targets();
  const std::string seed = targets.at(0).seeds(folder.path()).at(1);
  unsigned state = 1;
  const auto flip = [&](char* bytes, std::size_t size, std::size_t) {
    state = state * 1664525u + 1013904223u;
    if (size > 0) bytes[state % size] ^= static_cast<char>(1u << (state >> 29));
    return size;
  };
  int reached = 0, changed = 0;
  for (unsigned i = 1; i <= 300; ++i) {
    const std::string bytes = mutated_e57(seed, 8192, i * 7919, flip);
    changed += bytes != seed;
    const auto file = folder.write("mutated.e57", bytes);
    try {
      const io::E57File opened(file);
      reached += !opened.contents().scans.empty();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    }
  }
  EXPECT_GT(reached, 120);
  EXPECT_GT(changed, 250);
}

}  // namespace
}  // namespace hybrid::testing
