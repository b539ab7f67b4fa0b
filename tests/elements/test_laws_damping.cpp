// The viscous term of the beam, on the random beams of laws.hpp, their largest angles up to 0.9 of the singular
// one, and random velocities: tangents, objectivity, power; and that its rates are those of the elastic strains.
#include <gtest/gtest.h>

#include "elements/beam/beam_damping.hpp"
#include "elements/beam/beam_damping_batch.hpp"
#include "tests/elements/laws.hpp"
#include "tests/support/dense.hpp"

namespace mbd::test::test_laws_damping {
namespace {

using namespace mbd::laws;

template <class M>
struct DampingLaws : testing::Test {
  using Kernel = beam::Damping<M, 0>;
  using Output = typename Kernel::template Output<double>;
  using Nodes = std::vector<NodeState<double>>;
  static constexpr RateWeights weights{1.7, 0.6};

  // An element, its viscous stiffness in place of D, and a state of it.
  struct Sample {
    Beam beam;
    typename Kernel::Shared shared;
    typename Kernel::Data data;
    beam::Data<0> kinematics;
    Nodes x;

    void set(const std::vector<Mat6>& C) { shared.viscosity = C; }
  };
  template <class F>
  static void sample(int count, const F& f) {
    Rng rng(51);
    for (int order = 1; order <= beam::max_order; ++order)
      for (const Rule rule : {Rule::gauss, Rule::gauss_lobatto})
        for (int i = 0; i < count; ++i) {
          const double angle = i == 0 ? M::max_angle * (1 - 1e-6)
                                      : test::random_angle(rng, M::max_angle * (1 - 1e-6));
          Beam b;
          do b = random_beam(rng, metric_of<M>(), Form::energy, rule, order, M::max_angle, angle);
          while (max_angle(b.pose) > M::max_angle);
          const SpectralTable t = spectral_table(order, rule);
          const auto kinematics = beam::make_data<M, 0>(t, b.J, b.reference, 0, 0);
          Sample s{b,
                   {order, static_cast<int>(t.rule.points.size()), b.D},
                   Kernel::make_data(kinematics, 0, b.D.size() > 1 ? 1 : 0),
                   kinematics,
                   {}};
          for (const Pose<double>& H : b.pose) {
            NodeState<double> x{H, test::random_vector<6>(rng), test::random_vector<6>(rng)};
            x.V.template head<3>() *= b.length;
            s.x.push_back(x);
          }
          f(rng, s);
        }
  }
  static std::string name(const Sample& s) { return BeamLaws<M, beam::EnergyForm>::name(s.beam); }
  template <Want want>
  static Output evaluate(const Sample& s) {
    Output out;
    EXPECT_GT(
        (Kernel::template evaluate<want, double>(s.shared, s.data, s.x.data(), {}, weights, out)),
        0.0);
    return out;
  }
  // Of K and of D.
  static std::array<double, 2> errors(const Sample& s, const Output& out) {
    return {
        tangent_error(out.K, dual_tangent<Kernel>(s.shared, s.data, s.x, {}, false), s.beam.length),
        tangent_error(out.D, dual_tangent<Kernel>(s.shared, s.data, s.x, {}, true, weights),
                      s.beam.length)};
  }
  static std::vector<Mat6> mutated(std::vector<Mat6> C) {
    for (Mat6& one : C) one(1, 1) *= 1.1;
    return C;
  }
  static double power(const Sample& s) {
    return Kernel::damping_power(s.shared, s.data, s.x.data(), {});
  }
  static VecX velocities(const Nodes& x) {
    VecX V(6 * static_cast<Index>(x.size()));
    for (std::size_t a = 0; a < x.size(); ++a) V.segment<6>(6 * static_cast<Index>(a)) = x[a].V;
    return V;
  }
  // The largest force that the velocities of single nodes make: round-off is measured in it.
  static double force_unit(const Sample& s, const Output& out) {
    double V = 0.0;
    for (const auto& x : s.x)
      V = std::max(
          {V, x.V.template head<3>().norm(), s.beam.length * x.V.template tail<3>().norm()});
    return eps * tangent_size(out.D, s.beam.length) / weights.V * V;
  }
};
using Metrics = testing::Types<MatrixMetric, QuaternionMetric, GeodesicMetric>;
TYPED_TEST_SUITE(DampingLaws, Metrics);

TYPED_TEST(DampingLaws, TangentsAreTheDerivatives) {
  Worst poses("poses", 1e-12), rates("rates", 1e-12);
  this->sample(4, [&](Rng&, const auto& s) {
    const auto [K, D] = this->errors(s, this->template evaluate<Want::tangent>(s));
    poses.add(K, this->name(s));
    rates.add(D, this->name(s));
  });
}

// An entry of C 10 % off; K without the part of the rates, or without the geometric one.
TYPED_TEST(DampingLaws, TangentsFailUnderMutation) {
  double K_least = INFINITY, D_least = INFINITY;
  this->sample(1, [&](Rng&, const auto& s) {
    auto mutant = s;
    mutant.set(this->mutated(s.beam.D));
    const auto [K, D] = this->errors(s, this->template evaluate<Want::tangent>(mutant));
    K_least = std::min(K_least, K);
    D_least = std::min(D_least, D);
  });
  EXPECT_GT(K_least, 1e-4);
  EXPECT_GT(D_least, 1e-4);
}

TYPED_TEST(DampingLaws, ResidualIsTheSameWithAndWithoutTangent) {
  int same = 0, total = 0;
  this->sample(4, [&](Rng&, const auto& s) {
    const VecX with = this->template evaluate<Want::tangent>(s).r,
               without = this->template evaluate<Want::residual>(s).r;
    same += (with.array() == without.array()).all();
    ++total;
  });
  EXPECT_EQ(same, total) << "to the last bit";
}

// In axes that turn and move with all nodes, whatever the place and attitude, and whatever rigid motion is added
// to the velocities: which by itself makes no forces. Detects 1e-6 of a velocity left out at one node.
TYPED_TEST(DampingLaws, Objectivity) {
  Worst turned("turned", 64), added("rigid_motion_added", 64), alone("rigid_motion_alone", 64);
  double mutated = INFINITY;
  this->sample(4, [&](Rng& rng, const auto& s) {
    const auto out = this->template evaluate<Want::tangent>(s);
    const double unit = this->force_unit(s, out);
    const Pose<double> G = test::random_pose(rng, s.beam.length);
    auto there = s;
    for (auto& x : there.x) x.H = G * x.H;
    const VecX moved = this->template evaluate<Want::residual>(there).r;
    turned.add(force_size(moved - out.r, s.beam.length) / unit, this->name(s));

    Vec6 V0 = test::random_vector<6>(rng);
    V0.head<3>() *= s.beam.length;
    auto faster = s, rigid = s;
    for (std::size_t a = 0; a < s.x.size(); ++a) {
      const Vec6 own = adjoint_inverse(relative(s.x[0].H, s.x[a].H)) * V0;
      faster.x[a].V += own;
      rigid.x[a].V = own;
    }
    added.add(
        force_size(this->template evaluate<Want::residual>(faster).r - out.r, s.beam.length) / unit,
        this->name(s));
    alone.add(force_size(this->template evaluate<Want::residual>(rigid).r, s.beam.length) / unit,
              this->name(s));
    rigid.x[0].V *= 1 - 1e-6;
    mutated = std::min(
        mutated,
        force_size(this->template evaluate<Want::residual>(rigid).r, s.beam.length) / unit);
  });
  EXPECT_GT(mutated, 1e3);
}

// r.V is what the dissipation function says, and no velocity gains by it: r = D V with D symmetric, not negative.
TYPED_TEST(DampingLaws, Power) {
  Worst power("power", 1e-13), linear("linear", 64), symmetric("symmetric", 1e-14);
  double mutated = INFINITY, least = 0.0;
  this->sample(4, [&](Rng&, const auto& s) {
    const auto out = this->template evaluate<Want::tangent>(s);
    const VecX V = this->velocities(s.x), r = out.r;
    const double p = this->power(s);
    EXPECT_LT(p, 0.0);
    power.add(std::abs(r.dot(V) / p + 1.0), this->name(s));
    const MatrixXd D = scaled(out.D, s.beam.length) / this->weights.V;
    linear.add(
        force_size(out.D * V / this->weights.V - r, s.beam.length) / this->force_unit(s, out),
        this->name(s));
    symmetric.add((D - D.transpose()).cwiseAbs().maxCoeff() / D.cwiseAbs().maxCoeff());
    const VecX values = test::dense::eigenvalues(0.5 * (D + D.transpose()));
    least = std::min(least, values(0) / values(values.size() - 1));
    auto mutant = s;
    mutant.set(this->mutated(s.beam.D));
    mutated = std::min(mutated, std::abs(r.dot(V) / this->power(mutant) + 1.0));
  });
  EXPECT_GT(mutated, 1e-7);
  EXPECT_GT(least, -1e-14);
}

// C Edot is the rate of the elastic term's strain along H exp(t V), times C, and 2 R the sum of Edot.C Edot over the
// quadrature points. Through the interface of a model; zero where the state has no rates.
TYPED_TEST(DampingLaws, RatesAreThoseOfTheElasticStrains) {
  Worst rates("rates", 1e-12), power("power", 1e-12);
  double mutated = INFINITY;
  this->sample(4, [&](Rng&, const auto& s) {
    const SpectralTable t = spectral_table(s.beam.order, s.beam.rule);
    const std::size_t n = s.x.size();
    auto damping = make_beam_damping(s.beam.metric, s.beam.rule, s.beam.order);
    std::vector<int> nodes;
    for (std::size_t k = 0; k < n; ++k) nodes.push_back(static_cast<int>(k) + 1);
    for (const Mat6& C : s.beam.D) damping->add_viscosity(C);
    damping->add_element(s.beam.J, s.beam.reference, nodes, 0, s.beam.D.size() > 1 ? 1 : 0, "x");
    State state;
    state.pose.assign(1, {});
    state.pose.insert(state.pose.end(), s.beam.pose.begin(), s.beam.pose.end());
    EXPECT_TRUE(damping->resultants(state, 0, 0.3).isZero(0.0));
    EXPECT_EQ(damping->damping_power(state), 0.0);
    state.V.assign(n + 1, Vec6::Zero());
    state.Vdot = state.V;
    for (std::size_t k = 0; k < n; ++k) state.V[k + 1] = s.x[k].V;

    beam::Motion<TypeParam, 0, D1> motion;
    std::vector<Pose<D1>> pose;
    for (const auto& x : s.x) pose.push_back(seeded(x.H, x.V));
    motion.set(s.beam.order,
               [&pose](int k) -> const Pose<D1>& { return pose[static_cast<std::size_t>(k)]; });
    const VecX units = laws::units(6, s.beam.length);
    double twice_R = 0.0, size = 0.0, difference = 0.0, other = 0.0;
    for (std::size_t i = 0; i < t.rule.points.size(); ++i) {
      const Vector6<D1> K = beam::curvature<0, D1>(s.kinematics, static_cast<int>(i),
                                                   s.beam.order * (s.beam.order + 1) / 2, motion.q);
      Vec6 rate;
      for (Index c = 0; c < 6; ++c) rate(c) = K(c).d;
      const Mat6& C = s.beam.D[s.beam.D.size() > 1 ? i : 0];
      const Vec6 want = C * rate, got = damping->resultants(state, 0, t.rule.points[i]);
      size = std::max(size, (C.cwiseAbs() * rate.cwiseAbs()).cwiseQuotient(units).norm());
      difference = std::max(difference, (got - want).cwiseQuotient(units).norm());
      other = std::max(other, (this->mutated({C})[0] * rate - got).cwiseQuotient(units).norm());
      twice_R += s.data.wJ[i] * want.dot(rate);
    }
    rates.add(difference / size, this->name(s));
    power.add(std::abs(twice_R / damping->damping_power(state) + 1.0), this->name(s));
    mutated = std::min(mutated, other / size);
  });
  EXPECT_GT(mutated, 1e-4);
}

}  // namespace
}  // namespace mbd::test::test_laws_damping
