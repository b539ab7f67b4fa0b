#include "elements/component/component_batch.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "libmbd/core/dual.hpp"

namespace mbd {
namespace {

using component::MatX;

Mat6 block_of(const MatX& all, std::size_t a, std::size_t b) {
  if (all.size() == 0) return Mat6::Zero();
  return all.block<6, 6>(6 * static_cast<Index>(a), 6 * static_cast<Index>(b));
}

// Calls f(a, b, node of b, slot) for each pair of nodes.
template <class Part, class F>
void each_block(const Part& part, const F& f) {
  std::size_t slot = part.first_slot;
  for (std::size_t b = 0; b < part.nodes.size(); ++b)
    for (std::size_t a = 0; a < part.nodes.size(); ++a, ++slot)
      f(a, b, static_cast<std::size_t>(part.nodes[b]), slot);
}

// Poses and velocities of frames within a component, on any scalar.
template <class S>
std::vector<NodeState<S>> frames_within(const component::Data& data,
                                        std::span<const NodeState<S>> x,
                                        std::span<const Pose<double>> in, const MatX& shapes) {
  const component::Motion<S> motion(data, x);
  const component::VectorX<S> U = shapes.cast<S>() * motion.u();
  const component::VectorX<S> rate = shapes.cast<S>() * motion.u_rate();
  std::vector<NodeState<S>> all(in.size());
  for (std::size_t k = 0; k < in.size(); ++k) {
    const Vector6<S> own = U.template segment<6>(6 * static_cast<Index>(k));
    const Vector6<S> own_rate = rate.template segment<6>(6 * static_cast<Index>(k));
    const Pose<S> g = in[k].template cast<S>() * exp_se3<S>(own);
    all[k].H = x[0].H * g;
    all[k].V = body_twist<S>(g, x[0].V) + T_times<S>(own, own_rate);
    all[k].Vdot.setZero();
  }
  return all;
}

using NodeStates = std::vector<NodeState<double>>;

NodeStates gather(std::span<const int> nodes, const State& state) {
  NodeStates x;
  for (const int node : nodes) {
    const auto n = static_cast<std::size_t>(node);
    NodeState<double>& at = x.emplace_back();
    at.H = state.pose[n];
    at.V = state.V.empty() ? Vec6(Vec6::Zero()) : state.V[n];
    at.Vdot = state.V.empty() ? Vec6(Vec6::Zero()) : state.Vdot[n];
  }
  return x;
}

template <class Part>
void connect_all(std::vector<Part>& parts, BlockGraph& graph) {
  for (Part& part : parts) {
    part.first_slot = graph.contributions.size();
    for (const int b : part.nodes)
      for (const int a : part.nodes) graph.contributions.push_back({a - 1, b - 1});
  }
}

void add_to(std::span<const int> nodes, const VecX& own, VecX& r) {
  for (std::size_t k = 0; k < nodes.size(); ++k)
    r.segment<6>(6 * nodes[k]) += own.segment<6>(6 * static_cast<Index>(k));
}

}  // namespace

MatX component::inertia_tangent(const MatX& M, std::span<const NodeState<double>> x, double rate,
                                const VecX& p) {
  if (rate != 0.0) return rate * M;
  MatX D = MatX::Zero(M.rows(), M.cols());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto i = 6 * static_cast<Index>(k);
    D.middleRows<6>(i) -= twist_hat<double>(x[k].V).transpose() * M.middleRows<6>(i);
    D.block<6, 6>(i, i) -= wrench_hat<double>(Vec6(p.segment<6>(i)));
  }
  return D;
}

Index ComponentBatch::add(component::Data data, std::vector<int> nodes, std::string who) {
  parts_.push_back({std::move(data), std::move(nodes), std::move(who)});
  return size() - 1;
}

std::size_t ComponentBatch::bytes() const {
  std::size_t sum = sizeof(*this);
  for (const Part& part : parts_) {
    const component::Data& d = part.data;
    const Index numbers = d.K.size() + d.C.size() + d.M_a.size() + d.P.size();
    sum += static_cast<std::size_t>(numbers) * sizeof(double) + sizeof(Part) +
           part.nodes.size() * (sizeof(int) + sizeof(Pose<double>));
  }
  return sum;
}

