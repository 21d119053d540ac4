#pragma once
#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace hybrid::archive {

// A worker (worker.hpp) as the engine sees it: a child that dies with its parent.
class WorkerProcess {
 public:
  struct Start {
    std::filesystem::path store;
    std::string device;
    int threads = 1;
    std::string log_level = "info";
  };
  // Throws ErrorKind::temporary when the system has no process left.
  explicit WorkerProcess(const Start& start);
  // Kills what is left.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  int threads() const { return threads_; }
  int answers() const { return from_; }  // to poll
  // The lines that have arrived. Never blocks. `ended` is set once there will be no more.
  std::vector<nlohmann::ordered_json> read(bool& ended);
  void send(const nlohmann::ordered_json& job);
  void signal(int number) const;
  // Waits for its end; the status of waitpid.
  int wait();
  // Memory in use now; 0 when it has ended.
  std::uint64_t resident_bytes() const;

 private:
  pid_t process_ = -1;
  int to_ = -1, from_ = -1, threads_ = 1;
  std::string unread_;
};

// What a status of waitpid says of a process that ended by itself.
std::string describe_end(int status);

}  // namespace hybrid::archive
