// Radau IIA of 5 and 7 stages on mechanisms: orders of positions, velocities and reactions of a slider-crank against its
// equation in one coordinate, and of a beam in a loop against IDA; scenes that are made to mislead the estimate of errors.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libmbd/compile/time_stepping.hpp"
#include "tests/support/landings.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_radau_stages {
namespace {

std::string listed(const std::vector<double>& x) { return testing::PrintToString(x); }

// ---- slider-crank -------------------------------------------------------------------------------

// A crank of 1 m from the origin and a rod of 2.5 m fall, with a slider on the axis i1, from 0.7 rad, at rest. With
// sin(phi) = -sin(theta)/2.5 of the rod all follows from theta, and theta from
//   m(theta) theta'' + m'(theta)/2 theta'^2 = -dV/dtheta.
struct SliderCrank {
  using Long = long double;
  static constexpr Long a = 1.0L, l = 2.5L, crank_mass = 2.0L, crank_inertia = 0.2L,
                        rod_mass = 1.0L, rod_inertia = 0.5L, slider_mass = 1.5L, g = 9.81L,
                        start = 0.7L;

  struct At {
    Long x, x1, x2;  // of the slider, and derivatives with theta
    Long cx1, cx2;   // of the rod's centre
    Long cy1, cy2, phi, phi1, phi2;
  };
  static At at(Long theta) {
    const Long s = std::sin(theta), c = std::cos(theta);
    At k;
    k.phi = -std::asin(a / l * s);
    const Long sp = std::sin(k.phi), cp = std::cos(k.phi);
    k.phi1 = -a / l * c / cp;
    k.phi2 = (a / l * s + sp * k.phi1 * k.phi1) / cp;
    const Long bend = cp * k.phi1 * k.phi1 + sp * k.phi2;
    const Long rise = -sp * k.phi1 * k.phi1 + cp * k.phi2;
    k.x = a * c + l * cp;
    k.x1 = -a * s - l * sp * k.phi1;
    k.x2 = -a * c - l * bend;
    k.cx1 = -a * s - l / 2 * sp * k.phi1;
    k.cx2 = -a * c - l / 2 * bend;
    k.cy1 = a * c + l / 2 * cp * k.phi1;
    k.cy2 = -a * s + l / 2 * rise;
    return k;
  }
  static Long acceleration(Long theta, Long rate) {
    const At k = at(theta);
    const Long mass = crank_inertia + crank_mass * a * a / 4 +
                      rod_mass * (k.cx1 * k.cx1 + k.cy1 * k.cy1) + rod_inertia * k.phi1 * k.phi1 +
                      slider_mass * k.x1 * k.x1;
    const Long half = rod_mass * (k.cx1 * k.cx2 + k.cy1 * k.cy2) + rod_inertia * k.phi1 * k.phi2 +
                      slider_mass * k.x1 * k.x2;
    const Long pull = g * (crank_mass * a / 2 * std::cos(theta) + rod_mass * k.cy1);
    return -(pull + half * rate * rate) / mass;
  }

  // At 0, interval, …: of the slider, and the size of the force in its pin.
  std::vector<double> position, velocity, force;

