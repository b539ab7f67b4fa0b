// Structural damping of beams against closed forms.
//
// Modes. Where C = beta D and the drag is alpha M, a linear mode of the undamped frequency omega obeys
//   a'' + (alpha + beta omega^2) a' + omega^2 a = 0,                                                  (1)
// whatever the beam: damping ratio zeta = beta omega/2 + alpha/(2 omega). In one that turns with Omega, its
// complex deflection in inertial axes, to the square of radius of gyration over length,
//   z'' + (alpha + beta omega^2) z' + omega^2 (1 - i beta Omega) z = 0,                               (2)
// neither growing nor decaying at Omega = omega (1 + alpha/(beta omega^2)). Eigenvalues s of the motion are found
// from the motion alone: z(t) + b z(t + T) + c z(t + 2 T) = 0 with roots exp(s T), b and c by least squares.
//
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

#include "libmbd/study/trust/transform.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_damping {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

// --- closed forms of the bars of models/damped_beam.xml ---

constexpr double L = 1.0, a = 0.06, hold = 1e-3;
constexpr double EA = 2.1e11 * a * a, GA = 5.0 / 6.0 * 8e10 * a * a,
                 EI = 2.1e11 * a * a * a * a / 12, m = 7850 * a * a, J = 7850 * a * a * a * a / 12;

double bending_frequency() {  // with shear and rotary inertia, between pins
  const double k2 = pi * pi / (L * L), b = (GA * k2) * J + (EI * k2 + GA) * m,
               c = GA * k2 * EI * k2;
  return std::sqrt(2.0 * c / (b + std::sqrt(b * b - 4.0 * m * J * c)));
}
double axial_frequency() { return 0.5 * pi / L * std::sqrt(EA / m); }

// Of (1): 1 until `hold`, then free.
double decay(double omega, double alpha, double beta, double t) {
  if (t <= hold) return 1.0;
  const double z = 0.5 * (alpha + beta * omega * omega), w = std::sqrt(omega * omega - z * z),
               s = t - hold;
  return std::exp(-z * s) * (std::cos(w * s) + z / w * std::sin(w * s));
}

// --- eigenvalues of a motion ---

// Of samples `every` apart, from row `first` on, the eigenvalue of the larger imaginary part.
Complex eigenvalue(const std::vector<Complex>& z, double every, std::size_t first,
                   std::size_t shift) {
  Eigen::Matrix2cd N = Eigen::Matrix2cd::Zero();
  Eigen::Vector2cd f = Eigen::Vector2cd::Zero();
  for (std::size_t i = first; i + 2 * shift < z.size(); ++i) {
    const Eigen::RowVector2cd row(z[i], z[i + shift]);
    N += row.adjoint() * row;
    f -= row.adjoint() * z[i + 2 * shift];
  }
  const Eigen::Vector2cd cb = dense::solve(Eigen::MatrixXcd(N), Eigen::VectorXcd(f));
  const Complex root = std::sqrt(0.25 * cb(1) * cb(1) - cb(0));
  const double T = every * static_cast<double>(shift);
  const Complex one = std::log(-0.5 * cb(1) + root) / T, other = std::log(-0.5 * cb(1) - root) / T;
  return one.imag() > other.imag() ? one : other;
}
std::vector<Complex> complex(const std::vector<double>& x) { return {x.begin(), x.end()}; }

struct Damping {
  double alpha, beta;
};
Scene damped_beam(const Damping& d) {
  Scene scene = model_scene("damped_beam");
  scene.sections.front().damping->stiffness_proportional = d.beta;
  scene.sections.front().damping->mass_proportional = d.alpha;
  return scene;
}
History run_well(const Scene& scene) {
  History h = run_to_table(scene);
  EXPECT_TRUE(h.report.complete()) << h.report.failure;
  return h;
}

