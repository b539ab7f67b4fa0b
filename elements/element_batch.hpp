// Gather -> evaluate -> hand over, once for every element type.
#pragma once

#include <string>
#include <vector>

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

// Base: Batch, or an interface derived from it.
template <Element E, class Base = Batch>
class ElementBatch : public Base {
 public:
  ElementBatch(std::string type, typename E::Shared shared)
      : type_(std::move(type)), shared_(std::move(shared)), n_(E::node_count(shared_)) {}

  // Node indices as in State; the ground (0) is allowed. `name` is for messages.
  void add(const typename E::Data& data, std::span<const int> nodes, std::string name) {
    data_.push_back(data);
    nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
    names_.push_back(std::move(name));
    if constexpr (has_packs<E>) packs_.data.clear();
  }

  // Of an element type that says may_be_offset: its nodes are not those of the batch but fixed in them, at the poses
  // H_node^-1 H_own, one for each node of element e. Rates and increments of its own are Ad(frame^-1) times those of the
  // node, so that r = Ad^T r_own, K = Ad^T K_own Ad, D = Ad^T D_own Ad. An element without pays nothing.
  void set_frames(Index e, std::span<const Pose<double>> frames) requires requires {
    E::may_be_offset;
  }
  {
    offsets_of_.resize(data_.size(), -1);
    offsets_of_[static_cast<std::size_t>(e)] = static_cast<int>(offsets_.size());
    for (const Pose<double>& frame : frames) {
      const bool none = frame.p.vec().isZero(0.0) && frame.r.isZero(0.0);
      offsets_.push_back({frame, adjoint_inverse(frame).matrix(), none});
    }
  }

  std::string_view type() const override { return type_; }
  Index size() const override { return static_cast<Index>(data_.size()); }
  std::size_t bytes() const override {
    return data_.size() * sizeof(typename E::Data) + nodes_.size() * sizeof(int) +
           offsets_.size() * sizeof(Offset) + offsets_of_.size() * sizeof(int) + bytes_of_packs();
  }

  const typename E::Shared& shared() const { return shared_; }
  typename E::Shared& shared() { return shared_; }  // while building
  const typename E::Data& data(Index e) const { return data_[static_cast<std::size_t>(e)]; }

  void connect(BlockGraph& graph) override {
    if constexpr (has_packs<E>) packs_ = E::packed(shared_, data_);
    first_slot_ = graph.contributions.size();
    for (std::size_t e = 0; e < data_.size(); ++e) {
      const int* node = &nodes_[e * static_cast<std::size_t>(n_)];
      for (int b = 0; b < n_; ++b)
        for (int a = 0; a < n_; ++a) graph.contributions.push_back({node[a] - 1, node[b] - 1});
    }
  }

  bool residual(const State& state, VecX& r) const override {
    return run<Want::residual>(state, {}, r, {});
  }
  bool linearize(const State& state, const TangentWeights& weights, VecX& r,
                 std::span<const Slot> slots) const override {
    return run<Want::tangent>(state, weights, r, slots);
  }

  Index resultant_count() const override {
    if constexpr (Mixed<E>) {
      return size() * E::point_count(shared_);
    } else {
      return 0;
    }
  }

  void linearized_resultants(const State& state, std::span<const double> dU,
                             std::span<Vec6> S) const override {
    if constexpr (Mixed<E>) {
      const auto points = static_cast<std::size_t>(E::point_count(shared_));
      NodeStates x;
      Increments U;
      for (std::size_t e = 0; e < data_.size(); ++e) {
        gather(state, e, x);
        gather_increments(dU, e, U);
        E::linearized_resultants(shared_, data_[e], x.data(), U.data(), &S[e * points]);
      }
    }
  }

