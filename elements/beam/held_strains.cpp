#include "elements/beam/held_strains.hpp"

#include "elements/beam/beam_strips.hpp"
#include "elements/element.hpp"
#include "libmbd/core/dual.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd {
namespace beam {
namespace {

constexpr int most_nodes = Sizes<0>::max_nodes;

template <class Metric>
class HeldStrainsBatch final : public HeldStrains {
 public:
  HeldStrainsBatch(int order, bool give)
      : table_(spectral_table(order, Rule::gauss)),
        order_(order),
        type_((give ? std::string("beam forces of stiff strains, ")
                    : std::string("beam strains held at zero, ")) +
              Metric::name + ", N = " + std::to_string(order)) {}

  Index add_element(std::span<const double> J, std::span<const Pose<double>> reference,
                    std::span<const int> nodes, const StrainSet& held, const Mat6& stiffness,
                    std::span<const Rows> rows, std::span<const Pose<double>> frames,
                    std::string name) override {
    Element e{.data = make_data<Metric, 0>(table_, J, reference, 0, 0),
              .nodes = {nodes.begin(), nodes.end()},
              .held = held,
              .stiffness = stiffness,
              .compliance = {},
              .strains = {},
              .rows = {rows.begin(), rows.end()},
              .frames = {frames.begin(), frames.end()},
              .Ad = {},
              .name = std::move(name)};
    for (int c = 0; c < 6; ++c)
      if (held[static_cast<std::size_t>(c)]) e.strains.push_back(c);
    if (e.gives())
      e.compliance =
          Eigen::MatrixXd(stiffness(e.strains, e.strains))
              .llt()
              .solve(Eigen::MatrixXd::Identity(std::ssize(e.strains), std::ssize(e.strains)));
    for (const Pose<double>& frame : frames) e.Ad.push_back(adjoint_inverse(frame).matrix());
    elements_.push_back(std::move(e));
    return size() - 1;
  }

  std::string_view type() const override { return type_; }
  Index size() const override { return std::ssize(elements_); }
  std::size_t bytes() const override {
    std::size_t sum = elements_.size() * sizeof(Element);
    for (const Element& e : elements_)
      sum += e.nodes.size() * sizeof(int) + e.rows.size() * sizeof(Rows) +
             e.frames.size() * (sizeof(Pose<double>) + sizeof(Mat6));
    return sum;
  }
  const StrainSet& held(Index element) const override { return at(element).held; }
  const Mat6& stiffness(Index element) const override { return at(element).stiffness; }

  void connect(BlockGraph& graph) override {
    first_slot_ = graph.contributions.size();
    int nodes = 0;
    for (const auto& block : graph.blocks) nodes += block.kind == BlockGraph::Kind::node ? 1 : 0;
    for (const Element& e : elements_) {
      for (const int b : e.nodes)
        for (const int a : e.nodes) graph.contributions.push_back({a - 1, b - 1});
      for (int i = 0; i < points(); ++i) {
        const int l = nodes + static_cast<int>(e.rows[static_cast<std::size_t>(i)].constraint);
        for (std::size_t k = 0; k < e.nodes.size(); ++k) {
          const int a = e.nodes[node_of(i, k)];
          graph.contributions.push_back({a - 1, l});
          graph.contributions.push_back({l, a - 1});
        }
        if (e.gives()) graph.contributions.push_back({l, l});
      }
    }
  }

  bool residual(const State& state, VecX& r) const override {
    bool in_range = true;
    for (const Element& e : elements_) {
      Work work;
      in_range &= add_residual(e, state, work, r);
    }
    return in_range;
  }

  bool linearize(const State& state, const TangentWeights& weights, VecX& r,
                 std::span<const Slot> slots) const override {
    bool in_range = true;
    const Slot* slot = slots.data() + first_slot_;
    for (const Element& e : elements_) {
      Work work;
      in_range &= add_residual(e, state, work, r);
      add_stiffness(e, work, weights.U, slot);
      add_gradient(e, work, slot);
    }
    return in_range;
  }

  std::string out_of_range(const State& state) const override {
    for (const Element& e : elements_) {
      Work work;
      work.motion.set(order_, [&](int k) { return pose(e, state, k); });
      if (!(work.motion.margin > 0.0)) return e.name;
    }
    return {};
  }

  // g along H exp(tau V): its value and derivatives in tau at 0.
  void constraints(const State& state, VecX& g, VecX& gdot) const override {
    using D1 = Dual<double>;
    for (const Element& e : elements_)
      each_row_along<D1>(e, state, D1{0.0, 1.0}, [&](Index row, const D1& x) {
        g(row) = x.v;
        gdot(row) = x.d;
      });
    for (const Element& e : elements_)
      each_strain(e, state, [&g](Index row, double strain, double) { g(row) -= strain; });
  }
  void constraint_rates(const State& state, VecX& gdot, VecX& gddot_rest) const override {
    using D2 = Dual<Dual<double>>;
    const D2 tau{Dual<double>{0.0, 1.0}, Dual<double>{1.0, 0.0}};
    for (const Element& e : elements_)
      each_row_along<D2>(e, state, tau, [&](Index row, const D2& x) {
        gdot(row) = x.v.d;
        gddot_rest(row) = x.d.d;
      });
  }

