#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "core/json_text.hpp"
#include "device/self_test.hpp"

namespace hybrid::app {
namespace {

nlohmann::ordered_json describe(const device::DeviceInfo& info, const std::string& self_test) {
  return {{"index", info.index},
          {"name", info.name},
          {"vendor", info.vendor},
          {"platform", info.platform},
          {"driver", info.driver_version},
          {"opencl_c", info.opencl_c_version},
          {"type", info.is_cpu ? "cpu" : "gpu"},
          {"compute_units", info.compute_units},
          {"float_lanes", info.native_float_width},
          {"memory_bytes", info.global_memory_bytes},
          {"max_allocation_bytes", info.max_allocation_bytes},
          {"self_test", self_test.empty() ? "passed" : self_test}};
}

std::string test_device(int index) {
  try {
    device::Queue queue(std::to_string(index));
    return device::self_test(queue);
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

void add_devices(CLI::App& program, int& exit_code) {
  auto* command = program.add_subcommand("devices", "OpenCL devices, each with a known-answer self test");
  auto common = std::make_shared<CommonOptions>();
  add_common_options(*command, *common);
  command->callback([=, &exit_code] {
    apply(*common);
    const auto devices = device::list_devices();
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const auto& info : devices) {
      const std::string result = test_device(info.index);
      if (!result.empty()) exit_code = hybrid::exit_code(ErrorKind::device);
      list.push_back(describe(info, result));
    }
    if (common->json) {
      std::cout << json_text(list) << "\n";
      return;
    }
    for (const auto& row : list)
      std::cout << fmt::format(
          "[{}] {} ({}, {}): {} compute units, {} float lanes, {:.1f} GiB ({:.1f} GiB at once), "
          "self test {}\n",
          row["index"].get<int>(), row["name"].get<std::string>(), row["type"].get<std::string>(),
          row["platform"].get<std::string>(), row["compute_units"].get<int>(), row["float_lanes"].get<int>(),
          row["memory_bytes"].get<double>() / (1 << 30),
          row["max_allocation_bytes"].get<double>() / (1 << 30), row["self_test"].get<std::string>());
  });
}

}  // namespace hybrid::app
