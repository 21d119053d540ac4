#include "device/cl_error.hpp"

#include "core/error.hpp"

namespace hybrid::device {
namespace {

const char* explain(cl_int code) {
  switch (code) {
    case -1:
      return "CL_DEVICE_NOT_FOUND: no such device, or PoCL cannot use its cache folder (POCL_CACHE_DIR)";
    case -4:
    case -5:
    case -6:
      return "the device or host is out of memory: use smaller --tile or another --device";
    case -11:
      return "CL_BUILD_PROGRAM_FAILURE";
    case -43:
      return "CL_INVALID_BUILD_OPTIONS";
    case -48:
      return "CL_INVALID_KERNEL";
    case -51:
      return "CL_INVALID_ARG_SIZE: host and kernel disagree on an argument's type";
    case -52:
      return "CL_INVALID_KERNEL_ARGS: an argument was not set";
    case -54:
      return "CL_INVALID_WORK_GROUP_SIZE";
    case -59:
      return "CL_INVALID_OPERATION, or an image too wide for this device";
    case -61:
      return "CL_INVALID_BUFFER_SIZE: an allocation of 0 bytes or above the device's maximum; use smaller "
             "--tile";
    case -1001:
      return "no OpenCL platform: install one (Debian: pocl-opencl-icd) or set OCL_ICD_VENDORS";
    default:
      return "see CL/cl.h";
  }
}

}  // namespace

void check(cl_int code, const std::string& doing) {
  if (code != CL_SUCCESS) fail(ErrorKind::device, "OpenCL: {}: error {} ({})", doing, code, explain(code));
}

}  // namespace hybrid::device
