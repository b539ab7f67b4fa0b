// Steps of every size, and very many of them.
//
// From saved states of four_bar and shaft, 1000 steps of each size from 1e-7 to 0.1 s: each run converges or ends
// cleanly, with iterations that do not grow as steps shrink, on the trajectory of an adaptive integration by
// another method. What round-off leaves of velocities (eps/h) and multipliers (eps/h^2) is measured, and is what
// the stepper says of itself. A million steps of the heavy top and of a spinning shaft stay within bounds of drift
// and of spurious energy that their invariants and closed forms give.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libmbd/compile/time_stepping.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tests/hard/hard_case.hpp"
#include "tests/hard/whirl.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_steps {
namespace {

constexpr long thousand = 1000;

struct Saved {
  Model model;
  State state;
};

// The state of a model at t, in motion; its signals go on for a thousand steps of 0.1 s.
Saved saved_state(const std::string& name, double t) {
  Scene scene = model_scene(name);
  scene.transient->duration = t + 101.0;
  Saved saved;
  saved.model = compile(scene);
  saved.state = start_of(scene, saved.model);
  const auto stepper = radau({.tolerances = {.relative = 1e-9}, .end = t})(*saved.model.system);
  StepReport report = stepper->start(saved.state);
  while (report.converged && saved.state.t < t) report = stepper->step(saved.state);
  EXPECT_TRUE(report.converged) << report.failure;
  return saved;
}

enum class By { generalized_alpha, radau };
std::string name_of(By method) { return method == By::radau ? "radau" : "generalized_alpha"; }

MakeStepper fixed(By method, double h) {
  return method == By::radau ? radau({.step = h}) : generalized_alpha({.step = h, .newton = {}});
}

struct ManySteps {
  State state;
  long done = 0;
  int most_iterations = 0;
  Counters counters;
  StepReport last;
  double g = 0.0, gdot = 0.0;     // largest of all steps
  std::vector<VecX> multipliers;  // after each step
  std::optional<RoundOff> round_off;
};

ManySteps take_steps(const Saved& saved, By method, double h, long count = thousand) {
  const System& system = *saved.model.system;
  const auto stepper = fixed(method, h)(system);
  ManySteps m;
  m.state = saved.state;
  m.last = stepper->start(m.state);
  while (m.last.converged && m.done < count) {
    m.last = stepper->step(m.state);
    if (!m.last.converged) break;
    ++m.done;
    m.most_iterations = std::max(m.most_iterations, m.last.iterations);
    m.multipliers.push_back(m.state.lambda);
    const ConstraintResiduals c = constraint_residuals(system, m.state);
    m.g = std::max(m.g, c.position), m.gdot = std::max(m.gdot, c.velocity);
  }
  m.counters = stepper->counters();
  m.round_off = stepper->round_off();
  return m;
}

bool is_finite(const State& state) {
  bool finite = state.lambda.allFinite();
  for (std::size_t n = 0; n < state.pose.size(); ++n)
    finite = finite && state.pose[n].r.allFinite() && state.pose[n].p.coeffs().allFinite() &&
             state.V[n].allFinite() && state.Vdot[n].allFinite();
  return finite;
}

// Largest difference of positions, of the size of the scene.
double distance(const System& system, const State& a, const State& b) {
  double d = 0.0;
  for (std::size_t n = 1; n < a.pose.size(); ++n)
    d = std::max(d, (a.pose[n].r - b.pose[n].r).norm());
  return d / system.length_scale();
}

State reference(const Saved& saved, double span, double tolerance) {
  State state = saved.state;
  const auto stepper =
      radau({.tolerances = {.relative = tolerance}, .end = state.t + span})(*saved.model.system);
  StepReport report = stepper->start(state);
  while (report.converged && state.t < saved.state.t + span * (1.0 - 1e-12))
    report = stepper->step(state);
  EXPECT_TRUE(report.converged) << report.failure;
  return state;
}

struct Start {
  const char* model;
  double t;
};
void PrintTo(const Start& s, std::ostream* out) { *out << s.model << " at " << s.t << " s"; }
// Before the first change point; and above 0.8 times the critical speed, while it is driven through it.
constexpr Start starts[] = {{"four_bar", 3.0}, {"shaft", 1.1}};
// Of generalized-alpha: error after a thousand steps over h^2 [1/s^2], as the curvature of the motions asks for.
double second_order(const Start& start) {
  return start.model == std::string("shaft") ? 20.0 : 1e-3;
}

class StepsSlow : public testing::TestWithParam<Start> {};

TEST_P(StepsSlow, OfEverySizeConverge) {
  const Saved saved = saved_state(GetParam().model, GetParam().t);
  const System& system = *saved.model.system;
  double worst = 0.0, most = 0.0;  // error of its bound; iterations a step
  for (const double h : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
    for (const By method : {By::generalized_alpha, By::radau}) {
      const ManySteps m = take_steps(saved, method, h);
      const std::string what = fmt::format("{} h = {:.0e}", name_of(method), h);
      EXPECT_EQ(m.done, thousand) << what << ": " << m.last.failure;
      EXPECT_TRUE(is_finite(m.state)) << what;
      EXPECT_EQ(m.counters.retries, 0) << what;
      if (h > 1e-3) continue;  // longer than the fastest motions: what they do is checked below
      const double iterations = static_cast<double>(m.counters.iterations) / thousand;
      EXPECT_LE(iterations, method == By::radau ? 6.0 : 2.5) << what;
      most = std::max(most, iterations);
      EXPECT_LE(m.g, 1e-11) << what;
      if (h > 1e-4) continue;
      const State exact = reference(saved, thousand * h, h < 1e-4 ? 1e-11 : 1e-10);
      const double bound = 1e-10 + (method == By::radau ? 0.0 : second_order(GetParam()) * h * h);
      const double error = distance(system, m.state, exact);
      EXPECT_LE(error, bound) << what;
      worst = std::max(worst, error / bound);
    }
  }
  const bool shaft = GetParam().model == std::string("shaft");
  hard::record(
      {.id = shaft ? "4b" : "4a",
       .what = fmt::format("1000 steps each of 1e-7 … 1e-2 s from {} at {} s, two methods",
                           GetParam().model, GetParam().t),
       .run = "in C++",
       .reference = "Radau in adaptive steps, tolerance 1e-11, 1e-10 (h to 1e-4)",
       .error = fmt::format(
           "all converge, at most {:.1f} iterations a step; positions {:.1g} of the bound "
           "1e-10 + {:.0e} h^2",
           most, worst, second_order(GetParam())),
       .shown =
           "no floor of round-off in the norm of increments (in the engine): not done in 25 s"});
}

// Too long for the motions: the shaft turns by 6.5 rad a step, the four-bar meets its change points.
TEST_P(StepsSlow, ThatAreFarTooLongEndCleanly) {
  const Saved saved = saved_state(GetParam().model, GetParam().t);
  std::string how;
  for (const By method : {By::generalized_alpha, By::radau}) {
    const ManySteps m = take_steps(saved, method, 0.1);
    EXPECT_TRUE(is_finite(m.state)) << name_of(method);
    EXPECT_LE(m.g, 1e-8) << name_of(method);
    if (m.done < thousand) {
      EXPECT_FALSE(m.last.converged);
      EXPECT_NE(m.last.failure.find("from t = "), std::string::npos) << m.last.failure;
    }
    how += fmt::format("{}{}: {}", how.empty() ? "" : "; ", name_of(method),
                       m.done == thousand ? "to the end" : "ends with a reason");
  }
  hard::record(
      {.id = GetParam().model == std::string("shaft") ? "4d" : "4c",
       .what = fmt::format("1000 steps of 0.1 s from {} at {} s", GetParam().model, GetParam().t),
       .run = "in C++",
       .reference = "constraints hold to 1e-8, states stay finite, a failure has a reason",
       .error = how,
       .shown = GetParam().model == std::string("shaft")
                    ? "not shown: no step fails"
                    : "steps that did not converge accepted (in the engine)"});
}

INSTANTIATE_TEST_SUITE_P(From, StepsSlow, testing::ValuesIn(starts),
                         [](const auto& s) { return std::string(s.param.model); });

// Noise of the multipliers that are forces: third differences over the steps, in which smooth motion vanishes;
// those of independent noise are sqrt(20) times as large.
double force_noise(const System& system, const std::vector<VecX>& lambda) {
  double worst = 0.0;
  for (const ConstraintInfo& c : system.constraints())
    for (Index i = 0; i < c.rows; ++i) {
      if (!c.is_position[static_cast<std::size_t>(i)]) continue;
      const Index row = c.first_row + i;
      double sum = 0.0;
      for (std::size_t k = 103; k < lambda.size(); ++k) {
        const double d =
            lambda[k](row) - 3 * lambda[k - 1](row) + 3 * lambda[k - 2](row) - lambda[k - 3](row);
        sum += d * d;
      }
      worst = std::max(worst, std::sqrt(sum / 20.0 / static_cast<double>(lambda.size() - 103)));
    }
  return worst;
}

// gdot of generalized-alpha, which constrains positions only, and multipliers.
TEST(RoundOffOfSteps, IsWhatTheStepperSays) {
  std::string reached;
  for (const Start& start : starts) {
    const Saved saved = saved_state(start.model, start.t);
    const System& system = *saved.model.system;
    const double steps[] = {1e-8, 1e-7, 1e-6};
    std::vector<double> h, velocity, force, said_velocity, said_force;
    for (const double step : steps) {
      const ManySteps m = take_steps(saved, By::generalized_alpha, step);
      ASSERT_TRUE(m.round_off.has_value());
      h.push_back(step);
      velocity.push_back(m.gdot);
      force.push_back(force_noise(system, m.multipliers));
      said_velocity.push_back(m.round_off->velocity);
      said_force.push_back(m.round_off->force);
      const std::string what = fmt::format("{} h = {:.0e}", start.model, step);
      EXPECT_GE(said_force.back(), force.back()) << what;
      EXPECT_LE(said_force.back(), 1e4 * force.back()) << what;
      EXPECT_GE(said_velocity.back(), 0.03 * velocity.back()) << what;
      EXPECT_LE(said_velocity.back(), 1e2 * velocity.back()) << what;
      reached += fmt::format("{}{} h = {:.0e}: {:.0e} of {:.0e} m/s, {:.0e} of {:.0e} N",
                             reached.empty() ? "" : "; ", start.model, step, velocity.back(),
                             said_velocity.back(), force.back(), said_force.back());
    }
    // eps/h and eps/h^2.
    EXPECT_NEAR(fitted_order(h, velocity), -1.0, 0.2) << start.model;
    // At 1 us round-off of elastic forces, which does not depend on h, begins to show; and noise of so many steps in
    // a row is not independent: of the four-bar it is far below eps/h^2. What holds is the bound above.
    EXPECT_LT(fitted_order(h, force), 0.0) << start.model;
    EXPECT_NEAR(fitted_order(h, said_force), -2.0, 0.1) << start.model;
    // Constraints of velocities: eps/h.
    const ManySteps r = take_steps(saved, By::radau, 1e-7);
    ASSERT_TRUE(r.round_off.has_value());
    EXPECT_LE(r.round_off->force, 1e-2 * said_force[1]) << start.model;
    EXPECT_LE(r.gdot, 1e-2 * velocity[1]) << start.model;
    reached += fmt::format(", orders {:.2f} and {:.2f}", fitted_order(h, velocity),
                           fitted_order(h, force));
    reached += fmt::format("; radau h = 1e-07: {:.0e} m/s, {:.0e} of {:.0e} N", r.gdot,
                           force_noise(system, r.multipliers), r.round_off->force);
  }
  hard::record(
      {.id = "4e",
       .what = "noise of velocities (eps/h) and of multipliers (eps/h^2), measured and as reported",
       .run = "in C++; `report.json`, `round_off_of_the_last_step`",
       .reference = "third differences over 900 steps: what is said is at least the force's, at "
                    "most 1e4 times; of "
                    "velocities 0.03 to 100 times; orders -1, and below 0",
       .error = reached,
       .shown = "Radau's constraints of velocities: a hundredth of it (in the test)"});
}

// A pendulum in steps of 10 ns says that its forces are noise; in steps of 1 ms it does not.
TEST(RoundOffOfSteps, IsSaidToTheUser) {
  const auto run_with = [](double step, long count) {
    Scene scene = model_scene("heavy_top");
    scene.transient->step = step;
    scene.transient->duration = static_cast<double>(count) * step;
    return run(scene);
  };
  const auto has_note = [](const RunReport& report) {
    for (const std::string& note : report.notes)
      if (note.find("round-off of positions") != std::string::npos) return true;
    return false;
  };
  const RunReport tiny = run_with(1e-9, 2000), usual = run_with(1e-4, 2000);
  EXPECT_TRUE(tiny.complete()) << tiny.failure;
  ASSERT_TRUE(tiny.round_off && usual.round_off);
  EXPECT_TRUE(has_note(tiny));
  EXPECT_FALSE(has_note(usual));
  EXPECT_NE(to_json(tiny).find("round_off_of_the_last_step"), std::string::npos);
  // eps of a metre, over beta h^2 with beta of rho_infinity = 0.9, times 15 kg: within a factor of ten.
  const double beta = generalized_alpha_parameters(0.9).beta, expected = 15 * eps / (beta * 1e-18);
  EXPECT_GT(tiny.round_off->force, 0.1 * expected);
  EXPECT_LT(tiny.round_off->force, 10 * expected);
  hard::record(
      {.id = "4f",
       .what = "heavy_top in steps of 1 ns: the run says that its forces are noise",
       .run = "`mbd run models/heavy_top.xml --set step=1e-9` (longer)",
       .reference = "15 kg eps 1 m/(beta h^2)",
       .error = fmt::format("said {:.1e} N, expected {:.1e} N (within 10 times); no note at 0.1 ms",
                            tiny.round_off->force, expected),
       .shown = "steps of 0.1 ms: no note (in the test)"});
}

// 1/(|S| |S^-1|), 1-norms.
double reciprocal_condition(const Eigen::MatrixXd& S, const Eigen::MatrixXd& inverse) {
  const auto norm = [](const Eigen::MatrixXd& A) {
    return A.cwiseAbs().colwise().sum().maxCoeff();
  };
  return 1.0 / (norm(S) * norm(inverse));
}

// The matrix (2) of generalized-alpha, S, and the one without its scaling, U = diag(1/s, 1) S diag(1, s): forces in
// newtons in rows of motion, multipliers as they are. U is too badly conditioned to be inverted; its inverse follows
// from that of S.
TEST(Scaling, KeepsTheConditionAsStepsShrink) {
  const GeneralizedAlphaParameters a = generalized_alpha_parameters(0.0);
  std::string reached;
  for (const Start& start : starts) {
    const Saved saved = saved_state(start.model, start.t);
    const System& system = *saved.model.system;
    const Index motions = 6 * (system.nodes() - 1);
    DenseSolver S;
    S.analyze(system.graph());
    VecX r;
    double least = 1.0, least_unscaled = 1.0, most_unscaled = 0.0;
    for (const double h : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
      const double s = a.beta * h * h, m = (1.0 - a.alpha_m) / (1.0 - a.alpha_f);
      system.linearize(saved.state, {.U = s, .V = a.gamma * h, .A = m, .T_inv = {}}, r, S);
      Eigen::MatrixXd matrix = S.matrix(), inverse = dense::inverse(matrix);
      EXPECT_LE((matrix * inverse - Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-6);
      const double scaled = reciprocal_condition(matrix, inverse);
      matrix.topRows(motions) /= s;
      matrix.rightCols(matrix.cols() - motions) *= s;
      inverse.leftCols(motions) *= s;
      inverse.bottomRows(matrix.rows() - motions) /= s;
      const double unscaled = reciprocal_condition(matrix, inverse);
      EXPECT_GT(scaled, 1e3 * unscaled) << start.model << " h = " << h;
      least = std::min(least, scaled);
      least_unscaled = std::min(least_unscaled, unscaled);
      most_unscaled = std::max(most_unscaled, unscaled);
    }
    EXPECT_GT(least, 1e-9) << start.model;
    const ManySteps taken = take_steps(saved, By::generalized_alpha, 1e-7, 10);
    ASSERT_TRUE(taken.round_off.has_value());
    EXPECT_GT(taken.round_off->reciprocal_condition, 1e-10) << start.model;
    reached += fmt::format("{}{}: {:.0e} or better (KLU says {:.0e}), unscaled {:.0e} … {:.0e}",
                           reached.empty() ? "" : "; ", start.model, least,
                           taken.round_off->reciprocal_condition, least_unscaled, most_unscaled);
  }
  hard::record({.id = "4g",
                .what = "reciprocal condition of the iteration matrix, h = 1e-3 … 1e-7 s",
                .run = "in C++; `report.json`, `reciprocal_condition`",
                .reference = "1-norms by a dense inverse; the unscaled matrix",
                .error = reached,
                .shown = "no scaling (in the test)"});
}

struct Drift {
  double g = 0.0, gdot = 0.0;  // largest
  double energy = 0.0;         // largest change, of the kinetic energy at the start
  double momentum = 0.0;       // of the vertical angular momentum
  double spin = 0.0;           // of the rate about the axis of symmetry
};

Drift drift_of_the_top(const MakeStepper& make, long count) {
  const Scene scene = model_scene("heavy_top");
  const Model model = compile(scene);
  const System& system = *model.system;
  State state = model.initial;
  const auto stepper = make(system);
  StepReport report = stepper->start(state);
  const Energies before = system.energies(state);
  const double L = system.momentum(state)(5), spin = state.V[1](4);
  Drift d;
  for (long k = 0; k < count && report.converged; ++k) {
    report = stepper->step(state);
    if (k % 100 != 99) continue;
    const ConstraintResiduals c = constraint_residuals(system, state);
    d.g = std::max(d.g, c.position), d.gdot = std::max(d.gdot, c.velocity);
    d.energy = std::max(d.energy,
                        std::abs(system.energies(state).total() - before.total()) / before.kinetic);
    d.momentum = std::max(d.momentum, std::abs(system.momentum(state)(5) - L) / std::abs(L));
    d.spin = std::max(d.spin, std::abs(state.V[1](4) - spin) / std::abs(spin));
  }
  EXPECT_TRUE(report.converged) << report.failure;
  return d;
}

std::string words(const Drift& d) {
  return fmt::format("g {:.0e} m, gdot {:.0e} m/s, energy {:.0e}, momentum {:.0e}, spin {:.0e}",
                     d.g, d.gdot, d.energy, d.momentum, d.spin);
}

// `bounds` in the order of Drift.
void check(const Drift& d, const Drift& bounds) {
  EXPECT_LE(d.g, bounds.g);
  EXPECT_LE(d.gdot, bounds.gdot);
  EXPECT_LE(d.energy, bounds.energy);
  EXPECT_LE(d.momentum, bounds.momentum);
  EXPECT_LE(d.spin, bounds.spin);
}

TEST(MillionStepsSlow, OfTheHeavyTopByGeneralizedAlpha) {
  const Drift d = drift_of_the_top(
      generalized_alpha(
          {.step = 1e-4, .rho_infinity = 0.9, .balance = Balance::momentum, .newton = {}}),
      1000000);
  const Drift bounds{1e-14, 1e-9, 1e-5, 1e-8, 1e-5};
  check(d, bounds);
  const Drift longer = drift_of_the_top(
      generalized_alpha(
          {.step = 1e-3, .rho_infinity = 0.9, .balance = Balance::momentum, .newton = {}}),
      100000);
  EXPECT_GT(longer.energy, bounds.energy);
  hard::record(
      {.id = "4h",
       .what = "1e6 steps of 0.1 ms of heavy_top by generalized-alpha, momenta balanced (100 s, "
               "2400 turns)",
       .run = "in C++",
       .reference = "conservation; the symmetric top keeps its spin",
       .error = words(d) + "; bounds " + words(bounds) + " (energy, momentum, spin relative)",
       .shown = fmt::format("steps of 1 ms: energy {:.0e} (in the test)", longer.energy)});
}

TEST(MillionStepsSlow, OfTheHeavyTopByRadau) {
  const Drift d = drift_of_the_top(radau({.step = 5e-4}), 1000000);
  const Drift bounds{1e-14, 1e-11, 2e-5, 1e-4, 2e-9};  // of the spin: ten eps a step
  check(d, bounds);
  hard::record(
      {.id = "4i",
       .what = "1e6 steps of 0.5 ms of heavy_top by Radau (500 s, 12 000 turns)",
       .run = "in C++",
       .reference = "conservation; the symmetric top keeps its spin",
       .error = words(d) + "; bounds " + words(bounds) + " (energy, momentum, spin relative)",
       .shown = "steps of 1 ms: energy 1e-4, momentum 6e-4"});
}

// thousand_turns, each turn in a thousand steps. What its start leaves ringing must not grow.
TEST(MillionStepsSlow, OfASpinningShaft) {
  const Scene scene =
      read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models" / "hard" / "thousand_turns.xml",
                 {{"step", "2*pi/omega/1000"}});
  const Model model = compile(scene);
  const System& system = *model.system;
  State state = model.initial;
  const auto stepper = make_stepper(system, *scene.transient);
  StepReport report = stepper->start(state);
  const PlaneBeam beam{1.449e5, 1.623e7, 1.93, 2.227e-3, 900.0, 1.0};
  const double w = whirl(beam, 6.0, 40.0, 1e-4);
  std::vector<double> row(columns(model).size());
  std::size_t u2 = 0, u3 = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (columns(model)[i].name == "M.displacement_local.2") u2 = i;
    if (columns(model)[i].name == "M.displacement_local.3") u3 = i;
  }
  constexpr long count = 1001000, window = 20000;
  double early = 0.0, late = 0.0, g = 0.0, gdot = 0.0, spurious = 0.0, moved = 0.0;
  for (long k = 1; k <= count && report.converged; ++k) {
    report = stepper->step(state);
    if (k % 10 != 0) continue;
    const bool first = k > 3000 && k <= 3000 + window, last = k > count - window;
    if (first || last) {
      sample_row(model, state, row);
      double& ringing = first ? early : late;
      ringing = std::max(ringing, std::hypot(row[u2], row[u3] - w) / w);
    }
    if (k % 1000 != 0) continue;
    const ConstraintResiduals c = constraint_residuals(system, state);
    g = std::max(g, c.position);
    if (k > 3000 + window) gdot = std::max(gdot, c.velocity);  // the drive goes evenly
    const double total = system.energies(state).total();
    moved = std::max(moved, std::abs(total));
    spurious = std::max(spurious, std::abs(total - state.work.drives));
  }
  ASSERT_TRUE(report.converged) << report.failure;
  EXPECT_LE(late, 1.001 * early);
  EXPECT_LE(g, 1e-14);
  EXPECT_LE(gdot, 3e-8);  // of 30 rad/s: 1e-9
  EXPECT_LE(spurious, 1e-5 * moved);
  hard::record(
      {.id = "4j",
       .what = "1e6 steps of a spinning shaft (1000 turns)",
       .run = "`mbd run models/hard/thousand_turns.xml --set step=2*pi/omega/1000`",
       .reference = "steady whirl; work of the drive; constraints",
       .error = fmt::format(
           "ringing {:.2g} -> {:.2g} of the deflection (may not grow), energy {:.0e} of itself "
           "(bound 1e-5), g {:.0e} rad (1e-14), gdot {:.0e} rad/s (3e-8)",
           early, late, spurious / moved, g, gdot),
       .shown = "gamma - 0.05 (in the engine): does not stay on its way"});
}

}  // namespace
}  // namespace mbd::test::test_steps
