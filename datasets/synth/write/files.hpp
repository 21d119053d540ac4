#pragma once
#include <filesystem>
#include <string>

namespace synth {

// Creates the folder and its parents; throws an error that names it when that, or writing into it, fails.
void make_folder(const std::filesystem::path&);

// Writes a temporary file in the same folder, then renames: a reader never sees half a file. Throws
// std::system_error with errno's reason.
void write_bytes(const std::filesystem::path&, const std::string& bytes);

}  // namespace synth
