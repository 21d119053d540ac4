#pragma once
#include <xxhash.h>

#include <memory>

namespace hybrid::io {

struct FreeHashState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};
using HashState = std::unique_ptr<XXH3_state_t, FreeHashState>;

}  // namespace hybrid::io
