// The static models as rods (support/rod_path.hpp): their numbers, independent of the library's elements.
#pragma once

#include <numbers>

#include "tests/support/rod_path.hpp"

namespace mbd::test {

// A straight cantilever along i1, b3 = i3, under a dead force at its tip. The unknown is the moment at the
// clamp; there is none at the tip. Returns the tip.
inline RodSection<double> cantilever_tip(double length, const RodMatrix& D,
                                         const Eigen::Vector3d& force, int steps = 24) {
  const RodPiece piece{length, compliance_of(D), 0, steps};
  const double unit = force.norm() * length;
  double load = 0.0;
  const auto tip = [&]<class S>(const Unknowns<S>& z) {
    RodSection<S> clamp;
    clamp.n = (load * force).cast<S>();
    clamp.m = unit * Three<S>(z);
    return integrate(piece, clamp);
  };
  const auto residual = [&]<class S>(const Unknowns<S>& z) { return Unknowns<S>(tip(z).m / unit); };
  Eigen::VectorXd z = Eigen::VectorXd::Zero(3);
  for (int k = 1; k <= 8; ++k) {
    load = k / 8.0;
    z = solve_shooting(residual, z);
  }
  return tip(z);
}

// The four-bar of models/four_bar_static.xml: hinges at A, B about i3, at C about an axis turned by `tilt`
// about i2, D clamped; a dead moment M about i3 on the first bar at A.
struct FourBarRod {
  RodMatrix D12, D3;
  double tilt = 5 * std::numbers::pi / 180, M = 200;
  double l1 = 0.12, l2 = 0.24, l3 = 0.12;
  int steps = 12;

  template <class S>
  struct Sections {
    RodSection<S> A, B, C, D;  // ends of the bars, seen from the bar before; A from the first
    Three<S> axis_B, axis_C;   // inertial
    S angle_A;                 // of the first bar, about i3
  };
  // z = [force at A (3) over 1000 N; moment at A about i1, i2 over 100 N.m; angles of A, B, C].
  template <class S>
  Sections<S> sections(const Unknowns<S>& z, double factor) const {
    const Eigen::Vector3d e3(0, 0, 1), c(std::sin(tilt), 0, std::cos(tilt));
    const double right = std::numbers::pi / 2;
    const Rotation<S> R1 = turn<S>(e3, S(right)), R3 = turn<S>(e3, S(-right));  // of the second: I
    Sections<S> at;
    at.angle_A = z(5);
    at.A.R = turn<S>(e3, z(5)) * R1;
    at.A.n = 1000.0 * z.template head<3>();
    at.A.m << 100.0 * z(3), 100.0 * z(4), S(-factor * M);
    at.B = integrate({l1, compliance_of(D12), 0, steps}, at.A);
    RodSection<S> next = at.B;
    next.R = at.B.R * R1.transpose();
    at.axis_B = next.R * e3.cast<S>();
    next.R = next.R * turn<S>(e3, z(6));
    at.C = integrate({l2, compliance_of(D12), 0, steps}, next);
    next = at.C;
    at.axis_C = next.R * c.cast<S>();
    next.R = next.R * turn<S>(c, z(7)) * R3;
    at.D = integrate({l3, compliance_of(D3), 0, steps}, next);
    return at;
  }
  Sections<double> solve(int load_steps = 8) const {
    double factor = 0.0;
    const auto residual = [&]<class S>(const Unknowns<S>& z) {
      const Sections<S> at = sections(z, factor);
      const Eigen::Matrix3d R3 = turn<double>(Eigen::Vector3d(0, 0, 1), -std::numbers::pi / 2);
      const Rotation<S> W = R3.transpose().cast<S>() * at.D.R;
      Unknowns<S> y(8);
      y << (at.B.m.transpose() * at.axis_B)(0) / 100.0, (at.C.m.transpose() * at.axis_C)(0) / 100.0,
          at.D.r(0) - l2, at.D.r(1) - (l1 - l3), at.D.r(2), W(2, 1), W(0, 2), W(1, 0);
      return y;
    };
    Eigen::VectorXd z = Eigen::VectorXd::Zero(8);
    for (int k = 1; k <= load_steps; ++k) {
      factor = double(k) / load_steps;
      z = solve_shooting(residual, z);
    }
    return sections<double>(z, 1.0);
  }
};

}  // namespace mbd::test
