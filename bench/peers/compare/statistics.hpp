#pragma once
#include <string>
#include <vector>

namespace hybrid::compare {

// Of an even count the mean of the middle two; throws std::invalid_argument on none.
double median(std::vector<double> values);

struct Sized {
  double samples, value;
};

// What `samples` would take, from the sizes that were run (ascending): in proportion to the samples from the
// largest one, or along the last two sizes' own power law where that grows faster, up to the square. Throws
// std::invalid_argument without a size.
double extrapolate(const std::vector<Sized>& known, double samples);

// "12.3", three significant digits, no exponent; "-" for what is not finite.
std::string three_digits(double value);

// How many times as long as ours: "3.4 x"; "-" where ours is 0.
std::string ratio_text(double seconds, double ours_s);

}  // namespace hybrid::compare
