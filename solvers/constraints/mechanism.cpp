#include "solvers/constraints/mechanism.hpp"

#include <functional>

#include "libmbd/core/se3.hpp"
#include "solvers/constraints/parts.hpp"

namespace mbd {

namespace {

void count_rows(const System& system, Mechanism& result) {
  for (const ConstraintInfo& info : system.constraints())
    (info.gives        ? result.stiff_strains
     : info.of_strains ? result.held_strains
                       : result.constraints) += info.rows;
}

}  // namespace

Mechanism analyze_mechanism(const System& system, const State& state) {
  Mechanism result;
  count_rows(system, result);
  // Lengths: rotations times L.
  const double L = system.length_scale();
  // Rigid parts: every structure as a rigid body. Springs, dampers and bushings tie nothing: they leave every motion, and
  // give it a force.
  const ConnectedParts parts = find_parts(system, std::mem_fn(&Batch::is_structure));
  const std::vector<int>& part = parts.of_node;
  result.rigid_parts = parts.count();
  const std::vector<int>& origin = parts.first;

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
        if (of_part(i, j) != 0.0 && !info.of_strains)
          rigid.emplace_back(row, 6 * p + j, unit * of_part(i, j));
      }
  }

  // Joints first, so that a drive is blamed before the joint it drives.
  const std::vector<char> is_prescribed = prescribed_constraints(system);
  std::vector<Index> order, of_rigid;
  Index of_joints = 0;
  for (const bool prescribed : {false, true}) {
    for (std::size_t c = 0; c < is_prescribed.size(); ++c)
      for (Index i = 0; (is_prescribed[c] != 0) == prescribed && i < system.constraints()[c].rows;
           ++i) {
        if (system.constraints()[c].gives) continue;
        order.push_back(system.constraints()[c].first_row + i);
        if (!system.constraints()[c].of_strains) of_rigid.push_back(order.back());
      }
    if (!prescribed) of_joints = static_cast<Index>(of_rigid.size());
  }
  result.redundant =
      find_dependent(flexible, system.multipliers(), 6 * (system.nodes() - 1), order).redundant;
  Dependence as_rigid =
      find_dependent(rigid, system.multipliers(), 6 * result.rigid_parts, of_rigid);
  const Index joints_rank = as_rigid.rank_of_first[static_cast<std::size_t>(of_joints)];
  result.joint_freedoms = 6 * result.rigid_parts - joints_rank;
  result.prescribed = as_rigid.rank_of_first.back() - joints_rank;
  result.rigid_redundant = std::move(as_rigid.redundant);
  return result;
}

}  // namespace mbd
