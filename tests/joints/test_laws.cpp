// Laws of joints, tried on every type: gradient, wrench, geometric stiffness, rates, objectivity, and what
// each leaves free.
#include <gtest/gtest.h>

#include <numbers>

#include "elements/element_batch.hpp"
#include "elements/gravity.hpp"
#include "joints/any_joint_batch.hpp"
#include "joints/joint_list.hpp"
#include "libmbd/core/expression.hpp"
#include "tests/elements/laws.hpp"

namespace {

using namespace mbd;
using namespace mbd::laws;

constexpr double pi = std::numbers::pi;

// H_a^-1 H_b on the constraint: each type's free motion, phi the driven angle.
Pose<double> free_motion(std::string_view joint, Rng& rng, double phi) {
  Pose<double> g;
  if (joint == "revolute" || joint == "cylindrical")
    g.p = test::rotation(test::uniform(rng, -1, 1) < 0 ? pi : test::uniform(rng, -20, 20),
                         Vec3::UnitZ());
  if (joint == "cylindrical") g.r(2) = test::uniform(rng, -5, 5);
  if (joint == "spherical") g.p = test::random_pose(rng).p;
  if (joint == "driven rotation") {  // moves along and about the driven axis b1 too
    g.p = test::rotation(phi, Vec3::UnitZ()) *
          test::rotation(test::uniform(rng, -4, 4), Vec3::UnitX());
    g.r = test::random_vector<3>(rng, 5);
  }
  return g;
}

// Two nodes, or the ground and a node, and one joint between random frames.
template <class J>
struct Pair {
  static constexpr int m = static_cast<int>(J::rows.size());
  static constexpr bool driven = std::is_same_v<J, joint::DrivenRotation>;
  Pose<double> a, b;
  int P, Q;
  System system;
  const joint::AnyJointBatch* joint = nullptr;
  test::DenseSolver dense;

  explicit Pair(Rng& rng, bool on_ground = false)
      : a(test::random_pose(rng)),
        b(test::random_pose(rng)),
        P(on_ground ? 0 : 1),
        Q(on_ground ? 1 : 2) {
    if (!on_ground) system.add_node("node P", {});
    system.add_node("node Q", {});
    Index signal = -1;
    if (driven)
      signal = system.add_signal(
          Signal::from_expression(Expression::parse("0.7*t + 0.4*sin(3*t)", {}, Variables::time)));
    ConstraintInfo info;
    info.name = J::name;
    info.rows = m;
    info.row_names.assign(m, "row");
    info.is_position.assign(m, false);
    const Index multiplier = system.add_constraint(std::move(info));
    auto batch = joint::make_joint_batch(J::name);
    EXPECT_EQ(batch->rows().size(), J::rows.size());
    EXPECT_EQ(batch->add(a, b, P, Q, static_cast<int>(signal), 0, multiplier,
                         J::has_angle ? system.add_angle() : -1),
              0);
    joint = batch.get();
    system.add_batch(std::move(batch));
    system.finish(true, 1.0);
    dense.analyze(system.graph());
  }

  // With H_a^-1 H_b = g.
  State state(Rng& rng, const Pose<double>& g) const {
    State s = system.reference_state();
    const auto p = static_cast<std::size_t>(P), q = static_cast<std::size_t>(Q);
    if (P != 0) s.pose[p] = test::random_pose(rng);
    s.pose[q] = s.pose[p] * a * g * inverse(b);
    for (std::size_t n = 1; n < s.pose.size(); ++n) {
      s.V[n] = test::random_vector<6>(rng);
      s.Vdot[n] = test::random_vector<6>(rng);
    }
    s.lambda = VecX::NullaryExpr(m, [&] { return test::uniform(rng, -1, 1); });
    system.set_time(s, test::uniform(rng, 0, 3));
    return s;
  }
  double phi(const State& s) const { return driven ? s.signals[0].f : 0.0; }