  // By Runge and Kutta's method of order 4 in steps of 1/20 ms: to 1e-15.
  SliderCrank(double interval, int count) {
    Long theta = start, rate = 0.0L;
    const int steps = static_cast<int>(std::lround(interval / 5e-5));
    const Long h = static_cast<Long>(interval) / steps;
    keep(theta, rate);
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < steps; ++k) {
        const Long a1 = acceleration(theta, rate), r2 = rate + h / 2 * a1,
                   a2 = acceleration(theta + h / 2 * rate, r2), r3 = rate + h / 2 * a2,
                   a3 = acceleration(theta + h / 2 * r2, r3), r4 = rate + h * a3,
                   a4 = acceleration(theta + h * r3, r4);
        theta += h / 6 * (rate + 2 * r2 + 2 * r3 + r4);
        rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
      }
      keep(theta, rate);
    }
  }
  void keep(Long theta, Long rate) {
    const At k = at(theta);
    const Long alpha = acceleration(theta, rate);
    const auto second = [&](Long first, Long then) { return first * alpha + then * rate * rate; };
    const Long along = -slider_mass * second(k.x1, k.x2);  // on the rod, by the slider
    // Moments about the crank's pin.
    const Long across = (rod_inertia * second(k.phi1, k.phi2) +
                         rod_mass * l / 2 *
                             (std::cos(k.phi) * (second(k.cy1, k.cy2) + g) -
                              std::sin(k.phi) * second(k.cx1, k.cx2)) +
                         l * std::sin(k.phi) * along) /
                        (l * std::cos(k.phi));
    position.push_back(static_cast<double>(k.x));
    velocity.push_back(static_cast<double>(k.x1 * rate));
    force.push_back(static_cast<double>(std::hypot(along, across)));
  }

  static Scene scene(double metre = 1.0, double kilogram = 1.0) {
    const double theta = static_cast<double>(start);
    const auto phi = static_cast<double>(at(start).phi), x = static_cast<double>(at(start).x);
    const double J = kilogram * metre * metre;
    return scene_of(fmt::format(
        R"xml(
      <body name="crank" at="0 0 0" orientation="0 0 {0}" mass="{5}*2" center="{4}*0.5 0 0" inertia="{6}*0.01 {6}*0.2 {6}*0.2"/>
      <body name="rod" at="{4}*cos({0}) {4}*sin({0}) 0" orientation="0 0 {1}" mass="{5}" center="{4}*1.25 0 0"
            inertia="{6}*0.01 {6}*0.5 {6}*0.5"/>
      <body name="slider" at="{2}*{4} 0 0" mass="{5}*1.5" inertia="{6} {6} {6}"/>
      <revolute name="O" between="ground crank" at="0 0 0" axis="0 0 1"/>
      <spherical name="A" between="crank rod" at="{4}*cos({0}) {4}*sin({0}) 0"/>
      <spherical name="B" between="rod slider" at="{2}*{4} 0 0"/>
      <prismatic name="G" between="ground slider" at="{2}*{4} 0 0" axis="1 0 0"/>
      <gravity acceleration="0 -{4}*{3} 0"/>
      <transient duration="1" step="1"/>
      <record name="s" at="slider" quantities="position velocity"/>
      <record name="B" joint="B" quantities="reaction_force"/>)xml",
        fmt::format("{:.17g}", theta), fmt::format("{:.17g}", phi), fmt::format("{:.17g}", x), 9.81,
        fmt::format("{:.17g}", metre), fmt::format("{:.17g}", kilogram),
        fmt::format("{:.17g}", J)));
  }
};

struct Errors {
  std::vector<double> position, velocity, reaction;
};
std::vector<double> sizes(const Columns& v) {
  std::vector<double> size(v[0]->size(), 0.0);
  for (std::size_t k = 0; k < size.size(); ++k)
    size[k] = std::hypot((*v[0])[k], (*v[1])[k], (*v[2])[k]);
  return size;
}
Errors errors_of_crank(double interval, std::size_t stages, const std::vector<double>& h) {
  constexpr double duration = 1.6;
  const int count = static_cast<int>(std::floor(duration / interval + 1e-9));
  const SliderCrank exact(interval, count);
  const std::size_t n = exact.force.size();
  Errors e;
  for (const double step : h) {
    const Driven d =
        drive(SliderCrank::scene(), radau({.step = step, .stages = stages}), duration, interval);
    EXPECT_TRUE(d.last.converged) << d.last.failure;
    const std::vector<double> force = sizes(components(d.table, "B.reaction_force"));
    e.position.push_back(relative_rms({&d.table["s.position.1"]}, {&exact.position}, 1, n));
    e.velocity.push_back(relative_rms({&d.table["s.velocity.1"]}, {&exact.velocity}, 1, n));
    e.reaction.push_back(relative_rms({&force}, {&exact.force}, 1, n));
  }
  return e;
}
std::string orders(const std::vector<double>& h, const Errors& e) {
  return fmt::format("position {:.2f} {}, velocity {:.2f} {}, reaction {:.2f} {}",
                     fitted_order(h, e.position), listed(e.position), fitted_order(h, e.velocity),
                     listed(e.velocity), fitted_order(h, e.reaction), listed(e.reaction));
}

TEST(RadauStagesOrders, OfASliderCrankAtSteps) {
  for (const std::size_t stages : {3u, 5u, 7u}) {
    const std::vector<double> h = stages == 3   ? std::vector{0.05, 0.025, 0.0125}
                                  : stages == 5 ? std::vector{0.2, 0.1, 0.05}
                                                : std::vector{0.4, 0.2, 0.1};
    const Errors e = errors_of_crank(h.front(), stages, h);
    RecordProperty("stages_" + std::to_string(stages), orders(h, e));
    fmt::print("{} {}\n", stages, orders(h, e));
  }
}

