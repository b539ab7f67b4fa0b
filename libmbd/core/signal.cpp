#include "libmbd/core/signal.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/core/law_cells.hpp"
#include "libmbd/core/stop.hpp"

namespace mbd {

namespace {

using Real = long double;

constexpr std::size_t kNodes = 25;           // samples of the rate on a panel; degree 24
constexpr std::size_t kPanelsPerPiece = 16;  // to begin with, so that short pulses are seen
constexpr std::size_t kMaxPanels = 100'000;
constexpr double kMinPanel = 1e-10;       // shortest panel / interval
constexpr Real kTolerance = 1e-16L;       // of the integral over the interval, absolute
constexpr Real kPanelTolerance = 1e-17L;  // of the integral over any panel, however short
constexpr double kJumpTolerance = 1e-10;  // smallest jump / magnitude

std::string to_text(double x) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x).ptr;
  return {buffer.data(), end};
}

using Samples = std::array<Real, kNodes>;

// cos(π i / (2 kNodes)) for one period, i < 4 kNodes: node j is entry 2j + 1, T_k there entry
// k (2j + 1).
const std::array<Real, 4 * kNodes>& cosines() {
  static const auto table = [] {
    std::array<Real, 4 * kNodes> c{};
    for (std::size_t i = 0; i < c.size(); ++i) {
      c[i] = std::cos(std::numbers::pi_v<Real> * static_cast<Real>(i) / Real(2 * kNodes));
    }
    return c;
  }();
  return table;
}

// Coefficients a_k of (2) from values at the Chebyshev nodes (of the first kind: none at the ends,
// where the rate may jump).
Samples expand(const Samples& values) {
  const auto& cosine = cosines();
  Samples a{};
  for (std::size_t k = 0; k < kNodes; ++k) {
    for (std::size_t j = 0; j < kNodes; ++j) {
      a[k] += values[j] * cosine[k * (2 * j + 1) % (4 * kNodes)];
    }
    a[k] *= (k == 0 ? Real(1) : Real(2)) / Real(kNodes);
  }
  return a;
}

// Σ c_k T_k(x).
Real clenshaw(std::span<const Real> c, Real x) {
  Real u1 = 0, u2 = 0;
  for (std::size_t k = c.size() - 1; k > 0; --k) {
    const Real u = c[k] + 2 * x * u1 - u2;
    u2 = std::exchange(u1, u);
  }
  return c[0] + x * u1 - u2;
}

}  // namespace

class Signal::RateLaw {
 public:
  RateLaw(Expression rate, double f0, double t_begin, double t_end)
      : rate_(std::move(rate)), begin_(t_begin), end_(t_end) {
    if (!std::isfinite(t_begin) || !std::isfinite(t_end) || !(t_begin < t_end)) {
      throw Error(name() + ": found the interval " + interval() +
                  ", expected finite times, the first before the second; correct the interval");
    }
    if (rate_.has_inputs())
      throw Error(name() +
                  ": depends on an input, whose future is not known; prescribe the angle or the "
                  "displacement, and give the input its rates (InputValue)");
    if (rate_.has_sensors())
      throw Error(name() +
                  ": depends on a sensor; a motion that is prescribed cannot answer to the motion: "
                  "let a load or a <joint_torque> act on it");
    if (!std::isfinite(f0)) {
      throw Error(name() + ": found the initial value " + to_text(f0) +
                  ", expected a finite number; correct it");
    }
    integrate(f0);
  }

  SignalValue operator()(double t, Side side) const {
    const double slack =
        16 * std::numeric_limits<double>::epsilon() * std::max(std::abs(begin_), std::abs(end_));
    if (!(t >= begin_ - slack && t <= end_ + slack)) {
      throw Error(name() + ": asked for t = " + to_text(t) + " s outside its interval " +
                  interval() + "; extend the interval");
    }
    const auto after = std::upper_bound(panels_.begin() + 1, panels_.end(), t,
                                        [](double s, const Panel& p) { return s < p.begin; });
    const Panel& panel = *(after - 1);
    const Real x = (Real(t) - panel.middle) / panel.half;
    const Real f = clenshaw({coefficients_.data() + panel.first, panel.count}, x);
    const Taylor2 rate = rate_(t, side);
    return {static_cast<double>(f), rate.v, rate.d};
  }

  const Expression& rate() const { return rate_; }
  double begin() const { return begin_; }
  double end() const { return end_; }

 private:
  // f = Σ c_k T_k((t − middle)/half), c_k = half b_k of (4), c_0 with the integral so far.
  struct Panel {
    double begin;       // [s]
    Real middle, half;  // [s]
    std::size_t first;  // coefficients_[first … first + count)
    std::size_t count;
  };

