// Joints of one type: gather the two nodes, evaluate, hand over. Once for every type.
#pragma once

#include <vector>

#include "joints/any_joint_batch.hpp"
#include "joints/joint.hpp"
#include "libmbd/core/dual.hpp"

namespace mbd::joint {

template <int rows, int cols>
void add_block(const Slot& slot, const Matrix<double, rows, cols>& block) {
  for (Index c = 0; c < cols; ++c)
    Eigen::Map<Matrix<double, rows, 1>>(slot.data + c * slot.ld) += block.col(c);
}

// The tangents of the two nodes among themselves, U times t carried to them: PP, PQ, QP, QQ.
inline void add_nodes(const Slot* slot, double U, const PairTangent<double>& t, const Mat6& A,
                      const Mat6& B) {
  add_block<6, 6>(slot[0], U * (A.transpose() * t.jj * A));
  add_block<6, 6>(slot[1], U * (A.transpose() * t.jk * B));
  add_block<6, 6>(slot[2], U * (B.transpose() * t.kj * A));
  add_block<6, 6>(slot[3], U * (B.transpose() * t.kk * B));
}

template <Joint J>
class JointBatch final : public AnyJointBatch {
 public:
  static constexpr int m = rows_of<J>;
  static constexpr Law law = J::traits.law;
  static constexpr bool moves_a = law == Law::translation || law == Law::rotation;
  using Rows = Matrix<double, m, 1>;

  struct Data : Definition {
    Mat6 Ad_a, Ad_b;  // adjoints of the inverses of a and b: node increments seen in the frames
  };

  std::vector<RowFacts> rows() const override {
    std::vector<RowFacts> facts;
    each_row<J>([&](const auto& row, Index) { facts.push_back({row.name(), row.is_length}); });
    return facts;
  }
  Traits traits() const override { return J::traits; }

  Index add(const Definition& joint, std::string name) override {
    names_.push_back(std::move(name));
    data_.push_back({joint, adjoint_inverse(joint.a).matrix(), adjoint_inverse(joint.b).matrix()});
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
      const int P = d.P - 1, Q = d.Q - 1, l = nodes + static_cast<int>(d.constraint);
      for (const auto& c :
           {std::pair{P, P}, {P, Q}, {Q, P}, {Q, Q}, {P, l}, {Q, l}, {l, P}, {l, Q}})
        graph.contributions.push_back({c.first, c.second});
    }
  }

  bool residual(const State& state, VecX& r) const override {
    const Index first = r.size() - state.lambda.size();
    bool in_range = true;
    for (const Data& d : data_) {
      const Pose<double> g = relative_pose(state, d);
      const Rows lambda = state.lambda.segment<m>(d.multiplier);
      const Given<double> given = given_of(state, d);
      in_range &= on_branch<J>(g, given);
      add_residual(d, Ad_a(state, d), g, given, wrench<J, double>(g, given, lambda), first, r);
    }
    return in_range;
  }

  bool linearize(const State& state, const TangentWeights& w, VecX& r,
                 std::span<const Slot> slots) const override {
    const Index first = r.size() - state.lambda.size();
    bool in_range = true;
    const Slot* slot = slots.data() + first_slot_;
    for (const Data& d : data_) {
      const Pose<double> g = relative_pose(state, d);
      const Rows lambda = state.lambda.segment<m>(d.multiplier);
      const Given<double> given = given_of(state, d);
      in_range &= on_branch<J>(g, given);
      decltype(auto) A = Ad_a(state, d);
      const Vec6 f = wrench<J, double>(g, given, lambda);
      add_residual(d, A, g, given, f, first, r);

      const Matrix<double, m, 6> G = gradient<J, double>(g, given);
      const PairTangent<double> t =
          joint_tangent(g, f, geometric_stiffness<J, double>(g, given, lambda), has_tension<J>());
      const Mat6 Ad_g = adjoint_inverse(g).matrix();
      const Matrix<double, m, 6> BQ = G * d.Ad_b;
      const Matrix<double, m, 6> BP = -G * Ad_g * A;
      add_nodes(slot, w.U, t, A, d.Ad_b);
      add_block<6, m>(slot[4], BP.transpose());
      add_block<6, m>(slot[5], BQ.transpose());
      add_block<m, 6>(slot[6], BP);
      add_block<m, 6>(slot[7], BQ);
      slot += 8;
    }
    return in_range;
  }

