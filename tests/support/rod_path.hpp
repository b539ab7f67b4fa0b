// Elastic rods by shooting, to round-off, and the paths of their equilibria: independent of the library's
// elements and of its solvers. A planar rod is one whose unknowns stay in a plane.
//
// Uniform pieces under end forces; inertial components n, m of force and moment, section frame (R, r):
//   r' = R t,  R' = R k~,  [t; k] = K0 + D^-1 [R^T n; R^T m],  n' = 0,  m' = -r' x n               (1)
// (Antman, Nonlinear Problems of Elasticity, ch. VIII.) n and m are what the part beyond the section exerts
// on the part before it. Integrated by Gragg's midpoint rule, extrapolated to order 12 (Hairer, Norsett,
// Wanner, Solving Ordinary Differential Equations I, II.9). Boundary conditions are n equations for n + 1
// unknowns, the last of them the load:
//   F(z) = 0,  z = [start values; load]                                                              (2)
// The derivative of F is that of the integrator, by complex steps of 1e-40, exact to round-off. The path is
// followed along its tangent t, F_z t = 0; on it
//   t_load = 0                a limit point of the load                                              (3)
//   det [F_z; t^T] = 0        a simple bifurcation (it does not vanish at a limit point)             (4)
// (Keller, Numerical Methods in Bifurcation Problems, 1987.)
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "tests/support/rod.hpp"

namespace mbd::test {

using Complex = std::complex<double>;
template <class S>
using Unknowns = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using Three = Eigen::Matrix<S, 3, 1>;
template <class S>
using Rotation = Eigen::Matrix<S, 3, 3>;

// Without the conjugates of Eigen's cross product of complex vectors.
template <class S>
Rotation<S> cross_matrix(const Three<S>& v) {
  Rotation<S> M;
  M << S(0), -v(2), v(1), v(2), S(0), -v(0), -v(1), v(0), S(0);
  return M;
}

// By an angle [rad] about a unit axis.
template <class S>
Rotation<S> turn(const Eigen::Vector3d& axis, S angle) {
  using std::sin, std::cos;
  const Rotation<S> a = cross_matrix<S>(axis.cast<S>());
  return Rotation<S>::Identity() + sin(angle) * a + (S(1) - cos(angle)) * a * a;
}

struct RodPiece {
  double length = 1.0;   // [m]
  RodMatrix compliance;  // D^-1
  double curvature = 0;  // of the reference line about b3 [1/m]
  int steps = 16;        // of the integration
};

inline RodMatrix compliance_of(const RodMatrix& D) { return dense::inverse(D); }
inline RodMatrix compliance_of(double EA, double GA2, double GA3, double GJ, double EI2,
                               double EI3) {
  RodVector d;
  d << EA, GA2, GA3, GJ, EI2, EI3;
  return d.cwiseInverse().asDiagonal();
}

template <class S>
struct RodSection {
  Rotation<S> R = Rotation<S>::Identity();
  Three<S> r = Three<S>::Zero(), n = Three<S>::Zero(),
           m = Three<S>::Zero();  // inertial [m, N, N.m]
};

// From the start of a piece to its end; of real and of complex numbers.
template <class S>
RodSection<S> integrate(const RodPiece& piece, const RodSection<S>& start);

// dF/dz of a function of any scalar.
template <class F>
Eigen::MatrixXd jacobian(const F& f, const Eigen::VectorXd& z) {
  constexpr double h = 1e-40;
  Eigen::MatrixXd J;
  for (Eigen::Index c = 0; c < z.size(); ++c) {
    Unknowns<Complex> y = z.cast<Complex>();
    y(c) += Complex(0, h);
    const Unknowns<Complex> value = f(y);
    if (c == 0) J.resize(value.size(), z.size());
    J.col(c) = value.imag() / h;
  }
  return J;
}

// z with F(z) = 0, as many equations as unknowns of order one. Throws when Newton's method fails.
template <class F>
Eigen::VectorXd solve_shooting(const F& f, Eigen::VectorXd z, int iterations = 40) {
  double last = 0.0;
  for (int k = 0; k < iterations; ++k) {
    const Eigen::VectorXd step = dense::solve(jacobian(f, z), Unknowns<double>(f(z)));
    const double size = step.norm() / (1.0 + z.norm());
    if (!std::isfinite(size)) break;
    z -= step * std::min(1.0, 1.0 / size);
    if (size < 1e-14 || (size < 1e-9 && size > 0.1 * last)) return z;  // the floor of round-off
    last = size;
  }
  throw std::runtime_error("shooting: Newton's method does not converge");
}

struct PathPoint {
  Eigen::VectorXd z, t;   // |t| = 1
  double bordered = 0.0;  // det [F_z; t^T]
  double load() const { return z(z.size() - 1); }
};

// The path F(z) = 0; unknowns of order one.
template <class F>
class EquilibriumPath {
 public:
  explicit EquilibriumPath(const F& f) : f_(f) {}

