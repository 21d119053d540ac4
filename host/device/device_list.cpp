#include "device/device_list.hpp"

#include <unistd.h>
#include <charconv>
#include <cstdlib>
#include <filesystem>

#include "core/error.hpp"

namespace hybrid::device {
namespace {

template <typename Id, typename Query>
std::string text_of(Query query, Id id, cl_uint what) {
  std::size_t size = 0;
  check(query(id, what, 0, nullptr, &size), "query device text");
  std::string text(size, '\0');
  check(query(id, what, size, text.data(), nullptr), "query device text");
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

template <typename T>
T value_of(cl_device_id id, cl_device_info what) {
  T value{};
  check(clGetDeviceInfo(id, what, sizeof value, &value, nullptr), "query device value");
  return value;
}

void check_pocl_cache_folder() {
  const char* folder = std::getenv("POCL_CACHE_DIR");
  if (!folder || !*folder) return;
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  if (!std::filesystem::is_directory(folder, ignored) || access(folder, W_OK | X_OK) != 0)
    fail(ErrorKind::device,
         "POCL_CACHE_DIR={}: expected a writable folder for PoCL's compiled kernels; create it, or unset the "
         "variable",
         folder);
}

DeviceInfo describe(cl_platform_id platform, cl_device_id id, int index) {
  DeviceInfo info;
  info.index = index;
  info.id = id;
  info.platform_id = platform;
  info.name = text_of(clGetDeviceInfo, id, CL_DEVICE_NAME);
  info.vendor = text_of(clGetDeviceInfo, id, CL_DEVICE_VENDOR);
  info.driver_version = text_of(clGetDeviceInfo, id, CL_DRIVER_VERSION);
  info.opencl_c_version = text_of(clGetDeviceInfo, id, CL_DEVICE_OPENCL_C_VERSION);
  info.platform = text_of(clGetPlatformInfo, platform, CL_PLATFORM_NAME);
  info.is_cpu = (value_of<cl_device_type>(id, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) != 0;
  info.compute_units = value_of<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS);
  info.native_float_width = value_of<cl_uint>(id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT);
  info.global_memory_bytes = value_of<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
  info.max_allocation_bytes = value_of<cl_ulong>(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  return info;
}

}  // namespace

std::vector<DeviceInfo> list_devices() {
  check_pocl_cache_folder();
  cl_uint platform_count = 0;
  if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS || platform_count == 0) return {};
  std::vector<cl_platform_id> platforms(platform_count);
  check(clGetPlatformIDs(platform_count, platforms.data(), nullptr), "list platforms");
  std::vector<DeviceInfo> devices;
  for (cl_platform_id platform : platforms) {
    cl_uint count = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> ids(count);
    check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr), "list devices");
    for (cl_device_id id : ids) devices.push_back(describe(platform, id, static_cast<int>(devices.size())));
  }
  return devices;
}

DeviceInfo choose_device(const std::string& choice) {
  const auto devices = list_devices();
  if (devices.empty())
    fail(ErrorKind::device,
         "no OpenCL device found; install a driver (Debian: apt-get install pocl-opencl-icd) and check "
         "`hybrid devices`");
  std::string known;
  for (const auto& device : devices) known += fmt::format(" [{}] {}", device.index, device.name);
  if (choice.empty()) {
    for (const auto& device : devices)
      if (device.is_cpu) return device;
    return devices.front();
  }
  int index = -1;
  const auto parsed = std::from_chars(choice.data(), choice.data() + choice.size(), index);
  const bool is_index = parsed.ec == std::errc() && parsed.ptr == choice.data() + choice.size();
  for (const auto& device : devices) {
    if (is_index && device.index == index) return device;
    if (choice == "cpu" && device.is_cpu) return device;
    if (choice == "gpu" && !device.is_cpu) return device;
  }
  fail(ErrorKind::device, "--device {}: no such device; expected cpu, gpu or one of{}", choice, known);
}

}  // namespace hybrid::device