void ComponentBatch::connect(BlockGraph& graph) { connect_all(parts_, graph); }

Vec3 ComponentBatch::acceleration(const State& state) const {
  return state.load_factor * (gravity_ - BaseMotion::acceleration_of_base(base_, state.signals));
}

template <Want want, class Take>
bool ComponentBatch::run(const State& state, VecX& r, const Take& take) const {
  const Vec3 a = acceleration(state);
  component::Output<double> out;
  bool in_range = true;
  for (const Part& part : parts_) {
    const NodeStates x = gather(part.nodes, state);
    component::Motion<double> motion(part.data, x);
    in_range = motion.residual(a, out.r) > 0.0 && in_range;
    add_to(part.nodes, out.r, r);
    if constexpr (want == Want::tangent) {
      motion.tangent(out);
      take(part, out.K, out.D_V);
    }
  }
  return in_range;
}

bool ComponentBatch::residual(const State& state, VecX& r) const {
  return run<Want::residual>(state, r, [](const Part&, const MatX&, const MatX&) {});
}

bool ComponentBatch::linearize(const State& state, const TangentWeights& weights, VecX& r,
                               std::span<const Slot> slots) const {
  return run<Want::tangent>(state, r, [&](const Part& part, const MatX& K, const MatX& D_V) {
    each_block(part, [&](std::size_t a, std::size_t b, std::size_t node, std::size_t slot) {
      const Mat6 rate = weights.V * block_of(D_V, a, b);
      slots[slot].add(weights.U * block_of(K, a, b) + weights.at_node(rate, node));
    });
  });
}

void ComponentBatch::add_rate_tangent(const State& state, const TangentWeights& weights,
                                      std::span<const Slot> slots) const {
  VecX r = VecX::Zero(6 * static_cast<Index>(state.pose.size()));
  TangentWeights of_rates = weights;
  of_rates.U = 0.0;
  linearize(state, of_rates, r, slots);
}

bool ComponentBatch::linearize_powers(const State& state, std::span<const Mat6> V_hat, VecX& r,
                                      const std::array<std::span<const Slot>, 3>& P) const {
  return run<Want::tangent>(state, r, [&](const Part& part, const MatX& K, const MatX& D_V) {
    each_block(part, [&](std::size_t a, std::size_t b, std::size_t node, std::size_t slot) {
      const Mat6 D = block_of(D_V, a, b);
      P[0][slot].add(block_of(K, a, b) + D * V_hat[node]);
      P[1][slot].add(D);
    });
  });
}

// Only what accelerates all is a load: the residual with it less that without.
void ComponentBatch::load_rate(const State& state, VecX& r) const {
  State whole = state;
  whole.load_factor = 1.0;
  residual(whole, r);
  whole.load_factor = 0.0;
  VecX rest = VecX::Zero(r.size());
  residual(whole, rest);
  r -= rest;
}

std::string ComponentBatch::out_of_range(const State& state) const {
  VecX r;
  for (const Part& part : parts_) {
    const NodeStates x = gather(part.nodes, state);
    if (!(component::Motion<double>(part.data, x).residual(Vec3::Zero(), r) > 0.0)) return part.who;
  }
  return {};
}

Energies ComponentBatch::energies(const State& state) const {
  Energies sum;
  for (const Part& part : parts_) {
    const NodeStates x = gather(part.nodes, state);
    const component::Motion<double> motion(part.data, x);
    sum.strain += 0.5 * motion.u().dot(part.data.K * motion.u());
    const Vec3 moment = part.data.mass * x[0].H.r + x[0].H.p * motion.static_moment();
    sum.potential -= state.load_factor * gravity_.dot(moment);
  }
  return sum;
}

