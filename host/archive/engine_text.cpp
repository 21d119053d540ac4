#include <fmt/format.h>

#include "archive/engine.hpp"

namespace hybrid::archive {

namespace fs = std::filesystem;

std::string text_of(const EngineResult& result) {
  std::string text;
  for (const auto& [state, count] : result.summary["units"].items())
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count.get<std::size_t>(), state);
  text += fmt::format("; {} computed in {:.1f} s\n", result.summary["computed"].get<std::size_t>(),
                      result.summary["seconds"].get<double>());
  for (const auto& one : result.summary["failed"])
    text += fmt::format("{} {}: {}\n", one["id"].get<std::string>(), one["state"].get<std::string>(),
                        one["error"].get<std::string>());
  return text + fmt::format("results: {}\n",
                            (fs::path(result.summary["store"].get<std::string>()) / "results").string());
}

}  // namespace hybrid::archive
