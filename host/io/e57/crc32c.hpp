#pragma once
#include <cstdint>
#include <span>

namespace hybrid::io {

// CRC-32C (Castagnoli, reflected polynomial 0x82F63B78, initial value and final xor ~0), the checksum of an
// E57 page: by the processor's instruction where it has one, asked for at run time, else by tables.
std::uint32_t crc32c(std::span<const char> bytes);

// By tables on every machine.
std::uint32_t crc32c_by_tables(std::span<const char> bytes);

}  // namespace hybrid::io
