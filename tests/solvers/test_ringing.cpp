// Where little is damped, index-3 multipliers and velocities ring in steps that do not resolve the motion: generalized-alpha
// calms them, goes on to the end, stays of order 2, and changes nothing where nothing rings.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "solvers/constraints/initial.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/landings.hpp"

namespace mbd::test::test_ringing {
namespace {

// n thin rods of 0.3 m and 2 kg on balls, let go level: not the model's lengths and masses.
constexpr double length = 0.3, mass = 2.0, g = 9.81;
Scene chain(int n, double step, double rho, double duration) {
  return scene_of(fmt::format(
      R"(<repeat count="{0}" index="i">
           <body name="r{{i}}" at="(i+1)*{1} 0 0" mass="{2}" center="-{1}/2 0 0" inertia="1e-3 {3} {3}"/>
         </repeat>
         <spherical name="j0" between="ground r0" at="0 0 0"/>
         <repeat count="{0}-1" index="i">
           <spherical name="j{{i+1}}" between="r{{i}} r{{i+1}}" at="(i+1)*{1} 0 0"/>
         </repeat>
         <gravity acceleration="0 0 -{4}"/>
         <transient duration="{5}" step="{6}" rho_infinity="{7}"/>
         <record name="tip" at="r{{{0}-1}}" quantities="position"/>)",
      n, length, mass, mass * length * length / 12.0, g, duration, step, rho));
}

// The same by Lagrange's equations in the angles of the rods to the level, Runge-Kutta of order 4: the tip at `end`.
std::array<double, 2> tip_of_chain(int n, double end, int steps) {
  const auto N = static_cast<Index>(n);
  const auto accelerations = [&](const VecX& theta, const VecX& rate) {
    Eigen::MatrixXd M(N, N);
    VecX f(N);
    for (Index i = 0; i < N; ++i) {
      f(i) = -mass * g * length * (double(N - 1 - i) + 0.5) * std::cos(theta(i));
      for (Index j = 0; j < N; ++j) {
        const Index far = std::max(i, j);
        const double m =
            mass * length * length * (double(N - 1 - far) + (i == j ? 1.0 / 3.0 : 0.5));
        M(i, j) = m * std::cos(theta(i) - theta(j));
        f(i) -= m * std::sin(theta(i) - theta(j)) * rate(j) * rate(j);
      }
    }
    return dense::solve(M, f);
  };
  VecX q = VecX::Zero(N), v = VecX::Zero(N);
  const double h = end / steps;
  for (int s = 0; s < steps; ++s) {
    const VecX a1 = accelerations(q, v), v2 = v + 0.5 * h * a1;
    const VecX a2 = accelerations(q + 0.5 * h * v, v2), v3 = v + 0.5 * h * a2;
    const VecX a3 = accelerations(q + 0.5 * h * v2, v3), v4 = v + h * a3;
    const VecX a4 = accelerations(q + h * v3, v4);
    q += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  std::array<double, 2> tip{};
  for (Index i = 0; i < N; ++i) {
    tip[0] += length * std::cos(q(i));
    tip[1] += length * std::sin(q(i));
  }
  return tip;
}

// Mutation: calm_velocities() not called: 8 of the runs end before their time, and energy comes from nowhere.
TEST(Ringing, ChainsRunToTheirEnd) {
  for (const int n : {10, 30})
    for (const double step : {2e-3, 5e-3, 1e-2, 2e-2})
      for (const double rho : {0.0, 0.8, 0.9, 1.0}) {
        const RunReport report = run(chain(n, step, rho, 1.6));
        EXPECT_EQ(report.failure, "") << n << " " << step << " " << rho;
        // Of the energy that moved: little is put in, where steps are a tenth of a rod's swing and less.
        if (step < 2e-2) {
          EXPECT_GT(report.dissipated(), -0.02 * report.energy_moved())
              << n << " " << step << " " << rho;
        }
      }
}

// Mutation: the change of velocities doubled: order 1.
TEST(Ringing, OrderTwoStaysWhereVelocitiesAreProjected) {
  constexpr int n = 5;
  constexpr double end = 0.8;
  const std::array<double, 2> exact = tip_of_chain(n, end, 20'000);
  const auto error = [&](double rho, double step) {
    const History history = run_to_table(chain(n, step, rho, end));
    EXPECT_EQ(history.report.failure, "");
    const std::size_t last = history.table.rows() - 1;
    return std::hypot(history.table["tip.position.1"][last] - exact[0],
                      history.table["tip.position.3"][last] - exact[1]);
  };
  for (const double rho : {0.95, 1.0}) {  // from the start
    const double coarse = error(rho, 2e-3), fine = error(rho, 1e-3);
    EXPECT_LT(fine, 1e-4 * n * length) << rho;
    EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.2) << rho << " " << coarse << " " << fine;
  }
}

// Windows of four links on parallel revolutes through their change points, where each loop loses a constraint more.
// Mutation: increments of multipliers counted in rank-tolerant steps, and one eps only: N = 40 ends at 0.72 s.
TEST(RingingSlow, WindowsPassTheirChangePoints) {
  for (const auto& [n, step, rho] : {std::tuple{1, 1e-3, 0.9},
                                     {5, 2e-3, 0.0},
                                     {20, 1e-3, 0.0},
                                     {40, 1e-3, 0.9},
                                     {40, 5e-3, 0.0}}) {
    Scene scene =
        read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models/hard/windows_parallel.xml",
                   {{"N", std::to_string(n)}});
    scene.expects.clear();
    change_stepping(*scene.transient, {.method = TimeMethod::generalized_alpha, .step = step});
    scene.transient->rho_infinity = rho;
    scene.transient->output.reset();
    scene.transient->duration = n < 40 ? 4.0 : 1.0;
    const RunReport report = run(scene);
    EXPECT_EQ(report.failure, "") << n << " " << step << " " << rho;
    EXPECT_LT(std::abs(report.dissipated()), 0.01 * report.energy_moved()) << n;
  }
}

}  // namespace
}  // namespace mbd::test::test_ringing
