// Hermite interpolation on SE(3) against an analytic motion.
#include "solvers/time/dense_output.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "libmbd/core/dual.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_dense_output {
namespace {

using D1 = Dual<double>;

// H(t) = H0 exp(U(t)), turning by up to 2 rad. V = T(U) U', Vdot = d/dt V.
Vector6<D1> coordinates(double t, bool rate) {
  Vector6<D1> U;
  for (Index i = 0; i < 6; ++i) {
    const double a = 0.3 + 0.11 * static_cast<double>(i), b = 1.3 + 0.37 * static_cast<double>(i);
    const double f = a * std::sin(b * t), f1 = a * b * std::cos(b * t), f2 = -b * b * f;
    U(i) = rate ? D1{f1, f2} : D1{f, f1};
  }
  return U;
}
void set_motion(State& s, double t) {
  const Vector6<D1> U = coordinates(t, false);
  const Vector6<D1> V = T_of<D1>(U) * coordinates(t, true);
  Vec6 u;
  for (Index i = 0; i < 6; ++i) {
    u(i) = U(i).v;
    s.V.at(1)(i) = V(i).v;
    s.Vdot.at(1)(i) = V(i).d;
  }
  const Pose<double> H0{rotation(0.7, Vec3(1, 2, 3).normalized()), Vec3(0.3, -0.2, 5)};
  s.pose.at(1) = H0 * exp_se3<double>(u);
  s.t = t;
  for (Index i = 0; i < s.lambda.size(); ++i)
    s.lambda(i) = std::exp(-t) * std::sin(2.0 * t + 0.3 * static_cast<double>(i));
}

Model arm() {
  return compile(read_model_text(R"xml(<mbd name="test">
    <body name="arm" mass="1" inertia="1 1 1"/>
    <revolute name="A" between="ground arm" axis="0 0 1"/>
    <load at="arm" force="sin(3*t) 0 t&lt;0.5?1:2"/>
    <record name="A" joint="A" quantities="angle"/>
    <transient duration="2" step="0.01"/></mbd>)xml",
                                 "test.xml"));
}

struct Gap {
  double pose = 0.0, V = 0.0, Vdot = 0.0, lambda = 0.0;
};
// Largest errors inside a step of h from t = 0.4.
Gap gap(HermiteStep::Degree degree, bool inner, double h) {
  const Model model = arm();
  State begin = model.initial, end = begin, out = begin, exact = begin, a = begin, b = begin;
  set_motion(begin, 0.4);
  set_motion(end, 0.4 + h);
  set_motion(a, 0.4 + 0.155 * h);
  set_motion(b, 0.4 + 0.645 * h);
  std::vector<Vec6> Q(2, Vec6::Zero());
  Q[1] = log_se3<double>(relative(begin.pose[1], end.pose[1]));
  HermiteStep step(*model.system, degree);
  step.set(begin, end, Q);
  if (inner) step.set_inside({a.t, b.t}, {&a.lambda, &b.lambda}, {});
  Gap g;
  for (int k = 0; k <= 20; ++k) {
    const double t = 0.4 + h * k / 20.0;
    step.at(t, out);
    set_motion(exact, t);
    EXPECT_EQ(out.t, t);
    g.pose = std::max(g.pose,
                      log_se3<double>(relative(exact.pose[1], out.pose[1])).cwiseAbs().maxCoeff());
    g.V = std::max(g.V, (exact.V[1] - out.V[1]).cwiseAbs().maxCoeff());
    g.Vdot = std::max(g.Vdot, (exact.Vdot[1] - out.Vdot[1]).cwiseAbs().maxCoeff());
    g.lambda = std::max(g.lambda, (exact.lambda - out.lambda).cwiseAbs().maxCoeff());
  }
  return g;
}

