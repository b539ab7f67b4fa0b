// Steps that land on breakpoints, fail, are tried in halves, and say so; what a free system keeps.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tests/support/altered_solver.hpp"
#include "tests/support/landings.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_stepping {
namespace {

struct Stepped {
  Model model;
  State state;
  Counters counters;
  StepReport last;
};

// Steps until `duration`, or a failure.
template <class F>
Stepped step_through(const Scene& scene, GeneralizedAlphaOptions options, const F& seen) {
  Stepped s{compile(scene), {}, {}, {}};
  s.state = s.model.initial;
  options.step = scene.transient->step.value();
  options.rho_infinity = rho_infinity_of(*scene.transient);
  GeneralizedAlpha stepper(*s.model.system, make_klu_solver(), options);
  s.last = stepper.start(s.state);
  EXPECT_TRUE(s.last.converged) << s.last.failure;
  const long steps = number_of_steps(*scene.transient);
  for (long k = 0; k < steps && s.last.converged; ++k) {
    s.last = stepper.step(s.state);
    seen(s);
  }
  s.counters = stepper.counters();
  return s;
}
Stepped step_through(const Scene& scene, const GeneralizedAlphaOptions& options = {}) {
  return step_through(scene, options, [](const Stepped&) {});
}

// ---- breakpoints ------------------------------------------------------------------------------

// A force that jumps between two steps: exact, because the scheme is for piecewise constant accelerations.
TEST(Stepping, LandsOnAJumpBetweenTwoSteps) {
  const Scene scene = scene_of(R"xml(
    <body name="ball" mass="2" inertia="1 1 1"/>
    <load at="ball" force="t&lt;0.505?0:t&lt;0.7031?6:-1 0 0"/>
    <transient duration="1" step="0.01" rho_infinity="0.3"/>)xml");
  for (const Balance balance : {Balance::acceleration, Balance::momentum}) {
    const Stepped s = step_through(scene, {.balance = balance, .newton = {}});
    ASSERT_TRUE(s.last.converged) << s.last.failure;
    const double v1 = 3.0 * (0.7031 - 0.505), x1 = 1.5 * std::pow(0.7031 - 0.505, 2);
    const double T = 1.0 - 0.7031;
    EXPECT_NEAR(s.state.pose[1].r(0), x1 + v1 * T - 0.25 * T * T, 1e-13);
    EXPECT_NEAR(s.state.V[1](0), v1 - 0.5 * T, 1e-13);
    EXPECT_EQ(s.state.t, 1.0);
    EXPECT_EQ(s.counters.steps, 100);
    EXPECT_EQ(s.counters.substeps, 102);
    EXPECT_EQ(s.counters.restarts, 2);
    EXPECT_EQ(s.counters.retries, 0);
  }
}

TEST(Stepping, CountsBreakpointsAsTheyAre) {
  expect_breakpoints_counted([](const Scene& scene) { return step_through(scene).counters; });
}

// Order two; with the jump unknown to the integrator it is one.
TEST(Stepping, KeepsItsOrderAcrossAJump) {
  for (const Balance balance : {Balance::acceleration, Balance::momentum}) {
    const std::vector<double> h = {0.04, 0.02, 0.01, 0.005};
    std::vector<double> error;
    for (const double step : h)
      error.push_back(
          late_disk_error(step_through(late_disk(step), {.balance = balance, .newton = {}}).state));
    // Single slopes vary with where in its step the jump falls.
    EXPECT_NEAR(fitted_order(h, error), 2.0, 0.1) << testing::PrintToString(error);
  }
}

// Kinks in the load of another body split some steps: a body whose acceleration grows linearly must not
// notice. Detects an algorithmic acceleration that is not scaled with the step.
TEST(Stepping, UnequalStepsChangeNothingForALinearForce) {
  const auto speed = [](Balance balance, const std::string& kinks) {
    const Stepped s = step_through(scene_of(R"xml(
        <body name="ball" mass="2" inertia="1 1 1"/><load at="ball" force="3*t 0 0"/>
        <body name="other" mass="1" inertia="1 1 1"/><load at="other" force=")xml" +
                                            kinks + R"xml( 0 0"/>
        <transient duration="1" step="0.01" rho_infinity="0.3"/>)xml"),
                                   {.balance = balance, .newton = {}});
    return std::pair{s.state.V[1](0), s.counters.substeps};
  };
  for (const Balance balance : {Balance::acceleration, Balance::momentum}) {
    const auto [even, steps] = speed(balance, "1");
    const auto [uneven, more] =
        speed(balance, "max(0,t-0.6037)+max(0,t-0.713)+max(0,t-0.83333)+max(0,t-0.9011)");
    EXPECT_EQ(steps, 100);
    EXPECT_EQ(more, 104);
    EXPECT_NEAR(even, 0.75, 1e-4);
    EXPECT_NEAR(uneven, even, 1e-13);
  }
}

// ---- failures ---------------------------------------------------------------------------------

TEST(Stepping, ALockEndsTheRunWithItsResults) {
  const Scene scene = scene_of(locking);
  const History history = run_to_table(scene);
  EXPECT_FALSE(history.report.complete());
  EXPECT_NE(history.report.failure.find("even with a step of 0.000313 s"), std::string::npos)
      << history.report.failure;
  EXPECT_TRUE(history.report.failure.find("'B'") != std::string::npos ||
              history.report.failure.find("'C'") != std::string::npos ||
              history.report.failure.find("'A'") != std::string::npos)
      << history.report.failure;
  EXPECT_LE(history.table["time"].back(), lock_time);
  EXPECT_GT(history.table["time"].back(), lock_time - 0.02);
  EXPECT_NEAR(history.table["A.angle"].back(), history.table["time"].back() - 0.25, 1e-9);
  EXPECT_EQ(static_cast<std::size_t>(history.report.rows), history.table.rows());
  EXPECT_GT(history.report.transient_counters.retries, 0);
}

// A step too large for Newton's iterations is done in parts, and the next ones are whole again.
TEST(Stepping, AFailedStepIsTriedInHalves) {
  const Scene scene = model_scene("four_bar", {});
  Scene coarse = scene;
  coarse.transient->step = 0.6;
  coarse.transient->duration = 36;
  const Stepped without = step_through(coarse, {.max_halvings = 0, .newton = {}});
  EXPECT_FALSE(without.last.converged);
  EXPECT_EQ(without.last.failure.find("even with"), std::string::npos) << without.last.failure;
  const Stepped with = step_through(coarse, {.newton = {}});
  ASSERT_TRUE(with.last.converged) << with.last.failure;
  EXPECT_GT(with.counters.retries, 0);
  EXPECT_GT(with.counters.substeps, with.counters.steps);
  EXPECT_EQ(with.counters.steps, 60);
  EXPECT_NEAR(with.state.t, 36, 1e-12);
}

// The row of a driven angle holds half a turn away as well. Steps so large that Newton's iterations end there
// are halved, or the run fails by name.
TEST(Stepping, ADriveStaysOnItsBranch) {
  for (const char* const h : {"0.25", "0.2", "0.125", "0.1", "0.05"}) {
    const Scene scene = scene_of(R"xml(<parameter name="h" value="1"/>
        <body name="disk" mass="1" inertia="1 1 2"/>
        <revolute name="R" between="ground disk" axis="0 0 1"/>
        <drive joint="R" angle="3*(1-cos(8*t))"/>
        <transient duration="2" step="h" rho_infinity="0.5"/>)xml",
                                 {{"h", h}});
    const auto on_branch = [](const Stepped& s) {
      if (!s.last.converged) return;
      const double angle = 2.0 * std::atan2(s.state.pose[1].p.z(), s.state.pose[1].p.w());
      EXPECT_GT(std::cos(angle - 3 * (1 - std::cos(8 * s.state.t))), 0.999) << s.state.t;
    };
    for (const int halvings : {0, 5}) {
      const Stepped s = step_through(scene, {.max_halvings = halvings, .newton = {}}, on_branch);
      // The disk turns by up to 2.4 rad in 0.1 s, by up to 1.2 rad in 0.05 s; 1.5 rad are refused.
      if (scene.transient->step <= (halvings > 0 ? 0.1 : 0.05)) {
        EXPECT_TRUE(s.last.converged) << s.last.failure;
      }
      if (!s.last.converged) {
        EXPECT_TRUE(s.last.failure.find("drive of 'R'") != std::string::npos ||
                    s.last.failure.find("'disk' turns by more than") != std::string::npos)
            << s.last.failure;
      }
    }
  }
}

