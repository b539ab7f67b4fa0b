// The viscous term of the beam, on the random beams of laws.hpp, their largest angles up to 0.9 of the singular
// one, and random velocities: tangents, objectivity, power; and that its rates are those of the elastic strains.
#include <gtest/gtest.h>

#include <memory>

#include "elements/beam/beam_damping.hpp"
#include "elements/beam/beam_damping_batch.hpp"
#include "tests/elements/dual_tangent.hpp"
#include "tests/support/dense.hpp"

namespace mbd::test::test_laws_damping {
namespace {

using namespace mbd::laws;

constexpr RateWeights weights{1.7, 0.6};

// An element, its viscous stiffness, and a state of it.
struct Sample {
  Beam beam;
  std::vector<Mat6> C;  // one, or one a quadrature point
  std::vector<NodeState<double>> x;

  std::unique_ptr<BeamDampingBatch> batch() const {
    auto batch = make_beam_damping(beam.metric, beam.rule, beam.order);
    std::vector<int> nodes;
    for (std::size_t k = 0; k < x.size(); ++k) nodes.push_back(static_cast<int>(k) + 1);
    for (const Mat6& one : C) batch->add_viscosity(one);
    batch->add_element(beam.J, beam.reference, nodes, 0, C.size() > 1 ? 1 : 0, "x");
    return batch;
  }
};

// What is compiled for each metric: the kernel on dual numbers.
struct Dual {
  MatrixXd (*derivative)(const Sample&, bool of_rates);  // of the residual
  std::vector<Vec6> (*strain_rates)(const Sample&);      // of the elastic term, at the points
};
template <class M>
Dual dual() {
  using Kernel = beam::Damping<M, 0>;
  return {[](const Sample& s, bool of_rates) {
            const Beam& b = s.beam;
            const SpectralTable t = spectral_table(b.order, b.rule);
            return dual_tangent<Kernel>(
                {b.order, static_cast<int>(t.rule.points.size()), s.C},
                Kernel::make_data(beam::make_data<M, 0>(t, b.J, b.reference, 0, 0), 0,
                                  s.C.size() > 1 ? 1 : 0),
                s.x, {}, of_rates, weights);
          },
          [](const Sample& s) {
            const Beam& b = s.beam;
            const SpectralTable t = spectral_table(b.order, b.rule);
            const auto kinematics = beam::make_data<M, 0>(t, b.J, b.reference, 0, 0);
            beam::Motion<M, 0, D1> motion;
            std::vector<Pose<D1>> pose;
            for (const auto& x : s.x) pose.push_back(seeded(x.H, x.V));
            motion.set(b.order, [&pose](int k) -> const Pose<D1>& {
              return pose[static_cast<std::size_t>(k)];
            });
            std::vector<Vec6> rates(t.rule.points.size());
            for (std::size_t i = 0; i < rates.size(); ++i) {
              const Vector6<D1> K = beam::curvature<0, D1>(kinematics, static_cast<int>(i),
                                                           b.order * (b.order + 1) / 2, motion.q);
              for (Index c = 0; c < 6; ++c) rates[i](c) = K(c).d;
            }
            return rates;
          }};
}

struct DampingLaws : testing::TestWithParam<Metric> {
  const Dual dual_numbers = GetParam() == Metric::matrix       ? dual<MatrixMetric>()
                            : GetParam() == Metric::quaternion ? dual<QuaternionMetric>()
                                                               : dual<GeodesicMetric>();

