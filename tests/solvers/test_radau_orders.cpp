// Radau IIA of 5 and 7 stages, and the choice of their number: constants against order conditions and published ones,
// measured orders of motion, multipliers and dense output, stiffness, cost, checkpoints across a change of order.
//
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/LU>

#include "libmbd/compile/time_stepping.hpp"
#include "solvers/time/radau_stages.hpp"
#include "solvers/time/radau_tableau.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/landings.hpp"
#include "tests/support/rigid_cases.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_radau_orders {
namespace {

std::string listed(const std::vector<double>& x) { return testing::PrintToString(x); }

// ---- constants ----------------------------------------------------------------------------------

class RadauOfStages : public testing::TestWithParam<std::size_t> {
 protected:
  const RadauTableau& t = radau_tableau(GetParam());
  const Index s = static_cast<Index>(GetParam());
  const Eigen::MatrixXd D = t.D.topLeftCorner(s, s), A = dense::inverse(D);
  double c(Index j) const { return t.c[static_cast<std::size_t>(j)]; }
  double b(Index j) const { return t.b[static_cast<std::size_t>(j)]; }
};

// B(2s - 1), C(s), D(s - 1) of Butcher, which make the order 2s - 1; and the last stage is the end.
TEST_P(RadauOfStages, MeetTheOrderConditions) {
  for (int k = 1; k < 2 * s; ++k) {
    double sum = 0.0;
    for (Index j = 0; j < s; ++j) sum += b(j) * std::pow(c(j), k - 1);
    EXPECT_NEAR(sum, 1.0 / k, 4e-16) << k;
  }
  double sum = 0.0;  // and no more
  for (Index j = 0; j < s; ++j) sum += b(j) * std::pow(c(j), 2 * static_cast<int>(s) - 1);
  EXPECT_GT(std::abs(sum - 0.5 / static_cast<double>(s)), 1e-9);
  for (int k = 1; k <= s; ++k)
    for (Index i = 0; i < s; ++i) {
      double of_rates = 0.0, of_weights = 0.0;
      for (Index j = 0; j < s; ++j) {
        of_rates += A(i, j) * std::pow(c(j), k - 1);
        of_weights += b(j) * std::pow(c(j), k - 1) * A(j, i);
      }
      EXPECT_NEAR(of_rates, std::pow(c(i), k) / k, 2e-15) << k;
      if (k < s) {
        EXPECT_NEAR(of_weights, b(i) / k * (1.0 - std::pow(c(i), k)), 1e-15) << k;
      }
      EXPECT_NEAR(A(s - 1, i), b(i), 1e-15);
    }
  EXPECT_EQ(c(s - 1), 1.0);
}

// Columns of T are in units of their last components: their rows are as large as D's.
TEST_P(RadauOfStages, UncoupleTheStages) {
  Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(s, s);
  blocks(0, 0) = t.gamma;
  for (std::size_t k = 0; k < t.pairs(); ++k) {
    const auto i = static_cast<Index>(2 * k + 1);
    blocks(i, i) = blocks(i + 1, i + 1) = t.mu[k].real();
    blocks(i, i + 1) = t.mu[k].imag();
    blocks(i + 1, i) = -t.mu[k].imag();
  }
  const Eigen::MatrixXd T = t.T.topLeftCorner(s, s), inverse = t.T_inv.topLeftCorner(s, s);
  EXPECT_LE((T * blocks * inverse - D).cwiseAbs().maxCoeff(), 1e-13 * D.cwiseAbs().maxCoeff());
  EXPECT_LE((T * inverse - Eigen::MatrixXd::Identity(s, s)).cwiseAbs().maxCoeff(), 1e-13);
}

// J. Comput. Appl. Math. 111 (1999), as the code RADAU has them.
TEST(RadauConstants, HaveThePublishedEigenvalues) {
  const RadauTableau &five = radau_tableau(5), &seven = radau_tableau(7);
  EXPECT_NEAR(five.gamma, 6.286704751729276645173, 2e-15);
  EXPECT_NEAR(seven.gamma, 8.936832788405216337302, 4e-15);
  const std::complex<double> mu_five[] = {{3.655694325463572258243, 6.543736899360077294021},
                                          {5.700953298671789419170, 3.210265600308549888425}};
  const std::complex<double> mu_seven[] = {{4.378693561506806002523, 10.16969328379501162732},
                                           {7.141055219187640105775, 6.623045922639275970621},
                                           {8.511834825102945723051, 3.281013624325058830036}};
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(std::abs(five.mu[k] - mu_five[k]), 0.0, 8e-15);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(seven.mu[k] - mu_seven[k]), 0.0, 2e-14);
}

