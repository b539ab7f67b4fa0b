// IDA on stabilised equations of index 2: tangent, accuracy, constraints, landings, dense output, messages.
#include <gtest/gtest.h>

#include <cmath>

#include "libmbd/core/error.hpp"
#include "libmbd/front/model.hpp"
#include "solvers/ida.hpp"
#include "solvers/initial.hpp"
#include "solvers/klu_solver.hpp"
#include "solvers/stabilized_index2.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test {
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

// (dF/dy + c dF/dydot) times what solve() makes of b is b, by central differences of the residual: at a large
// motion, with mu = 0. What the tangent leaves out, dgdot/dU, is not of the rows looked at.
TEST(Ida, TangentIsThatOfTheResidual) {
  const Model model = compile(scene_of(R"xml(
    <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="300" EI2="400" EI3="500"/>
      <mass per_length="2" inertia="3e-2 1e-2 2e-2"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0.5 0" normal="0 0 1" order="2"/>
    <body name="k" at="1 0.5 0" mass="3" inertia="1 2 3"/>
    <revolute name="A" between="ground b.start" axis="0 0 1"/>
    <universal name="U" between="b.end k" at="1 0.5 0" axis="0 0 1" axis2="1 0 0"/>
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
  const Index size = equations.size();
  Vector y(size), ydot(size);
  equations.pack(state, span_of(y), span_of(ydot));
  for (Index i = 0; i < equations.first_mu(); ++i) ydot(i) += uniform(rng, -1.0, 1.0);  // not kinematics'
  y.head(equations.first_lambda()).reshaped(13, system.nodes() - 1).middleRows(3, 4) *= 1.07;  // |p|
  for (const double c : {30.0, 3e3}) {
    ASSERT_TRUE(equations.linearize(0.0, span_of(y), span_of(ydot), c));
    ASSERT_EQ(equations.factor(), FactorStatus::ok);
    Vector b(size);
    for (Index i = 0; i < size; ++i) b(i) = uniform(rng, -1.0, 1.0);
    Vector dy = b;
    equations.solve(span_of(dy));
    const auto F = [&](double s) {
      Vector at = y + s * dy, rate = ydot + s * c * dy, f(size);
      equations.residual(0.0, span_of(at), span_of(rate), span_of(f));
      return f;
    };
    const double s = 1e-5 / dy.head(equations.first_lambda()).cwiseAbs().maxCoeff();
    const Vector product =
        (8.0 * (F(s) - F(-s)) - (F(2.0 * s) - F(-2.0 * s))) / (12.0 * s);
    for (Index i = 0; i < size; ++i) {
      if (i >= equations.first_lambda() && i < equations.first_mu()) continue;
      // In units of what the rows are made of.
      EXPECT_NEAR(product(i), b(i), 1e-6 * (1.0 + std::abs(dy(i)) * 0.0 + product.cwiseAbs().maxCoeff()))
          << i << " " << equations.name_of(i);
    }
  }
}

}  // namespace
}  // namespace mbd::test
