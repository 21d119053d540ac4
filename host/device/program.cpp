#include "device/program.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "embedded_kernels.hpp"

namespace hybrid::device {
namespace {

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

}  // namespace

cl_kernel build_kernel(cl_context context, const DeviceInfo& device, const std::string& name,
                       const Defines& defines) {
  const Source source = kernel_source(name);
  std::string options = "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt" + source.include_option;
  if (!device.is_cpu) options += " -DPORTABLE";
  for (const auto& [define, value] : defines) options += fmt::format(" -D{}={}", define, value);

  const char* text = source.text.c_str();
  cl_int code = CL_SUCCESS;
  cl_program program = clCreateProgramWithSource(context, 1, &text, nullptr, &code);
  check(code, "create program " + name);
  code = clBuildProgram(program, 1, &device.id, options.c_str(), nullptr, nullptr);
  if (code == -43) {  // some drivers lack the rounding option: their division is then the driver's own
    options.erase(options.find(" -cl-fp32"), std::string(" -cl-fp32-correctly-rounded-divide-sqrt").size());
    code = clBuildProgram(program, 1, &device.id, options.c_str(), nullptr, nullptr);
  }
  if (code != CL_SUCCESS) {
    const std::string log = build_log(program, device.id);
    clReleaseProgram(program);
    fail(ErrorKind::device,
         "OpenCL: build kernel {} with '{}': error {} (PoCL: also when it cannot write to {})\n{}", name,
         options, code, kernel_cache_folder().string(), log);
  }
  cl_kernel kernel = clCreateKernel(program, name.c_str(), &code);
  clReleaseProgram(program);  // the kernel keeps it alive
  check(code, "create kernel " + name);
  return kernel;
}

}  // namespace hybrid::device