// Minus the rate at the start of the polynomial through 0 and the stages, of powers of time: nothing of those from 2 to s,
// of the next what a polynomial of degree s lacks of it.
TEST_P(RadauOfStages, EstimateTheError) {
  for (int k = 1; k <= s + 1; ++k) {
    double sum = 0.0, product = 1.0;
    for (Index j = 0; j < s; ++j) {
      sum += t.e[static_cast<std::size_t>(j)] * std::pow(c(j), k);
      product *= c(j);
    }
    EXPECT_NEAR(sum, k == 1 ? -1.0 : k <= s ? 0.0 : -product, 1e-14) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Three_five_seven, RadauOfStages, testing::Values(3, 5, 7));

// ---- orders -------------------------------------------------------------------------------------

constexpr std::size_t higher[] = {5, 7};

// The pendulum by its closed equations, for 2 s.
struct Swing {
  RigidCase c = pendulum();
  RigidReference reference;
  explicit Swing(double interval) {
    c.interval = interval;
    c.duration = std::floor(2.0 / interval + 1e-9) * interval;
    reference = reference_of(c, static_cast<int>(std::lround(interval / 2.5e-4)) + 1);
  }
};
StepErrors errors_of(const Swing& swing, std::size_t stages, const std::vector<double>& h) {
  const auto& [c, reference] = swing;
  Scene scene = model_scene(c.model);
  scene.records = {body_record(c.place, {"position", "velocity"}), joint_record(c.joint)};
  const std::size_t n = reference.tension.size();
  StepErrors e;
  for (const double step : h) {
    const Driven d = drive(scene, radau({.step = step, .stages = stages}), 2.0, c.interval);
    EXPECT_TRUE(d.last.converged) << d.last.failure;
    e.position.push_back(relative_rms(components(d.table, "body_bob.position"),
                                      columns_of(reference.position), 0, n));
    e.velocity.push_back(relative_rms(components(d.table, "body_bob.velocity"),
                                      columns_of(reference.velocity), 0, n));
    e.reaction.push_back(reaction_error(c, reference, d.table));
  }
  return e;
}

TEST(RadauOrders, AtTheEndsOfSteps) {
  const Swing swing(0.4);
  for (const std::size_t stages : higher) {
    const std::vector<double> h =
        stages == 5 ? std::vector{0.2, 0.1, 0.05} : std::vector{0.4, 0.2};  // then 1e-14
    const StepErrors e = errors_of(swing, stages, h);
    RecordProperty("stages_" + std::to_string(stages), e.in_words(h));
    const double p = stages == 5 ? 9.0 : 13.0;
    EXPECT_NEAR(fitted_order(h, e.position), p, 0.8) << e.in_words(h);
    EXPECT_NEAR(fitted_order(h, e.velocity), p, 0.8) << e.in_words(h);
    EXPECT_GT(fitted_order(h, e.reaction), static_cast<double>(stages) - 0.5) << e.in_words(h);
  }
}

TEST(RadauOrders, InsideSteps) {
  const Swing swing(0.0137);
  for (const std::size_t stages : higher) {
    const std::vector<double> h =
        stages == 5 ? std::vector{0.2, 0.1, 0.05} : std::vector{0.4, 0.2, 0.1};
    const StepErrors e = errors_of(swing, stages, h);
    RecordProperty("stages_" + std::to_string(stages), e.in_words(h));
    const auto s = static_cast<double>(stages);
    EXPECT_GT(fitted_order(h, e.position), s + 1.5) << e.in_words(h);
    EXPECT_GT(fitted_order(h, e.velocity), s + 0.5) << e.in_words(h);
    EXPECT_GT(fitted_order(h, e.reaction), s - 0.5) << e.in_words(h);
  }
}

// A mass of 1 kg on a spring of 1e8 N/m with a damper, driven so that it moves by cos t: steps are 1e3 periods long. Its
// order is that of the stages at least, and nothing rings (L-stability).
TEST(RadauOrders, WhereThingsAreStiff) {
  const Scene scene = scene_of(R"xml(
    <body name="m" at="1 0 0" mass="1" inertia="1 1 1" velocity="0 0 0"/>
    <prismatic name="guide" between="ground m" at="0 0 0" axis="1 0 0"/>
    <joint_spring name="s" joint="guide" stiffness="1e8" damping="1e2"/>
    <load at="m" force="(1e8-1)*(cos(t)-1)-1-1e2*sin(t) 0 0"/>
    <transient duration="2" step="0.5"/>)xml");
  for (const std::size_t stages : {3u, 5u, 7u}) {
    const auto s = static_cast<double>(stages);
    const std::vector<double> h = s < 6.0 ? std::vector{0.5, 0.25, 0.125} : std::vector{2.0, 1.0};
    std::vector<double> error;
    for (const double step : h) {
      const Driven d = drive(scene, radau({.step = step, .stages = stages}), 2.0);
      ASSERT_TRUE(d.last.converged) << d.last.failure;
      error.push_back(std::abs(d.state.V.at(1)(0) + std::sin(2.0)));
    }
    RecordProperty("stages_" + std::to_string(stages),
                   fmt::format("{:.2f} {}", fitted_order(h, error), listed(error)));
    EXPECT_GT(fitted_order(h, error), s - 0.5) << listed(error);
    EXPECT_LT(error.back(), 1e-4);
  }
}

// ---- tolerances, and the choice -----------------------------------------------------------------

Driven top(std::size_t stages, double tolerance) {
  Scene scene = model_scene("heavy_top");
  scene.records = {body_record("top", {"position", "velocity"})};
  return drive(scene, radau({.tolerances = {.relative = tolerance}, .end = 1.0, .stages = stages}),
               1.0, 1e-2);
}

// Errors of rows, inside steps, go with the tolerance; and a tight one is cheaper by far.
TEST(RadauOrders, FollowTheTolerance) {
  RigidCase c = heavy_top();
  c.interval = 1e-2;
  const RigidReference reference = reference_of(c, 400);
  const long residuals = top(3, 1e-9).counters.residuals;
  for (const std::size_t stages : {5u, 7u, 0u}) {
    const std::vector<double> tolerance = {1e-5, 1e-7, 1e-9};
    std::vector<double> error;
    for (const double relative : tolerance) {
      const Driven d = top(stages, relative);
      ASSERT_TRUE(d.last.converged) << d.last.failure;
      EXPECT_EQ(d.counters.retries, 0);
      error.push_back(std::max(relative_rms(components(d.table, "body_top.position"),
                                            columns_of(reference.position), 0, d.table.rows()),
                               relative_rms(components(d.table, "body_top.velocity"),
                                            columns_of(reference.velocity), 0, d.table.rows())));
      EXPECT_LT(error.back(), 2.0 * relative);
      if (relative == 1e-9) {
        EXPECT_LT(d.counters.residuals, residuals / 3);
      }
    }
    RecordProperty("stages_" + std::to_string(stages),
                   fmt::format("{:.2f} {}", fitted_order(tolerance, error), listed(error)));
    EXPECT_NEAR(fitted_order(tolerance, error), 1.0, 0.25) << listed(error);
  }
}

// Steps of `h` and work of one for each number of stages.
struct Pace {
  double three, five, seven;
};
// How many steps of each number of stages the choice takes.
std::array<int, 3> taken(RadauStages& choice, const Pace& pace, int steps) {
  std::array<int, 3> count{};
  for (int k = 0; k < steps; ++k) {
    const std::size_t s = choice.stages();
    ++count[(s - 3) / 2];
    choice.accepted(s == 3 ? pace.three : s == 5 ? pace.five : pace.seven, 1.0);
  }
  return count;
}

TEST(RadauStages, AreThoseThatComeFarthest) {
  RadauStages climbs(1e-8), stays(1e-8), turns(1e-8);
  EXPECT_GT(taken(climbs, {1.0, 2.0, 4.0}, 1000)[2], 850);
  EXPECT_GT(taken(stays, {1.0, 0.7, 0.5}, 1000)[0], 900);  // trials are a tenth, and get rarer
  EXPECT_GT(taken(stays, {1.0, 0.7, 0.5}, 4000)[0], 3900);
  EXPECT_GT(taken(turns, {1.0, 2.0, 1.0}, 1000)[1], 900);
  EXPECT_GT(taken(turns, {1.0, 0.1, 0.1}, 1000)[0], 800);  // something rings
  RadauStages even(1e-8);  // what gains less than a tenth is not worth a change
  EXPECT_GT(taken(even, {1.0, 1.05, 1.05}, 1000)[0], 900);
}

// Killed: no way back; a failure while it is away that does not lengthen its stay; its work left out.
TEST(RadauStages, AreTheFewestAfterAFailure) {
  RadauStages choice(1e-8);
  taken(choice, {1.0, 2.0, 4.0}, 1000);
  ASSERT_EQ(choice.stages(), 7U);
  EXPECT_TRUE(choice.failed());
  EXPECT_EQ(choice.stages(), 3U);
  const int stay = taken(choice, {1.0, 2.0, 4.0}, 20)[0];
  EXPECT_GT(stay, 2);
  EXPECT_LT(stay, 10);
  EXPECT_EQ(choice.stages(), 7U);
  EXPECT_TRUE(choice.failed());
  choice.accepted(1.0, 1.0);
  EXPECT_FALSE(choice.failed());
  EXPECT_EQ(taken(choice, {1.0, 2.0, 4.0}, 20)[0], stay);
  // Where steps of seven stages fail again and again, at great cost, five are better.
  int of_seven = 0, of_five = 0;
  for (int k = 0; k < 4000; ++k) {
    const std::size_t s = choice.stages();
    if (s == 7 && choice.failed()) {
      choice.accepted(1.0, 30.0);
      ++of_seven;
      continue;
    }
    of_five += s == 5 ? 1 : 0;
    choice.accepted(s == 5 ? 2.0 : 1.0, 1.0);
  }
  EXPECT_GT(of_five, 3000);
  EXPECT_LT(of_seven, 200);
}

// ---- what there is ------------------------------------------------------------------------------

TEST(RadauOrders, AreThree) {
  const Model model = compile(model_scene("pendulum"));
  EXPECT_THROW(radau({.step = 0.1, .stages = 4})(*model.system), Error);
}

TEST(RadauOrders, AreWhatAModelAsksFor) {
  Scene scene = model_scene("pendulum");
  TransientScene& transient = *scene.transient;
  change_stepping(transient, {.method = TimeMethod::radau, .tolerance = 1e-6});
  transient.duration = transient.max_step.emplace(1.0);
  const auto end = [&] {
    const Model model = compile(scene);
    const auto stepper = make_stepper(*model.system, transient);
    State state = model.initial;
    EXPECT_TRUE(stepper->start(state).converged);
    while (state.t < 1.0) {
      if (!stepper->step(state).converged) break;
    }
    return std::pair{stepper->counters().steps, Vec3(state.pose.at(1).r)};
  };
  const auto automatic = end();
  transient.stages = StageCount::automatic;
  EXPECT_EQ(end(), automatic);
  transient.stages = StageCount::three;
  const auto usual = end();
  EXPECT_LT(automatic.first, usual.first);
  transient.stages = StageCount::five;
  EXPECT_LT(2 * end().first, usual.first);
  EXPECT_NEAR((end().second - usual.second).norm(), 0.0, 1e-6);
  const auto notes = change_stepping(transient, {.method = TimeMethod::ida});
  EXPECT_FALSE(transient.stages);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "stages of the model is not used: it belongs to radau, not ida");
}

}  // namespace
}  // namespace mbd::test::test_radau_orders
