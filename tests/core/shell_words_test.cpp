#include "core/shell_words.hpp"

#include <gtest/gtest.h>

namespace hybrid {

TEST(ShellWords, are_quoted_where_a_shell_would_take_them_for_something_else) {
  EXPECT_EQ(as_typed({"hybrid", "run", "a/scene.toml", "--set", "render.blend=dual"}),
            "hybrid run a/scene.toml --set render.blend=dual");
  EXPECT_EQ(as_typed({"it's", "a b", "", "$HOME", "*"}), "'it'\\''s' 'a b' '' '$HOME' '*'");
}

}  // namespace hybrid
