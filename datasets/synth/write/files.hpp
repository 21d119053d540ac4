#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace synth {

// Creates the folder and its parents; throws an error that names it when that, or writing into it, fails.
void make_folder(const std::filesystem::path&);

// Calls `write` with a temporary name in the same folder (same extension, which image libraries look at),
// then renames: a reader never sees half a file.
void write_by_rename(const std::filesystem::path&,
                     const std::function<void(const std::filesystem::path&)>& write);

void write_bytes(const std::filesystem::path&, const std::string& bytes);

}  // namespace synth
