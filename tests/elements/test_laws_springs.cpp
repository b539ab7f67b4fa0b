// Laws of springs, dampers, bushings, and springs, dampers and torques of joints, at random large motions:
// tangents against dual numbers, energy -> force, power, objectivity, balance of what acts on both sides, and
// residuals the same with and without tangent. Each law is shown to see a coefficient that is 10 % off.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "elements/pair/bushing.hpp"
#include "elements/pair/bushing_damper.hpp"
#include "elements/pair/damper.hpp"
#include "elements/pair/spring.hpp"
#include "joints/joint_damper.hpp"
#include "joints/joint_spring.hpp"
#include "joints/joint_torque.hpp"
#include "tests/elements/laws.hpp"

namespace mbd::test::test_laws_springs {
namespace {

using namespace mbd::laws;
using joint::JointDamper, joint::JointSpring, joint::JointTorque, joint::Sliding, joint::Turning;

// A nonlinear law of a variable of size `x` and a force of size `f`.
Law some_law(double f, double x, Variables variable) {
  const Parameters p{{"f", f}, {"s", x}};
  const std::string y = variable == Variables::x ? "(x/s)" : "(v/s)";
  return Law::of(
      Expression::parse("f*(0.3*" + y + " + 0.5*" + y + "^3 + 0.2*sin(2*" + y + "))", p, variable));
}

two_points::Ends points(Rng& rng, double length) {
  return {length * random_vector<3>(rng), length * random_vector<3>(rng), length};
}
two_frames::Ends frames(Rng& rng, double length) {
  return {random_pose(rng, length), random_pose(rng, length)};
}

// A random instance, of forces of about 1 N; relative rotations up to `angle`.
template <class E>
struct Case;

template <>
struct Case<Spring> {
  static constexpr double angle = std::numbers::pi;
  Spring::Shared shared;
  Spring::Data data;
  Environment env{};
  Case(Rng& rng, double l)
      : shared{{some_law(1.0, l, Variables::x)}},
        data{points(rng, l), uniform(rng, 0, 2) * l, {uniform(rng, 0.5, 2) / l, 0}} {}
  void mutate() { data.force.coefficient *= 1.1; }
};
template <>
struct Case<Damper> {
  static constexpr double angle = std::numbers::pi;
  Damper::Shared shared;
  Damper::Data data;
  Environment env{};
  Case(Rng& rng, double l)
      : shared{{some_law(1.0, l, Variables::v)}},
        data{points(rng, l), {uniform(rng, 0.5, 2) / l, 0}} {}
  void mutate() { data.force.coefficient *= 1.1; }
};
template <>
struct Case<Bushing> {
  static constexpr double angle = 0.99 * GeodesicMetric::max_angle;
  Bushing::Shared shared;
  Bushing::Data data;
  Environment env{};
  Case(Rng& rng, double l)
      : shared{{some_law(1.0, l, Variables::x), some_law(l, 1.0, Variables::x)}},
        data{frames(rng, l), random_spd(rng, 1.0 / l, l), {-1, 0, -1, 1, -1, -1}} {}
  void mutate() { data.K(2, 4) *= 1.1; }
};
template <>
struct Case<BushingDamper> {
  static constexpr double angle = 0.99 * GeodesicMetric::max_angle;
  BushingDamper::Shared shared;
  BushingDamper::Data data;
  Environment env{};
  Case(Rng& rng, double l) : data{frames(rng, l), random_spd(rng, 1.0 / l, l)} {}
  void mutate() { data.C(2, 4) *= 1.1; }
};
// Angles followed over turns.
template <class C>
struct Followed {
  static constexpr double angle = std::numbers::pi;
  static constexpr bool turns = std::is_same_v<C, Turning>;
  std::array<double, 1> angles{};
  explicit Followed(Rng& rng) { angles[0] = uniform(rng, -20, 20); }
  static double unit(double l) { return turns ? 1.0 : l; }  // of the coordinate
};
template <class C>
struct Case<JointSpring<C>> : Followed<C> {
  typename JointSpring<C>::Shared shared;
  typename JointSpring<C>::Data data;
  Environment env{};
  Case(Rng& rng, double l) : Followed<C>(rng) {
    const double u = this->unit(l), f = this->turns ? l : 1.0;
    shared.laws.push_back(some_law(f, this->turns ? 20.0 : u, Variables::x));
    data = {{frames(rng, l), 0}, uniform(rng, -1, 1) * u, {uniform(rng, 0.5, 2) * f / u, 0}};
  }
  Case(const Case& other) = delete;
  void mutate() { data.force.coefficient *= 1.1; }
};
template <class C>
struct Case<JointDamper<C>> : Followed<C> {
  typename JointDamper<C>::Shared shared;
  typename JointDamper<C>::Data data;
  Environment env{};
  Case(Rng& rng, double l) : Followed<C>(rng) {
    const double u = this->unit(l), f = this->turns ? l : 1.0;
    shared.laws.push_back(some_law(f, u, Variables::v));
    data = {{frames(rng, l), 0}, {uniform(rng, 0.5, 2) * f / u, 0}};
  }
  Case(const Case& other) = delete;
  void mutate() { data.force.coefficient *= 1.1; }
};
template <class C>
struct Case<JointTorque<C>> : Followed<C> {
  typename JointTorque<C>::Shared shared;
  typename JointTorque<C>::Data data;
  std::array<SignalValue, 1> signals{};
  Environment env{};
  Case(Rng& rng, double l) : Followed<C>(rng) {
    signals[0] = {uniform(rng, 0.5, 2) * (this->turns ? l : 1.0), 7, 7};
    data = {frames(rng, l), 0};
  }
  Case(const Case& other) = delete;
  void mutate() { signals[0].f *= 1.1; }
};

template <class E>
struct SpringLaws : testing::Test {
  using Output = typename E::template Output<double>;
  static constexpr RateWeights weights{1.7, 0.6};
  static constexpr bool has_energy = requires(const NodeState<double>* x, const Environment& env) {
    E::energies({}, {}, x, env);
  };
  static constexpr bool of_rates = E::has_D;
  static constexpr bool is_load =
      std::is_same_v<E, JointTorque<Turning>> || std::is_same_v<E, JointTorque<Sliding>>;

