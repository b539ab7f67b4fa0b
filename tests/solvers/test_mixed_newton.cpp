// Mixed Newton of statics (solvers/statics/equilibrium.hpp): its tangent, its rate, that stretching and shear cost nothing
// however stiff they are, and that load steps keep to their path however large they are.
//
// Mutations tried: the tangent at D E in place of S* fails all of MixedNewton; steps taken wherever they lead fail Column. That
// signs of determinants are not judged fails none of Column, whose eigenvalues are counted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/spectral.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "solvers/statics/statics.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/increments.hpp"
#include "tests/support/random.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_mixed_newton {
namespace {

using std::numbers::pi;
using Resultants = std::vector<Vec6>;

struct Solved {
  Model model;
  State state;
  StaticReport report;
  Pose<double> tip() const { return state.pose.back(); }
};
Solved solve(const Scene& scene, int steps, double tolerance = 1e-9) {
  Solved s{compile(scene), {}, {}};
  s.state = s.model.initial;
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  s.report = solve_statics(
      *s.model.system, *solver,
      {.steps = steps, .newton = {.tolerance = tolerance}, .has_potential = false}, s.state);
  return s;
}

// EA, GA2, GA3 and their couplings times f.
Scene stiffer(Scene scene, double f) {
  for (auto& section : scene.sections) section.stiffness.topLeftCorner<3, 3>() *= f;
  return scene;
}

// ---- the laws ----------------------------------------------------------------------------------

struct Law {
  std::string name;
  std::string attributes;
  bool is_gradient;
};
std::vector<Law> laws() {
  std::vector<Law> all = {{"classical", "kinematics=\"classical\"", true}};
  for (const Metric metric : all_metrics)
    for (const Form form : all_forms)
      all.push_back({name_of(metric) + " " + name_of(form),
                     "metric=\"" + name_of(metric) + "\" form=\"" + name_of(form) + "\"",
                     form == Form::energy});
  return all;
}

// Two elements of order 3, 0.7 m each, far bent and turned, of stiffness D.
struct Bent {
  Model model;
  State state;
  const System& system() const { return *model.system; }
};
Bent bent(const Law& law, const Mat6& D, Rng& rng) {
  Scene scene = read(
      "<section name=\"s\"><stiffness EA=\"1\" GA2=\"1\" GA3=\"1\" GJ=\"1\" EI2=\"1\" EI3=\"1\"/>"
      "</section><beam name=\"b\" section=\"s\" from=\"1 2 3\" to=\"1 2 4.4\" normal=\"1 0 0\" "
      "elements=\"2\" order=\"3\" " +
      law.attributes + "/><static/>");
  scene.sections.front().stiffness = D;
  Bent b{compile(scene), {}};
  b.state = b.model.initial;
  move_at_random(b.state, rng, 0.3);
  return b;
}
Eigen::MatrixXd mixed_tangent(const Bent& b, const Resultants& S, VecX* residual = nullptr) {
  DenseSolver solver;
  solver.analyze(b.system().graph());
  VecX r;
  b.system().linearize_mixed(b.state, S, r, solver);
  if (residual != nullptr) *residual = r;
  return solver.matrix();
}
Eigen::MatrixXd exact_tangent(const Bent& b, VecX* residual = nullptr) {
  DenseSolver solver;
  solver.analyze(b.system().graph());
  VecX r;
  b.system().linearize(b.state, {}, r, solver);
  if (residual != nullptr) *residual = r;
  return solver.matrix();
}
Eigen::Map<const VecX> flat(const Resultants& S) {
  return {S.front().data(), static_cast<Index>(6 * S.size())};
}

// S = D (E + B dU): its change is the derivative of D E, by differences of sixth order.
TEST(LinearizedResultants, AreTheDerivative) {
  Rng rng(1);
  Worst worst("linearised resultants against differences", 2e-10);
  for (const Law& law : laws()) {
    const Bent b = bent(law, random_spd(rng, 1.0, 1.0), rng);
    const VecX x = random_increment(b.system(), rng);
    Resultants here, ahead, at;
    b.system().linearized_resultants(b.state, {}, here);
    b.system().linearized_resultants(b.state, x, ahead);
    VecX rate = VecX::Zero(flat(here).size());
    const double h = 5e-3, weights[] = {3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0};
    for (int k = 1; k <= 3; ++k)
      for (const double sign : {1.0, -1.0}) {
        b.system().linearized_resultants(moved_by(b.system(), b.state, x, sign * k * h), {}, at);
        rate += sign * weights[k - 1] / h * flat(at);
      }
    worst.add((flat(ahead) - flat(here) - rate).norm() / rate.norm(), law.name);
  }
}

// The tangent is that of the saddle point: B^T D B + d(B^T S)/dU. Of laws with an energy it is the second derivative of
// S.E(U) at fixed S, and (B dU).D (B dU), both by differences; of all, that with S = D' E differs from the exact tangent of
// a section D' by what differs without resultants. The residual is that of D E, to the last bit.
TEST(MixedTangent, IsThatOfTheSaddle) {
  Rng rng(2);
  Worst second("against second derivatives", 2e-8), other("against exact tangents", 1e-13),
      equal("at S = D E", 1e-14);
  for (const Law& law : laws()) {
    const Mat6 D = random_spd(rng, 1.0, 1.0), D_other = random_spd(rng, 3.0, 1.0);
    const Bent b = bent(law, D, rng);
    Bent c = bent(law, D_other, rng);
    c.state = b.state;
    Resultants S, S_other;
    b.system().linearized_resultants(b.state, {}, S);
    c.system().linearized_resultants(b.state, {}, S_other);
    const Resultants none(S.size(), Vec6::Zero());
    VecX r, r_exact;
    const Eigen::MatrixXd K = mixed_tangent(b, S_other, &r), exact = exact_tangent(b, &r_exact);
    EXPECT_EQ((r - r_exact).cwiseAbs().maxCoeff(), 0.0) << law.name;
    equal.add((mixed_tangent(b, S) - exact).norm() / exact.norm(), law.name);
    const Eigen::MatrixXd sum = exact_tangent(c) + mixed_tangent(b, none) - mixed_tangent(c, none);
    other.add((K - sum).norm() / K.norm(), law.name);
    if (!law.is_gradient) continue;
    const VecX x = random_increment(b.system(), rng), y = random_increment(b.system(), rng);
    const SpectralTable table = spectral_table(3, Rule::gauss);
    const double J = 0.35;
    const Mat6 C = dense::inverse(D);
    const auto weighted = [&](const Resultants& a, const Resultants& e) {
      double total = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i)
        total += J * table.rule.weights[i % table.rule.weights.size()] * a[i].dot(C * e[i]);
      return total;
    };
    const auto product = [&](double along_x, double along_y) {  // S.E, first y and then x
      Resultants DE;
      b.system().linearized_resultants(
          moved_by(b.system(), moved_by(b.system(), b.state, x, along_x), y, along_y), {}, DE);
      return weighted(S_other, DE);
    };
    const auto mixed_difference = [&](double h) {
      return (product(h, h) - product(h, -h) - product(-h, h) + product(-h, -h)) / (4.0 * h * h);
    };
    const double h = 4e-3, one = mixed_difference(h), two = mixed_difference(2 * h),
                 three = mixed_difference(3 * h);
    const double geometric = 1.5 * one - 0.6 * two + 0.1 * three;
    Resultants Bx, By;
    b.system().linearized_resultants(b.state, x, Bx);
    b.system().linearized_resultants(b.state, y, By);
    for (std::size_t i = 0; i < S.size(); ++i) {
      Bx[i] -= S[i];
      By[i] -= S[i];
    }
    second.add(
        std::abs(y.dot(K * x) - geometric - weighted(Bx, By)) / (y.norm() * K.norm() * x.norm()),
        law.name);
  }
}