  // Of what is prescribed, s = load factor times its value: ds/d(load factor) is that value.
  void load_rate(const State& state, VecX& r) const override {
    if constexpr (law != Law::none) {
      using D1 = Dual<double>;
      const Index first = r.size() - state.lambda.size();
      for (const Data& d : data_) {
        const auto s = [&](std::size_t i) {
          if (d.signals[i] < 0) return D1{0.0};
          const double f = state.signals[static_cast<std::size_t>(d.signals[i])].f;
          return D1{state.load_factor * f, f};
        };
        const auto still = [&](int node) {
          return state.pose[static_cast<std::size_t>(node)].template cast<D1>();
        };
        Pose<D1> a = d.a.template cast<D1>();
        if constexpr (moves_a) a = a * motion<D1>(s);
        Given<D1> given{D1{0.0}, d.parameter, near_of(state, d)};
        if constexpr (law == Law::coordinate) given.s = s(0);
        const Pose<D1> g = relative(still(d.P) * a, still(d.Q) * d.b.template cast<D1>());
        const Matrix<D1, m, 1> lambda = state.lambda.segment<m>(d.multiplier).template cast<D1>();
        const Vector6<D1> f = wrench<J, D1>(g, given, lambda);
        const Vector6<D1> on_P =
            adjoint_inverse(a).transpose_times(adjoint_inverse(g).transpose_times(f));
        const Vector6<D1> on_Q = adjoint_inverse(d.b.template cast<D1>()).transpose_times(f);
        const Matrix<D1, m, 1> rows = constraint<J, D1>(g, given);
        for (Index i = 0; i < m; ++i) r(first + d.multiplier + i) += rows(i).d;
        for (Index i = 0; i < 6; ++i) {
          r(6 * d.Q + i) += on_Q(i).d;
          r(6 * d.P + i) -= on_P(i).d;
        }
      }
    }
  }

  std::string out_of_range(const State& state) const override {
    for (std::size_t i = 0; i < data_.size(); ++i)
      if (!on_branch<J>(relative_pose(state, data_[i]), given_of(state, data_[i])))
        return names_[i];
    return {};
  }

  // g along H exp(tau V) and t + tau: its value, first and second derivative in tau at 0 are g, gdot and
  // the part of gddot without Vdot.
  void constraint_rates(const State& state, VecX& gdot, VecX& gddot_rest) const override {
    using D2 = Dual<Dual<double>>;
    const D2 tau{Dual<double>{0.0, 1.0}, Dual<double>{1.0, 0.0}};
    for (const Data& d : data_) {
      const auto g = constraint_along(state, d, tau, [](const SignalValue& x) {
        return D2{Dual<double>{x.f, x.fdot}, Dual<double>{x.fdot, x.fddot}};
      });
      for (Index i = 0; i < m; ++i) {
        gdot(d.multiplier + i) = g(i).v.d;
        gddot_rest(d.multiplier + i) = g(i).d.d;
      }
    }
  }

  void constraints(const State& state, VecX& g, VecX& gdot) const override {
    using D1 = Dual<double>;
    for (const Data& d : data_) {
      const auto both = constraint_along(state, d, D1{0.0, 1.0}, [](const SignalValue& x) {
        return D1{x.f, x.fdot};
      });
      for (Index i = 0; i < m; ++i) {
        g(d.multiplier + i) = both(i).v;
        gdot(d.multiplier + i) = both(i).d;
      }
    }
  }

  // The joint exerts -G^T lambda, on what moves with G V = gdot - g_t = -g_t: lambda . g_t.
  double drive_power(const State& state) const override {
    double sum = 0.0;
    if constexpr (law != Law::none) {
      using D1 = Dual<double>;
      for (const Data& d : data_) {
        const auto still = [&](int node) {
          return state.pose[static_cast<std::size_t>(node)].template cast<D1>();
        };
        const auto s = [&](std::size_t i) {
          const SignalValue x = signal(state, d, i);
          return D1{x.f, x.fdot};
        };
        const auto g = constraint_at<D1>(state, d, still(d.P), still(d.Q), s);
        for (Index i = 0; i < m; ++i) sum += state.lambda(d.multiplier + i) * g(i).d;
      }
    }
    return sum;
  }

  void follow_angles(State& state) const override {
    if constexpr (J::traits.angle) {
      for (Index i = 0; i < size(); ++i)
        if (const Index k = data(i).angle; k >= 0)
          state.angles[static_cast<std::size_t>(k)] = angle(state, i);
    }
  }

