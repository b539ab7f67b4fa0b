// Conditions of eigenvalues: closed forms, left eigenvectors of dense matrices, and what a change of the matrices does.
// Errors are relative. Seen to fail: where y is taken for the conjugate of x, where C is left out of the slope, where Q is solved
// and not its transpose.
#include "solvers/modes/condition.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "libmbd/study/modes/modes.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_conditions {
namespace {

using Complex = std::complex<double>;
using MatXc = Eigen::MatrixXcd;

std::vector<Mode> modes_of(SmallMotions& motions, int count) {
  const ModesFound found = find_modes(motions, {.count = count, .conditions = true});
  EXPECT_EQ(found.failure, "");
  return found.modes;
}

// 2 kg on a spring and a damper, 5 rad/s without the latter.
std::vector<Mode> of_oscillator(double zeta) {
  MotionsOfScene of(read(fmt::format(R"(
    <body name="b" mass="2" inertia="1 1 1"/><prismatic name="p" between="ground b" axis="1 0 0"/>
    <bushing name="s" between="ground b" stiffness="50 0 0" damping="{} 0 0"/>)",
                                     20.0 * zeta)));
  return modes_of(of.motions(), zeta > 1.0 ? 2 : 1);
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

  // Of [x; x']: the inverse of what gives its rate, by which what is slow is known best. K as it is, or changed.
  MatXc inverse_generator(const MatXc& K_changed) const {
    const Index n = M.rows();
    MatXc A = MatXc::Zero(2 * n, 2 * n);
    A.topLeftCorner(n, n) = -dense::solve_columns(K_changed, MatXc(C));
    A.topRightCorner(n, n) = -dense::solve_columns(K_changed, MatXc(M));
    A.bottomLeftCorner(n, n).setIdentity();
    return A;
  }

  double norm(const VecXc& x) const { return std::sqrt(x.dot(M * x).real()); }
};

struct Pairs {
  VecXc values;
  MatXc vectors;
  explicit Pairs(const MatXc& inverse) {
    dense::EigenPairs of_inverse = dense::eigenpairs(inverse);
    values = of_inverse.values.cwiseInverse();
    vectors = std::move(of_inverse.vectors);
  }
  Index nearest(Complex l) const {
    Index at = 0;
    (values.array() - l).abs().minCoeff(&at);
    return at;
  }
};

// y of the same formula from the dense transposed matrices; and the change of l by the worst change of K of its size.
void expect_dense(SmallMotions& motions, int count) {
  const std::vector<Mode> modes = modes_of(motions, count);
  const Dense dense(motions);
  Dense turned = dense;  // of Q^T
  turned.C.transposeInPlace();
  const Index n = dense.M.rows();
  const Pairs of_Q(dense.inverse_generator(dense.K)),
      of_transposed(turned.inverse_generator(dense.K.transpose()));
  ASSERT_GE(modes.size(), static_cast<std::size_t>(count));
  for (const Mode& mode : modes) {
    const Index right = of_Q.nearest(mode.eigenvalue),
                left = of_transposed.nearest(mode.eigenvalue);
    const Complex l = of_Q.values(right);
    EXPECT_LT(std::abs(l - mode.eigenvalue), 1e-8 * std::abs(l));
    const VecXc x = of_Q.vectors.col(right).head(n), y = of_transposed.vectors.col(left).head(n);
    const Complex slope = (y.transpose() * ((2.0 * l * dense.M + dense.C) * x)).value();
    const double kappa = 2.0 * std::abs(l) * dense.norm(x) * dense.norm(y) / std::abs(slope);
    EXPECT_NEAR(mode.condition, kappa, 1e-7 * kappa * kappa) << l;
    // y^T dK x is the largest there is of its size.
    constexpr double e = 1e-4;
    const VecXc Mx = dense.M * x, My = dense.M * y.conjugate();
    const MatXc change = e * std::norm(l) / (dense.norm(x) * dense.norm(y)) * (My * Mx.adjoint());
    const Pairs changed(dense.inverse_generator(dense.K + change));
    const double moved = std::abs(changed.values(changed.nearest(mode.eigenvalue)) - l);
    EXPECT_NEAR(moved, 0.5 * e * kappa * std::abs(l), 0.01 * e * kappa * std::abs(l)) << l;
  }
}

