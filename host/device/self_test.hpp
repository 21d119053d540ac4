#pragma once
#include <string>

#include "device/queue.hpp"

namespace hybrid::device {

// Runs kernels/self_test.cl on the queue's device and compares with the host's own answers. Returns "" when
// every bit agrees, else what differed first.
std::string self_test(Queue& queue);

}  // namespace hybrid::device
