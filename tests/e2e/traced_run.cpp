#include "traced_run.hpp"

#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <set>
#include <sstream>
#include <vector>

#include "io/output.hpp"
#include "places.hpp"

namespace hybrid::e2e {
namespace {

constexpr int kTraceRefused = 126;

[[noreturn]] void become_program(const std::string& arguments, const Scratch& scratch) {
  const std::string program = HYBRID_BIN_DIR "/hybrid";
  std::vector<std::string> words{program};
  std::istringstream stream(arguments);
  for (std::string word; stream >> word;) words.push_back(word);
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int out = open((scratch / "out").c_str(), O_WRONLY | O_CREAT, 0600);
  const int err = open((scratch / "err").c_str(), O_WRONLY | O_CREAT, 0600);
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(kTraceRefused);
  execv(program.c_str(), argv.data());
  _exit(127);
}

// Text of the traced process; stops at a zero byte.
std::string text_at(pid_t process, std::uint64_t address, std::size_t count) {
  std::string text(count, '\0');
  const iovec here{text.data(), count};
  // A path may end a page before the unreadable one: then only that page is read.
  for (std::size_t wanted : {count, std::size_t{4096} - address % 4096}) {
    const iovec there{reinterpret_cast<void*>(address), std::min(wanted, count)};
    const ssize_t got = process_vm_readv(process, &here, 1, &there, 1, 0);
    if (got <= 0) continue;
    text.resize(static_cast<std::size_t>(got));
    return text.substr(0, text.find('\0'));
  }
  return "";
}

bool is_moment(pid_t process, const Moment& moment) {
  __ptrace_syscall_info info{};
  if (ptrace(PTRACE_GET_SYSCALL_INFO, process, sizeof info, &info) <= 0) return false;
  if (info.op != PTRACE_SYSCALL_INFO_ENTRY) return false;
  const auto& [number, arguments] = info.entry;
  if (number == SYS_write && arguments[0] == STDERR_FILENO && !moment.prints.empty())
    return text_at(process, arguments[1], arguments[2]).find(moment.prints) != std::string::npos;
  std::uint64_t target = 0;
#ifdef SYS_rename
  if (number == SYS_rename) target = arguments[1];
#endif
#ifdef SYS_renameat
  if (number == SYS_renameat) target = arguments[3];
#endif
  if (number == SYS_renameat2) target = arguments[3];
  return target != 0 && !moment.renames.empty() && text_at(process, target, 4096).ends_with(moment.renames);
}

struct Stop {
  pid_t thread;
  int status;
};

// Of any thread; nothing when the minute is over.
std::optional<Stop> next_stop() {
  Stop stop{};
  stop.thread = waitpid(-1, &stop.status, __WALL);
  if (stop.thread < 0) return std::nullopt;
  return stop;
}

// The signal that a stopped thread is to get: tracing's own stops are none.
int pass_on(int status, bool is_new) {
  const int stop = WSTOPSIG(status);
  const bool own = stop == SIGTRAP || stop == (SIGTRAP | 0x80) || (is_new && stop == SIGSTOP);
  return own ? 0 : stop;
}

std::optional<int> end_of(pid_t process, const Moment& moment, int signal) {
  std::set<pid_t> threads;
  bool signalled = false;
  while (const auto stop = next_stop()) {
    const auto [thread, status] = *stop;
    if (!WIFSTOPPED(status)) {
      if (thread == process) return status;
      continue;
    }
    const bool is_new = threads.insert(thread).second;
    if (thread == process && is_new)
      ptrace(PTRACE_SETOPTIONS, process, nullptr,
             PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL);
    if (!signalled && WSTOPSIG(status) == (SIGTRAP | 0x80) && is_moment(thread, moment)) {
      kill(process, signal);
      signalled = true;
    }
    ptrace(signalled ? PTRACE_CONT : PTRACE_SYSCALL, thread, nullptr, pass_on(status, is_new));
  }
  return std::nullopt;
}

extern "C" void on_alarm(int) {}

}  // namespace

std::optional<Outcome> run_and_signal(const std::string& arguments, const Moment& moment, int signal) {
  const Scratch scratch;
  struct sigaction alarm_action {};
  alarm_action.sa_handler = on_alarm;  // without SA_RESTART: waitpid() returns
  sigaction(SIGALRM, &alarm_action, nullptr);
  const pid_t process = fork();
  if (process == 0) become_program(arguments, scratch);
  alarm(60);
  const auto status = end_of(process, moment, signal);
  alarm(0);
  Outcome outcome;
  if (!status) {
    kill(process, SIGKILL);
    waitpid(process, nullptr, __WALL);
  } else {
    outcome.exit_code = WIFEXITED(*status) ? WEXITSTATUS(*status) : 128 + WTERMSIG(*status);
  }
  if (outcome.exit_code == kTraceRefused) return std::nullopt;
  outcome.out = io::read_text(scratch / "out");
  outcome.err = io::read_text(scratch / "err");
  return outcome;
}

}  // namespace hybrid::e2e
