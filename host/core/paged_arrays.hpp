#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace hybrid::paged_arrays {

// Arrays in pages of files, behind `operator new` (new_arrays.cpp): the part of a MemoryBudget that hands
// them out and takes their pages back. All functions may be called by any thread at any time.

// Smaller ones are not worth a file each.
inline constexpr std::size_t kLeast_bytes = std::size_t{4} << 20;

// From now on make() makes arrays in files in this folder; "" ends that. False where the system has no
// addresses left for them.
bool use_folder(const std::filesystem::path& folder);

// An array of at least so many bytes, zeros; nullptr where none is to be made here, or the folder has no
// room.
void* make(std::size_t bytes) noexcept;
// Whether make() made this one. Costs a comparison.
bool is_ours(const void* memory) noexcept;
void release(void* memory) noexcept;

// Takes about so many bytes of address space out of memory, going round over all arrays from where the last
// call ended; contents stay, in the files. Returns how many bytes it went over, 0 when there is no array.
std::uint64_t trim(std::uint64_t bytes);

// Of all arrays, in memory or not.
std::uint64_t total_bytes();

// Arrays since the last use_folder that found no room.
std::uint64_t refused();

}  // namespace hybrid::paged_arrays
