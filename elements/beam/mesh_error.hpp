// How much of a beam element's deformation its mesh leaves out, estimated from one state, no matter how it was found.
//
// An element of order N knows its resultants S_h = D E best at the N Gauss points (Barlow's), and those at its ends from
// its nodal forces, which are in balance with all that acts on its nodes. The polynomial through both,
//   S*(xi) = S_h at the Gauss points + P_N(xi) (a + b xi),    S*(-1) = -F_0,  S*(1) = F_N            (1)
// P_N Legendre's, is nearly in equilibrium, and by Prager and Synge (Quart. Appl. Math. 5, 1947) the energy of the error is
//   e = 1/2 int (S* - S_h)^T D^-1 (S* - S_h) ds,   of   u = 1/2 int S*^T D^-1 S* ds                  (2)
// e/u is the relative error of the energy, and so of the displacement that a load sees (Clapeyron), of small motions added
// to the state: 1/4 for one element of order 1 of a cantilever with an end load, which is what it misses.
//
// S_h: the polynomial through the points of the element's own rule. Where the section varies within the element that is the
// polynomial of the strains, and S_h = D(xi) E_h(xi) with the D of the section there: a linear moment of a tapered beam is known
// exactly at the points while the element, which has few strains, is too stiff. F_0, F_N: forces of its end nodes [N, N.m].
// Loads and inertia that the element puts on its end nodes are in F: what they do within an element is seen in part.
#pragma once

#include <span>
#include <vector>

#include "elements/beam/held_strains.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/core/types.hpp"

namespace mbd::beam {

struct MeshError {
  double error = 0.0;   // e of (2) [J]
  double energy = 0.0;  // u [J]
  double unit = 0.0;    // of a stretch of 1 [J]: what round-off of energies is measured by
};

// A section that varies within an element: D [N, N.m, N.m2] at points of [-1, 1] with weights that sum to 2, exact for the
// section's table between its stations.
struct SectionSample {
  double xi, weight;
  Mat6 D;
};

// D^-1 of the strains that are not held, 0 in rows and columns of those that are: D^-1 where they had no compliance.
Mat6 compliance_of(const Mat6& D, const StrainSet& held);

// (1) and (2) of elements of one order and rule.
class MeshErrorRule {
 public:
  explicit MeshErrorRule(const SpectralTable& table);

  // Of one element, of length `length` [m], with S_h and D^-1 at the points of its rule; `begin` and `end` are S*(-1) and
  // S*(1) of (1). `samples`: of a section that varies; empty: of one that does not. `held`: strains without compliance.
  MeshError operator()(double length, std::span<const Vec6> S, std::span<const Mat6> compliance,
                       const Vec6& begin, const Vec6& end,
                       std::span<const SectionSample> samples = {},
                       const StrainSet& held = {}) const;

 private:
  VecX best(double xi) const;

  const std::vector<double> points_, gauss_;
  int order_;
  std::vector<double> weights_;  // of the quadrature of (2)
  std::vector<double> at_, P_;   // its points, P_N there
  std::vector<VecX> own_;        // S_h there, of S_h at the points of the rule
  std::vector<VecX> best_;       // of the polynomial through the Gauss points, likewise
  std::vector<int> nearest_;     // point of the rule
  VecX first_, last_;            // best_ at -1, 1
  double sign_;                  // P_N(-1)
};

}  // namespace mbd::beam
