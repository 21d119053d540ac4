#include "archive/store_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>

#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "core/log.hpp"
#include "io/output_file.hpp"

namespace hybrid::archive {
namespace {

std::string text_of(int descriptor) {
  std::array<char, 512> text{};
  const ssize_t count = pread(descriptor, text.data(), text.size() - 1, 0);
  return count > 0 ? std::string(text.data(), static_cast<std::size_t>(count)) : "another process";
}

[[noreturn]] void fail_locking(const std::filesystem::path& file, int reason) {
  fail(ErrorKind::failed, "{}: cannot be locked ({}); keep the store on a file system with locks",
       file.string(), std::error_code(reason, std::generic_category()).message());
}

}  // namespace

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &parts);
  return text.data();
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

StoreLock::StoreLock(const Store& store, Sharing sharing, const std::string& what, bool wait) {
  const auto file = store.lock_file();
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) io::fail_output(file, errno);
  const int kind = sharing == Sharing::alone ? LOCK_EX : LOCK_SH;
  bool said = false;
  while (flock(descriptor_, kind | LOCK_NB) != 0) {
    const int reason = errno;
    if (reason == EINTR) continue;
    if (reason != EWOULDBLOCK) {
      close(descriptor_);
      fail_locking(file, reason);
    }
    const std::string holder = text_of(descriptor_);
    if (!wait) {
      close(descriptor_);
      fail(ErrorKind::temporary, "{}: in use by {}; wait for it, or add --wait", store.folder().string(),
           holder);
    }
    if (!said) log::info("{}: waiting for {}", store.folder().string(), holder);
    said = true;
    check_interrupted();
    usleep(200'000);
  }
  if (sharing == Sharing::alone) {
    const std::string text =
        fmt::format("{} (process {} on {}, since {} UTC)", what, getpid(), host_name(), utc_now());
    if (ftruncate(descriptor_, 0) == 0)
      if (pwrite(descriptor_, text.data(), text.size(), 0) < 0)
        log::debug("{}: cannot be written", file.string());  // only others' messages lose by it
  }
}

StoreLock::~StoreLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::unique_ptr<KeyLock> KeyLock::try_lock(const Store& store, const std::string& key) {
  const auto file = store.key_lock_file();
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) io::fail_output(file, errno);
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = static_cast<off_t>(std::stoull(key.substr(0, 15), nullptr, 16));
  range.l_len = 1;
  if (fcntl(descriptor, F_OFD_SETLK, &range) == 0) return std::unique_ptr<KeyLock>(new KeyLock(descriptor));
  const int reason = errno;
  close(descriptor);
  if (reason != EAGAIN && reason != EACCES) fail_locking(file, reason);
  return nullptr;
}

KeyLock::~KeyLock() {
  close(descriptor_);
}

}  // namespace hybrid::archive
