// Strains of beams with sectional forces of their own: sections of infinite stiffness in some directions (no extension, no
// shear, ...), as constraints within elements instead of a large stiffness, and in statics of one that is finite and very large.
//
// At the N Gauss points of an element, where its strains determine its shape, and the strains c that its section holds:
//   g_ic = w_i J_i e_c^T (E_i - C S_i) = 0,   dg_ic = w_i J_i e_c^T (Bbar_i dU - C dS_i)                  (1)
// with E and Bbar of beam_motion.hpp (1), (2). The multiplier of (1) is the sectional force S_ic itself [N, N.m]: it adds
//   F = sum_i w_i J_i Bbar_i^T e_c S_ic                                                                   (2)
// to the nodal forces and the geometric stiffness of the pairs (beam_strips.hpp) to the tangent. The compliance C is zero for
// what is infinite; where it is not, the element's own section has a moderate stiffness D_0, and D = D_0 + C^-1, C a matrix of
// the strains that are held so. Both are the saddle point of Hellinger and Reissner's principle, whose elastic energy is
// 1/2 sum_i w_i J_i S_i^T C S_i. Of each point the rows are one constraint.
//
// Not used: a large stiffness, which sets the step of solvers and the round-off of all forces. (E is known to the round-off of
// places. Forces that follow from equilibrium do not see it; those that only strains determine, as the tension of a beam between
// two clamps, have D times that.)
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/batch.hpp"
#include "libmbd/core/choices.hpp"
#include "libmbd/core/spectral.hpp"

namespace mbd {

// Of [gamma; kappa]: whether a section has no compliance in it.
using StrainSet = std::array<bool, 6>;
inline bool any(const StrainSet& set) {
  return set[0] || set[1] || set[2] || set[3] || set[4] || set[5];
}

class HeldStrains : public Batch {
 public:
  // Where the rows of one point are: in State::lambda, and its place among System::constraints().
  struct Rows {
    Index multiplier, constraint;
  };

  // Adds an element: ds/dxi [m] and the reference pose at each node, its node indices, what it holds, with which stiffness C^-1
  // of (1) ([N, N.m, N.m2]; zero but for what is held; all zero: none gives way), the rows of each point, and (empty: none) the
  // poses at which its nodes are fixed in those named, H_node^-1 H_own. Returns its index.
  virtual Index add_element(std::span<const double> J, std::span<const Pose<double>> reference,
                            std::span<const int> nodes, const StrainSet& held,
                            const Mat6& stiffness, std::span<const Rows> rows,
                            std::span<const Pose<double>> frames, std::string name) = 0;

  // Of an element: its held sectional forces added to S, one for each point, section frame; and what they make of the forces
  // of its first and last node [N, N.m].
  virtual void add_forces(const State& state, Index element, std::span<Vec6> S) const = 0;
  virtual void add_end_forces(const State& state, Index element, Vec6& first, Vec6& last) const = 0;
  virtual const StrainSet& held(Index element) const = 0;
  virtual const Mat6& stiffness(Index element) const = 0;
};

// Elements of one metric and order (1 ... 8), with Gauss's rule. `give`: what its elements hold has a stiffness, or else none has.
std::unique_ptr<HeldStrains> make_held_strains(Metric metric, int order, bool give = false);

}  // namespace mbd
