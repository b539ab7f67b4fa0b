#include "solvers/newton/increments.hpp"

#include <limits>

namespace mbd {

IncrementNorm::IncrementNorm(const System& system, const NewtonOptions& options)
    : motions_(6 * (system.nodes() - 1)),
      length_(system.length_scale()),
      tolerance_(options.tolerance),
      multiplier_tolerance_(options.multiplier_tolerance) {
  for (const ConstraintInfo& c : system.constraints())
    for (const bool is_position : c.is_position)
      arm_.push_back(c.gives       ? std::numeric_limits<double>::infinity()
                     : is_position ? 1.0
                                   : length_);
}

void IncrementNorm::observe(const VecX& lambda) {
  for (Index i = 0; i < lambda.size(); ++i) {
    const double size = std::abs(lambda(i)) / arm_[static_cast<std::size_t>(i)];
    if (size > force_ && std::isfinite(size)) force_ = size;
  }
}

void IncrementNorm::set_floor(const State& state, double stiffness) {
  constexpr double units = 8.0;  // of round-off
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double farthest = length_;
  for (const Pose<double>& H : state.pose) farthest = std::max(farthest, H.r.cwiseAbs().maxCoeff());
  floor_ = units * eps * farthest / length_;
  force_floor_ = units * eps * farthest * stiffness;
}

double IncrementNorm::operator()(std::span<const double> increment, double multiplier_scale,
                                 double slack, double share, double* exact) const {
  double linear = 0.0, angular = 0.0, multipliers = 0.0;
  double sum = 0.0;  // not finite if any component is not: max() would hide a NaN
  const auto motions = static_cast<std::size_t>(motions_);
  for (std::size_t i = 0; i < motions; i += 6) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double u = std::abs(increment[i + k]), psi = std::abs(increment[i + 3 + k]);
      linear = std::max(linear, u);
      angular = std::max(angular, psi);
      sum += u + psi;
    }
  }
  for (std::size_t i = motions; i < increment.size(); ++i) {
    const double l = std::abs(increment[i]) / arm_[i - motions];
    multipliers = std::max(multipliers, l);
    sum += l;
  }
  if (!std::isfinite(sum)) return std::numeric_limits<double>::quiet_NaN();
  const double motion = std::max(linear / length_, angular);
  double e = motion / std::max(share * tolerance_, floor_);
  if (exact != nullptr) *exact = motion / (share * tolerance_);
  multipliers /= multiplier_scale;
  if (multipliers > 0.0) {
    // Before any multiplier has been met, the first increment is its own measure.
    const double force = std::max(force_, multipliers);
    const double m = multipliers / std::max(slack * multiplier_tolerance_ * force, force_floor_);
    e = std::max(e, m);
    if (exact != nullptr) *exact = std::max(*exact, m);
  }
  return e;
}

double largest_stiffness(const System& system, const LinearSolver& S) {
  return largest_stiffness(system, S.slots());
}

double largest_stiffness(const System& system, std::span<const Slot> slots) {
  // By pairs of displacements (0) and rotations (1).
  double largest[2][2] = {};
  const BlockGraph& graph = system.graph();
  for (std::size_t i = 0; i < graph.contributions.size(); ++i) {
    const auto [row, column] = graph.contributions[i];
    if (row < 0 || column < 0) continue;
    const auto& r = graph.blocks[static_cast<std::size_t>(row)];
    const auto& c = graph.blocks[static_cast<std::size_t>(column)];
    if (r.kind != BlockGraph::Kind::node || c.kind != BlockGraph::Kind::node) continue;
    const Slot slot = slots[i];
    for (Index k = 0; k < 6; ++k) {
      const double* const at = slot.data + k * slot.ld;
      double* const most = largest[k / 3];
      most[0] = std::max({most[0], std::abs(at[0]), std::abs(at[1]), std::abs(at[2])});
      most[1] = std::max({most[1], std::abs(at[3]), std::abs(at[4]), std::abs(at[5])});
    }
  }
  const double L = system.length_scale();
  return std::max({largest[0][0], largest[0][1] / L, largest[1][0] / L, largest[1][1] / (L * L)});
}

