#include "io/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kWindow_bytes = 1 << 20;

}  // namespace

InputFile::InputFile(const std::filesystem::path& file) : name_(file.string()) {
  check_readable(file);
  descriptor_ = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail_input("{}: cannot be opened ({})", name_, std::strerror(errno));
  struct stat status {};
  if (fstat(descriptor_, &status) == 0) size_ = static_cast<std::uint64_t>(status.st_size);
  if (size_ == 0) {
    close(descriptor_);
    fail_input("{}: byte 0: the file is empty (0 bytes); copy or export it again", name_);
  }
  posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

InputFile::~InputFile() {
  close(descriptor_);
}

std::string_view InputFile::ahead(std::uint64_t offset, std::uint64_t least) {
  const char* start = at(offset, std::min(least, size_ - offset));
  return {start, static_cast<std::size_t>(window_.data() + window_.size() - start)};
}

void InputFile::read(std::uint64_t offset, std::span<char> to) const {
  if (offset > size_ || to.size() > size_ - offset)
    fail_input("{}: byte {}: expected {} bytes, found {}; the file is cut short: copy or export it again",
               name_, offset, to.size(), size_ - std::min(offset, size_));
  for (std::size_t done = 0; done < to.size();) {
    const ssize_t count =
        pread(descriptor_, to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      fail_input("{}: byte {}: cannot be read ({}); copy the file to another disk", name_, offset + done,
                 std::strerror(errno));
    if (count == 0)
      fail_input(
          "{}: byte {}: expected {} bytes in all as when it was opened, found its end; another process "
          "shortened it meanwhile: read it again when it is complete",
          name_, offset + done, size_);
    done += static_cast<std::size_t>(count);
  }
}

void InputFile::load(std::uint64_t offset, std::uint64_t bytes) {
  const std::uint64_t rest = size_ - std::min(offset, size_);
  if (bytes <= rest) window_.resize(std::max(bytes, std::min(kWindow_bytes, rest)));
  window_start_ = offset;
  read(offset, bytes <= rest ? std::span(window_) : std::span(window_.data(), bytes));
}

bool InputFile::only_zeros_from(std::uint64_t offset) {
  while (offset < size_) {
    const std::string_view block = ahead(offset, 1);
    if (block.find_first_not_of('\0') != block.npos) return false;
    offset += block.size();
  }
  return true;
}

std::uint64_t start_of_text(InputFile& file) {
  const std::string_view bytes = file.ahead(0, 4);
  const bool marked = bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff");
  const auto alternates = [&](std::size_t zero) {
    return bytes.size() >= 4 && bytes[zero] == '\0' && bytes[zero + 2] == '\0' && bytes[1 - zero] != '\0' &&
           bytes[3 - zero] != '\0';
  };
  if (marked || alternates(0) || alternates(1))
    fail_input("{}: byte 0: expected ASCII or UTF-8 text, found UTF-16{}; save it as UTF-8", file.name(),
               marked ? " (a byte order mark)" : " without its byte order mark");
  return bytes.starts_with("\xef\xbb\xbf") ? 3 : 0;
}

void check_not_sent_as_text(InputFile& file, std::uint64_t data) {
  if (data < 2 || std::string_view(file.at(data - 2, 2), 2) != "\r\n") return;
  bool found = false;
  char before = '\n';
  for (std::uint64_t offset = data; offset < file.size();) {
    const std::string_view block = file.ahead(offset, 1);
    for (std::size_t at = block.find('\n'); at != block.npos; at = block.find('\n', at + 1)) {
      if ((at > 0 ? block[at - 1] : before) != '\r') return;
      found = true;
    }
    before = block.back();
    offset += block.size();
  }
  if (found)
    fail_input(
        "{}: byte {}: expected binary data, found CR before every LF of them, as after a transfer as text; "
        "copy the file again as binary",
        file.name(), data);
}

void check_count_fits(const std::string& file, const std::string& place, const char* records,
                      std::uint64_t count, std::uint64_t least_bytes, std::uint64_t available,
                      bool salvage_helps) {
  if (least_bytes == 0 || count <= available / least_bytes) return;
  fail_input(
      "{}: {}: expected {} {} of at least {} bytes each, found room for {} ({} bytes); the file is cut short "
      "or its header is wrong: copy or export it again{}",
      file, place, count, records, least_bytes, available / least_bytes, available,
      salvage_helps ? ", or use --salvage" : "");
}

}  // namespace hybrid::io
