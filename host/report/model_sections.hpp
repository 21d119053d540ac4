#pragma once
#include <string>

#include "report/html.hpp"
#include "report/previews.hpp"

namespace hybrid::report {

// Sections of a scene's page, each empty where the run has nothing of it.

// What [edit] changed: faces, holes, openings found and cut, displacement maps, clips and moved depths.
std::string edit_section(Previews& previews, const Json& summary);

// Whether photographs agree with each other, their gains, and the landmarks that placed their cameras.
std::string photograph_section(const Json& summary);

// What no photograph sees, face by face, and where to stand for more.
std::string coverage_section(const Json& summary);

// The files of DIR/export/, with what was left out of them.
std::string export_section(Previews& previews, const Json& summary);

}  // namespace hybrid::report