// Of the base's acceleration, on the static moment as it moves.
double ComponentBatch::load_power(const State& state) const {
  if (state.V.empty()) return 0.0;
  const Vec3 a = state.load_factor * BaseMotion::acceleration_of_base(base_, state.signals);
  if (a.isZero(0.0)) return 0.0;
  double sum = 0.0;
  for (const Part& part : parts_) {
    const NodeStates x = gather(part.nodes, state);
    const component::Motion<double> motion(part.data, x);
    const Vec3 s = motion.static_moment(), s_rate = part.data.P * motion.u_rate();
    const Vec3 v = part.data.mass * linear(x[0].V) + angular(x[0].V).cross(s) + s_rate;
    sum -= a.dot(x[0].H.p * v);
  }
  return sum;
}

double ComponentBatch::damping_power(const State& state) const {
  double sum = 0.0;
  if (state.V.empty()) return sum;
  for (const Part& part : parts_) {
    const component::Data& data = part.data;
    const NodeStates x = gather(part.nodes, state);
    if (data.C.size() > 0) {
      const component::Motion<double> motion(data, x);
      sum -= motion.u_rate().dot(data.C * motion.u_rate());
    }
    if (data.M_a.size() == 0) continue;
    const VecX V = component::velocities<double>(x);
    sum -= V.dot(data.M_a * V);
  }
  return sum;
}

double ComponentBatch::largest_turn(const State& state, Index k) const {
  const Part& part = parts_[static_cast<std::size_t>(k)];
  const NodeStates x = gather(part.nodes, state);
  const VecX u = component::Motion<double>(part.data, x).u();
  double largest = 0.0;
  for (Index i = 0; i < u.size(); i += 6) largest = std::max(largest, u.segment<3>(i + 3).norm());
  return largest;
}