// ---- the rate ----------------------------------------------------------------------------------

// Errors of the iterates of one load step of the elastica, of 0.4 of a load of 10 EI/L^2, stretching and shear 1e8 times
// as stiff as bending. Largest difference of positions from the solution, over L.
TEST(MixedNewton, RateIsQuadratic) {
  const Scene scene = model_scene("elastica", {{"stiff", "1e8"}, {"load", "10"}});
  const Model model = compile(scene);
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  solver->analyze(model.system->graph());
  const auto after = [&](int iterations) {
    State state = model.initial;
    state.load_factor = 0.2;
    Counters counters;
    std::string failure;
    newton_equilibrium(*model.system, *solver,
                       {.tolerance = 1e-30, .max_iterations = iterations, .line_search = false},
                       state, counters, failure);
    return state;
  };
  const State solution = after(12);
  std::vector<double> errors;
  for (int k = 0; k < 6; ++k) {
    const State state = after(k);
    double largest = 0.0;
    for (std::size_t n = 0; n < state.pose.size(); ++n)
      largest = std::max(largest, (state.pose[n].r - solution.pose[n].r).norm());
    errors.push_back(largest);
  }
  int measured = 0;
  for (std::size_t k = 0; k + 1 < errors.size(); ++k) {
    if (errors[k] > 0.3 || errors[k] < 1e-6) continue;
    EXPECT_LT(errors[k + 1], 3.0 * errors[k] * errors[k] + 1e-11) << k << ": " << errors[k];
    ++measured;
  }
  EXPECT_GE(measured, 2);
  EXPECT_LT(errors[4], 1e-9);
}

