// Momenta of parts that nothing ties to the ground, kept as a whole by a stepper that balances accelerations.
//
// Accelerations in body axes let the sum of momenta drift at the order of the method. What drifts is taken back after each
// step by a rigid motion of the part, which its joints and elements do not feel. With momentum P, angular momentum L about
// the mass centre C, and the force F and moment T of what acts from outside about C (in inertial axes),
//   P' = F,   L' = T,   m C' = P
// are stepped by generalized-alpha itself; then, J being the part's inertia about C,
//   r := r + dC,   v := v + dP/m + dw x (r - C),   w := w + dw,   J dw = dL,
// with what the step has missed. F and T are those of the accelerations, as forces between nodes cancel in the sums. All
// of it is of the order of the error of a step, and is the same in whatever inertial axes, at any place and speed.
//
// Not used: balancing the momenta of each node (Balance::momentum), whose sum is kept too. About one point the moment of
// momentum of a light body that flies by is m r x v, whose error, of order h^2 or that of Newton's iterations, is then
// made up for by its spin: a ball of 0.45 kg and 1e-4 kg.m2 thrown at 36 m/s began to spin at 0.5 rad/s.
#pragma once

#include <span>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

class Archive;

class FreeMomenta {
 public:
  FreeMomenta() = default;  // of nothing
  // Of the parts of a system that nothing holds, but for those with inertia that is not that of masses at nodes (added mass,
  // component modes).
  explicit FreeMomenta(const System& system);

  bool empty() const { return parts_.empty(); }
  int count() const { return static_cast<int>(parts_.size()); }

  // Begins with a state and its accelerations.
  void begin(const State& state);
  // The step changes its size by this ratio.
  void scale(double ratio);
  // Keeps the rate of forces over the last step, of h [s]; what is algorithmic is `by` [s] of it ahead.
  void find_rate(double h);
  void lag(double by);

  // Of the method: V_f = V_i + h [(1 - gamma) A_i + gamma A_f] and so on (generalized_alpha.hpp, equation (1)).
  struct Scheme {
    double alpha_m, alpha_f, gamma, beta;
  };
  // `end`: of a step of h [s] from where the last call left the motion. Its poses and velocities are moved; `Q`, with
  // H_f = H_i exp(Q) by node, follows.
  void keep(const Scheme& scheme, double h, State& end, std::span<Vec6> Q);

  void archive(Archive& a);

 private:
  struct Node {
    Index node = 0;
    Mat6 M = Mat6::Zero();       // body axes
    double mass = 0.0;           // [kg]
    Vec3 center = Vec3::Zero();  // [m] body axes
  };
  struct Part {
    std::vector<Node> nodes;
    double mass = 0.0;
    // At the last accepted time: centre, [P; L], [F; T], and their algorithmic value.
    Vec3 C = Vec3::Zero();
    Vec6 momentum = Vec6::Zero(), force = Vec6::Zero(), algorithmic = Vec6::Zero();
    Vec6 force_old = Vec6::Zero(), rate = Vec6::Zero();  // at the time before; find_rate()
  };
  struct Sums {
    Vec3 C = Vec3::Zero();
    Vec6 momentum = Vec6::Zero(), force = Vec6::Zero();
    Mat3 J = Mat3::Zero();
  };
  static Sums sums(const Part& part, const State& state);

  std::vector<Part> parts_;
};

}  // namespace mbd
