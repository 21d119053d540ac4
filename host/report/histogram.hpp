#pragma once
#include <string>

#include "report/html.hpp"

namespace hybrid::report {

// "residuals" of a registration in summary.json as an inline SVG plot: samples per step of the distance to
// the model, in steps that grow by a factor.
std::string residual_plot(const Json& residuals);

}  // namespace hybrid::report
