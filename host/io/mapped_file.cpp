#include "io/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::io {

MappedFile::MappedFile(const std::filesystem::path& file) : name_(file.string()) {
  check_readable(file);
  if (!std::filesystem::is_regular_file(file))
    fail_input("{}: expected a regular file, found a device or pipe; save it to a file first", name_);
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_input("{}: cannot be opened ({})", name_, std::strerror(errno));
  struct stat status {};
  const bool known = fstat(descriptor, &status) == 0;
  const auto size = known ? static_cast<std::size_t>(status.st_size) : 0;
  void* start = size > 0 ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
  const int reason = errno;
  close(descriptor);
  if (size == 0) fail_input("{}: byte 0: the file is empty (0 bytes); copy or export it again", name_);
  if (start == MAP_FAILED) fail_input("{}: cannot be read ({})", name_, std::strerror(reason));
  madvise(start, size, MADV_SEQUENTIAL);
  bytes_ = {static_cast<const char*>(start), size};
}

MappedFile::~MappedFile() {
  munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

std::string_view without_byte_order_mark(const std::string& file, std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    fail_input("{}: byte 0: expected ASCII or UTF-8 text, found UTF-16 (a byte order mark); save it as UTF-8",
               file);
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  return bytes;
}

void check_count_fits(const std::string& file, const std::string& place, const char* records,
                      std::uint64_t count, std::uint64_t least_bytes, std::uint64_t available) {
  if (least_bytes == 0 || count <= available / least_bytes) return;
  fail_input(
      "{}: {}: expected {} {} of at least {} bytes each, found room for {} ({} bytes); the file is cut short "
      "or "
      "its header is wrong: copy or export it again",
      file, place, count, records, least_bytes, available / least_bytes, available);
}

}  // namespace hybrid::io