// ---- stiffness costs nothing -------------------------------------------------------------------

// Beyond EA L^2/EI of about 1e11 round-off of the tangent would slow iterations down, were sectional forces not unknowns there
// (elements/beam/held_strains.hpp). Without these princeton x 1e9 does not end, and bend45 x 1e9 takes 112
// iterations.
TEST(MixedNewton, StiffStretchingCostsNothing) {
  const struct {
    const char* model;
    Overrides overrides;
    int steps;
  } cases[] = {{"elastica", {{"stiff", "1e2"}, {"load", "10"}}, 4},
               {"bend45", {}, 4},
               {"roll_up", {}, 4},
               {"princeton", {}, 4},
               {"portal_frame", {}, 2}};
  for (const auto& c : cases) {
    long least = 1000, most = 0;
    for (double f = 1.0; f <= 1e12; f *= 100.0) {
      const Solved s = solve(stiffer(model_scene(c.model, c.overrides), f), c.steps);
      ASSERT_TRUE(s.report.converged) << c.model << " x " << f << ": " << s.report.failure;
      least = std::min(least, s.report.counters.iterations);
      most = std::max(most, s.report.counters.iterations);
      EXPECT_LE(s.report.counters.steps, 4) << c.model << " x " << f;
    }
    EXPECT_LE(most - least, 3) << c.model << ": " << least << " to " << most << " iterations";
    EXPECT_LE(most, 22) << c.model;
  }
}

// A circle in one load step of half a turn and more, at any stiffness.
TEST(MixedNewton, RollsUpToACircle) {
  for (const double f : {1.0, 1e3, 1e6, 1e9}) {
    const Solved s = solve(stiffer(model_scene("roll_up"), f), 3);
    ASSERT_TRUE(s.report.converged) << s.report.failure;
    EXPECT_LT(s.tip().r.norm(), 1e-9) << f;
    EXPECT_LE(s.report.counters.steps, 3);
  }
}

// Elliptic integrals: models/elastica.xml.
TEST(MixedNewton, ElasticaOfEveryStiffness) {
  for (const double stiff : {1e4, 1e7, 1e10, 1e13}) {
    const Solved s =
        solve(model_scene("elastica", {{"stiff", std::to_string(stiff)}, {"load", "10"}}), 4);
    ASSERT_TRUE(s.report.converged) << s.report.failure;
    EXPECT_NEAR(s.tip().r(0), 1.0 - 0.554995598, 1e-9) << stiff;
    EXPECT_NEAR(s.tip().r(2), -0.810609025 - 10.0 / stiff, 1e-9) << stiff;
    EXPECT_LE(s.report.counters.steps, 5);
  }
}

// ---- traps -------------------------------------------------------------------------------------

