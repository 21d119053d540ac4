#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/queue.hpp"

namespace hybrid::bench {

// A benchmark ready to run: its input is made.
struct Prepared {
  std::function<void(device::Queue&)> run;
  double items = 0, bytes = 0, flops = 0;  // per run
};

struct Bench {
  std::string name;     // kernel's stem, which is also the label of its launches
  std::string variant;  // size or setting, e.g. "1M samples"
  std::function<Prepared()> prepare;
};

// All registered benches.
std::vector<Bench>& registry();

// Registers Case (tests/cases) at the given size. Used at namespace scope: const bool added =
// add<SquareCase>(...).
template <typename Case>
bool add(const std::string& variant, std::size_t size) {
  registry().push_back({Case::kName, variant, [size] {
                          auto input = std::make_shared<decltype(Case::make(size, 1))>(Case::make(size, 1));
                          return Prepared{[input](device::Queue& queue) { Case::run(queue, *input); },
                                          Case::items(*input), Case::bytes(*input), Case::flops(*input)};
                        }});
  return true;
}

}  // namespace hybrid::bench
