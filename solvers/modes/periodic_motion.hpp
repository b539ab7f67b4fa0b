// Motions that repeat after a period T, and small motions about them (Floquet): what is constant in no axes, as an unround
// rotor on unround supports, a parametrically excited structure, a mechanism that goes round.
//
// Fourier collocation: at N = 2h + 1 instants, evenly spaced over T, poses and multipliers are unknown, and between them all is
// a trigonometric polynomial of degree h, whose derivative is a matrix (Trefethen, Spectral Methods in MATLAB, 2000, ch. 3,
// for odd N):
//   D_ij = (pi/T) (-1)^(i-j) / sin(pi (i-j)/N),  D_ii = 0                                             (1)
//   V~ = H^-1 H',  H' = D H by entries of position and rotation matrix,  Vdot = D V                   (2)
// The equations of motion and the constraints hold at each instant: Newton's method on
//   M u'' + C u' + K u + B^T dlambda = -r,  B u = -g,   u' = D u                                      (3)
//   K = dr/dU + dr/dV V~ + dr/dVdot Vdot~,  C = dr/dV + dr/dVdot V~,  M = dr/dVdot
// with increments u in body axes (HB 15). Errors fall with h faster than any power where the motion is smooth.
//
// Small motions u = exp(l t) p(t), p of period T (Floquet's theorem): (3) with r = 0 and D + l in place of D, a quadratic
// eigenvalue problem (Hill's), with constraints as they are and no monodromy matrix. With l is l + 2 pi i k/T, any k, the
// same motion: what lies in |Im l| <= pi/T is all of them. exp(l T) are Floquet's multipliers.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/modes/eigenmodes.hpp"
#include "solvers/modes/motion_pencil.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

struct PeriodicReport {
  bool converged = false;
  int iterations = 0;
  // Of the motion's velocities, the largest amplitude of the two fastest harmonics beside the largest of all: what N leaves
  // out is of that size.
  double tail = 0.0;
  std::string failure;  // when not converged
};

class PeriodicMotion final : public MotionPencil {
 public:
  // `system` has rates (System::with_rates) and outlives this. `period` > 0 [s], `harmonics` h >= 1.
  PeriodicMotion(const System& system, double begin, double period, int harmonics);
  ~PeriodicMotion() override;

  Index instants() const { return static_cast<Index>(times_.size()); }
  double time(Index i) const { return times_[static_cast<std::size_t>(i)]; }
  double period() const { return period_; }

  // Moves states at the instants, poses and multipliers near those of a periodic motion, to one; their rates follow
  // from (2). Fails where Newton's method does not converge, and where the motion is not isolated: (3) is singular.
  PeriodicReport solve(const NewtonOptions& options, std::vector<State>& states);

  // Of the solution: states at the instants.
  const std::vector<State>& states() const { return states_; }

  // Amplitudes of the harmonics -h … h of p [m over the scene's length, rad], root of the sum of squares over nodes; motions
  // of all instants. In body axes, or turned into inertial ones.
  VecX harmonics(const VecXc& p, bool inertial = false) const;

  // As a pencil: motions of the first instant, then those of the second, ….
  Index motions() const override { return instants() * motions_; }
  double length_scale() const override { return system_.length_scale(); }
  bool is_damped_or_turns() const override { return true; }
  using MotionPencil::mass_times;
  using MotionPencil::rate_times;
  Eigen::MatrixXd mass_times(const Eigen::MatrixXd& X) const override;
  Eigen::MatrixXd rate_times(const Eigen::MatrixXd& X) const override;
  bool factor(double s) override;
  bool factor(std::complex<double> s) override;
  void solve(Eigen::MatrixXd& B) const override;
  void solve(Eigen::MatrixXcd& B) const override;

 private:
  struct Solvers;

  // Velocities and accelerations of (2).
  void differentiate(std::vector<State>& states) const;
  // M, C, K and B at all instants; false if an element is out of range.
  bool linearize(const std::vector<State>& states, VecX& r);
  // Of an increment x the share that is taken. `e`: its size, not finite if that of an instant is not.
  double share_of(const VecX& x, const IncrementNorm& norm, double& e) const;
  double tail(const std::vector<State>& states) const;  // of the harmonics of velocities; 0 at rest
  template <class Scalar>
  struct Factors;
  // add(i, row, j, column, value) for the summands of every entry, of instants and their unknowns.
  template <class Scalar, class Add>
  void each_entry(Scalar s, const Add& add) const;
  template <class Scalar>
  Eigen::SparseMatrix<Scalar> assemble(Scalar s) const;
  // r -= A x of all unknowns; sizes += |A| |x|, if that is asked for.
  template <class Scalar>
  void subtract_times(Scalar s, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& x,
                      Eigen::Ref<Eigen::Matrix<Scalar, Eigen::Dynamic, 1>> r, VecX* sizes) const;
  template <class Scalar>
  bool factor_with(Factors<Scalar>& factors, Scalar s);
  template <class Scalar>
  std::optional<int> refinements_of(const Factors<Scalar>& factors) const;
  template <class Scalar>
  void solve_with(const Factors<Scalar>& factors,
                  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& B) const;

  const System& system_;
  double period_;
  Index motions_, unknowns_;  // of an instant
  std::vector<double> times_;
  Eigen::MatrixXd D_;
  std::vector<State> states_;
  double stiffness_ = 0.0;
  // By instant: M, C of motions; K with the rows and columns of constraints.
  std::vector<Eigen::SparseMatrix<double>> M_, C_, K_;
  std::unique_ptr<Solvers> solvers_;
};

// A small motion about a periodic one.
struct FloquetMode {
  std::complex<double> exponent;    // l [1/s], 0 <= Im l <= pi/T
  std::complex<double> multiplier;  // exp(l T), of a conjugate pair one
  // Frequency of the largest harmonic [rad/s]: of a motion that hardly feels the period, the one that it has without.
  double frequency = 0.0;
  double inertial = 0.0;  // the same in inertial axes: of a rotor, as its bearings feel it
  double tail = 0.0;      // share of the fastest two harmonics, as PeriodicReport::tail
  double residual = 0.0;  // as Mode::residual
  VecXc shape;            // p, of all instants
};

struct FloquetFound {
  std::vector<FloquetMode> modes;  // the least stable first
  bool all = false;                // that N resolves; otherwise those of the smallest exponents
  std::string failure;
};

// Of a solution. At most some `most` exponents.
FloquetFound find_floquet_modes(PeriodicMotion& motion, int most);

}  // namespace mbd