// A curved and twisted beam under a follower load and a spring, in millimetres and in metres: the same motion, in as many
// iterations.
std::string twisted(double unit, double f) {
  const auto number = [](double x) { return std::to_string(x); };
  const auto point = [&](double x, double y, double z, double twist) {
    return "<point at=\"" + number(unit * x) + " " + number(unit * y) + " " + number(unit * z) +
           "\" twist=\"" + number(twist) + "\"/>";
  };
  return "<section name=\"s\"><stiffness EA=\"" + number(1e5 * f) + "\" GA2=\"" + number(4e4 * f) +
         "\" GA3=\"" + number(3e4 * f) + "\" GJ=\"" + number(0.8 * unit * unit) + "\" EI2=\"" +
         number(1.0 * unit * unit) + "\" EI3=\"" + number(3.0 * unit * unit) + "\" D45=\"" +
         number(0.2 * unit * unit) +
         "\"/></section><curve name=\"b\" section=\"s\" normal=\"0 0 1\" " +
         "elements=\"6\" order=\"4\">" + point(0, 0, 0, 0) + point(0.4, 0.1, 0, 0.2) +
         point(0.8, 0.3, 0.1, 0.5) + point(1.1, 0.6, 0.3, 0.9) +
         "</curve><fixed name=\"clamp\" between=\"ground b.start\"/>"
         "<load at=\"b.end\" follower_force=\"0 1 4\"/><static/>";
}
TEST(MixedNewton, DoesNotDependOnUnits) {
  std::vector<long> iterations;
  for (const double f : {1.0, 1e4}) {
    const Solved metre = solve(read(twisted(1.0, f)), 2, 1e-11),
                 millimetre = solve(read(twisted(1000.0, f)), 2, 1e-11);
    // The force is the same where D of bending grows with the square of the unit: a load of EI/L^2.
    ASSERT_TRUE(metre.report.converged) << metre.report.failure;
    ASSERT_TRUE(millimetre.report.converged) << millimetre.report.failure;
    EXPECT_LT((1000.0 * metre.tip().r - millimetre.tip().r).norm(), 1e-6);
    EXPECT_GT((metre.tip().r - metre.model.initial.pose.back().r).norm(), 0.3);
    for (const Solved* s : {&metre, &millimetre})
      iterations.push_back(s->report.counters.iterations);
  }
  const auto [least, most] = std::minmax_element(iterations.begin(), iterations.end());
  EXPECT_LE(*most - *least, 3) << *least << " to " << *most;
}

// A frame of two beams, a hinge, a rigid body and a spring.
TEST(MixedNewton, FrameWithJointsBodiesAndSprings) {
  long least = 1000, most = 0;
  for (const double f : {1.0, 1e3, 1e6}) {
    const Scene scene = stiffer(
        read("<section name=\"s\"><stiffness EA=\"1e4\" GA2=\"5e3\" GA3=\"5e3\" GJ=\"1\" EI2=\"1\" "
             "EI3=\"1\"/></section>"
             "<beam name=\"a\" section=\"s\" from=\"0 0 0\" to=\"0 0 1\" normal=\"1 0 0\" "
             "elements=\"3\" "
             "order=\"4\"/>"
             "<beam name=\"c\" section=\"s\" from=\"0 0 1\" to=\"1 0 1\" normal=\"0 0 1\" "
             "elements=\"3\" "
             "order=\"4\"/>"
             "<body name=\"block\" mass=\"1\" inertia=\"1 1 1\" at=\"1 0 1\"/>"
             "<fixed name=\"A\" between=\"ground a.start\"/>"
             "<revolute name=\"B\" between=\"a.end c.start\" axis=\"0 1 0\"/>"
             "<fixed name=\"C\" between=\"c.end block\"/>"
             "<spring name=\"k\" between=\"ground block\" stiffness=\"5\" "
             "length=\"0.5\" at_a=\"1 0 2\"/>"
             "<load at=\"block\" force=\"1.5 0 -1\"/><static/>"),
        f);
    const Solved s = solve(scene, 2);
    ASSERT_TRUE(s.report.converged) << f << ": " << s.report.failure;
    least = std::min(least, s.report.counters.iterations);
    most = std::max(most, s.report.counters.iterations);
  }
  EXPECT_LE(most - least, 3) << least << " to " << most;
}

// ---- a compressed column -----------------------------------------------------------------------

