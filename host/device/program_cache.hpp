#pragma once
#include <filesystem>
#include <string>

#include "device/device_list.hpp"

namespace hybrid::device {

// PoCL keeps what it compiles, but preprocesses a program's source and its own headers each time to find it:
// 25 ms a program, nearly half of what a small scan takes. So the programs it has built are kept as its
// binaries beside its own files, in kernel_cache_folder()/hybrid, and loaded within a millisecond. Other
// drivers keep their own.

// The file of the program of `source` built with `options`; empty for drivers other than PoCL, and where
// POCL_KERNEL_CACHE=0 tells PoCL to keep nothing.
std::filesystem::path program_file(const DeviceInfo& device, const std::string& name,
                                   const std::string& source, const std::string& options);

// The kernel `name` of the program kept in `file`; nullptr where there is none, it is damaged, or the driver
// does not take it: it is to be built from source then. The caller releases it.
cl_kernel load_kept_kernel(cl_context context, const DeviceInfo& device, const std::string& name,
                           const std::filesystem::path& file, const std::string& options);

// Keeps a program that is built for one device, for as many processes at a time as there are. What cannot be
// written is not kept: the next process builds it again.
void keep_program(cl_program program, const std::filesystem::path& file);

}  // namespace hybrid::device
