// Makes every OpenCL device a GPU: preloaded into a program (LD_PRELOAD), so that machines without one try
// the way that programs take with it: kernels in OpenCL C alone with one ray or sample per work-item, copies
// by the driver. What a real GPU's compiler and memory do to them only a GPU tells.
#include <dlfcn.h>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

extern "C" cl_int clGetDeviceInfo(cl_device_id device, cl_device_info what, std::size_t size, void* value,
                                  std::size_t* needed) {
  static const auto real = reinterpret_cast<decltype(&clGetDeviceInfo)>(dlsym(RTLD_NEXT, "clGetDeviceInfo"));
  const cl_int code = real(device, what, size, value, needed);
  if (code == CL_SUCCESS && what == CL_DEVICE_TYPE && value)
    *static_cast<cl_device_type*>(value) = CL_DEVICE_TYPE_GPU;
  return code;
}
