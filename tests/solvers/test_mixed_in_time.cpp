// Mixed Newton in time (solvers/newton/kept_resultants.hpp): its residual and tangent, its rate, and that stretching and shear
// cost steps nothing however stiff they are.
//
// Mutations tried, in kept_resultants.cpp: no advance fails AtTheStateOfTheTangent and ResidualIsThatOfTheSaddle; no geometric
// stiffness of S - D E fails TangentIsTheDerivative…, RateIsQuadratic and StiffStretchingCostsNothing; S = D E at each residual fails
// ResidualIsThatOfTheSaddle, TangentIsTheDerivative…, SolutionIsThatOfThePlainResidual and StiffStretchingCostsNothing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libmbd/compile/model.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/core/pack.hpp"
#include "libmbd/core/spectral.hpp"
#include "solvers/newton/kept_resultants.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/increments.hpp"
#include "tests/support/random.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_mixed_in_time {
namespace {

// ---- the laws ----------------------------------------------------------------------------------

struct Law {
  Metric metric;
  Form form;
  int order;
  std::string name() const {
    return fmt::format("{} {} {}", name_of(metric), name_of(form), order);
  }
  // How many elements lie side by side in its numbers.
  std::size_t lanes() const { return form == Form::energy ? pack_count : 1; }
};
// Orders of fixed and of run-time size; the paper's form has no packs.
std::vector<Law> laws() {
  std::vector<Law> all;
  for (const Metric metric : all_metrics)
    for (const Form form : all_forms)
      for (const int order : {2, 3, 5, 6}) all.push_back({metric, form, order});
  return all;
}

// Elements, a pack and one more, of stiffness D, bent and turned; the end is fused with a body in turned axes.
constexpr int elements = pack_count + 1;
constexpr double element_length = 0.7;
struct Bent {
  Model model;
  State state;
  const System& system() const { return *model.system; }
};
Bent bent(const Law& law, const Mat6& D, std::uint64_t seed) {
  const std::string end = fmt::format("1 2 {}", 3 + element_length * elements);
  Scene scene = read(fmt::format(
      R"(<section name="s"><stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/></section>
      <beam name="b" section="s" from="1 2 3" to="{0}" normal="1 0 0" elements="{1}" order="{2}"
        metric="{3}" form="{4}"/>
      <body name="c" at="{0}" orientation="0.3 0.2 0.4" mass="1" inertia="1 1 1"/>
      <fixed name="f" between="c b.end"/><static/>)",
      end, elements, law.order, name_of(law.metric), name_of(law.form)));
  scene.sections.front().stiffness = D;
  Bent b{compile(scene), {}};
  b.state = b.model.initial;
  Rng rng(seed);
  move_at_random(b.state, rng, 0.15);
  return b;
}
// Of an element and a point.
Vec6 one_of(const std::vector<double>& numbers, const Law& law, int element, int point) {
  const std::size_t lanes = law.lanes(), e = static_cast<std::size_t>(element);
  Vec6 S;
  for (std::size_t q = 0; q < 6; ++q)
    S(static_cast<Index>(q)) = numbers[(e / lanes * static_cast<std::size_t>(law.order) +
                                        static_cast<std::size_t>(point)) *
                                           6 * lanes +
                                       q * lanes + e % lanes];
  return S;
}

KeptResultants of(const System& system) {
  KeptResultants kept(system, 0.0);
  kept.begin();
  return kept;
}