// Complex eigenvalues of the first bending and the first axial mode.
TEST(StructuralDamping, DampingRatios) {
  constexpr double every = 5e-5;
  for (const Damping& d : {Damping{18, 4.5e-5}, Damping{0, 4.5e-5}, Damping{60, 0}}) {
    SCOPED_TRACE(testing::Message() << "alpha " << d.alpha << ", beta " << d.beta);
    Scene scene = damped_beam(d);
    scene.transient->step =
        2.5e-5;  // Radau damps the axial mode as h^6: at 50 us by 4e-4 of its least
    scene.transient->output = every;
    const Table t = run_well(scene).table;
    const struct {
      const char* column;
      double omega;
      std::size_t shift;
    } modes[] = {{"bend.displacement.3", bending_frequency(), 40},
                 {"pull.displacement.1", axial_frequency(), 4}};
    for (const auto& mode : modes) {
      const Complex s = eigenvalue(complex(t[mode.column]), every, 21, mode.shift);
      const double zeta = -s.real() / std::abs(s),
                   want = 0.5 * d.beta * mode.omega + 0.5 * d.alpha / mode.omega;
      RecordProperty(mode.column, testing::PrintToString(zeta / want - 1.0));
      EXPECT_NEAR(std::abs(s) / mode.omega, 1.0, 5e-6) << mode.column;
      EXPECT_NEAR(zeta / want, 1.0, 2e-4) << mode.column;
    }
  }
}

// The course against (1), steps of 50 us / 2^k: error over the amplitude, largest over the rows.
double error_of(Scene scene, double step, const char* column, double omega, const Damping& d) {
  scene.transient->step = step;
  const Table t = run_well(scene).table;
  double worst = 0.0;
  for (std::size_t i = 0; i < t.rows(); ++i)
    worst = std::max(
        worst, std::abs(t[column][i] / t[column][0] - decay(omega, d.alpha, d.beta, t["time"][i])));
  return worst;
}

TEST(StructuralDamping, ErrorsOfTheCourseConverge) {
  const Damping d{18, 4.5e-5};
  const double bending = bending_frequency(), axial = axial_frequency();
  for (const Balance balance : {Balance::acceleration, Balance::momentum}) {
    Scene scene = damped_beam(d);
    scene.transient->method = TimeMethod::generalized_alpha;
    scene.transient->rho_infinity = 0.8;
    scene.transient->balance = balance;
    scene.transient->newton_tolerance = 1e-12;
    const std::array h{1e-4, 5e-5, 2.5e-5};
    std::vector<double> e;
    for (const double step : h)
      e.push_back(error_of(scene, step, "bend.displacement.3", bending, d));
    RecordProperty(balance == Balance::momentum ? "momentum" : "acceleration",
                   testing::PrintToString(e));
    for (const double p : orders(h, e)) EXPECT_NEAR(p, 2.0, 0.1) << testing::PrintToString(e);
    EXPECT_LT(e.back(), 2e-3);
  }
  // Radau: no more than what the closed form leaves out, and a stiff axial mode at 0.4 to 0.8 radians a step.
  const Scene scene = damped_beam(d);
  EXPECT_LT(error_of(scene, 5e-5, "bend.displacement.3", bending, d), 2e-6);
  const double coarse = error_of(scene, 1e-4, "pull.displacement.1", axial, d),
               fine = error_of(scene, 5e-5, "pull.displacement.1", axial, d);
  EXPECT_LT(fine, 1e-5);
  EXPECT_GT(coarse / fine, 16.0);
  // and 10 % less damping would be seen
  EXPECT_GT(error_of(damped_beam({18, 4.05e-5}), 5e-5, "bend.displacement.3", bending, d), 1e-3);
}

