#include "device/device_list.hpp"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
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

// Why PoCL cannot use its cache folder; "" when it can.
std::string cache_problem() {
  const auto folder = kernel_cache_folder();
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return code.message();
  return access(folder.c_str(), W_OK | X_OK) == 0 ? "" : std::strerror(errno);
}

void check_chosen_cache_folder() {
  const char* chosen = std::getenv("POCL_CACHE_DIR");
  if (!chosen || !*chosen) return;
  if (const auto problem = cache_problem(); !problem.empty())
    fail(ErrorKind::device,
         "POCL_CACHE_DIR={}: expected a writable folder for PoCL's compiled kernels ({}); name another, or "
         "unset the variable",
         chosen, problem);
}

// Other drivers need no such folder, so that the default one counts only when there is no device.
[[noreturn]] void fail_without_device() {
  const auto problem = cache_problem();
  if (!problem.empty())
    fail(ErrorKind::device,
         "no OpenCL device found; if PoCL is installed: it cannot use its cache folder {} ({}): set "
         "POCL_CACHE_DIR to a writable folder",
         kernel_cache_folder().string(), problem);
  fail(ErrorKind::device,
       "no OpenCL device found; install a driver (Debian: apt-get install pocl-opencl-icd), or correct "
       "OCL_ICD_VENDORS if it is set; `hybrid devices` tests it");
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

std::filesystem::path kernel_cache_folder() {
  const auto value = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
  if (!value("POCL_CACHE_DIR").empty()) return value("POCL_CACHE_DIR");
  if (!value("XDG_CACHE_HOME").empty()) return value("XDG_CACHE_HOME") + "/pocl/kcache";
  return value("HOME").empty() ? "/tmp/pocl/kcache" : value("HOME") + "/.cache/pocl/kcache";
}

std::vector<DeviceInfo> list_devices() {
  check_chosen_cache_folder();
  cl_uint platform_count = 0;
  if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS || platform_count == 0)
    fail_without_device();
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
  if (devices.empty()) fail_without_device();
  return devices;
}

DeviceInfo choose_device(const std::string& choice) {
  const auto devices = list_devices();
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
