// IDA on stabilised equations of index 2: tangent, accuracy, constraints, landings, dense output, messages.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/error.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/ida.hpp"
#include "solvers/time/stabilized_index2.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_ida {
namespace {

using Vector = Eigen::VectorXd;

std::span<double> span_of(Vector& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

Scene scene_of(const std::string& items, const Overrides& overrides = {}) {
  return read_model_text("<mbd name=\"test\">" + items + "</mbd>", "test.xml", overrides);
}

Model compiled(const std::string& name, double duration) {
  Scene scene = model_scene(name);
  scene.transient->duration = duration;
  return compile(scene);
}

// Columns of one record at a state.
double value_of(const Model& model, const std::string& name, const State& state) {
  for (const Channel& channel : model.channels)
    for (std::size_t i = 0; i < channel.columns.size(); ++i)
      if (channel.columns[i].name == name) {
        std::vector<double> x(channel.columns.size());
        channel.sample(state, x);
        return x[i];
      }
  throw std::runtime_error("there is no column " + name);
}

struct Reached {
  State state;
  Counters counters;
  StepSizes sizes;
  StepReport last;
  double g = 0.0, gdot = 0.0;  // largest of accepted states
};

// Steps to options.end, or a failure.
Reached go(const Model& model, const IdaOptions& options,
           const std::function<void(const DenseStep&)>& observer = {}) {
  Reached r;
  r.state = model.initial;
  Ida ida(*model.system, make_klu_solver(), options);
  if (observer) ida.on_substep(observer);
  r.last = ida.start(r.state);
  while (r.last.converged && r.state.t < options.end) {
    r.last = ida.step(r.state);
    const ConstraintResiduals c = constraint_residuals(*model.system, r.state);
    r.g = std::max(r.g, c.position);
    r.gdot = std::max(r.gdot, c.velocity);
  }
  EXPECT_TRUE(r.last.converged) << r.last.failure;
  r.counters = ida.counters();
  r.sizes = ida.sizes();
  return r;
}

// ---- the tangent ------------------------------------------------------------------------------

// (dF/dy + c dF/dydot) times what solve() makes of b is b, by differences of the residual: at a large motion,
// off the kinematics, with mu = 0 and quaternions that are not of unit length.
TEST(Ida, TangentIsThatOfTheResidual) {
  const Model model = compile(scene_of(R"xml(
    <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="300" EI2="400" EI3="500"/>
      <mass per_length="2" inertia="3e-2 1e-2 2e-2"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0.5 0" normal="0 0 1" order="2"/>
    <body name="k" at="1 0.5 0" mass="3" inertia="1 2 3"/>
    <body name="l" at="2 0.5 0" mass="2" inertia="3 2 2"/>
    <revolute name="A" between="ground b.start" axis="0 0 1"/>
    <drive joint="A" rate="2*sin(3*t)"/>
    <spherical name="S" between="b.end k" at="1 0.5 0"/>
    <cylindrical name="C" between="k l" at="2 0.5 0" axis="1 0 0"/>
    <gravity acceleration="0 -9.81 0"/>
    <transient duration="1" step="1e-2"/>)xml"));
  const System& system = *model.system;
  Rng rng(7);
  State state = model.initial;
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    state.pose[n] = state.pose[n] * exp_se3<double>(random_vector<6>(rng, 0.2));
    state.V[n] = random_vector<6>(rng, 3.0);
    state.Vdot[n] = random_vector<6>(rng, 20.0);
  }
  for (Index i = 0; i < state.lambda.size(); ++i) state.lambda(i) = uniform(rng, -50.0, 50.0);
  StabilizedIndex2 equations(system, make_klu_solver());
  const Index size = equations.size(), motions = equations.first_lambda();
  Vector y(size), ydot(size);
  equations.pack(state, span_of(y), span_of(ydot));
  for (Index i = 0; i < motions; ++i) ydot(i) += uniform(rng, -1.0, 1.0);
  for (Index i = 0; i < motions; i += StabilizedIndex2::per_node) y.segment<4>(i + 3) *= 1.07;
  for (const double c : {30.0, 3e3}) {
    ASSERT_TRUE(equations.linearize(0.3, span_of(y), span_of(ydot), c));
    ASSERT_EQ(equations.factor(), FactorStatus::ok);
    // Rows by the powers of c at which increments of all unknowns are alike.
    Vector b(size), scale = Vector::Constant(size, 1.0 / c);
    for (Index i = 0; i < motions; i += StabilizedIndex2::per_node)
      scale.segment<6>(i + 7).setOnes();
    scale.tail(size - equations.first_mu()).setConstant(1.0 / (c * c));
    for (Index i = 0; i < size; ++i) b(i) = scale(i) * uniform(rng, -1.0, 1.0);
    Vector dy = b;
    equations.solve(span_of(dy));
    const auto F = [&](double s) {
      Vector at = y + s * dy, rate = ydot + s * c * dy, f(size);
      equations.residual(0.3, span_of(at), span_of(rate), span_of(f));
      return f;
    };
    const double s = 1e-3 / dy.head(motions).cwiseAbs().maxCoeff();
    const Vector product = (8.0 * (F(s) - F(-s)) - (F(2.0 * s) - F(-2.0 * s))) / (12.0 * s);
    for (Index i = 0; i < size; ++i)
      EXPECT_NEAR(product(i), b(i), 1e-7 * scale(i)) << equations.name_of(i) << ", component " << i;
  }
}

// ---- accuracy ---------------------------------------------------------------------------------

struct Reference {
  std::string model, quantity;
  double t = 0.0;
  Vec3 value;
  double size = 1.0;  // of the quantity, for tolerances
};

// Errors are local tolerances times what the motion and the number of steps make of them: within a hundred
// tolerances for these times. Constraints hold to the tolerance, of lengths and of the speeds met.
TEST(Ida, ErrorsGoWithTheTolerance) {
  const Reference references[] = {
      {"pendulum", "bob.position", 1, {.98629175113, -.16501085313, 0}, 1},
      {"heavy_top", "top.position", .2, {.60555056138, .59895768179, -.52398302743}, 1},
      {"dzhanibekov",
       "wing.angular_velocity_local",
       1,
       {-.064882609540, 4.999589007806, .038339505390},
       5}};
  for (const Reference& reference : references) {
    const Model model = compiled(reference.model, reference.t);
    std::vector<double> errors;
    for (const double relative : {1e-6, 1e-8, 1e-10}) {
      double fastest = 1.0;
      const Reached r = go(model, {.tolerances = {.relative = relative}, .end = reference.t},
                           [&](const DenseStep& step) {
                             State end = model.initial;
                             step.at(step.end(), end);
                             for (const Vec6& V : end.V)
                               fastest = std::max(fastest, V.cwiseAbs().maxCoeff());
                           });
      EXPECT_EQ(r.state.t, reference.t);
      double error = 0.0;
      for (int i = 0; i < 3; ++i)
        error = std::max(
            error,
            std::abs(value_of(model, reference.quantity + "." + std::to_string(i + 1), r.state) -
                     reference.value(i)));
      const std::string where = fmt::format("{} at tolerance {}", reference.model, relative);
      EXPECT_LE(error, 100.0 * relative * reference.size) << where;
      errors.push_back(error);
      EXPECT_LE(r.g, relative * model.system->length_scale()) << where;
      EXPECT_LE(r.gdot, 2.0 * relative * fastest) << where;
      EXPECT_LE(r.counters.iterations, 2.5 * static_cast<double>(r.counters.steps)) << where;
      EXPECT_LE(3 * r.counters.tangents, r.counters.steps) << where;
      EXPECT_EQ(r.counters.restarts, 0) << where;
      RecordProperty(
          fmt::format("{}_{:.0e}", reference.model, relative),
          fmt::format("error {:.2e} g {:.1e} gdot {:.1e} steps {} iterations {} tangents {}", error,
                      r.g, r.gdot, r.counters.steps, r.counters.iterations, r.counters.tangents));
      for (const Pose<double>& H : r.state.pose) EXPECT_NEAR(H.p.norm(), 1.0, 1e-15);
    }
    EXPECT_LE(errors[2], 1e-2 * errors[0]) << reference.model;
  }
}

// Stiff and undamped: order 2. u3 of C is tiny yet, 6 um of the 4 mm of a turn.
TEST(Ida, FourBarFollowsItsReference) {
  const Table reference = reference_table("four_bar");
  constexpr std::size_t row = 56;
  const double t = reference["t"].at(row);
  const Model model = compiled("four_bar", t);
  const Reached r = go(model, {.tolerances = {.relative = 1e-6}, .end = t, .max_order = 2});
  EXPECT_NEAR(t, 0.504, 1e-12);
  EXPECT_NEAR(value_of(model, "C.displacement.3", r.state), reference["uC3"].at(row),
              1e-9 * 4.26e-3);
  EXPECT_NEAR(value_of(model, "C.displacement.1", r.state), reference["uC1"].at(row), 1e-9);
  EXPECT_NEAR(value_of(model, "A.angle", r.state), reference["theta"].at(row), 1e-9);
  EXPECT_LE(r.g, 1e-8);
  const double energy = model.system->energies(r.state).total();
  EXPECT_NEAR(energy, reference["energy"].at(row), 1e-3 * energy);
  EXPECT_NEAR(r.state.work.drives, energy, 1e-3 * energy);
}

// ---- landings and dense output ----------------------------------------------------------------

constexpr const char* jumping_ball = R"xml(
    <body name="ball" mass="2" inertia="1 1 1"/>
    <load at="ball" force="t&lt;0.505?0:t&lt;0.7031?6:-1 0 0"/>
    <transient duration="1" step="0.01"/>)xml";

TEST(Ida, LandsOnJumps) {
  const Model model = compile(scene_of(jumping_ball));
  std::vector<double> ends;
  std::vector<double> at_ends;
  const Reached r =
      go(model, {.tolerances = {.relative = 1e-9}, .end = 1.0}, [&](const DenseStep& step) {
        State state = model.initial;
        step.at(step.end(), state);
        ends.push_back(step.end());
        at_ends.push_back(state.signals.at(0).f);
      });
  const double v1 = 3.0 * (0.7031 - 0.505), x1 = 1.5 * std::pow(0.7031 - 0.505, 2);
  const double T = 1.0 - 0.7031;
  EXPECT_NEAR(r.state.pose[1].r(0), x1 + v1 * T - 0.25 * T * T, 1e-8);
  EXPECT_NEAR(r.state.V[1](0), v1 - 0.5 * T, 1e-8);
  EXPECT_NEAR(r.state.work.loads, model.system->energies(r.state).kinetic, 1e-8);
  EXPECT_EQ(r.state.t, 1.0);
  EXPECT_EQ(r.counters.restarts, 2);
  EXPECT_EQ(r.counters.steps, static_cast<long>(ends.size()));
  EXPECT_EQ(r.counters.substeps, r.counters.steps);
  EXPECT_GT(r.sizes.least, 0.0);
  EXPECT_LE(r.sizes.least, r.sizes.most);
  EXPECT_LE(r.sizes.most, 0.05 * (1.0 + 1e-12));
  for (const auto& [t, before] : {std::pair{0.505, 0.0}, {0.7031, 6.0}}) {
    const auto found = std::find(ends.begin(), ends.end(), t);
    ASSERT_NE(found, ends.end());
    EXPECT_EQ(at_ends[static_cast<std::size_t>(found - ends.begin())], before);  // from the left
  }
}

// A kink is a restart as well, and drives are followed through it: 0.3 s at rest, then t^2/2.
TEST(Ida, RestartsAtKinks) {
  const Model model = compile(scene_of(R"xml(
    <body name="arm" at="1 0 0" mass="2" inertia="1 1 1"/>
    <revolute name="A" between="ground arm" at="0 0 0" axis="0 0 1"/>
    <drive joint="A" rate="t&lt;0.3?0:20*(t-0.3)"/>
    <transient duration="2" step="0.01"/>)xml"));
  const Reached r = go(model, {.tolerances = {.relative = 1e-8}, .end = 2.0});
  EXPECT_EQ(r.counters.restarts, 1);
  const double angle = 10.0 * 1.7 * 1.7;  // more than four turns
  ASSERT_EQ(r.state.angles.size(), 1u);
  EXPECT_NEAR(r.state.angles[0], angle, 1e-6);
  EXPECT_NEAR(r.state.V[1](5), 20.0 * 1.7, 1e-6);
  const double kinetic = 0.5 * 3.0 * std::pow(20.0 * 1.7, 2);
  EXPECT_NEAR(r.state.work.drives, kinetic, 1e-6 * kinetic);
}

TEST(Ida, DenseOutputJoinsTheSteps) {
  const Model model = compiled("pendulum", 0.5);
  State previous = model.initial;
  double worst = 0.0, worst_inside = 0.0, t = 0.0;
  long steps = 0;
  const auto distance = [](const State& a, const State& b) {
    double d = 0.0;
    for (std::size_t n = 1; n < a.pose.size(); ++n)
      d = std::max({d, log_se3<double>(relative(a.pose[n], b.pose[n])).cwiseAbs().maxCoeff(),
                    (a.V[n] - b.V[n]).cwiseAbs().maxCoeff()});
    return d;
  };
  Ida ida(*model.system, make_klu_solver(), {.tolerances = {.relative = 1e-8}, .end = 0.5});
  State state = model.initial, at = model.initial;
  ida.on_substep([&](const DenseStep& step) {
    EXPECT_EQ(step.begin(), t);
    t = step.end();
    step.at(step.begin(), at);
    worst = std::max(worst, distance(at, previous));
    step.at(0.5 * (step.begin() + step.end()), at);
    EXPECT_EQ(at.t, 0.5 * (step.begin() + step.end()));
    const ConstraintResiduals c = constraint_residuals(*model.system, at);
    worst_inside = std::max({worst_inside, c.position, c.velocity});
    step.at(step.end(), previous);
    ++steps;
  });
  ASSERT_TRUE(ida.start(state).converged);
  while (state.t < 0.5) {
    ASSERT_TRUE(ida.step(state).converged);
    EXPECT_LE(distance(state, previous), 1e-15);
    EXPECT_EQ(state.t, previous.t);
    EXPECT_EQ((state.Vdot[1] - previous.Vdot[1]).norm(), 0.0);
    EXPECT_EQ((state.lambda - previous.lambda).norm(), 0.0);
  }
  EXPECT_EQ(steps, ida.counters().steps);
  EXPECT_LE(worst, 1e-12);
  EXPECT_LE(worst_inside, 1e-6);
}

// What the limits in physical units do, and a shorter largest step.
TEST(Ida, TakesLimitsAndLargestSteps) {
  const Model model = compiled("pendulum", 0.2);
  const long loose = go(model, {.tolerances = {.relative = 1e-4}, .end = 0.2}).counters.steps;
  const long tight =
      go(model, {.tolerances = {.relative = 1e-4, .position = 1e-10}, .end = 0.2}).counters.steps;
  EXPECT_GT(tight, 2 * loose);
  const Reached r = go(model, {.tolerances = {.relative = 1e-4}, .end = 0.2, .max_step = 1e-3});
  EXPECT_LE(r.sizes.most, 1e-3 * (1.0 + 1e-12));
  EXPECT_GE(r.counters.steps, 200);
}

// ---- what cannot be done ----------------------------------------------------------------------

std::string error_of(const System& system, const IdaOptions& options, double t = 0.0) {
  try {
    State state = system.reference_state();
    state.t = t;
    static_cast<void>(Ida(system, make_klu_solver(), options).start(state));
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

TEST(Ida, RefusesBadSettings) {
  const Model model = compiled("pendulum", 1.0);
  const System& system = *model.system;
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(error_of(system, {.tolerances = {.relative = 0.0}, .end = 1.0}),
      "tolerance must be positive");
  has(error_of(system, {.tolerances = {.relative = 1e-16}, .end = 1.0}), "round-off");
  has(error_of(system, {.tolerances = {.relative = 1e-6, .position = -1.0}, .end = 1.0}),
      "position_tolerance");
  has(error_of(system, {}), "a time at which it ends");
  has(error_of(system, {.end = 1.0}, 2.0), "not after the start");
  has(error_of(system, {.end = 1.0, .max_step = -1.0}), "max_step");
  has(error_of(system, {.end = 1.0, .max_order = 6}), "max_order");
  Scene scene = model_scene("bend45");
  has(error_of(*compile(scene).system, {.end = 1.0}), "statics");
}

// A force that grows without bound: steps shrink until they are round-off, and that is the end.
TEST(Ida, EndsAtASingularity) {
  const Model model = compile(scene_of(R"xml(
    <body name="ball" mass="2" inertia="1 1 1"/>
    <load at="ball" force="0 1/(0.5-t)^2 0"/>
    <transient duration="1" step="0.01"/>)xml"));
  Ida ida(*model.system, make_klu_solver(), {.tolerances = {.relative = 1e-8}, .end = 1.0});
  State state = model.initial;
  StepReport report = ida.start(state);
  while (report.converged && state.t < 1.0) report = ida.step(state);
  EXPECT_NE(report.failure.find("ball"), std::string::npos) << report.failure;
  EXPECT_NEAR(state.t, 0.5, 1e-9);
  EXPECT_LT(ida.counters().steps, 10000);
  EXPECT_TRUE(std::isfinite(state.work.loads));
}

// A force that there is no more of: reported, with the state that was reached, and nothing printed.
TEST(Ida, ReportsWhereItCannotGoOn) {
  const Model model = compile(scene_of(R"xml(
    <body name="ball" mass="2" inertia="1 1 1"/>
    <load at="ball" force="0 log(0.5-t) 0"/>
    <transient duration="1" step="0.01"/>)xml"));
  Ida ida(*model.system, make_klu_solver(), {.tolerances = {.relative = 1e-8}, .end = 1.0});
  State state = model.initial;
  testing::internal::CaptureStderr();
  StepReport report = ida.start(state);
  while (report.converged && state.t < 1.0) report = ida.step(state);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(report.converged);
  EXPECT_NE(report.failure.find("ball"), std::string::npos) << report.failure;
  EXPECT_NEAR(state.t, 0.5, 1e-6);
  EXPECT_TRUE(state.V[1].allFinite());
}

TEST(Ida, ReportsTheEnd) {
  const Model model = compiled("pendulum", 0.1);
  Ida ida(*model.system, make_klu_solver(), {.end = 0.1});
  State state = model.initial;
  ASSERT_TRUE(ida.start(state).converged);
  while (state.t < 0.1) ASSERT_TRUE(ida.step(state).converged);
  const StepReport report = ida.step(state);
  EXPECT_FALSE(report.converged);
  EXPECT_NE(report.failure.find("the end"), std::string::npos) << report.failure;
  state = model.initial;  // and once more from the start
  ASSERT_TRUE(ida.start(state).converged);
  ASSERT_TRUE(ida.step(state).converged);
  EXPECT_GT(state.t, 0.0);
}

TEST(Ida, LeavesRedundantConstraintsIdle) {
  const Model model = compile(scene_of(R"xml(
    <body name="arm" at="1 0 0" mass="2" inertia="1 1 1"/>
    <revolute name="A" between="ground arm" at="0 0 0" axis="0 0 1"/>
    <revolute name="B" between="ground arm" at="0 0 0" axis="0 0 1"/>
    <transient duration="2" step="0.01"/>)xml"));
  Ida ida(*model.system, make_klu_solver(), {.end = 2.0});
  State state = model.initial;
  StepReport report = ida.start(state);
  while (report.converged && state.t < 2.0) report = ida.step(state);
  EXPECT_TRUE(report.converged) << report.failure;
  EXPECT_EQ(state.idle.size(), 5u);
  for (const Index row : state.idle) EXPECT_EQ(state.lambda(row), 0.0);
}

}  // namespace
}  // namespace mbd::test::test_ida
