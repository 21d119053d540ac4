#include "device.hpp"

namespace hybrid::testing {

device::Queue& queue() {
  static device::Queue instance;
  return instance;
}

}  // namespace hybrid::testing
