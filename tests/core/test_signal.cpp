#include "libmbd/core/signal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "libmbd/core/error.hpp"

namespace mbd::test::test_signal {
namespace {

using mbd::Expression;
using mbd::Jump;
using mbd::Side;
using mbd::Signal;
using mbd::SignalValue;
using mbd::Variables;
using Real = long double;

constexpr Real kPi = std::numbers::pi_v<Real>;

Expression in_time(const std::string& text) {
  return Expression::parse(text, {{"omega", 54.0}}, Variables::time);
}

const char* const kFourBarRate = "t<6 ? 0.3*(1-cos(pi*t/6)) : 0.6";
const char* const kShaftRate =
    "t<=0.5 ? 0.4*omega*(1-cos(2*pi*t)) : t<=1 ? 0.8*omega : "
    "t<=1.25 ? 0.8*omega+0.2*omega*(1-cos(pi*(t-1)/0.25)) : 1.2*omega";

Real four_bar_angle(Real t) {
  return t < 6 ? Real(0.3L) * (t - 6 / kPi * std::sin(kPi * t / 6)) : 1.8L + 0.6L * (t - 6);
}

Real shaft_angle(Real t) {
  const Real omega = 54;
  if (t <= 0.5L) return 0.4L * omega * (t - std::sin(2 * kPi * t) / (2 * kPi));
  const Real at_half = 0.4L * omega * 0.5L;
  if (t <= 1) return at_half + 0.8L * omega * (t - 0.5L);
  const Real at_one = at_half + 0.8L * omega * 0.5L;
  const auto ramp = [&](Real s) {
    return 0.8L * omega * s + 0.2L * omega * (s - 0.25L / kPi * std::sin(kPi * s / 0.25L));
  };
  if (t <= 1.25L) return at_one + ramp(t - 1);
  return at_one + ramp(0.25L) + 1.2L * omega * (t - 1.25L);
}

// |f − exact| ≤ tolerance max(1, |exact|) at `count` random times and the ends; f' and f'' against
// the rate itself.
void expect_integral(const std::string& rate, double begin, double end, int count,
                     const std::function<Real(Real)>& exact, Real tolerance = 1e-15L) {
  const Expression r = in_time(rate);
  const Signal f = Signal::from_rate(r, static_cast<double>(exact(begin)), begin, end);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> time(begin, end);
  Real worst = 0;
  for (int i = 0; i < count; ++i) {
    const double t = i == 0 ? begin : i == 1 ? end : time(random);
    const SignalValue value = f(t);
    const Real theta = exact(t);
    worst = std::max(worst, std::abs(value.f - theta) / std::max(Real(1), std::abs(theta)));
    EXPECT_EQ(value.fdot, r(t).v);
    EXPECT_EQ(value.fddot, r(t).d);
  }
  EXPECT_LE(worst, tolerance) << rate;
}

void expect_jump(const Jump& jump, double t, int derivative, double size) {
  EXPECT_EQ(jump.t, t);
  EXPECT_EQ(jump.derivative, derivative);
  EXPECT_NEAR(jump.size, size, 1e-12 * std::abs(size));
}

std::string error_of(const std::string& rate, double begin, double end, double f0 = 0.0) {
  try {
    (void)Signal::from_rate(in_time(rate), f0, begin, end);
  } catch (const mbd::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Signal, IsConstant) {
  const Signal f = Signal::constant(3.5);
  EXPECT_TRUE(f.is_constant());
  EXPECT_EQ(f(1e9).f, 3.5);
  EXPECT_EQ(f(1e9).fdot, 0.0);
  EXPECT_EQ(f(1e9).fddot, 0.0);
  EXPECT_TRUE(f.jumps().empty());
  EXPECT_TRUE(Signal::from_expression(in_time("2*omega")).is_constant());
  EXPECT_FALSE(Signal::from_expression(in_time("2*t")).is_constant());
  EXPECT_FALSE(Signal::from_rate(in_time("1"), 0, 0, 1).is_constant());
}

TEST(Signal, IsAnExpression) {
  const Signal f = Signal::from_expression(in_time("t<2 ? t^2 : 4*t - 4"));
  EXPECT_EQ(f(3.0).f, 8.0);
  EXPECT_EQ(f(2.0, Side::left).fddot, 2.0);
  EXPECT_EQ(f(2.0, Side::right).fddot, 0.0);
  ASSERT_EQ(f.jumps().size(), 1U);
  expect_jump(f.jumps().front(), 2.0, 2, -2.0);
}

TEST(Signal, IntegratesTheFourBarRate) {
  expect_integral(kFourBarRate, 0, 36, 2000, four_bar_angle);
}

TEST(Signal, IntegratesTheShaftRate) { expect_integral(kShaftRate, 0, 2.5, 1000, shaft_angle); }

TEST(Signal, IntegratesClosedForms) {
  const auto square = [](Real x) { return x * x; };
  expect_integral("3", -1, 2, 100, [](Real t) { return 3 * t; });
  expect_integral("2*t", 0, 1e-6, 100, square);
  expect_integral("5*t^4", -2, 2, 500, [](Real t) { return t * t * t * t * t; });
  expect_integral("exp(-t)", 0, 40, 500, [](Real t) { return 1 - std::exp(-t); });
  expect_integral("1/(1+t^2)", -50, 50, 500, [](Real t) { return std::atan(t); });
  expect_integral("1/t", 1e-3, 1, 500, [](Real t) { return std::log(t); });
  expect_integral("cos(t) - t*sin(t)", 0, 100, 500, [](Real t) { return t * std::cos(t); });
  expect_integral("1/cosh(100*(t-1))^2", 0, 3, 500,
                  [](Real t) { return std::tanh(100 * (t - 1)) / 100; });
}

// 16 000 periods. In double the phase, 1e5, would cost 1e-9 of the rate; in long double it costs
// 100·1e5·5e-20 = 5e-13, averaged over the samples.
TEST(Signal, IntegratesALongOscillation) {
  expect_integral(
      "100*cos(100*t)", 0, 1000, 2000, [](Real t) { return std::sin(100 * t); }, 1e-13L);
  expect_integral(
      "1 + cos(20*t + 1e6)", 0, 100, 500,
      [](Real t) { return t + (std::sin(20 * t + 1e6L) - std::sin(1e6L)) / 20; }, 3e-15L);
}

TEST(Signal, IntegratesKinksAndJumps) {
  expect_integral("abs(t-1)", 0, 3, 500,
                  [](Real t) { return t < 1 ? t - t * t / 2 : 0.5L + (t - 1) * (t - 1) / 2; });
  expect_integral("min(2*t, 1)", 0, 3, 500, [](Real t) { return t < 0.5L ? t * t : t - 0.25L; });
  expect_integral("t<1 ? 1 : t<1+1e-9 ? 1e9 : -1", 0, 3, 500, [](Real t) {
    const Real late = 1 + 1e-9;  // in double, as the expression has it
    return t < 1 ? t : t < late ? 1 + 1e9L * (t - 1) : 1 + 1e9L * (late - 1) - (t - late);
  });
  // Kinks that are not declared, and an infinite slope, are found by subdivision.
  expect_integral("sqrt((t-0.3)^2)", 0, 1, 500, [](Real t) {
    const Real s = t - Real(0.3);
    return (s * std::abs(s) + Real(0.3) * Real(0.3)) / 2;
  });
  expect_integral("1.5*sqrt(t)", 0, 1, 500, [](Real t) { return t * std::sqrt(t); });
}

TEST(Signal, IsContinuousAndMonotoneWhereTheRateIsPositive) {
  const Signal f = Signal::from_rate(in_time(kShaftRate), 0.0, 0.0, 2.5);
  for (const double t : {0.5, 1.0, 1.25}) {
    EXPECT_EQ(f(t, Side::left).f, f(t, Side::right).f);
    EXPECT_NEAR(f(std::nextafter(t, 0.0)).f, f(t).f, 2e-14);
  }
  double last = f(0.0).f;
  EXPECT_NEAR(last, 0.0, 1e-20);
  for (int i = 1; i <= 100'000; ++i) {
    const double next = f(2.5e-5 * i).f;
    ASSERT_GE(next, last) << i;
    last = next;
  }
}

// The integral over [a, c] is that over [a, b] continued on [b, c].
TEST(Signal, IsAdditive) {
  const Expression rate = in_time("t<1.3 ? sin(7*t)*exp(-t/3) : 1/(1+t)");
  const Signal whole = Signal::from_rate(rate, 0.25, 0.0, 5.0);
  for (const double b : {0.1, 1.3, 2.0, 4.9}) {
    const Signal rest = Signal::from_rate(rate, whole(b).f, b, 5.0);
    for (double t = b; t <= 5.0; t += 0.01) EXPECT_NEAR(rest(t).f, whole(t).f, 1e-15);
  }
}

TEST(Signal, ListsJumps) {
  // ṙ is continuous at 6, being zero on both sides but for rounding; r̈ is not asked for.
  EXPECT_TRUE(Signal::from_rate(in_time(kFourBarRate), 0, 0, 36).jumps().empty());
  EXPECT_TRUE(Signal::from_rate(in_time(kShaftRate), 0, 0, 2.5).jumps().empty());

  const std::vector<Jump> four_bar = Signal::from_expression(in_time(kFourBarRate)).jumps();
  ASSERT_EQ(four_bar.size(), 1U);
  const double pi = static_cast<double>(kPi);
  expect_jump(four_bar[0], 6.0, 2, 0.3 * pi * pi / 36);

  const std::vector<Jump> all =
      Signal::from_expression(in_time("t<1 ? 0 : t<2 ? (t-1)^2 : t<3 ? 1 + 2*(t-2) : t<4 ? 5 : 5"))
          .jumps();
  ASSERT_EQ(all.size(), 3U);
  expect_jump(all[0], 1.0, 2, 2.0);
  expect_jump(all[1], 2.0, 2, -2.0);
  expect_jump(all[2], 3.0, 0, 2.0);

  const std::vector<Jump> rate =
      Signal::from_rate(in_time("t<1 ? 1 : t<2 ? 3 : 3 + abs(t-2.5)"), 0, 0, 2.25).jumps();
  ASSERT_EQ(rate.size(), 2U);  // the kink at 2.5 is outside
  expect_jump(rate[0], 1.0, 1, 2.0);
  expect_jump(rate[1], 2.0, 1, 0.5);
  const std::vector<Jump> kink = Signal::from_rate(in_time("abs(t-1)"), 0, 0, 2).jumps();
  ASSERT_EQ(kink.size(), 1U);
  expect_jump(kink[0], 1.0, 2, 2.0);

  const std::vector<Jump> infinite =
      Signal::from_expression(in_time("t<1 ? 0 : sqrt(t-1)")).jumps();
  ASSERT_EQ(infinite.size(), 1U);
  EXPECT_EQ(infinite[0].derivative, 1);
  EXPECT_TRUE(std::isinf(infinite[0].size));
}

TEST(Signal, RefusesRatesItCannotIntegrate) {
  const struct {
    const char* rate;
    const char* problem;
  } rows[] = {
      {"sqrt(t-1)", "not finite at t = 0."},
      {"1/(t-1)", "near t = 1"},
      {"1/t", "near t = "},
      {"atan2(sin(t-3), cos(t-3))", "near t = 6.14159"},
      {"1/(1-1/(1+exp(1e13*(1-t))))", "t = "},
      {"cos(1e9*t)", "panels"},
  };
  for (const auto& row : rows) {
    const std::string message = error_of(row.rate, 0, 10);
    EXPECT_NE(message.find(row.problem), std::string::npos) << message;
    EXPECT_NE(message.find(row.rate), std::string::npos) << message;
    EXPECT_NE(message.find(";"), std::string::npos) << message;
  }
}

TEST(Signal, RefusesBadIntervals) {
  const double inf = INFINITY;
  EXPECT_NE(error_of("1", 1, 1).find("[1, 1] s"), std::string::npos);
  EXPECT_NE(error_of("1", 2, 1).find("interval"), std::string::npos);
  EXPECT_NE(error_of("1", 0, inf).find("interval"), std::string::npos);
  EXPECT_NE(error_of("1", NAN, 1).find("interval"), std::string::npos);
  EXPECT_NE(error_of("1", 0, 1, inf).find("initial value"), std::string::npos);
}

TEST(Signal, RefusesTimesOutsideTheInterval) {
  const Signal f = Signal::from_rate(in_time("2"), 1.0, 0.0, 36.0);
  EXPECT_THROW((void)f(-1e-9), mbd::Error);
  EXPECT_THROW((void)f(36.001), mbd::Error);
  EXPECT_THROW((void)f(NAN), mbd::Error);
  double t = 0.0;  // 4000 steps of 0.009 end beyond 36 by rounding
  for (int i = 0; i < 4; ++i) t = std::nextafter(i == 0 ? 36.0 : t, 40.0);
  EXPECT_NEAR(f(t).f, 73.0, 1e-13);
}

TEST(Signal, ReturnsValuesThatAreNotFinite) {
  const Signal f = Signal::from_expression(in_time("1/(t-1)"));
  EXPECT_TRUE(std::isinf(f(1.0).f));
}

}  // namespace
}  // namespace mbd::test::test_signal
