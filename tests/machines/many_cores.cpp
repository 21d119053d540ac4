// Sixteen cores on any machine: preloaded into a program (LD_PRELOAD), so that the host threads are as
// many and come and go as they do there, and what each keeps for itself is as small and as fresh. PoCL asks
// the hardware and keeps its own.
#include <dlfcn.h>
#include <sched.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include <cstddef>

namespace {
constexpr int kCores = 16;
}

extern "C" {

int get_nprocs() noexcept {
  return kCores;
}

long sysconf(int name) noexcept {
  static const auto real = reinterpret_cast<decltype(&sysconf)>(dlsym(RTLD_NEXT, "sysconf"));
  return name == _SC_NPROCESSORS_ONLN || name == _SC_NPROCESSORS_CONF ? kCores : real(name);
}

int sched_getaffinity(pid_t, std::size_t size, cpu_set_t* set) noexcept {
  CPU_ZERO_S(size, set);
  for (int core = 0; core < kCores; ++core) CPU_SET_S(core, size, set);
  return 0;
}
}
