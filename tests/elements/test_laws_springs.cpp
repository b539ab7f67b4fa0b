// Laws of springs, dampers, bushings, and springs, dampers and torques of joints, at random large motions:
// tangents against dual numbers, energy -> force, power, objectivity, balance of what acts on both sides, and
// residuals the same with and without tangent. Each law is shown to see a coefficient that is 10 % off.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "elements/pair/batches.hpp"
#include "joints/coordinate_batches.hpp"
#include "tests/elements/dual_tangent.hpp"

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

// A random instance of an element and of its motion: all that the laws below need to know of its type.
struct Sample {
  double length = 1.0;
  Environment env;
  std::vector<NodeState<double>> x;

  virtual ~Sample() = default;
  virtual MatrixXd derivative(bool of_rates) const = 0;  // of the residual, by dual numbers
  virtual std::unique_ptr<Batch> batch() const = 0;
  virtual void mutate() = 0;
};

struct Type {
  std::string name;
  bool of_rates, is_load;
  std::unique_ptr<Sample> (*make)(Rng&, double length);
};
constexpr RateWeights weights{1.7, 0.6};

template <class E>
struct SampleOf final : Sample {
  Case<E> one;

  // Node Q at random from P, with a relative rotation of the frames within the range; frames of joints off
  // the place where their angle is not defined.
  SampleOf(Rng& rng, double l) : one(rng, l) {
    length = l;
    env = one.env;
    NodeState<double> P{random_pose(rng, length), random_vector<6>(rng), random_vector<6>(rng)},
        Q{random_pose(rng, length), random_vector<6>(rng), random_vector<6>(rng)};
    if constexpr (
        requires { one.data.K; } || requires { one.data.C; }) {
      const double turn = uniform(rng, 0, 1) < 0.1 ? 1e-9 : uniform(rng, 0, Case<E>::angle);
      const auto& ends = one.data.ends;
      Q.H =
          P.H * ends.a * random_relative(rng, turn, uniform(rng, 0, 2) * length) * inverse(ends.b);
    } else if constexpr (requires { one.angles; }) {
      const auto& ends = [&]() -> const two_frames::Ends& {
        if constexpr (requires { one.data.axis; })
          return one.data.axis.ends;
        else
          return one.data.ends;
      }();
      const Pose<double> tilt{rotation(uniform(rng, 0, 0.5), random_direction(rng)),
                              length * random_vector<3>(rng)},
          turned{rotation(uniform(rng, -3, 3), Vec3::UnitZ()), Vec3::Zero()};
      Q.H = P.H * ends.a * turned * tilt * inverse(ends.b);
      // The last accepted angle lies near the present one.
      one.angles[0] =
          joint::unwrapped_angle<double>(relative(P.H * ends.a, Q.H * ends.b).R(), one.angles[0]) +
          uniform(rng, -1, 1);
      env.angles = one.angles;
    }
    if constexpr (requires { one.signals; }) {
      env.signals = one.signals;
      env.load_factor = 0.7;
    }
    for (NodeState<double>* node : {&P, &Q}) {
      node->V.template head<3>() *= length;
      node->Vdot.template head<3>() *= length;
    }
    x = {P, Q};
  }
  MatrixXd derivative(bool of_rates) const override {
    return dual_tangent<E>(one.shared, one.data, x, env, of_rates, weights);
  }
  std::unique_ptr<Batch> batch() const override {
    auto batch = std::make_unique<ElementBatch<E>>("it", one.shared);
    batch->add(one.data, std::array{1, 2}, "it");
    return batch;
  }
  void mutate() override { one.mutate(); }
};

template <class E>
Type type(const char* name, bool is_load = false) {
  return {name, E::has_D, is_load, [](Rng& rng, double length) -> std::unique_ptr<Sample> {
            return std::make_unique<SampleOf<E>>(rng, length);
          }};
}

