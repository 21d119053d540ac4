#include "device.hpp"

namespace hybrid::testing {

device::Queue& queue() {
  const char* chosen = std::getenv("HYBRID_TEST_DEVICE");
  static auto& instance =
      // Never destroyed: oclgrind crashes when released at the process's end.
      *new device::Queue(chosen ? chosen : "");
  return instance;
}

}  // namespace hybrid::testing
