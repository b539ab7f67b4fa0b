// Component modes of a part of a structure about its reference configuration (Craig, Bampton, AIAA Journal 6, 1968):
// static shapes of unit motions of the nodes at which it is held, its interfaces, and the slowest modes with these fixed. They
// become an element (elements/component) whose unknowns are motions of nodes: those of the interfaces, and of some within.
//
// With I the interfaces but one, the frame; m the nodes within that are kept; i all others; everything relative to the frame:
//   u_i = G_I u_I + G_m u_m + X q,   [G_I G_m] = -K_ii^-1 [K_iI K_im],                               (1)
//   X = F_i - G_m F_m,   q = F_m^+ (u_m - S_m u_I),   S = -K_JJ^-1 K_JI,   J = m and i                    (2)
// F: the modes with the interfaces fixed, of which (1) has all exactly, as the static shapes S; where there are more unknowns
// than modes, the rest are static shapes of u_m (hybrid reduction: Kammer, Int. J. Anal. Exp. Modal Analysis 6, 1991). Rigid
// motions, where q = 0, are exact. Nodes m: one after the other that which moves most in what those before do not show of
// the modes, until the smallest singular value of F_m (displacements over the size of the part) is a hundredth of the largest.
// Not used: q as unknowns of their own, which would be no motions of nodes; error control, pictures and joints know those.
#pragma once

#include <span>
#include <vector>

#include "elements/component/component.hpp"
#include "solvers/modes/small_motions.hpp"

namespace mbd {

struct ComponentModes {
  component::Data element;
  Eigen::MatrixXd M;       // of component.hpp (5)
  std::vector<int> nodes;  // of the element: the frame, the other interfaces, those within
  // Deformation of every node but the ground, of u of the element, body axes: 6 rows a node [m, rad].
  Eigen::MatrixXd shapes;
};

// At most so many nodes may an element have: its matrices are full.
inline constexpr std::size_t most_component_nodes = 200;

// `motions`: about the reference configuration at rest. `interfaces`: nodes, each once, the frame first. `mass_damping`: by node
// of the system, what of the rates is proportional to mass and not to rates of strain (mass_damping.hpp); empty: none.
// Throws Error, without a place, for parts that are not held together, more modes than there are, too many nodes.
ComponentModes component_modes(const SmallMotions& motions, std::span<const int> interfaces,
                               int modes, std::span<const Mat6> mass_damping = {});

}  // namespace mbd
