#pragma once
#include <string>

namespace synth {

// 1 where the letters are ink: `text` set in one line, 5 x 7 dots a letter plus one of space, in a box of
// width_m x height_m from (0, 0); letters keep their shape and are centred.
double lettering(const std::string& text, double u, double v, double width_m, double height_m,
                 double footprint);

}  // namespace synth