  std::string name() const { return "rate \"" + rate_.text().substr(0, 120) + "\""; }
  std::string interval() const {
    return std::string("[") + to_text(begin_) + ", " + to_text(end_) + "] s";
  }

  static Real time_at(Real middle, Real half, std::size_t node) {
    return middle + half * cosines()[2 * node + 1];
  }

  void integrate(double f0) {
    std::vector<double> knots{begin_};
    for (const double t : rate_.breakpoints()) {
      if (begin_ < t && t < end_) knots.push_back(t);
    }
    knots.push_back(end_);
    const LawCells cells = find_cells(rate_, {}, begin_, end_);
    Real f = f0, lost = 0;  // the integral so far, and what rounding took from it (Kahan)
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      std::vector<double> ends;  // of the panels still to do, the next one last
      for (std::size_t p = kPanelsPerPiece; p > 0; --p) {
        ends.push_back(std::lerp(knots[i], knots[i + 1], double(p) / double(kPanelsPerPiece)));
      }
      double left = knots[i];
      while (!ends.empty()) {
        const double right = ends.back();
        if (!(left < right)) {  // a piece of a few rounding units
          ends.pop_back();
          continue;
        }
        const Real middle = (Real(left) + Real(right)) / 2;
        const Real half = (Real(right) - Real(left)) / 2;
        const Samples a = expand(sample(middle, half));
        if (is_resolved(a, middle, half) && cells.narrowest(left, right) * 100.0 >= right - left) {
          const Real increment = append(a, left, middle, half, f) - lost;
          const Real sum = f + increment;
          lost = (sum - f) - increment;
          f = sum;
          left = right;
          ends.pop_back();
        } else {
          ends.push_back(split(left, right));
        }
      }
    }
    panels_.shrink_to_fit();
    coefficients_.shrink_to_fit();
  }

  Samples sample(Real middle, Real half) const {
    stop::check();
    Samples values{};
    for (std::size_t j = 0; j < kNodes; ++j) {
      const Real t = time_at(middle, half, j);
      values[j] = rate_.evaluate(t).v;
      if (!std::isfinite(static_cast<double>(values[j]))) {
        throw Error(name() + ": not finite at t = " + to_text(static_cast<double>(t)) +
                    " s; choose another law there by condition ? value : value, or change the "
                    "interval");
      }
    }
    return values;
  }

  // The last coefficients stand for those left out. They must be below the tolerance, of which a
  // panel has its share by length (but at least a tenth: short panels, at singularities, are few),
  // or below what rounding makes of zero.
  bool is_resolved(const Samples& a, Real middle, Real half) const {
    Real tail = 0;
    for (std::size_t k = kNodes - 4; k < kNodes; ++k) tail = std::max(tail, std::abs(a[k]));
    const Real width = 2 * half;
    const Real share = kTolerance * width / (Real(end_) - Real(begin_));
    return tail * width <= std::max(share, kPanelTolerance) || tail <= rounding(middle, half);
  }

  // Rounding error of a sample: that in double, which is seen by comparison, scaled to the unit of
  // Real; where Real is double and nothing can be seen, that of t and of the result.
  Real rounding(Real middle, Real half) const {
    constexpr Real unit = std::numeric_limits<Real>::epsilon();
    constexpr Real ratio = unit / Real(std::numeric_limits<double>::epsilon());
    Real largest = 0;
    for (std::size_t j = 0; j < kNodes; ++j) {
      const double t = static_cast<double>(time_at(middle, half, j));
      const Taylor<Real> exact = rate_.evaluate(Real(t));
      const Real seen = std::abs(Real(rate_(t).v) - exact.v);
      const Real least = std::abs(exact.v) + std::abs(Real(t) * exact.d);
      const Real error = ratio * seen + unit * least;
      if (std::isfinite(error)) largest = std::max(largest, error);
    }
    constexpr Real safety = 8;
    return safety * largest;
  }

  double split(double left, double right) const {
    const double middle = left + (right - left) / 2;
    if (right - left < kMinPanel * (end_ - begin_) || !(left < middle && middle < right)) {
      throw Error(name() + ": cannot be integrated to 1e-15 near t = " + to_text(middle) +
                  " s; if it jumps or has a kink there, write it as condition ? value : value, and "
                  "remove poles");
    }
    if (panels_.size() >= kMaxPanels) {
      throw Error(name() + ": needs more than " + std::to_string(kMaxPanels) + " panels, " +
                  "which are spent at t = " + to_text(left) +
                  " s; lower its frequency or shorten the interval");
    }
    return middle;
  }

  // Appends the panel on which f starts from `f_begin`; returns the increment of f over it.
  Real append(const Samples& a, double begin, Real middle, Real half, Real f_begin) {
    std::array<Real, kNodes + 1> c{};
    const auto coefficient = [&](std::size_t k) { return k < kNodes ? a[k] : Real(0); };
    c[1] = half * (coefficient(0) - coefficient(2) / 2);
    for (std::size_t k = 2; k <= kNodes; ++k) {
      c[k] = half * (coefficient(k - 1) - coefficient(k + 1)) / Real(2 * k);
    }
    Real at_begin = 0, increment = 0;  // from small to large; T_k(−1) = (−1)^k
    for (std::size_t k = kNodes; k > 0; --k) {
      at_begin += k % 2 == 0 ? c[k] : -c[k];
      if (k % 2 == 1) increment += 2 * c[k];
    }
    c[0] = f_begin - at_begin;
    std::size_t count = kNodes + 1;  // without what is below the rounding of Real
    const Real largest = std::max(Real(1), std::abs(f_begin));
    for (Real left_out = 0; count > 2; --count) {
      left_out += std::abs(c[count - 1]);
      if (left_out > largest * Real(1e-21)) break;
    }
    panels_.push_back({begin, middle, half, coefficients_.size(), count});
    coefficients_.insert(coefficients_.end(), c.begin(),
                         c.begin() + static_cast<std::ptrdiff_t>(count));
    return increment;
  }

  Expression rate_;
  double begin_, end_;              // [s]
  std::vector<Panel> panels_;       // ascending, without gaps
  std::vector<Real> coefficients_;  // of all panels
};

