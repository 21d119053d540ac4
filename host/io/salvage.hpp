#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace hybrid::io {

// Coordinates beyond are damage. Far beyond every coordinate system of the Earth, as there are files whose
// other numbers (times) are called coordinates.
inline constexpr double kAbsurd_m = 1e12;
// The same of E57 and LAS, whose coordinates are nothing else.
inline constexpr double kFarthest_m = 1e9;

inline constexpr const char* kSalvageRemedy = "or use --salvage";

// What a reader in salvage passes by: how many records, and of the first what is wrong with it.
class Damage {
 public:
  explicit Damage(std::string file) : file_(std::move(file)) {}

  // `problem` may be an error's text: the file's name and the remedies are left out.
  void add(std::uint64_t records, std::string_view problem);
  std::uint64_t records() const { return records_; }
  // "3 of 40 points (7.50 %) are lost, the first by: line 14: expected ..."; "" when none are.
  std::string note(std::uint64_t of) const;
  // The same of a text that is an error's.
  std::string shortened(std::string_view error) const;

 private:
  std::string file_, first_;
  std::uint64_t records_ = 0;
};

// The points that are there, as a grid of `fast` nodes in a row or column (as the file counts them): as many
// whole ones as hold them. fast = slow = 0 when they do not fill one.
struct CroppedGrid {
  std::uint64_t fast = 0, slow = 0;
  std::uint64_t nodes() const { return fast * slow; }
};
CroppedGrid cropped_grid(std::uint64_t fast, std::uint64_t points);

}  // namespace hybrid::io
