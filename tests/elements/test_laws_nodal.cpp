// What elements on one node are by mechanics, each against closed forms. (What holds for all: test_laws.cpp.)
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/elements/dual_tangent.hpp"
#include "tests/elements/element_cases.hpp"

namespace mbd::test::test_laws_nodal {
namespace {

using namespace mbd::laws;

// Random instances of an element at random motions.
template <class E>
struct Of {
  struct Sample {
    double length;
    Case<E> one;
    Nodes x;
  };
  template <class F>
  static void sample(const F& f) {
    Rng rng(43);
    for (int i = 0; i < 200; ++i) {
      const double length = log_uniform(rng, 1e-2, 1e2);
      Sample s{length, Case<E>(rng, length), {}};
      s.x.push_back({random_pose(rng, length), random_vector<6>(rng), random_vector<6>(rng)});
      s.x[0].V.template head<3>() *= length;
      s.x[0].Vdot.template head<3>() *= length;
      s.one.place(rng, i, s.x);
      f(rng, s);
    }
  }
  // Through the batch, as a model has it.
  static ElementBatch<E> batch(const Case<E>& c) {
    ElementBatch<E> batch(E::name, c.shared);
    batch.add(c.data, std::array{1}, "it");
    return batch;
  }
  static BatchValue value(const Case<E>& c, const Nodes& x) {
    ElementBatch<E> one = batch(c);
    const BatchValue v = linearized(one, state_of(x, c.environment()), {1.7, 0.6});
    EXPECT_TRUE(v.in_range);
    return v;
  }
  static VecX residual(const Case<E>& c, const Nodes& x) {
    VecX r = residual_of(batch(c), state_of(x, c.environment()));
    EXPECT_EQ(r.size(), 6);
    return r;
  }
};

// --- inertia and loads ---

// The momentum of a body seen from the inertial frame changes at the rate the residual says (Newton, Euler).
TEST(Inertia, ForceIsTheRateOfMomentum) {
  Worst worst("error", 64 * eps);
  double mutated = INFINITY;
  Of<Mass>::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    // H(tau) = H exp(tau V + tau^2/2 Vdot), V(tau) = V + tau Vdot, to first order at 0
    const Pose<D1> H = seeded(x.H, x.V);
    const auto wrench = [&](const Mat6& M) {
      const Vector6<D1> p = M.cast<D1>() * seeded(x.V, x.Vdot);
      const Vector6<D1> momentum = adjoint_inverse(H).transpose_times(p);
      Vec6 rate;
      for (Index i = 0; i < 6; ++i) rate(i) = momentum(i).d;
      return Vec6(adjoint(x.H).transpose_times(rate));
    };
    const Vec6 r = Of<Mass>::residual(s.one, s.x);
    const double size =
        force_size(s.one.data.M.cwiseAbs() * (x.Vdot.cwiseAbs() + x.V.cwiseAbs()), s.length) *
        (1 + angular(x.V).norm());
    worst.add(force_size(r - wrench(s.one.data.M), s.length) / size);
    Mat6 M = s.one.data.M;
    M(1, 1) *= 1.1;
    mutated = std::min(mutated, force_size(r - wrench(M), s.length) / size);
  });
  EXPECT_GT(mutated, 1e-5);
}

// dT/dt = F.V, the gyroscopic part does no work.
TEST(Inertia, PowerBalance) {
  Worst worst("error", 32 * eps);
  Of<Mass>::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Mat6& M = s.one.data.M;
    const Vec6 r = Of<Mass>::residual(s.one, s.x);
    const double size = (x.V.cwiseAbs()).dot(M.cwiseAbs() * (x.Vdot.cwiseAbs() + x.V.cwiseAbs()));
    worst.add(std::abs(r.dot(x.V) - x.V.dot(M * x.Vdot)) / size);
    EXPECT_NEAR(Mass::energies({}, s.one.data, &x, {}).kinetic / size,
                0.5 * x.V.dot(M * x.V) / size, 1e-14);
  });
}

