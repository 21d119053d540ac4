#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scalar_type.hpp"

namespace hybrid::io {

// How a file writes red, green and blue: bytes, 16-bit words (often holding bytes), or reals (0..1 or
// 0..255).
enum class ColourKind { none, byte, word, real };
ColourKind colour_kind(ScalarType type);

// What float coordinates are kept relative to: (0, 0, 0) where the centroid of the first returns is within
// 1 km of it. Readers that fill a Scan without a ScanBuilder pass the first kOriginSamples returns.
inline constexpr std::size_t kOriginSamples = 65536;
Vec3 local_origin(std::span<const std::array<double, 3>> returns);

// Turns a reader's samples, in double and in file order, into a Scan. Georeferenced coordinates (centroid of
// the first returns beyond 1 km) become relative to Scan::origin. Non-finite samples become NaN points
// and are counted in a note.
class ScanBuilder {
 public:
  struct Options {
    bool intensity = false;
    ColourKind colour = ColourKind::none;
    bool zero_is_no_return = false;  // "0 0 0" becomes NaN, without a note
  };
  // Throws ErrorKind::input when `count` samples cannot be indexed by 32 bits, ErrorKind::device (whose exit
  // code means memory, too) when there is no memory for them.
  ScanBuilder(const std::string& file, std::string name, std::uint64_t count, const Options& options);

  void add_point(double x, double y, double z);
  void add_intensity(double value) { scan_.intensity.push_back(static_cast<float>(value)); }
  void add_colour(double red, double green, double blue);
  void add_note(std::string note) { scan_.notes.push_back(std::move(note)); }

  Scan finish();

 private:
  using Point = std::array<double, 3>;
  std::array<float, 3> relative(const Point& point) const;
  void choose_origin();
  void scale_colours();

  Options options_;
  Scan scan_;
  bool origin_chosen_ = false;
  // Returns that wait for the choice of the origin.
  std::vector<std::size_t> waiting_index_;
  std::vector<Point> waiting_;
  std::vector<std::array<float, 3>> colours_;  // as written, for kinds whose scale only the whole file shows
  std::uint64_t not_finite_ = 0;
};

// Whether a lower-case field name means intensity.
bool names_intensity(const std::string& lower_case_name);

}  // namespace hybrid::io