TEST(HermiteStep, HasItsOrders) {
  const std::vector<double> h = {0.2, 0.1, 0.05, 0.025};
  for (const auto& [degree, inner, pose, lambda] :
       {std::tuple{HermiteStep::Degree::cubic, false, 4.0, 2.0},
        {HermiteStep::Degree::quintic, true, 6.0, 3.0}}) {
    std::vector<double> errors[4];
    for (const double step : h) {
      const Gap g = gap(degree, inner, step);
      errors[0].push_back(g.pose);
      errors[1].push_back(g.V);
      errors[2].push_back(g.Vdot);
      errors[3].push_back(g.lambda);
    }
    const double want[] = {pose, pose - 1, pose - 2, lambda};
    for (std::size_t i = 0; i < 4; ++i) {
      RecordProperty("order_" + std::to_string(static_cast<int>(10 * want[i])),
                     std::to_string(fitted_order(h, errors[i])));
      EXPECT_NEAR(fitted_order(h, errors[i]), want[i], 0.25)
          << "quantity " << i << testing::PrintToString(errors[i]);
    }
  }
}

// At both ends pose and V are those given, to round-off; of a quintic Vdot too. Multipliers at the end.
TEST(HermiteStep, MeetsItsEnds) {
  const Model model = arm();
  State begin = model.initial, end = begin, out = begin;
  set_motion(begin, 0.4);
  set_motion(end, 0.9);
  std::vector<Vec6> Q(2, Vec6::Zero());
  Q[1] = log_se3<double>(relative(begin.pose[1], end.pose[1]));
  for (const HermiteStep::Degree degree :
       {HermiteStep::Degree::cubic, HermiteStep::Degree::quintic}) {
    HermiteStep step(*model.system, degree);
    step.set(begin, end, Q);
    EXPECT_EQ(step.begin(), 0.4);
    EXPECT_EQ(step.end(), 0.9);
    for (const State* want : {&begin, &end}) {
      step.at(want->t, out);
      EXPECT_LE(log_se3<double>(relative(want->pose[1], out.pose[1])).cwiseAbs().maxCoeff(),
                8 * eps);
      EXPECT_LE((want->V[1] - out.V[1]).cwiseAbs().maxCoeff(), 32 * eps);
      EXPECT_LE((want->lambda - out.lambda).cwiseAbs().maxCoeff(), 8 * eps);
      if (degree == HermiteStep::Degree::quintic) {
        EXPECT_LE((want->Vdot[1] - out.Vdot[1]).cwiseAbs().maxCoeff(), 1e-13);
      }
      EXPECT_EQ(out.pose[0].r.norm(), 0.0);  // the ground
    }
    // set() again forgets what was prepared and the inner multipliers
    step.set_inside({0.5}, {&end.lambda}, {});
    State other = end;
    set_motion(other, 1.1);
    Q[1] = log_se3<double>(relative(begin.pose[1], other.pose[1]));
    step.set(begin, other, Q);
    step.at(0.75, out);
    EXPECT_LE((0.5 * (begin.lambda + other.lambda) - out.lambda).cwiseAbs().maxCoeff(), 8 * eps);
    step.at(1.1, out);
    EXPECT_LE((other.V[1] - out.V[1]).cwiseAbs().maxCoeff(), 32 * eps);
    Q[1] = log_se3<double>(relative(begin.pose[1], end.pose[1]));
  }
}

// Signals at t, at a jump at the end from the left; works between those of both ends; the angle followed.
TEST(HermiteStep, HasSignalsWorksAndAngles) {
  const Model model = arm();
  State begin = model.initial, end = begin, out = begin;
  begin.t = 0.0, end.t = 0.5;
  begin.work = {1.0, 10.0};
  end.work = {3.0, 30.0};
  const double rate = 4.0;  // rad/s about the joint, from 3 rad on: past half a turn
  const double start = 3.0;
  begin.pose[1].p = rotation(start, Vec3::UnitZ());
  end.pose[1].p = rotation(start + 0.5 * rate, Vec3::UnitZ());
  begin.V[1](5) = end.V[1](5) = rate;
  begin.angles.assign(1, start);
  std::vector<Vec6> Q(2, Vec6::Zero());
  Q[1](5) = 0.5 * rate;
  HermiteStep step(*model.system, HermiteStep::Degree::quintic);
  step.set(begin, end, Q);
  step.at(0.25, out);
  ASSERT_EQ(out.angles.size(), 1u);
  EXPECT_NEAR(out.angles[0], start + 0.25 * rate, 1e-14);
  EXPECT_NEAR(out.work.loads, 2.0, 1e-15);
  EXPECT_NEAR(out.work.drives, 20.0, 1e-14);
  double worst = 1.0;  // sin(3 t) is among the signals
  for (const SignalValue& s : out.signals) worst = std::min(worst, std::abs(s.f - std::sin(0.75)));
  EXPECT_LE(worst, 1e-15);
  step.at(0.5, out);
  bool left = false;
  for (const SignalValue& s : out.signals) {
    left = left || s.f == 1.0;
    EXPECT_NE(s.f, 2.0);
  }
  EXPECT_TRUE(left);
}

