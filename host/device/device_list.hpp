#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "device/cl_error.hpp"

namespace hybrid::device {

struct DeviceInfo {
  int index = 0;  // what --device N takes: platforms in the loader's order, devices in the platform's
  std::string name, vendor, platform, driver_version, opencl_c_version;
  bool is_cpu = false;
  unsigned compute_units = 0;
  unsigned native_float_width = 1;  // lanes of the widest native float vector
  std::size_t global_memory_bytes = 0;
  std::size_t max_allocation_bytes = 0;
  cl_device_id id = nullptr;
  cl_platform_id platform_id = nullptr;
};

// Where PoCL keeps compiled kernels: POCL_CACHE_DIR, else the user's cache folder.
std::filesystem::path kernel_cache_folder();

// Every OpenCL device of the machine, at least one. Throws ErrorKind::device when there is none, or when
// POCL_CACHE_DIR is set but unusable, since PoCL then merely reports no devices.
std::vector<DeviceInfo> list_devices();

// `choice`: "" (first CPU device, else the first of any kind), "cpu", "gpu" or an index. Throws
// ErrorKind::device when nothing matches, listing what there is.
DeviceInfo choose_device(const std::string& choice);

}  // namespace hybrid::device
