// The element of component modes (elements/component): its tangents by dual numbers at large random motions, power and energy,
// momenta, rigid motion, frames within by differences; and what gravity and the base do to it, against a rigid body's.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "elements/component/component_batch.hpp"
#include "elements/node/batches.hpp"
#include "elements/node/gravity.hpp"
#include "elements/node/mass.hpp"
#include "tests/elements/laws.hpp"

namespace mbd::test::test_component {
namespace {

using namespace mbd::laws;
using component::Data;
using component::MatX;
using States = std::vector<NodeState<double>>;

MatX random_matrix(Rng& rng, Index rows, Index columns) {
  MatX A(rows, columns);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) A(i, j) = uniform(rng, -1.0, 1.0);
  return A;
}
MatX random_semidefinite(Rng& rng, Index n) {
  const MatX A = random_matrix(rng, n, n);
  return A * A.transpose();
}

struct Case {
  Data data;
  MatX M;
  States x;
  Vec3 gravity = Vec3::Zero();
};

Case random_case(Rng& rng, Index n) {
  Case c;
  for (Index k = 1; k < n; ++k) c.data.A.push_back(random_pose(rng));
  c.data.K = random_semidefinite(rng, 6 * (n - 1));
  c.data.C = random_semidefinite(rng, 6 * (n - 1));
  c.M = random_semidefinite(rng, 6 * n);
  c.data.M_a = random_semidefinite(rng, 6 * n);
  c.data.P = random_matrix(rng, 3, 6 * (n - 1));
  c.data.mass = uniform(rng, 0.5, 2.0);
  c.data.static_moment = random_vector<3>(rng);
  const Pose<double> H = random_pose(rng);
  for (Index k = 0; k < n; ++k) {
    const Pose<double> own = k == 0 ? H : H * c.data.A[static_cast<std::size_t>(k - 1)];
    c.x.push_back({own * exp_se3<double>(random_vector<6>(rng, 0.9)), random_vector<6>(rng, 3.0),
                   random_vector<6>(rng, 9.0)});
  }
  c.gravity = random_vector<3>(rng, 10.0);
  return c;
}

ComponentBatch batch_of(const Case& c) {
  ComponentBatch batch(c.gravity, {});
  std::vector<int> nodes;
  for (std::size_t k = 0; k < c.x.size(); ++k) nodes.push_back(static_cast<int>(k) + 1);
  batch.add(c.data, nodes, "it");
  return batch;
}

ComponentInertia inertia_of(const Case& c) {
  ComponentInertia batch;
  std::vector<int> nodes;
  for (std::size_t k = 0; k < c.x.size(); ++k) nodes.push_back(static_cast<int>(k) + 1);
  batch.add(c.M, nodes);
  return batch;
}
VecX all_of(const Case& c, const State& state) {
  return residual_of(batch_of(c), state) + residual_of(inertia_of(c), state);
}

// Along dU, dV, dVdot of all nodes: of forces under the acceleration a, and of inertia.
std::array<VecX, 2> derivatives(const Case& c, const Vec3& a, double rate, const VecX& dU,
                                const VecX& dV, const VecX& dA) {
  std::vector<NodeState<D1>> y(c.x.size());
  for (std::size_t k = 0; k < y.size(); ++k) {
    const auto i = 6 * static_cast<Index>(k);
    y[k] = {seeded(c.x[k].H, dU.segment<6>(i)), seeded(c.x[k].V, dV.segment<6>(i)),
            seeded(c.x[k].Vdot, dA.segment<6>(i))};
  }
  std::array<component::VectorX<D1>, 2> r;
  component::VectorX<D1> p;
  component::Motion<D1>(c.data, y).residual(a, r[0]);
  component::inertia_residual<D1>(c.M, y, rate, p, r[1]);
  std::array<VecX, 2> d{VecX(r[0].size()), VecX(r[0].size())};
  for (std::size_t k = 0; k < 2; ++k)
    for (Index i = 0; i < d[k].size(); ++i) d[k](i) = r[k](i).d;
  return d;
}

TEST(Component, TangentsAreTheDerivatives) {
  Rng rng(3);
  Worst worst("error over the largest entry", 1e-13);
  for (const Index n : {2, 3, 5})
    for (const double rate : {0.0, 40.0})
      for (int i = 0; i < 10; ++i) {
        Case c = random_case(rng, n);
        Environment env;
        env.load_factor = 0.7;
        env.momentum_rate = rate;
        ComponentBatch forces = batch_of(c);
        ComponentInertia inertia = inertia_of(c);
        const RateWeights w{1.7, 0.6};
        const State state = state_of(c.x, env);
        const std::array<BatchValue, 2> got{linearized(forces, state, w),
                                            linearized(inertia, state, w)};
        EXPECT_TRUE(got[0].in_range);
        const Index size = 6 * n;
        const VecX none = VecX::Zero(size);
        std::array<MatX, 2> K{MatX(size, size), MatX(size, size)}, D = K;
        for (Index k = 0; k < size; ++k) {
          const VecX unit = VecX::Unit(size, k);
          const auto by_U = derivatives(c, 0.7 * c.gravity, rate, unit, none, none);
          const auto by_V = derivatives(c, 0.7 * c.gravity, rate, none, w.V * unit, w.A * unit);
          for (std::size_t i_of = 0; i_of < 2; ++i_of)
            K[i_of].col(k) = by_U[i_of], D[i_of].col(k) = by_V[i_of];
        }
        for (std::size_t i_of = 0; i_of < 2; ++i_of) {
          const double size_of_K = K[i_of].cwiseAbs().maxCoeff();
          worst.add((got[i_of].K - K[i_of]).cwiseAbs().maxCoeff() / std::max(size_of_K, 1e-300));
          worst.add((got[i_of].D - D[i_of]).cwiseAbs().maxCoeff() / D[i_of].cwiseAbs().maxCoeff());
        }
      }
}

// V.r is the rate of energy and what damping takes; the rate of energy by dual numbers along the motion.
TEST(Component, PowerIsTheRateOfEnergy) {
  Rng rng(4);
  for (int i = 0; i < 20; ++i) {
    const Case c = random_case(rng, 3);
    const ComponentBatch batch = batch_of(c);
    const State state = state_of(c.x, {});
    const VecX r = all_of(c, state);
    double power = 0.0, size = 0.0;
    for (std::size_t k = 0; k < c.x.size(); ++k) {
      const double part = c.x[k].V.dot(r.segment<6>(6 * static_cast<Index>(k)));
      power += part;
      size += std::abs(part);
    }
    constexpr double h = 1e-4;  // fourth order
    const auto energy = [&](double t) {
      States x = c.x;
      for (NodeState<double>& at : x) {
        at.H = at.H * exp_se3<double>(t * at.V);
        at.V += t * at.Vdot;
      }
      return batch.energies(state_of(x, {})).total() +
             inertia_of(c).energies(state_of(x, {})).total();
    };
    const double rate =
        (8.0 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
    EXPECT_NEAR(power, rate - batch.damping_power(state), 1e-7 * size);
    EXPECT_LT(batch.damping_power(state), 0.0);
  }
}

// Moved rigidly, without loads and damping, its forces move with it.
TEST(Component, IsObjective) {
  Rng rng(5);
  Worst worst("error over the forces", 1e-12);
  for (int i = 0; i < 20; ++i) {
    Case c = random_case(rng, 4);
    c.gravity.setZero();
    const VecX r = all_of(c, state_of(c.x, {}));
    const Pose<double> Q = random_pose(rng, 10.0);
    for (NodeState<double>& at : c.x) at.H = Q * at.H;
    const VecX moved = all_of(c, state_of(c.x, {}));
    worst.add((moved - r).norm() / r.norm());
  }
}

// As a rigid body with its mass matrix is: inertia and gravity of nodes that move as one.
TEST(Component, MovesRigidlyAsARigidBodyDoes) {
  Rng rng(6);
  Worst worst("error over the forces", 1e-12);
  for (int i = 0; i < 20; ++i) {
    Case c = random_case(rng, 3);
    c.data.M_a.resize(0, 0);
    const Mat6 M = rigid_mass(c.data.mass, c.data.static_moment / c.data.mass,
                              Mat3(random_spd(rng, 1.0, 1.0).topLeftCorner<3, 3>()));
    // Any matrix whose rigid part is M: all at node 0, and what rigid motions do not see.
    MatX rigid(18, 6), other = MatX::Identity(18, 18);
    rigid.topRows<6>().setIdentity();
    for (Index k = 1; k < 3; ++k)
      rigid.middleRows<6>(6 * k) =
          adjoint_inverse(c.data.A[static_cast<std::size_t>(k - 1)]).matrix();
    other -= rigid * (rigid.transpose() * rigid).inverse() * rigid.transpose();
    c.M = other * random_semidefinite(rng, 18) * other;
    c.M.topLeftCorner<6, 6>() += M;
    for (Index k = 1; k < 3; ++k) {
      const Pose<double>& A = c.data.A[static_cast<std::size_t>(k - 1)];
      c.x[static_cast<std::size_t>(k)].H = c.x[0].H * A;
      c.x[static_cast<std::size_t>(k)].V = adjoint_inverse(A).matrix() * c.x[0].V;
      c.x[static_cast<std::size_t>(k)].Vdot = adjoint_inverse(A).matrix() * c.x[0].Vdot;
    }
    const VecX r = all_of(c, state_of(c.x, {}));
    const Vec6 sum = rigid.transpose() * r;
    ElementBatch<Mass> body(Mass::name, {});
    body.add({M}, std::array{1}, "body");
    ElementBatch<NodalGravity> weight(NodalGravity::name, {c.gravity});
    weight.add({c.data.mass, c.data.static_moment}, std::array{1}, "weight");
    const State one = state_of({c.x[0]}, {});
    const Vec6 want = residual_of(body, one) + residual_of(weight, one);
    worst.add((sum - want).norm() / want.norm());
    // And momentum, energy of it.
    std::vector<Vec6> p(4, Vec6::Zero()), of_body(2, Vec6::Zero());
    const State state = state_of(c.x, {});
    inertia_of(c).add_momenta(state, p);
    body.add_momenta(one, of_body);
    Vec6 momentum = p[1];
    for (std::size_t k = 1; k < 3; ++k)
      momentum += adjoint_inverse(c.data.A[k - 1]).matrix().transpose() * p[k + 1];
    worst.add((momentum - of_body[1]).norm() / of_body[1].norm());
    const Energies got = batch_of(c).energies(state), a = body.energies(one),
                   b = weight.energies(one);
    worst.add(std::abs(inertia_of(c).energies(state).kinetic - a.kinetic) / a.kinetic);
    worst.add(std::abs(got.potential - b.potential) / std::abs(b.potential));
    worst.add(got.strain);
  }
}

// Poses of frames within are those of the nodes where they are nodes; velocities and accelerations are their differences.
TEST(Component, FramesWithinMoveAsTheirPosesDo) {
  Rng rng(7);
  for (int i = 0; i < 5; ++i) {
    const Case c = random_case(rng, 3);
    const ComponentBatch batch = batch_of(c);
    MatX shapes = MatX::Zero(18, 12);
    shapes.topRows<6>() = 0.3 * random_matrix(rng, 6, 12);
    shapes.bottomRows<12>().setIdentity();
    std::vector<Pose<double>> in{random_pose(rng)};
    in.insert(in.end(), c.data.A.begin(), c.data.A.end());
    const auto at = [&](double t) {
      States x = c.x;
      for (NodeState<double>& node : x) {
        node.H = node.H * exp_se3<double>(t * node.V + 0.5 * t * t * node.Vdot);
        node.V += t * node.Vdot;
      }
      return batch.within(state_of(x, {}), 0, in, shapes, true);
    };
    constexpr double h = 1e-5;
    const auto now = at(0.0), ahead = at(h), behind = at(-h);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec6 V = log_se3<double>(relative(behind[k].H, ahead[k].H)) / (2.0 * h);
      EXPECT_LT((V - now[k].V).norm(), 1e-6 * (1.0 + V.norm()));
      const Vec6 A = (ahead[k].V - behind[k].V) / (2.0 * h);
      EXPECT_LT((A - now[k].Vdot).norm(), 1e-6 * (1.0 + A.norm()));
      if (k == 0) continue;
      EXPECT_LT(log_se3<double>(relative(c.x[k].H, now[k].H)).norm(), 1e-13);
      EXPECT_LT((now[k].V - c.x[k].V).norm(), 1e-12);
      EXPECT_LT((now[k].Vdot - c.x[k].Vdot).norm(), 1e-11);
    }
  }
}

// d/d(load factor) is of gravity alone; a large turn between two of its nodes is out of range, and named.
TEST(Component, LoadsAndRange) {
  Rng rng(8);
  Case c = random_case(rng, 2);
  const ComponentBatch batch = batch_of(c);
  Environment half, whole;
  half.load_factor = 0.5;
  const VecX r0 = residual_of(batch, state_of(c.x, half)),
             r1 = residual_of(batch, state_of(c.x, whole));
  VecX rate = VecX::Zero(18);
  batch.load_rate(state_of(c.x, half), rate);
  EXPECT_LT((rate.tail<12>() - 2.0 * (r1 - r0)).norm(), 1e-12 * r1.norm());
  EXPECT_EQ(batch.out_of_range(state_of(c.x, {})), "");
  c.x[1].H = c.x[0].H * c.data.A[0] * exp_se3<double>(six<double>(Vec3::Zero(), Vec3(0, 0, 3.0)));
  EXPECT_EQ(batch.out_of_range(state_of(c.x, {})), "it");
}

}  // namespace
}  // namespace mbd::test::test_component
