// Sectional stiffness and mass along a beam: constant, or interpolated between stations.
#pragma once

#include <memory>

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
// semidefinite), or whose stations do not rise from 0 to 1.
void check_section(const Section& section);

class SectionTable {
 public:
  explicit SectionTable(
      const Section& section);  // that has passed check_section, and outlives this

  bool is_uniform() const { return section_.stations.empty(); }
  bool has_mass() const;
  // At s, a fraction of the beam's reference length. Throws Error where the interpolated matrix is not
  // positive definite (mass: semidefinite).
  Mat6 stiffness(double s) const;
  Mat6 mass(double s) const;
  Mat6 viscosity(double s) const;  // of a section with damping

 private:
  struct Smooth;  // splines of the entries
  Mat6 interpolated(double s, bool of_mass) const;

  const Section& section_;
  std::shared_ptr<const Smooth> smooth_;
};

}  // namespace mbd
