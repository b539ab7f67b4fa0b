// Laws of the elements on one node: inertia, gravity, loads. (Beams: test_laws_elastic_*.cpp.)
#include <gtest/gtest.h>

#include "elements/node/batches.hpp"
#include "tests/elements/dual_tangent.hpp"

namespace {

using namespace mbd;
using namespace mbd::laws;

// A random instance of an element: what a new element type has to add to be tried here.
template <class E>
struct Case;

template <>
struct Case<Mass> {
  Mass::Shared shared;
  Mass::Data data;
  explicit Case(Rng& rng, double length) : data{test::random_spd(rng, 2.0, length)} {}
  void mutate() { data.M(2, 3) *= 1.1; }
  Environment environment() const { return {}; }
  void turn(const Pose<double>&) {}
};
template <>
struct Case<MassDamping> {
  MassDamping::Shared shared;
  MassDamping::Data data;
  explicit Case(Rng& rng, double length) : data{test::random_spd(rng, 2.0, length)} {}
  void mutate() { data.P(2, 3) *= 1.1; }
  Environment environment() const { return {}; }
  void turn(const Pose<double>&) {}
};
template <>
struct Case<NodalGravity> {
  NodalGravity::Shared shared;
  NodalGravity::Data data;
  explicit Case(Rng& rng, double length)
      : shared{test::random_vector<3>(rng, 10)}, data{3.0, length * test::random_vector<3>(rng)} {}
  void mutate() { data.m *= 1.1; }
  Environment environment() const { return {.t = 0, .load_factor = 0.7, .signals = {}}; }
  void turn(const Pose<double>& G) { shared.g = G.p * shared.g; }
};
// What the loads have in common: signals in any order, one of them absent.
template <class E>
struct LoadCase {
  typename E::Shared shared;
  typename E::Data data{};
  std::array<SignalValue, 6> signals{};
  LoadCase(Rng& rng, double length) {
    for (std::size_t i = 0; i < 6; ++i)
      signals[i] = {test::uniform(rng, -1, 1) * (i % 2 ? length : 1), 7, 7};
    signals[1].f = signals[3].f = 0.3 * length;
    data.signals = {2, -1, 0, 4, 3, 1};
    data.weight = test::uniform(rng, 0.5, 2);
    if constexpr (requires { data.offset; }) data.offset = length * test::random_vector<3>(rng);
  }
  void mutate() { signals[2].f *= 1.1; }
  Environment environment() const { return {.t = 0, .load_factor = 0.7, .signals = signals}; }
  Vec6 load() const {  // weighted and scaled
    return 0.7 * data.weight *
           Vec6(signals[2].f, 0, signals[0].f, signals[4].f, signals[3].f, signals[1].f);
  }
};
// Dead loads turn with the field.
template <class E>
struct DeadCase : LoadCase<E> {
  using LoadCase<E>::LoadCase;
  void turn(const Pose<double>& G) {
    const Vec6 f = this->load() / (0.7 * this->data.weight);
    const Vec6 turned = six<double>(G.p * Vec3(linear(f)), G.p * Vec3(angular(f)));
    for (std::size_t i = 0; i < 6; ++i) {
      this->data.signals[i] = static_cast<int>(i);
      this->signals[i].f = turned(static_cast<Index>(i));
    }
  }
};
template <>
struct Case<PointLoad> : DeadCase<PointLoad> {
  using DeadCase::DeadCase;
};
template <>
struct Case<DeadForceArm> : DeadCase<DeadForceArm> {
  using DeadCase::DeadCase;
};
template <>
struct Case<FollowerLoad> : LoadCase<FollowerLoad> {
  using LoadCase::LoadCase;
  void turn(const Pose<double>&) {}  // nothing to turn: it is stated in the node's axes
};

template <class E>
struct ElementLaws : testing::Test {
  static constexpr RateWeights weights{1.7, 0.6};

