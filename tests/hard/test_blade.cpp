// The blade of a wind turbine of 5 MW (61.5 m, stiffness and mass of 26 stations after Jonkman and others, NREL/TP-500-38060,
// table 2-1; shear stiffness, which they do not give, as parts of EA), held at its root, with a force at its tip that is
// suddenly there: long steps, and elements at the tip that are a hundred thousand times softer than those at the root.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tests/support/dense.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_blade {
namespace {

constexpr double blade_length = 61.5;  // [m]

// Fraction of the length, kg/m, EI of flap and edge [MN.m2], GJ [MN.m2], EA [MN], rotary inertias of flap and edge [kg.m].
constexpr std::array<std::array<double, 8>, 26> stations{{
    {0.0, 678.935, 18110.0, 18113.6, 5564.4, 9729.48, 972.86, 973.04},
    {0.01951, 773.363, 19424.9, 19558.6, 5431.59, 10789.5, 1091.52, 1066.38},
    {0.05203, 740.042, 15287.4, 19788.8, 4666.59, 9867.78, 873.81, 1099.75},
    {0.08455, 450.275, 7229.72, 10220.6, 2323.54, 5491.26, 456.76, 641.49},
    {0.11707, 400.638, 5528.36, 8063.16, 1570.36, 4493.95, 351.61, 547.18},
    {0.14959, 399.655, 4936.84, 7009.18, 1002.12, 4037.29, 303.6, 503.86},
    {0.18211, 416.82, 3949.46, 7271.66, 672.27, 4082.35, 246.57, 569.9},
    {0.21465, 381.42, 2933.74, 6244.53, 448.84, 3668.34, 187.11, 546.56},
    {0.24715, 349.477, 2388.65, 4948.49, 311.35, 3011.58, 148.56, 453.76},
    {0.29595, 339.333, 2050.05, 4501.4, 261.0, 2613.97, 124.61, 398.18},
    {0.32846, 330.004, 1828.25, 4244.07, 228.82, 2357.48, 109.42, 362.08},
    {0.36098, 321.99, 1588.71, 3995.28, 200.75, 2146.86, 94.36, 335.01},
    {0.42602, 294.734, 1102.38, 3447.14, 144.47, 1632.7, 62.67, 263.87},
    {0.49106, 263.343, 681.3, 2734.24, 81.19, 1168.76, 37.34, 196.41},
    {0.5561, 241.666, 408.9, 2334.03, 57.45, 922.95, 22.16, 162.43},
    {0.62115, 200.293, 238.63, 1584.1, 35.98, 648.03, 13.3, 116.3},
    {0.68618, 165.094, 126.01, 1183.68, 20.9, 531.15, 7.3, 98.93},
    {0.75122, 138.935, 90.88, 797.81, 16.28, 375.75, 5.19, 69.96},
    {0.81626, 107.264, 61.05, 518.19, 9.07, 244.04, 3.36, 45.44},
    {0.8813, 90.248, 39.36, 395.12, 7.08, 181.52, 2.21, 34.09},
    {0.91382, 72.906, 30.41, 304.73, 5.75, 109.23, 1.69, 20.15},
    {0.93821, 66.264, 23.84, 261.71, 4.94, 92.24, 1.34, 17.11},
    {0.95447, 55.914, 16.0, 137.88, 3.66, 53.32, 0.89, 9.77},
    {0.97073, 49.114, 10.08, 101.63, 2.64, 36.9, 0.56, 6.82},
    {0.98699, 41.669, 4.6, 64.26, 1.58, 21.31, 0.25, 4.01},
    {1.0, 10.319, 0.17, 5.01, 0.19, 3.53, 0.02, 0.68},
}};

// `n` elements of order 4, a force [N] at the tip from t = 0 on, for one second; `shear`: GA2 and GA3 as parts of EA.
Scene blade(int n, std::string_view method, double step, double force,
            std::array<double, 2> shear = {0.3, 0.1}) {
  std::string text = R"(<mbd name="blade"><section name="s">)";
  for (const auto& [at, m, flap, edge, torsion, EA, J2, J3] : stations)
    text += fmt::format(
        R"(<station at="{}"><stiffness EA="{} MN" GA2="{} MN" GA3="{} MN" GJ="{} MN.m2" EI2="{} MN.m2" EI3="{} MN.m2"/>
           <mass per_length="{}" inertia="{} {} {}"/></station>)",
        at, EA, shear[0] * EA, shear[1] * EA, torsion, flap, edge, m, J2 + J3, J2, J3);
  text += fmt::format(R"(</section>
      <beam name="b" section="s" from="0 0 0" to="61.5 0 0" normal="0 0 1" elements="{}" order="4"/>
      <fixed name="root" between="ground b.start"/><load at="b.end" force="0 0 {}"/>
      <transient duration="1" step="{}" method="{}"/>
      <record name="tip" at="b.end" quantities="displacement"/></mbd>)",
                      n, force, step, method);
  return read_model_text(text, "blade.xml");
}

