#include "solvers/constraints/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "joints/any_joint_batch.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd {
namespace {

// Part of each node, -1 for the ground: nodes that elements couple are one.
std::vector<int> rigid_parts(const System& system, Index& count) {
  const auto nodes = static_cast<int>(system.nodes());
  std::vector<int> parent(static_cast<std::size_t>(nodes));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int n) {
    while (parent[static_cast<std::size_t>(n)] != n) n = parent[static_cast<std::size_t>(n)];
    return n;
  };
  const auto first = system.first_contributions();
  const auto& contributions = system.graph().contributions;
  for (std::size_t b = 0; b < system.batches().size(); ++b) {
    if (dynamic_cast<const joint::AnyJointBatch*>(system.batches()[b].get())) continue;
    for (std::size_t i = first[b]; i < first[b + 1]; ++i) {
      const auto [row, column] = contributions[i];
      if (row < 0 || column < 0) continue;
      const int p = root(row + 1), q = root(column + 1);
      parent[static_cast<std::size_t>(std::max(p, q))] = std::min(p, q);
    }
  }
  std::vector<int> part(static_cast<std::size_t>(nodes), -1);
  count = 0;
  for (int n = 1; n < nodes; ++n) {
    const int r = root(n);
    part[static_cast<std::size_t>(n)] =
        r == n ? static_cast<int>(count++) : part[static_cast<std::size_t>(r)];
  }
  return part;
}

}  // namespace

Mechanism analyze_mechanism(const System& system, const State& state) {
  Mechanism result;
  result.constraints = system.multipliers();

  // Lengths: rotations times L.
  const double L = system.length_scale();
  const auto nodes = static_cast<std::size_t>(system.nodes());
  const std::vector<int> part = rigid_parts(system, result.rigid_parts);
  std::vector<int> origin(static_cast<std::size_t>(result.rigid_parts), -1);  // a node of each part
  for (std::size_t n = nodes; n-- > 1;)
    origin[static_cast<std::size_t>(part[n])] = static_cast<int>(n);

  ConstraintEntries flexible, rigid;
  for (const GradientBlock& piece : constraint_gradients(system, state)) {
    const ConstraintInfo& info = system.constraints()[static_cast<std::size_t>(piece.constraint)];
    const auto n = static_cast<std::size_t>(piece.node);
    const int p = part[n];
    const Pose<double>& H = state.pose[n];
    const Pose<double>& H_0 =
        state.pose[static_cast<std::size_t>(origin[static_cast<std::size_t>(p)])];
    // The increment of the node when its part moves by dU_0 in its origin's axes: Ad(H^-1 H_0) dU_0.
    const Mat6 along = adjoint(relative(H, H_0)).matrix();
    const Eigen::MatrixXd of_part = piece.B * along;
    for (Index i = 0; i < info.rows; ++i)
      for (int j = 0; j < 6; ++j) {
        const double unit = j < 3 ? 1.0 : 1.0 / L;
        const auto row = static_cast<int>(info.first_row + i);
        if (piece.B(i, j) != 0.0)
          flexible.emplace_back(row, 6 * (piece.node - 1) + j, unit * piece.B(i, j));
        if (of_part(i, j) != 0.0) rigid.emplace_back(row, 6 * p + j, unit * of_part(i, j));
      }
  }

  // Joints first, so that a drive is blamed before the joint it drives.
  const std::vector<char> is_prescribed = prescribed_constraints(system);
  std::vector<Index> order;
  Index of_joints = 0;
  for (const bool prescribed : {false, true}) {
    for (std::size_t c = 0; c < is_prescribed.size(); ++c)
      for (Index i = 0; (is_prescribed[c] != 0) == prescribed && i < system.constraints()[c].rows;
           ++i)
        order.push_back(system.constraints()[c].first_row + i);
    if (!prescribed) of_joints = static_cast<Index>(order.size());
  }
  result.redundant =
      find_dependent(flexible, system.multipliers(), 6 * (system.nodes() - 1), order).redundant;
  Dependence as_rigid = find_dependent(rigid, system.multipliers(), 6 * result.rigid_parts, order);
  const Index joints_rank = as_rigid.rank_of_first[static_cast<std::size_t>(of_joints)];
  result.joint_freedoms = 6 * result.rigid_parts - joints_rank;
  result.prescribed = as_rigid.rank_of_first.back() - joints_rank;
  result.rigid_redundant = std::move(as_rigid.redundant);
  return result;
}

}  // namespace mbd