  Energies energies(const State& state) const override {
    Energies sum;
    for (const Element& e : elements_)
      each_strain(e, state,
                  [&sum](Index, double strain, double S) { sum.strain += 0.5 * strain * S; });
    return sum;
  }

  void add_forces(const State& state, Index element, std::span<Vec6> S) const override {
    const Element& e = at(element);
    for (int i = 0; i < points(); ++i) S[static_cast<std::size_t>(i)] += force(e, state, i);
  }
  void add_end_forces(const State& state, Index element, Vec6& first, Vec6& last) const override {
    Work work;
    set(at(element), state, work);
    first += rows_at<6>(work.out.r, 0);
    last += rows_at<6>(work.out.r, 6 * order_);
  }

 private:
  struct Element {
    Data<0> data;
    std::vector<int> nodes;
    StrainSet held;
    Mat6 stiffness;
    Eigen::MatrixXd compliance;  // of the strains
    std::vector<int> strains;
    std::vector<Rows> rows;            // by point
    std::vector<Pose<double>> frames;  // by node, or none
    std::vector<Mat6> Ad;              // of their inverses
    std::string name;

    bool gives() const { return !stiffness.isZero(0.0); }
  };

  // What residual and tangent share.
  struct Work {
    Motion<Metric, 0, double> motion;
    std::array<Vec6, Sizes<0>::max_pairs> W;
    ElementOutput<double, Eigen::Dynamic, most_nodes> out;
  };

  const Element& at(Index element) const { return elements_[static_cast<std::size_t>(element)]; }
  int points() const { return order_; }
  int pairs() const { return order_ * (order_ + 1) / 2; }
  double weight(const Element& e, int point) const {
    return e.data.wJ[static_cast<std::size_t>(point)];
  }

  Pose<double> pose(const Element& e, const State& state, int k) const {
    const auto K = static_cast<std::size_t>(k);
    const Pose<double>& H = state.pose[static_cast<std::size_t>(e.nodes[K])];
    return e.frames.empty() ? H : H * e.frames[K];
  }

  // Of each row of (1) with a compliance: w_i J_i e_c^T C S_i and S_ic.
  template <class F>
  void each_strain(const Element& e, const State& state, const F& is) const {
    if (!e.gives()) return;
    const Index count = e.compliance.rows();
    for (int i = 0; i < points(); ++i) {
      const Index first = e.rows[static_cast<std::size_t>(i)].multiplier;
      for (Index n = 0; n < count; ++n) {
        double strain = 0.0;
        for (Index m = 0; m < count; ++m) strain += e.compliance(n, m) * state.lambda(first + m);
        is(first + n, weight(e, i) * strain, state.lambda(first + n));
      }
    }
  }

  // (2) at a point: what is not held is zero.
  Vec6 force(const Element& e, const State& state, int point) const {
    Vec6 S = Vec6::Zero();
    Index row = e.rows[static_cast<std::size_t>(point)].multiplier;
    for (const int c : e.strains) S(c) = state.lambda(row++);
    return S;
  }

  // Nodal forces in axes of the element's own nodes. Not inlined: the same to the last bit with and without the tangent.
  [[gnu::noinline]] void set(const Element& e, const State& state, Work& work) const {
    work.motion.set(order_, [&](int k) { return pose(e, state, k); });
    std::array<Vec6, Sizes<0>::max_points> weighted;
    for (int i = 0; i < points(); ++i)
      weighted[static_cast<std::size_t>(i)] = weight(e, i) * force(e, state, i);
    assemble_pairs<0, double>(e.data, order_, points(), work.motion, weighted, work.W, work.out);
  }

  [[gnu::noinline]] bool add_residual(const Element& e, const State& state, Work& work,
                                      VecX& r) const {
    set(e, state, work);
    for (std::size_t a = 0; a < e.nodes.size(); ++a) {
      Vec6 f = rows_at<6>(work.out.r, 6 * static_cast<Index>(a));
      if (!e.Ad.empty()) f = Vec6(e.Ad[a].transpose() * f);
      rows_at<6>(r, 6 * e.nodes[a]) += f;
    }
    const Index first = r.size() - state.lambda.size();
    for (int i = 0; i < points(); ++i) {
      const auto I = static_cast<std::size_t>(i);
      const Vec6 E = curvature<0, double>(e.data, i, pairs(), work.motion.q) - e.data.K0[I];
      Index row = first + e.rows[I].multiplier;
      for (const int c : e.strains) r(row++) += weight(e, i) * E(c);
    }
    each_strain(e, state, [&](Index row, double strain, double) { r(first + row) -= strain; });
    return work.motion.margin > 0.0;
  }

