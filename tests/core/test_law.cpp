// Laws of one variable: values, slopes and integrals of expressions and tables; what they refuse.
#include "libmbd/core/law.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "libmbd/core/error.hpp"
#include "libmbd/scene/laws.hpp"

namespace mbd::test::test_law {
namespace {

Expression of_x(const std::string& text) { return Expression::parse(text, {}, Variables::x); }

TEST(Law, OfAnExpression) {
  const Law law = Law::of(of_x("100*x + 3000*x^3 + abs(x - 0.1) + (x < 0.2 ? 0 : 50*(x-0.2))"));
  const auto f = [](double x) {
    return 100 * x + 3000 * x * x * x + std::abs(x - 0.1) + (x < 0.2 ? 0.0 : 50 * (x - 0.2));
  };
  const auto df = [](double x) {
    return 100 + 9000 * x * x + (x < 0.1 ? -1 : 1) + (x < 0.2 ? 0.0 : 50.0);
  };
  const auto F = [](double x) {
    const double a = x - 0.1, kink = 0.5 * a * std::abs(a) + 0.005, b = std::max(0.0, x - 0.2);
    return 50 * x * x + 750 * x * x * x * x + kink + 25 * b * b;
  };
  for (const double x : {-0.7, -1e-9, 0.0, 0.05, 0.1, 0.15, 0.3, 2.0}) {
    EXPECT_NEAR(law(x).f, f(x), 1e-12 * std::max(1.0, std::abs(f(x)))) << x;
    EXPECT_NEAR(law(x).df, df(x), 1e-12 * df(x)) << x;
    EXPECT_NEAR(law.integral(x), F(x), 1e-13 * std::max(1.0, F(x))) << x;
  }
  // Not a polynomial, and far: halved until two halves agree.
  const Law wave = Law::of(of_x("sin(40*x)/(1+x^2) + 40*cos(40*x)*atan(x)"));
  for (const double x : {-3.0, 0.01, 7.0})
    EXPECT_NEAR(wave.integral(x), std::sin(40 * x) * std::atan(x), 1e-12) << x;
}

// A narrow peak, of which the first pieces see next to nothing: they were halved by that measure, without an end. In closed form by
// the error function. Before: it hung.
TEST(Law, OfANarrowPeakHasAPotential) {
  const Law law = Law::of(of_x("200*exp(-((x-0.503)/0.001)^2)"));
  for (const double x : {0.45, 0.48, 0.4995, 0.503, 0.504, 0.51, 0.6}) {
    const double s = 100.0 * 1e-3 * std::sqrt(std::acos(-1.0)),
                 F = s * std::erfc((0.503 - x) / 1e-3);
    EXPECT_NEAR(law.integral(x), F, 1e-12 * s + 1e-11 * F) << x;
  }
}

LawScene table(std::vector<std::array<double, 2>> points, bool smooth) {
  return TableScene{{}, std::move(points), smooth ? Interpolation::smooth : Interpolation::linear};
}

TEST(Law, OfALinearTable) {
  const Law law = make_law(table({{-1, -3}, {0.5, 0}, {2, 6}}, false));
  for (const auto& [x, f, df] : {std::array{-3.0, -7.0, 2.0},
                                 {-1.0, -3.0, 2.0},
                                 {0.0, -1.0, 2.0},
                                 {0.5, 0.0, 4.0},
                                 {1.0, 2.0, 4.0},
                                 {5.0, 18.0, 4.0}}) {
    EXPECT_DOUBLE_EQ(law(x).f, f) << x;
    EXPECT_DOUBLE_EQ(law(x).df, df) << x;
  }
  EXPECT_DOUBLE_EQ(law.integral(0.0), 0.0);
  EXPECT_DOUBLE_EQ(law.integral(0.5), -0.25);
  EXPECT_DOUBLE_EQ(law.integral(1.0), 0.25);
  EXPECT_DOUBLE_EQ(law.integral(5.0), -0.25 + 0.5 * 4.5 * 18);
  EXPECT_DOUBLE_EQ(law.integral(-3.0), 3 * (1.0 + 7.0) / 2);
}

// The spline of a cubic is the cubic, and goes on straight beyond its ends.
TEST(Law, OfASmoothTable) {
  const auto f = [](double x) { return 2 * x * x * x - x * x + 5 * x + 1; };
  const auto df = [](double x) { return 6 * x * x - 2 * x + 5; };
  const auto F = [](double x) { return x * x * x * x / 2 - x * x * x / 3 + 2.5 * x * x + x; };
  std::vector<std::array<double, 2>> points;
  for (const double x : {-1.0, -0.4, 0.1, 0.3, 1.2, 2.0}) points.push_back({x, f(x)});
  const Law law = make_law(table(points, true));
  for (const double x : {-1.0, -0.8, 0.0, 0.3, 0.77, 1.9, 2.0}) {
    EXPECT_NEAR(law(x).f, f(x), 1e-12) << x;
    EXPECT_NEAR(law(x).df, df(x), 1e-11) << x;
    EXPECT_NEAR(law.integral(x), F(x), 1e-12) << x;
  }
  EXPECT_NEAR(law(3.0).f, f(2.0) + df(2.0), 1e-11);
  EXPECT_NEAR(law(-2.0).df, df(-1.0), 1e-11);
  EXPECT_NEAR(law.integral(3.0), F(2.0) + f(2.0) + 0.5 * df(2.0), 1e-11);
  // Two points: a line.
  EXPECT_NEAR(make_law(table({{0, 1}, {2, 5}}, true))(7.0).f, 15.0, 1e-12);
}

TEST(Law, InOtherUnits) {
  for (const LawScene& one : {LawScene(of_x("x < 0.1 ? 2*x : 0.2 + sin(x-0.1)")),
                              table({{-1, 0}, {0, 1}, {1, 5}}, true)}) {
    const Law law = make_law(one), other = make_law(scaled_law(one, 1000.0, 0.01));
    for (const double x : {-0.5, 0.05, 0.3, 2.0}) {
      EXPECT_NEAR(other(0.01 * x).f, 1000.0 * law(x).f, 1e-9) << x;
      EXPECT_NEAR(other(0.01 * x).df, 1e5 * law(x).df, 1e-6) << x;
      EXPECT_NEAR(other.integral(0.01 * x), 10.0 * law.integral(x), 1e-10) << x;
    }
  }
}

std::string refusal(const LawScene& law, LawOf of) {
  try {
    check_law(law, of, {}, "spring \"s\"", "force");
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

TEST(Law, Refusals) {
  const auto says = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  EXPECT_EQ(refusal(of_x("x < 0.3 ? 0 : 1e6*(x - (0.1+0.2))"), LawOf::displacement), "none");
  says(refusal(of_x("x < 0.3 ? 1 : 2"), LawOf::displacement), "jumps from 1 to 2 at x = 0.3");
  says(refusal(of_x("1/x"), LawOf::displacement), "finite");
  says(refusal(of_x("sqrt(x)"), LawOf::displacement), "slope inf");
  says(refusal(Expression::parse("3 + v", {}, Variables::v), LawOf::rate), "at v = 0 is 3");
  says(refusal(table({{0, 1}}, false), LawOf::displacement), "two at least");
  says(refusal(table({{0, 1}, {0, 2}}, false), LawOf::displacement), "must rise");
  says(refusal(table({{0, 1}, {1, NAN}}, true), LawOf::displacement), "finite");
  const auto parse = [](const std::string& text, const Parameters& parameters, Variables of) {
    try {
      Expression::parse(text, parameters, of);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  says(parse("2*t", {}, Variables::x), "a law does not vary in time");
  says(parse("2*x", {{"x", 1.0}}, Variables::x), "rename the parameter");
  says(parse("2*v", {}, Variables::x), "unknown name 'v'");
  says(parse("abs(x^2)", {}, Variables::x), "a*x + b");
  says(parse("v*v > 1 ? v : 0", {}, Variables::v), "general function of v");
  EXPECT_EQ(parse("2*x", {{"x", 1.0}}, Variables::time), "none");
}

}  // namespace
}  // namespace mbd::test::test_law
