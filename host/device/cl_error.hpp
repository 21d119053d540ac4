#pragma once
#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <string>

namespace hybrid::device {

// Throws ErrorKind::device with the code's name, its usual cause and the remedy when `code` is not
// CL_SUCCESS.
void check(cl_int code, const std::string& doing);

}  // namespace hybrid::device
