#include "solvers/time/stabilized_index2.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/newton/increments.hpp"

namespace mbd {
namespace {

Quaternion<double> quaternion(const double* p) { return {p[0], p[1], p[2], p[3]}; }
void put(const Quaternion<double>& q, double* p) {
  p[0] = q.w(), p[1] = q.x(), p[2] = q.y(), p[3] = q.z();
}

Vec3 vector(const double* x) { return {x[0], x[1], x[2]}; }

using Block = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
Block block(const Slot& slot, int rows, int columns) {
  return {slot.data, rows, columns, Eigen::OuterStride<>(slot.ld)};
}

}  // namespace

StabilizedIndex2::StabilizedIndex2(const System& system, std::unique_ptr<LinearSolver> solver)
    : system_(system),
      solver_(std::move(solver)),
      nodes_(system.nodes() - 1),
      size_(per_node * nodes_ + 2 * system.multipliers()),
      length_(system.length_scale()) {
  solver_->analyze(lay_out(system.graph()));

  find_joints();

  at_ = system.reference_state();
  mu_state_ = at_;
  const auto n = static_cast<std::size_t>(system.nodes());
  norm_.assign(n, 1.0);
  rate_.assign(n, Vec6::Zero());
  q0_.assign(n, 0.0);
  x_.resize(12 * nodes_ + 2 * system.multipliers());
  for (const ConstraintInfo& c : system.constraints()) first_row_.push_back(c.first_row);
  color_nodes();
}

// Blocks: dU of the nodes, dV of the nodes, dlambda, dmu; rows: (1), (3), gdot, g.
BlockGraph StabilizedIndex2::lay_out(const BlockGraph& graph) {
  const auto nodes = static_cast<int>(nodes_);
  const int constraints = static_cast<int>(graph.blocks.size()) - nodes;
  BlockGraph all;
  all.blocks.assign(static_cast<std::size_t>(2 * nodes), {6, BlockGraph::Kind::node});
  for (int copy = 0; copy < 2; ++copy)
    all.blocks.insert(all.blocks.end(), graph.blocks.begin() + nodes, graph.blocks.end());
  for (int n = 0; n < nodes; ++n) {
    all.contributions.push_back({n, n});
    all.contributions.push_back({n, nodes + n});
  }
  std::size_t values = 0;
  for (const auto& [row, column] : graph.contributions) {
    Source s;
    s.offset = values;
    s.first = all.contributions.size();
    const auto size = [&](int b) {
      return b < 0 ? 6 : graph.blocks[static_cast<std::size_t>(b)].size;
    };
    s.rows = size(row), s.columns = size(column);
    s.row = row, s.column = column;
    values += static_cast<std::size_t>(s.rows * s.columns);
    if (row >= 0 && column >= 0) {
      if (row < nodes && column < nodes) {
        s.kind = Source::Kind::node;
        all.contributions.push_back({nodes + row, column});
        all.contributions.push_back({nodes + row, nodes + column});
      } else if (row < nodes) {
        s.kind = Source::Kind::forces;
        all.contributions.push_back({nodes + row, nodes + column});
        all.contributions.push_back({row, nodes + constraints + column});
      } else if (column >= nodes) {
        s.kind = Source::Kind::own;
        all.contributions.push_back({nodes + row, nodes + column});
        all.contributions.push_back({nodes + constraints + row, nodes + constraints + column});
      } else {
        s.kind = Source::Kind::gradient;
        all.contributions.push_back({nodes + row, nodes + column});
        all.contributions.push_back({nodes + constraints + row, column});
        all.contributions.push_back({nodes + row, column});
      }
    }
    sources_.push_back(s);
  }
  K_.assign(values, 0.0);
  D_.assign(values, 0.0);
  G_.assign(values, 0.0);
  for (const Source& s : sources_) {
    K_slots_.push_back({K_.data() + s.offset, s.rows});
    D_slots_.push_back({D_.data() + s.offset, s.rows});
  }
  return all;
}

// Batches with a contribution to a multiplier: B^T mu is their residual, which is linear in multipliers.
void StabilizedIndex2::find_joints() {
  const auto first = system_.first_contributions();
  for (std::size_t b = 0; b + 1 < first.size(); ++b)
    for (std::size_t i = first[b]; i < first[b + 1]; ++i)
      if (system_.graph().contributions[i].row >= nodes_) {
        joints_.push_back(system_.batches()[b].get());
        break;
      }
}

// Nodes of one constraint differ in color.
void StabilizedIndex2::color_nodes() {
  std::vector<std::vector<int>> nodes_of(first_row_.size());
  std::vector<std::vector<int>> constraints_of(static_cast<std::size_t>(nodes_));
  for (const Source& s : sources_) {
    if (s.kind != Source::Kind::gradient) continue;
    const int c = s.row - static_cast<int>(nodes_);
    nodes_of[static_cast<std::size_t>(c)].push_back(s.column);
    constraints_of[static_cast<std::size_t>(s.column)].push_back(c);
  }
  color_.assign(static_cast<std::size_t>(nodes_), -1);
  std::vector<bool> taken;
  for (std::size_t n = 0; n < color_.size(); ++n) {
    if (constraints_of[n].empty()) continue;
    taken.assign(static_cast<std::size_t>(colors_) + 1, false);
    for (const int c : constraints_of[n])
      for (const int other : nodes_of[static_cast<std::size_t>(c)])
        if (const int color = color_[static_cast<std::size_t>(other)]; color >= 0)
          taken[static_cast<std::size_t>(color)] = true;
    color_[n] = static_cast<int>(std::find(taken.begin(), taken.end(), false) - taken.begin());
    colors_ = std::max(colors_, color_[n] + 1);
  }
}

// G by equation (6), from B in K_.
void StabilizedIndex2::set_gradient_of_rates() {
  if (colors_ == 0) return;
  mu_state_.pose = at_.pose;
  mu_state_.signals = at_.signals;
  double size = 1e-3;  // of W, near that of V: less round-off
  for (const Vec6& V : at_.V) size = std::max(size, V.cwiseAbs().maxCoeff());
  for (int color = 0; color < colors_; ++color)
    for (Index k = 0; k < 6; ++k) {
      for (const double sign : {1.0, -1.0}) {
        mu_state_.V = at_.V;
        for (std::size_t n = 0; n < color_.size(); ++n)
          if (color_[n] == color) mu_state_.V[n + 1](k) += sign * size;
        system_.constraint_rates(mu_state_, rates_, sign > 0.0 ? more_ : less_);
      }
      for (const Source& s : sources_)
        if (s.kind == Source::Kind::gradient &&
            color_[static_cast<std::size_t>(s.column)] == color) {
          const Index first =
              first_row_[static_cast<std::size_t>(s.row - static_cast<int>(nodes_))];
          for (Index i = 0; i < s.rows; ++i)
            G_[s.offset + static_cast<std::size_t>(k * s.rows + i)] =
                (more_(first + i) - less_(first + i)) / (4.0 * size);
        }
    }
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& s = sources_[i];
    if (s.kind != Source::Kind::gradient) continue;
    const Block B = block(K_slots_[i], s.rows, 6);
    Block G = block({G_.data() + s.offset, s.rows}, s.rows, 6);
    G -= 0.5 * B * twist_hat<double>(at_.V[static_cast<std::size_t>(s.column) + 1]);
  }
}

