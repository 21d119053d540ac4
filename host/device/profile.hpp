#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace hybrid::device {

struct ProfileRow {
  std::int64_t launches = 0;
  double seconds = 0;  // device time, summed
};

// Device time by launch label: the rows of timing.json and of bench/.
using Profile = std::map<std::string, ProfileRow>;

}  // namespace hybrid::device
