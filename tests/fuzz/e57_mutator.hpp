#pragma once
#include <cstddef>
#include <functional>
#include <string>

namespace hybrid::testing {

// Changes up to `most` bytes in place of `size`, as LLVMFuzzerMutate does; returns the new size.
using Mutate = std::function<std::size_t(char* bytes, std::size_t size, std::size_t most)>;

// A mutation of an E57 file that gets past its first lines of defence: one part (description, sections or
// header) is changed, then the header's lengths and all checksums are made to fit again, mostly. Bytes that
// are no E57 file are changed as they are.
std::string mutated_e57(const std::string& file, std::size_t most, unsigned seed, const Mutate& mutate);

}  // namespace hybrid::testing
