#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace hybrid {

// The known name nearest to `name` by edit distance (insert, delete, replace, swap neighbours), or "" when
// none is near enough to be a slip of the pen: more than a third of the longer name would have to change.
std::string_view nearest_name(std::string_view name, const std::vector<std::string_view>& known);

// `unknown key "squre"; did you mean "square"? Known: fit, square` with `what` = "key". Every reader that
// rejects a name tells the names it knows in this form.
std::string unknown_name(std::string_view what, std::string_view name,
                         const std::vector<std::string_view>& known);

// "a, b, c and 4 more": the first three.
std::string some_of(const std::vector<std::string>& names);

}  // namespace hybrid
