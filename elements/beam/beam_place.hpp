// The motion of a place within a beam element: that of the interpolation between its nodes. For output only; its rates
// are the derivatives of the interpolated pose in time, so that position, velocity and acceleration belong together.
//
// kinematics="motion". H and q_k as in beam_field.hpp (1), of which, with V_k of the nodes, the derivatives are
//   V  = B^-1 sum_k l_k T^-1(q_k) V_k,   B = sum_k l_k T^-1(-q_k)                                  (1)
//   V' = B^-1 sum_k l_k { T^-1(q_k) V_k' + [T^-1(q_k)]' V_k - [T^-1(-q_k)]' V }                    (2)
// (1) is linear: solved as it stands. In (2) T^-1 is differentiated by dual numbers along the relative motion of each
// node, g_k' = g_k (V_k - Ad(g_k^-1) V)~: exact, with the one expression of T^-1 that each metric has. The increments
// of an iteration with dual numbers throughout would cost its derivatives in each of its steps.
//
// kinematics="classical". r = sum_k l_k r_k, a = sum_k l_k s_k p_k, p = a/|a| (beam_classical.hpp), n = a.a:
//   p_k' = p_k [0; w_k]/2,   p_k'' = (p_k' [0; w_k] + p_k [0; w_k'])/2                             (3)
//   w = 2 Im(a* a')/n,   w' = 2 Im(a* a'')/n - 2 (a.a'/n) w                                        (4)
//
// At a node both are that of the node, and of nodes in a rigid motion that motion. Between nodes the pose is of order
// N + 1 in the length of elements, at the ends of elements (statics) of order 2 N.
//
// Symbols: V = [v; w], V' [m/s, rad/s; m/s2, rad/s2], body frame of the place; l_k Lagrange polynomials of the nodes.
#pragma once

#include <span>

#include "elements/element.hpp"
#include "libmbd/core/choices.hpp"

namespace mbd::beam {

// Where the polynomials are `l`, one for each node of the element. Without `rates` V and Vdot are zero, and
// those of the nodes are not read. Throws Error where the nodes are turned too far against each other for the metric.
NodeState<double> motion_within(Kinematics kinematics, Metric metric,
                                std::span<const NodeState<double>> nodes, const VecX& l,
                                bool rates);

}  // namespace mbd::beam