  void add_stiffness(const Element& e, Work& work, double U, const Slot*& slot) const {
    std::array<DualMatrix<double>, Sizes<0>::max_pairs> T;
    for (std::size_t p = 0; p < static_cast<std::size_t>(pairs()); ++p)
      T[p] = work.motion.pair[p].T_inverse();
    auto& K = work.out.K;
    K.setZero(6 * (order_ + 1), 6 * (order_ + 1));
    add_geometric_stiffness<0, double>(order_, work.motion, T, work.W, K);
    for (std::size_t b = 0; b < e.nodes.size(); ++b)
      for (std::size_t a = 0; a < e.nodes.size(); ++a, ++slot) {
        Mat6 block = block_at<6, 6>(K, 6 * static_cast<Index>(a), 6 * static_cast<Index>(b));
        if (!e.Ad.empty()) block = Mat6(e.Ad[a].transpose() * block * e.Ad[b]);
        slot->add(U * block);
      }
  }

  // A point's nodes in the order in which solvers are to join its rows to them: first that behind it, whose place follows from the
  // strain there and the nodes before. (Any other may be one that the strain hardly knows.)
  std::size_t node_of(int point, std::size_t k) const {
    return (static_cast<std::size_t>(point) + 1 + k) % static_cast<std::size_t>(order_ + 1);
  }

  // (1), by points and nodes.
  void add_gradient(const Element& e, const Work& work, const Slot*& slot) const {
    std::array<DualMatrix<double>, Sizes<0>::max_pairs> T;
    for (std::size_t p = 0; p < static_cast<std::size_t>(pairs()); ++p)
      T[p] = work.motion.pair[p].T_inverse();
    for (int i = 0; i < points(); ++i) {
      std::array<DualMatrix<double>, static_cast<std::size_t>(most_nodes)> B;
      for (DualMatrix<double>& one : B) one = {Mat3::Zero(), Mat3::Zero()};
      std::size_t p = 0;
      for (std::size_t j = 0; j < e.nodes.size(); ++j)
        for (std::size_t k = j + 1; k < e.nodes.size(); ++k, ++p) {
          const double c =
              weight(e, i) * e.data.c[static_cast<std::size_t>(i * Sizes<0>::max_pairs) + p];
          B[k].A += c * T[p].A;
          B[k].B += c * T[p].B;
          B[j].A -= c * T[p].A.transpose();
          B[j].B -= c * T[p].B.transpose();
        }
      for (std::size_t k = 0; k < e.nodes.size(); ++k) {
        const std::size_t a = node_of(i, k);
        Mat6 all = B[a].matrix();
        if (!e.Ad.empty()) all = Mat6(all * e.Ad[a]);
        Index n = 0;
        for (const int c : e.strains) {
          for (Index q = 0; q < 6; ++q) {
            slot[0].data[n * slot[0].ld + q] += all(c, q);
            slot[1].data[q * slot[1].ld + n] += all(c, q);
          }
          ++n;
        }
        slot += 2;
      }
      if (!e.gives()) continue;
      for (Index n = 0; n < e.compliance.cols(); ++n)
        for (Index m = 0; m < e.compliance.rows(); ++m)
          slot->data[n * slot->ld + m] -= weight(e, i) * e.compliance(m, n);
      ++slot;
    }
  }

  template <class S, class F>
  void each_row_along(const Element& e, const State& state, const S& tau, const F& row_is) const {
    Motion<Metric, 0, S> motion;
    std::array<Pose<S>, static_cast<std::size_t>(most_nodes)> H;
    for (std::size_t k = 0; k < e.nodes.size(); ++k) {
      const auto n = static_cast<std::size_t>(e.nodes[k]);
      const Vector6<S> moved = state.V[n].template cast<S>() * tau;
      H[k] = state.pose[n].template cast<S>() * exp_se3<S>(moved);
      if (!e.frames.empty()) H[k] = H[k] * e.frames[k].template cast<S>();
    }
    motion.set(order_, [&H](int k) -> const Pose<S>& { return H[static_cast<std::size_t>(k)]; });
    for (int i = 0; i < points(); ++i) {
      const auto I = static_cast<std::size_t>(i);
      const Vector6<S> E =
          curvature<0, S>(e.data, i, pairs(), motion.q) - e.data.K0[I].template cast<S>();
      Index row = e.rows[I].multiplier;
      for (const int c : e.strains) row_is(row++, S(weight(e, i)) * E(c));
    }
  }

  SpectralTable table_;
  int order_;
  std::string type_;
  std::vector<Element> elements_;
  std::size_t first_slot_ = 0;
};

}  // namespace
}  // namespace beam

std::unique_ptr<HeldStrains> make_held_strains(Metric metric, int order, bool give) {
  switch (metric) {
    case Metric::matrix:
      return std::make_unique<beam::HeldStrainsBatch<MatrixMetric>>(order, give);
    case Metric::quaternion:
      return std::make_unique<beam::HeldStrainsBatch<QuaternionMetric>>(order, give);
    case Metric::geodesic:
      break;
  }
  return std::make_unique<beam::HeldStrainsBatch<GeodesicMetric>>(order, give);
}

}  // namespace mbd
