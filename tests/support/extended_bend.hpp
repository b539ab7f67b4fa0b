// The bend45 scene (a clamped arc under a dead tip force) solved in long double: the elastic kernel of the
// library on constants, reference poses, states and loads of that type, so that round-off is about 1e-18 of
// the displacement and errors of the discretisation show down to there.
#pragma once

#include "elements/beam/beam_elastic_batch.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd::test {

// Units as the scene's: in, lb, rad. Reference line (R (1 - cos t), R sin t, 0), t = 0 … angle, clamped at
// the start; b1 the tangent, b3 = i3.
struct ExtendedBend {
  using Real = long double;
  Metric metric = Metric::geodesic;
  Form form = Form::energy;
  Rule rule = Rule::gauss;
  int order = 3;
  int elements = 8;
  Real radius = 100.0L;
  Real angle = 0.785398163397448309615660845819875721L;  // pi/4
  Matrix6<Real> D = printed_stiffness();                 // [N; M] vs [gamma; kappa]
  Vector3<Real> force = Vector3<Real>(0.0L, 0.0L, 600.0L);

  // HB 9.1, as printed.
  static Matrix6<Real> printed_stiffness();
};

struct ExtendedSolution {
  bool converged = false;
  int iterations = 0;            // at the full load
  long double increment = 0.0L;  // norm of the last increment of the positions over the radius
  Vector3<long double> tip;      // displacement
};

// Load steps of a quarter, halved where Newton's method with the exact tangent does not converge; each until
// the increments are round-off.
ExtendedSolution solve(const ExtendedBend& bend);

}  // namespace mbd::test