  // The point with z's component c as it is in the guess, its tangent along `direction`.
  PathPoint at(const Eigen::VectorXd& guess, Eigen::Index c,
               const Eigen::VectorXd& direction) const {
    return point(guess, Eigen::VectorXd::Unit(guess.size(), c), guess(c), direction);
  }
  // A step along the tangent.
  PathPoint step(const PathPoint& p, double length) const {
    return point(p.z + length * p.t, p.t, p.t.dot(p.z) + length, p.t);
  }
  // Where an event changes its sign within the next `most` steps of a length, shorter ones where the path
  // turns; `p` becomes the last point before it. By Illinois' false position to round-off.
  template <class Event>
  PathPoint find(PathPoint& p, double length, int most, const Event& event) const {
    for (int k = 0; k < most; ++k) {
      double b = length;
      const PathPoint next = safe_step(p, b);
      double a = 0.0, fa = event(p), fb = event(next);
      if (fa * fb > 0.0) {
        p = next;
        continue;
      }
      PathPoint x = next;
      for (int i = 0; i < 60 && std::abs(b - a) > 1e-14; ++i) {
        const double s = b - fb * (b - a) / (fb - fa);
        x = step(p, s);
        const double fs = event(x);
        if (fs == 0.0 || std::abs(s - b) < 1e-14) break;
        if (fs * fb < 0.0) {
          a = b, fa = fb;
        } else {
          fa *= 0.5;
        }
        b = s, fb = fs;
      }
      return x;
    }
    throw std::runtime_error("path: no such point within reach");
  }

 private:
  // Halves the length until the next point is on the same path: near the tangent, its own much the same.
  PathPoint safe_step(const PathPoint& p, double& length) const {
    for (int k = 0; k < 12; ++k, length *= 0.5) {
      try {
        PathPoint next = step(p, length);
        if ((next.z - p.z - length * p.t).norm() < 0.3 * length && next.t.dot(p.t) > 0.9)
          return next;
      } catch (const std::runtime_error&) {  // shorter, then
      }
    }
    throw std::runtime_error("path: lost");
  }
  PathPoint point(const Eigen::VectorXd& guess, const Eigen::VectorXd& row, double value,
                  const Eigen::VectorXd& direction) const {
    const auto closed = [&]<class S>(const Unknowns<S>& z) {
      const Unknowns<S> y = f_(z);
      Unknowns<S> g(y.size() + 1);
      g << y, (row.transpose().cast<S>() * z)(0) - value;
      return g;
    };
    PathPoint p;
    p.z = solve_shooting(closed, guess);
    Eigen::MatrixXd J(guess.size(), guess.size());
    J.topRows(guess.size() - 1) = jacobian(f_, p.z);
    J.bottomRows(1) = direction.transpose();
    p.t = dense::solve(J, Eigen::VectorXd(Eigen::VectorXd::Unit(guess.size(), guess.size() - 1)));
    p.t.normalize();
    J.bottomRows(1) = p.t.transpose();
    p.bordered = dense::determinant(J);
    return p;
  }

  const F& f_;
};

inline double limit_event(const PathPoint& p) { return p.t(p.t.size() - 1); }
inline double branch_event(const PathPoint& p) { return p.bordered; }

}  // namespace mbd::test
