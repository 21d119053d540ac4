#include "io/allocation_watch.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> largest{0};

void* take(std::size_t bytes) noexcept {
  std::size_t known = largest.load(std::memory_order_relaxed);
  while (bytes > known && !largest.compare_exchange_weak(known, bytes, std::memory_order_relaxed)) {
  }
  return std::malloc(bytes > 0 ? bytes : 1);
}

void* take_or_throw(std::size_t bytes) {
  if (void* start = take(bytes)) return start;
  throw std::bad_alloc();
}

}  // namespace

// All forms that malloc serves, since a sanitizer checks that each block is given back as it was taken.
void* operator new(std::size_t bytes) {
  return take_or_throw(bytes);
}
void* operator new[](std::size_t bytes) {
  return take_or_throw(bytes);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return take(bytes);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return take(bytes);
}
void operator delete(void* start) noexcept {
  std::free(start);
}
void operator delete[](void* start) noexcept {
  std::free(start);
}
void operator delete(void* start, std::size_t) noexcept {
  std::free(start);
}
void operator delete[](void* start, std::size_t) noexcept {
  std::free(start);
}
void operator delete(void* start, const std::nothrow_t&) noexcept {
  std::free(start);
}
void operator delete[](void* start, const std::nothrow_t&) noexcept {
  std::free(start);
}

namespace hybrid::testing {

AllocationWatch::AllocationWatch() {
  largest = 0;
}

std::size_t AllocationWatch::largest_bytes() const {
  return largest;
}

}  // namespace hybrid::testing
