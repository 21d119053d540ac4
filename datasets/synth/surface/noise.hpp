#pragma once
#include <cstdint>

namespace synth {

double hash01(std::int64_t i, std::int64_t j, std::uint64_t key);  // [0, 1), fixed for a lattice cell

// Sum of value noise, -1..1, halving wavelength and weight per octave. Octaves too fine for the footprint
// fade out: what a pixel would average away.
double fractal_noise(double x, double y, double wavelength, int octaves, double footprint, std::uint64_t key);

// Exact box filters of width `footprint`, so that edges and thin lines neither alias nor vanish.
double cover(double x, double low, double high, double footprint);  // share inside [low, high]
double stripes(double x, double period, double width,
               double footprint);                         // share inside [0, width) + k period
double inside(double signed_distance, double footprint);  // 1 where the distance is negative

}  // namespace synth