// At the state of the tangent the residual is that of D E, whatever S is, and S <- D (E + B0 dU) is that of statics, from
// kernels of their own.
TEST(KeptResultants, AtTheStateOfTheTangent) {
  Rng rng(3);
  Worst plain("against the residual of D E", 1e-13), next("S <- D (E + B0 dU)", 1e-13);
  for (const Law& law : laws()) {
    const Bent b = bent(law, random_spd(rng, 1.0, 1.0), 17),
               c = bent(law, random_spd(rng, 3.0, 1.0), 17);
    const System& system = b.system();
    DenseSolver solver;
    solver.analyze(system.graph());
    VecX r, r_plain;
    KeptResultants kept = of(system);
    KeptResultants::Iterate at;
    of(c.system()).set(b.state, at.S);
    system.linearize(b.state, {}, r, solver);
    kept.keep_tangent(b.state, 1.0, at, solver.slots());
    kept.residual(b.state, at, r);
    system.residual(b.state, r_plain);
    plain.add((r - r_plain).norm() / r_plain.norm(), law.name());

    const VecX x = random_increment(system, rng);
    std::vector<Vec6> expected;
    system.linearized_resultants(b.state, x, expected);
    kept.advance(x, at);
    for (int e = 0; e < elements; ++e)
      for (int i = 0; i < law.order; ++i) {
        const Vec6& one = expected[static_cast<std::size_t>(e * law.order + i)];
        next.add((one_of(at.S, law, e, i) - one).norm() / one.norm(), law.name());
      }
  }
}

// Elsewhere, of the energy form: B^T S is the residual of a section D' with S = D' E, and B0^T the transposed of B0 in
// S <- D (E + B0 dU), x . B0^T s = sum w J s . B0 x.
TEST(KeptResultants, ResidualIsThatOfTheSaddle) {
  Rng rng(4);
  Worst saddle("against B^T S + B0^T (D E - S)", 1e-12);
  for (const Law& law : laws()) {
    if (law.form != Form::energy) continue;
    const Mat6 D = random_spd(rng, 1.0, 1.0), C = dense::inverse(D);
    const Bent b = bent(law, D, 17), c = bent(law, random_spd(rng, 3.0, 1.0), 17);
    const System& system = b.system();
    DenseSolver solver;
    solver.analyze(system.graph());
    VecX r, r_other;
    KeptResultants kept = of(system);
    KeptResultants::Iterate at;
    kept.set(b.state, at.S);
    system.linearize(b.state, {}, r, solver);
    kept.keep_tangent(b.state, 1.0, at, solver.slots());
    const VecX x = random_increment(system, rng);
    KeptResultants::Iterate ahead = at;
    kept.advance(x, ahead);

    const State other = moved_by(system, b.state, random_increment(system, rng), 0.1);
    const std::vector<double> DE0 = at.DE;
    of(c.system()).set(other, at.S);
    kept.residual(other, at, r);
    c.system().residual(other, r_other);
    const SpectralTable table = spectral_table(law.order, Rule::gauss);
    double work = r_other.tail(x.size()).dot(x), size = std::abs(work);
    for (int e = 0; e < elements; ++e)
      for (int i = 0; i < law.order; ++i) {
        const Vec6 rest = one_of(at.DE, law, e, i) - one_of(at.S, law, e, i),
                   D_B0_x = one_of(ahead.S, law, e, i) - one_of(DE0, law, e, i);
        const double one = 0.5 * element_length * table.rule.weights[static_cast<std::size_t>(i)] *
                           rest.dot(C * D_B0_x);
        work += one;
        size += std::abs(one);
      }
    saddle.add(std::abs(work - r.tail(x.size()).dot(x)) / size, law.name());
    EXPECT_GT((r - r_other).norm(), 1e-2 * r.norm()) << law.name();
  }
}

// U dr/dU of the mixed residual at the state of the tangent, by differences of sixth order with S and B0 held.
TEST(KeptResultants, TangentIsTheDerivativeOfTheMixedResidual) {
  Rng rng(5);
  Worst worst("tangent against differences of the mixed residual", 1e-8);
  for (const Law& law : laws()) {
    const Bent b = bent(law, random_spd(rng, 1.0, 1.0), 18),
               c = bent(law, random_spd(rng, 3.0, 1.0), 18);
    const System& system = b.system();
    DenseSolver solver;
    solver.analyze(system.graph());
    KeptResultants kept = of(system);
    KeptResultants::Iterate at;
    of(c.system()).set(b.state, at.S);
    VecX r;
    const double U = 0.7;
    system.linearize(b.state, {.U = U}, r, solver);
    kept.keep_tangent(b.state, U, at, solver.slots());
    const VecX x = random_increment(system, rng);
    VecX rate = VecX::Zero(x.size());
    const double h = 2e-3, weights[] = {3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0};
    for (int k = 1; k <= 3; ++k)
      for (const double sign : {1.0, -1.0}) {
        kept.residual(moved_by(system, b.state, x, sign * k * h), at, r);
        rate += sign * weights[k - 1] / h * r.tail(x.size());
      }
    worst.add((solver.matrix() * x - U * rate).norm() / rate.norm(), law.name());
  }
}