// r.V is -power, never negative; and the drag is alpha times the momentum where P is alpha M.
TEST(MassDampingLaw, Power) {
  Worst worst("error", 16 * eps), drag("drag", 4 * eps);
  double mutated = INFINITY;
  Of<MassDamping>::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec6 r = Of<MassDamping>::residual(s.one, s.x);
    const auto power = [&x](const auto& c) {
      return MassDamping::damping_power({}, c.data, &x, c.environment());
    };
    EXPECT_LT(power(s.one), 0.0);
    const double size = x.V.cwiseAbs().dot(s.one.data.P.cwiseAbs() * x.V.cwiseAbs());
    worst.add(std::abs(r.dot(x.V) + power(s.one)) / size);
    auto mutant = s.one;
    mutant.data.P *= 1.1;
    mutated = std::min(mutated, std::abs(r.dot(x.V) + power(mutant)) / size);
    auto of_mass = s.one;
    of_mass.data.P = 0.3 * s.one.data.P;
    const Vec6 p = Mass::momentum({}, {s.one.data.P}, &x);
    const Vec6 f = Of<MassDamping>::residual(of_mass, s.x);
    drag.add(force_size(f - 0.3 * p, s.length) /
             force_size(s.one.data.P.cwiseAbs() * x.V.cwiseAbs(), s.length));
  });
  EXPECT_GT(mutated, 1e-6);
}

// Against a cloud of particles.
TEST(Inertia, MassMatrixOfARigidBody) {
  Rng rng(42);
  for (int sample = 0; sample < 20; ++sample) {
    std::vector<std::pair<double, Vec3>> particles;
    double m = 0;
    Vec3 c = Vec3::Zero();
    for (int i = 0; i < 6; ++i) {
      particles.emplace_back(uniform(rng, 0.1, 1), random_vector<3>(rng));
      m += particles.back().first;
      c += particles.back().first * particles.back().second;
    }
    c /= m;
    Mat3 J = Mat3::Zero();
    for (const auto& [mi, x] : particles) {
      const Vec3 d = x - c;
      J += mi * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
    }
    const Vec6 V = random_vector<6>(rng);
    double kinetic = 0;
    for (const auto& [mi, x] : particles)
      kinetic += 0.5 * mi * (linear(V) + angular(V).cross(x)).squaredNorm();
    const Mat6 M = rigid_mass(m, c, J);
    EXPECT_NEAR(0.5 * V.dot(M * V), kinetic, 1e-14 * kinetic);

    // seen from a frame in which the body's is at H: the same particles at H x
    const Pose<double> H = random_pose(rng);
    double seen = 0;
    for (const auto& [mi, x] : particles)
      seen += 0.5 * mi * (linear(V) + angular(V).cross(H * x)).squaredNorm();
    EXPECT_NEAR(0.5 * V.dot(transformed_mass(M, H) * V), seen, 1e-13 * seen);
  }
}

TEST(NodalGravityLaw, ForceIsTheGradientOfThePotential) {
  Worst gradient("gradient", 1e-11), skew("skew", 32 * eps);
  double mutated = INFINITY;
  Of<NodalGravity>::sample([&](Rng& rng, const auto& s) {
    const auto out = Of<NodalGravity>::value(s.one, s.x);
    Vec6 V = random_vector<6>(rng);
    V.head<3>() *= s.length;
    const auto potential = [&](double tau) {
      NodeState<double> x = s.x[0];
      x.H = x.H * exp_se3<double>(tau * V);
      const Energies e = NodalGravity::energies(s.one.shared, s.one.data, &x, s.one.environment());
      EXPECT_EQ(e.kinetic + e.strain, 0.0);
      return Matrix<double, 1, 1>(e.potential);
    };
    const double rate = first_difference(potential, 0.02)(0),
                 size = out.r.cwiseAbs().dot(V.cwiseAbs());
    gradient.add(std::abs(rate - out.r.dot(V)) / size);
    mutated = std::min(mutated, std::abs(rate - 1.1 * out.r.dot(V)) / size);
    skew.add(tangent_size(out.K - out.K.transpose() - skew_part(out.r), s.length) /
             tangent_size(out.K, s.length));
  });
  EXPECT_GT(mutated, 1e-6);
}

