// Linear elastic materials of a cross-section, and how a ply lies in it.
//
// Components of strain are [e11 e22 e33 2e23 2e13 2e12], of stress [s11 s22 s33 s23 s13 s12], along the axes that are
// said: L T N of the material (L along the fibres, N across the ply, T = N x L), or b1 b2 b3 of the section.
//
// A ply in a section (NOTATION.md 8): with its normal n = cos a b2 + sin a b3 (outward, or what the shape says) and its
// angle theta, L = cos theta b1 + sin theta (n x b1), N = n. So theta is positive when L turns from b1 towards
// n x b1: right-handed about n.
#pragma once

#include "libmbd/core/types.hpp"

namespace mbd::section {

// Stiffness against [e11 e22 e33 2e23 2e13 2e12]; symmetric, positive definite.
using Stiffness = Mat6;

// Engineering constants of an orthotropic material in its axes 1 = L, 2 = T, 3 = N; nu_ij is the contraction along j
// by a stress along i, so that nu_ij/E_i = nu_ji/E_j.
struct EngineeringConstants {
  double e1 = 0.0, e2 = 0.0, e3 = 0.0;        // Young's moduli [Pa]
  double g12 = 0.0, g13 = 0.0, g23 = 0.0;     // shear moduli [Pa]
  double nu12 = 0.0, nu13 = 0.0, nu23 = 0.0;  // Poisson's ratios
};

// Of an isotropic material: G = E/(2 (1 + nu)).
EngineeringConstants isotropic(double young, double poisson);

// Transversely isotropic about L: along the fibres E_L, G_LT = G_LN and nu_LT = nu_LN; across them E_T = E_N and nu_TN,
// with G_TN = E_T/(2 (1 + nu_TN)).
EngineeringConstants transversely_isotropic(double e_l, double e_t, double g_lt, double nu_lt,
                                            double nu_tn);

// The stiffness of such a material. Throws Error, saying which constant and its limit, where moduli are not positive
// and finite or the compliance is not positive definite.
Stiffness stiffness_of(const EngineeringConstants& constants);

// Strains along `axes` (columns, right-handed) from those along b1 b2 b3. Its transpose takes stresses along `axes` to those
// along b1 b2 b3.
Mat6 strain_turned(const Mat3& axes);

// The stiffness along b1 b2 b3 of a ply of angle theta whose normal is at the angle a from b2 (radians).
Stiffness in_section_axes(const Stiffness& material, double theta, double a);

// The axes L T N of such a ply, as columns along b1 b2 b3.
Mat3 ply_axes(double theta, double a);

}  // namespace mbd::section