// Of a tapered bar C = beta D from place to place: zeta = beta |s|/2 with |s| of the motion itself. Each entry by
// its name is as good as beta of that entry.
TEST(StructuralDamping, SectionsThatVaryAndEntriesByName) {
  constexpr double beta = 4.5e-5, every = 5e-5;
  Scene scene = damped_beam({0, beta});
  Section& section = scene.sections.front();
  Station thick{{}, 0.0, section.stiffness, section.mass, {}, {}}, thin = thick;
  thin.at = 1.0;
  thin.stiffness *= 0.3;
  *thin.mass *= 0.5;
  section.stations = {thick, thin};
  for (const auto interpolation : {Interpolation::linear, Interpolation::smooth}) {
    section.interpolation = interpolation;
    const Table t = run_well(scene).table;
    const Complex s = eigenvalue(complex(t["bend.displacement.3"]), every, 100, 40);
    EXPECT_GT(std::abs(std::abs(s) / bending_frequency() - 1.0), 0.05);
    EXPECT_NEAR(-s.real() / std::abs(s) / (0.5 * beta * std::abs(s)), 1.0, 1e-3);
  }

  const Table proportional = run_well(damped_beam({0, beta})).table;
  Scene by_name = damped_beam({0, 0});
  by_name.sections.front().damping->viscous = beta * by_name.sections.front().stiffness;
  const Table same = run_well(by_name).table;
  by_name.sections.front().damping->viscous(4, 4) = 0.0;  // leaves the axial mode as it is
  const Table other = run_well(by_name).table;
  double equal = 0.0, axial = 0.0, bending = 0.0;
  for (std::size_t i = 0; i < same.rows(); ++i) {
    for (const char* column : {"bend.displacement.3", "pull.displacement.1"})
      equal = std::max(equal, std::abs(same[column][i] - proportional[column][i]));
    axial = std::max(
        axial, std::abs(other["pull.displacement.1"][i] - proportional["pull.displacement.1"][i]));
    bending = std::max(bending, std::abs(other["bend.displacement.3"][i] -
                                         proportional["bend.displacement.3"][i]));
  }
  EXPECT_LE(equal, 1e-12);
  EXPECT_LE(axial, 1e-12);
  EXPECT_GT(bending, 1e-5);
}

// What is recorded of the section is D E + C Edot: in a mode M(t)/M(0) = (a + beta a')/a(0), at mid-span where there
// is no shear. Detects M without its viscous part.
TEST(StructuralDamping, RecordedMomentHasItsViscousPart) {
  const Damping d{0, 4.5e-5};
  Scene scene = damped_beam(d);
  scene.records.front().quantities.push_back("velocity");
  const Table t = run_well(scene).table;
  const auto &w = t["bend.displacement.3"], &v = t["bend.velocity.3"], &M = t["bend.moment.2"];
  double error = 0.0, elastic = 0.0;
  for (std::size_t i = 60; i < t.rows(); ++i) {
    error = std::max(error, std::abs(M[i] / M[0] - (w[i] + d.beta * v[i]) / w[0]));
    elastic = std::max(elastic, std::abs(M[i] / M[0] - w[i] / w[0]));
  }
  RecordProperty("error", testing::PrintToString(error));
  EXPECT_LT(error, 1e-4);
  EXPECT_GT(elastic, 1e-2);
}

// start + works = end, up to the integrator: of order 2 with generalized-alpha at rho = 1.
TEST(StructuralDamping, EnergyBalance) {
  Scene scene = model_scene("free_beam");
  scene.sections.front().damping = SectionDamping{{}, 0.02, 0.01, Mat6::Zero()};
  scene.transient->duration = 7.5;
  scene.transient->rho_infinity = 1.0;
  for (const Balance balance : {Balance::acceleration, Balance::momentum}) {
    scene.transient->balance = balance;
    const std::array h{0.0125, 0.00625};  // one balance changes the sign at 0.04
    std::vector<double> left;
    double work = 0.0;
    for (const double step : h) {
      scene.transient->step = step;
      const RunReport report = run(scene, {.output = {}, .observers = {}, .progress = {}});
      ASSERT_TRUE(report.complete()) << report.failure;
      left.push_back(std::abs(report.dissipated()) / report.energy_end.total());
      work = -report.work.damping / report.energy_end.total();
    }
    EXPECT_GT(work, 0.05) << "nothing to balance";
    EXPECT_NEAR(orders(h, left)[0], 2.0, 0.15) << testing::PrintToString(left);
    EXPECT_LT(left.back(), 2e-4 * work) << testing::PrintToString(left);
  }
}

