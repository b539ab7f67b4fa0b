// Conditions of eigenvalues: closed forms, left eigenvectors of dense matrices, and what a change of the matrices does.
// Errors are relative. Seen to fail: where y is taken for the conjugate of x, where C is left out of the slope, where Q is solved
// and not its transpose.
#include "solvers/modes/condition.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numeric>

#include "libmbd/compile/model.hpp"
#include "libmbd/run/run.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_conditions {
namespace {

using Complex = std::complex<double>;
using MatXc = Eigen::MatrixXcd;

std::vector<Mode> modes_of(SmallMotions& motions, int count) {
  const ModesFound found = find_modes(motions, {.count = count});
  EXPECT_EQ(found.failure, "");
  return found.modes;
}

// 2 kg on a spring and a damper, 5 rad/s without the latter.
std::vector<Mode> of_oscillator(double zeta) {
  const Model model = compile(read(fmt::format(R"(
    <body name="b" mass="2" inertia="1 1 1"/><prismatic name="p" between="ground b" axis="1 0 0"/>
    <bushing name="s" between="ground b" stiffness="50 0 0 0 0 0" damping="{} 0 0 0 0 0"/>
    <transient duration="1" step="0.1"/>)",
                                               20.0 * zeta)));
  SmallMotions motions(*model.system);
  motions.about(model.initial);
  return modes_of(motions, zeta > 1.0 ? 2 : 1);
}

// kappa = 2 |l| m/|2 l m + c|, l = w (-zeta +- sqrt(zeta^2 - 1)).
TEST(Conditions, OfADampedOscillator) {
  for (const double zeta : {0.0, 0.3, 0.9, 0.9999}) {
    const auto modes = of_oscillator(zeta);
    ASSERT_FALSE(modes.empty());
    const double want = 1.0 / std::sqrt(1.0 - zeta * zeta);
    EXPECT_NEAR(modes[0].condition, want, 1e-8 * want * want * want) << zeta;
  }
  for (const double zeta : {1.01, 3.0}) {
    const auto modes = of_oscillator(zeta);
    ASSERT_EQ(modes.size(), 2u) << zeta;
    const double root = std::sqrt(zeta * zeta - 1.0);
    for (int k = 0; k < 2; ++k) {
      const double want = (k == 0 ? zeta - root : zeta + root) / root;
      EXPECT_NEAR(modes[static_cast<std::size_t>(k)].condition, want, 1e-7 * want) << zeta;
    }
  }
}

// What moves, as constraints leave it: Z^T (K, C, M) Z, Z an orthonormal basis of what they allow.
struct Dense {
  Eigen::MatrixXd Z, K, C, M;

  explicit Dense(const SmallMotions& motions) {
    const Eigen::MatrixXd B(motions.constraint_gradient());
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(B.transpose());
    const Index n = motions.motions();
    Z = Eigen::MatrixXd(qr.householderQ()).rightCols(n - B.rows());
    const auto within = [this](const auto& A) { return Eigen::MatrixXd(Z.transpose() * (A * Z)); };
    K = within(motions.stiffness_matrix());
    C = within(motions.rate_matrix());
    M = within(motions.mass_matrix());
  }

  // x'' = -M^-1 (C x' + K x), with K and C as they are or changed.
  MatXc generator(const MatXc& K_changed) const {
    const Index n = M.rows();
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(M);
    const Eigen::MatrixXd inverse = lu.inverse();
    MatXc A = MatXc::Zero(2 * n, 2 * n);
    A.topRightCorner(n, n).setIdentity();
    A.bottomLeftCorner(n, n) = -(inverse * K_changed);
    A.bottomRightCorner(n, n) = -(inverse * C);
    return A;
  }

  double norm(const VecXc& x) const { return std::sqrt(x.dot(M * x).real()); }
};

// Of the eigenvalue nearest to l: it, and its vector of A.
std::pair<Complex, VecXc> nearest(const MatXc& A, Complex l) {
  const Eigen::ComplexEigenSolver<MatXc> solver(A);
  Index at = 0;
  (solver.eigenvalues().array() - l).abs().minCoeff(&at);
  return {solver.eigenvalues()(at), solver.eigenvectors().col(at)};
}

