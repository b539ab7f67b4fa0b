#include "solvers/statics/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "solvers/constraints/parts.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/statics/equilibrium.hpp"

namespace mbd {

VecX motion_weights(const System& system) {
  const Index nodes = system.nodes() - 1;
  VecX w = VecX::Zero(system.unknowns());
  const double one = 1.0 / static_cast<double>(std::max<Index>(nodes, 1)),
               length = system.length_scale();
  for (Index i = 0; i < 6 * nodes; ++i) w(i) = i % 6 < 3 ? one / (length * length) : one;
  return w;
}

StabilityCount::StabilityCount(const System& system)
    : system_(system), solver_(make_block_inertia_solver()) {
  solver_->analyze(system.graph());
}

StabilityCount::StabilityCount(const System& system, LinearSolver& solver)
    : system_(system), solver_(make_block_inertia_solver_in(solver)) {
  if (solver_) return;
  solver_ = make_block_inertia_solver();
  solver_->analyze(system.graph());
}

namespace {

// The slot of each node's own block.
std::vector<const Slot*> own_slots(const System& system, std::span<const Slot> slots) {
  std::vector<const Slot*> own(static_cast<std::size_t>(system.nodes()) - 1, nullptr);
  const auto& contributions = system.graph().contributions;
  for (std::size_t i = 0; i < contributions.size(); ++i) {
    const auto [row, column] = contributions[i];
    if (row >= 0 && row == column && static_cast<std::size_t>(row) < own.size())
      own[static_cast<std::size_t>(row)] = &slots[i];
  }
  return own;
}

// s W of stability.hpp on the diagonal of what has been added to slots; false if a node has no place for it.
bool add_springs(const System& system, std::span<const Slot> slots, double s) {
  const VecX w = motion_weights(system);
  Index row = 0;
  for (const Slot* const slot : own_slots(system, slots)) {
    if (slot == nullptr) return false;
    for (Index k = 0; k < 6; ++k, ++row) slot->data[k * (slot->ld + 1)] += s * w(row);
  }
  return true;
}

// Where nothing is stiff, as a wheel on its axle, any will do.
double spring_of(const System& system, const LinearSolver& solver) {
  const double L = system.length_scale(), stiffness = largest_stiffness(system, solver);
  if (is_nothing(stiffness)) return L * L;
  return neutral_share * stiffness * L * L * static_cast<double>(system.nodes());
}

}  // namespace

void NeutralMotions::take_out(const VecX& weights, Eigen::Ref<VecX> x) const {
  for (Index k = 0; k < shapes.cols(); ++k)
    x -= shapes.col(k) * shapes.col(k).dot(weights.cwiseProduct(x));
}

// Each node is compared with the first of them, not with its neighbour, since of a fine mesh neighbours hardly differ in
// any motion.
bool strains_beams(const System& system, const State& state, const VecX& x) {
  // Of the motion. Rigid ones, found from a matrix of that condition, have up to 2e-3; bending is of the order of 1.
  constexpr double none = 0.03;
  const double L = system.length_scale();
  const auto size_of = [L](const Vec6& u) {
    return std::max(u.head<3>().norm() / L, u.tail<3>().norm());
  };
  const auto motion_of = [&x](int node) -> Vec6 { return x.segment<6>(6 * Index{node - 1}); };
  const auto pose_of = [&state](int node) { return state.pose[static_cast<std::size_t>(node)]; };
  const auto nodes = static_cast<int>(system.nodes());
  double most = 0.0;
  for (int n = 1; n < nodes; ++n) most = std::max(most, size_of(motion_of(n)));
  const ConnectedParts parts = find_parts(system, std::mem_fn(&Batch::is_structure));
  for (int n = 1; n < nodes; ++n) {
    const auto part = static_cast<std::size_t>(parts.of_node[static_cast<std::size_t>(n)]);
    const int first = parts.first[part];
    const Pose<double> g = relative(pose_of(first), pose_of(n));
    if (size_of(motion_of(n) - adjoint_inverse(g) * motion_of(first)) > none * most) return true;
  }
  return false;
}

namespace {

// Whether what moves far along x from an equilibrium is in equilibrium still, up to multipliers: at a critical point it is not.
// (Neutral motions, rigid ones and spins, are the same all the way as increments in the nodes' own axes.) `solver` has the
// factors of S + s W at the state.
bool keeps_equilibrium(const System& system, const LinearSolver& solver, const State& state,
                       const NeutralMotions& found, const VecX& x) {
  constexpr double far = 0.1;  // of the scene, or [rad]
  constexpr double in_equilibrium = 1e-7, aside = 1e-4, along = 0.1;
  const VecX w = motion_weights(system);
  VecX r;
  // What brings a state to equilibrium, along x and aside, of motions.
  const auto corrections = [&](const State& at) -> std::pair<double, double> {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (!system.residual(at, r)) return {infinite, infinite};
    VecX y = r.tail(w.size());
    solver.solve({y.data(), static_cast<std::size_t>(y.size())});
    found.take_out(w, y);
    const double part = y.dot(w.cwiseProduct(x));
    y -= part * x;
    const double rest = std::sqrt(y.dot(w.cwiseProduct(y)));
    if (!std::isfinite(part + rest)) return {infinite, infinite};
    return {std::abs(part), rest};
  };
  if (corrections(state).second > in_equilibrium) return false;
  for (const double share : {far, -far}) {
    State moved = state;
    retract(system, moved, x, share);
    const auto [part, rest] = corrections(moved);
    if (part > along * far || rest > aside * far) return false;
  }
  return true;
}

}  // namespace

bool lead_along_equilibria(const System& system, const LinearSolver& solver, const State& state,
                           const NeutralMotions& neutral) {
  for (Index k = 0; k < neutral.count(); ++k)
    if (!keeps_equilibrium(system, solver, state, neutral, neutral.shapes.col(k))) return false;
  return true;
}

NeutralMotions find_neutral_motions(const System& system, LinearSolver& solver, const State& state,
                                    std::span<const Vec6> resultants) {
  constexpr Index most = 64;
  constexpr int iterations = 4;
  constexpr double all_found = 1e-14;  // of a motion, that is left
  constexpr double no_share = 1e-13;   // of neutral motions, in one
  NeutralMotions none, found;
  VecX r;
  system.linearize_mixed(state, resultants, r, solver);
  const double s = spring_of(system, solver);
  if (!(s > 0.0) || !add_springs(system, solver.slots(), s)) return none;
  if (solver.factor() != FactorStatus::ok) return none;
  const VecX w = motion_weights(system);
  const Index motions = 6 * (system.nodes() - 1);
  found.shapes.resize(w.size(), 0);
  VecX x(w.size()), y(w.size());
  // Twice, so that what is left is none of them; false where that is round-off: all that there are have been found.
  const auto take_out_all = [&](VecX& of) {
    of.tail(of.size() - motions).setZero();
    const double whole = std::sqrt(of.dot(w.cwiseProduct(of)));
    found.take_out(w, of);
    found.take_out(w, of);
    const double left = std::sqrt(of.dot(w.cwiseProduct(of)));
    of /= left;
    return left > all_found * whole;
  };
  while (true) {
    for (Index i = 0; i < x.size(); ++i)  // with a share of every mode, the same in every run
      x(i) = std::sin(1.0 + (2.7 + 0.3 * static_cast<double>(found.count())) *
                                static_cast<double>((i * i + 31 * found.count()) % 1009));
    double eigenvalue = 0.0;
    for (int k = 0; k < iterations; ++k) {
      if (!take_out_all(x)) return found;
      y = w.cwiseProduct(x);
      solver.solve({y.data(), static_cast<std::size_t>(y.size())});
      if (!y.allFinite()) return none;
      const double inverse = x.dot(w.cwiseProduct(y));
      // Constraints hold all the rest: what comes next is the round-off of nothing.
      if (std::abs(inverse) * s < no_share) return found;
      eigenvalue = 1.0 / inverse;  // of K + s W, and s of a neutral motion
      x = y;
    }
    if (!(std::abs(eigenvalue) < 2.0 * s)) return found;
    if (!take_out_all(x)) return found;
    if (strains_beams(system, state, x) && !keeps_equilibrium(system, solver, state, found, x))
      return found;
    if (found.count() == most) return none;
    found.shapes.conservativeResize(Eigen::NoChange, found.count() + 1);
    found.shapes.col(found.count() - 1) = x;
  }
}

bool drives(const System& system, const State& state, const NeutralMotions& neutral) {
  constexpr double none = 1e-9;  // of the loads
  if (neutral.count() == 0) return false;
  VecX rate;
  system.load_rate(state, rate);
  const Index motions = 6 * (system.nodes() - 1);
  // Loads are energies of a motion of unit size.
  VecX loads = rate.segment(6, motions);
  double size = 0.0;
  for (Index i = 0; i < motions; ++i)
    size = std::max(size, std::abs(loads(i)) * (i % 6 < 3 ? system.length_scale() : 1.0));
  const VecX work = neutral.shapes.topRows(motions).transpose() * loads;
  return !(work.norm() <= none * size);
}

Holds holds_of(const VecX& weights, const NeutralMotions& neutral) {
  Holds holds;
  if (neutral.count() == 0) return holds;  // whose shapes have no rows
  Eigen::MatrixXd left = weights.cwiseSqrt().asDiagonal() * neutral.shapes;
  for (Index k = 0; k < neutral.count(); ++k) {  // elimination with pivots from all that is left
    Index row = 0, column = 0;
    const double pivot = left.cwiseAbs().maxCoeff(&row, &column) > 0.0 ? left(row, column) : 0.0;
    if (pivot == 0.0) break;
    holds.rows.push_back(row);
    const Eigen::RowVectorXd shares = left.row(row) / pivot;
    const VecX taken = left.col(column);
    left -= taken * shares;
  }
  return holds;
}

void add_holds(const System& system, std::span<const Slot> slots, const Holds& holds) {
  if (holds.rows.empty()) return;
  const std::vector<const Slot*> own = own_slots(system, slots);
  const double L = system.length_scale(), stiffness = largest_stiffness(system, slots);
  for (const Index row : holds.rows) {
    const Slot* const slot = own[static_cast<std::size_t>(row / 6)];
    if (slot == nullptr) continue;
    const Index k = row % 6, first = k < 3 ? 0 : 3;
    double there = 0.0;
    for (Index j = first; j < first + 3; ++j)
      there = std::max(there, std::abs(slot->data[j * (slot->ld + 1)]));
    if (there == 0.0) there = stiffness > 0.0 ? stiffness * (first == 0 ? 1.0 : L * L) : 1.0;
    slot->data[k * (slot->ld + 1)] += there;
  }
}

std::optional<Index> StabilityCount::operator()(const State& equilibrium, const Holds& holds,
                                                std::span<const Vec6> resultants) {
  system_.linearize_mixed(equilibrium, resultants, r_, *solver_);
  add_holds(system_, solver_->slots(), holds);
  if (solver_->factor() != FactorStatus::ok) return std::nullopt;
  const std::optional<Index> negative = solver_->negative_eigenvalues();
  // Fewer than constraints: they are not independent, and the count means nothing.
  if (!negative || *negative < system_.multipliers()) return std::nullopt;
  return *negative - system_.multipliers();
}

std::optional<CriticalMode> critical_mode(const System& system, LinearSolver& solver,
                                          const State& state, const VecX& guess,
                                          std::span<const Vec6> resultants, const Holds& holds) {
  constexpr int most_iterations = 60;
  constexpr double converged = 1e-13;  // of the eigenvalue, relative; twice in a row
  VecX r;
  system.linearize_mixed(state, resultants, r, solver);
  add_holds(system, solver.slots(), holds);
  if (solver.factor() != FactorStatus::ok) return std::nullopt;
  const VecX w = motion_weights(system);
  CriticalMode mode;
  mode.shape = guess;
  if (guess.size() != w.size()) {
    mode.shape.resize(w.size());  // with a share of every mode, the same in every run
    for (Index i = 0; i < w.size(); ++i)
      mode.shape(i) = std::sin(1.0 + 2.7 * static_cast<double>(i * i % 1009));
  }
  const auto normalise = [&w](VecX& x) {
    const double size = std::sqrt(x.dot(w.cwiseProduct(x)));
    x /= size;
  };
  normalise(mode.shape);
  VecX y(w.size());
  for (int k = 0, still = 0; k < most_iterations && still < 2; ++k) {
    y = w.cwiseProduct(mode.shape);
    solver.solve({y.data(), static_cast<std::size_t>(y.size())});
    const double inverse = mode.shape.dot(w.cwiseProduct(y));
    const double before = mode.eigenvalue;
    mode.eigenvalue = 1.0 / inverse;
    mode.shape = y;
    normalise(mode.shape);
    if (!mode.shape.allFinite()) return std::nullopt;
    still =
        std::abs(mode.eigenvalue - before) <= converged * std::abs(mode.eigenvalue) ? still + 1 : 0;
  }
  return mode;
}

std::string name_of_motion(const System& system, const VecX& shape) {
  constexpr double alike = 1.0 + 1e-6;  // by symmetry: the first is named, whatever round-off says
  const VecX w = motion_weights(system);
  Index largest = 0;
  double most = -1.0;
  for (Index i = 0; i < 6 * (system.nodes() - 1); ++i)
    if (const double size = w(i) * shape(i) * shape(i); size > alike * most) {
      most = size;
      largest = i;
    }
  return fmt::format("{} {} its axis {}", system.node_name(largest / 6 + 1),
                     largest % 6 < 3 ? "moves along" : "turns about", largest % 3 + 1);
}

}  // namespace mbd