TEST(RadauStagesOrders, OfASliderCrankInsideSteps) {
  for (const std::size_t stages : {5u, 7u}) {
    const std::vector<double> h =
        stages == 5 ? std::vector{0.2, 0.1, 0.05} : std::vector{0.4, 0.2, 0.1};
    const Errors e = errors_of_crank(0.0137, stages, h);
    RecordProperty("stages_" + std::to_string(stages), orders(h, e));
    fmt::print("{} {}\n", stages, orders(h, e));
  }
}

// ---- a beam in a loop ---------------------------------------------------------------------------

// Its bending is slow against the steps, its stretch is not.
Scene beam_loop() {
  return scene_of(R"xml(
    <section name="s"><stiffness EA="2e5" GA2="8e4" GA3="8e4" GJ="20" EI2="25" EI3="25"/>
      <mass per_length="0.8" inertia="1e-3 5e-4 5e-4"/></section>
    <body name="crank" at="0 0 0" mass="1" center="0 0.25 0" inertia="0.05 0.01 0.05"/>
    <beam name="coupler" section="s" from="0 0.5 0" to="1.5 0.5 0" normal="0 0 1" elements="1" order="3"/>
    <body name="rocker" at="1.5 0 0" mass="1" center="0 0.25 0" inertia="0.05 0.01 0.05"/>
    <revolute name="O" between="ground crank" at="0 0 0" axis="0 0 1"/>
    <spherical name="A" between="crank coupler.start" at="0 0.5 0"/>
    <universal name="B" between="coupler.end rocker" at="1.5 0.5 0" axis="0 0 1"/>
    <revolute name="C" between="ground rocker" at="1.5 0 0" axis="0 0 1"/>
    <load at="crank" moment="0 0 2*sin(3*t)"/>
    <gravity acceleration="0 -9.81 0"/>
    <transient duration="1" step="1"/>
    <record name="m" at="coupler@0.5" quantities="position velocity"/>
    <record name="C" joint="C" quantities="reaction_force"/>)xml");
}

MakeStepper ida(double tolerance, double duration) {
  TransientScene transient;
  transient.method = TimeMethod::ida;
  transient.tolerance = tolerance;
  transient.duration = duration;
  return [transient](const System& system) { return make_stepper(system, transient); };
}

TEST(RadauStagesOrders, OfABeamInALoop) {
  constexpr double duration = 0.8;
  const Scene scene = beam_loop();
  const Driven exact = drive(scene, ida(1e-11, duration), duration, 0.2);
  ASSERT_TRUE(exact.last.converged) << exact.last.failure;
  fmt::print("ida steps {}\n", exact.counters.steps);
  const Driven fine = drive(scene, radau({.step = 1e-3}), duration, 0.2);
  const std::size_t n = exact.table.rows();
  const auto errors = [&](const Table& t, const Table& of) {
    return std::array<double, 3>{
        relative_rms(components(t, "m.position"), components(of, "m.position"), 1, n),
        relative_rms(components(t, "m.velocity"), components(of, "m.velocity"), 1, n),
        relative_rms(components(t, "C.reaction_force"), components(of, "C.reaction_force"), 1, n)};
  };
  fmt::print("fine against ida {}\n", testing::PrintToString(errors(fine.table, exact.table)));
  for (const std::size_t stages : {3u, 5u, 7u}) {
    const std::vector<double> h = {0.1, 0.05, 0.025, 0.0125};
    Errors e;
    for (const double step : h) {
      const Driven d = drive(scene, radau({.step = step, .stages = stages}), duration, 0.2);
      EXPECT_TRUE(d.last.converged) << d.last.failure;
      const auto [x, v, f] = errors(d.table, fine.table);
      e.position.push_back(x);
      e.velocity.push_back(v);
      e.reaction.push_back(f);
    }
    fmt::print("{} {}\n", stages, orders(h, e));
  }
}

// ---- scenes to mislead the estimate -------------------------------------------------------------