// W(t) = sin (t + 1) over [0, h]: the error inside falls by the number of powers plus one; the ends are met.
TEST(WorkInside, HasItsOrders) {
  const auto at = [](double t) { return std::sin(t + 1.0) * Work{1.0, 2.0, -1.0}; };
  const auto power = [](double t) { return std::cos(t + 1.0) * Work{1.0, 2.0, -1.0}; };
  const auto worst = [&]<std::size_t n>(const std::array<double, n>& nodes, double h) {
    std::array<Work, n> powers;
    for (std::size_t k = 0; k < n; ++k) powers[k] = power(h * nodes[k]);
    double error = 0.0;
    for (int i = 0; i <= 20; ++i) {
      const double s = i / 20.0;
      const Work w = work_inside(s, h, nodes, powers, at(0.0), at(h));
      error = std::max(error, std::abs(w.loads - at(s * h).loads));
      EXPECT_NEAR(w.drives, 2.0 * w.loads, 1e-15);
      EXPECT_NEAR(w.damping, -w.loads, 1e-15);
      if (i % 20 == 0) {
        EXPECT_NEAR(w.loads, at(s * h).loads, 1e-15);
      }
    }
    return error;
  };
  const std::vector<double> h = {0.2, 0.1, 0.05};
  std::vector<double> two, three, four;
  for (const double step : h) {
    two.push_back(worst(std::array{0.0, 1.0}, step));
    three.push_back(worst(std::array{0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)}, step));
    four.push_back(worst(std::array{0.0, 0.155, 0.645, 1.0}, step));
  }
  EXPECT_NEAR(fitted_order(h, two), 3.0, 0.3);
  EXPECT_NEAR(fitted_order(h, three), 4.0, 0.3);
  EXPECT_NEAR(fitted_order(h, four), 5.0, 0.3);
}

// Work that a linear damper takes from m x'' + c x' + k x = 0, x(0) = 0, at output times inside the steps, in closed form;
// largest error over the hundred rows, over the energy at the start, 4 J.
TEST(WorkInside, OfADampedOscillatorIsAsGoodAsItsMotion) {
  const double w0 = 20.0, zeta = 0.1, v0 = 2.0, wd = w0 * std::sqrt(1.0 - zeta * zeta);
  const auto taken = [&](double t) {
    const double e = v0 / wd * std::exp(-zeta * w0 * t);
    const double x = e * std::sin(wd * t),
                 v = e * (wd * std::cos(wd * t) - zeta * w0 * std::sin(wd * t));
    return 0.5 * 2.0 * (v * v + w0 * w0 * x * x) - 0.5 * 2.0 * v0 * v0;
  };
  for (const auto& [method, tolerance, bound] : {std::tuple{TimeMethod::radau, 1e-6, 2e-6},
                                                 {TimeMethod::radau, 1e-9, 2e-9},
                                                 {TimeMethod::ida, 1e-7, 1e-5},
                                                 {TimeMethod::generalized_alpha, 1e-5, 1e-3}}) {
    Scene scene = model_scene("damped_oscillator");
    scene.transient->method = method;
    scene.transient->step.reset();
    scene.transient->tolerance = tolerance;
    scene.transient->output = 0.01;
    const History run = run_to_table(scene);
    const std::vector<double>&t = run.table["time"], &work = run.table["system.work_of_damping"];
    ASSERT_EQ(t.size(), 101u);
    double worst = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i)
      worst = std::max(worst, std::abs(work[i] - taken(t[i])) / 4.0);
    EXPECT_LE(worst, bound) << name_of(method) << ' ' << tolerance;
  }
}

}  // namespace
}  // namespace mbd::test::test_dense_output