// Of the table, linear between stations.
double at(double x, std::size_t column) {
  const auto after = std::find_if(stations.begin() + 1, stations.end() - 1,
                                  [&](const auto& s) { return s[0] * blade_length >= x; });
  const auto& a = *(after - 1);
  const auto& b = *after;
  const double w = (x / blade_length - a[0]) / (b[0] - a[0]);
  return (1.0 - w) * a[column] + w * b[column];
}

// Deflection of the tip at the times k dt, by cubic Euler-Bernoulli elements and the trapezoidal rule: small motions,
// neither shear nor rotary inertia.
std::vector<double> deflections(double force, double dt, int count) {
  constexpr int n = 48, each = 20;  // elements, steps between two times
  const double h = blade_length / n;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(2 * n + 2, 2 * n + 2), M = K;
  constexpr std::array points{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                              0.8611363115940526};
  constexpr std::array weights{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                               0.3478548451374538};
  for (int e = 0; e < n; ++e)
    for (std::size_t g = 0; g < points.size(); ++g) {
      const double s = 0.5 * (1.0 + points[g]), x = (e + s) * h, w = 0.5 * h * weights[g];
      const Eigen::Vector4d N(1 - 3 * s * s + 2 * s * s * s, h * (s - 2 * s * s + s * s * s),
                              3 * s * s - 2 * s * s * s, h * (s * s * s - s * s));
      const Eigen::Vector4d B =
          Eigen::Vector4d(-6 + 12 * s, h * (-4 + 6 * s), 6 - 12 * s, h * (6 * s - 2)) / (h * h);
      K.block<4, 4>(2 * e, 2 * e) += w * 1e6 * at(x, 2) * B * B.transpose();
      M.block<4, 4>(2 * e, 2 * e) += w * at(x, 1) * N * N.transpose();
    }
  const Eigen::MatrixXd k = K.bottomRightCorner(2 * n, 2 * n),
                        m = M.bottomRightCorner(2 * n, 2 * n);
  const double t = dt / each;
  const Eigen::MatrixXd inverse = dense::inverse(m + 0.25 * t * t * k);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(2 * n), u = f, v = f;
  f(2 * n - 2) = force;
  Eigen::VectorXd a = dense::solve(m, f);
  std::vector<double> tip{0.0};
  for (int i = 1; i <= each * count; ++i) {
    const Eigen::VectorXd predicted = u + t * v + 0.25 * t * t * a;
    const Eigen::VectorXd next = inverse * (f - k * predicted);
    u = predicted + 0.25 * t * t * next;
    v += 0.5 * t * (a + next);
    a = next;
    if (i % each == 0) tip.push_back(u(2 * n - 2));
  }
  return tip;
}

// Small forces and stiff shear (as above it would be 2.6 %): as the linear beam, to 1 % (rms over all rows, over the largest
// deflection), with both methods and on coarse and fine meshes. Mutation: EI3 in place of EI2.
TEST(Blade, FollowsTheLinearBeam) {
  const double force = 1.0;
  const std::vector<double> expected = deflections(force, 1e-2, 100);
  for (const auto& [n, method] :
       {std::pair{10, "radau"}, {40, "radau"}, {20, "generalized_alpha"}}) {
    SCOPED_TRACE(fmt::format("{} elements, {}", n, method));
    const History history = run_to_table(blade(n, method, 1e-2, force, {3.0, 3.0}));
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    const std::vector<double>& tip = history.table["tip.displacement.3"];
    ASSERT_EQ(tip.size(), expected.size());
    double sum = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < tip.size(); ++i) {
      sum += std::pow(tip[i] - expected[i], 2);
      largest = std::max(largest, std::abs(expected[i]));
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(tip.size())) / largest, 1e-2);
  }
}

// A force that bends it by many metres comes to its end on any mesh and in any step, and the meshes agree: 1 % of the
// largest deflection, at all rows that both have. Mutation: no retries in halves.
TEST(BladeSlow, ComesToItsEndOnAnyMeshInAnyStep) {
  const History best = run_to_table(blade(20, "radau", 2.5e-3, 1e5));
  ASSERT_TRUE(best.report.complete()) << best.report.failure;
  const std::vector<double>& right = best.table["tip.displacement.3"];
  const double largest = *std::max_element(right.begin(), right.end());
  EXPECT_GT(largest, 5.0);
  for (const int n : {10, 30, 60})
    for (const double step : {5e-3, 1e-2, 2e-2}) {
      SCOPED_TRACE(fmt::format("{} elements, {} s", n, step));
      const History history = run_to_table(blade(n, "radau", step, 1e5));
      ASSERT_TRUE(history.report.complete()) << history.report.failure;
      const std::vector<double>& tip = history.table["tip.displacement.3"];
      const auto every = static_cast<std::size_t>(std::lround(step / 2.5e-3));
      for (std::size_t i = 0; i < tip.size(); ++i)
        EXPECT_NEAR(tip[i], right[every * i], 0.01 * largest) << "row " << i;
    }
}

}  // namespace
}  // namespace mbd::test::test_blade