struct SpringLaws : testing::TestWithParam<Type> {
  static void sample(const std::function<void(Rng&, Sample&)>& f) {
    Rng rng(43);
    for (int i = 0; i < 200; ++i) {
      const double length = log_uniform(rng, 1e-2, 1e2);
      f(rng, *GetParam().make(rng, length));
    }
  }
  static BatchValue value(const Sample& s) {
    const BatchValue v = linearized(*s.batch(), state_of(s.x, s.env), weights);
    EXPECT_TRUE(v.in_range);
    return v;
  }
  static VecX residual(const Sample& s, const std::vector<NodeState<double>>& x) {
    VecX r = residual_of(*s.batch(), state_of(x, s.env));
    EXPECT_EQ(r.size(), 12);
    return r;
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
INSTANTIATE_TEST_SUITE_P(Every, SpringLaws,
                         testing::Values(type<Spring>("spring"), type<Damper>("damper"),
                                         type<Bushing>("bushing"),
                                         type<BushingDamper>("bushing_damper"),
                                         type<JointSpring<Turning>>("spring_of_an_angle"),
                                         type<JointSpring<Sliding>>("spring_of_a_displacement"),
                                         type<JointDamper<Turning>>("damper_of_an_angle"),
                                         type<JointDamper<Sliding>>("damper_of_a_displacement"),
                                         type<JointTorque<Turning>>("torque", true),
                                         type<JointTorque<Sliding>>("force", true)),
                         [](const testing::TestParamInfo<Type>& it) { return it.param.name; });

TEST_P(SpringLaws, TangentsAreDerivatives) {
  Worst K("K", 1e-13), D("D", 1e-13);
  double mutated = INFINITY;
  sample([&](Rng&, Sample& s) {
    const BatchValue v = value(s);
    const MatrixXd want = s.derivative(false), rate = s.derivative(true);
    K.add(tangent_error(v.K, want, s.length));
    if (GetParam().of_rates)
      D.add(tangent_error(v.D, rate, s.length));
    else
      D.add(std::max(rate.cwiseAbs().maxCoeff(), v.D.cwiseAbs().maxCoeff()));
    s.mutate();
    mutated = std::min(mutated, tangent_error(value(s).K, want, s.length));
  });
  EXPECT_GT(mutated, 1e-8) << "10 % off in one coefficient may pass unnoticed";
}

TEST_P(SpringLaws, ResidualIsTheSameWithAndWithoutTangent) {
  int same = 0, total = 0;
  sample([&](Rng&, Sample& s) {
    const VecX with = value(s).r, without = residual(s, s.x);
    same += (with.array() == without.array()).all();
    ++total;
  });
  EXPECT_EQ(same, total) << "to the last bit";
}

// Body-frame forces do not change under a rigid motion of both nodes; what acts on both sides balances; a rigid
// velocity makes no force of rates.
TEST_P(SpringLaws, IsObjectiveAndBalanced) {
  Worst objective("objective", 1e-11), balance("balance", 1e-13), rest("rest", 1e-11);
  sample([&](Rng& rng, Sample& s) {
    const VecX r = residual(s, s.x);
    const double size = force_size(r, s.length);
    const Pose<double> G = random_pose(rng, 10 * s.length);
    auto x = s.x;
    for (auto& node : x) node.H = G * node.H;
    objective.add(force_size(residual(s, x) - r, s.length) / (size + 1e-3));
    balance.add(force_size(resultant(r, {s.x[0].H, s.x[1].H}), s.length) / (size + 1e-3));
    if (GetParam().of_rates) {
      const Vec6 V = s.x[0].V;
      x = s.x;
      x[1].V = adjoint_inverse(relative(x[0].H, x[1].H)) * V;
      rest.add(force_size(residual(s, x), s.length) / (size + 1e-3));
    } else {
      rest.add(0.0);
    }
  });
}

// Springs: the force is the gradient of the energy. Others: its power is what they say.
TEST_P(SpringLaws, EnergyAndPowerAreThoseOfTheForce) {
  Worst power("power", 1e-10);
  int mutated = 0, total = 0;
  sample([&](Rng&, Sample& s) {
    const auto stated = [&] {
      const std::unique_ptr<Batch> batch = s.batch();
      if (GetParam().of_rates) return -batch->damping_power(state_of(s.x, s.env));
      if (GetParam().is_load) return -batch->load_power(state_of(s.x, s.env));
      const auto energy = [&](double step) {
        const auto x = stepped(s.x, step);
        Eigen::Matrix<double, 1, 1> value;
        value(0) = batch->energies(state_of(x, s.env)).strain;
        return value;
      };
      return first_difference(energy, 2e-3)(0);
    };
    const VecX r = residual(s, s.x);
    const double size = force_size(r, s.length) * s.length, want = r.dot(rates(s.x));
    power.add(std::abs(stated() - want) / size);
    s.mutate();
    mutated += std::abs(stated() - want) / size > 1e-6;
    ++total;
  });
  // unless the motion happens to be across what was changed
  EXPECT_GT(mutated, (9 * total) / 10);
}

}  // namespace
}  // namespace mbd::test::test_laws_springs
