#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libmbd/core/interval.hpp"
#include "libmbd/core/opcode.hpp"

// Truncated power series over intervals: u(t + s) = u_0 + u_1 s + u_2 s^2 + …. Of w = f(u) the recurrences follow from
// a differential equation of f, e.g. w' = u' w for exp: k w_k = sum_j j u_j w_{k-j}.
namespace mbd {
namespace {

using namespace interval;

constexpr std::size_t most = Expression::most_coefficients;
using Series = std::array<Interval, most>;

struct Calculator {
  std::size_t n;  // coefficients in use

  Series constant(double x) const {
    Series c{};
    c[0] = point(x);
    return c;
  }
  Series add(const Series& x, const Series& y) const {
    Series c{};
    for (std::size_t k = 0; k < n; ++k) c[k] = x[k] + y[k];
    return c;
  }
  Series negative(const Series& x) const {
    Series c{};
    for (std::size_t k = 0; k < n; ++k) c[k] = -x[k];
    return c;
  }
  Series scaled(double a, const Series& x) const {
    Series c{};
    for (std::size_t k = 0; k < n; ++k) c[k] = a * x[k];
    return c;
  }
  Interval product(const Series& x, const Series& y, std::size_t k) const {
    Interval sum;
    for (std::size_t j = 0; j <= k; ++j) sum = sum + x[j] * y[k - j];
    return sum;
  }
  Series multiply(const Series& x, const Series& y) const {
    Series c{};
    for (std::size_t k = 0; k < n; ++k) c[k] = product(x, y, k);
    return c;
  }
  static Interval square(const Interval& x) {
    const double largest = magnitude(x) * magnitude(x);
    const double near = std::min(std::abs(x.lo), std::abs(x.hi));
    const Interval s = outward(x.lo <= 0.0 && x.hi >= 0.0 ? 0.0 : near * near, largest);
    return {std::max(0.0, s.lo), s.hi};
  }
  Series squared(const Series& x) const {
    Series c = multiply(x, x);
    c[0] = square(x[0]);
    return c;
  }
  Series divide(const Series& x, const Series& y) const {
    Series q{};
    for (std::size_t k = 0; k < n; ++k) {
      Interval rest = x[k];
      for (std::size_t j = 1; j <= k; ++j) rest = rest - y[j] * q[k - j];
      q[k] = rest / y[0];
    }
    return q;
  }
  // sum over j = 1 … k of j u_j w_{k-j}, over k.
  Interval weighted(const Series& u, const Series& w, std::size_t k) const {
    Interval sum;
    for (std::size_t j = 1; j <= k; ++j) sum = sum + double(j) * (u[j] * w[k - j]);
    return (1.0 / double(k)) * sum;
  }
  Series exp(const Series& u) const {
    Series w{};
    w[0] = rising(u[0], [](double x) { return std::exp(x); });
    w[0].lo = std::max(0.0, w[0].lo);
    for (std::size_t k = 1; k < n; ++k) w[k] = weighted(u, w, k);
    return w;
  }
  void sin_cos(const Series& u, Series& s, Series& c) const {
    s[0] = interval::sin(u[0]);
    c[0] = interval::cos(u[0]);
    for (std::size_t k = 1; k < n; ++k) {
      s[k] = weighted(u, c, k);
      c[k] = -weighted(u, s, k);
    }
  }
  void sinh_cosh(const Series& u, Series& s, Series& c) const {
    s[0] = rising(u[0], [](double x) { return std::sinh(x); });
    const double near =
        u[0].lo <= 0.0 && u[0].hi >= 0.0 ? 0.0 : std::min(std::abs(u[0].lo), std::abs(u[0].hi));
    c[0] = outward(std::cosh(near), std::cosh(magnitude(u[0])));
    for (std::size_t k = 1; k < n; ++k) {
      s[k] = weighted(u, c, k);
      c[k] = weighted(u, s, k);
    }
  }
  // w' = (1 + sign w^2) u'; `of_zero` holds 1 + sign w^2.
  Series tangent(const Series& u, const Interval& w0, const Interval& of_zero, double sign) const {
    Series w{}, d{};
    w[0] = w0;
    d[0] = of_zero;
    for (std::size_t k = 1; k < n; ++k) {
      w[k] = weighted(u, d, k);
      d[k] = sign * product(w, w, k);
    }
    return w;
  }
  Series log(const Series& u) const {
    Series w{};
    w[0] = u[0].lo > 0.0 ? rising(u[0], [](double x) { return std::log(x); }) : everything;
    return quotient(u, u, w);
  }
  // w' = u'/d, with w_0 given.
  Series quotient(const Series& u, const Series& d, Series w) const {
    for (std::size_t k = 1; k < n; ++k) {
      Interval rest = double(k) * u[k];
      for (std::size_t j = 1; j < k; ++j) rest = rest - double(j) * (w[j] * d[k - j]);
      w[k] = (rest / d[0]);
      w[k] = (1.0 / double(k)) * w[k];
    }
    return w;
  }
  Series sqrt(const Series& u) const {
    Series w{};
    if (u[0].hi < 0.0) {
      w[0] = everything;
    } else {
      w[0] = outward(std::sqrt(std::max(0.0, u[0].lo)), std::sqrt(u[0].hi));
      w[0].lo = u[0].lo < 0.0 ? -infinity : std::max(0.0, w[0].lo);
    }
    for (std::size_t k = 1; k < n; ++k) {
      Interval rest = u[k];
      for (std::size_t j = 1; j < k; ++j) rest = rest - w[j] * w[k - j];
      w[k] = rest / (2.0 * w[0]);
    }
    return w;
  }
  Series power(const Series& u, double p) const {
    if (p == std::floor(p) && std::abs(p) <= 64.0) {
      const int whole = static_cast<int>(std::abs(p));
      Series w = constant(1.0);
      bool first = true;
      Series base = u;
      for (int left = whole; left > 0; left /= 2) {
        if (left % 2 == 1) {
          w = first ? base : multiply(w, base);
          first = false;
        }
        if (left > 1) base = squared(base);
      }
      return p < 0.0 ? divide(constant(1.0), w) : w;
    }
    if (!(u[0].lo > 0.0)) {
      Series w{};
      for (std::size_t k = 0; k < n; ++k) w[k] = everything;
      if (u[0].lo >= 0.0 && p > 0.0) w[0] = outward(0.0, std::pow(u[0].hi, p));
      return w;
    }
    Series w{};
    const double a = std::pow(u[0].lo, p), b = std::pow(u[0].hi, p);
    w[0] = outward(std::min(a, b), std::max(a, b));
    for (std::size_t k = 1; k < n; ++k) {
      Interval sum;
      for (std::size_t j = 1; j <= k; ++j)
        sum = sum + (p * double(j) - double(k - j)) * (u[j] * w[k - j]);
      w[k] = (1.0 / double(k)) * (sum / u[0]);
    }
    return w;
  }
  // 1 + sign u^2.
  Series one_and_square(const Series& u, double sign) const {
    return add(constant(1.0), scaled(sign, squared(u)));
  }
  Series asin(const Series& u) const {
    Series w{};
    w[0] =
        inside(u[0], -1.0, 1.0) ? rising(u[0], [](double x) { return std::asin(x); }) : everything;
    return quotient(u, sqrt(one_and_square(u, -1.0)), w);
  }
  Series atan(const Series& u) const {
    Series w{};
    w[0] = rising(u[0], [](double x) { return std::atan(x); });
    return quotient(u, one_and_square(u, 1.0), w);
  }
  Series atan2(const Series& y, const Series& x) const {
    constexpr double pi = std::numbers::pi;
    if (x[0].lo > 0.0) return atan(divide(y, x));
    if (y[0].lo > 0.0 || y[0].hi < 0.0) {  // away from the cut: w is +-pi/2 - atan(x/y)
      const double quarter = y[0].lo > 0.0 ? 0.5 * pi : -0.5 * pi;
      return add(constant(quarter), negative(atan(divide(x, y))));
    }
    Series w{};
    w[0] = {-pi, pi};
    for (std::size_t k = 1; k < n; ++k) w[k] = everything;  // it may jump there
    return w;
  }

