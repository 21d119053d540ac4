// libFuzzer over any row of the reader table, from its sample; more seeds may be given as a folder:
//   HYBRID_FUZZ_READER=ply_ascii hybrid_fuzz_reader -max_total_time=60 [folder]
// A reader reads or throws Error of ErrorKind::input; anything else is a finding.
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "core/error.hpp"
#include "io/file_in_memory.hpp"
#include "io/reader_rows.hpp"
#include "io/reader_table.hpp"

namespace {
namespace fs = std::filesystem;
using hybrid::testing::FileInMemory;
using hybrid::testing::ReaderRow;

struct Target {
  const ReaderRow* row = nullptr;
  fs::path folder;
  std::unique_ptr<FileInMemory> file;

  ~Target() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

Target& target() {
  static Target instance;
  return instance;
}

const ReaderRow& chosen_reader() {
  const char* name = std::getenv("HYBRID_FUZZ_READER");
  for (const ReaderRow& row : hybrid::testing::reader_table())
    if (name != nullptr && row.name == name) return row;
  std::cerr << "expected HYBRID_FUZZ_READER to be one of";
  for (const ReaderRow& row : hybrid::testing::reader_table()) std::cerr << ' ' << row.name;
  std::cerr << ", found " << (name != nullptr ? name : "nothing") << '\n';
  std::exit(2);
}

}  // namespace

// Adds the folder with the sample to the arguments, as the first corpus but one for new findings.
extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  Target& t = target();
  t.row = &chosen_reader();
  t.folder = fs::temp_directory_path() / fmt::format("hybrid fuzz {} {}", t.row->name, getpid());
  fs::create_directories(t.folder);
  const std::string good = t.row->good(t.folder);
  static std::string seeds = (t.folder / "seeds").string();
  hybrid::testing::write_file_beside(fs::path(seeds) / "sample", good);
  t.file = std::make_unique<FileInMemory>(t.folder / t.row->file);
  static std::vector<char*> all(*arguments, *arguments + *count);
  const bool one_input =
      std::any_of(all.begin() + 1, all.end(), [](const char* a) { return fs::is_regular_file(a); });
  if (!one_input) all.push_back(seeds.data());
  *count = static_cast<int>(all.size());
  all.push_back(nullptr);
  *arguments = all.data();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const Target& t = target();
  t.file->write({reinterpret_cast<const char*>(bytes), size});
  try {
    t.row->read(t.folder / t.row->file);
  } catch (const hybrid::Error& error) {
    if (error.kind() != hybrid::ErrorKind::input) throw;
  }
  return 0;
}
