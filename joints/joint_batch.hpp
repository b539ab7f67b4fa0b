// Joints of one type: gather the two nodes, evaluate, hand over. Once for every type.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "joints/any_joint_batch.hpp"
#include "joints/joint.hpp"
#include "libmbd/core/dual.hpp"

namespace mbd::joint {

template <Joint J>
class JointBatch final : public AnyJointBatch {
 public:
  static constexpr int m = static_cast<int>(J::rows.size());
  using Rows = Matrix<double, m, 1>;

  struct Data {
    Pose<double> a, b;     // frames in their nodes: H_P^-1 H_a, H_Q^-1 H_b
    Mat6 Ad_a, Ad_b;       // adjoints of their inverses: node increments seen in the frames
    int P = 0, Q = 0;      // nodes; 0 is the ground
    int signal = -1;       // driven angle
    int block = 0;         // index of the constraint among the System's
    Index multiplier = 0;  // first row in State::lambda
    int angle = -1;        // turn counter, if the angle is followed
  };

  std::span<const Row> rows() const override { return J::rows; }

  Index add(const Pose<double>& a, const Pose<double>& b, int P, int Q, int signal,
            Index constraint, Index multiplier, Index angle) override {
    data_.push_back({a, b, adjoint_inverse(a).matrix(), adjoint_inverse(b).matrix(), P, Q, signal,
                     static_cast<int>(constraint), multiplier, static_cast<int>(angle)});
    return size() - 1;
  }

  std::string_view type() const override { return J::name; }
  Index size() const override { return static_cast<Index>(data_.size()); }
  std::size_t bytes() const override { return data_.size() * sizeof(Data); }
  const Data& data(Index i) const { return data_[static_cast<std::size_t>(i)]; }

  void connect(BlockGraph& graph) override {
    first_slot_ = graph.contributions.size();
    int nodes = 0;
    for (const auto& block : graph.blocks) nodes += block.kind == BlockGraph::Kind::node ? 1 : 0;
    for (const Data& d : data_) {
      const int P = d.P - 1, Q = d.Q - 1, l = nodes + d.block;
      for (const auto& c :
           {std::pair{P, P}, {P, Q}, {Q, P}, {Q, Q}, {P, l}, {Q, l}, {l, P}, {l, Q}})
        graph.contributions.push_back({c.first, c.second});
    }
  }

  bool residual(const State& state, VecX& r) const override {
    const Index first = r.size() - state.lambda.size();
    for (const Data& d : data_) {
      const Pose<double> g = relative_pose(state, d);
      const Rows lambda = state.lambda.segment<m>(d.multiplier);
      const double phi = angle_of(state, d);
      add_residual(d, g, phi, wrench<J, double>(g, phi, lambda), first, r);
    }
    return true;
  }

  bool linearize(const State& state, const TangentWeights& w, VecX& r,
                 std::span<const Slot> slots) const override {
    const Index first = r.size() - state.lambda.size();
    const Slot* slot = slots.data() + first_slot_;
    for (const Data& d : data_) {
      const Pose<double> g = relative_pose(state, d);
      const Rows lambda = state.lambda.segment<m>(d.multiplier);
      const double phi = angle_of(state, d);
      const Vec6 f = wrench<J, double>(g, phi, lambda);
      add_residual(d, g, phi, f, first, r);

      const Matrix<double, m, 6> G = gradient<J, double>(g, phi);
      const PairTangent<double> t =
          pair_tangent(g, f, geometric_stiffness<J, double>(g, phi, lambda));
      const Mat6 Ad_g = adjoint_inverse(g).matrix();
      const Matrix<double, m, 6> BQ = G * d.Ad_b;
      const Matrix<double, m, 6> BP = -G * Ad_g * d.Ad_a;
      add<6, 6>(slot[0], w.U * (d.Ad_a.transpose() * t.jj * d.Ad_a));
      add<6, 6>(slot[1], w.U * (d.Ad_a.transpose() * t.jk * d.Ad_b));
      add<6, 6>(slot[2], w.U * (d.Ad_b.transpose() * t.kj * d.Ad_a));
      add<6, 6>(slot[3], w.U * (d.Ad_b.transpose() * t.kk * d.Ad_b));
      add<6, m>(slot[4], BP.transpose());
      add<6, m>(slot[5], BQ.transpose());
      add<m, 6>(slot[6], BP);
      add<m, 6>(slot[7], BQ);
      slot += 8;
    }
    return true;
  }

