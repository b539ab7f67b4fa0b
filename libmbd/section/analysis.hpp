// The central solutions of a beam over the finite elements of its section: D, M and the fields of warping
// (NOTATION.md 8; Giavotto et al. 1983, Han and Bauchau 2014 and 2015).
//
// Strains and resultants are those of the beam: [gamma; kappa] and [N1 Q2 Q3 M1 M2 M3] about the point x2 = x3 = 0.
#pragma once

#include <Eigen/Core>

#include "libmbd/section/mesh.hpp"

namespace mbd::section {

// Curvature of the reference line of the stress-free beam along b1 b2 b3 [1/m]: twist k1, k2 and k3.
struct Analysis {
  Mat6 stiffness;     // D, from the energy of the central solutions    [N, N m, N m^2]
  Mat6 mass;          // M, per length of the reference line             [kg/m, kg, kg m]
  Mat6 compliance;    // inverse of D
  double area = 0.0;  // integral of dA (without the metric)             [m^2]

  // Central solution for the resultant c: displacement of node i in section axes, less that of the section as a rigid one,
  // is rows 3i .. 3i + 2 of column c; its gauge is that of strains' Gamma below.   [m/N, m/(N m)]
  Eigen::MatrixXd warping;  // (3 nodes x 6)
  Mat6 gamma;               // strain [gamma; kappa] of the section as a rigid one, in that gauge

  // What must come out zero, relative: multipliers of the six conditions on the gauge, and Z^T P - 1.
  double largest_multiplier = 0.0;
  double largest_imbalance = 0.0;

  // What it cost: matrices factorised, one of a straight beam and two of a curved one; right-hand sides that went through
  // the factors.
  int factorisations = 0, solutions = 0;
};

// How resultants change along a line of that curvature that bears no loads: S' = transport S.
Mat6 transport_of(const Vec3& curvature);

// Throws Error where an element has no positive area or too few nodes, the metric sqrt(g) = 1 + k2 x3 - k3 x2 is not
// positive somewhere, parts of the mesh are not joined, or a material is not positive definite.
Analysis analyse(const Mesh& mesh, const Vec3& curvature = Vec3::Zero());

}  // namespace mbd::section
