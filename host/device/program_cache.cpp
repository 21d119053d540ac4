#include "device/program_cache.hpp"

#include <unistd.h>
#include <xxhash.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "core/error.hpp"

namespace hybrid::device {
namespace {

namespace fs = std::filesystem;

std::string hex_of(XXH128_hash_t hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string checksum(const std::string& bytes) {
  return hex_of(XXH3_128bits(bytes.data(), bytes.size()));
}

constexpr std::size_t kChecksumLength = 32;

std::string binary_of(cl_program program) {
  std::size_t size = 0;
  if (clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr) != CL_SUCCESS)
    return "";
  std::string bytes(size, '\0');
  auto* start = reinterpret_cast<unsigned char*>(bytes.data());
  const bool read =
      clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof start, &start, nullptr) == CL_SUCCESS;
  return read ? bytes : "";
}

// "" where it is not there or not as it was written.
std::string read_kept(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return "";
  std::string sum(kChecksumLength, '\0');
  in.read(sum.data(), kChecksumLength);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  return checksum(bytes) == sum ? bytes : "";
}

}  // namespace

fs::path program_file(const DeviceInfo& device, const std::string& name, const std::string& source,
                      const std::string& options) {
  const char* cached = std::getenv("POCL_KERNEL_CACHE");
  if (device.platform != "Portable Computing Language" || (cached && std::string(cached) == "0")) return {};
  std::string key;
  for (const auto& part : {device.name, device.driver_version, device.opencl_c_version, options, source})
    key += part + '\0';
  return kernel_cache_folder() / "hybrid" / fmt::format("{}-{}.bin", name, checksum(key));
}

cl_kernel load_kept_kernel(cl_context context, const DeviceInfo& device, const std::string& name,
                           const fs::path& file, const std::string& options) {
  const std::string bytes = read_kept(file);
  if (bytes.empty()) return nullptr;
  const std::size_t size = bytes.size();
  const auto* start = reinterpret_cast<const unsigned char*>(bytes.data());
  cl_program program = clCreateProgramWithBinary(context, 1, &device.id, &size, &start, nullptr, nullptr);
  if (!program) return nullptr;
  cl_kernel kernel = nullptr;
  if (clBuildProgram(program, 1, &device.id, options.c_str(), nullptr, nullptr) == CL_SUCCESS)
    kernel = clCreateKernel(program, name.c_str(), nullptr);
  clReleaseProgram(program);
  return kernel;
}

void keep_program(cl_program program, const fs::path& file) {
  const std::string bytes = binary_of(program);
  if (bytes.empty()) return;
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  std::string temporary = file.string() + ".XXXXXX";
  const int opened = mkstemp(temporary.data());
  if (opened < 0) return;
  close(opened);
  std::ofstream out(temporary, std::ios::binary);
  out << checksum(bytes) << bytes;
  out.close();
  if (!out || std::rename(temporary.c_str(), file.c_str()) != 0) fs::remove(temporary, ignored);
}

}  // namespace hybrid::device