  static void sample(int count, const std::function<void(Rng&, const Sample&)>& f) {
    Rng rng(51);
    const double limit = BeamLaws(GetParam(), Form::energy).largest_angle();
    for (int order = 1; order <= beam::max_order; ++order)
      for (const Rule rule : {Rule::gauss, Rule::gauss_lobatto})
        for (int i = 0; i < count; ++i) {
          const double angle =
              i == 0 ? limit * (1 - 1e-6) : test::random_angle(rng, limit * (1 - 1e-6));
          Beam b;
          do b = random_beam(rng, GetParam(), Form::energy, rule, order, limit, angle);
          while (max_angle(b.pose) > limit);
          Sample s{b, b.D, {}};
          for (const Pose<double>& H : b.pose) {
            NodeState<double> x{H, test::random_vector<6>(rng), test::random_vector<6>(rng)};
            x.V.head<3>() *= b.length;
            s.x.push_back(x);
          }
          f(rng, s);
        }
  }
  static std::string name(const Sample& s) { return BeamLaws::name(s.beam); }
  static BatchValue value(const Sample& s) {
    const BatchValue v = linearized(*s.batch(), state_of(s.x, {}), weights);
    EXPECT_TRUE(v.in_range);
    return v;
  }
  static VecX residual(const Sample& s) {
    VecX r = residual_of(*s.batch(), state_of(s.x, {}));
    EXPECT_GT(r.size(), 0);
    return r;
  }
  // Of K and of D.
  std::array<double, 2> errors(const Sample& s, const BatchValue& v) const {
    return {tangent_error(v.K, dual_numbers.derivative(s, false), s.beam.length),
            tangent_error(v.D, dual_numbers.derivative(s, true), s.beam.length)};
  }
  static std::vector<Mat6> mutated_stiffness(std::vector<Mat6> C) {
    for (Mat6& one : C) one(1, 1) *= 1.1;
    return C;
  }
  static double power_of(const Sample& s) { return s.batch()->damping_power(state_of(s.x, {})); }
  static VecX velocities(const std::vector<NodeState<double>>& x) {
    VecX V(6 * static_cast<Index>(x.size()));
    for (std::size_t a = 0; a < x.size(); ++a) V.segment<6>(6 * static_cast<Index>(a)) = x[a].V;
    return V;
  }
  // The largest force that the velocities of single nodes make: round-off is measured in it.
  static double force_unit(const Sample& s, const BatchValue& v) {
    double V = 0.0;
    for (const auto& x : s.x)
      V = std::max({V, x.V.head<3>().norm(), s.beam.length * x.V.tail<3>().norm()});
    return eps * tangent_size(v.D, s.beam.length) / weights.V * V;
  }
};
INSTANTIATE_TEST_SUITE_P(Every, DampingLaws,
                         testing::Values(Metric::matrix, Metric::quaternion, Metric::geodesic),
                         metric_name);

TEST_P(DampingLaws, TangentsAreTheDerivatives) {
  Worst poses("poses", 1e-12), rates("rates", 1e-12);
  sample(4, [&](Rng&, const Sample& s) {
    const auto [K, D] = errors(s, value(s));
    poses.add(K, name(s));
    rates.add(D, name(s));
  });
}

// An entry of C 10 % off; K without the part of the rates, or without the geometric one.
TEST_P(DampingLaws, TangentsFailUnderMutation) {
  double K_least = INFINITY, D_least = INFINITY;
  sample(1, [&](Rng&, const Sample& s) {
    Sample mutant = s;
    mutant.C = mutated_stiffness(s.C);
    const auto [K, D] = errors(s, value(mutant));
    K_least = std::min(K_least, K);
    D_least = std::min(D_least, D);
  });
  EXPECT_GT(K_least, 1e-4);
  EXPECT_GT(D_least, 1e-4);
}

TEST_P(DampingLaws, ResidualIsTheSameWithAndWithoutTangent) {
  int same = 0, total = 0;
  sample(4, [&](Rng&, const Sample& s) {
    const VecX with = value(s).r, without = residual(s);
    same += (with.array() == without.array()).all();
    ++total;
  });
  EXPECT_EQ(same, total) << "to the last bit";
}

// In axes that turn and move with all nodes, whatever the place and attitude, and whatever rigid motion is added
// to the velocities: which by itself makes no forces. Detects 1e-6 of a velocity left out at one node.
TEST_P(DampingLaws, Objectivity) {
  Worst turned("turned", 64), added("rigid_motion_added", 64), alone("rigid_motion_alone", 64);
  double mutated = INFINITY;
  sample(4, [&](Rng& rng, const Sample& s) {
    const auto out = value(s);
    const double unit = force_unit(s, out);
    const Pose<double> G = test::random_pose(rng, s.beam.length);
    auto there = s;
    for (auto& x : there.x) x.H = G * x.H;
    const VecX moved = residual(there);
    turned.add(force_size(moved - out.r, s.beam.length) / unit, name(s));

    Vec6 V0 = test::random_vector<6>(rng);
    V0.head<3>() *= s.beam.length;
    auto faster = s, rigid = s;
    for (std::size_t a = 0; a < s.x.size(); ++a) {
      const Vec6 own = adjoint_inverse(relative(s.x[0].H, s.x[a].H)) * V0;
      faster.x[a].V += own;
      rigid.x[a].V = own;
    }
    added.add(force_size(residual(faster) - out.r, s.beam.length) / unit, name(s));
    alone.add(force_size(residual(rigid), s.beam.length) / unit, name(s));
    rigid.x[0].V *= 1 - 1e-6;
    mutated = std::min(mutated, force_size(residual(rigid), s.beam.length) / unit);
  });
  EXPECT_GT(mutated, 1e3);
}

// r.V is what the dissipation function says, and no velocity gains by it: r = D V with D symmetric, not negative.
TEST_P(DampingLaws, Power) {
  Worst power("power", 1e-13), linear("linear", 64), symmetric("symmetric", 1e-14);
  double mutated = INFINITY, least = 0.0;
  sample(4, [&](Rng&, const Sample& s) {
    const auto out = value(s);
    const VecX V = velocities(s.x), r = out.r;
    const double p = power_of(s);
    EXPECT_LT(p, 0.0);
    power.add(std::abs(r.dot(V) / p + 1.0), name(s));
    const MatrixXd D = scaled(out.D, s.beam.length) / weights.V;
    linear.add(force_size(out.D * V / weights.V - r, s.beam.length) / force_unit(s, out), name(s));
    symmetric.add((D - D.transpose()).cwiseAbs().maxCoeff() / D.cwiseAbs().maxCoeff());
    const VecX values = test::dense::eigenvalues(0.5 * (D + D.transpose()));
    least = std::min(least, values(0) / values(values.size() - 1));
    Sample mutant = s;
    mutant.C = mutated_stiffness(s.C);
    mutated = std::min(mutated, std::abs(r.dot(V) / power_of(mutant) + 1.0));
  });
  EXPECT_GT(mutated, 1e-7);
  EXPECT_GT(least, -1e-14);
}

// C Edot is the rate of the elastic term's strain along H exp(t V), times C, and 2 R the sum of Edot.C Edot over the
// quadrature points. Through the interface of a model; zero where the state has no rates.
TEST_P(DampingLaws, RatesAreThoseOfTheElasticStrains) {
  Worst rates("rates", 1e-12), power("power", 1e-12);
  double mutated = INFINITY;
  sample(4, [&](Rng&, const Sample& s) {
    const SpectralTable t = spectral_table(s.beam.order, s.beam.rule);
    const auto damping = s.batch();
    const State state = state_of(s.x, {});
    State at_rest = state;
    at_rest.V.clear();
    at_rest.Vdot.clear();
    std::vector<Vec6> viscous(t.rule.points.size(), Vec6::Ones());
    damping->resultants(at_rest, 0, viscous);
    for (const Vec6& S : viscous) EXPECT_TRUE(S.isZero(0.0));
    damping->resultants(state, 0, viscous);
    EXPECT_EQ(damping->damping_power(at_rest), 0.0);
    const std::vector<Vec6> strain_rates = dual_numbers.strain_rates(s);
    const std::vector<Mat6> other_C = mutated_stiffness(s.C);
    const VecX units = laws::units(6, s.beam.length);
    double twice_R = 0.0, size = 0.0, difference = 0.0, other = 0.0;
    for (std::size_t i = 0; i < t.rule.points.size(); ++i) {
      const Vec6& rate = strain_rates[i];
      const std::size_t at = s.C.size() > 1 ? i : 0;
      const Vec6 want = s.C[at] * rate, got = viscous[i];
      size = std::max(size, (s.C[at].cwiseAbs() * rate.cwiseAbs()).cwiseQuotient(units).norm());
      difference = std::max(difference, (got - want).cwiseQuotient(units).norm());
      other = std::max(other, (other_C[at] * rate - got).cwiseQuotient(units).norm());
      const VecX l = lagrange(t.nodes.points, t.rule.points[i]);
      double J = 0.0;
      for (Index k = 0; k < l.size(); ++k) J += l(k) * s.beam.J[static_cast<std::size_t>(k)];
      twice_R += t.rule.weights[i] * J * want.dot(rate);
    }
    rates.add(difference / size, name(s));
    power.add(std::abs(twice_R / damping->damping_power(state) + 1.0), name(s));
    mutated = std::min(mutated, other / size);
  });
  EXPECT_GT(mutated, 1e-4);
}

}  // namespace
}  // namespace mbd::test::test_laws_damping
