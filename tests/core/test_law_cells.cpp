// Enclosures of laws of time, and the cells in which they are resolved.

#include "libmbd/core/law_cells.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "libmbd/core/interval.hpp"
#include "libmbd/core/signal.hpp"

namespace mbd::test::test_law_cells {
namespace {

Expression law(const std::string& text) { return Expression::parse(text, {}, Variables::time); }

// Every function, on intervals wide and narrow: f, f' and f''/2 at places inside, from Taylor arithmetic, lie in what is
// said of the interval. Mutation: c[k] of cosine without its sign; w_k of exp without its weight j.
TEST(Enclosure, HoldsValueAndDerivatives) {
  const char* const laws[] = {"3",
                              "2-3*t",
                              "sin(5*t)",
                              "cos(t^2)",
                              "tan(0.3*t)",
                              "asin(0.2*t)",
                              "acos(0.2*t-0.1)",
                              "atan(3*t)",
                              "sinh(t)",
                              "cosh(t-1)",
                              "tanh(4*(t-1))",
                              "exp(-((t-1)/0.3)^2)",
                              "log(t+0.5)",
                              "log10(2*t+1)",
                              "sqrt(t+0.1)",
                              "(t+0.2)^1.5",
                              "(t+0.2)^(-3)",
                              "t^3-t^2",
                              "(1+t)^t",
                              "atan2(sin(t),cos(t))",
                              "atan2(t-1,-1-t)",
                              "t/(1+t^2)",
                              "abs(t-1)*sin(t)",
                              "min(t,1.5)+max(0.2,t)",
                              "t<1?t^2:2-t",
                              "!(t<1)&&t<1.5||t>1.9?t:-t"};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int finite = 0;
  for (const char* const text : laws) {
    const Expression f = law(text);
    for (int trial = 0; trial < 200; ++trial) {
      double a = 2.0 * uniform(random);
      double b = std::min(2.0, a + std::pow(10.0, -6.0 * uniform(random)));
      for (const double t : f.breakpoints())
        if (a < t && t < b) (uniform(random) < 0.5 ? a : b) = t;
      std::array<Interval, 3> c;
      f.enclose(a, b, c);
      for (int k = 0; k <= 4; ++k) {
        const double t = std::lerp(a, b, 0.25 * k);
        const Taylor2 at = f(t, k == 4 ? Side::left : Side::right);
        const double exact[3] = {at.v, at.d, 0.5 * at.dd};
        for (std::size_t i = 0; i < 3; ++i) {
          if (!std::isfinite(exact[i])) continue;
          const double slack = 1e-13 * (1.0 + std::abs(exact[i]));  // of what it is compared with
          EXPECT_GE(exact[i], c[i].lo - slack) << text << " " << i << " at " << t;
          EXPECT_LE(exact[i], c[i].hi + slack) << text << " " << i << " at " << t;
          finite += std::isfinite(c[i].hi - c[i].lo) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(finite, 70'000);  // of 78 000: it does not say "everything" of all
}

// Narrow enclosures are narrow: nothing to be known but round-off. And of higher derivatives: closed forms.
TEST(Enclosure, IsSharpWhereTheIntervalIsShort) {
  const double t = 0.7;
  std::array<Interval, 9> c;
  const auto expect = [&](const std::string& text, const std::array<double, 9>& exact) {
    law(text).enclose(t, t + 1e-13, c);
    for (std::size_t k = 0; k < 9; ++k) {
      EXPECT_NEAR(c[k].lo, exact[k], 1e-9 * (1.0 + std::abs(exact[k]))) << text << " " << k;
      EXPECT_NEAR(c[k].hi, exact[k], 1e-9 * (1.0 + std::abs(exact[k]))) << text << " " << k;
    }
  };
  std::array<double, 9> sine{}, exponential{}, logarithm{}, inverse{}, root{};
  double factorial = 1.0, binomial = 1.0;
  for (std::size_t k = 0; k < 9; ++k) {
    if (k > 0) factorial *= double(k);
    sine[k] = std::sin(3.0 * t + 0.5 * std::numbers::pi * double(k)) * std::pow(3.0, double(k)) /
              factorial;
    exponential[k] = std::exp(-2.0 * t) * std::pow(-2.0, double(k)) / factorial;
    logarithm[k] = k == 0 ? std::log(t) : -std::pow(-1.0 / t, double(k)) / double(k);
    inverse[k] = std::pow(-1.0, double(k)) * std::pow(t, -1.0 - double(k));
    root[k] = binomial * std::pow(t, 0.5 - double(k));
    binomial *= (0.5 - double(k)) / (double(k) + 1.0);
  }
  expect("sin(3*t)", sine);
  expect("exp(-2*t)", exponential);
  expect("log(t)", logarithm);
  expect("1/t", inverse);
  expect("t^(-1)", inverse);
  expect("sqrt(t)", root);
  expect("t^0.5", root);
}

// A pulse of any width, anywhere, on top of anything: cells about it are as narrow as it is, and few.
// Mutation: |R| taken at the middle of a cell in place of its enclosure: nothing is found from 1e-3 on.
TEST(LawCells, FindPulsesHoweverShort) {
  for (const char* const rest : {"0", "5", "sin(t)", "t<40?3:4"})
    for (const double at : {44.375, 50.0, 33.333, 99.99, 1e-3})
      for (const double width : {1.0, 1e-2, 1e-4, 1e-6}) {
        const LawCells cells = find_cells(
            law(fmt::format("({})+2*exp(-((t-{})/{})^2)", rest, at, width)), {}, 0.0, 100.0);
        EXPECT_FALSE(cells.unresolved) << rest << " " << at << " " << width;
        EXPECT_LT(cells.narrowest(at - width, at + width), width) << rest << " " << at;
        EXPECT_LT(cells.count(), 400) << rest << " " << at << " " << width;
        // Five cells and more in it.
        const auto in = [&](double t) {
          return std::lower_bound(cells.ends.begin(), cells.ends.end(), t) - cells.ends.begin();
        };
        if (at + 3.0 * width < 100.0 && at > 3.0 * width) {
          EXPECT_GE(in(at + 2.0 * width) - in(at - 2.0 * width), 5) << rest << " " << width;
        }
      }
}

// What is smooth costs little: a sine 8 cells a period at most, and a polynomial one.
TEST(LawCells, AreFewWhereLawsAreSmooth) {
  EXPECT_EQ(find_cells(law("3*t^2-t"), {}, 0.0, 10.0).count(), 1);
  EXPECT_EQ(find_cells(law("7"), {}, 0.0, 10.0).count(), 1);
  EXPECT_EQ(find_cells(law("0*t"), {}, 0.0, 10.0).count(), 1);
  const std::array both{1, 2};
  EXPECT_EQ(find_cells(law("3*t"), both, 0.0, 10.0).count(), 1);
  for (const double periods : {0.3, 10.0, 1000.0}) {
    const LawCells cells =
        find_cells(law(fmt::format("4*sin(2*pi*{}*t)", periods)), both, 0.0, 1.0);
    EXPECT_LE(cells.count(), 1.0 + 16.0 * periods);
    EXPECT_GE(cells.count(), 4.0 * periods);
  }
  // A breakpoint ends a cell.
  const LawCells cells = find_cells(law("t<3?0:t-3"), {}, 0.0, 10.0);
  EXPECT_EQ(cells.ends, (std::vector<double>{0.0, 3.0, 10.0}));
}

// The second derivative of a drive may have a feature that its value hides.
TEST(LawCells, OfDerivatives) {
  const std::array both{1, 2};
  const Expression hidden = law("t+1e-7*exp(-((t-4)/1e-3)^2)");
  EXPECT_LT(find_cells(hidden, {}, 0.0, 10.0).count(), 20);
  EXPECT_LT(find_cells(hidden, both, 0.0, 10.0).narrowest(3.999, 4.001), 1e-3);
}

TEST(LawCells, SayWhatIsNotResolved) {
  const LawCells fast = find_cells(law("sin(1e9*t)"), {}, 0.0, 100.0, 1000);
  ASSERT_TRUE(fast.unresolved);
  EXPECT_EQ(fast.count(), 1000);
  const LawCells kink = find_cells(law("sqrt((t-pi)^2)"), {}, 0.0, 10.0);  // not of much size
  EXPECT_FALSE(kink.unresolved);
  const LawCells jump = find_cells(law("atan2(sin(t),cos(t))"), {}, 0.0, 5.0);
  ASSERT_TRUE(jump.unresolved);
  EXPECT_NEAR(*jump.unresolved, std::numbers::pi, 1e-7);
  const LawCells pole = find_cells(law("1/(t-1/3)"), {}, 0.0, 1.0);
  ASSERT_TRUE(pole.unresolved);
  EXPECT_NEAR(*pole.unresolved, 1.0 / 3.0, 1e-8);
}

// A rate law, integrated, does not lose a pulse between its samples.
// Mutation: panels not compared with the cells: 0.
TEST(LawCells, OfARateThatIsIntegrated) {
  for (const double at : {44.375, 50.0, 61.7}) {
    const double width = 1e-3;
    const Signal signal =
        Signal::from_rate(law(fmt::format("exp(-((t-{})/{})^2)", at, width)), 0.0, 0.0, 100.0);
    EXPECT_NEAR(signal(100.0).f, width * std::sqrt(std::numbers::pi), 1e-15) << at;
    EXPECT_NEAR(signal(at).f, 0.5 * width * std::sqrt(std::numbers::pi), 1e-15) << at;
  }
}

}  // namespace
}  // namespace mbd::test::test_law_cells
