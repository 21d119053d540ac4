#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/parallel.hpp"
#include "geometry/scan.hpp"
#include "io/scalar_type.hpp"

namespace hybrid::io {

// How a file writes red, green and blue: bytes, 16-bit words (often holding bytes), or reals (0..1 or
// 0..255).
enum class ColourKind { none, byte, word, real };
ColourKind colour_kind(ScalarType type);
// From words or reals to bytes: 16-bit fields often hold bytes, and reals are 0..1 or 0..255; the largest
// value of the file tells.
double colour_scale(ColourKind kind, double largest);

// A sample as a file writes it; what the file does not have stays 0.
struct ScanSample {
  double x = 0, y = 0, z = 0, intensity = 0;
  std::array<double, 3> rgb{};
};

// What float coordinates are kept relative to: (0, 0, 0) where the centroid of the first returns is within
// 1 km of it. Readers that fill a Scan without a ScanBuilder pass the first kOriginSamples returns.
inline constexpr std::size_t kOriginSamples = 65536;
Vec3 local_origin(std::span<const std::array<double, 3>> returns);

// Turns a reader's samples, in double and in file order, into a Scan. Georeferenced coordinates (centroid of
// the first returns beyond 1 km) become relative to Scan::origin. Non-finite samples become NaN points
// and are counted in a note. Coordinates beyond kAbsurd_m are damage: ErrorKind::input that names the first.
class ScanBuilder {
 public:
  struct Options {
    bool intensity = false;
    ColourKind colour = ColourKind::none;
    bool scaled_colours = false;     // of kind byte, from other kinds: fractions are not odd
    bool zero_is_no_return = false;  // "0 0 0" becomes NaN, without a note
    bool salvage = false;            // absurd coordinates become NaN, with a note, instead of an error
    bool exact = false;              // fills Scan::exact, unless the points hold the same
    std::optional<Vec3> origin{};    // where it is known; else chosen from the first returns
    std::size_t part = 0;            // of samples that are built part after part: of one
  };
  // Throws ErrorKind::input when `count` samples cannot be indexed by 32 bits, ErrorKind::device (whose exit
  // code means memory, too) when there is no memory for them.
  ScanBuilder(const std::string& file, std::string name, std::uint64_t count, const Options& options);

  void add_point(double x, double y, double z);
  void add_intensity(double value) { scan_.intensity.push_back(static_cast<float>(value)); }
  void add_colour(double red, double green, double blue);
  void add(const ScanSample& sample) {
    add_point(sample.x, sample.y, sample.z);
    if (options_.intensity) add_intensity(sample.intensity);
    if (options_.colour != ColourKind::none) add_colour(sample.rgb[0], sample.rgb[1], sample.rgb[2]);
  }
  // Samples that salvage knows nothing of: no-returns, without a note.
  void add_lost(std::uint64_t count);
  std::size_t size() const { return scan_.points.size(); }
  // For scans that are taken part after part: drops the samples that there are, and goes on behind them.
  void start_part();
  const Scan& part() const { return scan_; }
  // What origins are chosen from, `zero_is_no_return` as above.
  static bool is_place(const ScanSample& sample, bool zero_is_no_return);
  // counts[0] samples, then counts[1] ..., made on all threads by sample(part, index): a ScanSample.
  template <typename Sample>
  void add_parts(const std::vector<std::size_t>& counts, const Sample& sample);
  void add_note(std::string note) { scan_.notes.push_back(std::move(note)); }

  Scan finish();

 private:
  using Point = std::array<double, 3>;
  // Samples that are no coordinates.
  struct Tally {
    std::uint64_t not_finite = 0, absurd = 0, first_absurd = 0;
    std::uint64_t odd_colours = 0;  // of points whose colour should be bytes, and is not
    double absurd_value = 0;
    void add(const Tally& later);
  };
  std::array<float, 3> relative(const Point& point) const;
  bool is_return(double x, double y, double z) const;
  // Whether they are finite and not absurd; counts those that are not.
  static bool are_coordinates(double x, double y, double z, std::uint64_t at, Tally& tally);
  void judge_absurd();
  void note_colours();
  void choose_origin();
  void scale_colours();
  // For samples whose places are known, once the origin is.
  void grow(std::size_t count);
  void put(std::size_t at, const ScanSample& sample, Tally& tally);

  std::string file_;
  Options options_;
  Scan scan_;
  std::uint64_t before_ = 0;  // samples of parts before
  bool origin_chosen_ = false;
  // Returns that wait for the choice of the origin.
  std::vector<std::size_t> waiting_index_;
  std::vector<Point> waiting_;
  std::vector<std::array<float, 3>> colours_;  // as written, for kinds whose scale only the whole file shows
  Tally tally_;
};

template <typename Sample>
void ScanBuilder::add_parts(const std::vector<std::size_t>& counts, const Sample& sample) {
  // The origin follows from the first returns: until it is chosen, one after the other.
  std::size_t part = 0, done = 0;
  while (part < counts.size() && !origin_chosen_) {
    for (done = 0; done < counts[part] && !origin_chosen_; ++done) add(sample(part, done));
    if (done == counts[part]) ++part, done = 0;
  }
  if (part == counts.size()) return;
  std::vector<std::size_t> first(counts.size());
  std::vector<Tally> tallies(counts.size());
  std::size_t end = scan_.points.size();
  for (std::size_t k = part; k < counts.size(); ++k) {
    first[k] = end - (k == part ? done : 0);
    end = first[k] + counts[k];
  }
  grow(end);
  parallel_for(counts.size() - part, [&](std::size_t k) {
    k += part;
    for (std::size_t i = k == part ? done : 0; i < counts[k]; ++i)
      put(first[k] + i, sample(k, i), tallies[k]);
  });
  for (const Tally& tally : tallies) tally_.add(tally);
}

// Whether Scan::exact says no more than the points.
bool holds_the_same(const Scan& scan);

// Whether all values lie between two; NaN does not count.
bool within(const std::vector<float>& values, float least, float greatest);

// Whether a lower-case field name means intensity.
bool names_intensity(const std::string& lower_case_name);

}  // namespace hybrid::io