// ---- in steps ----------------------------------------------------------------------------------

// A cantilever of 1 m whipped by its end, which moves by 0.4 m; EA, GA times f.
Scene whip(double f, const std::string& transient) {
  return read(fmt::format(
      R"xml(<section name="s"><stiffness EA="1e5*{0}" GA2="4e4*{0}" GA3="4e4*{0}" GJ="1.5" EI2="2" EI3="2"/>
        <mass per_length="0.1" inertia="2e-6 1e-6 1e-6"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="10" order="3"/>
      <fixed name="F" between="ground b.start"/>
      <load at="b.end" force="0 10*sin(60*t) 4*sin(23*t)"/>
      <transient duration="0.2" {1}/><record name="tip" at="b.end" quantities="position"/>)xml",
      f, transient));
}

Driven run(double f, const std::string& transient, double duration = 0.2) {
  const Scene scene = whip(f, transient);
  Driven d;
  d.model = compile(scene);
  d.state = d.model.initial;
  const auto stepper = make_stepper(*d.model.system, *scene.transient);
  d.last = stepper->start(d.state);
  while (d.last.converged && d.state.t < duration * (1.0 - 1e-9)) d.last = stepper->step(d.state);
  EXPECT_TRUE(d.last.converged) << "EA, GA times " << f << ": " << d.last.failure;
  d.counters = stepper->counters();
  return d;
}

struct Method {
  const char* transient;
  int steps;
  double most_iterations;  // a step
};

// Without it, at 1, 1e2, 1e4, 1e6: generalized-alpha 2.9, 3.3, 11, 11 iterations a step; fixed steps of Radau 5.5, 11, 23, and
// the end in the second of them; adaptive ones 2.2, 2.1, 2.8, 8.4.
TEST(MixedInTime, StiffStretchingCostsNothing) {
  for (const Method& method : {Method{R"(step="1e-3" rho_infinity="0.5")", 200, 3.5},
                               Method{R"(step="1e-3" method="radau")", 200, 7.0},
                               Method{R"(tolerance="1e-4" method="radau" stages="3")", 0, 3.0}}) {
    SCOPED_TRACE(method.transient);
    for (const double f : {1.0, 1e2, 1e4, 1e6}) {
      const Counters c = run(f, method.transient).counters;
      const double a_step = static_cast<double>(c.iterations) / static_cast<double>(c.substeps);
      RecordProperty(fmt::format("{} {}", method.transient, f), testing::PrintToString(a_step));
      if (method.steps > 0) {
        EXPECT_LE(c.substeps, 1.1 * method.steps) << f;
      }
      EXPECT_LE(a_step, method.most_iterations) << f;
    }
  }
}

// What U alone would add to an accepted state is not more than what Newton's iterations may leave.
TEST(MixedInTime, SolutionIsThatOfThePlainResidual) {
  const double step = 1e-3, rho = 0.5;
  const Scene scene = whip(1e5, R"(step="1e-3" rho_infinity="0.5")");
  const Model model = compile(scene);
  const System& system = *model.system;
  ASSERT_TRUE(KeptResultants(system).should_begin({.tangents = 11}));
  const auto stepper = make_stepper(system, *scene.transient);
  const GeneralizedAlphaParameters a = generalized_alpha_parameters(rho);
  const auto solver = make_klu_solver();
  solver->analyze(system.graph());
  State state = model.initial;
  ASSERT_TRUE(stepper->start(state).converged);
  VecX r;
  const double s = a.beta * step * step;
  double largest = 0.0;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = stepper->step(state);
    ASSERT_TRUE(report.converged) << report.failure;
    system.linearize(state,
                     {.U = s, .V = a.gamma * step, .A = (1.0 - a.alpha_m) / (1.0 - a.alpha_f)}, r,
                     *solver);
    ASSERT_EQ(solver->factor(), FactorStatus::ok);
    VecX x = -r.tail(system.unknowns());
    const Index motions = 6 * (system.nodes() - 1);
    x.head(motions) *= s;
    solver->solve({x.data(), static_cast<std::size_t>(x.size())});
    largest = std::max(largest, x.head(motions).cwiseAbs().maxCoeff());
  }
  EXPECT_LE(largest, 2e-9);
}