  bool linearize_mixed(const State& state, std::span<const Vec6> S, VecX& r,
                       std::span<const Slot> slots) const override {
    if constexpr (Mixed<E>) {
      const auto points = static_cast<std::size_t>(E::point_count(shared_));
      typename E::template Output<double> out;
      NodeStates x;
      double margin = 1.0;
      for (std::size_t e = 0; e < data_.size(); ++e) {
        gather(state, e, x);
        const double m = E::evaluate_mixed(shared_, data_[e], x.data(), &S[e * points], out);
        margin = m < margin ? m : margin;
        carry<Want::tangent>(e, out);
        if constexpr (!has_packs<E>) add_residual(out, e, r);
        hand_over(out, e, 1.0, {}, slots);
      }
      if constexpr (has_packs<E>) run_packs(state, r);
      return margin > 0.0;
    } else {
      return linearize(state, {}, r, slots);
    }
  }

  void add_rate_tangent(const State& state, const TangentWeights& weights,
                        std::span<const Slot> slots) const override {
    if constexpr (E::has_D) {
      const Environment env = environment(state);
      typename E::template Output<double> out;
      NodeStates x;
      for (std::size_t e = 0; e < data_.size(); ++e) {
        gather(state, e, x);
        E::template evaluate<Want::tangent>(shared_, data_[e], x.data(), env,
                                            RateWeights{weights.V, weights.A}, out);
        carry<Want::tangent>(e, out);
        hand_over<false>(out, e, 0.0, weights.T_inv, slots);
      }
    }
  }

  bool linearize_powers(const State& state, std::span<const Mat6> V_hat, VecX& r,
                        const std::array<std::span<const Slot>, 3>& P) const override {
    if constexpr (E::has_D) {
      const Environment env = environment(state);
      typename E::template Output<double> by_V, by_A;
      NodeStates x;
      double margin = 1.0;
      for (std::size_t e = 0; e < data_.size(); ++e) {
        gather(state, e, x);
        const double m = E::template evaluate<Want::tangent>(shared_, data_[e], x.data(), env,
                                                             RateWeights{1.0, 0.0}, by_V);
        E::template evaluate<Want::tangent>(shared_, data_[e], x.data(), env, RateWeights{0.0, 1.0},
                                            by_A);
        margin = m < margin ? m : margin;
        carry<Want::tangent>(e, by_V);
        carry<Want::tangent>(e, by_A);
        if constexpr (!has_packs<E>) add_residual(by_V, e, r);
        hand_over(by_V, e, 1.0, V_hat, P[0]);
        hand_over<false>(by_V, e, 0.0, {}, P[1]);
        hand_over<false>(by_A, e, 0.0, V_hat, P[1]);
        hand_over<false>(by_A, e, 0.0, {}, P[2]);
      }
      if constexpr (has_packs<E>) run_packs(state, r);
      return margin > 0.0;
    } else {
      return linearize(state, {}, r, P[0]);
    }
  }

  // Loads are linear in the load factor.
  void load_rate(const State& state, VecX& r) const override {
    if constexpr (requires { E::scales_with_load; }) {
      Environment whole = environment(state), none = whole;
      whole.load_factor = 1.0;
      none.load_factor = 0.0;
      typename E::template Output<double> out, rest;
      NodeStates x;
      for (std::size_t e = 0; e < data_.size(); ++e) {
        gather(state, e, x);
        E::template evaluate<Want::residual>(shared_, data_[e], x.data(), whole, RateWeights{},
                                             out);
        E::template evaluate<Want::residual>(shared_, data_[e], x.data(), none, RateWeights{},
                                             rest);
        const int* node = &nodes_[e * static_cast<std::size_t>(n_)];
        for (int a = 0; a < count(); ++a)
          r.segment<6>(6 * node[a]) += rows_at<6>(out.r, 6 * a) - rows_at<6>(rest.r, 6 * a);
      }
    }
  }

