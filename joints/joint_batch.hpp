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

// may_pack: code on packs of instructions that a program does without must not meet the library's own, for one
// processor, under the same names.
template <Joint J, bool may_pack = true>
class JointBatch final : public AnyJointBatch {
 public:
  static constexpr int m = rows_of<J>;
  static constexpr Law law = J::traits.law;
  static constexpr bool moves_a = law == Law::translation || law == Law::rotation;
  using Rows = Matrix<double, m, 1>;

  // Whether joints are evaluated a pack at a time: those with parameters of their own or laws of time are few.
  static constexpr bool packed = may_pack && law == Law::none && !has_tension<J>() &&
                                 count_of<J, row::Advance>() == 0 &&
                                 count_of<J, row::Distance>() == 0;

  using Data = Definition;

  std::vector<RowFacts> rows() const override {
    std::vector<RowFacts> facts;
    each_row<J>([&](const auto& row, Index) { facts.push_back({row.name(), row.is_length}); });
    return facts;
  }
  Traits traits() const override { return J::traits; }

  Index add(const Definition& joint, std::string name) override {
    names_.push_back(std::move(name));
    data_.push_back(joint);
    if constexpr (packed) {
      const std::size_t lane = (data_.size() - 1) % pack_count;
      if (lane == 0) frames_.emplace_back();
      const PackOf pack{data_.size() - 1 - lane, data_.size()};
      const auto of = [&](Pose<double> Definition::*frame) {
        return pack_of_poses([&](int k) -> const Pose<double>& { return data_[pack[k]].*frame; });
      };
      frames_.back() = {of(&Definition::a), of(&Definition::b)};
    }
    return size() - 1;
  }