void StabilizedIndex2::pack(const State& state, std::span<double> y, std::span<double> ydot) const {
  std::fill(y.begin(), y.end(), 0.0);
  std::fill(ydot.begin(), ydot.end(), 0.0);
  for (Index n = 0; n < nodes_; ++n) {
    const auto N = static_cast<std::size_t>(n + 1);
    double* const x = y.data() + per_node * n;
    double* const xdot = ydot.data() + per_node * n;
    const Pose<double>& H = state.pose[N];
    const Vec6& V = state.V[N];
    const Vec3 rdot = H.R() * V.head<3>();
    const Quaternion<double> pdot =
        H.p * Quaternion<double>(0.0, 0.5 * V(3), 0.5 * V(4), 0.5 * V(5));
    std::copy_n(H.r.data(), 3, x);
    std::copy_n(rdot.data(), 3, xdot);
    put(H.p, x + 3);
    put(pdot, xdot + 3);
    std::copy_n(V.data(), 6, x + 7);
    std::copy_n(state.Vdot[N].data(), 6, xdot + 7);
  }
  std::copy_n(state.lambda.data(), state.lambda.size(), y.data() + first_lambda());
}

void StabilizedIndex2::unpack(std::span<const double> y, std::span<const double> ydot,
                              State& state) const {
  for (Index n = 0; n < nodes_; ++n) {
    const auto N = static_cast<std::size_t>(n + 1);
    const double* const x = y.data() + per_node * n;
    state.pose[N].r = vector(x);
    state.pose[N].p = quaternion(x + 3).normalized();
    std::copy_n(x + 7, 6, state.V[N].data());
    std::copy_n(ydot.data() + per_node * n + 7, 6, state.Vdot[N].data());
  }
  state.lambda.resize(system_.multipliers());
  std::copy_n(y.data() + first_lambda(), state.lambda.size(), state.lambda.data());
}

