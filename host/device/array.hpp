#pragma once
#include <cstddef>
#include <type_traits>
#include <utility>

#include "device/cl_error.hpp"

namespace hybrid::device {

// `count` values of T on the device. Made by Queue::array; moves, does not copy. An empty array still holds
// one element's memory, so that kernels always get a valid pointer.
template <typename T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Array() = default;
  Array(cl_mem memory, std::size_t count) : memory_(memory), count_(count) {}
  Array(Array&& other) noexcept
      : memory_(std::exchange(other.memory_, nullptr)), count_(std::exchange(other.count_, 0)) {}
  Array& operator=(Array&& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(count_, other.count_);
    return *this;
  }
  ~Array() {
    if (memory_) clReleaseMemObject(memory_);
  }

  std::size_t count() const { return count_; }
  cl_mem memory() const { return memory_; }

 private:
  cl_mem memory_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace hybrid::device
