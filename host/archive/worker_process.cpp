#include "archive/worker_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "archive/worker.hpp"
#include "core/error.hpp"

namespace hybrid::archive {

WorkerProcess::WorkerProcess(const Start& start) : threads_(start.threads) {
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0) fail(ErrorKind::temporary, "no pipe for a worker; close other programs");
  if (pipe2(from, O_CLOEXEC) != 0) {
    close(to[0]), close(to[1]);
    fail(ErrorKind::temporary, "no pipe for a worker; close other programs");
  }
  const std::string threads = std::to_string(start.threads), store = start.store.string();
  std::vector<const char*> arguments = {"hybrid",        "batch",       "work",
                                        "--out",         store.c_str(), "--threads",
                                        threads.c_str(), "--log-level", start.log_level.c_str()};
  if (!start.device.empty()) arguments.insert(arguments.end(), {"--device", start.device.c_str()});
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {  // only calls that are safe between fork and exec
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    dup2(to[0], STDIN_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    if (from[1] == kAnswerDescriptor)
      fcntl(from[1], F_SETFD, 0);
    else
      dup2(from[1], kAnswerDescriptor);
    execv("/proc/self/exe", const_cast<char* const*>(arguments.data()));
    _exit(1);
  }
  close(to[0]);
  close(from[1]);
  to_ = to[1];
  from_ = from[0];
  fcntl(from_, F_SETFL, O_NONBLOCK);
  if (process_ < 0) {
    close(to_), close(from_);
    fail(ErrorKind::temporary, "no process for a worker; close other programs");
  }
}

WorkerProcess::~WorkerProcess() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    wait();
  }
  close(to_);
  close(from_);
}

std::vector<nlohmann::ordered_json> WorkerProcess::read(bool& ended) {
  char bytes[4096];
  while (true) {
    const ssize_t count = ::read(from_, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) ended = true;
    if (count <= 0) break;
    unread_.append(bytes, static_cast<std::size_t>(count));
  }
  std::vector<nlohmann::ordered_json> lines;
  for (std::size_t end; (end = unread_.find('\n')) != std::string::npos; unread_.erase(0, end + 1)) {
    auto line = nlohmann::ordered_json::parse(unread_.substr(0, end), nullptr, false);
    if (line.is_object()) lines.push_back(std::move(line));
  }
  return lines;
}

void WorkerProcess::send(const nlohmann::ordered_json& job) {
  const std::string line = job.dump() + "\n";  // shorter than a pipe's buffer
  while (write(to_, line.data(), line.size()) < 0 && errno == EINTR) {
  }
}

void WorkerProcess::signal(int number) const {
  if (process_ > 0) kill(process_, number);
}

int WorkerProcess::wait() {
  int status = 0;
  while (process_ > 0 && waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

std::uint64_t WorkerProcess::resident_bytes() const {
  std::ifstream statm("/proc/" + std::to_string(process_) + "/statm");
  std::uint64_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::string describe_end(int status) {
  return WIFSIGNALED(status)
             ? fmt::format("its process was ended by signal {} ({})", WTERMSIG(status),
                           strsignal(WTERMSIG(status)))
             : fmt::format("its process ended with code {} before it was done", WEXITSTATUS(status));
}

}  // namespace hybrid::archive