  double angle(const State& state, Index i) const override {
    const Data& d = data(i);
    return unwrapped_angle<double>(relative_pose(state, d).R(), given_of(state, d).near);
  }
  double displacement(const State& state, Index i) const override {
    const Pose<double> g = relative_pose(state, data(i));
    return (g.R().transpose() * g.r)(2);
  }
  Vec6 relative_velocity(const State& state, Index i) const override {
    const Data& d = data(i);
    const Vec6 Va = Ad_a(state, d) * state.V[static_cast<std::size_t>(d.P)];
    return d.Ad_b * state.V[static_cast<std::size_t>(d.Q)] -
           adjoint_inverse(relative_pose(state, d)) * Va;
  }
  Vec6 reaction(const State& state, Index i) const override {
    const Data& d = data(i);
    return -wrench<J, double>(relative_pose(state, d), given_of(state, d),
                              state.lambda.segment<m>(d.multiplier));
  }

 private:
  // In statics prescribed motions grow with the load; with rates the load factor is 1.
  static SignalValue signal(const State& state, const Data& d, std::size_t i) {
    if (d.signals[i] < 0) return {0.0, 0.0, 0.0};
    SignalValue value = state.signals[static_cast<std::size_t>(d.signals[i])];
    value.f *= state.load_factor;
    return value;
  }
  static double near_of(const State& state, const Data& d) {
    return d.angle < 0 ? 0.0 : state.angles[static_cast<std::size_t>(d.angle)];
  }
  static Given<double> given_of(const State& state, const Data& d) {
    return {law == Law::coordinate ? signal(state, d, 0).f : 0.0, d.parameter, near_of(state, d)};
  }

  // M(t) of a moving frame a; s(i) are the values of the signals.
  template <class S, class F>
  static Pose<S> motion(const F& s) {
    const Vector3<S> x(s(0), s(1), s(2));
    if constexpr (law == Law::translation)
      return {Quaternion<S>(S(1.0), S(0.0), S(0.0), S(0.0)), x};
    else
      return {exp_so3<S>(x), Vector3<S>::Zero()};
  }
  static Pose<double> motion(const State& state, const Data& d) {
    return motion<double>([&](std::size_t i) { return signal(state, d, i).f; });
  }

  static Pose<double> relative_pose(const State& state, const Data& d) {
    Pose<double> a = state.pose[static_cast<std::size_t>(d.P)] * d.a;
    if constexpr (moves_a) a = a * motion(state, d);
    return relative(a, state.pose[static_cast<std::size_t>(d.Q)] * d.b);
  }
  // Node increments of P seen in frame a, where it is now.
  static decltype(auto) Ad_a(const State& state, const Data& d) {
    if constexpr (moves_a)
      return Mat6(adjoint_inverse(motion(state, d)).matrix() * d.Ad_a);
    else
      return static_cast<const Mat6&>(d.Ad_a);
  }
  template <class S, class F>
  static Matrix<S, m, 1> constraint_at(const State& state, const Data& d, const Pose<S>& P,
                                       const Pose<S>& Q, const F& s) {
    Pose<S> a = P * d.a.template cast<S>();
    if constexpr (moves_a) a = a * motion<S>(s);
    Given<S> given{S(0.0), d.parameter, near_of(state, d)};
    if constexpr (law == Law::coordinate) given.s = s(0);
    return constraint<J, S>(relative(a, Q * d.b.template cast<S>()), given);
  }

  // At H exp(tau V), with the signals that `value` makes of theirs.
  template <class S, class F>
  static Matrix<S, m, 1> constraint_along(const State& state, const Data& d, const S& tau,
                                          const F& value) {
    const auto moved = [&](int node) {
      const auto n = static_cast<std::size_t>(node);
      const Vector6<S> V = state.V[n].template cast<S>() * tau;
      return state.pose[n].template cast<S>() * exp_se3<S>(V);
    };
    return constraint_at<S>(state, d, moved(d.P), moved(d.Q),
                            [&](std::size_t i) { return value(signal(state, d, i)); });
  }

  static void add_residual(const Data& d, const Mat6& A, const Pose<double>& g,
                           const Given<double>& given, const Vec6& f, Index first, VecX& r) {
    r.segment<m>(first + d.multiplier) = constraint<J, double>(g, given);
    r.segment<6>(6 * d.Q).noalias() += d.Ad_b.transpose() * f;
    r.segment<6>(6 * d.P).noalias() -= A.transpose() * adjoint_inverse(g).transpose_times(f);
  }

  std::vector<Data> data_;
  std::vector<std::string> names_;
  std::size_t first_slot_ = 0;
};

}  // namespace mbd::joint