void StabilizedIndex2::follow(const State& accepted) {
  at_.angles = mu_state_.angles = accepted.angles;
  at_.load_factor = mu_state_.load_factor = accepted.load_factor;
  at_.idle = mu_state_.idle = accepted.idle;
  at_.inputs = mu_state_.inputs = accepted.inputs;
  at_.control = mu_state_.control = accepted.control;
}

void StabilizedIndex2::set(double t, std::span<const double> y, std::span<const double> ydot) {
  unpack(y, ydot, at_);
  system_.set_time(at_, t, Side::left);
  for (Index n = 0; n < nodes_; ++n) {
    const auto N = static_cast<std::size_t>(n + 1);
    const double* const x = y.data() + per_node * n;
    const double* const xdot = ydot.data() + per_node * n;
    const Quaternion<double> p = quaternion(x + 3);
    const double square = p.squaredNorm();
    const Quaternion<double> q = p.conjugate() * quaternion(xdot + 3);
    norm_[N] = std::sqrt(square);
    q0_[N] = q.w() / square;
    rate_[N].head<3>() = at_.pose[N].R().transpose() * vector(xdot);
    rate_[N].tail<3>() = 2.0 / square * q.vec();
  }
}

bool StabilizedIndex2::residual(double t, std::span<const double> y, std::span<const double> ydot,
                                std::span<double> F) {
  set(t, y, ydot);
  const bool in_range = system_.residual(at_, r_);
  system_.constraints(at_, g_, gdot_);
  mu_forces_.setZero(system_.rows());
  if (system_.multipliers() > 0) {
    mu_state_.pose = at_.pose;
    mu_state_.V = at_.V;
    mu_state_.signals = at_.signals;
    mu_state_.t = t;
    std::copy_n(y.data() + first_mu(), mu_state_.lambda.size(), mu_state_.lambda.data());
    for (const Batch* joint : joints_) joint->residual(mu_state_, mu_forces_);
  }
  for (Index n = 0; n < nodes_; ++n) {
    const auto N = static_cast<std::size_t>(n + 1);
    Eigen::Map<VecX> f(F.data() + per_node * n, per_node);
    const auto forces = mu_forces_.segment<6>(6 * (n + 1));
    f.head<6>() = rate_[N] - at_.V[N];
    f.head<3>() -= length_ * length_ * forces.head<3>();
    f.segment<3>(3) -= forces.tail<3>();
    f(6) = 0.5 * (norm_[N] - 1.0) * (norm_[N] + 1.0);
    f.tail<6>() = r_.segment<6>(6 * (n + 1));
  }
  std::copy_n(gdot_.data(), gdot_.size(), F.data() + first_lambda());
  std::copy_n(g_.data(), g_.size(), F.data() + first_mu());
  return in_range;
}

// The rows (1) of the nodes, without mu.
void StabilizedIndex2::add_kinematics(std::span<const Slot> slots) const {
  for (Index n = 0; n < nodes_; ++n) {
    const auto N = static_cast<std::size_t>(n + 1);
    const auto first = static_cast<std::size_t>(2 * n);
    Block A = block(slots[first], 6, 6);
    A.diagonal().array() += 1.0;
    A.diagonal().tail<3>().array() -= q0_[N] / c_;
    A.topRightCorner<3, 3>() += hat(rate_[N].head<3>()) / c_;
    A.bottomRightCorner<3, 3>() += 0.5 / c_ * hat(rate_[N].tail<3>());
    block(slots[first + 1], 6, 6).diagonal().array() -= 1.0;
  }
}

