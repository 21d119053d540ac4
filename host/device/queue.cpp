#include "device/queue.hpp"

#include <algorithm>
#include <cstring>

#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "device/program.hpp"

namespace hybrid::device {

namespace {

constexpr std::size_t kCopied = 1 << 18;  // bytes, by one thread at a time

// On a CPU the device's memory is the host's: rows are copied on the host's threads, where the driver's
// command would take one.
void copy_mapped_rect(cl_command_queue queue, cl_mem memory, void* image, std::size_t element_bytes,
                      std::size_t image_cols, const Rect& rect, bool to_device) {
  const std::size_t row_bytes = rect.cols * element_bytes;
  cl_int code = CL_SUCCESS;
  void* mapped = clEnqueueMapBuffer(queue, memory, CL_TRUE, to_device ? CL_MAP_WRITE : CL_MAP_READ, 0,
                                    rect.rows * row_bytes, 0, nullptr, nullptr, &code);
  check(code, "map a tile");
  parallel_for(
      rect.rows,
      [&](std::size_t row) {
        char* of_image =
            static_cast<char*>(image) + ((rect.row + row) * image_cols + rect.col) * element_bytes;
        char* of_device = static_cast<char*>(mapped) + row * row_bytes;
        std::memcpy(to_device ? of_device : of_image, to_device ? of_image : of_device, row_bytes);
      },
      std::max<std::size_t>(kCopied / row_bytes, 1));
  check(clEnqueueUnmapMemObject(queue, memory, mapped, 0, nullptr, nullptr), "unmap a tile");
}

}  // namespace

Queue::Queue(const std::string& choice) : device_(choose_device(choice)) {
  cl_int code = CL_SUCCESS;
  const cl_context_properties properties[] = {
      CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(device_.platform_id), 0};
  context_ = clCreateContext(properties, 1, &device_.id, nullptr, nullptr, &code);
  check(code, "create context on " + device_.name);
  queue_ = clCreateCommandQueue(context_, device_.id, CL_QUEUE_PROFILING_ENABLE, &code);
  check(code, "create queue on " + device_.name);
}

Queue::~Queue() {
  if (queue_) clFinish(queue_);
  for (const auto& launch : pending_) clReleaseEvent(launch.event);
  kernels_.clear();
  if (queue_) clReleaseCommandQueue(queue_);
  if (context_) clReleaseContext(context_);
}

int Queue::vector_width() const {
  if (!device_.is_cpu) return 1;
  return device_.native_float_width >= 16 ? 16 : device_.native_float_width >= 8 ? 8 : 4;
}

const Kernel& Queue::kernel(const std::string& name, const Defines& defines) {
  auto& slot = kernels_[{name, defines}];
  if (!slot) slot = std::make_unique<Kernel>(build_kernel(context_, device_, name, defines), name);
  return *slot;
}

cl_mem Queue::allocate(std::size_t count, std::size_t element_bytes) {
  const std::size_t bytes = std::max<std::size_t>(count, 1) * element_bytes;
  if (bytes > device_.max_allocation_bytes)
    fail(ErrorKind::device,
         "an array of {} bytes exceeds the largest this device allocates ({}): use a smaller --tile", bytes,
         device_.max_allocation_bytes);
  cl_int code = CL_SUCCESS;
  cl_mem memory = clCreateBuffer(context_, CL_MEM_READ_WRITE, bytes, nullptr, &code);
  check(code, fmt::format("allocate {} bytes", bytes));
  return memory;
}

void Queue::write_bytes(cl_mem target, const void* bytes, std::size_t size, std::size_t capacity) {
  if (size > capacity) fail(ErrorKind::failed, "write of {} bytes to an array of {}", size, capacity);
  if (size == 0) return;
  check(clEnqueueWriteBuffer(queue_, target, CL_TRUE, 0, size, bytes, 0, nullptr, nullptr),
        "write to the device");
}

void Queue::read_bytes(cl_mem source, void* bytes, std::size_t size, std::size_t capacity) {
  if (size > capacity) fail(ErrorKind::failed, "read of {} bytes from an array of {}", size, capacity);
  if (size == 0) return;
  check(clEnqueueReadBuffer(queue_, source, CL_TRUE, 0, size, bytes, 0, nullptr, nullptr),
        "read from the device");
  collect_profile();
}

void Queue::copy_rect(cl_mem memory, void* image, std::size_t element_bytes, std::size_t image_cols,
                      const Rect& rect, bool to_device) {
  if (rect.rows == 0 || rect.cols == 0) return;
  if (device_.is_cpu)
    return copy_mapped_rect(queue_, memory, image, element_bytes, image_cols, rect, to_device);
  const std::size_t zero[3] = {0, 0, 0};
  const std::size_t host_origin[3] = {rect.col * element_bytes, rect.row, 0};
  const std::size_t region[3] = {rect.cols * element_bytes, rect.rows, 1};
  const std::size_t device_pitch = rect.cols * element_bytes, host_pitch = image_cols * element_bytes;
  if (to_device)
    check(clEnqueueWriteBufferRect(queue_, memory, CL_TRUE, zero, host_origin, region, device_pitch, 0,
                                   host_pitch, 0, image, 0, nullptr, nullptr),
          "write a tile to the device");
  else
    check(clEnqueueReadBufferRect(queue_, memory, CL_TRUE, zero, host_origin, region, device_pitch, 0,
                                  host_pitch, 0, image, 0, nullptr, nullptr),
          "read a tile from the device");
}

void Queue::set_argument_bytes(const Kernel& kernel, cl_uint index, const void* bytes, std::size_t size) {
  const cl_int code = clSetKernelArg(kernel.native(), index, size, bytes);
  if (code != CL_SUCCESS) check(code, fmt::format("set argument {} of {}", index, kernel.name()));
}

void Queue::enqueue(const std::string& label, const Kernel& kernel, const Grid& grid) {
  if (grid.width == 0 || grid.height == 0) return;
  check_interrupted();
  // Few local sizes, because PoCL compiles each kernel anew for every one it meets.
  const std::size_t items = grid.width * grid.height;
  std::size_t group = work_group_size_;
  if (group == 0) group = items < 256u * device_.compute_units || (grid.uneven && device_.is_cpu) ? 16 : 128;
  const std::size_t local[2] = {group, 1};
  const std::size_t global[2] = {(grid.width + group - 1) / group * group, grid.height};
  cl_event event = nullptr;
  check(clEnqueueNDRangeKernel(queue_, kernel.native(), static_cast<cl_uint>(grid.dimensions), nullptr,
                               global, local, 0, nullptr, &event),
        fmt::format("launch {} on {} x {} work-items", kernel.name(), grid.width, grid.height));
  pending_.push_back({label, event});
  if (pending_.size() > 256) finish();
}

void Queue::finish() {
  check(clFinish(queue_), "finish queued work");
  collect_profile();
}

const Profile& Queue::profile() {
  finish();
  return profile_;
}

// Only called when everything queued has ended: after clFinish or a blocking read on the in-order queue.
void Queue::collect_profile() {
  for (const auto& launch : pending_) {
    cl_ulong start = 0, end = 0;
    clGetEventProfilingInfo(launch.event, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr);
    clGetEventProfilingInfo(launch.event, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr);
    auto& row = profile_[launch.label];
    row.launches += 1;
    row.seconds += static_cast<double>(end - start) * 1e-9;
    clReleaseEvent(launch.event);
  }
  pending_.clear();
}

}  // namespace hybrid::device