  // g along H exp(tau V) and phi(t + tau): its value, first and second derivative in tau at 0 are g, gdot
  // and the part of gddot without Vdot.
  void constraint_rates(const State& state, VecX& gdot, VecX& gddot_rest) const override {
    using D2 = Dual<Dual<double>>;
    const D2 tau{Dual<double>{0.0, 1.0}, Dual<double>{1.0, 0.0}};
    for (const Data& d : data_) {
      const auto moved = [&](int node) {
        const auto n = static_cast<std::size_t>(node);
        const Vector6<D2> V = state.V[n].template cast<D2>() * tau;
        return state.pose[n].template cast<D2>() * exp_se3<D2>(V);
      };
      D2 phi = D2(0.0);
      if (d.signal >= 0) {
        const SignalValue s = state.signals[static_cast<std::size_t>(d.signal)];
        phi = {Dual<double>{s.f, s.fdot}, Dual<double>{s.fdot, s.fddot}};
      }
      const auto g = constraint<J, D2>(
          relative(moved(d.P) * d.a.template cast<D2>(), moved(d.Q) * d.b.template cast<D2>()),
          phi);
      for (Index i = 0; i < m; ++i) {
        gdot(d.multiplier + i) = g(i).v.d;
        gddot_rest(d.multiplier + i) = g(i).d.d;
      }
    }
  }

  void count_turns(const State& before, State& after) const override {
    if constexpr (J::has_angle) {
      for (const Data& d : data_) {
        if (d.angle < 0) continue;
        const double from = principal_angle(before, d), to = principal_angle(after, d);
        after.turns[static_cast<std::size_t>(d.angle)] +=
            static_cast<int>(std::lround((from - to) / (2.0 * std::numbers::pi)));
      }
    }
  }

  double angle(const State& state, Index i) const override {
    const Data& d = data(i);
    const int turns = d.angle < 0 ? 0 : state.turns[static_cast<std::size_t>(d.angle)];
    return principal_angle(state, d) + 2.0 * std::numbers::pi * turns;
  }
  Vec6 relative_velocity(const State& state, Index i) const override {
    const Data& d = data(i);
    const Vec6 Va = d.Ad_a * state.V[static_cast<std::size_t>(d.P)];
    return d.Ad_b * state.V[static_cast<std::size_t>(d.Q)] -
           adjoint_inverse(relative_pose(state, d)) * Va;
  }
  Vec6 reaction(const State& state, Index i) const override {
    const Data& d = data(i);
    return -wrench<J, double>(relative_pose(state, d), angle_of(state, d),
                              state.lambda.segment<m>(d.multiplier));
  }

 private:
  static Pose<double> relative_pose(const State& state, const Data& d) {
    return relative(state.pose[static_cast<std::size_t>(d.P)] * d.a,
                    state.pose[static_cast<std::size_t>(d.Q)] * d.b);
  }
  static double angle_of(const State& state, const Data& d) {
    return d.signal < 0 ? 0.0 : state.signals[static_cast<std::size_t>(d.signal)].f;
  }
  static double principal_angle(const State& state, const Data& d) {
    const Mat3 R = relative_pose(state, d).R();
    return std::atan2(R(1, 0), R(0, 0));
  }
  static void add_residual(const Data& d, const Pose<double>& g, double phi, const Vec6& f,
                           Index first, VecX& r) {
    r.segment<m>(first + d.multiplier) = constraint<J, double>(g, phi);
    r.segment<6>(6 * d.Q).noalias() += d.Ad_b.transpose() * f;
    r.segment<6>(6 * d.P).noalias() -= d.Ad_a.transpose() * adjoint_inverse(g).transpose_times(f);
  }
  template <int rows, int cols>
  static void add(const Slot& slot, const Matrix<double, rows, cols>& block) {
    for (Index c = 0; c < cols; ++c)
      Eigen::Map<Matrix<double, rows, 1>>(slot.data + c * slot.ld) += block.col(c);
  }

  std::vector<Data> data_;
  std::size_t first_slot_ = 0;
};

}  // namespace mbd::joint