bool StabilizedIndex2::linearize(double t, std::span<const double> y, std::span<const double> ydot,
                                 double c) {
  set(t, y, ydot);
  c_ = c;
  std::fill(K_.begin(), K_.end(), 0.0);
  std::fill(D_.begin(), D_.end(), 0.0);
  const bool in_range = system_.linearize(at_, {}, r_, K_slots_);
  system_.add_rate_tangent(at_, {.U = 0.0, .V = 0.0, .A = 1.0, .T_inv = {}}, D_slots_);
  mass_ = 0.0;
  for (const double d : D_) mass_ = std::max(mass_, std::abs(d));
  if (!(mass_ > 0.0)) mass_ = 1.0;
  for (double& d : D_) d *= c;
  system_.add_rate_tangent(at_, {.U = 0.0, .V = 1.0, .A = 0.0, .T_inv = {}}, D_slots_);

  set_gradient_of_rates();

  solver_->set_zero();
  const auto slots = solver_->slots();
  add_kinematics(slots);
  const double by_position = 1.0 / (mass_ * c * c), by_velocity = 1.0 / (mass_ * c);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& s = sources_[i];
    if (s.kind == Source::Kind::ground) continue;
    const Block K = block(K_slots_[i], s.rows, s.columns),
                D = block(D_slots_[i], s.rows, s.columns);
    Block one = block(slots[s.first], s.rows, s.columns);
    Block two = block(slots[s.first + 1], s.rows, s.columns);
    switch (s.kind) {
      case Source::Kind::node:
        one += by_position * K;
        two += by_velocity * D;
        break;
      case Source::Kind::forces:
        one += K;
        two.topRows<3>() -= length_ * length_ * K.topRows<3>();
        two.bottomRows<3>() -= K.bottomRows<3>();
        break;
      case Source::Kind::gradient:
        one += K;
        two += K;
        block(slots[s.first + 2], s.rows, 6) +=
            block({G_.data() + s.offset, s.rows}, s.rows, 6) / c;
        break;
      case Source::Kind::own:  // of idle rows
        one += K;
        two += K;
        break;
      case Source::Kind::ground:
        break;
    }
  }
  return in_range;
}

void StabilizedIndex2::solve(std::span<double> b) {
  const Index m = system_.multipliers();
  Eigen::Map<VecX> y(b.data(), static_cast<Index>(b.size()));
  for (Index n = 0; n < nodes_; ++n) {
    const auto N = static_cast<std::size_t>(n + 1);
    const auto f = y.segment<per_node>(per_node * n);
    const double ds = f(6) / norm_[N];
    x_.segment<6>(6 * n) = f.head<6>() / c_;
    x_.segment<3>(6 * n + 3) += ds / (norm_[N] * c_) * rate_[N].tail<3>();
    x_.segment<6>(6 * (nodes_ + n)) = f.tail<6>() / (mass_ * c_ * c_);
  }
  x_.segment(12 * nodes_, m) = y.segment(first_lambda(), m) / c_;
  x_.tail(m) = y.tail(m);
  solver_->solve({x_.data(), static_cast<std::size_t>(x_.size())});
  for (Index n = 0; n < nodes_; ++n) {
    const auto N = static_cast<std::size_t>(n + 1);
    auto f = y.segment<per_node>(per_node * n);
    const Vec6 U = x_.segment<6>(6 * n);
    const double ds = f(6) / norm_[N];
    const Pose<double>& H = at_.pose[N];
    const double half = 0.5 * norm_[N];
    f.head<3>() = H.R() * U.head<3>();
    put(H.p * Quaternion<double>(ds, half * U(3), half * U(4), half * U(5)), f.data() + 3);
    f.tail<6>() = c_ * x_.segment<6>(6 * (nodes_ + n));
  }
  y.segment(first_lambda(), m) = mass_ * c_ * c_ * x_.segment(12 * nodes_, m);
  y.tail(m) = c_ * x_.tail(m);
}

std::string StabilizedIndex2::worst_equation() const {
  return system_.name_of(worst_row(system_, r_));
}

std::string StabilizedIndex2::singular_unknown() const {
  const Index i = solver_->singular_row(), m = system_.multipliers();
  if (i < 0) return {};
  if (i < 12 * nodes_) return system_.name_of(6 + i % (6 * nodes_));
  return system_.name_of(6 * (nodes_ + 1) + (i - 12 * nodes_) % std::max<Index>(m, 1));
}

std::string StabilizedIndex2::name_of(Index component) const {
  if (component < first_lambda()) {
    const Index n = component / per_node + 1, k = component % per_node;
    const Index row = k < 3 ? k : k < 7 ? std::max<Index>(k - 1, 3) : k - 7;
    return system_.name_of(6 * n + row);
  }
  const Index m = system_.multipliers();
  return system_.name_of(6 * (nodes_ + 1) + (component - first_lambda()) % std::max<Index>(m, 1));
}

}  // namespace mbd