// Clamped at its foot, free at its head; P in units of Euler's pi^2 EI/(4 L^2), across it q of it.
Solved column(double P, double q, int steps) {
  const auto number = [](double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return std::string(text);
  };
  Solved s{compile(read(
               "<section name=\"s\"><stiffness EA=\"1e7\" GA2=\"1e7\" GA3=\"1e7\" GJ=\"1\" "
               "EI2=\"1\" EI3=\"2\"/></section><beam name=\"b\" section=\"s\" from=\"0 0 0\" "
               "to=\"1 0 0\" normal=\"0 0 1\" elements=\"4\" order=\"4\"/><fixed name=\"clamp\" "
               "between=\"ground b.start\"/><load at=\"b.end\" force=\"" +
               number(-P * pi * pi / 4) + " 0 " + number(q * P * pi * pi / 4) + "\"/><static/>")),
           {},
           {}};
  s.state = s.model.initial;
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  s.report = solve_statics(*s.model.system, *solver,
                           {.steps = steps, .newton = {}, .has_potential = true}, s.state);
  return s;
}

// P/P_E = (2 K(k)/pi)^2, deflection of the head 2 k/sqrt(P): Timoshenko, Gere, Theory of Elastic Stability, 2.7.
double post_buckled(double P) {
  double low = 0.0, high = 0.999;
  for (int i = 0; i < 100; ++i) {
    const double k = 0.5 * (low + high);
    (std::pow(2.0 / pi * std::comp_ellint_1(k), 2) < P ? low : high) = k;
  }
  return 2.0 * low / (0.5 * pi * std::sqrt(P));
}

// With an imperfection, however small, it bends to its side, whatever the load steps are.
TEST(Column, BendsToTheSideOfItsImperfection) {
  for (const double P : {1.2, 2.0})
    for (const double q : {1e-2, -1e-4, 1e-6})
      for (const int steps : {1, 2, 3, 10}) {
        const Solved s = column(P, q, steps);
        ASSERT_TRUE(s.report.converged) << s.report.failure;
        EXPECT_NEAR(s.tip().r(2), std::copysign(post_buckled(P), q), 1.5 * std::abs(q) + 1e-4)
            << "P = " << P << ", q = " << q << ", " << steps << " steps";
        EXPECT_TRUE(s.report.passed.empty());
      }
}

// A perfect one stays straight, and the loads at which it could have bent are said: 1 and 9, and 2 and 18 about the other
// axis.
TEST(Column, SaysWhereAPerfectOneCouldHaveBent) {
  for (const int steps : {1, 3, 7}) {
    const Solved s = column(5.0, 0.0, steps);
    ASSERT_TRUE(s.report.converged) << s.report.failure;
    EXPECT_LT(std::abs(s.tip().r(2)), 1e-12);
    ASSERT_EQ(s.report.passed.size(), 2U) << steps;
    for (std::size_t i = 0; i < 2; ++i) {
      const double load =
          std::stod(s.report.passed[i].substr(std::string("at load factor ").size()));
      EXPECT_NEAR(load, (i == 0 ? 1.0 : 2.0) / 5.0, 2e-5) << s.report.passed[i];
      EXPECT_SAYS(s.report.passed[i], i == 0 ? "negative eigenvalues 0 -> 1" : "1 -> 2");
    }
  }
}

// Load steps, however large, do not jump over a limit point to the equilibria beyond the snap: they end at the limit load, by
// shooting of the rod equations (as the model quotes it), for a load of 1.02 to 5 times that. Mutation: every step that converges
// is taken: the arch stands snapped through, or not, by luck of the step.
TEST(Column, LoadStepsEndAtALimitPoint) {
  const double limit = 193950.1924;
  for (const double load : {1.98e5, 2.5e5, 6e5, 1e6})
    for (const int steps : {1, 3, 10}) {
      SCOPED_TRACE(fmt::format("{} N in {} steps", load, steps));
      Scene scene = model_scene("shallow_arch", {{"EI", "1e8"}, {"P", fmt::format("{}", load)}});
      scene.path.reset();
      scene.statics.emplace();
      scene.statics->steps = steps;
      const RunReport report = run_to_table(scene).report;
      EXPECT_FALSE(report.complete());
      EXPECT_NE(report.failure.find("gives way"), std::string::npos) << report.failure;
      EXPECT_LE(report.load_factor * load, limit * (1.0 + 1e-9));
      EXPECT_GT(report.load_factor * load, limit * (1.0 - 5e-5));
    }
}

}  // namespace
}  // namespace mbd::test::test_mixed_newton
