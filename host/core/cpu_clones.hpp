#pragma once

// Before a function: it is compiled for several generations of x86-64 processors, and the program takes the
// one made for the processor it runs on. Without contraction (-ffp-contract=off, everywhere) and with sums in
// an order of the source's all give the same bits. Sanitizers have no say in functions chosen before they are
// set up.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define HYBRID_CPU_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define HYBRID_CPU_CLONES
#endif

// Before what such a function calls: it becomes part of each of the clones.
#define HYBRID_INLINE [[gnu::always_inline]] inline
