// Packs: functions of packs are those of numbers, and elements and joints evaluated side by side give the same to the last
// bit wherever they stand in their batch. Tried, and seen: by_size (libmbd/core/pack.hpp) without the closed forms of
// single lanes (errors of 0.1 where 1e-14 is allowed); frames of the first pack for all packs of joints.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "elements/beam/beam_elastic_batch.hpp"
#include "joints/any_joint_batch.hpp"
#include "libmbd/core/system.hpp"
#include "tests/support/random.hpp"

namespace {

using namespace mbd;
using test::Rng;

// Of numbers of all sizes: where each branch lies, and its ends.
TEST(Packs, FunctionsAreThoseOfNumbers) {
  Rng rng(1);
  test::Worst worst("functions of packs", 64.0 * test::eps);
  for (int sample = 0; sample < 500; ++sample) {
    std::array<Vec6, pack_count> U, x;
    for (std::size_t k = 0; k < pack_count; ++k) {
      U[k] = test::random_vector<6>(rng);
      U[k].tail<3>() = test::random_angle(rng, 3.1) * test::random_direction(rng);
      x[k] = test::random_vector<6>(rng);
    }
    const PackOf all{0, pack_count};
    const Vector6<Pack> pU = packed(U, all), px = packed(x, all);
    const Pose<Pack> H = exp_se3<Pack>(pU);
    const Vector6<Pack> back = log_se3<Pack>(H), T = T_times<Pack>(pU, px),
                        T_inverse = T_inverse_times<Pack>(pU, px);
    for (int k = 0; k < pack_count; ++k) {
      const auto K = static_cast<std::size_t>(k);
      const Pose<double> one = exp_se3<double>(U[K]);
      const Vec6 values[] = {log_se3<double>(one), T_times<double>(U[K], x[K]),
                             T_inverse_times<double>(U[K], x[K])};
      for (Index i = 0; i < 4; ++i) worst.add(std::abs(H.p.coeffs()(i)[k] - one.p.coeffs()(i)));
      for (Index i = 0; i < 3; ++i) worst.add(std::abs(H.r(i)[k] - one.r(i)));
      // Near pi T and its inverse are large, and the logarithm is as badly conditioned.
      const double size = 1.0 + values[2].norm();
      for (Index i = 0; i < 6; ++i) {
        worst.add(std::abs(T(i)[k] - values[1](i)) / size);
        worst.add(std::abs(T_inverse(i)[k] - values[2](i)) / (size * size));
        worst.add(std::abs(back(i)[k] - values[0](i)) / (size * size));
      }
    }
  }
}

// Residual of all things of a batch, each with rows of its own; `first` of them.
using ResidualOf = std::function<VecX(std::size_t first, std::size_t count)>;

void expect_same_at_every_place(const ResidualOf& residual, std::size_t things, Index rows) {
  std::vector<VecX> alone;
  for (std::size_t e = 0; e < things; ++e) alone.push_back(residual(e, 1));
  for (const std::size_t first : {std::size_t{0}, std::size_t{1}})
    for (std::size_t count = 2; first + count <= things; ++count) {
      const VecX r = residual(first, count);
      for (std::size_t e = 0; e < count; ++e)
        ASSERT_EQ(r.segment(rows * static_cast<Index>(e), rows), alone[first + e])
            << e << " of " << count;
    }
}

class PackedBeams : public testing::TestWithParam<int> {};

TEST_P(PackedBeams, AreTheSameAtEveryPlace) {
  const int order = GetParam();
  const auto nodes = static_cast<std::size_t>(order + 1);
  constexpr std::size_t things = 2 * pack_count + 3;
  Rng rng(static_cast<unsigned>(order));
  std::vector<std::vector<Pose<double>>> reference(things), bent(things);
  std::vector<Mat6> D;
  for (std::size_t e = 0; e < things; ++e) {
    D.push_back(test::random_spd(rng, 100.0, 1.0));
    // Between nodes from next to nothing to half of what may be.
    const double angle = test::log_uniform(rng, 1e-3, 1.4);
    for (std::size_t a = 0; a < nodes; ++a) {
      const double s = static_cast<double>(a) / order;
      const Vec6 along = (Vec6() << 1, 0, 0, 0, 0, 0.1).finished();
      reference[e].push_back(exp_se3<double>(s * along));
      const Vec6 bend =
          test::random_vector<6>(rng, 0.1) + (Vec6() << 0, 0, 0, 0, angle, 0).finished();
      bent[e].push_back(reference[e].back() * exp_se3<double>(s * bend));
    }
  }
  const std::vector<double> J(nodes, 0.5);
  const auto residual = [&](std::size_t first, std::size_t count) {
    System system;
    auto batch = make_beam_elastic(Metric::geodesic, Form::energy, Rule::gauss, order);
    State poses;
    for (std::size_t e = first; e < first + count; ++e) {
      std::vector<int> of;
      for (const Pose<double>& H : reference[e])
        of.push_back(static_cast<int>(system.add_node("node", H)));
      batch->add_element(J, reference[e], of, batch->add_stiffness(D[e]), 0, "element");
      poses.pose.insert(poses.pose.end(), bent[e].begin(), bent[e].end());
    }
    system.add_batch(std::move(batch));
    system.finish(false, 1.0);
    State state = system.reference_state();
    std::copy(poses.pose.begin(), poses.pose.end(), state.pose.begin() + 1);
    VecX r;
    EXPECT_TRUE(system.residual(state, r));
    return VecX(r.tail(r.size() - 6));
  };
  expect_same_at_every_place(residual, things, 6 * (order + 1));
}

INSTANTIATE_TEST_SUITE_P(Orders, PackedBeams, testing::Values(1, 3, 5));

TEST(PackedJoints, AreTheSameAtEveryPlace) {
  constexpr std::size_t things = 2 * pack_count + 3;
  Rng rng(5);
  std::vector<joint::Definition> joints(things);
  std::vector<std::array<Pose<double>, 2>> poses(things);
  std::vector<std::array<Vec6, 2>> V(things);
  std::vector<VecX> lambda;
  for (std::size_t e = 0; e < things; ++e) {
    joints[e].a = test::random_pose(rng);
    joints[e].b = test::random_pose(rng);
    poses[e] = {test::random_pose(rng), test::random_pose(rng)};
    V[e] = {test::random_vector<6>(rng), test::random_vector<6>(rng)};
    lambda.push_back(test::random_vector<5>(rng));
  }
  const auto residual = [&](std::size_t first, std::size_t count) {
    System system;
    auto batch = joint::make_joint_batch("revolute");
    const auto bodies = 2 * static_cast<Index>(count);
    for (Index n = 0; n < bodies; ++n) system.add_node("node", {});
    for (std::size_t e = 0; e < count; ++e) {
      joint::Definition d = joints[first + e];
      d.P = 1 + 2 * static_cast<int>(e);
      d.Q = d.P + 1;
      ConstraintInfo info;
      info.rows = 5;
      info.row_names.assign(5, "row");
      info.is_position.assign(5, false);
      d.constraint = static_cast<Index>(e);
      d.multiplier = system.add_constraint(std::move(info));
      batch->add(d);
    }
    system.add_batch(std::move(batch));
    system.finish(true, 1.0);
    State state = system.reference_state();
    for (std::size_t e = 0; e < count; ++e) {
      for (std::size_t k = 0; k < 2; ++k) {
        state.pose[1 + 2 * e + k] = poses[first + e][k];
        state.V[1 + 2 * e + k] = V[first + e][k];
      }
      state.lambda.segment<5>(5 * static_cast<Index>(e)) = lambda[first + e];
    }
    VecX r, g, gdot, rates, rest;
    system.residual(state, r);
    system.constraints(state, g, gdot);
    system.constraint_rates(state, rates, rest);
    VecX all(27 * static_cast<Index>(count));
    for (std::size_t k = 0; k < count; ++k) {
      const auto e = static_cast<Index>(k);
      all.segment<27>(27 * e) << r.segment<12>(6 + 12 * e), g.segment<5>(5 * e),
          gdot.segment<5>(5 * e), rest.segment<5>(5 * e);
    }
    return all;
  };
  expect_same_at_every_place(residual, things, 27);
}

}  // namespace
