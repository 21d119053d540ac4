#include "io/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace hybrid::io {
namespace {

constexpr std::size_t kBuffer_bytes = 1 << 18;

const char* remedy(int reason) {
  switch (reason) {
    case EFBIG:
      return "; raise the file size limit (ulimit -f)";
    case EROFS:
    case EACCES:
    case EPERM:
      return "; choose another --out or change its permissions";
    case EIO:
      return "; check the disk";
    default:
      return "";
  }
}

}  // namespace

void fail_output(const std::filesystem::path& file, int reason) {
  if (reason == ENOSPC)
    hybrid::fail(ErrorKind::temporary, "{}: the disk is full; free space and run again", file.string());
  if (reason == EDQUOT)
    hybrid::fail(ErrorKind::temporary, "{}: the disk quota is used up; free space and run again",
                 file.string());
  hybrid::fail(ErrorKind::failed, "{}: cannot write: {}{}", file.string(), std::strerror(reason),
               remedy(reason));
}

OutputFile::OutputFile(const std::filesystem::path& file) : file_(file) {
  descriptor_ = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail_output(file_, errno);
  buffer_.reserve(kBuffer_bytes);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::fail(int reason) {
  if (failure_ == 0) failure_ = reason;
  fail_output(file_, failure_);
}

void OutputFile::write(const void* bytes, std::size_t count) {
  if (failure_ != 0) fail(failure_);
  const char* from = static_cast<const char*>(bytes);
  if (count >= kBuffer_bytes) {
    flush();
    write_through(from, count);
    return;
  }
  buffer_.insert(buffer_.end(), from, from + count);
  if (buffer_.size() >= kBuffer_bytes) flush();
}

void OutputFile::write_through(const char* bytes, std::size_t count) {
  for (std::size_t done = 0; done < count;) {
    const ssize_t written = ::write(descriptor_, bytes + done, count - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(written < 0 ? errno : EIO);
    done += static_cast<std::size_t>(written);
  }
  flushed_ += count;
}

void OutputFile::flush() {
  write_through(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void OutputFile::seek(std::uint64_t position) {
  if (failure_ != 0) fail(failure_);
  flush();
  if (lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) < 0) fail(errno);
  flushed_ = position;
}

void OutputFile::close() {
  if (failure_ != 0) fail(failure_);
  flush();
  const int descriptor = std::exchange(descriptor_, -1);
  if (::close(descriptor) != 0) fail(errno);
}

}  // namespace hybrid::io