// Times carry the round-off of their size; steps must not, for accelerations see it divided by h^2.
TEST(Stepping, LateStepsAreAsEvenAsEarlyOnes) {
  const Model model = compile(model_scene("heavy_top"));
  const auto reaction = [&model](double start) {
    GeneralizedAlpha stepper(*model.system, make_klu_solver(),
                             {.step = 1e-5, .rho_infinity = 0.5, .newton = {}});
    State state = model.initial;
    state.t = start;
    EXPECT_TRUE(stepper.start(state).converged);
    for (int k = 0; k < 50; ++k) EXPECT_TRUE(stepper.step(state).converged);
    return state.lambda;
  };
  const VecX early = reaction(0), late = reaction(1e4);
  EXPECT_LT((late - early).norm(), 1e-9 * early.norm());
}

// A force from just after the start acts from the first step on.
TEST(Stepping, AJumpJustAfterTheStartCounts) {
  const Stepped s = step_through(scene_of(R"xml(<body name="ball" mass="1" inertia="1 1 1"/>
      <load at="ball" force="t&gt;1e-10?1:0 0 0"/>
      <transient duration="0.01" step="1e-3" rho_infinity="0.5"/>)xml"));
  EXPECT_NEAR(s.state.pose[1].r(0), 5e-5, 1e-11);
}

// KLU whose second solver, that of rank-tolerant steps, may lack the diagonal of the multipliers.
class SecondSolver : public AlteredSolver {
 public:
  SecondSolver(bool is_second, bool whole) : is_second_(is_second), whole_(whole) {}
  void analyze(const BlockGraph& graph) override {
    AlteredSolver::analyze(graph);
    if (!is_second_ || whole_) return;
    for (std::size_t i = 0; i < graph.contributions.size(); ++i) {
      const auto& c = graph.contributions[i];
      if (c.row == c.column && is_multiplier(graph, c.row)) drop(i);
    }
  }
  std::unique_ptr<LinearSolver> another() const override {
    return std::make_unique<SecondSolver>(true, whole_);
  }

 private:
  bool is_second_, whole_;
};

// Three windows driven at a quarter turn a second: at 1 s, the end of step 100, all links are in line and the
// constraints have lost rank to the last bit. Only the block -eps I carries the steps there; without it no
// step ends where it should.
TEST(Stepping, EndsStepsInASingularConfiguration) {
  constexpr double rate = 0.5 * 3.14159265358979323846;
  Scene scene = model_scene("windows", {{"N", "3"}, {"step", "0.01"}});
  scene.transient->duration = 1.5;
  for (BodyScene& body : scene.bodies) {
    body.velocity *= rate;
    body.angular_velocity *= rate;
  }
  DriveScene drive;
  drive.joint = "A0";
  drive.angle = Expression::parse("-pi/2*t", {}, Variables::time);
  scene.drives.push_back(drive);
  for (const bool whole : {true, false}) {
    const Model model = compile(scene);
    GeneralizedAlpha stepper(*model.system, std::make_unique<SecondSolver>(false, whole),
                             {.step = 0.01, .rho_infinity = 0.9, .max_halvings = 0, .newton = {}});
    State state = model.initial;
    ASSERT_TRUE(stepper.start(state).converged);
    StepReport report;
    for (int k = 0; k < 150; ++k) {
      report = stepper.step(state);
      if (!report.converged) break;
    }
    if (whole) {
      ASSERT_TRUE(report.converged) << report.failure;
      EXPECT_GT(stepper.counters().tolerant, 0);
      EXPECT_EQ(stepper.counters().retries, 0);
      for (std::size_t n = 1; n <= 4; ++n) {  // the cranks: still parallel
        const double angle = 2.0 * std::atan2(state.pose[n].p.z(), state.pose[n].p.w());
        EXPECT_NEAR(angle, -rate * 1.5, 1e-8);
      }
    } else {
      EXPECT_FALSE(report.converged);
    }
  }
}

// Its first step is rank-tolerant, and rejected.
class RejectedOnce final : public OneStep {
 public:
  explicit RejectedOnce(const System& system)
      : OneStep(system, make_klu_solver(),
                settings_of(GeneralizedAlphaOptions{
                    .tolerances = {.relative = 1e-3}, .end = 1.0, .newton = {}}),
                2) {
    solver_->analyze(system.graph());
  }
  std::vector<bool> tolerant;  // as each step finds it

 private:
  void begin_at(State&) override {}
  bool solve_step(double t, double, StepReport&) override {
    tolerant.push_back(tolerant_);
    tolerant_ = tolerant.size() == 1;
    end_ = begin_;
    end_.t = t;
    return true;
  }
  double estimated_error(bool again) override { return again ? 0.5 : 2.0; }
  void accept() override {}
  void settle() override { tolerant_ = false; }
  void forget() override { tolerant_ = false; }
  const State& solved() const override { return end_; }
};

TEST(Stepping, ARejectedStepLeavesNoRankTolerantTangent) {
  const Model model = compile(model_scene("pendulum"));
  RejectedOnce stepper(*model.system);
  State state = model.initial;
  ASSERT_TRUE(stepper.start(state).converged);
  ASSERT_TRUE(stepper.step(state).converged);
  EXPECT_EQ(stepper.tolerant, (std::vector<bool>{false, false}));
  EXPECT_EQ(stepper.counters().rejected, 1);
  EXPECT_EQ(stepper.counters().tolerant, 0);
}

TEST(Stepping, RefusesOptionsThatMeanNothing) {
  const Model model = compile(model_scene("pendulum"));
  const auto make = [&model](GeneralizedAlphaOptions options) {
    GeneralizedAlpha(*model.system, make_klu_solver(), options);
  };
  EXPECT_THROW(make({.step = 1e-3, .max_halvings = -1, .newton = {}}), Error);
  EXPECT_THROW(make({.step = 1e-3, .max_halvings = 1000, .newton = {}}), Error);
  EXPECT_NO_THROW(make({.step = 1e-3, .max_halvings = 0, .newton = {}}));
}

// ---- what a free system keeps ------------------------------------------------------------------

struct Kept {
  Vec3 momentum, momentum_drift,
      angular_drift;          // after the load, and its largest changes from then on
  double angular = 0.0;       // its size
  double energy_drift = 0.0;  // relative
};

Kept throw_beam(const Overrides& overrides, Balance balance) {
  const Scene scene = model_scene("free_beam", overrides);
  Kept kept;
  Vec6 first = Vec6::Zero(), worst = Vec6::Zero();
  double energy = 0.0;
  bool seen = false;
  const Stepped s = step_through(
      scene,
      {.balance = balance, .newton = {.tolerance = scene.transient->newton_tolerance.value()}},
      [&](const Stepped& now) {
        // The algorithmic rate outlives the load: it decays by 0.73 a step for rho = 0.9.
        if (now.state.t < 5.0 + 100 * scene.transient->step.value()) return;
        const Vec6 p = now.model.system->momentum(now.state);
        const double e = now.model.system->energies(now.state).total();
        if (!seen) first = p, energy = e, seen = true;
        worst = worst.cwiseMax((p - first).cwiseAbs());
        kept.energy_drift = std::max(kept.energy_drift, std::abs(e / energy - 1.0));
      });
  EXPECT_TRUE(s.last.converged) << s.last.failure;
  kept.momentum = first.head<3>();
  kept.momentum_drift = worst.head<3>();
  kept.angular_drift = worst.tail<3>();
  kept.angular = first.tail<3>().norm();
  return kept;
}

// Norms: momentum 100 steps after the load against (50, 0, 0) N.s, and the changes of momentum and angular
// momentum about the origin from then to 15 s, at every step, divided by their sizes. 6 elements of order
// 3, energy form, geodesic metric, h = 25 ms.
class FreeBeam : public testing::TestWithParam<double> {};
TEST_P(FreeBeam, KeepsItsMomenta) {
  const Kept kept =
      throw_beam({{"rho", fmt::format("{}", GetParam())}, {"step", "0.025"}}, Balance::momentum);
  EXPECT_LT((kept.momentum - Vec3(50, 0, 0)).norm(), 1e-10 * 50);
  EXPECT_LT(kept.momentum_drift.norm(), 1e-10 * 50);
  EXPECT_LT(kept.angular_drift.norm(), 1e-10 * kept.angular);
  EXPECT_GT(kept.angular, 100.0);
}
INSTANTIATE_TEST_SUITE_P(Rho, FreeBeam, testing::Values(0.0, 0.5, 0.9, 1.0));

// What the test above sees: the paper's balance, and a force form without self-equilibrium.
TEST(FreeBeamMutation, OtherBalancesDrift) {
  const Kept accelerations = throw_beam({}, Balance::acceleration);
  EXPECT_GT(accelerations.momentum_drift.norm(), 1e-3 * 50);
  Scene paper = model_scene("free_beam");
  paper.beams.front().form = Form::paper;
  Vec6 p = Vec6::Zero();
  step_through(paper, {.balance = Balance::momentum, .newton = {.tolerance = 1e-12}},
               [&p](const Stepped& s) { p = s.model.system->momentum(s.state); });
  EXPECT_GT((p.head<3>() - Vec3(50, 0, 0)).norm(), 1e-6 * 50);
}

// Energy after 5 s: kept to the order of the scheme.
TEST(FreeBeamEnergy, IsKeptToOrderTwo) {
  const std::vector<double> h = {0.00625, 0.003125, 0.0015625};
  std::vector<double> drift;
  for (const double step : h)
    drift.push_back(throw_beam({{"rho", "1"}, {"step", fmt::format("{}", step)}}, Balance::momentum)
                        .energy_drift);
  EXPECT_LT(drift.front(), 1e-4);
  EXPECT_GT(fitted_order(h, drift), 1.8) << testing::PrintToString(drift);
}

// Solver without what the balance of momenta adds to the tangent, (Ad^T p)^U: the last contributions.
class WithoutTurningOfThePast : public AlteredSolver {
 public:
  void analyze(const BlockGraph& graph) override {
    AlteredSolver::analyze(graph);
    std::size_t contribution = graph.contributions.size();
    for (const auto& block : graph.blocks)
      if (block.kind == BlockGraph::Kind::node) drop(--contribution);
  }
};

// Order of Newton's iterations: slope of log e_k+1 against log e_k, e in rad or of the scene's length, over
// first steps of the heavy top that turn it by up to 3 rad; pairs with e_k < 0.1 and e_k+1 > 1e-13.
double newton_order(bool whole_tangent) {
  const Model model = compile(model_scene("heavy_top"));
  std::vector<double> from, to;
  for (const double h : {2e-3, 4e-3, 6e-3, 8e-3, 1e-2, 1.4e-2, 2e-2}) {
    GeneralizedAlphaOptions options{
        .step = h, .rho_infinity = 0.5, .balance = Balance::momentum, .newton = {}};
    options.newton.tangent = NewtonOptions::Tangent::every_iteration;
    options.newton.tolerance = 1e-14;
    options.newton.multiplier_tolerance = 1.0;
    options.max_halvings = 0;
    GeneralizedAlpha stepper(
        *model.system,
        whole_tangent ? make_klu_solver() : std::make_unique<WithoutTurningOfThePast>(), options);
    State state = model.initial;
    EXPECT_TRUE(stepper.start(state).converged);
    const StepReport report = stepper.step(state);
    for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(report.iterations); ++k) {
      const double e = 1e-14 * report.increments.at(k), next = 1e-14 * report.increments.at(k + 1);
      if (!(e < 0.1 && next > 1e-13)) continue;
      from.push_back(e);
      to.push_back(next);
    }
  }
  EXPECT_GE(from.size(), 5u);  // measured: 6 above the floor of round-off
  return fitted_order(from, to);
}
TEST(MomentumBalance, NewtonIsQuadratic) { EXPECT_GE(newton_order(true), 1.8); }
TEST(MomentumBalanceMutation, NewtonWithoutTheTurningOfThePast) {
  EXPECT_LT(newton_order(false), 1.4);
}