namespace {

// Of rows with a compliance, by multiplier: the largest derivative of a gap by a motion, turns over the scene's length, and the
// compliance; 0 of others.
struct Giving {
  VecX B, C;
};
Giving giving_rows(const System& system, std::span<const Slot> slots) {
  const auto nodes = static_cast<int>(system.nodes()) - 1;
  const BlockGraph& graph = system.graph();
  const double L = system.length_scale();
  Giving g{VecX::Zero(system.multipliers()), VecX::Zero(system.multipliers())};
  for (std::size_t i = 0; i < graph.contributions.size(); ++i) {
    const auto [row, column] = graph.contributions[i];
    if (row < nodes || column < 0) continue;
    const ConstraintInfo& info = system.constraints()[static_cast<std::size_t>(row - nodes)];
    if (!info.gives) continue;
    const Slot slot = slots[i];
    for (Index r = 0; r < info.rows; ++r) {
      const Index k = info.first_row + r;
      if (column == row) g.C(k) = std::abs(slot.data[r * slot.ld + r]);
      for (Index j = 0; column < nodes && j < 6; ++j)
        g.B(k) = std::max(g.B(k), std::abs(slot.data[j * slot.ld + r]) / (j < 3 ? 1.0 : L));
    }
  }
  return g;
}

}  // namespace

VecX gap_per_motion(const System& system, std::span<const Slot> slots) {
  return giving_rows(system, slots).B;
}

double largest_stiffness_behind(const System& system, std::span<const Slot> slots) {
  const auto [B, C] = giving_rows(system, slots);
  double largest = largest_stiffness(system, slots);
  for (Index k = 0; k < C.size(); ++k)
    if (C(k) > 0.0) largest = std::max(largest, B(k) * B(k) / C(k));
  return largest;
}

double largest_force(const System& system, const VecX& lambda) {
  double largest = 0.0;
  for (const ConstraintInfo& c : system.constraints())
    for (Index i = 0; i < c.rows; ++i) {
      const double size =
          std::abs(lambda(c.first_row + i)) /
          (c.is_position[static_cast<std::size_t>(i)] ? 1.0 : system.length_scale());
      if (std::isnan(size)) return size;
      largest = std::max(largest, size);
    }
  return largest;
}

double largest_violation(const System& system, const VecX& g, Index* row) {
  double largest = 0.0;
  Index worst = -1;
  const double per_length = 1.0 / system.length_scale();
  for (const ConstraintInfo& c : system.constraints())
    for (Index i = 0; i < c.rows; ++i) {
      const double raw = std::abs(g(c.first_row + i));
      const double size = c.is_position[static_cast<std::size_t>(i)] ? raw * per_length : raw;
      if (std::isnan(size) || size > largest) {
        worst = c.first_row + i;
        largest = size;
      }
      if (std::isnan(size)) {
        if (row != nullptr) *row = worst;
        return size;
      }
    }
  if (row != nullptr) *row = worst;
  return largest;
}

double fastest(const System& system, const State& state) {
  double most = 0.0;
  for (const Vec6& V : state.V)
    most = std::max({most, V.head<3>().norm() / system.length_scale(), V.tail<3>().norm()});
  return most;
}

Index worst_row(const System& system, const VecX& residual) {
  // A force, a moment over the scene's length, and a gap are compared within their kind.
  double largest[3] = {0.0, 0.0, 0.0};
  Index row[3] = {-1, -1, -1};
  for (Index i = 6; i < residual.size(); ++i) {
    const int kind = i >= 6 * system.nodes() ? 2 : (i % 6 < 3 ? 0 : 1);
    const double size = std::abs(residual(i));
    if (!std::isfinite(size)) return i;
    if (row[kind] < 0 || size > largest[kind]) {
      largest[kind] = size;
      row[kind] = i;
    }
  }
  if (largest[2] > 1e-6 * system.length_scale()) return row[2];
  return largest[1] / system.length_scale() > largest[0] ? row[1] : row[0];
}

std::string range_failure(const std::string& name) {
  if (name.starts_with("beam "))
    return name + " is bent beyond the range of its metric; give the beam more elements";
  if (name.starts_with("spring "))
    return name +
           " has no length left, and so no direction; keep its points apart, or give a "
           "bushing";
  if (name.starts_with("bushing "))
    return name +
           " is turned beyond its range, 0.9 of half a turn; make it stiffer, or give a joint";
  if (name.starts_with("force '")) {  // of a program or a plug-in; it may have said why
    return name.ends_with(")") ? name
                               : name + " is out of its range; look for what it cannot take there";
  }
  if (name.ends_with(" is not finite"))  // a law of sensors
    return name + " at what its sensors read; look for what it divides by, or begin elsewhere";
  // The others are joints (joint.hpp, on_branch).
  return name + " has turned to the wrong side, half a turn away; take smaller steps";
}

}  // namespace mbd