// A heavy particle at c weighs m g and pulls at c.
TEST(NodalGravityLaw, WeightOfABodyOnItsSide) {
  const NodalGravity::Shared shared{Vec3(0, 0, -9.81)};
  const NodalGravity::Data data{2.0, 2.0 * Vec3(0.5, 0, 0)};
  const NodeState<double> x{{rotation(std::numbers::pi / 2, Vec3::UnitX()), Vec3(1, 2, 3)}, {}, {}};
  NodalGravity::Output<double> out;
  NodalGravity::evaluate<Want::residual>(shared, data, &x, {}, {}, out);
  // inertial -e3 is body -e2: internal minus external
  EXPECT_LT((out.r - Vec6(0, 19.62, 0, 0, 0, 9.81)).norm(), 1e-14);
  EXPECT_NEAR(NodalGravity::energies(shared, data, &x, {}).potential, 2 * 9.81 * 3, 1e-13);
}

// The power of a dead load is f.v + m.w in the inertial frame, whatever the node's attitude.
TEST(PointLoadLaw, PowerOfADeadLoad) {
  Worst worst("error", 32 * eps);
  Of<PointLoad>::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec6 f = s.one.load(), r = Of<PointLoad>::residual(s.one, s.x);
    const Vec6 V = six<double>(x.H.R() * Vec3(linear(x.V)), x.H.R() * Vec3(angular(x.V)));
    worst.add(std::abs(-r.dot(x.V) - f.dot(V)) /
              (f.head<3>().norm() * V.head<3>().norm() + f.tail<3>().norm() * V.tail<3>().norm()));
  });
}

// A dead force at an offset has the potential -f.(r + R c), as gravity has: the gradient of it is the load
// and its arm together.
TEST(PointLoadLaw, ForceAtAnOffsetHasAPotential) {
  Worst gradient("gradient", 1e-11);
  double without_arm = INFINITY;
  Of<DeadForceArm>::sample([&](Rng& rng, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec3 f = linear(s.one.load()), c = s.one.data.offset;
    PointLoad::Data force{s.one.data.signals, s.one.data.weight};
    for (std::size_t i = 3; i < 6; ++i) force.signals[i] = -1;
    PointLoad::Output<double> r;
    PointLoad::evaluate<Want::residual>({}, force, &x, s.one.environment(), {}, r);
    const Vec6 arm = Of<DeadForceArm>::residual(s.one, s.x);
    Vec6 V = random_vector<6>(rng);
    V.head<3>() *= s.length;
    const auto potential = [&](double tau) {
      return Matrix<double, 1, 1>(-f.dot((x.H * exp_se3<double>(tau * V)) * c));
    };
    const double rate = first_difference(potential, 0.02)(0), size = f.norm() * s.length;
    gradient.add(std::abs(rate - (r.r + arm).dot(V)) / size);
    without_arm = std::min(without_arm, std::abs(rate - r.r.dot(V)) / size);
  });
  EXPECT_GT(without_arm, 1e-6);
}

// One element without constants in common.
template <class E>
BatchValue alone(const typename E::Data& data, const NodeState<double>& x, const Environment& env,
                 RateWeights weights = {}) {
  ElementBatch<E> one(E::name, {});
  one.add(data, std::array{1}, "it");
  return linearized(one, state_of({x}, env), weights);
}

// --- drag ---