// Momenta of a free, flexible beam in large motion: viscous forces keep them, drag takes both with exp(-alpha t).
TEST(StructuralDamping, MomentaOfAFreeBeam) {
  constexpr double alpha = 0.3;
  Scene scene = model_scene("free_beam");
  scene.transient->duration = 10.0;
  scene.transient->newton_tolerance = 1e-14;
  const auto momenta = [&](double mass_proportional) {
    scene.sections.front().damping = SectionDamping{{}, 0.02, mass_proportional, Mat6::Zero()};
    return run_well(scene).table;
  };
  const auto at = [](const Table& t, double time, const std::string& name) {
    const auto row = static_cast<std::size_t>(std::lround(time / 0.025));
    return Vec3(t[name + ".1"][row], t[name + ".2"][row], t[name + ".3"][row]);
  };
  const Table viscous = momenta(0.0), dragged = momenta(alpha);
  for (const std::string name : {"all.linear_momentum", "all.angular_momentum"}) {
    const Vec3 p = at(viscous, 6, name);
    EXPECT_GT(p.norm(), 10.0);
    EXPECT_LT((at(viscous, 10, name) - p).norm() / p.norm(), 1e-11) << name;
    const Vec3 q = at(dragged, 6, name);
    EXPECT_LT((at(dragged, 10, name) - std::exp(-4 * alpha) * q).norm() / q.norm(), 1e-4) << name;
  }
}

// The methods and balances agree on a large motion.
TEST(StructuralDamping, MethodsAgree) {
  Scene scene = model_scene("free_beam");
  scene.sections.front().damping = SectionDamping{{}, 0.02, 0.05, Mat6::Zero()};
  scene.sections.front().damping->viscous(3, 3) = 20.0;
  TransientScene& transient = *scene.transient;
  transient.duration = 3.0;
  const auto end = [&](TimeMethod method, std::optional<double> step,
                       std::optional<double> tolerance, std::optional<Balance> balance) {
    transient.method = method;
    transient.step = step;
    transient.tolerance = tolerance;
    transient.balance = balance;
    transient.rho_infinity = balance ? std::optional(0.9) : std::nullopt;
    transient.newton_tolerance = balance ? std::optional(1e-12) : std::nullopt;
    transient.output = 3.0;
    const Table t = run_well(scene).table;
    return Vec3(t["end.position.1"].back(), t["end.position.2"].back(), t["end.position.3"].back());
  };
  using enum TimeMethod;
  const Vec3 want = end(radau, {}, 1e-8, {});
  EXPECT_LT((end(ida, {}, 1e-7, {}) - want).norm(), 2e-4);
  EXPECT_LT((end(radau, 0.02, {}, {}) - want).norm(), 1e-5);
  for (const Balance balance : {Balance::acceleration, Balance::momentum}) {
    const double coarse = (end(generalized_alpha, 0.02, {}, balance) - want).norm(),
                 fine = (end(generalized_alpha, 0.01, {}, balance) - want).norm();
    EXPECT_NEAR(coarse / fine, 4.0, 0.5);
    EXPECT_LT(fine, 0.02);
  }
}

// --- internal damping of a shaft ---

struct Whirl {
  double omega, alpha, beta;
  Complex s(double ratio) const {  // root of (2) next to i omega
    const Complex b = alpha + beta * omega * omega,
                  c = omega * omega * Complex(1.0, -beta * ratio * omega);
    const Complex root = std::sqrt(0.25 * b * b - c);
    const Complex one = -0.5 * b + root, other = -0.5 * b - root;
    return one.imag() > 0.0 ? one : other;
  }
};

// Eigenvalue of the forward whirl at `ratio` times the first critical speed, from 0.3 s on, when backward whirl and
// higher modes are gone; seen from mid-span.
Complex whirl(double ratio, const Damping& d) {
  Scene scene = model_scene("internal_damping", {{"ratio", std::to_string(ratio)}});
  scene.sections.front().damping->mass_proportional = d.alpha;
  scene.sections.front().damping->stiffness_proportional = d.beta;
  constexpr double every = 1e-3;
  scene.transient->output = every;
  const Table t = run_well(scene).table;
  std::vector<Complex> z;
  for (std::size_t i = 0; i < t.rows(); ++i)
    z.emplace_back(t["M.displacement.2"][i], t["M.displacement.3"][i]);
  return eigenvalue(z, every, 300, 3);
}

