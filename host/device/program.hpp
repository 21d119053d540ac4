#pragma once
#include <string>

#include "device/queue.hpp"

namespace hybrid::device {

// Compiles kernels/<name>.cl (embedded, or from HYBRID_KERNEL_DIR when that is set) with -cl-std=CL1.2, IEEE
// division and square roots, no relaxed math, and `defines`; on devices other than CPUs also PORTABLE, which
// leaves the compiler's own built-ins out. Throws ErrorKind::device with the compiler's log.
cl_kernel build_kernel(cl_context context, const DeviceInfo& device, const std::string& name,
                       const Defines& defines);

}  // namespace hybrid::device
