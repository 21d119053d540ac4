#include "device/program_cache.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "device.hpp"
#include "io/files.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

const std::string kTwice = "__kernel void twice(__global int* v) { v[get_global_id(0)] *= 2; }";
const std::string kOptions = "-cl-std=CL1.2";

// A context of its own with the program `twice`.
class KeptProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    if (device_.platform != "Portable Computing Language") GTEST_SKIP() << "programs are kept for PoCL alone";
    context_ = clCreateContext(nullptr, 1, &device_.id, nullptr, nullptr, nullptr);
    const char* text = kTwice.c_str();
    program_ = clCreateProgramWithSource(context_, 1, &text, nullptr, nullptr);
    ASSERT_EQ(clBuildProgram(program_, 1, &device_.id, kOptions.c_str(), nullptr, nullptr), CL_SUCCESS);
  }
  void TearDown() override {
    if (program_) clReleaseProgram(program_);
    if (context_) clReleaseContext(context_);
  }
  cl_kernel load(const fs::path& file, const std::string& name = "twice") {
    return device::load_kept_kernel(context_, device_, name, file, kOptions);
  }
  // Twice 21 by a kernel that is released then.
  int of_21(cl_kernel kernel) {
    int value = 21;
    cl_command_queue queue = clCreateCommandQueue(context_, device_.id, 0, nullptr);
    cl_mem memory =
        clCreateBuffer(context_, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof value, &value, nullptr);
    const std::size_t one = 1;
    clSetKernelArg(kernel, 0, sizeof memory, &memory);
    clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &one, &one, 0, nullptr, nullptr);
    clEnqueueReadBuffer(queue, memory, CL_TRUE, 0, sizeof value, &value, 0, nullptr, nullptr);
    clReleaseMemObject(memory);
    clReleaseCommandQueue(queue);
    clReleaseKernel(kernel);
    return value;
  }

  const device::DeviceInfo device_ = queue().device();
  cl_context context_ = nullptr;
  cl_program program_ = nullptr;
  const TemporaryFolder folder_;
};

}  // namespace

TEST_F(KeptProgram, is_loaded_and_computes_as_the_one_built) {
  const fs::path file = folder_.path() / "programs/twice.bin";
  EXPECT_EQ(load(file), nullptr) << "there is none yet";
  for (int written = 0; written < 2; ++written) {
    device::keep_program(program_, file);
    cl_kernel kernel = load(file);
    ASSERT_NE(kernel, nullptr);
    EXPECT_EQ(of_21(kernel), 42);
  }
  EXPECT_EQ(load(file, "thrice"), nullptr) << "a kernel that the program lacks";
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1) << "temporary files are left";
}

TEST_F(KeptProgram, is_not_loaded_when_damaged) {
  const fs::path file = folder_.path() / "twice.bin";
  device::keep_program(program_, file);
  const std::string whole = bytes_of(file);
  ASSERT_GT(whole.size(), 1000u);
  for (const std::size_t kept : {std::size_t{0}, std::size_t{31}, std::size_t{32}, whole.size() - 1}) {
    folder_.write("twice.bin", whole.substr(0, kept));
    EXPECT_EQ(load(file), nullptr) << kept << " bytes of " << whole.size();
  }
  for (const std::size_t at : {std::size_t{3}, std::size_t{32}, whole.size() / 2, whole.size() - 1}) {
    std::string damaged = whole;
    damaged[at] ^= 4;
    folder_.write("twice.bin", damaged);
    EXPECT_EQ(load(file), nullptr) << "byte " << at;
  }
  folder_.write("twice.bin", whole);
  cl_kernel kernel = load(file);
  ASSERT_NE(kernel, nullptr);
  EXPECT_EQ(of_21(kernel), 42);
}

TEST_F(KeptProgram, is_not_kept_where_nothing_can_be_written) {
  folder_.write("file", "not a folder");
  device::keep_program(program_, folder_.path() / "file/programs/twice.bin");
  fs::create_directories(folder_.path() / "taken.bin/full");  // a folder bears the name
  device::keep_program(program_, folder_.path() / "taken.bin");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 2);
}

TEST_F(KeptProgram, has_a_file_for_each_source_options_and_driver) {
  const auto file = [&](const std::string& source, const std::string& options) {
    return device::program_file(device_, "twice", source, options);
  };
  const fs::path one = file(kTwice, kOptions);
  EXPECT_EQ(one, file(kTwice, kOptions));
  EXPECT_EQ(one.parent_path(), device::kernel_cache_folder() / "hybrid");
  EXPECT_NE(one, file(kTwice + " ", kOptions));
  EXPECT_NE(one, file(kTwice, kOptions + " "));
  EXPECT_NE(file("b", "a"), file("", "ab"));
  device::DeviceInfo other = device_;
  other.driver_version += "-1";
  EXPECT_NE(one, device::program_file(other, "twice", kTwice, kOptions));
  other = device_;
  other.name += " 2";
  EXPECT_NE(one, device::program_file(other, "twice", kTwice, kOptions));
  other.platform = "NVIDIA CUDA";
  EXPECT_EQ(device::program_file(other, "twice", kTwice, kOptions), "");
  ::setenv("POCL_KERNEL_CACHE", "0", 1);
  EXPECT_EQ(file(kTwice, kOptions), "");
  ::unsetenv("POCL_KERNEL_CACHE");
}

}  // namespace hybrid::testing
