#include "io/salvage.hpp"

#include <fmt/format.h>

namespace hybrid::io {

std::string Damage::shortened(std::string_view error) const {
  if (error.starts_with(file_ + ": ")) error.remove_prefix(file_.size() + 2);
  return std::string(error.substr(0, error.find(';')));
}

void Damage::add(std::uint64_t records, std::string_view problem) {
  if (records_ == 0 && records > 0) first_ = shortened(problem);
  records_ += records;
}

std::string Damage::note(std::uint64_t of) const {
  if (records_ == 0) return {};
  return fmt::format("{} of {} points ({:.2f} %) are lost to damage, the first by: {}", records_, of,
                     100 * static_cast<double>(records_) / static_cast<double>(of), first_);
}

CroppedGrid cropped_grid(std::uint64_t fast, std::uint64_t points) {
  if (fast == 0 || points < fast) return {};
  return {fast, (points + fast - 1) / fast};
}

}  // namespace hybrid::io
