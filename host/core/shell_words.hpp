#pragma once
#include <string>
#include <vector>

namespace hybrid {

// Words as one types them into a shell: quoted where they hold more than letters, digits and the like.
std::string as_typed(const std::vector<std::string>& words);

// The command that started this process.
std::string own_command();

}  // namespace hybrid