  std::string out_of_range(const State& state) const override {
    const Environment env = environment(state);
    typename E::template Output<double> out;
    for (std::size_t e = 0; e < data_.size(); ++e) {
      NodeStates x;
      gather(state, e, x);
      if (!(E::template evaluate<Want::residual>(shared_, data_[e], x.data(), env, RateWeights{},
                                                 out) > 0.0)) {
        return names_[e];
      }
    }
    return {};
  }

  void law_arguments(const State& state, std::vector<LawArgument>& all) const override {
    if constexpr (requires(const NodeState<double>* x, Environment env) {
                    E::each_law(shared_, data_[0], x, env, [](const Law&, double, ArgumentOf) {});
                  }) {
      const Environment env = environment(state);
      for (std::size_t e = 0; e < data_.size(); ++e) {
        NodeStates x;
        gather(state, e, x);
        E::each_law(shared_, data_[e], x.data(), env,
                    [&](const Law& law, double argument, ArgumentOf of) {
                      all.push_back({&names_[e], &law, argument, of});
                    });
      }
    }
  }

  Energies energies(const State& state) const override {
    Energies sum;
    if constexpr (requires(const NodeState<double>* x, Environment env) {
                    E::energies(shared_, data_[0], x, env);
                  }) {
      const Environment env = environment(state);
      for (std::size_t e = 0; e < data_.size(); ++e) {
        NodeStates x;
        gather(state, e, x);
        const Energies one = E::energies(shared_, data_[e], x.data(), env);
        sum.kinetic += one.kinetic;
        sum.strain += one.strain;
        sum.potential += one.potential;
      }
    }
    return sum;
  }

  void add_momenta(const State& state, std::span<Vec6> p) const override {
    if constexpr (requires(const NodeState<double>* x) { E::momentum(shared_, data_[0], x); }) {
      for (std::size_t e = 0; e < data_.size(); ++e) {
        NodeStates x;
        gather(state, e, x);
        p[static_cast<std::size_t>(nodes_[e])] += E::momentum(shared_, data_[e], x.data());
      }
    }
  }

  double load_power(const State& state) const override {
    double sum = 0.0;
    if constexpr (requires(const NodeState<double>* x, Environment env) {
                    E::load_power(shared_, data_[0], x, env);
                  }) {
      if (state.V.empty()) return 0.0;
      const Environment env = environment(state);
      for (std::size_t e = 0; e < data_.size(); ++e) {
        NodeStates x;
        gather(state, e, x);
        const int* node = &nodes_[e * static_cast<std::size_t>(n_)];
        for (int a = 0; a < count(); ++a)  // residuals of loads do without rates
          x[static_cast<std::size_t>(a)].V = state.V[static_cast<std::size_t>(node[a])];
        sum += E::load_power(shared_, data_[e], x.data(), env);
      }
    }
    return sum;
  }

  double damping_power(const State& state) const override {
    double sum = 0.0;
    if constexpr (requires(const NodeState<double>* x, Environment env) {
                    E::damping_power(shared_, data_[0], x, env);
                  }) {
      const Environment env = environment(state);
      for (std::size_t e = 0; e < data_.size(); ++e) {
        NodeStates x;
        gather(state, e, x);
        sum += E::damping_power(shared_, data_[e], x.data(), env);
      }
    }
    return sum;
  }

  const std::string& name(Index e) const { return names_[static_cast<std::size_t>(e)]; }

  static constexpr int max_nodes = E::template Output<double>::Vector::MaxRowsAtCompileTime / 6;
  using NodeStates = std::array<NodeState<double>, static_cast<std::size_t>(max_nodes)>;
  using Increments = std::array<Vec6, static_cast<std::size_t>(max_nodes)>;

