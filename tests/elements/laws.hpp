// Laws of elements, to be tried on any of them: tangents by dual numbers, random beams at large motions.
//
// Norms. Forces and moments, displacements and rotations are made comparable by a length l of the case:
// rows and columns of rotations are divided by l. `tangent_error` is then the largest difference over the
// largest entry. Round-off of a force is measured in `force_unit` = eps * (largest scaled entry of the
// tangent) * l: what one rounding of a position does.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "elements/element.hpp"
#include "libmbd/core/choices.hpp"
#include "libmbd/core/dual.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/core/system.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"

namespace mbd {
class BeamElasticBatch;
}

namespace mbd::laws {

using test::eps;
using test::Rng;
using test::Worst;
using D1 = Dual<double>;
using Eigen::MatrixXd;

// H exp(eps U), written out to first order.
Pose<D1> seeded(const Pose<double>& H, const Vec6& U);
Vector6<D1> seeded(const Vec6& V, const Vec6& dV);

// 1 for displacements, l for rotations.
VecX units(Index rows, double l);
MatrixXd scaled(const MatrixXd& K, double l);
double force_size(const VecX& r, double l);
double tangent_size(const MatrixXd& K, double l);
double tangent_error(const MatrixXd& got, const MatrixXd& want, double l);

// The wrenches F_a on frames H_a together, about the first frame's origin: inertial components.
Vec6 resultant(const VecX& F, const std::vector<Pose<double>>& H);

// For a force that is the gradient of a potential, in body-frame increments:
// eta.K xi - xi.K eta = F.[xi, eta] = F.(xi~ eta), so K - K^T = blockdiag(F_a^U). Zero at equilibrium.
MatrixXd skew_part(const VecX& F);

// A batch by itself, through the interface that a System has of it. Node k is node k + 1 of the state: the ground
// takes no part.
struct BatchValue {
  VecX r;
  MatrixXd K, D;  // of poses, of rates with the weights given
  bool in_range = false;
};
BatchValue linearized(Batch& batch, const State& state, RateWeights w);
// The residual alone, out of range empty.
VecX residual_of(const Batch& batch, const State& state);
// A state of these nodes.
State state_of(const std::vector<NodeState<double>>& x, const Environment& env);

// --- beams ---

// One element and a state of it.
struct Beam {
  Metric metric;
  Form form;
  Rule rule;
  int order;
  double length;
  std::vector<double> J;
  std::vector<Pose<double>> reference, pose;
  std::vector<Mat6> D;  // one, or one a quadrature point
  Kinematics kinematics = Kinematics::motion;
};

double max_angle(const std::vector<Pose<double>>& H);

// Rotations exp(f phi_k) whose largest relative angle is the given one.
void set_rotations(std::vector<Pose<double>>& H, const std::vector<Vec3>& phi, double angle);

// Curved, twisted, unevenly spaced reference; full random D, in half of the cases one a point. The state is,
// by turns: rotations varying smoothly; rotations at random, node by node; the reference slightly deformed.
Beam random_beam(Rng& rng, Metric metric, Form form, Rule rule, int order, double range,
                 double angle);

// A smooth curve, strained, s = 0 … 1, of a curved reference of length 1; body-frame fields along it.
Vec6 smooth_field(int n, double s);
// K with K~ = H^-1 H'.
Vec6 curvature_of(const std::function<Pose<D1>(const D1&)>& curve, double s);
// Element e of n along the smooth curve.
Beam smooth_element(Metric metric, Form form, int order, int e, int n, const Mat6& D);

struct BeamValue {
  VecX r;
  MatrixXd K;
  double energy = 0.0;
  bool in_range = false;
};

// The element in a batch of its own, through the interface that a System has of it. Node k is node k + 1
// of the System: the ground takes no part.
class BeamSystem {
 public:
  BeamSystem(const Beam& beam, bool run_time_order);

  const System& system() const { return system_; }
  State state(const std::vector<Pose<double>>& pose) const;
  BeamValue operator()(const std::vector<Pose<double>>& pose);
  VecX residual(const std::vector<Pose<double>>& pose) const;
  Vec6 resultants(const std::vector<Pose<double>>& pose, double xi) const;
  double energy(const std::vector<Pose<double>>& pose) const;

 private:
  System system_;
  const BeamElasticBatch* batch_ = nullptr;
  test::DenseSolver dense_;
};

std::vector<NodeState<double>> node_states(const std::vector<Pose<double>>& pose);

// --- of a kernel on dual numbers (dual_beams.cpp), for an order known at run time ---

// Tangent of the residual at the beam's pose.
MatrixXd dual_tangent(const Beam& b);
// Gradient of the energy there.
VecX dual_energy_gradient(const Beam& b);

// What the elements of a metric and form, and those of the classical beam, have in common: to be called by the tests of each.
class BeamLaws {
 public:
  BeamLaws(Metric metric, Form form) : metric_(metric), form_(form) {}
  // The classical beam: its metric and form are not used.
  static BeamLaws classical();

  double largest_angle() const;  // between two nodes, of the metric [rad]
  Beam random(Rng& rng, Rule rule, int order, double angle) const;
  // f(rng, beam) for orders 1 … 8, both rules, largest relative angles up to 0.9 of the singular one.
  void sample(int count, const std::function<void(Rng&, const Beam&)>& f) const;
  static std::string name(const Beam& b);

  void tangent_is_the_derivative() const;
  void tangent_fails_under_mutation() const;
  void residual_is_the_same_with_and_without_tangent() const;
  void sizes_agree() const;
  void objectivity() const;
  void rigid_motion_costs_nothing() const;
  void force_is_as_written() const;
  void rolls_up_exactly() const;
  void rank() const;
  void range() const;
  void energy_converges_to_the_continuum() const;

 private:
  Metric metric_;
  Form form_;
  Kinematics kinematics_ = Kinematics::motion;
};

// For suites that go through metrics.
inline std::string metric_name(const testing::TestParamInfo<Metric>& metric) {
  return metric.param == Metric::matrix       ? "matrix"
         : metric.param == Metric::quaternion ? "quaternion"
                                              : "geodesic";
}

}  // namespace mbd::laws
