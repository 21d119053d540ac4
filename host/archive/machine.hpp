#pragma once
#include <cstdint>

namespace hybrid::archive {

// Bytes that this process and its children may use: what is free, and no more than its control group has.
std::uint64_t free_memory_bytes();

// Cores that this process may run on.
int usable_cores();

}  // namespace hybrid::archive