Signal Signal::constant(double f) { return Signal(Law(f)); }

Signal Signal::from_expression(Expression f) { return Signal(Law(std::move(f))); }

Signal Signal::from_rate(Expression rate, double f0, double t_begin, double t_end) {
  return Signal(Law(std::make_shared<const RateLaw>(std::move(rate), f0, t_begin, t_end)));
}

SignalValue Signal::operator()(double t, Side side, std::span<const InputValue> inputs) const {
  if (const auto* f = std::get_if<double>(&law_)) return {*f, 0.0, 0.0};
  if (const auto* expression = std::get_if<Expression>(&law_)) {
    const Taylor2 f = (*expression)(t, side, inputs);
    return {f.v, f.d, f.dd};
  }
  return (*std::get<std::shared_ptr<const RateLaw>>(law_))(t, side);
}

const Expression* Signal::expression(bool& is_rate) const {
  const auto* rate = std::get_if<std::shared_ptr<const RateLaw>>(&law_);
  is_rate = rate != nullptr;
  return is_rate ? &(*rate)->rate() : std::get_if<Expression>(&law_);
}

bool Signal::is_constant() const {
  if (std::holds_alternative<double>(law_)) return true;
  const auto* expression = std::get_if<Expression>(&law_);
  return expression != nullptr && expression->is_constant();
}

bool Signal::has_inputs() const {
  const auto* expression = std::get_if<Expression>(&law_);
  return expression != nullptr && expression->has_inputs();
}

bool Signal::has_sensors() const {
  const auto* expression = std::get_if<Expression>(&law_);
  return expression != nullptr && expression->has_sensors();
}

// Where it is known [s].
std::array<double, 2> Signal::interval() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (const auto* law = std::get_if<std::shared_ptr<const RateLaw>>(&law_))
    return {(*law)->begin(), (*law)->end()};
  return {-infinity, infinity};
}

std::vector<double> Signal::breakpoints() const {
  const auto [begin, end] = interval();
  std::span<const double> all;
  if (const auto* expression = std::get_if<Expression>(&law_))
    all = expression->breakpoints();
  else if (const auto* law = std::get_if<std::shared_ptr<const RateLaw>>(&law_))
    all = (*law)->rate().breakpoints();
  std::vector<double> times;
  std::copy_if(all.begin(), all.end(), std::back_inserter(times),
               [first = begin, last = end](double t) { return first < t && t < last; });
  return times;
}

