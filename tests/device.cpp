#include "device.hpp"

namespace hybrid::testing {

device::Queue& queue() {
  static auto& instance =
      *new device::Queue;  // never destroyed: oclgrind crashes when released at the process's end
  return instance;
}

}  // namespace hybrid::testing