// y of the same formula from the dense transposed matrices; and the change of l by the worst change of K of its size.
void expect_dense(SmallMotions& motions, int count, double tolerance) {
  const std::vector<Mode> modes = modes_of(motions, count);
  const Dense dense(motions);
  const Index n = dense.M.rows();
  const MatXc A = dense.generator(dense.K), A_left = [&] {
    Dense turned = dense;  // of Q^T
    turned.C.transposeInPlace();
    return turned.generator(dense.K.transpose());
  }();
  ASSERT_GE(modes.size(), static_cast<std::size_t>(count));
  for (const Mode& mode : modes) {
    const auto [l, right] = nearest(A, mode.eigenvalue);
    EXPECT_LT(std::abs(l - mode.eigenvalue), tolerance * std::abs(l));
    const VecXc x = right.head(n), y = nearest(A_left, mode.eigenvalue).second.head(n);
    const Complex slope = (y.transpose() * ((2.0 * l * dense.M + dense.C) * x)).value();
    const double kappa = 2.0 * std::abs(l) * dense.norm(x) * dense.norm(y) / std::abs(slope);
    EXPECT_NEAR(mode.condition, kappa, tolerance * kappa) << l;
    // y^T dK x is the largest there is of its size.
    constexpr double e = 1e-6;
    const VecXc Mx = dense.M * x, My = dense.M * y.conjugate();
    const MatXc change = e * std::norm(l) / (dense.norm(x) * dense.norm(y)) * (My * Mx.adjoint());
    const Complex moved = nearest(dense.generator(dense.K + change), mode.eigenvalue).first;
    EXPECT_NEAR(std::abs(moved - l), 0.5 * e * mode.condition * std::abs(l),
                0.02 * e * mode.condition * std::abs(l));
  }
}

// Beck's column, without damping but circulatory, up to its flutter: there two eigenvalues become one, and
// the condition grows as the root of what is left to it.
std::string beck(double load, const std::string& damping = "") {
  return fmt::format(R"(
    <section name="s"><stiffness EA="1e5" GA2="1e5" GA3="1e5" GJ="10" EI2="1" EI3="3"/>
      <mass per_length="1" inertia="2e-4 1e-4 1e-4"/>{}</section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="4"/>
    <fixed name="F" between="ground b.start"/>
    <load name="f" at="b.end" follower_force="{} 0 0"/><static/>)",
                     damping, -load);
}

struct Motions {
  Model model;
  SmallMotions motions;
  explicit Motions(const std::string& text)
      : model([&text] {
          Scene scene = read(text);
          scene.transient.emplace();
          scene.transient->duration = 1.0;
          scene.transient->step = 0.1;
          return compile(scene);
        }()),
        motions(*model.system) {
    motions.about(model.initial);
  }
};

TEST(Conditions, OfBecksColumn) {
  for (const double load : {5.0, 15.0, 19.0}) {
    Motions of(beck(load));
    expect_dense(of.motions, 5, 1e-6);
    EXPECT_GT(modes_of(of.motions, 1)[0].condition, load > 10.0 ? 1.1 : 1.0);
  }
  Motions at_rest(beck(0.0));
  for (const Mode& mode : modes_of(at_rest.motions, 5)) EXPECT_EQ(mode.condition, 1.0);
}

TEST(Conditions, GrowAsTheRootUpToFlutter) {
  const auto first_two = [](double load) {
    Motions of(beck(load));
    return modes_of(of.motions, 2);
  };
  double low = 19.0, high = 21.0;  // of its flutter
  for (int k = 0; k < 40; ++k) {
    const double mid = 0.5 * (low + high);
    (first_two(mid)[0].eigenvalue.real() < 1e-6 && first_two(mid)[1].eigenvalue.real() < 1e-6
         ? low
         : high) = mid;
  }
  const auto scaled = [&](double share) {
    return first_two(low * (1.0 - share))[0].condition * std::sqrt(share);
  };
  EXPECT_NEAR(scaled(1e-4), scaled(1e-3), 0.01 * scaled(1e-4));
}

// Damped in part and out of proportion, turning: complex vectors, none of them the other's conjugate.
TEST(Conditions, OfWhatIsDampedAndTurns) {
  Motions damped(
      beck(12.0, R"(<damping stiffness_proportional="1e-3"/>)") +
      R"(<bushing name="d" between="ground b@0.5" stiffness="0 0 0 0 0 0" damping="0 0.2 3 0 0 0"/>)");
  expect_dense(damped.motions, 6, 1e-6);

  Motions turning(R"(
    <body name="r" mass="3" inertia="0.4 0.25 0.22" center="0.1 0 0"/>
    <bushing name="s" between="ground r" stiffness="900 500 700 40 60 30" damping="0 2 1 0 0 0.3"/>)");
  State state = turning.model.initial;
  state.V[1] << 0.0, 0.0, 0.0, 30.0, 0.0, 0.0;
  turning.motions.about(state);
  expect_dense(turning.motions, 4, 1e-8);
}

}  // namespace
}  // namespace mbd::test::test_conditions
