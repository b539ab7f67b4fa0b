// Laws of joints, tried on every type: gradient, wrench, geometric stiffness, rates, objectivity, and what
// each leaves free.
#include <gtest/gtest.h>

#include <numbers>

#include "elements/element_batch.hpp"
#include "elements/node/gravity.hpp"
#include "joints/any_joint_batch.hpp"
#include "joints/joint_list.hpp"
#include "libmbd/core/expression.hpp"
#include "tests/elements/laws.hpp"
#include "tests/support/dense.hpp"

namespace {

using namespace mbd;
using namespace mbd::laws;

constexpr double pi = std::numbers::pi;

// A relative pose at random, its angle about e3 well defined (a3 well off b1) for any type.
Pose<double> random_relative(Rng& rng) {
  Pose<double> g;
  do g = test::random_pose(rng);
  while (std::abs(g.R()(2, 0)) > 0.4);
  return g;
}

double random_parameter(const joint::Traits& traits, Rng& rng) {
  if (traits.points == joint::Points::two) return test::uniform(rng, 0.5, 2);
  return traits.parameter.name[0] != '\0' ? test::uniform(rng, -2, 2) : 0.0;
}

// Two nodes, or the ground and a node, and one joint of a type between random frames.
struct Pair {
  Pose<double> a, b;
  int P, Q;
  System system;
  const joint::AnyJointBatch* joint = nullptr;
  joint::Traits traits;
  Index m = 0;
  double parameter = 0.0;
  test::DenseSolver dense;