// Torque-free body that flips: its angular momentum in inertial axes, and order two of its velocities
// against the closed solution (models/dzhanibekov.xml).
TEST(MomentumBalance, DzhanibekovKeepsAngularMomentumAtOrderTwo) {
  const Vec3 exact(-.064882609540, 4.999589007806, .038339505390);  // at 1 s
  const std::vector<double> h = {8e-3, 4e-3, 2e-3, 1e-3};
  for (const double rho : {0.0, 0.8}) {
    std::vector<double> error;
    for (const double step : h) {
      Scene scene = model_scene("dzhanibekov");
      scene.transient->step = step;
      scene.transient->duration = 1.0;
      scene.transient->rho_infinity = rho;
      Vec6 start = Vec6::Zero();
      double drift = 0.0;
      const Stepped s =
          step_through(scene, {.balance = Balance::momentum, .newton = {.tolerance = 1e-14}},
                       [&](const Stepped& now) {
                         const Vec6 p = now.model.system->momentum(now.state);
                         if (start.isZero()) start = p;
                         drift = std::max(drift, (p - start).norm() / start.norm());
                       });
      EXPECT_LT(drift, 1e-12);
      error.push_back((s.state.V[1].tail<3>() - exact).norm() / exact.norm());
    }
    EXPECT_NEAR(fitted_order(h, error), 2.0, 0.1) << testing::PrintToString(error);
  }
}

}  // namespace
}  // namespace mbd::test::test_stepping
