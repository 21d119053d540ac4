#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace hybrid {

// JSON as text, over several lines where `indent` is not negative. Names of files and groups need not be
// UTF-8: bytes of theirs that are none become U+FFFD.
template <typename Json>
std::string json_text(const Json& json, int indent = 1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace hybrid