  // H exp(tau V + tau^2/2 Vdot): V and Vdot at tau = 0.
  State along(const State& s, double tau) const {
    State moved = s;
    for (std::size_t n = 1; n < s.pose.size(); ++n)
      moved.pose[n] = s.pose[n] * exp_se3<double>(tau * s.V[n] + 0.5 * tau * tau * s.Vdot[n]);
    system.set_time(moved, s.t + tau);
    return moved;
  }
  VecX residual(const State& s) const {
    VecX r;
    EXPECT_TRUE(system.residual(s, r));
    return r;
  }
  VecX constraint_rows(const State& s) const { return residual(s).tail(m); }
  MatrixXd tangent(const State& s, VecX& r) {
    EXPECT_TRUE(system.linearize(s, {}, r, dense));
    return dense.matrix();
  }
  // d residual / d(poses, multipliers), ground left out, by differences of order 8
  MatrixXd difference(const State& s) const {
    const Index n = system.unknowns(), first = 6;
    MatrixXd K(n, n);
    for (Index c = 0; c < n; ++c) {
      K.col(c) = test::first_difference(
          [&](double h) {
            State moved = s;
            if (c < n - m) {
              auto& H = moved.pose[static_cast<std::size_t>(1 + c / 6)];
              H = H * exp_se3<double>(h * Vec6::Unit(c % 6));
            } else {
              moved.lambda(c - (n - m)) += h;
            }
            return VecX(residual(moved).tail(system.rows() - first));
          },
          0.03);
    }
    return K;
  }
};

template <class J>
struct JointLaws : testing::Test {
  // Any relative pose: the constraint need not hold.
  template <class F>
  static void sample(int count, const F& f) {
    Rng rng(51);
    for (int i = 0; i < count; ++i) {
      Pair<J> pair(rng, i % 4 == 0);
      const State s = pair.state(rng, test::random_pose(rng));
      f(rng, pair, s);
    }
  }
};
template <class List>
struct WithDrive;
template <class... J>
struct WithDrive<joint::List<J...>> {
  using Types = testing::Types<J..., joint::DrivenRotation>;
};
using Types = WithDrive<joint::Types>::Types;
TYPED_TEST_SUITE(JointLaws, Types);

// dg = G z, f = G^T lambda, df = L z, by dual numbers.
TYPED_TEST(JointLaws, GradientWrenchAndGeometricStiffness) {
  using J = TypeParam;
  constexpr int m = Pair<J>::m;
  Rng rng(52);
  Worst gradient("gradient", 16 * eps), wrench("wrench", 16 * eps),
      stiffness("stiffness", 16 * eps);
  double mutated = INFINITY;
  for (int i = 0; i < 500; ++i) {
    const Pose<double> g = test::random_pose(rng);
    const double phi = test::uniform(rng, -10, 10);
    const auto lambda = test::random_vector<m>(rng);
    const Matrix<double, m, 6> G = joint::gradient<J, double>(g, phi);
    const Vec6 f = joint::wrench<J, double>(g, phi, lambda);
    const Mat6 L = joint::geometric_stiffness<J, double>(g, phi, lambda);
    wrench.add((f - G.transpose() * lambda).norm());
    Mat6 dfdz;
    for (Index c = 0; c < 6; ++c) {
      const Pose<D1> moved = seeded(g, Vec6::Unit(c));
      const auto dg = joint::constraint<J, D1>(moved, D1(phi));
      const auto df = joint::wrench<J, D1>(moved, D1(phi), lambda.template cast<D1>());
      for (Index k = 0; k < m; ++k) gradient.add(std::abs(dg(k).d - G(k, c)));
      for (Index k = 0; k < 6; ++k) dfdz(k, c) = df(k).d;
    }
    stiffness.add((L - dfdz).cwiseAbs().maxCoeff());
    mutated = std::min(mutated, dfdz.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(mutated, 1e-4) << "without geometric stiffness";
}

// All of a joint's tangent, both nodes, by differences of order 8 with step 0.03: 1e-11.
TYPED_TEST(JointLaws, TangentIsTheDerivative) {
  constexpr int m = Pair<TypeParam>::m;
  Worst K("K", 1e-11), B("B", 1e-11);
  double mutated = INFINITY;
  this->sample(20, [&](Rng&, auto& pair, const State& s) {
    VecX r;
    const MatrixXd want = pair.difference(s), got = pair.tangent(s, r), error = got - want;
    const Index n = want.rows() - m;
    K.add(error.topLeftCorner(n, n).cwiseAbs().maxCoeff());
    B.add(error.rightCols(m).cwiseAbs().maxCoeff());
    B.add(error.bottomRows(m).cwiseAbs().maxCoeff());
    State without = s;  // no multipliers, no geometric stiffness
    without.lambda.setZero();
    mutated = std::min(mutated,
                       (pair.tangent(without, r) - want).topLeftCorner(n, n).cwiseAbs().maxCoeff());
  });
  EXPECT_GT(mutated, 1e-4) << "the comparison would not miss the geometric stiffness";
}

// Weights reach the dynamic rows of the nodes, not the constraints.
TYPED_TEST(JointLaws, WeightsAreThoseOfTheDynamicRows) {
  constexpr int m = Pair<TypeParam>::m;
  this->sample(5, [&](Rng&, auto& pair, const State& s) {
    VecX r;
    const MatrixXd plain = pair.tangent(s, r);
    TangentWeights w;
    w.U = 0.25;
    w.V = 3;
    w.A = 5;
    pair.system.linearize(s, w, r, pair.dense);
    MatrixXd want = plain;
    want.topLeftCorner(want.rows() - m, want.rows() - m) *= 0.25;
    EXPECT_LT((pair.dense.matrix() - want).cwiseAbs().maxCoeff(), 1e-15);
  });
}

TYPED_TEST(JointLaws, ResidualIsTheSameWithAndWithoutTangent) {
  this->sample(20, [](Rng&, auto& pair, const State& s) {
    VecX with;
    pair.tangent(s, with);
    EXPECT_TRUE((with.array() == pair.residual(s).array()).all());
  });
}

// The wrenches on both nodes, the ground's among them, are in equilibrium; their power is lambda.(B V).
TYPED_TEST(JointLaws, ForcesAreSelfEquilibratedAndDoTheWorkOfTheMultipliers) {
  Worst balance("balance", 32 * eps), power("power", 64 * eps);
  double mutated = 0;
  this->sample(50, [&](Rng&, auto& pair, const State& s) {
    const VecX r = pair.residual(s);
    const VecX F = r.head(6 * pair.system.nodes());
    balance.add(resultant(F, s.pose).cwiseAbs().maxCoeff());
    double work = 0;
    for (std::size_t n = 1; n < s.pose.size(); ++n)
      work += F.segment<6>(6 * static_cast<Index>(n)).dot(s.V[n]);
    State at_rest = s;
    for (auto& V : at_rest.V) V.setZero();
    VecX gdot, g_t, rest;
    pair.system.constraint_rates(s, gdot, rest);
    pair.system.constraint_rates(at_rest, g_t, rest);
    power.add(std::abs(work - s.lambda.dot(gdot - g_t)));
    mutated = std::max(mutated, std::abs(1.1 * work - s.lambda.dot(gdot - g_t)));
  });
  EXPECT_GT(mutated, 1e-3);
}

// gdot, and gddot = B Vdot + rest, by differences of order 8 along a motion, a drive turning: 1e-11, 1e-9.
TYPED_TEST(JointLaws, ConstraintRates) {
  constexpr int m = Pair<TypeParam>::m;
  Worst first("first", 1e-11), second("second", 1e-9);
  double mutated = 0;
  this->sample(20, [&](Rng&, auto& pair, const State& s) {
    const auto g = [&](double tau) { return pair.constraint_rows(pair.along(s, tau)); };
    VecX gdot, rest, r;
    pair.system.constraint_rates(s, gdot, rest);
    first.add((test::first_difference(g, 0.01) - gdot).cwiseAbs().maxCoeff());
    const MatrixXd B = pair.tangent(s, r).bottomRows(m);
    VecX Vdot(B.cols() - m);
    for (Index n = 0; n < Vdot.size() / 6; ++n)
      Vdot.segment<6>(6 * n) = s.Vdot[static_cast<std::size_t>(n + 1)];
    const VecX gddot = B.leftCols(Vdot.size()) * Vdot + rest;
    const VecX difference = test::second_difference(g, 0.0125);
    second.add((difference - gddot).cwiseAbs().maxCoeff());
    mutated = std::max(mutated, (difference - gddot + rest).cwiseAbs().maxCoeff());
  });
  EXPECT_GT(mutated, 1e-2) << "the rest may be forgotten unnoticed";
}

TYPED_TEST(JointLaws, Objectivity) {
  Worst worst("error", 16);
  Rng rng(53);
  for (int i = 0; i < 50; ++i) {
    Pair<TypeParam> pair(rng);
    State s = pair.state(rng, test::random_pose(rng));
    const VecX r = pair.residual(s);
    const double distance = test::log_uniform(rng, 1, 1e6);
    const Pose<double> G = test::random_pose(rng, distance);
    for (std::size_t n = 1; n < s.pose.size(); ++n) s.pose[n] = G * s.pose[n];
    worst.add((pair.residual(s) - r).cwiseAbs().maxCoeff() / (eps * (1 + distance)));
  }
}

// What a joint leaves free does not show in g, and nothing else is free: the rows are independent there.
TYPED_TEST(JointLaws, FreeMotionsKeepTheConstraint) {
  constexpr int m = Pair<TypeParam>::m;
  Rng rng(54);
  Worst worst("error", 64 * eps);
  double smallest = INFINITY, mutated = INFINITY;
  for (int i = 0; i < 100; ++i) {
    Pair<TypeParam> pair(rng, i % 4 == 0);
    const double t = test::uniform(rng, 0, 30);
    State any = pair.system.reference_state();
    pair.system.set_time(any, t);
    const Pose<double> g = free_motion(TypeParam::name, rng, pair.phi(any));
    State s = pair.state(rng, g);
    pair.system.set_time(s, t);
    worst.add(pair.constraint_rows(s).cwiseAbs().maxCoeff() / (1 + g.r.norm() + pair.phi(s)));
    const MatrixXd G = joint::gradient<TypeParam, double>(g, pair.phi(s));
    smallest = std::min(smallest, G.jacobiSvd().singularValues()(m - 1));
    // a motion across each row is seen
    const Vec6 across = G.transpose() * (G * G.transpose()).inverse() * VecX::Constant(m, 1e-3);
    const VecX moved = pair.constraint_rows(pair.state(rng, g * exp_se3<double>(across)));
    if (!Pair<TypeParam>::driven) mutated = std::min(mutated, moved.cwiseAbs().minCoeff());
  }
  EXPECT_GT(smallest, 0.1);
  EXPECT_GT(mutated, 5e-4);
}

// Twist of b relative to a, and the wrench on b: against the motion of g and the residual.
TYPED_TEST(JointLaws, RelativeVelocityAndReaction) {
  Worst velocity("velocity", 1e-11), reaction("reaction", 32 * eps);
  this->sample(20, [&](Rng&, auto& pair, const State& s) {
    const auto p = static_cast<std::size_t>(pair.P), q = static_cast<std::size_t>(pair.Q);
    const auto g = [&](const State& x) { return relative(x.pose[p] * pair.a, x.pose[q] * pair.b); };
    const auto moved = [&](double tau) {  // log of g(0)^-1 g(tau)
      return log_se3(inverse(g(s)) * g(pair.along(s, tau)));
    };
    velocity.add(
        (test::first_difference(moved, 0.01) - pair.joint->relative_velocity(s, 0)).norm());
    // residual of Q is minus the wrench on it
    const Vec6 on_b = pair.joint->reaction(s, 0);
    const Vec6 r = pair.residual(s).template segment<6>(6 * pair.Q);
    reaction.add((r + adjoint_inverse(pair.b).transpose_times(on_b)).norm());
  });
}

// --- signs, turns ---

// A weight hung from the ground by any joint that holds it: lambda is what the body exerts on the ground.
TEST(JointSigns, MultipliersOfAHangingWeight) {
  for (const char* name : {"fixed", "revolute", "spherical"}) {
    Rng rng(55);
    System system;
    const Pose<double> H = test::random_pose(rng);
    const int node = static_cast<int>(system.add_node("body", H));
    auto gravity = std::make_unique<ElementBatch<NodalGravity>>(
        "gravity", NodalGravity::Shared{Vec3(0, 0, -9.81)});
    gravity->add({2.0, Vec3::Zero()}, std::array{node}, "body");
    system.add_batch(std::move(gravity));
    auto batch = joint::make_joint_batch(name);
    const auto rows = static_cast<Index>(batch->rows().size());
    const auto count = static_cast<std::size_t>(rows);
    const Index first = system.add_constraint(
        {name, 0, rows, std::vector<std::string>(count, "row"), std::vector<bool>(count, false)});
    batch->add(H, {}, 0, node, -1, 0, first, -1);
    const joint::AnyJointBatch& joint = *batch;
    system.add_batch(std::move(batch));
    system.finish(true, 1.0);
    State s = system.reference_state();
    const Vec3 weight = H.p.conjugate() * Vec3(0, 0, -19.62);
    s.lambda.head<3>() = weight;
    VecX r;
    system.residual(s, r);
    EXPECT_LT(r.tail(r.size() - 6).norm(), 1e-13) << name;
    EXPECT_LT((joint.reaction(s, 0).head<3>() + weight).norm(), 1e-13) << name;
    // the ground's row: the joint pulls at it with the weight, at the joint
    const Vec3 moment = H.r.cross(Vec3(0, 0, -19.62));
    EXPECT_LT((r.head<6>() + six<double>(Vec3(0, 0, -19.62), moment)).norm(), 1e-13) << name;
  }
}

// A free angle over several turns, forwards and backwards, past pi, in steps up to just less than half a turn.
template <class J>
struct JointTurns : testing::Test {};
using Turning = testing::Types<joint::Revolute, joint::Cylindrical>;
TYPED_TEST_SUITE(JointTurns, Turning);

TYPED_TEST(JointTurns, AnglesAreUnwrapped) {
  Rng rng(56);
  Pair<TypeParam> pair(rng);
  double theta = 0.3;
  const auto at = [&](double angle) {
    Rng same(57);
    return pair.state(same, {test::rotation(angle, Vec3::UnitZ()), Vec3::Zero()});
  };
  State s = at(theta);
  EXPECT_NEAR(pair.joint->angle(s, 0), theta, 1e-14);
  int most = 0, least = 0;
  const auto step_to = [&](double angle) {
    State next = at(angle);
    if (test::uniform(rng, 0, 1) < 0.5) next.pose[1].p.coeffs() *= -1.0;
    next.turns = s.turns;
    EXPECT_LT(pair.constraint_rows(next).cwiseAbs().maxCoeff(), 1e-14);
    pair.system.count_turns(s, next);
    EXPECT_NEAR(pair.joint->angle(next, 0), angle, 1e-12) << "from " << theta;
    s = next;
    theta = angle;
    most = std::max(most, s.turns[0]);
    least = std::min(least, s.turns[0]);
  };
  while (theta < 6 * 2 * pi) step_to(theta + test::uniform(rng, 0.01, 0.99 * pi));
  while (theta > -7 * 2 * pi) step_to(theta - test::uniform(rng, 0.01, 0.99 * pi));
  for (const double angle : {-13 * pi - 0.5, -13 * pi + 1e-9, -13 * pi - 1e-9, -13 * pi + 0.5})
    step_to(angle);
  for (int i = 0; i < 2000; ++i) step_to(theta + test::uniform(rng, -0.99, 0.99) * pi);
  EXPECT_GE(most, 6);
  EXPECT_LE(least, -6);

  // counted from where it is, twice the same
  State again = s;
  pair.system.count_turns(s, again);
  EXPECT_EQ(again.turns, s.turns);
}

TEST(JointTypes, UnknownNamesMakeNothing) {
  EXPECT_EQ(joint::make_joint_batch("hinge"), nullptr);
  EXPECT_NE(joint::make_joint_batch("driven rotation"), nullptr);
}

}  // namespace