// Beck's column, without damping but circulatory, up to its flutter: there two eigenvalues become one, and
// the condition grows as the root of what is left to it.
std::string beck(double load, const std::string& damping = "") {
  return fmt::format(R"(
    <section name="s"><stiffness EA="1e5" GA2="1e5" GA3="1e5" GJ="10" EI2="1" EI3="3"/>
      <mass per_length="1" inertia="2e-4 1e-4 1e-4"/>{}</section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
    <fixed name="F" between="ground b.start"/>
    <load name="f" at="b.end" follower_force="{} 0 0"/><static/>)",
                     damping, -load);
}

double largest(SmallMotions& motions) {
  double most = 0.0;
  for (const Mode& mode : modes_of(motions, 4)) most = std::max(most, mode.condition);
  return most;
}

TEST(Conditions, OfBecksColumn) {
  for (const double load : {5.0, 15.0, 19.0}) {
    MotionsOfScene of(read(beck(load)));
    expect_dense(of.motions(), 3);
    EXPECT_GT(largest(of.motions()), load > 18.0 ? 2.0 : 1.01);
  }
  MotionsOfScene at_rest(read(beck(0.0)));
  for (const Mode& mode : modes_of(at_rest.motions(), 5)) EXPECT_EQ(mode.condition, 1.0);
}

TEST(Conditions, GrowAsTheRootUpToFlutter) {
  const auto flutters = [](double load) {
    MotionsOfScene of(read(beck(load)));
    return std::ranges::any_of(modes_of(of.motions(), 4),
                               [](const Mode& mode) { return mode.eigenvalue.real() > 1e-5; });
  };
  double low = 19.0, high = 21.0;
  for (int k = 0; k < 40; ++k) {
    const double mid = 0.5 * (low + high);
    (flutters(mid) ? high : low) = mid;
  }
  const auto scaled = [&](double share) {
    MotionsOfScene of(read(beck(low * (1.0 - share))));
    return largest(of.motions()) * std::sqrt(share);
  };
  EXPECT_NEAR(scaled(1e-4), scaled(1e-3), 0.01 * scaled(1e-4));
}

// Damped in part and out of proportion, turning: complex vectors, none of them the other's conjugate.
TEST(Conditions, OfWhatIsDampedAndTurns) {
  MotionsOfScene damped(read(beck(12.0, R"(<damping stiffness_proportional="1e-3"/>)") +
                             R"(<bushing name="d" between="ground b@0.5" damping="0 0.2 3"/>)"));
  expect_dense(damped.motions(), 4);

  MotionsOfScene turning(read(R"(
    <body name="r" mass="3" inertia="0.4 0.25 0.22" center="0.1 0 0"/>
    <bushing name="s" between="ground r">
      <matrix of="stiffness">900 0 0 0 0 0  0 500 0 0 0 60  0 0 700 0 -50 0
        0 0 0 40 0 0  0 0 -50 0 60 0  0 60 0 0 0 30</matrix>
      <matrix of="damping">0 0 0 0 0 0  0 2 0 0 0 0  0 0 1 0 0 0  0 0 0 0 0 0  0 0 0 0 0 0  0 0 0 0 0 0.3</matrix>
    </bushing>)"));
  State state = turning.state();
  state.V[1] << 0.0, 0.0, 0.0, 30.0, 0.0, 0.0;
  turning.motions().about(state);
  expect_dense(turning.motions(), 4);
}

// Damped out of proportion, but symmetric; of a round beam each eigenvalue twice, with any two shapes: as of one that is
// nearly round.
TEST(Conditions, OfARoundBeam) {
  const auto beam = [](double EI3) {
    return read(fmt::format(R"(
      <section name="s"><stiffness EA="1e5" GA2="1e5" GA3="1e5" GJ="10" EI2="1" EI3="{}"/>
        <mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
      <fixed name="F" between="ground b.start"/>
      <bushing name="d" between="ground b@0.5"><matrix of="damping">0 0 0 0 0 0  0 9 0 0 0 0  0 0 9 0 0 0
        0 0 0 0 0 0  0 0 0 0 0 0  0 0 0 0 0 0</matrix></bushing><static/>)",
                            EI3));
  };
  MotionsOfScene nearly(beam(1.001)), round(beam(1.0));
  expect_dense(nearly.motions(), 5);
  const auto some = modes_of(nearly.motions(), 7), twice = modes_of(round.motions(), 7);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(twice[k].condition, some[k].condition, 2e-3 * some[k].condition) << k;
  EXPECT_GT(some[2].condition, 1.001);
}

}  // namespace
}  // namespace mbd::test::test_conditions