// A stepper restored in a model compiled anew goes on to the last bit: its resultants are part of what is saved.
TEST(MixedInTime, CheckpointsGoOnToTheLastBit) {
  for (const char* transient :
       {R"(step="1e-3" rho_infinity="0.5")", R"(step="1e-3" method="radau")"}) {
    SCOPED_TRACE(transient);
    const Scene scene = whip(1e4, transient);
    const Model model = compile(scene), again = compile(scene);
    const auto stepper = make_stepper(*model.system, *scene.transient),
               other = make_stepper(*again.system, *scene.transient);
    State state = model.initial, restored;
    ASSERT_TRUE(stepper->start(state).converged);
    const auto take = [](Stepper& by, State& s) {
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(by.step(s).converged);
    };
    take(*stepper, state);
    other->restore(stepper->save(state), restored);
    take(*stepper, state);
    take(*other, restored);
    for (std::size_t n = 0; n < state.pose.size(); ++n) {
      EXPECT_EQ(restored.pose[n].r, state.pose[n].r);
      EXPECT_EQ(restored.V[n], state.V[n]);
    }
    EXPECT_EQ(other->counters().iterations, stepper->counters().iterations);
  }
}

// Newton's iterations with the tangent taken anew at each, back to a state whose forces are known, of beams whose EA, GA are
// 1e6 times EI over a squared length: increments e_k+1 of the motion over e_k^2, above round-off.
TEST(KeptResultants, RateIsQuadratic) {
  Rng rng(6);
  std::vector<double> from, to;
  double constant = 0.0;
  for (const Law& law : laws()) {
    if (law.form != Form::energy) continue;
    Mat6 D = Mat6::Identity();
    D.topLeftCorner<3, 3>() *= 1e6;
    const Bent b = bent(law, D, 19);
    const System& system = b.system();
    // What ties the first node: its rows and columns are left out.
    const Index n = system.unknowns() - 6;
    DenseSolver solver;
    solver.analyze(system.graph());
    KeptResultants kept = of(system);
    KeptResultants::Iterate at;
    VecX forces, r;
    system.residual(b.model.initial, forces);
    VecX x = VecX::Zero(system.unknowns());
    for (Index i = 6; i < x.size(); ++i) x(i) = uniform(rng, -0.02, 0.02);
    State state = moved_by(system, b.model.initial, x, 1.0);
    kept.set(b.model.initial, at.S);
    double last = 0.0;
    int k = 0;
    for (; k < 12; ++k) {
      solver.set_zero();
      system.linearize(state, {}, r, solver);
      kept.keep_tangent(state, 1.0, at, solver.slots());
      x.setZero();
      x.tail(n) = dense::solve(Eigen::MatrixXd(solver.matrix().bottomRightCorner(n, n)),
                               VecX((forces - r).tail(n)));
      kept.advance(x, at);
      retract(system, state, x);
      const double e = x.cwiseAbs().maxCoeff();
      if (last > 0.0 && e > 1e-12) {
        from.push_back(last);
        to.push_back(e);
        constant = std::max(constant, e / (last * last));
      }
      if (e < 1e-12) break;
      last = e;
    }
    EXPECT_LE(k, 7) << law.name();
  }
  ASSERT_GE(from.size(), 20u);
  EXPECT_GE(fitted_order(from, to), 1.8);
  EXPECT_LE(constant, 1e2);
}

}  // namespace
}  // namespace mbd::test::test_mixed_in_time
