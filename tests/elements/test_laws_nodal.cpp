// Laws of what acts on one node and is stated by few scenes: drag, motion of the base, variants of inertia.
#include <gtest/gtest.h>

#include "elements/node/batches.hpp"
#include "tests/elements/dual_tangent.hpp"

namespace mbd::test::test_laws_nodal {
namespace {

using namespace mbd::laws;

constexpr double factor = 0.7;  // load factor

// A random instance of an element: what the laws below need of it.
template <class E>
struct Case;

struct WithSignals {
  std::array<SignalValue, 3> signals{};
  Environment environment() const { return {.t = 0, .load_factor = factor, .signals = signals}; }
  // The field turned with the node; -1, a component that is zero, has no place to go.
  void turn(const Pose<double>& G, std::array<int, 3>& places, double SignalValue::*of) {
    Vec3 x = Vec3::Zero();
    for (std::size_t i = 0; i < 3; ++i)
      if (places[i] >= 0)
        x(static_cast<Index>(i)) = signals[static_cast<std::size_t>(places[i])].*of;
    x = G.p * x;
    for (std::size_t i = 0; i < 3; ++i) {
      places[i] = static_cast<int>(i);
      signals[i].*of = x(static_cast<Index>(i));
    }
  }
};

template <bool flowing, bool placed>
struct Case<LineDrag<flowing, placed>> : WithSignals {
  typename LineDrag<flowing, placed>::Shared shared;
  typename LineDrag<flowing, placed>::Data data{};
  Case(Rng& rng, double length) {
    data.across = uniform(rng, 0.5, 2);
    data.along = uniform(rng, 0.1, 0.5);
    for (SignalValue& s : signals) s = {length * uniform(rng, -1, 1), 7, 7};
    if constexpr (flowing) data.flow.signals = {2, -1, 0};
    if constexpr (placed) {
      data.frame.R = exp_so3<double>(random_vector<3>(rng)).toRotationMatrix();
      data.frame.c = length * random_vector<3>(rng);
    }
  }
  void mutate() { data.across *= 1.1; }
  void move(const Pose<double>& G) {
    if constexpr (flowing) turn(G, data.flow.signals, &SignalValue::f);
  }
};
template <bool flowing>
struct Case<PointDrag<flowing>> : WithSignals {
  typename PointDrag<flowing>::Shared shared;
  typename PointDrag<flowing>::Data data{};
  Case(Rng& rng, double length) {
    data.b = uniform(rng, 0.5, 2);
    data.offset = length * random_vector<3>(rng);
    for (SignalValue& s : signals) s = {length * uniform(rng, -1, 1), 7, 7};
    if constexpr (flowing) data.flow.signals = {2, -1, 0};
  }
  void mutate() { data.b *= 1.1; }
  void move(const Pose<double>& G) {
    if constexpr (flowing) turn(G, data.flow.signals, &SignalValue::f);
  }
};
template <>
struct Case<BaseMotion> : WithSignals {
  BaseMotion::Shared shared;
  BaseMotion::Data data{};
  Case(Rng& rng, double length) {
    shared.law = static_cast<BaseMotion::Law>(static_cast<int>(uniform(rng, 0, 2.999)));
    shared.signals = {2, -1, 0};
    data = {3.0, length * random_vector<3>(rng)};
    for (SignalValue& s : signals)
      s = {uniform(rng, -9, 9), uniform(rng, -9, 9), uniform(rng, -9, 9)};
  }
  double SignalValue::*derivative() const {
    return shared.law == BaseMotion::Law::acceleration ? &SignalValue::f
           : shared.law == BaseMotion::Law::velocity   ? &SignalValue::fdot
                                                       : &SignalValue::fddot;
  }
  void mutate() { data.m *= 1.1; }
  void move(const Pose<double>& G) { turn(G, shared.signals, derivative()); }
};
template <>
struct Case<MassNoGyroscopic> {
  MassNoGyroscopic::Shared shared;
  MassNoGyroscopic::Data data;
  Case(Rng& rng, double length)
      : data{random_spd(rng, 2.0, length), random_spd(rng, 2.0, length).bottomRightCorner<3, 3>()} {
  }
  Environment environment() const { return {}; }
  void mutate() { data.J(0, 1) *= 1.1; }
  void move(const Pose<double>&) {}
};

template <class E>
struct NodalLaws : testing::Test {
  static constexpr RateWeights weights{1.7, 0.6};
  struct Sample {
    double length;
    Case<E> one;
    std::vector<NodeState<double>> x;
  };
  template <class F>
  static void sample(const F& f) {
    Rng rng(43);
    for (int i = 0; i < 200; ++i) {
      const double length = log_uniform(rng, 1e-2, 1e2);
      Sample s{length, Case<E>(rng, length), {}};
      NodeState<double> x{random_pose(rng, length), random_vector<6>(rng), random_vector<6>(rng)};
      // From at rest against the fluid to fast.
      const bool drags = !std::is_same_v<E, MassNoGyroscopic>;
      const double fast = drags && i % 4 == 0 ? log_uniform(rng, 1e-9, 1) : 1.0;
      x.V *= fast;
      x.V.template head<3>() *= length;
      x.Vdot.template head<3>() *= length;
      s.x.push_back(x);
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
    testing::Types<LineDrag<false>, LineDrag<true>, LineDrag<false, true>, LineDrag<true, true>,
                   PointDrag<false>, PointDrag<true>, BaseMotion, MassNoGyroscopic>;
TYPED_TEST_SUITE(NodalLaws, Types);

TYPED_TEST(NodalLaws, TangentIsTheDerivative) {
  Worst worst("error", 2e-14);
  double mutated = INFINITY;
  this->sample([&](Rng&, const auto& s) {
    worst.add(TestFixture::error(s.one, s));
    Case<TypeParam> mutant = s.one;
    mutant.mutate();
    mutated = std::min(mutated, TestFixture::error(mutant, s));
  });
  EXPECT_GT(mutated, 1e-8);
}

TYPED_TEST(NodalLaws, ResidualIsTheSameWithAndWithoutTangent) {
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
TYPED_TEST(NodalLaws, Objectivity) {
  Worst worst("error", 32 * eps);
  this->sample([&](Rng& rng, const auto& s) {
    const Pose<double> G = random_pose(rng, 1e6 * s.length);
    auto there = s;
    there.one.move(G);
    for (auto& x : there.x) x.H = G * x.H;
    const VecX r = TestFixture::residual(s.one, s.x);
    const VecX moved = TestFixture::residual(there.one, there.x);
    worst.add(force_size(moved - r, s.length) / force_size(r, s.length));
  });
}

// What an element says of its power is that of its residual, -r.V, and through a batch no different; a 10 % mutation
// shows. The load factor is linear.
template <class E>
struct PowerLaws : testing::Test {};
using PowerTypes =
    testing::Types<LineDrag<false>, LineDrag<true>, LineDrag<false, true>, LineDrag<true, true>,
                   PointDrag<false>, PointDrag<true>, BaseMotion>;
TYPED_TEST_SUITE(PowerLaws, PowerTypes);

TYPED_TEST(PowerLaws, Power) {
  using Laws = NodalLaws<TypeParam>;
  constexpr bool is_load = std::is_same_v<TypeParam, BaseMotion>;
  Worst worst("error", 64 * eps), rate("load_rate", 16 * eps);
  double mutated = INFINITY, largest = -INFINITY;
  Laws::sample([&](Rng&, const auto& s) {
    const NodeState<double>& x = s.x[0];
    const Vec6 r = Laws::residual(s.one, s.x);
    const double size = r.cwiseAbs().dot(x.V.cwiseAbs());
    const auto power = [&](const Case<TypeParam>& c) {
      ElementBatch<TypeParam> one(TypeParam::name, c.shared);
      one.add(c.data, std::array{1}, "it");
      State state;
      state.load_factor = factor;
      const Environment env = c.environment();
      state.signals.assign(env.signals.begin(), env.signals.end());
      state.pose = {Pose<double>{}, x.H};
      State still = state;
      state.V = {Vec6::Zero(), x.V};
      state.Vdot = {Vec6::Zero(), x.Vdot};
      VecX F = VecX::Zero(12);
      one.load_rate(state, F);
      rate.add(force_size(F.tail<6>() * factor - r, s.length) / force_size(r, s.length));
      EXPECT_EQ(one.load_power(still) + one.damping_power(still), 0.0);
      EXPECT_EQ(is_load ? one.damping_power(state) : one.load_power(state), 0.0);
      return is_load ? one.load_power(state) : one.damping_power(state);
    };
    const double P = power(s.one);
    worst.add(std::abs(P + r.dot(x.V)) / size);
    largest = std::max(largest, P / size);
    Case<TypeParam> mutant = s.one;
    if constexpr (is_load)
      mutant.data.mc *= 1.1, mutant.data.m *= 1.1;
    else
      mutant.mutate();
    const VecX other = Laws::residual(mutant, s.x);
    mutated = std::min(mutated, std::abs(P + other.dot(x.V)) / size);
  });
  EXPECT_GT(mutated, 1e-6);
  if (std::is_same_v<TypeParam, LineDrag<false>> ||
      std::is_same_v<TypeParam, LineDrag<false, true>> ||
      std::is_same_v<TypeParam, PointDrag<false>>) {
    EXPECT_LT(largest, 0.0) << "in still fluid drag only takes";
  } else {
    EXPECT_GT(largest, 0.0);
  }
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
  NodalLaws<BaseMotion>::sample([&](Rng&, const auto& s) {
    Vec3 a = Vec3::Zero();
    for (Index i = 0; i < 3; ++i)
      if (const int place = s.one.shared.signals[static_cast<std::size_t>(i)]; place >= 0)
        a(i) = s.one.signals[static_cast<std::size_t>(place)].*(s.one.derivative());
    const auto of_base = NodalLaws<BaseMotion>::value(s.one, s.x);
    NodalGravity::Output<double> of_gravity;
    NodalGravity::evaluate<Want::tangent>(NodalGravity::Shared{-a},
                                          NodalGravity::Data{s.one.data.m, s.one.data.mc},
                                          s.x.data(), s.one.environment(), {}, of_gravity);
    EXPECT_LE((of_base.r - of_gravity.r).norm(), 16 * eps * of_gravity.r.norm());
    EXPECT_LE((of_base.K - of_gravity.K).norm(), 16 * eps * of_gravity.K.norm());
  });
}

// --- inertia ---

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
