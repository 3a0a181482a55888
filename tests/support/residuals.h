#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

/// HANDLOOP_RESIDUALS=1 prints, after each test, the worst residual of every tolerance in it beside its bound; any
/// other value is the name of a file to which the same lines are appended, tab separated (packaging/residuals makes a
/// table of it). Every test sees this header without including it: the floating-point checks of GoogleTest are put
/// behind a recorder here, with the same verdicts and messages.
namespace handloop::test {

/// True where HANDLOOP_RESIDUALS is set to something other than 0.
bool residuals_wanted();

/// One check of a tolerance: `residual` may go up to `bound` (at_most) or down to it.
struct Check {
  const char* file;
  int line;
  std::string what;  ///< as it is written in the test
  double residual, bound;
  bool at_most = true;
};

/// Keeps the worst of each line. From any thread.
void record_residual(Check check);

/// Where a check stands, and GoogleTest's predicate of two or three values with the recorder before it.
class Recorded {
 public:
  Recorded(const char* file, int line) : file_(file), line_(line) {}

 protected:
  void record(std::string what, double residual, double bound, bool at_most = true) const {
    record_residual({file_, line_, std::move(what), residual, bound, at_most});
  }

 private:
  const char* file_;
  int line_;
};

class Near : Recorded {
 public:
  using Recorded::Recorded;
  testing::AssertionResult operator()(const char* a_text, const char* b_text, const char* bound_text, double a,
                                      double b, double bound) const {
    if (residuals_wanted()) record(std::string(a_text) + " = " + b_text, std::abs(a - b), bound);
    return testing::internal::DoubleNearPredFormat(a_text, b_text, bound_text, a, b, bound);
  }
};

class DoubleEqual : Recorded {
 public:
  using Recorded::Recorded;
  testing::AssertionResult operator()(const char* a_text, const char* b_text, double a, double b) const {
    if (residuals_wanted()) {  // GoogleTest allows 4 units in the last place
      const double size = std::max(std::abs(a), std::abs(b));
      record(std::string(a_text) + " = " + b_text, std::abs(a - b),
             4 * (std::nextafter(size, std::numeric_limits<double>::infinity()) - size));
    }
    return testing::internal::CmpHelperFloatingPointEQ<double>(a_text, b_text, a, b);
  }
};

/// Records a comparison where one side is a floating-point number and the other any number.
template <bool at_most>
class Comparison : Recorded {
 public:
  using Recorded::Recorded;

 protected:
  template <class A, class B>
  void compare(const char* a_text, const char* b_text, const char* sign, const A& a, const B& b) const {
    if constexpr (std::is_arithmetic_v<A> && std::is_arithmetic_v<B> &&
                  (std::is_floating_point_v<A> || std::is_floating_point_v<B>)) {
      if (!residuals_wanted()) return;
      record(std::string(a_text).append(sign).append(b_text), static_cast<double>(a), static_cast<double>(b), at_most);
    }
  }
};

#define HANDLOOP_COMPARISON(NAME, HELPER, AT_MOST, SIGN)                                                        \
  class NAME : Comparison<AT_MOST> {                                                                            \
   public:                                                                                                      \
    using Comparison::Comparison;                                                                               \
    template <class A, class B>                                                                                 \
    testing::AssertionResult operator()(const char* a_text, const char* b_text, const A& a, const B& b) const { \
      compare(a_text, b_text, SIGN, a, b);                                                                      \
      return testing::internal::HELPER(a_text, b_text, a, b);                                                   \
    }                                                                                                           \
  }
HANDLOOP_COMPARISON(Less, CmpHelperLT, true, " < ");
HANDLOOP_COMPARISON(LessOrEqual, CmpHelperLE, true, " <= ");
HANDLOOP_COMPARISON(Greater, CmpHelperGT, false, " > ");
HANDLOOP_COMPARISON(GreaterOrEqual, CmpHelperGE, false, " >= ");
#undef HANDLOOP_COMPARISON

}  // namespace handloop::test

#undef EXPECT_NEAR
#undef ASSERT_NEAR
#undef EXPECT_DOUBLE_EQ
#undef EXPECT_LT
#undef ASSERT_LT
#undef EXPECT_LE
#undef ASSERT_LE
#undef EXPECT_GT
#undef ASSERT_GT
#undef EXPECT_GE
#define EXPECT_NEAR(a, b, bound) EXPECT_PRED_FORMAT3(::handloop::test::Near(__FILE__, __LINE__), a, b, bound)
#define ASSERT_NEAR(a, b, bound) ASSERT_PRED_FORMAT3(::handloop::test::Near(__FILE__, __LINE__), a, b, bound)
#define EXPECT_DOUBLE_EQ(a, b) EXPECT_PRED_FORMAT2(::handloop::test::DoubleEqual(__FILE__, __LINE__), a, b)
#define EXPECT_LT(a, b) EXPECT_PRED_FORMAT2(::handloop::test::Less(__FILE__, __LINE__), a, b)
#define ASSERT_LT(a, b) ASSERT_PRED_FORMAT2(::handloop::test::Less(__FILE__, __LINE__), a, b)
#define EXPECT_LE(a, b) EXPECT_PRED_FORMAT2(::handloop::test::LessOrEqual(__FILE__, __LINE__), a, b)
#define ASSERT_LE(a, b) ASSERT_PRED_FORMAT2(::handloop::test::LessOrEqual(__FILE__, __LINE__), a, b)
#define EXPECT_GT(a, b) EXPECT_PRED_FORMAT2(::handloop::test::Greater(__FILE__, __LINE__), a, b)
#define ASSERT_GT(a, b) ASSERT_PRED_FORMAT2(::handloop::test::Greater(__FILE__, __LINE__), a, b)
#define EXPECT_GE(a, b) EXPECT_PRED_FORMAT2(::handloop::test::GreaterOrEqual(__FILE__, __LINE__), a, b)
