// bend45, the paper's first example (HB 9.1): a cantilever bent to an eighth of a circle under a dead tip
// force out of its plane. Converged displacement, orders of accuracy, the paper's table 1, and what errors of
// 10 % in the data do to each.
//
// Errors: Euclidean norm of the error of the tip's displacement over that of the displacement. The reference
// has 20 digits; it was calculated apart from this project, in extended precision (and a finite-volume code
// agrees to 1e-7). What is below the round-off of double is solved in long double (extended_bend.hpp).

#include <gtest/gtest.h>

#include "tests/support/extended_bend.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_bend45 {
namespace {

std::string listed(const std::vector<double>& x) { return testing::PrintToString(x); }

const Vector3<long double> exact_tip(-13.73548151312558962L, -23.82504922387786265L,
                                     53.61385809953141840L);
const Vec3 converged_tip = exact_tip.cast<double>();

Vec3 tip_displacement(const Scene& scene) {
  const History history = run_to_table(scene);
  EXPECT_TRUE(history.report.complete()) << history.report.failure;
  const auto last = [&](const char* name) { return history.table[name].back(); };
  return {last("tip.displacement.1"), last("tip.displacement.2"), last("tip.displacement.3")};
}

double tip_error(const Scene& scene) {
  return (tip_displacement(scene) - converged_tip).norm() / converged_tip.norm();
}

Scene bend(Metric metric, Form form, int order, int elements, Rule rule = Rule::gauss) {
  static const Scene bend45 = model_scene("bend45", {{"in", "1"}, {"lb", "1"}});
  Scene scene = with(bend45, metric, form);
  scene.beams.at(0).order = order;
  scene.beams.at(0).elements = elements;
  scene.beams.at(0).rule = rule;
  return scene;
}

ExtendedBend extended(Metric metric, Form form, int order, int elements, Rule rule = Rule::gauss) {
  return {.metric = metric, .form = form, .rule = rule, .order = order, .elements = elements};
}

double extended_error(const ExtendedBend& bend) {
  const ExtendedSolution solution = solve(bend);
  EXPECT_TRUE(solution.converged) << solution.iterations << " iterations, " << solution.increment;
  return static_cast<double>((solution.tip - exact_tip).norm() / exact_tip.norm());
}

// 10 % more of an entry of D, and of its mirror image.
void enlarge(Mat6& D, Index i, Index j) {
  D(i, j) *= 1.1;
  if (i != j) D(j, i) = D(i, j);
}

// ---- the converged solution ----------------------------------------------------------------------

// 32 elements of order 6: the error of the mesh is about 1e-22. Measured: 5.7e-18 … 9.5e-18 (round-off).
TEST(Bend45Slow, ConvergesToSixteenDigitsInLongDouble) {
  for (const Metric metric : all_metrics)
    for (const Form form : all_forms)
      EXPECT_LT(extended_error(extended(metric, form, 6, 32)), 1e-16)
          << name_of(metric) << ' ' << name_of(form);
}

// 16 elements of order 6, through the interface that everyone has.
TEST(Bend45, ConvergesToTwelveDigits) {
  for (const Metric metric : all_metrics)
    for (const Form form : all_forms)
      EXPECT_LT(tip_error(bend(metric, form, 6, 16)), 1e-12)
          << name_of(metric) << ' ' << name_of(form);
}

// D16 is the entry that matters least: 10 % of it are 8e-7 of the displacement.
TEST(Bend45MutationSlow, OfTheConvergedSolution) {
  ExtendedBend mutant = extended(Metric::geodesic, Form::energy, 6, 32);
  mutant.D(0, 5) = mutant.D(5, 0) *= 1.1L;
  EXPECT_GT(extended_error(mutant), 1e-7);
  mutant = extended(Metric::geodesic, Form::energy, 6, 32);
  mutant.D(3, 3) *= 1.1L;
  EXPECT_GT(extended_error(mutant), 1e-4);
  mutant = extended(Metric::geodesic, Form::energy, 6, 32);
  mutant.force *= 1.1L;
  EXPECT_GT(extended_error(mutant), 1e-3);

  Scene scene = bend(Metric::geodesic, Form::energy, 6, 16);
  enlarge(scene.sections.at(0).stiffness, 0, 5);
  EXPECT_GT(tip_error(scene), 1e-7);
  scene = bend(Metric::geodesic, Form::energy, 6, 16);
  enlarge(scene.sections.at(0).stiffness, 3, 3);
  EXPECT_GT(tip_error(scene), 1e-4);
}

// ---- orders -------------------------------------------------------------------------------------

// Meshes that are fine enough to show the order, and errors above the round-off of the solution, which is
// about 1e-15 of the displacement.
const std::vector<std::vector<int>> meshes = {
    {16, 32, 64}, {8, 16, 32}, {4, 8, 16}, {4, 8, 16}, {2, 4, 8}};  // N = 1, 2, …
constexpr double finest[] = {5e-4, 1e-6, 1e-8, 1e-11, 1e-11};       // bounds of the finest's error

class OrderInSpace : public testing::TestWithParam<std::tuple<Metric, Form>> {};

// Slopes of the last halving, worst of metrics and forms: N = 1 1.999, 2 3.98, 3 5.96, 4 7.59, 5 9.77.
TEST_P(OrderInSpace, IsTwiceTheOrderOfTheElements) {
  const auto [metric, form] = GetParam();
  for (int N = 1; N <= 5; ++N) {
    std::vector<double> length, error;
    for (const int elements : meshes[static_cast<std::size_t>(N - 1)]) {
      length.push_back(1.0 / elements);
      error.push_back(tip_error(bend(metric, form, N, elements)));
    }
    const std::vector<double> slopes = orders(length, error);
    EXPECT_NEAR(slopes.back(), 2.0 * N, 0.06 * 2 * N)
        << "N = " << N << ": errors " << listed(error) << ", slopes " << listed(slopes);
    EXPECT_NEAR(fitted_order(length, error), 2.0 * N, 0.1 * 2 * N) << "N = " << N;
    EXPECT_LT(error.back(), finest[static_cast<std::size_t>(N - 1)]) << "N = " << N;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, OrderInSpace,
                         testing::Combine(testing::ValuesIn(all_metrics),
                                          testing::ValuesIn(all_forms)),
                         [](const auto& p) {
                           return name_of(std::get<0>(p.param)) + "_" +
                                  name_of(std::get<1>(p.param));
                         });

// Orders 5 and 6 again, in long double, where errors from 1e-9 to 1e-16 show; round-off is 1e-17. Slopes of the
// last halving, worst of metrics and forms: N = 5 9.79, 6 11.67.
TEST_P(OrderInSpace, BelowTheRoundOffOfDouble) {
  const auto [metric, form] = GetParam();
  for (const int N : {5, 6}) {
    std::vector<double> length, error;
    for (const int elements : N == 5 ? std::vector{4, 8, 16} : std::vector{2, 4, 8}) {
      length.push_back(1.0 / elements);
      error.push_back(extended_error(extended(metric, form, N, elements)));
    }
    const std::vector<double> slopes = orders(length, error);
    EXPECT_NEAR(slopes.back(), 2.0 * N, 0.04 * 2 * N)
        << "N = " << N << ": errors " << listed(error) << ", slopes " << listed(slopes);
    EXPECT_LT(error.back(), N == 5 ? 3e-15 : 5e-15) << "N = " << N;
  }
}

// Errors of the geodesic metric and the paper's form that were known before, to their two or three digits.
TEST(Bend45, HasTheListedErrors) {
  struct Row {
    int order, elements;
    double error, tolerance;
    Rule rule = Rule::gauss;
  };
  for (const Row& row :
       {Row{2, 8, 8.28e-6, 0.01}, Row{2, 16, 5.29e-7, 0.01}, Row{3, 8, 2.98e-8, 0.01},
        Row{3, 16, 4.77e-10, 0.01}, Row{4, 8, 5.48e-11, 0.01}, Row{4, 16, 2.20e-13, 0.1},
        Row{5, 8, 9.21e-14, 0.1}, Row{2, 8, 3.7e-3, 0.02, Rule::gauss_lobatto},
        Row{3, 8, 5.3e-6, 0.02, Rule::gauss_lobatto}}) {
    EXPECT_NEAR(tip_error(bend(Metric::geodesic, Form::paper, row.order, row.elements, row.rule)),
                row.error, row.tolerance * row.error)
        << "N = " << row.order << ", " << row.elements << " elements";
  }
}

// The same, without round-off; and 10 % more of D16, of D44 or of the load is far from any of them.
TEST(Bend45Slow, HasTheListedErrorsInLongDouble) {
  struct Row {
    int order, elements;
    double error;
    Rule rule = Rule::gauss;
  };
  for (const Row& row :
       {Row{2, 8, 8.28e-6}, Row{2, 16, 5.29e-7}, Row{3, 8, 2.98e-8}, Row{3, 16, 4.77e-10},
        Row{4, 8, 5.48e-11}, Row{4, 16, 2.20e-13}, Row{5, 8, 9.21e-14},
        Row{2, 8, 3.7e-3, Rule::gauss_lobatto}, Row{3, 8, 5.3e-6, Rule::gauss_lobatto}}) {
    // Half a unit of the last digit that is listed.
    const double tolerance = row.rule == Rule::gauss ? 0.002 * row.error : 0.01 * row.error;
    const ExtendedBend right =
        extended(Metric::geodesic, Form::paper, row.order, row.elements, row.rule);
    EXPECT_NEAR(extended_error(right), row.error, tolerance)
        << "N = " << row.order << ", " << row.elements << " elements";
    ExtendedBend wrong = right;
    wrong.D(3, 3) *= 1.1L;
    EXPECT_GT(std::abs(extended_error(wrong) - row.error), tolerance);
    wrong = right;
    wrong.force *= 1.1L;
    EXPECT_GT(std::abs(extended_error(wrong) - row.error), tolerance);
    if (row.rule != Rule::gauss) continue;  // locking outweighs D16
    wrong = right;
    wrong.D(0, 5) = wrong.D(5, 0) *= 1.1L;
    EXPECT_GT(std::abs(extended_error(wrong) - row.error), tolerance);
  }
}

// ---- the paper's table 1 ---------------------------------------------------------------------------

// Its section before it was rounded: 1 x 1, E = 1e7, Poisson's ratio 0, shear factor 5/6; D16 = k3 EI3; GJ of
// the square by Saint-Venant's series.
Mat6 unrounded_stiffness() {
  const double E = 1e7, G = 5e6, I = 1.0 / 12;
  double sum = 0.0;
  for (int n = 1; n < 200; n += 2)
    sum += std::tanh(0.5 * n * std::numbers::pi) / std::pow(n * std::numbers::pi, 5);
  Mat6 D = Vec6(E, 5 * G / 6, 5 * G / 6, G * (1.0 / 3 - 64 * sum), E * I, E * I).asDiagonal();
  D(0, 5) = D(5, 0) = -0.01 * E * I;
  return D;
}

Scene table_1(Rule rule, bool rounded) {
  Scene scene = bend(Metric::geodesic, Form::paper, 2, 8, rule);
  if (!rounded) scene.sections.at(0).stiffness = unrounded_stiffness();
  return scene;
}

double distance(const Scene& scene, const Vec3& u) {
  return (tip_displacement(scene) - u).cwiseAbs().maxCoeff();
}

struct Table1Row {
  Rule rule;
  bool rounded;
  Vec3 tip;
  double tolerance;  // greatest difference of a component
};
const Table1Row table_1_rows[] = {
    // The paper's printed numbers. What is left, 1.5e-3 and 2.4e-3, is nothing we could find.
    {Rule::gauss, false, {-13.731, -23.818, 53.607}, 2e-3},
    {Rule::gauss_lobatto, false, {-13.670, -23.712, 53.421}, 3e-3},
    // With the section as it is printed the last digit but one changes.
    {Rule::gauss, true, {-13.731, -23.818, 53.607}, 8e-3},
    {Rule::gauss_lobatto, true, {-13.670, -23.712, 53.421}, 9e-3},
    // Calculated apart from this project, to the digits given.
    {Rule::gauss, false, {-13.7325, -23.8191, 53.6079}, 1e-4},
    {Rule::gauss_lobatto, false, {-13.672, -23.714, 53.423}, 1e-3}};

TEST(Bend45, IsThatOfTable1) {
  for (const Table1Row& row : table_1_rows)
    EXPECT_LT(distance(table_1(row.rule, row.rounded), row.tip), row.tolerance)
        << row.tip.transpose() << ", is "
        << tip_displacement(table_1(row.rule, row.rounded)).transpose();
}

TEST(Bend45MutationSlow, OfTable1) {
  for (const Table1Row& row : table_1_rows) {
    for (const Index i : {3, 4, 5}) {
      Scene scene = table_1(row.rule, row.rounded);
      enlarge(scene.sections.at(0).stiffness, i, i);
      EXPECT_GT(distance(scene, row.tip), row.tolerance) << i + 1 << i + 1;
    }
    Scene scene = table_1(row.rule, row.rounded);
    for (LoadScene& load : scene.loads)
      load.force->at(2) = Expression::parse("660", {}, Variables::time);
    EXPECT_GT(distance(scene, row.tip), row.tolerance) << "load";
  }
}
TEST(Bend45, WithoutCoupling) {
  Scene scene = bend(Metric::geodesic, Form::energy, 4, 8);
  scene.sections.at(0).stiffness(0, 5) = scene.sections.at(0).stiffness(5, 0) = 0.0;
  const Vec3 u = tip_displacement(scene);
  EXPECT_LT((u - Vec3(-13.73505, -23.82530, 53.61372)).cwiseAbs().maxCoeff(), 6e-6);
}

// The Gauss-Lobatto rule locks: N points instead of the Gauss points, an error a hundred times larger.
TEST(Bend45, GaussLobattoLocks) {
  for (const Form form : all_forms) {
    for (int N = 2; N <= 4; ++N) {
      const double gauss = tip_error(bend(Metric::geodesic, form, N, 8));
      const double lobatto = tip_error(bend(Metric::geodesic, form, N, 8, Rule::gauss_lobatto));
      EXPECT_GT(lobatto, 100 * gauss) << "N = " << N;
    }
  }
}

// 10 % more of any entry of D, and the error is no longer one of the mesh.
TEST(OrderInSpaceMutation, AnyEntryOfTheStiffness) {
  for (const auto& [i, j] : {std::pair{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}, {0, 5}}) {
    std::vector<double> length, error;
    for (const int elements : {4, 8, 16}) {
      Scene scene = bend(Metric::geodesic, Form::energy, 3, elements);
      Mat6& D = scene.sections.at(0).stiffness;
      D(i, j) *= 1.1;
      if (i != j) D(j, i) *= 1.1;
      length.push_back(1.0 / elements);
      error.push_back(tip_error(scene));
    }
    EXPECT_LT(orders(length, error).back(), 1.0) << i + 1 << j + 1 << ": " << listed(error);
    EXPECT_GT(error.back(), 1e-8) << i + 1 << j + 1;
  }
}

}  // namespace
}  // namespace mbd::test::test_bend45
