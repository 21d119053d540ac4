#include "device/program.hpp"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "device/program_cache.hpp"
#include "embedded_kernels.hpp"

namespace hybrid::device {
namespace {

constexpr const char* kRounding = " -cl-fp32-correctly-rounded-divide-sqrt";

struct Source {
  std::string text;
  std::string include_option;
};

Source kernel_source(const std::string& name) {
  if (const char* folder = std::getenv("HYBRID_KERNEL_DIR")) {
    const std::string path = std::string(folder) + "/" + name + ".cl";
    std::ifstream file(path);
    if (!file)
      fail(ErrorKind::device, "HYBRID_KERNEL_DIR: cannot read {}; unset it to use the built-in kernels",
           path);
    std::ostringstream text;
    text << file.rdbuf();
    return {text.str(), fmt::format(" -I{}", folder)};
  }
  for (const auto& kernel : kernels::embedded_kernels())
    if (name == kernel.name) return {kernel.source, ""};
  fail(ErrorKind::failed, "kernel {} is not in this build", name);
}

std::string build_log(cl_program program, cl_device_id device) {
  std::size_t size = 0;
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
  std::string log(size, '\0');
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
  return log;
}

// With `options`, or without the rounding option where the driver lacks it: its division is then the driver's
// own.
cl_program compile(cl_context context, const DeviceInfo& device, const std::string& name,
                   const Source& source, std::string options) {
  const char* text = source.text.c_str();
  cl_int code = CL_SUCCESS;
  cl_program program = clCreateProgramWithSource(context, 1, &text, nullptr, &code);
  check(code, "create program " + name);
  code = clBuildProgram(program, 1, &device.id, options.c_str(), nullptr, nullptr);
  if (code == CL_INVALID_BUILD_OPTIONS) {
    options.erase(options.find(kRounding), std::strlen(kRounding));
    code = clBuildProgram(program, 1, &device.id, options.c_str(), nullptr, nullptr);
  }
  if (code != CL_SUCCESS) {
    const std::string log = build_log(program, device.id);
    clReleaseProgram(program);
    fail(ErrorKind::device,
         "OpenCL: build kernel {} with '{}': error {} (PoCL: also when it cannot write to {})\n{}", name,
         options, code, kernel_cache_folder().string(), log);
  }
  return program;
}

}  // namespace

cl_kernel build_kernel(cl_context context, const DeviceInfo& device, const std::string& name,
                       const Defines& defines) {
  const Source source = kernel_source(name);
  std::string options = std::string("-cl-std=CL1.2") + kRounding + source.include_option;
  if (!device.is_cpu) options += " -DPORTABLE";
  for (const auto& [define, value] : defines) options += fmt::format(" -D{}={}", define, value);

  // Files that a source includes are no part of what names it.
  const auto kept = source.include_option.empty() ? program_file(device, name, source.text, options) : "";
  if (!kept.empty())
    if (cl_kernel kernel = load_kept_kernel(context, device, name, kept, options)) return kernel;
  cl_program program = compile(context, device, name, source, options);
  cl_int code = CL_SUCCESS;
  cl_kernel kernel = clCreateKernel(program, name.c_str(), &code);
  if (kernel && !kept.empty()) keep_program(program, kept);
  clReleaseProgram(program);  // the kernel keeps it alive
  check(code, "create kernel " + name);
  return kernel;
}

}  // namespace hybrid::device
