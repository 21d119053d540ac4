#pragma once
#include <string>
#include <vector>

#include "geometry/scan.hpp"

namespace hybrid::io {

// The shortest decimal that is this number again.
void append_number(std::string& text, double value);
void append_number(std::string& text, float value);
// "x y z", the shortest decimals that a reader turns into the same sample: where the scan has an origin, of
// that sum no more digits than the sample has. Of exact coordinates the shortest that are the same double, or
// the same whole number of the file's steps. A no-return is "0 0 0".
void append_point(std::string& text, const Scan& scan, std::size_t sample);
void append_colour(std::string& text, const std::array<std::uint8_t, 3>& rgb);  // " r g b"

// How many samples lie on the grid: others are further returns of a node, or lie beside a range image;
// unorganised, all.
std::size_t laid_out(const Scan& scan);
// The sample at each place of a grid, Scan::kNoNode where there is none.
class GridSamples {
 public:
  explicit GridSamples(const Scan& scan);
  std::uint32_t at(int row, int col) const;

 private:
  const Scan& scan_;
  std::vector<std::uint32_t> sample_;  // by node, where the samples are not one per node in order
};
// The indices of samples with a finite point.
std::vector<std::uint32_t> returns_of(const Scan& scan);
bool is_return(const std::array<float, 3>& point);

}  // namespace hybrid::io