std::array<double, 2> ComponentBatch::geometric_shares(const State& state, Index k) const {
  const Part& part = parts_[static_cast<std::size_t>(k)];
  if (part.nodes.size() < 2) return {};
  const NodeStates x = gather(part.nodes, state);
  component::Motion<double> motion(part.data, x);
  VecX r;
  motion.residual(acceleration(state), r);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> shares(
      motion.geometric_stiffness(), part.data.K, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  const VecX& all = shares.eigenvalues();
  return {std::min(0.0, all(0)), std::max(0.0, all(all.size() - 1))};
}

// What linear modes leave out of a bend is of the square of its angle. What forces change of the stiffness they have to about a
// third of it (component.hpp), over what is left of it then; without any left they have buckled, or would.
ComponentBatch::Wrong ComponentBatch::wrong_by(const State& state, Index k) const {
  constexpr double wrong = 1.0 / 3.0;
  Wrong result;
  result.turn = largest_turn(state, k);
  const auto [least, most] = geometric_shares(state, k);
  const double softer = least > -1.0 ? std::min(1.0, -wrong * least / (1.0 + least)) : 1.0;
  const double stiffer = wrong * most / (1.0 + most);
  result.error = std::max({0.5 * result.turn * result.turn, softer, stiffer});
  result.share = softer > stiffer ? least : most;
  return result;
}

std::vector<NodeState<double>> ComponentBatch::within(const State& state, Index k,
                                                      std::span<const Pose<double>> in,
                                                      const MatX& shapes, bool rates) const {
  const Part& part = parts_[static_cast<std::size_t>(k)];
  const NodeStates x = gather(part.nodes, state);
  if (!rates) return frames_within<double>(part.data, x, in, shapes);
  // Along the motion: dH = H V~ dt, dV = Vdot dt.
  using D = Dual<double>;
  std::vector<NodeState<D>> moving;
  for (const NodeState<double>& at : x) {
    NodeState<D>& with = moving.emplace_back();
    const Vec3 v = at.H.p * linear(at.V);
    const Quaternion<double> half(0.0, 0.5 * at.V(3), 0.5 * at.V(4), 0.5 * at.V(5));
    const Quaternion<double> p_rate = at.H.p * half;
    for (Index i = 0; i < 4; ++i) with.H.p.coeffs()(i) = D(at.H.p.coeffs()(i), p_rate.coeffs()(i));
    for (Index i = 0; i < 3; ++i) with.H.r(i) = D(at.H.r(i), v(i));
    for (Index i = 0; i < 6; ++i) with.V(i) = D(at.V(i), at.Vdot(i));
    with.Vdot.setZero();
  }
  std::vector<NodeState<double>> all;
  for (const NodeState<D>& found : frames_within<D>(part.data, moving, in, shapes)) {
    NodeState<double>& at = all.emplace_back();
    for (Index i = 0; i < 4; ++i) at.H.p.coeffs()(i) = found.H.p.coeffs()(i).v;
    for (Index i = 0; i < 3; ++i) at.H.r(i) = found.H.r(i).v;
    for (Index i = 0; i < 6; ++i) at.V(i) = found.V(i).v, at.Vdot(i) = found.V(i).d;
  }
  return all;
}

// --- inertia ---

void ComponentInertia::add(Eigen::MatrixXd M, std::vector<int> nodes) {
  parts_.push_back({std::move(M), std::move(nodes)});
}

std::size_t ComponentInertia::bytes() const {
  std::size_t sum = sizeof(*this);
  for (const Part& part : parts_)
    sum += sizeof(Part) + static_cast<std::size_t>(part.M.size()) * sizeof(double) +
           part.nodes.size() * sizeof(int);
  return sum;
}

void ComponentInertia::connect(BlockGraph& graph) { connect_all(parts_, graph); }

template <Want want, class Take>
void ComponentInertia::run(const State& state, VecX& r, const Take& take) const {
  if (state.V.empty()) return;
  VecX p, own;
  for (const Part& part : parts_) {
    const NodeStates x = gather(part.nodes, state);
    component::inertia_residual<double>(part.M, x, state.momentum_rate, p, own);
    add_to(part.nodes, own, r);
    if constexpr (want == Want::tangent)
      take(part, component::inertia_tangent(part.M, x, state.momentum_rate, p));
  }
}

bool ComponentInertia::residual(const State& state, VecX& r) const {
  run<Want::residual>(state, r, [](const Part&, const MatX&) {});
  return true;
}

bool ComponentInertia::linearize(const State& state, const TangentWeights& weights, VecX& r,
                                 std::span<const Slot> slots) const {
  const double A = state.momentum_rate != 0.0 ? 0.0 : weights.A;
  run<Want::tangent>(state, r, [&](const Part& part, const MatX& D_V) {
    each_block(part, [&](std::size_t a, std::size_t b, std::size_t node, std::size_t slot) {
      const Mat6 rate = weights.V * block_of(D_V, a, b) + A * block_of(part.M, a, b);
      slots[slot].add(weights.at_node(rate, node));
    });
  });
  return true;
}

void ComponentInertia::add_rate_tangent(const State& state, const TangentWeights& weights,
                                        std::span<const Slot> slots) const {
  VecX r = VecX::Zero(6 * static_cast<Index>(state.pose.size()));
  linearize(state, weights, r, slots);
}

bool ComponentInertia::linearize_powers(const State& state, std::span<const Mat6> V_hat, VecX& r,
                                        const std::array<std::span<const Slot>, 3>& P) const {
  run<Want::tangent>(state, r, [&](const Part& part, const MatX& D_V) {
    each_block(part, [&](std::size_t a, std::size_t b, std::size_t node, std::size_t slot) {
      const Mat6 D = block_of(D_V, a, b), M = block_of(part.M, a, b);
      P[0][slot].add(D * V_hat[node]);
      P[1][slot].add(D + M * V_hat[node]);
      P[2][slot].add(M);
    });
  });
  return true;
}

Energies ComponentInertia::energies(const State& state) const {
  Energies sum;
  if (state.V.empty()) return sum;
  for (const Part& part : parts_) {
    const VecX V = component::velocities<double>(gather(part.nodes, state));
    sum.kinetic += 0.5 * V.dot(part.M * V);
  }
  return sum;
}

void ComponentInertia::add_momenta(const State& state, std::span<Vec6> p) const {
  if (state.V.empty()) return;
  for (const Part& part : parts_) {
    const VecX own = part.M * component::velocities<double>(gather(part.nodes, state));
    for (std::size_t k = 0; k < part.nodes.size(); ++k)
      p[static_cast<std::size_t>(part.nodes[k])] += own.segment<6>(6 * static_cast<Index>(k));
  }
}

}  // namespace mbd