  void gather(const State& state, std::size_t e, NodeStates& x) const {
    const int* node = &nodes_[e * static_cast<std::size_t>(n_)];
    for (int a = 0; a < count(); ++a) {
      const auto A = static_cast<std::size_t>(a);
      const auto k = static_cast<std::size_t>(node[a]);
      x[A].H = state.pose[k];
      if constexpr (E::needs_rates) {
        if (state.V.empty()) {
          x[A].V.setZero();
          x[A].Vdot.setZero();
        } else {
          x[A].V = state.V[k];
          x[A].Vdot = state.Vdot[k];
        }
      }
    }
    if constexpr (may_be_offset)
      if (const Offset* const offset = offsets_of(e)) move(offset, x);
  }

 private:
  static constexpr bool may_be_offset = requires { E::may_be_offset; };
  struct Offset {
    Pose<double> frame;  // H_node^-1 H_own
    Mat6 Ad;             // of its inverse: twists of the node as the element's own
    bool none;           // the identity
  };

  const Offset* offsets_of(std::size_t e) const {
    if (offsets_of_.size() <= e || offsets_of_[e] < 0) return nullptr;
    return &offsets_[static_cast<std::size_t>(offsets_of_[e])];
  }

  [[gnu::noinline]] void move(const Offset* offset, NodeStates& x) const {
    for (int a = 0; a < count(); ++a) {
      if (offset[a].none) continue;
      NodeState<double>& own = x[static_cast<std::size_t>(a)];
      own.H = own.H * offset[a].frame;
      if constexpr (E::needs_rates) {
        own.V = times<double>(offset[a].Ad, own.V);
        own.Vdot = times<double>(offset[a].Ad, own.Vdot);
      }
    }
  }

  void move_increments(const Offset* offset, Increments& U) const {
    for (int a = 0; a < count(); ++a)
      if (!offset[a].none) {
        Vec6& u = U[static_cast<std::size_t>(a)];
        u = times<double>(offset[a].Ad, u);
      }
  }

 protected:
  // Takes what the element made to the nodes of the batch.
  template <Want want>
  void carry(std::size_t e, typename E::template Output<double>& out) const {
    if constexpr (may_be_offset) {
      const Offset* const offset = offsets_of(e);
      if (offset == nullptr) return;
      carry_residual(offset, out);
      if constexpr (want == Want::tangent) {
        if constexpr (E::has_K) carry_square(offset, out.K);
        if constexpr (E::has_D) carry_square(offset, out.D);
      }
    }
  }

 private:
  [[gnu::noinline]] void carry_residual(const Offset* offset,
                                        typename E::template Output<double>& out) const {
    for (int a = 0; a < count(); ++a)
      if (!offset[a].none)
        rows_at<6>(out.r, 6 * a) = Vec6(offset[a].Ad.transpose() * Vec6(rows_at<6>(out.r, 6 * a)));
  }
  template <class Square>
  [[gnu::noinline]] void carry_square(const Offset* offset, Square& K) const {
    for (int a = 0; a < count(); ++a) {
      if (offset[a].none) continue;
      for (int b = 0; b < count(); ++b) {
        const Mat6 row = block_at<6, 6>(K, 6 * a, 6 * b);
        block_at<6, 6>(K, 6 * a, 6 * b) = offset[a].Ad.transpose().lazyProduct(row);
      }
      for (int b = 0; b < count(); ++b) {
        const Mat6 column = block_at<6, 6>(K, 6 * b, 6 * a);
        block_at<6, 6>(K, 6 * b, 6 * a) = column.lazyProduct(offset[a].Ad);
      }
    }
  }
  int count() const { return E::nodes == Eigen::Dynamic ? n_ : E::nodes; }

  static Environment environment(const State& state) {
    return {state.t, state.load_factor, state.signals, state.momentum_rate, state.angles};
  }

