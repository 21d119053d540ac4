#include "core/option_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/suggest.hpp"

namespace hybrid {
namespace {

struct Options {
  double threshold = 0.5;
  int count = 3;
  bool merge = true;
  std::string fit = "ransac";
};

const std::vector<OptionRow<Options>>& table() {
  static const std::vector<OptionRow<Options>> kTable = {
      {"threshold", "m", &Options::threshold, 0, 1, "largest distance", {}},
      {"count", "", &Options::count, 1, 10, "how many", {}},
      {"merge", "", &Options::merge, 0, 0, "join them", {}},
      {"fit", "", &Options::fit, 0, 0, "how planes are fitted", {"ransac", "eigen"}},
  };
  return kTable;
}

void set(Options& options, std::string_view name, const OptionValue& value) {
  set_option(options, *find_option(table(), name), value);
}

std::string reason(std::string_view name, const OptionValue& value) {
  Options options;
  try {
    set(options, name, value);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "accepted";
}

TEST(option_table, sets_and_gets_every_type) {
  Options options;
  set(options, "threshold", 0.25);
  set(options, "count", std::int64_t{10});
  set(options, "merge", false);
  set(options, "fit", std::string("eigen"));
  EXPECT_EQ(options.threshold, 0.25);
  EXPECT_EQ(options.count, 10);
  EXPECT_FALSE(options.merge);
  EXPECT_EQ(options.fit, "eigen");
  EXPECT_EQ(get_option(options, *find_option(table(), "threshold")), OptionValue(0.25));
  EXPECT_EQ(get_option(options, *find_option(table(), "count")), OptionValue(std::int64_t{10}));
  EXPECT_EQ(get_option(options, *find_option(table(), "merge")), OptionValue(false));
  EXPECT_EQ(get_option(options, *find_option(table(), "fit")), OptionValue(std::string("eigen")));
  set(options, "threshold", std::int64_t{1});  // a whole number is a number
  EXPECT_EQ(options.threshold, 1);
}

TEST(option_table, errors_say_what_was_expected_and_found) {
  EXPECT_EQ(reason("threshold", 1.5), "threshold: expected a number from 0 to 1 m, found 1.5");
  EXPECT_EQ(reason("count", 2.0), "count: expected a whole number from 1 to 10, found 2.0");
  EXPECT_EQ(reason("count", std::int64_t{0}), "count: expected a whole number from 1 to 10, found 0");
  EXPECT_EQ(reason("count", std::int64_t{1} << 40),
            "count: expected a whole number from 1 to 10, found 1099511627776");
  EXPECT_EQ(reason("threshold", static_cast<double>(NAN)),
            "threshold: expected a number from 0 to 1 m, found nan");
  EXPECT_EQ(reason("threshold", std::string("x")), "threshold: expected a number from 0 to 1 m, found \"x\"");
  EXPECT_EQ(reason("count", true), "count: expected a whole number from 1 to 10, found true");
  EXPECT_EQ(reason("merge", std::int64_t{1}), "merge: expected true or false, found 1");
  EXPECT_EQ(reason("fit", std::string("eign")), "fit: expected one of ransac, eigen, found \"eign\"");
  EXPECT_EQ(reason("fit", false), "fit: expected a string, found false");
}

TEST(option_table, a_refused_value_changes_nothing) {
  Options options;
  EXPECT_THROW(set(options, "count", std::int64_t{99}), Error);
  EXPECT_EQ(options.count, 3);
}

TEST(option_table, names) {
  EXPECT_EQ(option_names(table()), (std::vector<std::string_view>{"threshold", "count", "merge", "fit"}));
  EXPECT_EQ(find_option(table(), "squares"), nullptr);
}

TEST(suggest, nearest_name_is_a_slip_of_the_pen_away) {
  const std::vector<std::string_view> known = {"square", "score", "levelled", "fov_deg", "up", "fit"};
  EXPECT_EQ(nearest_name("sqaure", known), "square");   // swapped
  EXPECT_EQ(nearest_name("squares", known), "square");  // one too many
  EXPECT_EQ(nearest_name("scor", known), "score");      // one missing
  EXPECT_EQ(nearest_name("leveled", known), "levelled");
  EXPECT_EQ(nearest_name("level", known), "levelled");  // its beginning
  EXPECT_EQ(nearest_name("lev", known), "");
  EXPECT_EQ(nearest_name("ap", known), "");  // half of it would change
  EXPECT_EQ(nearest_name("threshold", known), "");
  EXPECT_EQ(nearest_name("", known), "");
  EXPECT_EQ(nearest_name("x", {}), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), known), "");
}

TEST(suggest, unknown_name_lists_the_known_ones) {
  EXPECT_EQ(unknown_name("key", "squre", {"fit", "square"}),
            "unknown key \"squre\"; did you mean \"square\"? Known: fit, square");
  EXPECT_EQ(unknown_name("view", "front", {"a", "b"}), "unknown view \"front\"; Known: a, b");
}

}  // namespace
}  // namespace hybrid
