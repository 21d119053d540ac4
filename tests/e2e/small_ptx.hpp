#pragma once
#include <string>

namespace hybrid::e2e {

// A PTX file of 2 x 2 points with intensities and colours.
inline const std::string kHeader = "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";
inline const std::string kPoints =
    "1 2 3.5 0.25 1 2 3\n0 0 0 0.5 0 0 0\n-1 2 3 0.75 4 5 6\n1.125 2 3 1 7 8 9\n";

}  // namespace hybrid::e2e
