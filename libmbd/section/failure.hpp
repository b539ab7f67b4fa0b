// When a material fails: indices of stresses along its axes L T N.
//
// An index f says which share of its strength a stress is: the criterion predicts failure where f = 1, and, for a stress that grows in
// proportion, at the stress over f. So all indices are linear in the load, and comparable; in print the sums of squares of
// Tsai and Hill, or of Hashin, are f^2, and the polynomial of Tsai and Wu is (a + b f)/f^2 with its squares a and its linear
// terms b.
#pragma once

#include <array>
#include <string_view>

#include "libmbd/core/types.hpp"

namespace mbd::section {

// Stresses at which an orthotropic material fails, all positive [Pa]: tension and compression along L, T, N, and shear.
struct Strengths {
  double lt = 0.0, lc = 0.0, tt = 0.0, tc = 0.0, nt = 0.0, nc = 0.0;
  double s_lt = 0.0, s_ln = 0.0, s_tn = 0.0;
};

enum class Criterion {
  max_stress,  // the largest of the six components, each over its own strength
  tsai_hill,  // Hill 1948 in three dimensions, with the strengths of the side on which each stress lies; where strengths of T
  // and N are alike, in plane stress that of Azzi and Tsai 1965: (s_L^2 - s_L s_T)/X^2 + s_T^2/Y^2 + s_LT^2/S^2
  tsai_wu,  // Tsai, Wu 1971; F_ij = -sqrt(F_ii F_jj)/2 between normal stresses
  hashin  // Hashin 1980, in three dimensions: the largest of fibre and matrix, tension and compression
};
inline constexpr std::array<std::string_view, 4> criterion_names{"max_stress", "tsai_hill",
                                                                 "tsai_wu", "hashin"};

// `stress`: [LL TT NN TN LN LT] [Pa].
double failure_index(Criterion criterion, const Vec6& stress, const Strengths& strengths);

// The stress of von Mises [Pa], along any axes.
double von_mises(const Vec6& stress);
// A of its square s.A s, for stresses that are linear in something.
Mat6 von_mises_form();

}  // namespace mbd::section
