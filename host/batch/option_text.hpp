#pragma once
#include <string>
#include <vector>

#include "batch/stage_options.hpp"

namespace hybrid::batch {

// As a scene file may have them: sections of keys with their defaults, what each takes and does in the
// comment before it. Keys whose default is another key's are comments, too: all of it in a scene file changes
// nothing.
std::string option_text(const std::vector<OptionNote>& notes);

// An array of objects: section, key, default, and as the key has them unit, least, most, choices, help.
nlohmann::ordered_json option_json(const std::vector<OptionNote>& notes);

}  // namespace hybrid::batch
