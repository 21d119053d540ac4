// libFuzzer over the targets of targets.hpp:
//   HYBRID_FUZZ_TARGET=ptx hybrid_fuzz -runs=100000 corpus [more corpora]
//   HYBRID_FUZZ_TARGET=ptx hybrid_fuzz --seeds FOLDER   writes the target's seeds
//   hybrid_fuzz --list                                   names the targets, with the size of their inputs
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>

#include "core/parallel.hpp"
#include "fuzz/e57_mutator.hpp"
#include "fuzz/targets.hpp"
#include "io/reader_rows.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t most);

namespace {
namespace fs = std::filesystem;
using namespace hybrid::testing;

FuzzTarget chosen_target() {
  const char* name = std::getenv("HYBRID_FUZZ_TARGET");
  for (const FuzzTarget& target : fuzz_targets())
    if (name != nullptr && target.name == name) return target;
  std::cerr << "expected HYBRID_FUZZ_TARGET to be one of those of --list, found "
            << (name != nullptr ? name : "nothing") << '\n';
  std::exit(2);
}

struct Session {
  FuzzTarget target = chosen_target();
  fs::path folder = fs::temp_directory_path() / fmt::format("hybrid fuzz {} {}", target.name, getpid());
  FuzzRun run{target, folder};

  ~Session() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

Session& session() {
  static Session instance;
  return instance;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  const std::string command = *count > 1 ? (*arguments)[1] : "";
  if (command == "--list") {
    for (const FuzzTarget& target : fuzz_targets())
      std::cout << target.name << ' ' << target.most_bytes << '\n';
    std::exit(0);
  }
  hybrid::set_thread_count(1);
  if (command == "--seeds" && *count > 2) {
    std::size_t number = 0;
    for (const std::string& seed : session().target.seeds(session().folder))
      write_file_beside(fs::path((*arguments)[2]) / fmt::format("seed-{:02}", number++), seed);
    std::exit(0);
  }
  session();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  session().run({reinterpret_cast<const char*>(bytes), size});
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size, std::size_t most,
                                               unsigned seed) {
  if (!session().target.pages) return LLVMFuzzerMutate(bytes, size, most);
  const auto mutate = [](char* part, std::size_t part_size, std::size_t part_most) {
    return LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(part), part_size, part_most);
  };
  const std::string result = mutated_e57({reinterpret_cast<const char*>(bytes), size}, most, seed, mutate);
  std::copy(result.begin(), result.end(), reinterpret_cast<char*>(bytes));
  return result.size();
}