TEST(InternalDamping, WhirlGrowsAboveTheThreshold) {
  const double omega = std::pow(4.730040745, 2) * std::sqrt(2.1e11 / 7850.0) * 0.01 / 4.0,
               beta = 0.04 / omega, unit = 0.5 * beta * omega * omega;
  for (const double external : {0.0, 0.25}) {  // alpha/(beta omega^2)
    const Damping d{external * beta * omega * omega, beta};
    const Whirl closed{omega, d.alpha, d.beta};
    const double threshold = 1.0 + external;
    EXPECT_NEAR(closed.s(threshold).real() / unit, 0.0, 1e-12);
    for (const double factor : {0.8, 0.97, 1.03, 1.3}) {
      const double ratio = factor * threshold;
      const Complex s = whirl(ratio, d), want = closed.s(ratio);
      RecordProperty("rate_at_" + std::to_string(ratio),
                     testing::PrintToString((s.real() - want.real()) / unit));
      EXPECT_EQ(s.real() > 0.0, factor > 1.0) << ratio;
      EXPECT_NEAR(s.real() / unit, want.real() / unit, 2e-3) << ratio;
      EXPECT_NEAR(s.imag() / want.imag(), 1.0, 1e-3) << ratio;
    }
  }
}

// In other units: C = beta D is the same whether beta or its entries were given.
TEST(StructuralDamping, IsRescaled) {
  Scene scene = damped_beam({18, 4.5e-5});
  SectionDamping& damping = *scene.sections.front().damping;
  damping.viscous = damping.stiffness_proportional * scene.sections.front().stiffness;
  const Scene other = rescaled(scene, {.length = 10.0, .mass = 3.0, .time = 1e3}).scene;
  const SectionDamping& d = *other.sections.front().damping;
  EXPECT_DOUBLE_EQ(d.stiffness_proportional, 4.5e-2);
  EXPECT_DOUBLE_EQ(d.mass_proportional, 18e-3);
  EXPECT_TRUE(
      d.viscous.isApprox(d.stiffness_proportional * other.sections.front().stiffness, 1e-14));
  EXPECT_FALSE(d.viscous.isApprox(damping.viscous, 0.1));
}

// --- what is read, and what is not there ---

TEST(StructuralDamping, IsRead) {
  const auto damping = [](const std::string& attributes) {
    return read_model_text(R"(<mbd name="one"><section name="s">
        <stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/>
        <damping )" + attributes +
                           R"(/></section></mbd>)")
        .sections.at(0)
        .damping.value();
  };
  const SectionDamping d =
      damping(R"(stiffness_proportional="2 ms" mass_proportional="3" EA="5" EI3="7" D16="-0.5")");
  EXPECT_DOUBLE_EQ(d.stiffness_proportional, 2e-3);
  EXPECT_EQ(d.mass_proportional, 3.0);
  Mat6 want = Mat6::Zero();
  want(0, 0) = 5.0;
  want(5, 5) = 7.0;
  want(0, 5) = want(5, 0) = -0.5;
  EXPECT_EQ(d.viscous, want);
  EXPECT_EQ(d.source.line, 3);
  EXPECT_EQ(damping(R"(mass_proportional="0")").mass_proportional, 0.0);
}

TEST(StructuralDamping, IsNotThereInStatics) {
  Scene scene = model_scene("damped_beam");
  const auto batches = [](const Scene& s) { return compile(s).system->batches().size(); };
  const std::size_t all = batches(scene);
  Scene undamped = scene;
  undamped.sections.front().damping.reset();
  EXPECT_EQ(batches(undamped) + 2, all);
  Scene zero = scene;
  zero.sections.front().damping = SectionDamping{};
  EXPECT_EQ(batches(zero) + 2, all);

  // The phase of statics is the same to the last bit; and so is what is recorded before there are rates.
  scene.transient->duration = undamped.transient->duration = 1e-3;
  const Table with = run_well(scene).table, without = run_well(undamped).table;
  for (const std::string& name : with.names)
    EXPECT_EQ(with[name].front(), without[name].front()) << name;

  scene.transient.reset();
  undamped.transient.reset();
  EXPECT_EQ(batches(scene), batches(undamped));
}

}  // namespace
}  // namespace mbd::test::test_damping
