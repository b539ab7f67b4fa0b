// How well the elements of a beam resolve its motion, from the nodes alone: how fast the Legendre coefficients of
// the motion within an element fall, and how far strains jump where two elements meet.
//
// Within an element, q(xi) is the logarithm of the pose relative to its first node, known at the N + 1 nodes. A
// constant strain makes it linear whatever the rotation, so that coefficients from the second on are the variation
// of strain:
//   q = sum_n a_n P_n(xi),   a_n = sum_k w_k P_n(xi_k) q(xi_k) / sum_k w_k P_n(xi_k)^2   (GLL rule)     (1)
// |a_n| adds lengths, over that of the element, and angles. Of a smooth motion |a_n| ~ sigma^-n.
//
// Strain at a node, whatever kinematics the element has: e_j = sum_k d_jk log(H_j^-1 H_k) / J_j - the same of the
// reference, linear part and element length times angular part, so that both are numbers.
#pragma once

#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

struct BeamResolution {
  std::string name;
  int order = 0, elements = 0;
  // Over the elements and states looked at, the largest: |a_n|, n = 0 … N (a_0 unused), strain and its jumps,
  // but for those ends at which something is attached (forces step there, and strains with them).
  std::vector<double> coefficients;
  double strain = 0.0, jump = 0.0;

  // sigma, of the last coefficients: by how much one more order lessens what is not resolved; 1 … 1000.
  double decay() const;
  // |a_N| over the largest of all: what the last order still contributes.
  double last() const;
};

// Looks at states of a model.
class ResolutionMeter {
 public:
  explicit ResolutionMeter(const Scene& scene) : scene_(scene) {}
  void look(const Model& model, const State& state);
  const std::vector<BeamResolution>& beams() const { return beams_; }

 private:
  void set_up(const Model& model);

  const Scene& scene_;
  std::vector<BeamResolution> beams_;
  std::vector<std::vector<bool>> attached_;  // by beam and inner end of elements
};

}  // namespace mbd