  struct Sample {
    double length;
    Case<E> one;
    std::vector<NodeState<double>> x;
    Sample(Rng& rng, double l) : length(l), one(rng, l) {
      if constexpr (requires { one.angles; }) one.env.angles = one.angles;
      if constexpr (requires { one.signals; }) {
        one.env.signals = one.signals;
        one.env.load_factor = 0.7;
      }
    }
  };

  // Node Q at random from P, with a relative rotation of the frames within the range; frames of joints off
  // the place where their angle is not defined.
  template <class F>
  static void sample(const F& f) {
    Rng rng(43);
    for (int i = 0; i < 200; ++i) {
      const double length = log_uniform(rng, 1e-2, 1e2);
      Sample s(rng, length);
      NodeState<double> P{random_pose(rng, length), random_vector<6>(rng), random_vector<6>(rng)},
          Q{random_pose(rng, length), random_vector<6>(rng), random_vector<6>(rng)};
      if constexpr (
          requires { s.one.data.K; } || requires { s.one.data.C; }) {
        const double turn = uniform(rng, 0, 1) < 0.1 ? 1e-9 : uniform(rng, 0, Case<E>::angle);
        const auto& ends = s.one.data.ends;
        Q.H = P.H * ends.a * random_relative(rng, turn, uniform(rng, 0, 2) * length) *
              inverse(ends.b);
      } else if constexpr (requires { s.one.angles; }) {
        const auto& ends = [&]() -> const two_frames::Ends& {
          if constexpr (requires { s.one.data.axis; })
            return s.one.data.axis.ends;
          else
            return s.one.data.ends;
        }();
        const Pose<double> tilt{rotation(uniform(rng, 0, 0.5), random_direction(rng)),
                                length * random_vector<3>(rng)},
            turned{rotation(uniform(rng, -3, 3), Vec3::UnitZ()), Vec3::Zero()};
        Q.H = P.H * ends.a * turned * tilt * inverse(ends.b);
        // The last accepted angle lies near the present one.
        s.one.angles[0] = joint::unwrapped_angle<double>(relative(P.H * ends.a, Q.H * ends.b).R(),
                                                         s.one.angles[0]) +
                          uniform(rng, -1, 1);
      }
      for (NodeState<double>* node : {&P, &Q}) {
        node->V.head<3>() *= length;
        node->Vdot.head<3>() *= length;
      }
      s.x = {P, Q};
      f(rng, s);
    }
  }
  template <Want want>
  static Output evaluate(const Sample& s, const std::vector<NodeState<double>>& x) {
    Output out;
    EXPECT_GT((E::template evaluate<want, double>(s.one.shared, s.one.data, x.data(), s.one.env,
                                                  weights, out)),
              0.0);
    return out;
  }
  static VecX rates(const std::vector<NodeState<double>>& x) {
    VecX V(12);
    V << x[0].V, x[1].V;
    return V;
  }
  static std::vector<NodeState<double>> stepped(const std::vector<NodeState<double>>& x,
                                                double step) {
    std::vector<NodeState<double>> y = x;
    for (NodeState<double>& node : y) node.H = node.H * exp_se3<double>(Vec6(step * node.V));
    return y;
  }
};

using Types = testing::Types<Spring, Damper, Bushing, BushingDamper, JointSpring<Turning>,
                             JointSpring<Sliding>, JointDamper<Turning>, JointDamper<Sliding>,
                             JointTorque<Turning>, JointTorque<Sliding>>;
TYPED_TEST_SUITE(SpringLaws, Types);

TYPED_TEST(SpringLaws, TangentsAreDerivatives) {
  using E = TypeParam;
  Worst K("K", 1e-13), D("D", 1e-13);
  double mutated = INFINITY;
  TestFixture::sample([&](Rng&, auto& s) {
    const auto out = TestFixture::template evaluate<Want::tangent>(s, s.x);
    const MatrixXd want = dual_tangent<E>(s.one.shared, s.one.data, s.x, s.one.env, false);
    K.add(tangent_error(out.K, want, s.length));
    const MatrixXd rate =
        dual_tangent<E>(s.one.shared, s.one.data, s.x, s.one.env, true, TestFixture::weights);
    if constexpr (E::has_D)
      D.add(tangent_error(out.D, rate, s.length));
    else
      D.add(rate.cwiseAbs().maxCoeff());
    s.one.mutate();
    const auto other = TestFixture::template evaluate<Want::tangent>(s, s.x);
    mutated = std::min(mutated, tangent_error(other.K, want, s.length));
  });
  EXPECT_GT(mutated, 1e-8) << "10 % off in one coefficient may pass unnoticed";
}

TYPED_TEST(SpringLaws, ResidualIsTheSameWithAndWithoutTangent) {
  int same = 0, total = 0;
  TestFixture::sample([&](Rng&, auto& s) {
    const VecX with = TestFixture::template evaluate<Want::tangent>(s, s.x).r,
               without = TestFixture::template evaluate<Want::residual>(s, s.x).r;
    same += (with.array() == without.array()).all();
    ++total;
  });
  EXPECT_EQ(same, total) << "to the last bit";
}

// Body-frame forces do not change under a rigid motion of both nodes; what acts on both sides balances; a rigid
// velocity makes no force of rates.
TYPED_TEST(SpringLaws, IsObjectiveAndBalanced) {
  Worst objective("objective", 1e-11), balance("balance", 1e-13), rest("rest", 1e-11);
  TestFixture::sample([&](Rng& rng, auto& s) {
    const VecX r = TestFixture::template evaluate<Want::residual>(s, s.x).r;
    const double size = force_size(r, s.length);
    const Pose<double> G = random_pose(rng, 10 * s.length);
    auto x = s.x;
    for (auto& node : x) node.H = G * node.H;
    const VecX there = TestFixture::template evaluate<Want::residual>(s, x).r;
    objective.add(force_size(there - r, s.length) / (size + 1e-3));
    balance.add(force_size(resultant(r, {s.x[0].H, s.x[1].H}), s.length) / (size + 1e-3));
    if constexpr (TestFixture::of_rates) {
      const Vec6 V = s.x[0].V;
      x = s.x;
      x[1].V = adjoint_inverse(relative(x[0].H, x[1].H)) * V;
      rest.add(force_size(TestFixture::template evaluate<Want::residual>(s, x).r, s.length) /
               (size + 1e-3));
    } else {
      rest.add(0.0);
    }
  });
}

// Springs: the force is the gradient of the energy. Others: its power is what they say.
TYPED_TEST(SpringLaws, EnergyAndPowerAreThoseOfTheForce) {
  using E = TypeParam;
  Worst power("power", 1e-10);
  int mutated = 0, total = 0;
  TestFixture::sample([&](Rng&, auto& s) {
    const auto stated = [&] {
      if constexpr (TestFixture::of_rates) {
        return -E::damping_power(s.one.shared, s.one.data, s.x.data(), s.one.env);
      } else if constexpr (TestFixture::is_load) {
        return -E::load_power(s.one.shared, s.one.data, s.x.data(), s.one.env);
      } else {
        const auto energy = [&](double step) {
          const auto x = TestFixture::stepped(s.x, step);
          Eigen::Matrix<double, 1, 1> value;
          value(0) = E::energies(s.one.shared, s.one.data, x.data(), s.one.env).strain;
          return value;
        };
        return first_difference(energy, 2e-3)(0);
      }
    };
    const auto done = [&] {
      return TestFixture::template evaluate<Want::residual>(s, s.x).r.dot(TestFixture::rates(s.x));
    };
    const double size =
        force_size(TestFixture::template evaluate<Want::residual>(s, s.x).r, s.length) * s.length;
    const double want = done();
    power.add(std::abs(stated() - want) / size);
    s.one.mutate();
    mutated += std::abs(stated() - want) / size > 1e-6;
    ++total;
  });
  // unless the motion happens to be across what was changed
  EXPECT_GT(mutated, (9 * total) / 10);
}

}  // namespace
}  // namespace mbd::test::test_laws_springs