  struct Sample {
    double length;
    Case<E> one;
    std::vector<NodeState<double>> x;
  };
  template <class F>
  static void sample(const F& f) {
    Rng rng(41);
    for (int i = 0; i < 200; ++i) {
      const double length = test::log_uniform(rng, 1e-2, 1e2);
      Sample s{length, Case<E>(rng, length), {}};
      for (int a = 0; a < E::nodes; ++a) {
        NodeState<double> x{test::random_pose(rng, length), test::random_vector<6>(rng),
                            test::random_vector<6>(rng)};
        x.V.template head<3>() *= length;
        x.Vdot.template head<3>() *= length;
        s.x.push_back(x);
      }
      f(rng, s);
    }
  }
  // Through the batch, as a model has it.
  static ElementBatch<E> batch(const Case<E>& c) {
    ElementBatch<E> batch(E::name, c.shared);
    batch.add(c.data, std::array{1}, "it");
    return batch;
  }
  static BatchValue value(const Case<E>& c, const std::vector<NodeState<double>>& x) {
    ElementBatch<E> one = batch(c);
    const BatchValue v = linearized(one, state_of(x, c.environment()), weights);
    EXPECT_TRUE(v.in_range);
    return v;
  }
  static VecX residual(const Case<E>& c, const std::vector<NodeState<double>>& x) {
    VecX r = residual_of(batch(c), state_of(x, c.environment()));
    EXPECT_EQ(r.size(), 6);
    return r;
  }
  static double error(const Case<E>& c, const Sample& s) {
    const BatchValue out = value(c, s.x);
    const Environment env = s.one.environment();
    double e = 0;
    const MatrixXd K = dual_tangent<E>(s.one.shared, s.one.data, s.x, env, false);
    const MatrixXd D = dual_tangent<E>(s.one.shared, s.one.data, s.x, env, true, weights);
    if constexpr (E::has_K)
      e = std::max(e, tangent_error(out.K, K, s.length));
    else
      EXPECT_TRUE(K.isZero(0.0) && out.K.isZero(0.0));
    if constexpr (E::has_D)
      e = std::max(e, tangent_error(out.D, D, s.length));
    else
      EXPECT_TRUE(D.isZero(0.0) && out.D.isZero(0.0));
    return e;
  }
};
using Types =
    testing::Types<Mass, MassDamping, NodalGravity, PointLoad, FollowerLoad, DeadForceArm>;
TYPED_TEST_SUITE(ElementLaws, Types);

// With respect to poses; and to V and Vdot by their weights. A tangent that an element says it has not is zero.
TYPED_TEST(ElementLaws, TangentIsTheDerivative) {
  Worst worst("error", 1e-14);
  this->sample([&](Rng&, const auto& s) { worst.add(TestFixture::error(s.one, s)); });
}

// (Of a follower load there is no tangent; that its residual does not depend on the pose is tested above.)
TYPED_TEST(ElementLaws, TangentFailsUnderMutation) {
  if constexpr (!TypeParam::has_K && !TypeParam::has_D) return;
  double smallest = INFINITY;
  this->sample([&](Rng&, const auto& s) {
    Case<TypeParam> mutant = s.one;
    mutant.mutate();
    smallest = std::min(smallest, TestFixture::error(mutant, s));
  });
  EXPECT_GT(smallest, 1e-8);
}

TYPED_TEST(ElementLaws, ResidualIsTheSameWithAndWithoutTangent) {
  int same = 0, total = 0;
  this->sample([&](Rng&, const auto& s) {
    const auto with = TestFixture::value(s.one, s.x).r;
    const auto without = TestFixture::residual(s.one, s.x);
    same += (with.array() == without.array()).all();
    ++total;
  });
  EXPECT_EQ(same, total) << "to the last bit";
}

// Turned and moved with its node and its field, nothing changes in the body frame.
TYPED_TEST(ElementLaws, Objectivity) {
  Worst worst("error", 16 * eps);
  this->sample([&](Rng& rng, const auto& s) {
    const Pose<double> G = test::random_pose(rng, 1e6 * s.length);
    auto there = s;
    there.one.turn(G);
    for (auto& x : there.x) x.H = G * x.H;
    const VecX r = TestFixture::residual(s.one, s.x);
    const VecX moved = TestFixture::residual(there.one, there.x);
    worst.add(force_size(moved - r, s.length) / force_size(r, s.length));
  });
}

// --- each against mechanics ---

// The momentum of a body seen from the inertial frame changes at the rate the residual says (Newton, Euler).
TEST(Inertia, ForceIsTheRateOfMomentum) {
  Worst worst("error", 64 * eps);
  double mutated = INFINITY;
  ElementLaws<Mass>::sample([&](Rng&, const auto& s) {
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
    const Vec6 r = ElementLaws<Mass>::residual(s.one, s.x);
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
  ElementLaws<Mass>::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Mat6& M = s.one.data.M;
    const Vec6 r = ElementLaws<Mass>::residual(s.one, s.x);
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
  ElementLaws<MassDamping>::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec6 r = ElementLaws<MassDamping>::residual(s.one, s.x);
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
    const Vec6 f = ElementLaws<MassDamping>::residual(of_mass, s.x);
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
      particles.emplace_back(test::uniform(rng, 0.1, 1), test::random_vector<3>(rng));
      m += particles.back().first;
      c += particles.back().first * particles.back().second;
    }
    c /= m;
    Mat3 J = Mat3::Zero();
    for (const auto& [mi, x] : particles) {
      const Vec3 d = x - c;
      J += mi * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
    }
    const Vec6 V = test::random_vector<6>(rng);
    double kinetic = 0;
    for (const auto& [mi, x] : particles)
      kinetic += 0.5 * mi * (linear(V) + angular(V).cross(x)).squaredNorm();
    const Mat6 M = rigid_mass(m, c, J);
    EXPECT_NEAR(0.5 * V.dot(M * V), kinetic, 1e-14 * kinetic);

    // seen from a frame in which the body's is at H: the same particles at H x
    const Pose<double> H = test::random_pose(rng);
    double seen = 0;
    for (const auto& [mi, x] : particles)
      seen += 0.5 * mi * (linear(V) + angular(V).cross(H * x)).squaredNorm();
    EXPECT_NEAR(0.5 * V.dot(transformed_mass(M, H) * V), seen, 1e-13 * seen);
  }
}

TEST(NodalGravityLaw, ForceIsTheGradientOfThePotential) {
  Worst gradient("gradient", 1e-11), skew("skew", 32 * eps);
  double mutated = INFINITY;
  ElementLaws<NodalGravity>::sample([&](Rng& rng, const auto& s) {
    const auto out = ElementLaws<NodalGravity>::value(s.one, s.x);
    Vec6 V = test::random_vector<6>(rng);
    V.head<3>() *= s.length;
    const auto potential = [&](double tau) {
      NodeState<double> x = s.x[0];
      x.H = x.H * exp_se3<double>(tau * V);
      const Energies e = NodalGravity::energies(s.one.shared, s.one.data, &x, s.one.environment());
      EXPECT_EQ(e.kinetic + e.strain, 0.0);
      return Matrix<double, 1, 1>(e.potential);
    };
    const double rate = test::first_difference(potential, 0.02)(0),
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
  const NodeState<double> x{
      {test::rotation(std::numbers::pi / 2, Vec3::UnitX()), Vec3(1, 2, 3)}, {}, {}};
  NodalGravity::Output<double> out;
  NodalGravity::evaluate<Want::residual>(shared, data, &x, {}, {}, out);
  // inertial -e3 is body -e2: internal minus external
  EXPECT_LT((out.r - Vec6(0, 19.62, 0, 0, 0, 9.81)).norm(), 1e-14);
  EXPECT_NEAR(NodalGravity::energies(shared, data, &x, {}).potential, 2 * 9.81 * 3, 1e-13);
}

// What a load says of its power is that of its residual, -r.V, both through the batch. Detects 10 % more of one
// component, or another offset.
template <class E>
struct LoadLaws : testing::Test {};
using LoadTypes = testing::Types<PointLoad, FollowerLoad, DeadForceArm>;
TYPED_TEST_SUITE(LoadLaws, LoadTypes);

TYPED_TEST(LoadLaws, Power) {
  using Laws = ElementLaws<TypeParam>;
  Worst worst("error", 64 * eps);
  double mutated = INFINITY;
  Laws::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec6 r = Laws::residual(s.one, s.x);
    const auto power = [&s](const Case<TypeParam>& c) {
      const auto batch = Laws::batch(c);
      State state = state_of(s.x, c.environment());
      const double with_rates = batch.load_power(state);
      state.V.clear();
      state.Vdot.clear();
      EXPECT_EQ(batch.load_power(state), 0.0) << "without rates";
      return with_rates;
    };
    double arm = s.length;
    if constexpr (requires { s.one.data.offset; }) arm += s.one.data.offset.norm();
    const double size = s.one.load().norm() *
                        (x.V.template head<3>().norm() + (1 + arm) * x.V.template tail<3>().norm());
    worst.add(std::abs(-r.dot(x.V) - power(s.one)) / size);
    Case<TypeParam> mutant = s.one;
    mutant.mutate();
    mutated = std::min(mutated, std::abs(-r.dot(x.V) - power(mutant)) / size);
  });
  EXPECT_GT(mutated, 1e-7);
}

// The power of a dead load is f.v + m.w in the inertial frame, whatever the node's attitude.
TEST(PointLoadLaw, PowerOfADeadLoad) {
  Worst worst("error", 32 * eps);
  ElementLaws<PointLoad>::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec6 f = s.one.load(), r = ElementLaws<PointLoad>::residual(s.one, s.x);
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
  ElementLaws<DeadForceArm>::sample([&](Rng& rng, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec3 f = linear(s.one.load()), c = s.one.data.offset;
    PointLoad::Data force{s.one.data.signals, s.one.data.weight};
    for (std::size_t i = 3; i < 6; ++i) force.signals[i] = -1;
    PointLoad::Output<double> r;
    PointLoad::evaluate<Want::residual>({}, force, &x, s.one.environment(), {}, r);
    const Vec6 arm = ElementLaws<DeadForceArm>::residual(s.one, s.x);
    Vec6 V = test::random_vector<6>(rng);
    V.head<3>() *= s.length;
    const auto potential = [&](double tau) {
      return Matrix<double, 1, 1>(-f.dot((x.H * exp_se3<double>(tau * V)) * c));
    };
    const double rate = test::first_difference(potential, 0.02)(0), size = f.norm() * s.length;
    gradient.add(std::abs(rate - (r.r + arm).dot(V)) / size);
    without_arm = std::min(without_arm, std::abs(rate - r.r.dot(V)) / size);
  });
  EXPECT_GT(without_arm, 1e-6);
}

}  // namespace
