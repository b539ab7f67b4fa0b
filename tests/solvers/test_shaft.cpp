// The rotating shaft (models/shaft.xml) against its converged reference.
//
// Norm: sqrt(sum e2^2 + e3^2) / sqrt(sum u2^2 + u3^2) over the 501 times of the reference (every 5 ms,
// 0 … 2.5 s), u2 and u3 the inertial displacements of mid-span, e their errors. At the paper's step the
// error is that of the integrator, several per cent; so its size is tested, not only a bound: within 5 %
// of what the scheme gives. Sag: at mid-span in equilibrium at rest, relative.

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "tests/support/scenes.hpp"

namespace mbd::test::test_shaft {
namespace {

constexpr double sag = 3.525552557e-3;  // [m]
constexpr double sag_tolerance = 1e-9;  // of the sag; 8 digits are 1.4e-8
constexpr double band = 0.05;

// Errors of the scheme with rho_infinity = 0 and steps of 5 ms / refinement.
const std::map<int, double> scheme = {{1, 3.83e-2}, {2, 9.64e-3}, {4, 2.52e-3}, {8, 6.47e-4}};

struct Measured {
  double error = 0.0;
  double sag = 0.0;  // [m]
};

Measured measure(Scene scene, int refinement) {
  scene.transient->step = 5e-3 / refinement;
  const History history = run_to_table(scene, refinement);
  EXPECT_TRUE(history.report.complete()) << history.report.failure;
  const Table& t = history.table;
  const Table reference = reference_table("shaft");
  EXPECT_EQ(reference.rows(), 501u);
  EXPECT_EQ(t.rows(), 501u);
  for (std::size_t k = 0; k < t.rows(); ++k) {
    EXPECT_NEAR(t["time"][k], reference["t"][k], 1e-12);
    EXPECT_NEAR(t["drive.angle"][k], reference["theta"][k], 1e-10);
  }
  return {.error = relative_rms({&t["M.displacement.2"], &t["M.displacement.3"]},
                                {&reference["u2"], &reference["u3"]}, 0, t.rows()),
          .sag = -t["M.displacement.3"].front()};
}

bool in_band(double error, int refinement) {
  return std::abs(error / scheme.at(refinement) - 1.0) <= band;
}

TEST(ShaftScene, IsThePapers) {
  const Scene scene = model_scene("shaft");
  ASSERT_EQ(scene.beams.size(), 1u);
  EXPECT_EQ(scene.beams[0].elements, 8);
  EXPECT_EQ(scene.beams[0].order, 3);
  EXPECT_EQ(scene.transient->step, 5e-3);
  EXPECT_EQ(scene.transient->rho_infinity, 0.0);
  EXPECT_EQ(scene.transient->duration, 2.5);
}

class Shaft : public testing::TestWithParam<std::tuple<Metric, Form>> {
 protected:
  static void expect_error_of_the_scheme(int refinement) {
    const auto [metric, form] = GetParam();
    Scene scene = with(model_scene("shaft"), metric, form);
    if (metric == Metric::matrix && form == Form::energy && refinement == 8)
      scene.beams.front().order = 4;
    const Measured m = measure(scene, refinement);
    EXPECT_NEAR(m.error, scheme.at(refinement), band * scheme.at(refinement))
        << "step 5 ms / " << refinement;
    EXPECT_NEAR(m.sag, sag, sag_tolerance * sag);
  }
};
class ShaftSlow : public Shaft {};

// Measured at 5, 2.5, 1.25, .625 ms, paper's form:
//   matrix 3.833e-2, 9.651e-3, 2.528e-3, 6.604e-4; quaternion 3.832e-2, 9.644e-3, 2.522e-3, 6.538e-4;
//   geodesic 3.832e-2, 9.642e-3, 2.520e-3, 6.518e-4;
// energy form: quaternion 3.832e-2, 9.644e-3, 2.522e-3, 6.543e-4; geodesic 3.831e-2, 9.636e-3, 2.514e-3,
// 6.464e-4. Matrix metric with the energy form: 3.835e-2, 9.673e-3, 2.550e-3, 6.814e-4; the last is 5.3 %
// off, by the error of the mesh, so this pair has its elements of order 4 there (6.487e-4).
TEST_P(Shaft, HasTheErrorOfTheScheme) {
  for (const int refinement : {1, 2}) expect_error_of_the_scheme(refinement);
}
TEST_P(ShaftSlow, HasTheErrorOfTheScheme) {
  for (const int refinement : {4, 8}) expect_error_of_the_scheme(refinement);
}

std::string name_of_case(const testing::TestParamInfo<std::tuple<Metric, Form>>& p) {
  return name_of(std::get<0>(p.param)) + "_" + name_of(std::get<1>(p.param));
}
const auto every_case =
    testing::Combine(testing::ValuesIn(all_metrics), testing::ValuesIn(all_forms));
INSTANTIATE_TEST_SUITE_P(Every, Shaft, every_case, name_of_case);
INSTANTIATE_TEST_SUITE_P(Every, ShaftSlow, every_case, name_of_case);

// ---- mutations: 10 % more of one thing, steps of .625 ms ----------------------------------------

using Mutation = std::function<void(Scene&)>;

Mutation change_D(Index i, Index j) {
  return [=](Scene& scene) {
    Mat6& D = scene.sections.at(0).stiffness;
    D(i - 1, j - 1) *= 1.1;
    if (i != j) D(j - 1, i - 1) *= 1.1;
  };
}

Measured measure_with(const Mutation& mutation) {
  Scene scene = model_scene("shaft");
  mutation(scene);
  return measure(scene, 8);
}

TEST(ShaftMutationSlow, MassLeavesTheBandAndTheSag) {
  const Measured disk = measure_with([](Scene& s) { s.bodies.at(0).mass *= 1.1; });
  EXPECT_FALSE(in_band(disk.error, 8)) << disk.error;
  EXPECT_GT(std::abs(disk.sag / sag - 1.0), sag_tolerance);
  const Measured beam =
      measure_with([](Scene& s) { s.sections.at(0).mass->topLeftCorner<3, 3>() *= 1.1; });
  EXPECT_FALSE(in_band(beam.error, 8)) << beam.error;
  EXPECT_GT(std::abs(beam.sag / sag - 1.0), sag_tolerance);
}

// Disk 1.71e-3, beam 5.62e-4; equilibrium at rest does not depend on them.
TEST(ShaftMutationSlow, InertiaLeavesTheBand) {
  const Measured disk = measure_with([](Scene& s) { s.bodies.at(0).inertia *= 1.1; });
  EXPECT_FALSE(in_band(disk.error, 8)) << disk.error;
  EXPECT_NEAR(disk.sag, sag, sag_tolerance * sag);
  const Measured beam =
      measure_with([](Scene& s) { s.sections.at(0).mass->bottomRightCorner<3, 3>() *= 1.1; });
  EXPECT_FALSE(in_band(beam.error, 8)) << beam.error;
}

// The diagonal of D: 5.8e-4 (D11), .990 (D55), 1.08 (D66), about 1e-2 (D22, D33, D44). The coupling of
// shear and bending: the sag by 3.7e-6 (D25) and 9.7e-9 (D36) of itself. D14, which couples stretching
// with twisting, does neither (the shaft is free to slide); four_bar sees it.
TEST(ShaftMutationSlow, StiffnessLeavesTheBandOrTheSag) {
  for (Index i = 1; i <= 6; ++i) {
    const Measured m = measure_with(change_D(i, i));
    EXPECT_FALSE(in_band(m.error, 8)) << "D" << i << i << ": " << m.error;
  }
  for (Index i = 2; i <= 3; ++i) {
    const Measured m = measure_with(change_D(i, i + 3));
    EXPECT_GT(std::abs(m.sag / sag - 1.0), sag_tolerance) << "D" << i << i + 3;
  }
}

// At the paper's own step of 5 ms, where the band is wide, what is left: mass and bending stiffness.
TEST(ShaftMutationSlow, ThePapersStepSeesMassAndBending) {
  for (const Mutation& mutation :
       {Mutation([](Scene& s) { s.bodies.at(0).mass *= 1.1; }),
        Mutation([](Scene& s) { s.sections.at(0).mass->topLeftCorner<3, 3>() *= 1.1; }),
        change_D(2, 2), change_D(3, 3), change_D(4, 4), change_D(5, 5), change_D(6, 6)}) {
    Scene scene = model_scene("shaft");
    mutation(scene);
    const Measured m = measure(scene, 1);
    EXPECT_FALSE(in_band(m.error, 1)) << m.error;
  }
}

}  // namespace
}  // namespace mbd::test::test_shaft