// In still fluid it only takes.
template <class E>
void only_takes() {
  double largest = -INFINITY;
  Of<E>::sample([&](Rng&, const auto& s) {
    largest =
        std::max(largest, Of<E>::batch(s.one).damping_power(state_of(s.x, s.one.environment())));
  });
  EXPECT_LT(largest, 0.0);
}
TEST(Drag, OnlyTakesInStillFluid) {
  only_takes<LineDrag<false>>();
  only_takes<LineDrag<false, true>>();
  only_takes<PointDrag<false>>();
}

// At rest against the fluid force and derivative are zero, not nan, and near it they go there.
TEST(Drag, IsSmoothAtRest) {
  SignalValue flow[3] = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const Environment env{.t = 0, .load_factor = 1, .signals = flow};
  const Pose<double> H{rotation(1.0, Vec3(1, 2, 2) / 3), Vec3::Zero()};
  const Vec3 U = H.p.conjugate() * Vec3(1, 2, 3);
  const auto look = [&]<class E>(const typename E::Data& data, const Vec3& v0) {
    for (const double away : {0.0, 1e-300, 1e-12}) {
      NodeState<double> x{H, six<double>(v0 + away * Vec3(1, -1, 1), Vec3::Zero()), Vec6::Zero()};
      const BatchValue out = alone<E>(data, x, env, {1, 0});
      ASSERT_TRUE(out.r.allFinite() && out.D.allFinite());
      // v0 is R^T U to round-off
      EXPECT_LE(out.r.norm(), 1e-20);
      EXPECT_LE(out.D.norm(), 1e-10);
      if (away == 0.0 && v0.isZero(0.0)) {
        EXPECT_TRUE(out.r.isZero(0.0) && out.D.isZero(0.0));
      }
      const MatrixXd D =
          dual_tangent<E>({}, data, std::vector<NodeState<double>>{x}, env, true, {1, 0});
      ASSERT_TRUE(D.allFinite());
      EXPECT_LE((D - out.D).norm(), 1e-14);
    }
  };
  look.operator()<LineDrag<false>>({2.0, 3.0, {}, {}}, Vec3::Zero());
  look.operator()<PointDrag<false>>({2.0, Vec3(1, 0, 0), {}}, Vec3::Zero());
  look.operator()<LineDrag<true>>({2.0, 3.0, {{0, 1, 2}}, {}}, U);
  look.operator()<PointDrag<true>>({2.0, Vec3(1, 0, 0), {{0, 1, 2}}}, U);
}

// By hand: a beam along i2 in a flow (3, 4, 0): across it 3, along it 4; quadratic, so twice the speed is four times
// the force.
TEST(Drag, ForcesByHand) {
  for (const double k : {1.0, 2.0}) {
    SignalValue flow[2] = {{3 * k, 0, 0}, {4 * k, 0, 0}};
    const Environment env{.t = 0, .load_factor = 1, .signals = flow};
    const NodeState<double> x{
        {rotation(std::numbers::pi / 2, Vec3::UnitZ()), Vec3(5, 6, 7)}, Vec6::Zero(), Vec6::Zero()};
    BatchValue out = alone<LineDrag<true>>({2.0, 0.5, {{0, 1, -1}}, {}}, x, env);
    // b1 = i2, b2 = -i1
    Vec6 want = -k * k * (Vec6() << 0.5 * 16, -2.0 * 9, 0, 0, 0, 0).finished();
    EXPECT_LT((out.r - want).norm(), 1e-13 * k * k);
    out = alone<PointDrag<true>>({2.0, Vec3(0, 0, 0.1), {{0, 1, -1}}}, x, env);
    // 2 |5| (4, -3) in b1 b2, and its moment about the node
    want = -k * k * (Vec6() << 40, -30, 0, 3, 4, 0).finished();
    EXPECT_LT((out.r - want).norm(), 1e-13 * k * k);
  }
}

// --- base motion ---

