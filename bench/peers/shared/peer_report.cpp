#include "shared/peer_report.hpp"

#include <exception>
#include <iostream>

namespace hybrid::peers {

int report_of(const std::function<Report()>& body) {
  try {
    const Report report = body();
    nlohmann::ordered_json line = {{"package", report.package},
                                   {"settings", report.settings},
                                   {"seconds", report.seconds},
                                   {"parts", report.parts}};
    if (report.more.is_object()) line.update(report.more);
    std::cout << line.dump() << std::endl;
    return 0;
  } catch (const std::exception& problem) {
    std::cerr << "error: " << problem.what() << "\n";
    return 1;
  }
}

}  // namespace hybrid::peers
