#include "compare/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace hybrid::compare {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

[[noreturn]] void become(const std::vector<std::string>& command, int output, int errors) {
  // A group of its own, so that what a script starts ends with it; a terminal's interrupt ends us, and the
  // kernel then ends the program.
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  dup2(output, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
  std::vector<char*> arguments;
  for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  _exit(127);
}

// Appends what is there; false at the end of the stream.
bool drain(int stream, std::string& text) {
  std::array<char, 65536> buffer;
  const ssize_t count = read(stream, buffer.data(), buffer.size());
  if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0 || (count < 0 && errno == EINTR);
}

}  // namespace

Finished run_process(const std::vector<std::string>& command, double limit_s) {
  int output[2], errors[2];
  if (pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error("pipe: " + std::string(std::strerror(errno)));
  if (pipe2(errors, O_CLOEXEC) != 0) throw std::runtime_error("pipe: " + std::string(std::strerror(errno)));
  const auto start = Clock::now();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork: " + std::string(std::strerror(errno)));
  if (child == 0) become(command, output[1], errors[1]);
  setpgid(child, child);  // here too: whoever comes first
  close(output[1]);
  close(errors[1]);
  Finished result;
  std::array<pollfd, 2> streams{{{output[0], POLLIN, 0}, {errors[0], POLLIN, 0}}};
  std::array<std::string*, 2> texts{&result.output, &result.errors};
  for (int open = 2; open > 0;) {
    if (!result.stopped && since(start) > limit_s) {
      kill(-child, SIGKILL);
      result.stopped = true;
    }
    if (poll(streams.data(), streams.size(), 200) <= 0) continue;
    for (std::size_t i = 0; i < streams.size(); ++i)
      if (streams[i].fd >= 0 && streams[i].revents != 0 && !drain(streams[i].fd, *texts[i])) {
        close(streams[i].fd);
        streams[i].fd = -1;
        --open;
      }
  }
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  result.wall_s = since(start);
  result.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024;
  result.limit_s = limit_s;
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  result.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (result.exit_code == 127) throw std::runtime_error(command.front() + ": cannot be started");
  return result;
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "";
  const std::size_t before = text.find_last_of('\n', end);
  const std::size_t start = before == std::string::npos ? 0 : before + 1;
  return text.substr(start, end - start + 1);
}

std::string failure_of(const Finished& finished) {
  if (finished.stopped) return fmt::format("stopped after {:g} s", finished.limit_s);
  if (finished.exit_code == 0) return "";
  const std::string words = last_line(finished.errors);
  std::string failure = fmt::format("exit status {}", finished.exit_code);
  if (finished.exit_code > 128) {
    failure =
        fmt::format("ended by signal {} ({})", finished.exit_code - 128, strsignal(finished.exit_code - 128));
    if (finished.exit_code == 128 + SIGKILL) failure += ", as when memory runs out";
  }
  return words.empty() ? failure : failure + ": " + words;
}

}  // namespace hybrid::compare
