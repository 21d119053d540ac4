#pragma once
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace hybrid::peers {

// Wall clock since construction.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// What a program says on stdout, one JSON object: hybrid-compare reads these names (README.md).
struct Report {
  std::string package;   // "PCL 1.13.0"
  std::string settings;  // for a reader of the table
  double seconds = 0;    // from the input in memory to the result in memory
  nlohmann::ordered_json parts = nlohmann::ordered_json::object();  // seconds of its steps
  nlohmann::ordered_json more = nlohmann::ordered_json::object();   // pose, iterations, counts
};

// Runs the body, prints its report; a failure becomes "error: ..." on stderr and exit status 1.
int report_of(const std::function<Report()>& body);

}  // namespace hybrid::peers