  // Where there are packs, all residuals are theirs: the same with and without the tangent.
  // (A template of its own: clang 14 instantiates members whose constraints do not hold, with the class.)
  template <class Of = E>
  bool run_packs(const State& state, VecX& r) const requires has_packs<Of> {
    if (packs_.data.empty() && !data_.empty())  // not yet connected
      return run_packs(state, r, E::packed(shared_, data_));
    return run_packs(state, r, packs_);
  }
  template <class Packs>
  bool run_packs(const State& state, VecX& r, const Packs& packs) const {
    const Environment env = environment(state);
    typename E::Packed::template Output<Pack> out;
    std::array<NodeState<Pack>, static_cast<std::size_t>(max_nodes)> x;
    double margin = 1.0;
    each_pack(0, data_.size(), [&](const PackOf& pack) {
      gather(state, pack, x);
      const double m = smallest_of(E::Packed::template evaluate<Want::residual>(
          packs.shared, packs.data[pack.first / pack_count], x.data(), env, {}, out));
      margin = m < margin ? m : margin;
      add_residuals(out, pack, r);
    });
    return margin > 0.0;
  }

 protected:
  MBD_INLINE void add_residuals(const auto& out, const PackOf& pack, VecX& r) const {
    for (int k = 0; k < pack.count(); ++k) {
      typename E::template Output<double> one;
      one.r.resize(out.r.size());
      for (Index i = 0; i < out.r.size(); ++i) one.r(i) = out.r(i)[k];
      carry<Want::residual>(pack[k], one);
      add_residual(one, pack[k], r);
    }
  }

  const auto& packs() const { return packs_; }  // of a connected batch

  void gather(const State& state, const PackOf& pack,
              std::array<NodeState<Pack>, static_cast<std::size_t>(max_nodes)>& x) const {
    if constexpr (E::needs_rates) {
      for (int a = 0; a < count(); ++a) {
        const auto A = static_cast<std::size_t>(a);
        const auto node = [&](int k) {
          return static_cast<std::size_t>(nodes_[pack[k] * static_cast<std::size_t>(n_) + A]);
        };
        if (state.V.empty()) {
          x[A].V.setZero();
          x[A].Vdot.setZero();
        } else {
          pack_into(x[A].V, [&](int k) { return state.V[node(k)].data(); });
          pack_into(x[A].Vdot, [&](int k) { return state.Vdot[node(k)].data(); });
        }
      }
      static_assert(!may_be_offset);
    }
    std::array<const Pose<double>*, pack_count> H;
    std::array<NodeStates, pack_count> own;  // of elements with offsets
    for (int a = 0; a < count(); ++a) {
      const auto A = static_cast<std::size_t>(a);
      for (int k = 0; k < pack_count; ++k) {
        const auto K = static_cast<std::size_t>(k);
        const std::size_t e = pack[k];
        H[K] = &state.pose[static_cast<std::size_t>(nodes_[e * static_cast<std::size_t>(n_) + A])];
        if constexpr (may_be_offset)
          if (offsets_of(e) != nullptr) {
            if (a == 0) gather(state, e, own[K]);
            H[K] = &own[K][A].H;
          }
      }
      x[A].H = pack_of_poses(
          [&](int k) -> const Pose<double>& { return *H[static_cast<std::size_t>(k)]; });
    }
  }

  // Increments of an element's own nodes, or of those of a pack, of dU as linearized_resultants() has it.
  void gather_increments(std::span<const double> dU, std::size_t e, Increments& U) const {
    const int* node = &nodes_[e * static_cast<std::size_t>(n_)];
    for (int a = 0; a < count(); ++a) {
      Vec6& u = U[static_cast<std::size_t>(a)];
      u.setZero();
      if (!dU.empty() && node[a] > 0)
        u = Eigen::Map<const Vec6>(&dU[6 * static_cast<std::size_t>(node[a] - 1)]);
    }
    if constexpr (may_be_offset)
      if (const Offset* const offset = offsets_of(e)) move_increments(offset, U);
  }
  template <class S>
  void gather_increments(std::span<const double> dU, const PackOf& pack,
                         std::array<Vector6<S>, static_cast<std::size_t>(max_nodes)>& U) const {
    if constexpr (is_pack<S>) {
      std::array<Increments, pack_count> own;
      for (int k = 0; k < pack_count; ++k)
        gather_increments(dU, pack[k], own[static_cast<std::size_t>(k)]);
      for (std::size_t a = 0; a < static_cast<std::size_t>(count()); ++a)
        pack_into(U[a], [&](int k) { return own[static_cast<std::size_t>(k)][a].data(); });
    } else {
      gather_increments(dU, pack.first, U);
    }
  }