// It is gravity of the opposite acceleration.
TEST(BaseMotionLaw, IsGravityUpsideDown) {
  Of<BaseMotion>::sample([&](Rng&, const auto& s) {
    Vec3 a = Vec3::Zero();
    for (Index i = 0; i < 3; ++i)
      if (const int place = s.one.shared.signals[static_cast<std::size_t>(i)]; place >= 0)
        a(i) = s.one.signals[static_cast<std::size_t>(place)].*(s.one.derivative());
    const auto of_base = Of<BaseMotion>::value(s.one, s.x);
    NodalGravity::Output<double> of_gravity;
    NodalGravity::evaluate<Want::tangent>(NodalGravity::Shared{-a},
                                          NodalGravity::Data{s.one.data.m, s.one.data.mc},
                                          s.x.data(), s.one.environment(), {}, of_gravity);
    EXPECT_LE((of_base.r - of_gravity.r).norm(), 16 * eps * of_gravity.r.norm());
    EXPECT_LE((of_base.K - of_gravity.K).norm(), 16 * eps * of_gravity.K.norm());
  });
}

// --- variants of inertia ---

// The variants differ by w x J w about the mass centre, for any rigid body about any point; by nothing for a sphere.
// Neither does work with it.
TEST(InertiaTermsLaw, DifferByTheGyroscopicMoment) {
  Rng rng(44);
  Worst difference("difference", 64 * eps), sphere("sphere", 64 * eps), work("work", 64 * eps);
  double mutated = INFINITY;
  for (int i = 0; i < 100; ++i) {
    const double m = uniform(rng, 0.1, 3);
    const Vec3 c = random_vector<3>(rng);
    for (const bool is_sphere : {false, true}) {
      const Mat3 J = is_sphere ? Mat3(0.7 * Mat3::Identity())
                               : Mat3(random_spd(rng, 2.0, 1.0).bottomRightCorner<3, 3>());
      const Mat6 M = rigid_mass(m, c, J);
      const NodeState<double> x{random_pose(rng), random_vector<6>(rng), random_vector<6>(rng)};
      Mass::Output<double> full;
      MassNoGyroscopic::Output<double> less;
      Mass::evaluate<Want::tangent>({}, {M}, &x, {}, {1, 1}, full);
      MassNoGyroscopic::evaluate<Want::tangent>({}, {M, central_inertia(M)}, &x, {}, {1, 1}, less);
      const Vec3 w = angular(x.V);
      const double size = full.r.norm() + (M * x.V).norm() * x.V.norm();
      const Vec6 gyroscopic = full.r - less.r;
      const Vec6 want = six<double>(Vec3::Zero(), w.cross(J * w));
      difference.add((gyroscopic - want).norm() / size);
      work.add(std::abs(gyroscopic.dot(x.V)) / size);
      if (is_sphere)
        sphere.add(gyroscopic.norm() / size);
      else
        mutated = std::min(mutated, (gyroscopic - 1.1 * want).norm() / size);
      EXPECT_EQ((full.r.head<3>() - less.r.head<3>()).norm(), 0.0);
    }
  }
  EXPECT_GT(mutated, 1e-5);
}

// A fluid's M_a is any symmetric matrix: the kernel is Kirchhoff's equations, whose moment on a body that moves
// without turning is Munk's, v x M_a v.
TEST(InertiaTermsLaw, MomentOfMunk) {
  Mat6 M = rigid_mass(2.0, Vec3::Zero(), Mat3::Identity());
  M(0, 0) += 0.3;
  M(1, 1) += 1.7;
  NodeState<double> x{Pose<double>{}, Vec6::Zero(), Vec6::Zero()};
  x.V.head<2>() << 2.0, 0.5;
  Mass::Output<double> out;
  Mass::evaluate<Want::residual>({}, {M}, &x, {}, {}, out);
  EXPECT_NEAR(out.r(5), (1.7 - 0.3) * 2.0 * 0.5, 1e-14);
  EXPECT_EQ(out.r.head<5>().norm(), 0.0);
}

}  // namespace
}  // namespace mbd::test::test_laws_nodal
