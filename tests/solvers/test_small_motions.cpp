// Small motions about a state that turns: the matrices of small_motions.hpp against differences of the residual along
// motions u(t) = x exp(s t), whose velocities and accelerations are had by differences in time.
// Mutations seen: V~ left out of C or of K; the scale of multipliers in solve_all; M Vdot~ left out of K; what a pair's force
// adds to its tangent (elements/pair/two_frames.hpp).
#include "solvers/modes/small_motions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libmbd/compile/model.hpp"
#include "solvers/modes/steady_rotation.hpp"
#include "tests/support/random.hpp"
#include "tests/support/read_text.hpp"

namespace mbd::test::test_small_motions {
namespace {

// Elastic and viscous beams of two forms, drag, a body, joints of several kinds, springs, a follower load, gravity.
const std::string everything = R"(
  <section name="s"><stiffness EA="2e3" GA2="9e2" GA3="8e2" GJ="30" EI2="40" EI3="50" D14="12" D25="-7"/>
    <mass per_length="1.5" inertia="0.03 0.02 0.01"/>
    <damping stiffness_proportional="0.02" mass_proportional="0.3"/></section>
  <beam name="a" section="s" from="0 0 0" to="1 0.2 0" normal="0 0 1" elements="2" order="3"/>
  <beam name="b" section="s" from="1 0.2 0" to="1 1 0.5" normal="1 0 0" elements="1" order="2" form="paper"/>
  <body name="d" at="1 1 0.5" mass="2" inertia="0.3 0.2 0.15" center="0.1 0 0.05"/>
  <revolute name="R" between="ground a.start" axis="0 0 1"/>
  <universal name="U" between="a.end b.start" axis="0 0 1" second_axis="1 0 0"/>
  <spherical name="S" between="b.end d"/>
  <drive joint="R" rate="0"/>
  <spring name="k" between="ground d" at_a="0 0 1" stiffness="30" damping="2" length="1"/>
  <bushing name="g" between="a.end d" at="1 0.6 0.3" stiffness="40 60 90" angular_stiffness="3 5 4" damping="1 2 1"
    angular_damping="0.2 0.3 0.1"/>
  <load name="f" at="a.end" follower_force="3 -2 5"/>
  <gravity acceleration="0 0 -9.8"/>
  <static/><transient duration="1" step="1"/>
)";

// H exp(u) and its velocity and acceleration in body axes, of a node that moves with V (constant components).
struct Moved {
  Pose<double> H;
  Vec6 V;
};

Moved moved(const Pose<double>& H, const Vec6& V, const Vec6& x, double s, double t) {
  const Vec6 u = std::exp(s * t) * x;
  constexpr double dt = 1e-5;
  const auto at = [&](double time) {
    return H * exp_se3<double>(time * V) * exp_se3<double>(std::exp(s * (t + time)) * x);
  };
  const Pose<double> now = H * exp_se3<double>(u), g = relative(at(-dt), at(dt));
  // In axes of the middle.
  const Pose<double> half = relative(at(-dt), now);
  Vec6 rate;
  rate.head<3>() = half.p.conjugate() * Vec3(g.r / (2.0 * dt));
  rate.tail<3>() = 2.0 * g.p.vec() / (2.0 * dt);
  return {now, rate};
}

TEST(SmallMotions, AreTheDifferencesOfTheResidual) {
  const Model model = compile(read(everything));
  const System& system = *model.system;
  Rng rng(7);
  for (int trial = 0; trial < 8; ++trial) {
    const bool on_its_way = trial >= 4;
    State state = model.initial;
    for (std::size_t n = 1; n < state.pose.size(); ++n) {
      state.pose[n] = state.pose[n] * exp_se3<double>(random_vector<6>(rng, 0.1));
      state.V[n] = random_vector<6>(rng, 2.0);
      state.Vdot[n].setZero();
      if (on_its_way) state.Vdot[n] = random_vector<6>(rng, 30.0);
    }
    for (double& l : state.lambda) l = uniform(rng, -20.0, 20.0);
    SmallMotions motions(system);
    ASSERT_TRUE(on_its_way ? motions.frozen_at(state) : motions.about(state));
    const double s = uniform(rng, 1.0, 4.0);
    ASSERT_TRUE(motions.factor(s));
    VecX b(motions.unknowns());
    for (double& entry : b) entry = uniform(rng, -1.0, 1.0);
    VecX x = b;
    motions.solve_all(x);

    const double e = 1e-4 / x.head(motions.motions()).cwiseAbs().maxCoeff();
    const auto residual_at = [&](double factor) {
      State at = state;
      constexpr double dt = 1e-4;
      for (std::size_t n = 1; n < at.pose.size(); ++n) {
        const Vec6 u = factor * Vec6(x.segment<6>(6 * static_cast<Index>(n - 1)));
        const auto of = [&](double t) {
          // At t the node has moved on.
          const Vec6 &V = state.V[n], &A = state.Vdot[n];
          const Pose<double> H = state.pose[n] * exp_se3<double>(t * V + 0.5 * t * t * A);
          return moved(H, V + t * A, std::exp(s * t) * u, s, 0.0);
        };
        const Moved now = of(0.0);
        at.pose[n] = now.H;
        at.V[n] = now.V;
        at.Vdot[n] = (of(dt).V - of(-dt).V) / (2.0 * dt);
      }
      at.lambda += factor * x.tail(at.lambda.size());
      VecX r;
      EXPECT_TRUE(system.residual(at, r));
      return VecX(r.tail(motions.unknowns()));
    };
    const VecX difference = (residual_at(e) - residual_at(-e)) / (2.0 * e);
    // Largest entry, over that of what cancels in it.
    const double size =
        std::max(1.0, motions.stiffness() * x.head(motions.motions()).cwiseAbs().maxCoeff());
    EXPECT_LT((difference - b).cwiseAbs().maxCoeff(), 1e-6 * size) << trial;
  }
}

// A state that turns steadily has residuals that do not change with it, and its velocities are those of the rotation.
TEST(SmallMotions, VelocitiesOfSteadyRotation) {
  const Model model = compile(read(everything));
  State state = model.initial;
  const SteadyRotation rotation{1.7, Vec3(2.0, -1.0, 2.0) / 3.0, Vec3(0.3, 0.2, -0.5)};
  turn_steadily(rotation, state);
  constexpr double t = 1e-6;
  const Eigen::Quaterniond by(Eigen::AngleAxisd(rotation.rate * t, Eigen::Vector3d(rotation.axis)));
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    const Pose<double> moved = state.pose[n] * exp_se3<double>(t * state.V[n]);
    const Vec3 r = rotation.through + by * (state.pose[n].r - rotation.through);
    EXPECT_LT((moved.r - r).norm(), 1e-11);
    EXPECT_LT((moved.p.coeffs() - (by * state.pose[n].p).coeffs()).norm(), 1e-11);
  }
}

}  // namespace
}  // namespace mbd::test::test_small_motions
