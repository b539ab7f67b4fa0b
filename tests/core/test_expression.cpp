#include "libmbd/core/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "libmbd/core/error.hpp"

namespace mbd::test::test_expression {
namespace {

using mbd::Expression;
using mbd::Parameters;
using mbd::Side;
using mbd::Taylor2;
using mbd::Variables;

constexpr double kPi = std::numbers::pi;

const Parameters& parameters() {
  static const Parameters p{{"omega", 54.0}, {"tilt", 5.0}, {"zero", 0.0}, {"span_1", 2.5}};
  return p;
}

Expression in_time(const std::string& text) {
  return Expression::parse(text, parameters(), Variables::time);
}

double constant(const std::string& text) {
  return Expression::parse(text, parameters(), Variables::none).value();
}

std::vector<double> breakpoints(const std::string& text) {
  const Expression e = in_time(text);
  return {e.breakpoints().begin(), e.breakpoints().end()};
}

std::string error_of(const std::string& text, Variables allowed = Variables::time) {
  try {
    (void)Expression::parse(text, parameters(), allowed);
  } catch (const mbd::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Expression, FollowsPrecedenceAndAssociativity) {
  const struct {
    const char* text;
    double value;
  } rows[] = {
      {"1", 1},
      {".5", 0.5},
      {"1.", 1},
      {"1e-3", 1e-3},
      {"2.5E+2", 250},
      {" 1 + 2 * 3 ", 7},
      {"(1+2)*3", 9},
      {"10-4-3", 3},
      {"24/4/2", 3},
      {"24/4*2", 12},
      {"2^3^2", 512},
      {"-2^2", -4},
      {"(-2)^2", 4},
      {"2^-1", 0.5},
      {"2^-3^0", 0.5},
      {"-2^-2", -0.25},
      {"--3", 3},
      {"2--3", 5},
      {"2*-3", -6},
      {"+4", 4},
      {"0^0", 1},
      {"(-8)^3", -512},
      {"1<2 ? 3 : 4", 3},
      {"1>2 ? 3 : 4", 4},
      {"1>2 ? 3 : 2>1 ? 4 : 5", 4},
      {"1<2 ? 1<0 ? 1 : 2 : 3", 2},
      {"1 + (1<2 ? 3 : 4)", 4},
      {"1<2 && 2<3 ? 1 : 0", 1},
      {"1<0 && 2<3 || 3<4 ? 1 : 0", 1},
      {"3<4 || 2<3 && 1<0 ? 1 : 0", 1},
      {"!(1<2) || 1==1 ? 1 : 0", 1},
      {"!1<2 ? 1 : 0", 0},
      {"!!1<2 ? 1 : 0", 1},
      {"1!=1 ? 1 : 0", 0},
      {"2<=2 && 2>=2 ? 1 : 0", 1},
      {"1+1 < 1*3 ? 1 : 0", 1},
      {"5*deg", 5 * kPi / 180},
      {"pi", kPi},
      {"tilt*deg", 5 * kPi / 180},
      {"omega/2 + span_1", 29.5},
      {"sin(tilt*deg)", std::sin(5 * kPi / 180)},
      {"min(1, 2) + max(3, 4)", 5},
      {"abs(-3) + floor(2.7) + ceil(2.2) + round(2.5)", 11},
      {"pow(2, 10)", 1024},
      {"atan2(1, -1)", 0.75 * kPi},
      {"ln(exp(2)) + log(exp(1)) + log10(1000)", 6},
      {"zero > 0 ? 1/zero : 7", 7},
      {"zero > 0 && 1/zero > 3 ? 1 : 7", 7},
      {"zero == 0 || 1/zero > 3 ? 1 : 7", 1},
  };
  for (const auto& row : rows) {
    const double tolerance = 4e-16 * std::abs(row.value);
    EXPECT_NEAR(constant(row.text), row.value, tolerance) << row.text;
  }
}

TEST(Expression, FoldsWhatDoesNotDependOnTime) {
  for (const char* text : {"t - t + 3", "0*t + 3", "1<2 ? 3 : t", "t<1 && 2<1 ? t : 3",
                           "t<1 || 1<2 ? 3 : t", "t < t+1 ? 3 : t", "min(3, 4)"}) {
    const Expression e = in_time(text);
    EXPECT_TRUE(e.is_constant()) << text;
    EXPECT_EQ(e.value(), 3.0) << text;
    EXPECT_TRUE(e.breakpoints().empty()) << text;
  }
  EXPECT_FALSE(in_time("t").is_constant());
  EXPECT_THROW((void)in_time("t").value(), mbd::Error);
  EXPECT_EQ(in_time("2*t").text(), "2*t");
}

// Each function by complex step (f') and 8th-order central differences of the complex step (f'') at
// random times, with arguments that are not linear in t.
TEST(Expression, DifferentiatesEveryFunction) {
  using C = std::complex<double>;
  const auto inner = [](C t) {
    return 0.3 + 0.4 * t - 0.2 * t * t;
  };  // in (-0.1, 0.5) for t in (-0.8, 0.8)
  const std::string x = "(0.3 + 0.4*t - 0.2*t^2)";
  const struct {
    std::string text;
    std::function<C(C)> f;
  } rows[] = {
      {x, [&](C t) { return inner(t); }},
      {"sin" + x, [&](C t) { return std::sin(inner(t)); }},
      {"cos" + x, [&](C t) { return std::cos(inner(t)); }},
      {"tan" + x, [&](C t) { return std::tan(inner(t)); }},
      {"asin" + x, [&](C t) { return std::asin(inner(t)); }},
      {"acos" + x, [&](C t) { return std::acos(inner(t)); }},
      {"atan" + x, [&](C t) { return std::atan(inner(t)); }},
      {"sinh" + x, [&](C t) { return std::sinh(inner(t)); }},
      {"cosh" + x, [&](C t) { return std::cosh(inner(t)); }},
      {"tanh(5*" + x + ")", [&](C t) { return std::tanh(5.0 * inner(t)); }},
      {"exp" + x, [&](C t) { return std::exp(inner(t)); }},
      {"log(1+" + x + ")", [&](C t) { return std::log(1.0 + inner(t)); }},
      {"ln(1+" + x + ")", [&](C t) { return std::log(1.0 + inner(t)); }},
      {"log10(1+" + x + ")", [&](C t) { return std::log10(1.0 + inner(t)); }},
      {"sqrt(1+" + x + ")", [&](C t) { return std::sqrt(1.0 + inner(t)); }},
      {"1/(2-t) + t/" + x + "*" + x, [&](C t) { return 1.0 / (2.0 - t) + t; }},
      {"(t - 2)^3", [&](C t) { return (t - 2.0) * (t - 2.0) * (t - 2.0); }},
      {"(1+" + x + ")^-1.5", [&](C t) { return std::pow(1.0 + inner(t), -1.5); }},
      {"pow(1+" + x + ", 2+t)", [&](C t) { return std::pow(1.0 + inner(t), 2.0 + t); }},
      {"2^sin(t)", [&](C t) { return std::pow(2.0, std::sin(t)); }},
      {"atan2(t-1, 1+" + x + ")", [&](C t) { return std::atan((t - 1.0) / (1.0 + inner(t))); }},
      {"-sin(3*t)*exp(-t)", [&](C t) { return -std::sin(3.0 * t) * std::exp(-t); }},
  };
  std::mt19937 random(1);
  std::uniform_real_distribution<double> time(-0.8, 0.8);
  for (const auto& row : rows) {
    const Expression e = in_time(row.text);
    const auto slope = [&](double t) { return row.f(C(t, 1e-30)).imag() / 1e-30; };
    for (int i = 0; i < 50; ++i) {
      const double t = time(random);
      const Taylor2 value = e(t);
      const double h = 5e-3;
      const double second =
          (672 * (slope(t + h) - slope(t - h)) - 168 * (slope(t + 2 * h) - slope(t - 2 * h)) +
           32 * (slope(t + 3 * h) - slope(t - 3 * h)) - 3 * (slope(t + 4 * h) - slope(t - 4 * h))) /
          (840 * h);
      EXPECT_NEAR(value.v, row.f(t).real(), 1e-14 * (1 + std::abs(value.v))) << row.text;
      EXPECT_NEAR(value.d, slope(t), 3e-14 * (1 + std::abs(value.d))) << row.text;
      EXPECT_NEAR(value.dd, second, 1e-10 * (1 + std::abs(value.dd))) << row.text << " t=" << t;
    }
  }
}

TEST(Expression, AngleHasDerivativesInAllQuadrants) {
  const Expression e = in_time("atan2(sin(3*t + t^2), cos(3*t + t^2))");
  for (double t = 0.01; t < 3; t += 0.05) {
    EXPECT_NEAR(e(t).d, 3 + 2 * t, 1e-13);
    EXPECT_NEAR(e(t).dd, 2, 1e-12);
  }
}

TEST(Expression, PowersAreFiniteAtZero) {
  const struct {
    const char* text;
    Taylor2 at_zero;
  } rows[] = {{"t^0", {1, 0, 0}},
              {"t^1", {0, 1, 0}},
              {"t^2", {0, 0, 2}},
              {"t^3", {0, 0, 0}},
              {"t^2.5", {0, 0, 0}}};
  for (const auto& row : rows) {
    const Taylor2 value = in_time(row.text)(0.0);
    EXPECT_EQ(value.v, row.at_zero.v) << row.text;
    EXPECT_EQ(value.d, row.at_zero.d) << row.text;
    EXPECT_EQ(value.dd, row.at_zero.dd) << row.text;
  }
  EXPECT_FALSE(std::isfinite(in_time("sqrt(t)")(0.0).d));
  EXPECT_TRUE(std::isnan(in_time("sqrt(t)")(-1.0).v));
}

TEST(Expression, TakesTheLimitFromTheSideAskedFor) {
  const Expression e = in_time("t<6 ? 0.3*(1-cos(pi*t/6)) : 0.1*t^2");
  const Taylor2 left = e(6.0, Side::left), right = e(6.0, Side::right);
  EXPECT_NEAR(left.v, 0.6, 1e-15);
  EXPECT_NEAR(left.d, 0.0, 1e-15);
  EXPECT_NEAR(left.dd, -0.3 * kPi * kPi / 36, 1e-15);
  EXPECT_NEAR(right.v, 3.6, 1e-15);
  EXPECT_NEAR(right.d, 1.2, 1e-15);
  EXPECT_NEAR(right.dd, 0.2, 1e-15);
  // A strict and a weak comparison, and all ways to write it, are the same.
  for (const char* text :
       {"t<2 ? 1 : 3", "t<=2 ? 1 : 3", "t>2 ? 3 : 1", "t>=2 ? 3 : 1", "2>t ? 1 : 3", "2<t ? 3 : 1",
        "-t>-2 ? 1 : 3", "3*t+1 < 7 ? 1 : 3", "(1-t)/2 <= -0.5 ? 3 : 1", "!(t<2) ? 3 : 1",
        "2*t < t+2 ? 1 : 3", "t<2 && t<5 ? 1 : 3", "t>2 || t>5 ? 3 : 1"}) {
    const Expression step = in_time(text);
    EXPECT_EQ(step.breakpoints().front(), 2.0) << text;
    EXPECT_EQ(step(2.0, Side::left).v, 1.0) << text;
    EXPECT_EQ(step(2.0, Side::right).v, 3.0) << text;
    EXPECT_EQ(step(std::nextafter(2.0, 0.0)).v, 1.0) << text;
    EXPECT_EQ(step(std::nextafter(2.0, 3.0), Side::left).v, 3.0) << text;
    EXPECT_EQ(step(-1e300).v, 1.0) << text;
    EXPECT_EQ(step(1e300).v, 3.0) << text;
  }
}

TEST(Expression, ListsBreakpoints) {
  using Times = std::vector<double>;
  EXPECT_EQ(breakpoints("sin(t)"), Times{});
  EXPECT_EQ(breakpoints("t<=0.5 ? t : t<=1 ? 0.8*omega : t<=1.25 ? 3 : 4"), (Times{0.5, 1, 1.25}));
  EXPECT_EQ(breakpoints("(t>3 ? 1 : 0) + (t<1 ? 1 : 0) + (t<3 ? 2 : 4)"), (Times{1, 3}));
  EXPECT_EQ(breakpoints("t > omega/2 ? 1 : 2"), (Times{27}));
  EXPECT_EQ(breakpoints("omega > 1 ? (t<1 ? 1 : 2) : (t<3 ? 1 : 2)"), (Times{1}));
  EXPECT_EQ(breakpoints("omega < 1 ? (t<1 ? 1 : 2) : (t<3 ? 1 : 2)"), (Times{3}));
  EXPECT_EQ(breakpoints("abs(2*t - 3)"), (Times{1.5}));
  EXPECT_EQ(breakpoints("max(t, 4 - t)"), (Times{2}));
  EXPECT_EQ(breakpoints("min(t, t + 4)"), Times{});
  // Equal but for rounding: one breakpoint, and no gap between the pieces.
  const Expression e = in_time("(t < 0.3 ? 1 : 0) + (t < 0.1+0.2 ? 0 : 1)");
  ASSERT_EQ(e.breakpoints().size(), 1U);
  for (const double t : {0.3, 0.1 + 0.2}) {
    EXPECT_EQ(e(t, Side::left).v, 1.0);
    EXPECT_EQ(e(t, Side::right).v, 1.0);
  }
}

TEST(Expression, ResolvesKinks) {
  const struct {
    const char* text;
    std::function<double(double)> f;
    double kink, left, right;  // slopes
  } rows[] = {
      {"abs(t-1)", [](double t) { return std::abs(t - 1); }, 1, -1, 1},
      {"abs(3-2*t)", [](double t) { return std::abs(3 - 2 * t); }, 1.5, -2, 2},
      {"min(t, 1)", [](double t) { return std::min(t, 1.0); }, 1, 1, 0},
      {"max(t, 1)", [](double t) { return std::max(t, 1.0); }, 1, 0, 1},
      {"min(2-t, t/2)", [](double t) { return std::min(2 - t, t / 2); }, 4.0 / 3, 0.5, -1},
      {"max(2-t, t/2)", [](double t) { return std::max(2 - t, t / 2); }, 4.0 / 3, -1, 0.5},
  };
  for (const auto& row : rows) {
    const Expression e = in_time(row.text);
    EXPECT_EQ(e(row.kink, Side::left).d, row.left) << row.text;
    EXPECT_EQ(e(row.kink, Side::right).d, row.right) << row.text;
    for (double t = -5; t < 5; t += 0.17) EXPECT_NEAR(e(t).v, row.f(t), 1e-15) << row.text;
  }
  EXPECT_EQ(in_time("min(t+1, t+2)^2")(1.0).v, 4.0);
  EXPECT_EQ(in_time("max(t+1, t+2)^2")(1.0).v, 9.0);
  EXPECT_EQ(in_time("5 - abs(t)*2")(-2.0).v, 1.0);
}

// Every message: expression, column, what was found, what was expected, remedy.
TEST(Expression, RefusesBadInput) {
  const struct {
    const char* text;
    int column;
    const char* found;
    const char* remedy;
  } rows[] = {
      {"", 1, "the end", "give a value"},
      {"  ", 3, "the end", "give a value"},
      {"1 +", 4, "the end", "complete"},
      {"1 + * 2", 5, "'*'", "give a value"},
      {"sin(2*t", 8, "the end", "opened at column 4"},
      {"(1 + 2", 7, "the end", "opened at column 1"},
      {"1 + 2)", 6, "')'", "open a parenthesis"},
      {"2 t", 3, "'t'", "write *"},
      {"2pi", 2, "'pi'", "write *"},
      {"5deg", 2, "'deg'", "write *"},
      {"2(t+1)", 2, "'('", "write *"},
      {"t(2)", 2, "'('", "write *"},
      {"1.5.2", 4, "'.2'", "write *"},
      {"1,5", 2, "','", "decimal sign is a point"},
      {"sin(1,5)", 6, "one argument too many", "decimal sign"},
      {"sin()", 5, "no argument", "give the arguments"},
      {"atan2(1)", 8, "one argument", "second"},
      {"atan2(1;2)", 8, "';'", "remove it"},
      {"sin t", 5, "'t'", "write sin(x)"},
      {"sin", 4, "the end", "write sin(x)"},
      {"2**3", 2, "'**'", "write ^"},
      {"2 % 3", 3, "'%'", "remainder"},
      {"[1]", 1, "'['", "group with"},
      {"1 − 2", 3, "'−'", "write -"},
      {"2·t", 2, "'·'", "write *"},
      {"2*π", 3, "'π'", "write pi"},
      {"30°", 3, "'°'", "*deg"},
      {"π² + $", 1, "'π'", "write pi"},
      {"1 − $", 3, "'−'", "write -"},
      {"1 + \x01", 5, "control character 1", "remove it"},
      {"1e999", 1, "'1e999'", "other units"},
      {"omga*2", 1, "unknown name 'omga'", "did you mean 'omega'?"},
      {"1+Sin(2)", 3, "unknown name 'Sin'", "did you mean 'sin'?"},
      {"sqr(2)", 1, "unknown name 'sqr'", "did you mean 'sqrt'?"},
      {"itlt", 1, "unknown name 'itlt'", "did you mean 'tilt'?"},
      {"blabla", 1, "unknown name",
       "parameters omega, span_1, tilt, zero; constants pi, deg; the time t"},
      {"t < 1", 1, "a condition", "condition ? value : value"},
      {"1 + (t < 1)", 5, "a condition", "condition ? value : value"},
      {"sin(t<1)", 5, "a condition", "condition ? value : value"},
      {"t ? 1 : 2", 1, "a number", "compare it"},
      {"t < 1 && t ? 1 : 2", 10, "a number", "compare it"},
      {"!t ? 1 : 2", 2, "a number", "compare it"},
      {"t<1 ? 2", 8, "the end", "condition ? value : value"},
      {"t<1 ? 2 3", 9, "'3'", "write *"},
      {"t<1 : 2", 5, "':'", "condition ? value : value"},
      {"0 < t < 1 ? 1 : 2", 7, "a second comparison", "&&"},
      {"t = 1 ? 1 : 2", 3, "'='", "=="},
      {"t == 1 ? 1 : 2", 3, "'==' in t", "with < or >"},
      {"t != 1 ? 1 : 2", 3, "'!=' in t", "with < or >"},
      {"t<1 & t>0 ? 1 : 2", 5, "'&'", "&&"},
      {"t<1 | t>0 ? 1 : 2", 5, "'|'", "||"},
      {"sin(t) < 0.5 ? 1 : 2", 8, "general function of t", "switching time"},
      {"1 < t^2 ? 1 : 2", 3, "general function of t", "switching time"},
      {"abs(sin(t))", 5, "abs of a general function", "t < t1 ?"},
      {"max(0, sin(t))", 8, "max of a general function", "t < t1 ?"},
      {"min(1, min(t, 2))", 8, "min of a general function", "t < t1 ?"},
      {"floor(t)", 7, "floor of a function of t", "t < t1 ?"},
      {"1/0", 2, "1 / 0 = inf", "exclude them"},
      {"0/0", 2, "0 / 0 = ", "exclude them"},
      {"2*sqrt(-1)", 3, "sqrt(-1) = ", "exclude them"},
      {"log(zero)", 1, "log(0) = -inf", "exclude them"},
      {"pow(-2, 0.5)", 1, "pow(-2, 0.5) = ", "exclude them"},
      {"t/zero", 2, "a division by zero", "exclude them"},
      {"t<1 ? t : 1/0", 12, "1 / 0 = inf", "exclude them"},
      {"1/0 < 2 ? 1 : 2", 2, "1 / 0 = inf", "exclude them"},
      {"0/(1/0)", 5, "1 / 0 = inf", "exclude them"},
      {"!(1/0 < t) && t<1 ? 1 : 2", 4, "1 / 0 = inf", "exclude them"},
      {"1e308*10", 6, "1e+308 * 10 = inf", "exclude them"},
  };
  for (const auto& row : rows) {
    const std::string message = error_of(row.text);
    const std::string column = "column " + std::to_string(row.column) + ": found ";
    EXPECT_NE(message.find("expression \""), std::string::npos) << message;
    EXPECT_NE(message.find(column), std::string::npos) << row.text << "\n  " << message;
    EXPECT_NE(message.find(row.found), std::string::npos) << row.text << "\n  " << message;
    EXPECT_NE(message.find(", expected "), std::string::npos) << row.text << "\n  " << message;
    const std::size_t remedy = message.find("; ");
    ASSERT_NE(remedy, std::string::npos) << row.text << "\n  " << message;
    EXPECT_NE(message.find(row.remedy, remedy), std::string::npos) << row.text << "\n  " << message;
  }
}

TEST(Expression, RefusesTimeWhereItIsNotAllowed) {
  const std::string message = error_of("2*t", Variables::none);
  EXPECT_NE(message.find("column 3: found the time t, expected a constant"), std::string::npos)
      << message;
  EXPECT_EQ(error_of("blabla", Variables::none).find("the time"), std::string::npos);
}

TEST(Expression, RefusesParametersThatHideNamesOrAreNotFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const char* name : {"t", "pi", "deg", "sin", "ln"}) {
    EXPECT_TRUE(Expression::is_reserved(name));
    EXPECT_THROW((void)Expression::parse(name, {{name, 1.0}}, Variables::time), mbd::Error);
  }
  EXPECT_FALSE(Expression::is_reserved("omega"));
  EXPECT_THROW((void)Expression::parse("x", {{"x", inf}}, Variables::none), mbd::Error);
  EXPECT_EQ(Expression::parse("0>1 ? x : 2", {{"x", inf}}, Variables::none).value(), 2.0);
}

std::string repeated(const std::string& part, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += part;
  return text;
}

TEST(Expression, LimitsNestingAndLength) {
  const auto parentheses = [](int n) { return repeated("(", n) + "t" + repeated(")", n); };
  const auto calls = [](int n) { return repeated("sin(", n) + "t" + repeated(")", n); };
  EXPECT_EQ(error_of(parentheses(200)), "no error");
  EXPECT_EQ(error_of(calls(200)), "no error");
  for (const std::string& text :
       {parentheses(201), calls(201), parentheses(40'000), repeated("-", 50'000) + "1",
        repeated("!", 50'000) + "1<2 ? 1 : 2", repeated("2^", 40'000) + "1",
        repeated("t<1 ? ", 9'000) + "1" + repeated(" : 2", 9'000)}) {
    const std::string message = error_of(text);
    EXPECT_NE(message.find("more than 200 levels"), std::string::npos) << message.substr(0, 300);
  }
  EXPECT_NE(error_of(std::string(100'001, ' ')).find("at most 100000"), std::string::npos);
  EXPECT_LT(error_of(std::string(90'000, 'x')).size(), 1000U);
  // Many pending values, without much nesting by themselves.
  const std::string pending =
      error_of(repeated("1 - t*(t<1 ? t : t + t*(1 + t^(", 45) + "t" + repeated(")))", 45));
  EXPECT_NE(pending.find("pending values"), std::string::npos) << pending;
}

TEST(Expression, TakesLongSumsAndTables) {
  const Expression sum = in_time("t" + repeated("+t", 40'000));
  EXPECT_EQ(sum(1.0).v, 40'001.0);
  std::string table;
  for (int i = 0; i < 5000; ++i) {
    table += "t<" + std::to_string(i) + "?" + std::to_string(2 * i) + ":";
  }
  const Expression steps = in_time(table + "t");
  EXPECT_EQ(steps.breakpoints().size(), 5000U);
  EXPECT_EQ(steps(1234.5).v, 2470.0);
  EXPECT_EQ(steps(1234.0, Side::left).v, 2468.0);
  EXPECT_EQ(steps(1234.0, Side::right).v, 2470.0);
  EXPECT_EQ(steps(5000.0).v, 5000.0);
}

// Random expressions, written with all parentheses, against direct evaluation of the same tree; and
// the same text with spaces.
class RandomExpression {
 public:
  explicit RandomExpression(unsigned seed) : random_(seed) {}

  struct Tree {
    std::string text;
    std::function<Taylor2(double)> f;
  };

  Tree make(int depth) {
    const int kind = depth == 0 ? pick(2) : 2 + pick(6);
    if (kind == 0) return {"t", [](double t) { return Taylor2{t, 1, 0}; }};
    if (kind == 1) {
      const double c = 0.25 * (1 + pick(20));
      return {std::to_string(c), [c](double) { return Taylor2{c, 0, 0}; }};
    }
    const Tree x = make(depth - 1);
    if (kind == 2) return {"sin(" + x.text + ")", [x](double t) { return sin(x.f(t)); }};
    if (kind == 3) return {"-" + x.text, [x](double t) { return -x.f(t); }};
    const Tree y = make(depth - 1);
    if (kind == 4)
      return {"(" + x.text + " + " + y.text + ")", [=](double t) { return x.f(t) + y.f(t); }};
    if (kind == 5)
      return {"(" + x.text + " - " + y.text + ")", [=](double t) { return x.f(t) - y.f(t); }};
    if (kind == 6)
      return {"(" + x.text + ")*(" + y.text + ")", [=](double t) { return x.f(t) * y.f(t); }};
    const double c = 0.5 * pick(8);
    return {"(t < " + std::to_string(c) + " ? " + x.text + " : " + y.text + ")",
            [=](double t) { return t < c ? x.f(t) : y.f(t); }};
  }

 private:
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  std::mt19937 random_;
};

TEST(Expression, AgreesWithDirectEvaluationOfRandomTrees) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const auto tree = RandomExpression(seed).make(1 + static_cast<int>(seed % 6));
    const Expression e = in_time(tree.text);
    for (const double t : {-0.3, 0.77, 1.5, 2.3, 3.9}) {
      const Taylor2 a = e(t), b = tree.f(t);
      const auto tolerance = [](double x) { return 1e-11 * (1 + std::abs(x)); };
      EXPECT_NEAR(a.v, b.v, tolerance(b.v)) << tree.text;
      EXPECT_NEAR(a.d, b.d, tolerance(b.d)) << tree.text;
      EXPECT_NEAR(a.dd, b.dd, tolerance(b.dd)) << tree.text;
    }
  }
}

// Any bytes give a value or an Error, never anything else.
TEST(Expression, SurvivesRandomText) {
  const std::vector<std::string> parts{"t",    "1", "2.5",  "(",    ")",    "+",     "-",     "*",
                                       "/",    "^", "<",    ">=",   "==",   "!",     "&&",    "||",
                                       "?",    ":", ",",    "sin(", "min(", "omega", " ",     "x",
                                       "\xff", "−", "abs(", ".",    "e",    "1e",    "atan2("};
  std::mt19937 random(7);
  std::uniform_int_distribution<std::size_t> part(0, parts.size() - 1), length(1, 15);
  int valid = 0;
  for (int i = 0; i < 50'000; ++i) {
    std::string text;
    for (std::size_t n = length(random); n > 0; --n) text += parts[part(random)];
    try {
      (void)in_time(text)(0.5);
      ++valid;
    } catch (const mbd::Error&) {
    }
  }
  EXPECT_GT(valid, 100);
}

TEST(Expression, IsEvaluatedByManyThreads) {
  const Expression e = in_time("t<1 ? sin(3*t) : abs(t-2)*exp(-t)");
  std::vector<std::thread> threads;
  std::vector<double> sums(4, 0.0);
  for (double& sum : sums) {
    threads.emplace_back([&] {
      for (int i = 0; i < 10'000; ++i) sum += e(3e-4 * i).v;
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const double sum : sums) EXPECT_EQ(sum, sums.front());
}

TEST(Expression, SumsAndStretchesLaws) {
  const Parameters given{{"a", 2.0}};
  const Expression x = Expression::parse("t < 3 ? a*t^2 : 9*a + min(t, 5)", given, Variables::time);
  const Expression y = Expression::parse("sin(a*t)*exp(-t)", given, Variables::time);
  const Expression z = Expression::parse("7", given, Variables::time);
  const Expression::Term terms[] = {{0.5, &x}, {-2.0, &y}, {1.0, &z}, {0.0, &y}};
  for (const double stretch : {1.0, 1e-3, 250.0}) {
    const Expression sum = Expression::sum(terms, stretch);
    const std::vector<double> at(sum.breakpoints().begin(), sum.breakpoints().end());
    ASSERT_EQ(at.size(), 2U);
    EXPECT_DOUBLE_EQ(at[0], 3.0 * stretch);
    EXPECT_DOUBLE_EQ(at[1], 5.0 * stretch);
    for (const double t : {0.0, 1.3, 3.0, 4.2, 5.0, 7.7})
      for (const Side side : {Side::left, Side::right}) {
        const Taylor2 s = sum(t == 3.0 ? at[0] : t == 5.0 ? at[1] : t * stretch, side);
        const Taylor2 X = x(t, side), Y = y(t, side);
        EXPECT_NEAR(s.v, 0.5 * X.v - 2.0 * Y.v + 7.0, 1e-13);
        EXPECT_NEAR(s.d * stretch, 0.5 * X.d - 2.0 * Y.d, 1e-12);
        EXPECT_NEAR(s.dd * stretch * stretch, 0.5 * X.dd - 2.0 * Y.dd, 1e-12);
      }
  }
  const Expression::Term constants[] = {{3.0, &z}, {-1.0, &z}};
  EXPECT_TRUE(Expression::sum(constants, 2.0).is_constant());
  EXPECT_EQ(Expression::sum(constants, 2.0).value(), 14.0);
  EXPECT_EQ(Expression::sum({}).value(), 0.0);
  EXPECT_THROW(Expression::sum(terms, 0.0), Error);
}

// A law of what stands beside sensors and inputs.
TEST(Expression, HeldAt) {
  Parameters parameters;
  parameters.inputs["u"] = {};
  const Expression law =
      Expression::parse("sin(t)*(1+a.rate)+2*u-t*a.rate", parameters, Variables::time);
  ASSERT_TRUE(law.has_sensors());
  ASSERT_TRUE(law.has_inputs());
  const Expression held = law.held_at(3.0, 0.5);
  EXPECT_FALSE(held.has_sensors());
  EXPECT_FALSE(held.has_inputs());
  EXPECT_NEAR(held(0.7).v, 4.0 * std::sin(0.7) + 2.0 * 0.5 * 0.77 - 2.1, 1e-15);
  EXPECT_NEAR(held(0.7).d, 4.0 * std::cos(0.7) - 3.0, 1e-15);
}

// Two sensors do not read the same.
TEST(Expression, HeldDifferencesAreNotZero) {
  const Expression held =
      Expression::parse("(a.rate-b.rate)*(1+t)", {}, Variables::time).held_at(1.0, 1.0);
  EXPECT_GT(std::abs(held(0.0).v), 0.1);
}

// Functions that call others twice are read 2^n times: refused before that takes time or memory.
TEST(Expression, ChainsOfFunctionsEnd) {
  Parameters parameters;
  const auto shared = std::make_shared<Parameters>();
  shared->functions["f0"] = {std::make_shared<std::string>("t"), std::make_shared<Parameters>(),
                             1.0};
  parameters = *shared;
  for (int k = 1; k <= 40; ++k) {
    const auto text = std::make_shared<std::string>("f" + std::to_string(k - 1) + "(t)*f" +
                                                    std::to_string(k - 1) + "(t+1)");
    parameters.functions["f" + std::to_string(k)] = {text, std::make_shared<Parameters>(parameters),
                                                     1.0};
  }
  EXPECT_NO_THROW(Expression::parse("f8(t)", parameters, Variables::time));
  try {
    Expression::parse("f40(t)", parameters, Variables::time);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("calls of functions in one law"), std::string::npos)
        << error.what();
  }
}

// Of the place along a beam at an instant, which is a parameter there; time and sensors it does not know.
TEST(Expression, OfThePlaceAtAnInstant) {
  Parameters at = parameters();
  at["t"] = 2.0;
  const Expression e = Expression::parse("s<0.25 ? t*s : omega*s^2", at, Variables::place);
  EXPECT_DOUBLE_EQ(e(0.125).v, 0.25);
  EXPECT_DOUBLE_EQ(e(0.125).d, 2.0);
  EXPECT_DOUBLE_EQ(e(0.5).v, 13.5);
  ASSERT_EQ(e.breakpoints().size(), 1U);
  EXPECT_EQ(e.breakpoints()[0], 0.25);
  EXPECT_NE(error_of("s*arm.angle", Variables::place).find("sensor"), std::string::npos);
  EXPECT_NE(error_of("s*t", Variables::place), "no error");  // of no instant
}

// A law of sensors as a function of one of them, with the slope that derivative() has.
TEST(Expression, OfOneOfItsSensors) {
  const Expression law =
      Expression::parse("2*b.rate*exp(-a.angle^2)+omega*t", parameters(), Variables::time);
  const std::vector<double> readings{0.3, 0.7};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::optional<Expression> of = law.of_sensor(k, readings, 0.1);
    ASSERT_TRUE(of);
    EXPECT_TRUE(of->sensors().empty());
    const Taylor2 x = (*of)(readings[k]);
    EXPECT_DOUBLE_EQ(x.v, law(0.1, Side::right, {}, readings).v);
    EXPECT_DOUBLE_EQ(x.d, law.derivative(k, 0.1, Side::right, {}, readings));
  }
  // What switches in time is another function before and after.
  EXPECT_FALSE(Expression::parse("t<1 ? a.angle : 0", parameters(), Variables::time)
                   .of_sensor(0, std::vector<double>{0.0}, 0.0));
}

}  // namespace
}  // namespace mbd::test::test_expression