struct Achieved {
  double position, velocity;
  long steps, rejected, residuals;
};
// Largest errors of the coordinate i1 of a body "m" at rows inside steps.
Achieved errors_at(const std::string& items, std::size_t stages, double tolerance, double duration,
                   double interval, const std::function<std::array<double, 2>(double)>& exact) {
  const Scene scene = scene_of(items + R"xml(<transient duration="1" step="1"/>
      <record name="m" at="m" quantities="position velocity"/>)xml");
  const Driven d = drive(
      scene, radau({.tolerances = {.relative = tolerance}, .end = duration, .stages = stages}),
      duration, interval);
  EXPECT_TRUE(d.last.converged) << d.last.failure;
  Achieved a{0.0, 0.0, d.counters.steps, d.counters.rejected, d.counters.residuals};
  for (std::size_t k = 0; k < d.table.rows(); ++k) {
    const auto [x, v] = exact(static_cast<double>(k) * interval);
    a.position = std::max(a.position, std::abs(d.table["m.position.1"][k] - x));
    a.velocity = std::max(a.velocity, std::abs(d.table["m.velocity.1"][k] - v));
  }
  return a;
}

TEST(RadauStagesHostile, Explore) {
  struct Case {
    std::string name, items;
    double duration, interval;
    std::function<std::array<double, 2>(double)> exact;
  };
  const double k = 2e4, g = 9.81, fall = 0.5, w = std::sqrt(k);
  // A ball of 1 kg bounces on a spring that begins 0.5 m below.
  const double t0 = std::sqrt(2 * fall / g), v0 = g * t0;
  const double A = std::hypot(g / k, v0 / w), phase = std::atan2(v0 / w, g / k);
  const double contact = 2.0 * (std::numbers::pi - phase) / w;
  const auto bounce = [=](double t) -> std::array<double, 2> {
    double since = std::fmod(t, 2 * t0 + contact);
    if (since < t0) return {-g * since * since / 2, -g * since};
    since -= t0;
    if (since < contact) {  // x = -fall - g/k + A cos(w t + phase')
      // depth y: y'' = -k y + g, y(0) = 0, y'(0) = v0
      const double y = g / k * (1 - std::cos(w * since)) + v0 / w * std::sin(w * since);
      const double yd = g / w * std::sin(w * since) + v0 * std::cos(w * since);
      return {-fall - y, -yd};
    }
    since -= contact;
    return {-fall + v0 * since - g * since * since / 2, v0 - g * since};
  };
  (void)A;
  const double pulse = 1e-3, at = 3.3337;
  const std::vector<Case> cases = {
      {"stiff spring", R"xml(<body name="m" at="1 0 0" mass="1" inertia="1 1 1" velocity="0 0 0"/>
        <prismatic name="guide" between="ground m" at="0 0 0" axis="1 0 0"/>
        <joint_spring name="s" joint="guide" stiffness="1e8" damping="1e2"/>
        <load at="m" force="(1e8-1)*(cos(t)-1)-1-1e2*sin(t) 0 0"/>)xml",
       10.0, 0.0137,
       [](double t) -> std::array<double, 2> {
         return {std::cos(t), -std::sin(t)};
       }},
      {"short load",
       fmt::format(R"xml(<body name="m" at="1 0 0" mass="2" inertia="1 1 1"/>
        <load at="m" force="100*exp(-((t-{})/{})^2) 0 0"/>)xml",
                   at, pulse),
       10.0, 0.0137,
       [=](double t) -> std::array<double, 2> {
         const double J = 50 * pulse * std::sqrt(std::numbers::pi) / 2, z = (t - at) / pulse;
         return {1.0 + J * (t - at) * std::erfc(-z) +
                     J * pulse * std::exp(-z * z) / std::sqrt(std::numbers::pi),
                 J * std::erfc(-z)};
       }},
      {"bounce",
       fmt::format(R"xml(<body name="m" at="0 0 0" mass="1" inertia="1 1 1"/>
        <prismatic name="guide" between="ground m" at="0 0 0" axis="1 0 0"/>
        <joint_spring name="s" joint="guide" force="x &lt; -0.5 ? {}*(x+0.5) : 0"/>
        <gravity acceleration="-9.81 0 0"/>)xml",
                   k),
       3.0, 0.0137, bounce},
  };
  for (const Case& c : cases)
    for (const double tolerance : {1e-4, 1e-6, 1e-8})
      for (const std::size_t stages : {3u, 5u, 7u, 0u}) {
        const Achieved a = errors_at(c.items, stages, tolerance, c.duration, c.interval, c.exact);
        fmt::print("{} {:g} {}: x {:.2e} v {:.2e} steps {} rejected {} residuals {}\n", c.name,
                   tolerance, stages, a.position, a.velocity, a.steps, a.rejected, a.residuals);
      }
}

}  // namespace
}  // namespace mbd::test::test_radau_stages