// The magnitude against which a jump is measured is that on the pieces on both sides, of length τ:
//   (5)  m_k = max(|f^(k)|, |f^(k−1)|/τ, …), sampled,
// because the limits alone may both be rounding errors, as those of ṙ at t = 6 for
// r = t<6 ? 1-cos(pi*t/6) : 2, namely 1e-16 and 0.
std::vector<Jump> Signal::jumps() const {
  const auto [begin, end] = interval();
  const std::vector<double> times = breakpoints();
  using Values = std::array<double, 3>;
  const auto values = [&](double t, Side side) -> Values {
    const SignalValue s = (*this)(t, side);
    return {s.f, s.fdot, s.fddot};
  };
  std::vector<Jump> result;
  if (has_inputs() || has_sensors()) {
    for (const double t : times) result.push_back({t, 0, std::numeric_limits<double>::quiet_NaN()});
    return result;
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    stop::check();
    const double t = times[i];
    double before = t - (i == 0 ? begin : times[i - 1]);
    double after = (i + 1 == times.size() ? end : times[i + 1]) - t;
    if (std::isinf(before)) before = std::isinf(after) ? std::max(1.0, std::abs(t)) : after;
    if (std::isinf(after)) after = before;
    Values magnitude{};
    constexpr int samples = 16;
    for (int j = 0; j < samples; ++j) {
      const double fraction = (j + 0.5) / samples;
      for (const Values& v :
           {values(t - fraction * before, Side::left), values(t + fraction * after, Side::right)}) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (std::isfinite(v[k])) magnitude[k] = std::max(magnitude[k], std::abs(v[k]));
        }
      }
    }
    const double length = std::max(before, after);
    const Values left = values(t, Side::left), right = values(t, Side::right);
    for (std::size_t k = 0; k < 3; ++k) {
      if (k > 0) magnitude[k] = std::max(magnitude[k], magnitude[k - 1] / length);
      const double size = right[k] - left[k];
      if (!std::isfinite(size) || std::abs(size) > kJumpTolerance * magnitude[k]) {
        result.push_back({t, static_cast<int>(k), size});
        break;
      }
    }
  }
  return result;
}

// An interval [a, b] of length h is quiet if, with V the largest |ḟ| met (1e-9 at least: less is round-off),
//   (6)  |ḟ_b − ḟ_a − h (f̈_a + f̈_b)/2| ≤ 1e-4 V,
//   (7)  |f_b − f_a − h (ḟ_a + ḟ_b)/2 + h² (f̈_b − f̈_a)/12| ≤ 1e-4 h V;
// where f is smooth the left sides fall with h³ and h⁵, where ḟ jumps (6) does not fall, where f jumps (7)
// does not; two jumps within the interval, which may cancel in (6), do not in (7).
std::optional<Jump> Signal::undeclared_jump(double t_begin, double t_end) const {
  const auto* expression = std::get_if<Expression>(&law_);
  if (expression == nullptr || expression->is_constant() || expression->has_inputs() ||
      expression->has_sensors())
    return {};
  constexpr double smallest = 1e-4;  // jump / V
  constexpr double shortest = 1e-9;  // interval / (t_end - t_begin)
  constexpr int samples = 199;       // of a piece; uneven, so as not to fall in step with a period
  constexpr long most = 2'000'000;   // intervals: what oscillates faster is believed to be smooth
  std::vector<double> knots{t_begin};
  for (const double t : expression->breakpoints())
    if (t_begin < t && t < t_end) knots.push_back(t);
  knots.push_back(t_end);
  std::vector<double> ends;  // of the first intervals, the next one last
  double V = 1e-9;
  const auto observe = [&V](double rate) {
    if (std::isfinite(rate)) V = std::max(V, std::abs(rate));
  };
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    stop::check();
    for (int j = 1; j <= samples; ++j) {
      const double x = double(j) / samples;
      const double uneven = x + 0.05 / samples * std::sin(7.0 * x * (1.0 - x) * j);
      ends.push_back(j == samples ? knots[i + 1] : std::lerp(knots[i], knots[i + 1], uneven));
      observe((*this)(ends.back(), Side::left).fdot);
    }
  }
  std::reverse(ends.begin(), ends.end());
  double a = t_begin;
  for (long n = 0; !ends.empty() && n < most; ++n) {
    stop::check();
    const double b = ends.back(), h = b - a;
    const SignalValue left = (*this)(a, Side::right), right = (*this)(b, Side::left);
    observe(left.fdot);
    observe(right.fdot);
    const double rate = right.fdot - left.fdot;
    const double unexplained = rate - 0.5 * h * (left.fddot + right.fddot);  // (6)
    const double gap = right.f - left.f - 0.5 * h * (left.fdot + right.fdot) +
                       h * h / 12.0 * (right.fddot - left.fddot);  // (7)
    const bool quiet = std::abs(unexplained) <= smallest * V && std::abs(gap) <= smallest * h * V;
    const double middle = a + 0.5 * h;
    if (!quiet && h > shortest * (t_end - t_begin) && a < middle && middle < b) {
      ends.push_back(middle);
      continue;
    }
    if (!quiet) {  // so short that what is smooth does not change in it; round-off of f is below V h
      const double step = right.f - left.f;
      if (std::abs(step) > 1e3 * h * V && std::abs(step) > 1e-10 * std::abs(left.f))
        return Jump{middle, 0, step};
      if (std::abs(rate) > smallest * V) return Jump{middle, 1, rate};
    }
    a = b;
    ends.pop_back();
  }
  return {};
}

}  // namespace mbd