 private:
  std::size_t bytes_of_packs() const {
    if constexpr (has_packs<E>)
      return packs_.data.size() * sizeof(packs_.data[0]);
    else
      return 0;
  }

  template <Want want>
  bool run(const State& state, const TangentWeights& weights, VecX& r,
           std::span<const Slot> slots) const {
    bool in_range = true;
    if constexpr (has_packs<E>) {
      in_range = run_packs(state, r);
      if constexpr (want == Want::residual) return in_range;
    }
    const Environment env = environment(state);
    const RateWeights rates{weights.V, weights.A};
    typename E::template Output<double> out;
    NodeStates x;
    double margin = 1.0;
    for (std::size_t e = 0; e < data_.size(); ++e) {
      gather(state, e, x);
      const double m = E::template evaluate<want>(shared_, data_[e], x.data(), env, rates, out);
      margin = m < margin ? m : margin;
      carry<want>(e, out);
      if constexpr (!has_packs<E>) add_residual(out, e, r);
      if constexpr (want == Want::tangent) hand_over(out, e, weights.U, weights.T_inv, slots);
    }
    return in_range && margin > 0.0;
  }

 protected:
  void add_residual(const typename E::template Output<double>& out, std::size_t e, VecX& r) const {
    const int* node = &nodes_[e * static_cast<std::size_t>(n_)];
    for (int a = 0; a < count(); ++a) rows_at<6>(r, 6 * node[a]) += rows_at<6>(out.r, 6 * a);
  }

  // Adds U K + D T_inv of an element to its slots, or D T_inv alone.
  template <bool with_K = E::has_K>
  void hand_over(const typename E::template Output<double>& out, std::size_t e, double U,
                 std::span<const Mat6> T_inv, std::span<const Slot> slots) const {
    const auto n = static_cast<std::size_t>(n_);
    const int* node = &nodes_[e * n];
    const Slot* slot = &slots[first_slot_ + e * n * n];
    for (int b = 0; b < count(); ++b) {
      for (int a = 0; a < count(); ++a, ++slot) {
        Eigen::Map<Mat6, 0, Eigen::OuterStride<>> S(slot->data, Eigen::OuterStride<>(slot->ld));
        if constexpr (with_K) S += U * block_at<6, 6>(out.K, 6 * a, 6 * b);
        if constexpr (E::has_D) {
          if (T_inv.empty()) {
            S += block_at<6, 6>(out.D, 6 * a, 6 * b);
          } else {
            S += block_at<6, 6>(out.D, 6 * a, 6 * b)
                     .lazyProduct(T_inv[static_cast<std::size_t>(node[b])]);
          }
        }
      }
    }
  }

 private:
  std::string type_;
  typename E::Shared shared_;
  int n_;
  std::vector<typename E::Data> data_;
  struct NoPacks {};
  template <class Of>
  struct PacksOf {
    using type = NoPacks;
  };
  template <class Of>
  requires has_packs<Of>
  struct PacksOf<Of> {
    using type = PackedElements<Of>;
  };
  [[no_unique_address]] typename PacksOf<E>::type packs_;
  std::vector<int> nodes_;       // n_ an element
  std::vector<int> offsets_of_;  // by element: the first of its offsets, or -1; as long as needed
  std::vector<Offset> offsets_;  // n_ an element that has any
  std::vector<std::string> names_;
  std::size_t first_slot_ = 0;
};

}  // namespace mbd
