#include "core/error.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace hybrid {
namespace {

TEST(error, context_stands_outermost_first) {
  try {
    with_context("scene church",
                 [] { with_context("scan west.e57", [] { fail_input("page {}: CRC mismatch", 33); }); });
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "scene church: scan west.e57: page 33: CRC mismatch");
    EXPECT_EQ(error.kind(), ErrorKind::input);
  }
}

TEST(error, foreign_exceptions_become_failures_with_context) {
  try {
    with_context("stage", [] { throw std::runtime_error("library said no"); });
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "stage: library said no");
    EXPECT_EQ(error.kind(), ErrorKind::failed);
  }
}

TEST(error, context_passes_results_through) {
  EXPECT_EQ(with_context("x", [] { return 7; }), 7);
  EXPECT_NO_THROW(with_context("x", [] {}));
}

TEST(error, every_kind_has_its_documented_exit_code) {
  EXPECT_EQ(exit_code(ErrorKind::failed), 1);
  EXPECT_EQ(exit_code(ErrorKind::usage), 2);
  EXPECT_EQ(exit_code(ErrorKind::input), 4);
  EXPECT_EQ(exit_code(ErrorKind::device), 5);
  EXPECT_EQ(exit_code(ErrorKind::temporary), 75);
  EXPECT_EQ(exit_code(ErrorKind::interrupted), 130);
}

}  // namespace
}  // namespace hybrid
