#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "device/array.hpp"
#include "device/device_list.hpp"
#include "device/profile.hpp"

namespace hybrid::device {

// A kernel built with its defines. Owned by the Queue that made it.
class Kernel {
 public:
  Kernel(cl_kernel kernel, std::string name) : kernel_(kernel), name_(std::move(name)) {}
  ~Kernel() { clReleaseKernel(kernel_); }
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
  cl_kernel native() const { return kernel_; }
  const std::string& name() const { return name_; }

 private:
  cl_kernel kernel_;
  std::string name_;
};

// Work-items of a launch. The device gets `width` and `height` rounded up to whole work-groups: kernels check
// bounds.
struct Grid {
  std::size_t width = 1;
  std::size_t height = 1;
  int dimensions = 1;
  bool uneven = false;  // see below
};
inline Grid grid(std::size_t width) {
  return {width, 1, 1};
}
inline Grid grid(std::size_t width, std::size_t height) {
  return {width, height, 2};
}
// The same where work-items differ in cost. PoCL's threads take up to 512 work-groups at a time: of small
// ones no thread is left with all the dear ones at the end.
inline Grid uneven(Grid grid) {
  grid.uneven = true;
  return grid;
}

// A rectangle of a row-major host image, in elements.
struct Rect {
  std::size_t row = 0, col = 0, rows = 0, cols = 0;
};

using Defines = std::map<std::string, int>;

// One in-order command queue on one device, with its context, its built kernels and its profile. Not
// thread-safe: one Queue per host thread.
class Queue {
 public:
  // `choice` as in choose_device().
  explicit Queue(const std::string& choice = "");
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  const DeviceInfo& device() const { return device_; }
  // Lanes for kernels on explicit vectors (their VW define): 16, 8, 4 or 1.
  int vector_width() const;

  // Builds kernels/<name>.cl once per set of defines and returns its entry point of the same name.
  const Kernel& kernel(const std::string& name, const Defines& defines = {});

  template <typename T>
  Array<T> array(std::size_t count) {
    return Array<T>(allocate(count, sizeof(T)), count);
  }
  template <typename T>
  Array<T> array(std::span<const T> values) {
    auto made = array<T>(values.size());
    write(made, values);
    return made;
  }
  template <typename T>
  Array<T> array(const std::vector<T>& values) {
    return array(std::span<const T>(values));
  }

  // Blocking copies. The span may be shorter than the array.
  template <typename T>
  void write(Array<T>& target, std::span<const T> values) {
    write_bytes(target.memory(), values.data(), values.size_bytes(), target.count() * sizeof(T));
  }
  template <typename T>
  void read(const Array<T>& source, std::span<T> values) {
    read_bytes(source.memory(), values.data(), values.size_bytes(), source.count() * sizeof(T));
  }
  template <typename T>
  std::vector<T> read(const Array<T>& source) {
    std::vector<T> values(source.count());
    read(source, std::span<T>(values));
    return values;
  }

  // Copies a rectangle of a row-major host image of `image_cols` columns to / from a dense rect.rows x
  // rect.cols array.
  template <typename T>
  void write_rect(Array<T>& target, const T* image, std::size_t image_cols, const Rect& rect) {
    if (rect.rows * rect.cols > target.count()) fail(ErrorKind::failed, "write_rect: tile exceeds its array");
    copy_rect(target.memory(), const_cast<T*>(image), sizeof(T), image_cols, rect, true);
  }
  template <typename T>
  void read_rect(const Array<T>& source, T* image, std::size_t image_cols, const Rect& rect) {
    if (rect.rows * rect.cols > source.count()) fail(ErrorKind::failed, "read_rect: tile exceeds its array");
    copy_rect(source.memory(), image, sizeof(T), image_cols, rect, false);
  }

  // Sets the arguments (Array, scalar or trivially copyable struct, in the kernel's order) and enqueues.
  // `label` is the row of the profile. Returns at once; reads wait.
  template <typename... Args>
  void launch(const std::string& label, const Kernel& kernel, const Grid& grid, const Args&... args) {
    cl_uint index = 0;
    (set_argument(kernel, index++, args), ...);
    enqueue(label, kernel, grid);
  }

  void finish();
  // Device seconds by label since construction; waits for queued work.
  const Profile& profile();

  // Tests run every kernel at two work-group sizes; 0 = the default choice.
  void set_work_group_size(std::size_t size) { work_group_size_ = size; }

 private:
  struct Pending {
    std::string label;
    cl_event event;
  };

  cl_mem allocate(std::size_t count, std::size_t element_bytes);
  void write_bytes(cl_mem target, const void* bytes, std::size_t size, std::size_t capacity);
  void read_bytes(cl_mem source, void* bytes, std::size_t size, std::size_t capacity);
  void copy_rect(cl_mem memory, void* image, std::size_t element_bytes, std::size_t image_cols,
                 const Rect& rect, bool to_device);
  template <typename T>
  void set_argument(const Kernel& kernel, cl_uint index, const Array<T>& array) {
    cl_mem memory = array.memory();
    set_argument_bytes(kernel, index, &memory, sizeof memory);
  }
  template <typename T>
  void set_argument(const Kernel& kernel, cl_uint index, const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    set_argument_bytes(kernel, index, &value, sizeof value);
  }
  void set_argument_bytes(const Kernel& kernel, cl_uint index, const void* bytes, std::size_t size);
  void enqueue(const std::string& label, const Kernel& kernel, const Grid& grid);
  void collect_profile();

  DeviceInfo device_;
  cl_context context_ = nullptr;
  cl_command_queue queue_ = nullptr;
  std::map<std::pair<std::string, Defines>, std::unique_ptr<Kernel>> kernels_;
  std::vector<Pending> pending_;
  Profile profile_;
  std::size_t work_group_size_ = 0;
};

}  // namespace hybrid::device
