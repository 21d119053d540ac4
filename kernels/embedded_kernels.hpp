#pragma once
#include <span>

namespace hybrid::kernels {

// One OpenCL program: the file's stem and its source with all includes flattened.
struct EmbeddedKernel {
  const char* name;
  const char* source;
};

std::span<const EmbeddedKernel> embedded_kernels();

}  // namespace hybrid::kernels
