// Included first by every header that both compilers read. Structs that cross the border use only float, int
// and uint members and fixed arrays of them, padded by hand to a multiple of 16 bytes; LAYOUT_CHECK holds
// both sides to it.
#ifndef HYBRID_SHARED_LAYOUT_H
#define HYBRID_SHARED_LAYOUT_H

#ifdef __OPENCL_C_VERSION__
#pragma OPENCL FP_CONTRACT OFF
#define HYBRID_UINT uint
#else
#include <cstdint>
#define HYBRID_UINT std::uint32_t
#endif

#define LAYOUT_CHECK(type, bytes) typedef char layout_check_##type[(sizeof(type) == (bytes)) ? 1 : -1]

#endif