  Series one(Opcode op, const Series& u) const {
    Series s{}, c{};
    switch (op) {
      case Opcode::negate:
        return negative(u);
      case Opcode::sin:
      case Opcode::cos:
        sin_cos(u, s, c);
        return op == Opcode::sin ? s : c;
      case Opcode::tan: {
        sin_cos(u, s, c);
        const Interval w0 = s[0] / c[0];
        return tangent(u, w0, point(1.0) / square(c[0]), 1.0);
      }
      case Opcode::asin:
        return asin(u);
      case Opcode::acos:
        return add(constant(0.5 * std::numbers::pi), negative(asin(u)));
      case Opcode::atan:
        return atan(u);
      case Opcode::sinh:
      case Opcode::cosh:
        sinh_cosh(u, s, c);
        return op == Opcode::sinh ? s : c;
      case Opcode::tanh: {
        sinh_cosh(u, s, c);
        return tangent(u, rising(u[0], [](double x) { return std::tanh(x); }),
                       clipped(point(1.0) / square(c[0]), 0.0, 1.0), -1.0);
      }
      case Opcode::exp:
        return exp(u);
      case Opcode::log:
        return log(u);
      case Opcode::log10:
        return scaled(std::numbers::log10e, log(u));
      case Opcode::sqrt:
        return sqrt(u);
      case Opcode::opposite:
        return truth(!is_true(u));
      default: {
        for (Interval& x : s) x = everything;
        return s;
      }
    }
  }
  static bool is_true(const Series& x) { return x[0].lo != 0.0; }
  Series truth(bool is) const { return constant(is ? 1.0 : 0.0); }
  Series two(Opcode op, const Series& x, const Series& y, bool is_after) const {
    switch (op) {
      case Opcode::add:
        return add(x, y);
      case Opcode::subtract:
        return add(x, negative(y));
      case Opcode::multiply:
        return multiply(x, y);
      case Opcode::divide:
        return divide(x, y);
      case Opcode::power:
        return exp(multiply(y, log(x)));
      case Opcode::atan2:
        return atan2(x, y);
      case Opcode::both:
        return truth(is_true(x) && is_true(y));
      case Opcode::either:
        return truth(is_true(x) || is_true(y));
      case Opcode::first_before:
      case Opcode::first_after:
        return is_after == (op == Opcode::first_before) ? y : x;
      default: {
        Series s{};
        for (Interval& each : s) each = everything;
        return s;
      }
    }
  }
};

Series pop(std::vector<Series>& stack) {
  const Series last = stack.back();
  stack.pop_back();
  return last;
}

}  // namespace

void Expression::enclose(double a, double b, std::span<Interval> c) const {
  const Calculator with{std::min(c.size(), most)};
  const double middle = a + 0.5 * (b - a);
  std::vector<Series> stack;
  for (std::size_t i = 0; i < program_.size(); ++i) {
    const Instruction& instruction = program_[i];
    const Opcode op = instruction.op;
    const bool is_after = middle > instruction.value;
    switch (op) {
      case Opcode::constant:
        stack.push_back(with.constant(instruction.value));
        break;
      case Opcode::input:
      case Opcode::sensor:
        stack.emplace_back().fill(everything);
        break;
      case Opcode::time:
        stack.push_back({Interval{a, b}, point(1.0)});
        break;
      case Opcode::before:
      case Opcode::after:
        stack.push_back(with.truth(is_after == (op == Opcode::after)));
        break;
      case Opcode::add:
      case Opcode::subtract:
      case Opcode::multiply:
      case Opcode::divide:
      case Opcode::power:
      case Opcode::atan2:
      case Opcode::both:
      case Opcode::either:
      case Opcode::first_before:
      case Opcode::first_after: {
        const Series y = pop(stack);
        stack.back() = with.two(op, stack.back(), y, is_after);
        break;
      }
      case Opcode::power_constant:
        stack.back() = with.power(stack.back(), instruction.value);
        break;
      case Opcode::negate_before:
      case Opcode::negate_after:
        if (is_after == (op == Opcode::negate_after)) stack.back() = with.negative(stack.back());
        break;
      // Of what is sampled, where nothing is differentiated: no bound is known.
      case Opcode::less:
      case Opcode::less_equal:
      case Opcode::equal:
      case Opcode::min:
      case Opcode::max:
        std::ranges::fill(c, everything);
        return;
      case Opcode::jump:
      case Opcode::jump_if_false:
        if (op == Opcode::jump || !with.is_true(pop(stack)))
          i = static_cast<std::size_t>(instruction.target) - 1;
        break;
      default:
        stack.back() = with.one(op, stack.back());
        break;
    }
  }
  for (std::size_t k = 0; k < c.size(); ++k) c[k] = k < most ? stack.front()[k] : everything;
}

}  // namespace mbd
