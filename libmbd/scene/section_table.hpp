// Sectional stiffness and mass along a beam: constant, or interpolated between stations.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "libmbd/core/spectral.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// Eigenvalues of a stiffness or a mass, relative to the largest after scaling, below which it is not definite.
inline constexpr double definite = 1e-12;

// Smallest eigenvalue of a symmetric matrix scaled to a unit diagonal: independent of units.
double scaled_definiteness(const Mat6& M);

// The same of a matrix whose rows may be zero: they do not count. -1 for a diagonal entry that is negative, or zero and
// coupled.
double definiteness_of_some(Mat6 M);

// C = beta D + viscous entries, where the elastic stiffness is D [N.s, N.m.s, N.m2.s].
Mat6 viscosity(const SectionDamping& damping, const Mat6& D);

// Throws Error for a section that is not symmetric, positive definite (its mass and its damping:
// semidefinite), or whose stations do not rise from 0 to 1. Stiffnesses on the diagonal may be infinite: not all of one
// section, the same at all stations, without couplings.
void check_section(const Section& section);

// The strains in which D is infinite; of a section that of the first of its stations, as all are alike in it.
std::array<bool, 6> infinite_stiffnesses(const Mat6& D);
std::array<bool, 6> infinite_stiffnesses(const Section& section);

class SectionTable {
 public:
  // A section that has passed check_section, and outlives this. In place of what is infinite stand stiffnesses like the
  // others over `length` [m], so that matrices are finite and definite: who minds asks held().
  explicit SectionTable(const Section& section, double length = 1.0);

  bool is_uniform() const { return section_->stations.empty(); }
  bool has_mass() const;
  // Strains [gamma; kappa] of infinite stiffness, the same along the beam.
  const std::array<bool, 6>& held() const { return held_; }
  // At s, a fraction of the beam's reference length. Throws Error where the interpolated matrix is not
  // positive definite (mass: semidefinite).
  Mat6 stiffness(double s) const;
  Mat6 mass(double s) const;
  // C where the stiffness is D, of a section with damping; `s` is for messages.
  Mat6 viscosity_of(const Mat6& D, double s) const;

  // Points of [a, b] and weights, which sum to b - a: exact for entries of the table times polynomials of degree 12,
  // whether there are stations between or not.
  struct Sample {
    double s, weight;
  };
  std::vector<Sample> rule(double a, double b) const;

  // The mean stiffness that acts at a quadrature point of an element on [a, b]: the integral of the table times the
  // Lagrange polynomial of the point, over the point's weight. So energies of strains of degree N - 1 are those of the
  // table. `rule`: on [-1, 1]. Where such a mean is not positive definite (tables that change much within
  // the element), it is the stiffness at the point. Throws Error as stiffness() does.
  std::vector<Mat6> stiffnesses(double a, double b, const Quadrature& rule) const;

  // The same for masses of the nodes (GLL points on [-1, 1]): integrals of mass times their polynomials, in parts of
  // b - a. They sum to the mass between a and b to round-off, and so does the first moment of a straight element. Where
  // one is not semidefinite, each bit of mass is shared by the two nodes beside it: sum and moment are the same.
  std::vector<Mat6> masses(double a, double b, const Quadrature& nodes) const;

 private:
  struct Smooth;  // splines of the entries
  Mat6 interpolated(double s, bool of_mass) const;

  const Section* section_;
  std::shared_ptr<const Section> finite_;  // where something is infinite
  std::array<bool, 6> held_;
  std::shared_ptr<const Smooth> smooth_;
};

}  // namespace mbd