  Pair(const std::string& type, Rng& rng, bool on_ground = false)
      : a(test::random_pose(rng)),
        b(test::random_pose(rng)),
        P(on_ground ? 0 : 1),
        Q(on_ground ? 1 : 2) {
    auto batch = joint::make_joint_batch(type);
    joint = batch.get();
    traits = batch->traits();
    m = static_cast<Index>(batch->rows().size());
    parameter = random_parameter(traits, rng);
    if (!on_ground) system.add_node("node P", {});
    system.add_node("node Q", {});
    joint::Definition definition{.a = a, .b = b, .P = P, .Q = Q, .parameter = parameter};
    const char* const laws[] = {"0.7*t + 0.4*sin(3*t)", "t - 0.5*cos(2*t)", "0.3*t^2"};
    for (int i = 0; i < joint::signals_of(traits.law); ++i)
      definition.signals[static_cast<std::size_t>(i)] = static_cast<int>(system.add_signal(
          Signal::from_expression(Expression::parse(laws[i], {}, Variables::time))));
    ConstraintInfo info;
    info.name = type;
    info.rows = m;
    info.row_names.assign(batch->rows().size(), "row");
    info.is_position.assign(batch->rows().size(), false);
    definition.multiplier = system.add_constraint(std::move(info));
    if (traits.angle) definition.angle = system.add_angle();
    EXPECT_EQ(batch->add(definition), 0);
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
  // Moves Q by z in b.
  State moved(const State& s, const Vec6& z) const {
    State x = s;
    Pose<double>& H = x.pose[static_cast<std::size_t>(Q)];
    H = H * b * exp_se3<double>(z) * inverse(b);
    renormalize(H);
    return x;
  }
  // dg/dz of the motion of b, by differences: not the joint's own gradient.
  MatrixXd gradient(const State& s) const {
    MatrixXd G(m, 6);
    for (Index c = 0; c < 6; ++c)
      G.col(c) = test::first_difference(
          [&](double h) { return constraint_rows(moved(s, h * Vec6::Unit(c))); }, 0.03);
    return G;
  }
  // After a long walk from where the joint is assembled along what it leaves free: pieces across the
  // gradient's rows, each mended by Gauss and Newton's method. Follows angles, as accepted steps do; what
  // is prescribed moves on in time.
  State walked(Rng& rng, double duration) const {
    Pose<double> g;
    if (traits.points == joint::Points::two) g.r = parameter * test::random_direction(rng);
    State s = state(rng, g);
    system.set_time(s, 0.0);
    const auto solve = [](const MatrixXd& G, const VecX& x) {
      return Vec6(G.transpose() * test::dense::solve(G * G.transpose(), x));
    };
    for (int piece = 0; piece <= 20; ++piece) {
      if (piece > 0) {
        const MatrixXd G = gradient(s);
        const Vec6 any = test::random_vector<6>(rng, 0.8);
        s = moved(s, any - solve(G, G * any));
        system.set_time(s, duration * piece / 20);
      }
      for (int i = 0; i < 20; ++i) {
        const Vec6 z = solve(gradient(s), -constraint_rows(s));
        s = moved(s, z);
        if (z.norm() < 1e-15) break;
      }
      system.follow_angles(s);
    }
    return s;
  }

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
    system.residual(s, r);  // random poses may be on the other branch of a joint
    return r;
  }
  VecX constraint_rows(const State& s) const { return residual(s).tail(m); }
  MatrixXd tangent(const State& s, VecX& r) {
    system.linearize(s, {}, r, dense);
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

std::vector<std::string> all_types() {
  std::vector<std::string> names;
  const auto add = [&names]<class J>() { names.push_back(J::name); };
  joint::for_each(joint::Types{}, add);
  joint::for_each(joint::Prescribed{}, add);
  return names;
}

struct JointLaws : testing::TestWithParam<std::string> {
  // Any relative pose: the constraint need not hold.
  template <class F>
  static void sample(int count, const F& f) {
    Rng rng(51);
    for (int i = 0; i < count; ++i) {
      Pair pair(GetParam(), rng, i % 4 == 0);
      State s = pair.state(rng, random_relative(rng));
      if (pair.traits.angle) s.angles[0] = test::uniform(rng, -20, 20);
      pair.system.follow_angles(s);  // away from where the nearest turn changes
      f(rng, pair, s);
    }
  }
};
std::string test_name(const testing::TestParamInfo<std::string>& type) {
  std::string name = type.param;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Every, JointLaws, testing::ValuesIn(all_types()), test_name);

// The kernels themselves, by type: little here, because it is compiled for each.
template <class J>
struct JointKernels : testing::Test {};
template <class A, class B>
struct Both;
template <class... A, class... B>
struct Both<joint::List<A...>, joint::List<B...>> {
  using Types = testing::Types<A..., B...>;
};
using Types = Both<joint::Types, joint::Prescribed>::Types;
TYPED_TEST_SUITE(JointKernels, Types);

// dg = G z, f = G^T lambda, df = L z, by dual numbers.
TYPED_TEST(JointKernels, GradientWrenchAndGeometricStiffness) {
  using J = TypeParam;
  constexpr int m = joint::rows_of<J>;
  Rng rng(52);
  Worst gradient("gradient", 16 * eps), wrench("wrench", 16 * eps),
      stiffness("stiffness", 16 * eps);
  double mutated = INFINITY;
  for (int i = 0; i < 500; ++i) {
    const Pose<double> g = random_relative(rng);
    const joint::Given<double> given{test::uniform(rng, -10, 10), random_parameter(J::traits, rng),
                                     test::uniform(rng, -20, 20)};
    const joint::Given<D1> dual{D1(given.s), given.parameter, given.near};
    const auto lambda = test::random_vector<m>(rng);
    const Matrix<double, m, 6> G = joint::gradient<J, double>(g, given);
    const Vec6 f = joint::wrench<J, double>(g, given, lambda);
    const Mat6 L = joint::geometric_stiffness<J, double>(g, given, lambda);
    wrench.add((f - G.transpose() * lambda).norm());
    Mat6 dfdz;
    for (Index c = 0; c < 6; ++c) {
      const Pose<D1> moved = seeded(g, Vec6::Unit(c));
      const auto dg = joint::constraint<J, D1>(moved, dual);
      const auto df = joint::wrench<J, D1>(moved, dual, lambda.template cast<D1>());
      for (Index k = 0; k < m; ++k) gradient.add(std::abs(dg(k).d - G(k, c)));
      for (Index k = 0; k < 6; ++k) dfdz(k, c) = df(k).d;
    }
    stiffness.add((L - dfdz).cwiseAbs().maxCoeff());
    mutated = std::min(mutated, dfdz.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(mutated, 1e-4) << "without geometric stiffness";
}

// All of a joint's tangent, both nodes, by differences of order 8 with step 0.03: 1e-11.
TEST_P(JointLaws, TangentIsTheDerivative) {
  Worst K("K", 1e-11), B("B", 1e-11);
  double mutated = INFINITY;
  sample(20, [&](Rng&, Pair& pair, const State& s) {
    VecX r;
    const MatrixXd want = pair.difference(s), got = pair.tangent(s, r), error = got - want;
    const Index n = want.rows() - pair.m;
    K.add(error.topLeftCorner(n, n).cwiseAbs().maxCoeff());
    B.add(error.rightCols(pair.m).cwiseAbs().maxCoeff());
    B.add(error.bottomRows(pair.m).cwiseAbs().maxCoeff());
    State without = s;  // no multipliers, no geometric stiffness
    without.lambda.setZero();
    mutated = std::min(mutated,
                       (pair.tangent(without, r) - want).topLeftCorner(n, n).cwiseAbs().maxCoeff());
  });
  EXPECT_GT(mutated, 1e-4) << "the comparison would not miss the geometric stiffness";
}

// Weights reach the dynamic rows of the nodes, not the constraints.
TEST_P(JointLaws, WeightsAreThoseOfTheDynamicRows) {
  sample(5, [&](Rng&, Pair& pair, const State& s) {
    VecX r;
    const MatrixXd plain = pair.tangent(s, r);
    TangentWeights w;
    w.U = 0.25;
    w.V = 3;
    w.A = 5;
    pair.system.linearize(s, w, r, pair.dense);
    MatrixXd want = plain;
    want.topLeftCorner(want.rows() - pair.m, want.rows() - pair.m) *= 0.25;
    EXPECT_LT((pair.dense.matrix() - want).cwiseAbs().maxCoeff(), 1e-15);
  });
}

TEST_P(JointLaws, ResidualIsTheSameWithAndWithoutTangent) {
  sample(20, [](Rng&, Pair& pair, const State& s) {
    VecX with;
    pair.tangent(s, with);
    EXPECT_TRUE((with.array() == pair.residual(s).array()).all());
  });
}

// The wrenches on both nodes, the ground's among them, are in equilibrium; their power is lambda.(B V).
TEST_P(JointLaws, ForcesAreSelfEquilibratedAndDoTheWorkOfTheMultipliers) {
  Worst balance("balance", 32 * eps), power("power", 64 * eps);
  double mutated = 0;
  sample(50, [&](Rng&, Pair& pair, const State& s) {
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
TEST_P(JointLaws, ConstraintRates) {
  Worst first("first", 1e-11), second("second", 1e-9);
  double mutated = 0;
  sample(20, [&](Rng&, Pair& pair, const State& s) {
    const auto g = [&](double tau) { return pair.constraint_rows(pair.along(s, tau)); };
    VecX gdot, rest, r;
    pair.system.constraint_rates(s, gdot, rest);
    first.add((test::first_difference(g, 0.01) - gdot).cwiseAbs().maxCoeff());
    const MatrixXd B = pair.tangent(s, r).bottomRows(pair.m);
    VecX Vdot(B.cols() - pair.m);
    for (Index n = 0; n < Vdot.size() / 6; ++n)
      Vdot.segment<6>(6 * n) = s.Vdot[static_cast<std::size_t>(n + 1)];
    const VecX gddot = B.leftCols(Vdot.size()) * Vdot + rest;
    const VecX difference = test::second_difference(g, 0.0125);
    second.add((difference - gddot).cwiseAbs().maxCoeff());
    mutated = std::max(mutated, (difference - gddot + rest).cwiseAbs().maxCoeff());
  });
  EXPECT_GT(mutated, 1e-2) << "the rest may be forgotten unnoticed";
}

TEST_P(JointLaws, Objectivity) {
  Worst worst("error", 16);
  Rng rng(53);
  for (int i = 0; i < 50; ++i) {
    Pair pair(GetParam(), rng);
    State s = pair.state(rng, random_relative(rng));
    const VecX r = pair.residual(s);
    const double distance = test::log_uniform(rng, 1, 1e6);
    const Pose<double> G = test::random_pose(rng, distance);
    for (std::size_t n = 1; n < s.pose.size(); ++n) s.pose[n] = G * s.pose[n];
    worst.add((pair.residual(s) - r).cwiseAbs().maxCoeff() / (eps * (1 + distance)));
  }
}

// What a joint leaves free does not show in g, and nothing else is free: the rows are independent there,
// and as many as there are. An angle keeps to its turn all along, which a screw would show.
TEST_P(JointLaws, FreeMotionsKeepTheConstraint) {
  Rng rng(54);
  Worst worst("error", 64 * eps);
  double smallest = INFINITY, mutated = INFINITY, farthest = 0;
  bool has_angle = false;
  for (int i = 0; i < 50; ++i) {
    Pair pair(GetParam(), rng, i % 4 == 0);
    State s = pair.walked(rng, test::uniform(rng, 0, 20));
    double size = 1;
    for (const Pose<double>& H : s.pose) size += H.r.norm();
    for (const SignalValue& signal : s.signals) size += std::abs(signal.f);
    worst.add(pair.constraint_rows(s).cwiseAbs().maxCoeff() / size);
    has_angle = pair.traits.angle;
    if (has_angle) farthest = std::max(farthest, std::abs(pair.joint->angle(s, 0)));
    VecX r;
    const MatrixXd B = pair.tangent(s, r).bottomRows(pair.m);
    const MatrixXd G =
        B.middleCols(6 * (pair.Q - 1), 6) * adjoint_inverse(inverse(pair.b)).matrix();
    smallest = std::min(smallest, test::dense::singular_values(G)(pair.m - 1));
    // a motion across each row is seen
    const Vec6 across =
        G.transpose() * test::dense::inverse(G * G.transpose()) * VecX::Constant(pair.m, 1e-3);
    mutated = std::min(mutated, pair.constraint_rows(pair.moved(s, across)).cwiseAbs().minCoeff());
  }
  EXPECT_GT(smallest, 0.1);
  EXPECT_GT(mutated, 5e-4);
  if (has_angle) {
    EXPECT_GT(farthest, pi) << "no walk has passed half a turn";
  }
}

// The power of what is prescribed is that of the multipliers against the law's own motion, by differences
// in time; zero for any other joint. 10 % more of it is seen.
TEST_P(JointLaws, DrivePower) {
  Worst worst("error", 1e-11);
  double mutated = INFINITY;
  sample(20, [&](Rng&, Pair& pair, const State& s) {
    const auto g = [&](double tau) {
      State later = s;
      pair.system.set_time(later, s.t + tau);
      return pair.constraint_rows(later);
    };
    const double power = s.lambda.dot(test::first_difference(g, 0.01));
    worst.add(std::abs(pair.system.power(s).drives - power));
    mutated = std::min(mutated, std::abs(0.1 * power));
  });
  if (joint::make_joint_batch(GetParam())->traits().law != joint::Law::none)
    EXPECT_GT(mutated, 1e-6);
  else
    EXPECT_EQ(mutated, 0.0);
}

// Twist of b relative to a, and the wrench on b: against the motion of g and the residual.
TEST_P(JointLaws, RelativeVelocityAndReaction) {
  Worst velocity("velocity", 1e-11), reaction("reaction", 32 * eps);
  sample(20, [&](Rng&, Pair& pair, const State& s) {
    const auto p = static_cast<std::size_t>(pair.P), q = static_cast<std::size_t>(pair.Q);
    const auto g = [&](const State& x) { return relative(x.pose[p] * pair.a, x.pose[q] * pair.b); };
    const auto moved = [&](double tau) {  // log of g(0)^-1 g(tau)
      return log_se3(inverse(g(s)) * g(pair.along(s, tau)));
    };
    velocity.add(
        (test::first_difference(moved, 0.01) - pair.joint->relative_velocity(s, 0)).norm());
    // residual of Q is minus the wrench on it
    const Vec6 on_b = pair.joint->reaction(s, 0);
    const Vec6 r = pair.residual(s).segment<6>(6 * pair.Q);
    reaction.add((r + adjoint_inverse(pair.b).transpose_times(on_b)).norm());
  });
}

// --- signs, turns ---

// A weight hung from the ground by any joint that holds it: lambda is what the body exerts on the ground.
TEST(JointSigns, MultipliersOfAHangingWeight) {
  for (const char* name : {"fixed", "rigid_link", "revolute", "universal", "spherical"}) {
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
    batch->add({.a = H, .Q = node, .multiplier = first});
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
struct JointTurns : testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Turning, JointTurns,
                         testing::Values("revolute", "cylindrical", "planar", "screw"), test_name);

TEST_P(JointTurns, AnglesAreUnwrapped) {
  Rng rng(56);
  Pair pair(GetParam(), rng);
  const double advance = GetParam() == "screw" ? pair.parameter / (2 * pi) : 0.0;
  double theta = 0.3;
  const auto at = [&](double angle) {
    Rng same(57);
    return pair.state(same, {test::rotation(angle, Vec3::UnitZ()), {0, 0, advance * angle}});
  };
  State s = at(theta);
  EXPECT_NEAR(pair.joint->angle(s, 0), theta, 1e-14);
  pair.system.follow_angles(s);
  double most = 0, least = 0;
  const auto step_to = [&](double angle) {
    State next = at(angle);
    if (test::uniform(rng, 0, 1) < 0.5) next.pose[1].p.coeffs() *= -1.0;
    next.angles = s.angles;
    EXPECT_LT(pair.constraint_rows(next).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_NEAR(pair.joint->angle(next, 0), angle, 1e-12)
        << "from " << theta << ", not yet accepted";
    pair.system.follow_angles(next);
    EXPECT_NEAR(pair.joint->angle(next, 0), angle, 1e-12) << "from " << theta;
    s = next;
    theta = angle;
    most = std::max(most, s.angles[0]);
    least = std::min(least, s.angles[0]);
  };
  while (theta < 6 * 2 * pi) step_to(theta + test::uniform(rng, 0.01, 0.99 * pi));
  while (theta > -7 * 2 * pi) step_to(theta - test::uniform(rng, 0.01, 0.99 * pi));
  for (const double angle :
       {-14 * pi, -13 * pi - 0.5, -13 * pi + 1e-9, -13 * pi - 1e-9, -13 * pi + 0.5})
    step_to(angle);
  for (int i = 0; i < 2000; ++i) step_to(theta + test::uniform(rng, -0.99, 0.99) * pi);
  EXPECT_GE(most, 6 * 2 * pi);
  EXPECT_LE(least, -6 * 2 * pi);

  // counted from where it is, twice the same
  State again = s;
  pair.system.follow_angles(again);
  EXPECT_EQ(again.angles, s.angles);
}

TEST(JointTypes, UnknownNamesMakeNothing) {
  EXPECT_EQ(joint::make_joint_batch("hinge"), nullptr);
  EXPECT_NE(joint::make_joint_batch("driven rotation"), nullptr);
}

}  // namespace
