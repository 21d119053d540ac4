#pragma once
#include <string>

#include "world/world.hpp"

namespace synth {

struct Summary {
  std::string json;
  std::string text;
};

// Bytes the scene's files will take, roughly, what is only there meanwhile included.
double estimate_bytes(const World&, const Options&);

// Traces the world and writes the whole scene; scene.toml last: a folder that has it is complete.
Summary generate(const World&, const Options&, const std::string& folder);

}  // namespace synth