  std::string_view type() const override { return J::name; }
  Index size() const override { return static_cast<Index>(data_.size()); }
  std::size_t bytes() const override {
    return data_.size() * sizeof(Data) + frames_.size() * sizeof(Frames);
  }
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
    if constexpr (packed) {
      each_pack(0, data_.size(), [&](const PackOf& pack) {
        Place<Pack> place;
        Forces<Pack> f;
        in_range &= evaluate_pack(state, pack, place, f);
        add_residual(pack, f, first, r);
      });
    } else {
      for (const Data& d : data_) {
        const Given<double> given = given_of(state, d);
        const Pose<double> a = frame_a(state, d);
        Place<double> place;
        Forces<double> f;
        in_range &= evaluate<double>(pose(state, d.P), pose(state, d.Q), a, d.b, given,
                                     state.lambda.segment<m>(d.multiplier), place, f);
        add_residual(d, f, first, r);
      }
    }
    return in_range;
  }

  bool linearize(const State& state, const TangentWeights& w, VecX& r,
                 std::span<const Slot> slots) const override {
    const Index first = r.size() - state.lambda.size();
    bool in_range = true;
    const Slot* slot = slots.data() + first_slot_;
    if constexpr (packed) {
      each_pack(0, data_.size(), [&](const PackOf& pack) {
        Place<Pack> place;
        Forces<Pack> f;
        in_range &= evaluate_pack(state, pack, place, f);
        add_residual(pack, f, first, r);
        add_tangent(pack, place, f, w.U, slot + 8 * pack.first);
      });
      return in_range;
    }
    for (const Data& d : data_) {
      const Given<double> given = given_of(state, d);
      const Pose<double> a = frame_a(state, d);
      Place<double> place;
      Forces<double> f;
      const Rows lambda = state.lambda.segment<m>(d.multiplier);
      in_range &=
          evaluate<double>(pose(state, d.P), pose(state, d.Q), a, d.b, given, lambda, place, f);
      add_residual(d, f, first, r);

      const Pose<double>& g = place.g;
      const Mat6 A = adjoint_inverse(a).matrix(), Ad_b = adjoint_inverse(d.b).matrix();
      const Matrix<double, m, 6> G = gradient<J, double>(g, given);
      const PairTangent<double> t =
          joint_tangent(g, f.f, geometric_stiffness<J, double>(g, given, lambda), has_tension<J>());
      const Mat6 Ad_g = adjoint_inverse(g).matrix();
      const Matrix<double, m, 6> BQ = G * Ad_b;
      const Matrix<double, m, 6> BP = -G * Ad_g * A;
      add_nodes(slot, w.U, t, A, Ad_b);
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
      if (!on_branch<J, double>(relative_pose(state, data_[i]), given_of(state, data_[i])))
        return names_[i];
    return {};
  }

  // g along H exp(tau V) and t + tau: its value, first and second derivative in tau at 0 are g, gdot and
  // the part of gddot without Vdot. Without laws of time they are sums over rows (evaluate_rates).
  void constraint_rates(const State& state, VecX& gdot, VecX& gddot_rest) const override {
    if constexpr (packed) {
      each_row_of_packs(state, true, [&](Index row, const Rates<Pack>& rates, Index i, int k) {
        gdot(row) = rates.gdot(i)[k];
        gddot_rest(row) = rates.gddot_rest(i)[k];
      });
      return;
    }
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
    if constexpr (packed) {
      each_row_of_packs(state, false, [&](Index row, const Rates<Pack>& rates, Index i, int k) {
        g(row) = rates.g(i)[k];
        gdot(row) = rates.gdot(i)[k];
      });
      return;
    }
    using D1 = Dual<double>;
    if constexpr (!moves_a) {
      for (const Data& d : data_) {
        const Given<double> given = given_of(state, d);
        Rates<double> rates;
        set_rates<double>(pose(state, d.P), pose(state, d.Q), d.a, d.b,
                          state.V[static_cast<std::size_t>(d.P)],
                          state.V[static_cast<std::size_t>(d.Q)], given, false, rates);
        if constexpr (law == Law::coordinate) {  // g_t
          const SignalValue s = signal(state, d, 0);
          const Given<D1> moving{D1{s.f, s.fdot}, d.parameter, given.near};
          const auto by_s = constraint<J, D1>(rates.place.template cast<D1>(), moving);
          for (Index i = 0; i < m; ++i) rates.gdot(i) += by_s(i).d;
        }
        g.segment<m>(d.multiplier) = rates.g;
        gdot.segment<m>(d.multiplier) = rates.gdot;
      }
      return;
    }
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
    const Vec6 Va = body_twist<double>(frame_a(state, d), state.V[static_cast<std::size_t>(d.P)]);
    return body_twist<double>(d.b, state.V[static_cast<std::size_t>(d.Q)]) -
           body_twist<double>(relative_pose(state, d), Va);
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

  static const Pose<double>& pose(const State& state, int node) {
    return state.pose[static_cast<std::size_t>(node)];
  }
  // Frame a in its node, where it is now.
  static Pose<double> frame_a(const State& state, const Data& d) {
    if constexpr (moves_a)
      return d.a * motion(state, d);
    else
      return d.a;
  }
  static Pose<double> relative_pose(const State& state, const Data& d) {
    return relative(pose(state, d.P) * frame_a(state, d), pose(state, d.Q) * d.b);
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

  // A joint, or a pack of them, between nodes at P and Q with frames at a and b in them.
  template <class S>
  struct Place {
    Pose<S> g;  // of b in a
    Pose<S>
        b_in_P;  // a g, from positions themselves: forces on P and Q are in balance to round-off
    Pose<S> b;
    Given<S> given;
  };
  template <class S>
  struct Forces {
    Matrix<S, m, 1> rows;   // the constraint
    Vector6<S> f;           // on b
    Vector6<S> on_P, on_Q;  // in the residual
    StiffnessSum<S> stiffness;
  };

  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline, gnu::flatten]] static bool evaluate(const Pose<S>& P, const Pose<S>& Q,
                                                       const Pose<S>& a, const Pose<S>& b,
                                                       const Given<S>& given,
                                                       const Matrix<S, m, 1>& lambda,
                                                       Place<S>& place, Forces<S>& f) {
    const Pose<S> at_b = Q * b;
    place.g = relative<S>(P * a, at_b);
    place.b_in_P = relative<S>(P, at_b);
    place.b = b;
    place.given = given;
    f.rows = constraint<J, S>(place.g, given);
    f.f = wrench<J, S>(place.g, given, lambda);
    f.on_Q = inertial_wrench<S>(b, f.f);
    if constexpr (moves_a)  // what is prescribed may be far: first to the frame that moves with it
      f.on_P = -inertial_wrench<S>(a, inertial_wrench<S>(place.g, f.f));
    else
      f.on_P = -inertial_wrench<S>(place.b_in_P, f.f);
    if constexpr (packed) {
      const RowPlace<S> at(place.g, given);
      f.stiffness = {};
      each_row<J>([&](const auto& row, Index n) { row.add_stiffness(at, lambda(n), f.stiffness); });
    }
    return on_branch<J, S>(place.g, given);
  }

  void gather(const State& state, const PackOf& pack, Pose<Pack>& P, Pose<Pack>& Q) const {
    const auto at = [&](int Definition::*node) {
      return pack_of_poses(
          [&](int k) -> const Pose<double>& { return pose(state, data_[pack[k]].*node); });
    };
    P = at(&Definition::P);
    Q = at(&Definition::Q);
  }

  bool evaluate_pack(const State& state, const PackOf& pack, Place<Pack>& place,
                     Forces<Pack>& f) const {
    Pose<Pack> P, Q;
    gather(state, pack, P, Q);
    Matrix<Pack, m, 1> lambda;
    pack_into(lambda, [&](int k) { return state.lambda.data() + data_[pack[k]].multiplier; });
    const Frames& frames = frames_[pack.first / pack_count];
    return evaluate<Pack>(P, Q, frames.a, frames.b, {}, lambda, place, f);
  }

  static void add_residual(const Data& d, const Forces<double>& f, Index first, VecX& r) {
    r.segment<m>(first + d.multiplier) = f.rows;
    r.segment<6>(6 * d.Q) += f.on_Q;
    r.segment<6>(6 * d.P) += f.on_P;
  }
  void add_residual(const PackOf& pack, const Forces<Pack>& f, Index first, VecX& r) const {
    for (int k = 0; k < pack.count(); ++k) {
      const Data& d = data_[pack[k]];
      for (Index i = 0; i < m; ++i) r(first + d.multiplier + i) = f.rows(i)[k];
      for (Index i = 0; i < 6; ++i) r(6 * d.Q + i) += f.on_Q(i)[k];
      for (Index i = 0; i < 6; ++i) r(6 * d.P + i) += f.on_P(i)[k];
    }
  }

  // Of rows without tension, with C = Ad((a g)^-1) = [R X; 0 R], B = Ad(b^-1), L = [0 0; n~ c] and f^U = [0 n~; n~ m~]:
  //   QQ: B^T L B,   QP: -B^T L C,   PQ: -C^T (L - f^U) B,   PP: C^T (L - f^U) C,   of which the upper left quarters are 0.
  template <class S>
  struct NodeTangent {
    Matrix3<S> PP_right, PP, PQ_right, PQ, QP_left, QP, QQ_left,
        QQ;                  // upper right, lower right; lower left
    Matrix<S, 6, m> BP, BQ;  // transposed gradients
  };
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void set_tangent(const Place<S>& place, const Forces<S>& f,
                                                          const S& U, NodeTangent<S>& t) {
    const RowPlace<S> at(place.g, place.given);
    const DualMatrix<S> B = adjoint_inverse<S>(place.b), C = adjoint_inverse<S>(place.b_in_P);
    const Matrix3<S> n = U * hat(linear(f.f)), L = U * f.stiffness.turning + n * hat(at.x_b),
                     M = L - U * hat(angular(f.f));
    const auto by_L = [&](const DualMatrix<S>& right, Matrix3<S>& lower_left, Matrix3<S>& lower) {
      lower_left = B.A.transpose() * Matrix3<S>(n * right.A);
      lower = B.A.transpose() * Matrix3<S>(n * right.B + L * right.A);
    };
    const auto by_M = [&](const DualMatrix<S>& right, Matrix3<S>& upper, Matrix3<S>& lower) {
      const Matrix3<S> nR = n * right.A;
      upper = C.A.transpose() * nR;
      lower = C.B.transpose() * nR - C.A.transpose() * Matrix3<S>(M * right.A);
    };
    by_L(B, t.QQ_left, t.QQ);
    by_L(C, t.QP_left, t.QP);
    by_M(B, t.PQ_right, t.PQ);
    by_M(C, t.PP_right, t.PP);
    each_row<J>([&](const auto& row, Index i) {
      Vector3<S> u, psi;
      row.gradient(at, u, psi);
      const Vector6<S> G = six<S>(u, psi);
      t.BQ.col(i) = inertial_wrench<S>(place.b, G);
      t.BP.col(i) = -inertial_wrench<S>(place.b_in_P, G);
    });
  }

  static void add_part(const Slot& slot, Index row, Index column, const Matrix3<Pack>& part, int k,
                       double sign) {
    for (Index c = 0; c < 3; ++c)
      for (Index i = 0; i < 3; ++i)
        slot.data[row + i + (column + c) * slot.ld] += sign * part(i, c)[k];
  }
  void add_tangent(const PackOf& pack, const Place<Pack>& place, const Forces<Pack>& f, double U,
                   const Slot* slot) const {
    NodeTangent<Pack> t;
    set_tangent<Pack>(place, f, U, t);
    for (int k = 0; k < pack.count(); ++k, slot += 8) {
      add_part(slot[0], 0, 3, t.PP_right, k, -1.0);
      add_part(slot[0], 3, 3, t.PP, k, -1.0);
      add_part(slot[1], 0, 3, t.PQ_right, k, 1.0);
      add_part(slot[1], 3, 3, t.PQ, k, 1.0);
      add_part(slot[2], 3, 0, t.QP_left, k, -1.0);
      add_part(slot[2], 3, 3, t.QP, k, -1.0);
      add_part(slot[3], 3, 0, t.QQ_left, k, 1.0);
      add_part(slot[3], 3, 3, t.QQ, k, 1.0);
      for (Index i = 0; i < m; ++i)
        for (Index c = 0; c < 6; ++c) {
          const double P = t.BP(c, i)[k], Q = t.BQ(c, i)[k];
          slot[4].data[c + i * slot[4].ld] += P;
          slot[5].data[c + i * slot[5].ld] += Q;
          slot[6].data[i + c * slot[6].ld] += P;
          slot[7].data[i + c * slot[7].ld] += Q;
        }
    }
  }

  template <class S>
  struct Rates {
    Pose<S> place;
    Matrix<S, m, 1> g, gdot, gddot_rest;
  };
  // With w = Ad((a g)^-1) V_P, the velocity of P at b, and z = Ad(b^-1) V_Q - w, g changes by z, and w by -z~ w while V
  // stays: gdot = G z, and without Vdot gddot = z^T L z + G z~ w.
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void set_rates(
      const Pose<S>& P, const Pose<S>& Q, const Pose<S>& a, const Pose<S>& b, const Vector6<S>& V_P,
      const Vector6<S>& V_Q, const Given<S>& given, bool second, Rates<S>& rates) {
    const Pose<S> at_b = Q * b, g = relative<S>(P * a, at_b);
    rates.place = g;
    const Vector6<S> w = body_twist<S>(relative<S>(P, at_b), V_P), z = body_twist<S>(b, V_Q) - w;
    rates.g = constraint<J, S>(g, given);
    const Matrix<S, m, 6> G = gradient<J, S>(g, given);
    const auto along = [&](const Vector6<S>& x, Matrix<S, m, 1>& to) {
      for (Index i = 0; i < m; ++i) {
        S sum = S(0.0);
        for (Index c = 0; c < 6; ++c) sum += G(i, c) * x(c);
        to(i) = sum;
      }
    };
    along(z, rates.gdot);
    if (!second) return;
    const Vector3<S> zu = linear(z), zp = angular(z), wu = linear(w), wp = angular(w);
    along(six<S>(zp.cross(wu) + zu.cross(wp), zp.cross(wp)), rates.gddot_rest);
    rates.gddot_rest += curvature_along<J, S>(g, given, z);
  }
  // put(row of g, rates, i, lane) for the rows i of all joints.
  template <class Put>
  void each_row_of_packs(const State& state, bool second, const Put& put) const {
    each_pack(0, data_.size(), [&](const PackOf& pack) {
      Rates<Pack> rates;
      evaluate_rates(state, pack, second, rates);
      for (int k = 0; k < pack.count(); ++k)
        for (Index i = 0; i < m; ++i) put(data_[pack[k]].multiplier + i, rates, i, k);
    });
  }
  void evaluate_rates(const State& state, const PackOf& pack, bool second,
                      Rates<Pack>& rates) const {
    Pose<Pack> P, Q;
    gather(state, pack, P, Q);
    Vector6<Pack> V_P, V_Q;
    const auto V = [&](int node) { return state.V[static_cast<std::size_t>(node)].data(); };
    pack_into(V_P, [&](int k) { return V(data_[pack[k]].P); });
    pack_into(V_Q, [&](int k) { return V(data_[pack[k]].Q); });
    const Frames& frames = frames_[pack.first / pack_count];
    set_rates<Pack>(P, Q, frames.a, frames.b, V_P, V_Q, {}, second, rates);
  }

  struct Frames {
    Pose<Pack> a, b;
  };

  std::vector<Data> data_;
  std::vector<Frames> frames_;  // of packs; empty where there are none
  std::vector<std::string> names_;
  std::size_t first_slot_ = 0;
};

}  // namespace mbd::joint
