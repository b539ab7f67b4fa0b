// Closed form of a shaft that turns steadily with an eccentric disk at mid-span, and of a beam's first frequency:
// the linear beam with shear, by the classical Runge-Kutta method; knows nothing of elements.
#pragma once

#include <array>

namespace mbd::test {

// Of a plane beam in steady harmonic motion, or in steady rotation: deflection w, tilt psi, shear force Q, moment M,
//   w' = psi + Q/GA,  psi' = M/EI,  Q' = -m W w,  M' = J W psi s - Q,
// W the square of the frequency; s = 1 where the beam turns (a tilted disk straightens), -1 where it vibrates.
struct PlaneBeam {
  double EI = 0.0, GA = 0.0;  // [N.m2], [N]
  double m = 0.0, J = 0.0;    // per length [kg/m, kg.m]
  double W = 0.0;             // [rad2/s2]
  double sign = 1.0;

  using Vector = std::array<double, 4>;  // w, psi, Q, M
  Vector rate(const Vector& y) const {
    return {y[1] + y[2] / GA, y[3] / EI, -m * W * y[0], sign * J * W * y[1] - y[2]};
  }
  // From one end to x.
  Vector at(double x, Vector y, int steps = 2000) const {
    const double h = x / steps;
    const auto ahead = [](const Vector& a, double f, const Vector& b) {
      Vector c{};
      for (std::size_t i = 0; i < 4; ++i) c[i] = a[i] + f * b[i];
      return c;
    };
    for (int k = 0; k < steps; ++k) {
      const Vector a = rate(y), b = rate(ahead(y, h / 2, a)), c = rate(ahead(y, h / 2, b)),
                   d = rate(ahead(y, h, c));
      for (std::size_t i = 0; i < 4; ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
    return y;
  }
};

// Deflection of mid-span of a clamped shaft of length L with a disk of mass M whose centre is e beside the axis.
inline double whirl(const PlaneBeam& beam, double L, double M, double e) {
  const auto shear = beam.at(L / 2, {0, 0, 1, 0}), moment = beam.at(L / 2, {0, 0, 0, 1});
  const double k = 0.5 * M * beam.W;       // Q = k (w + e), psi = 0 at mid-span
  const double r = -shear[1] / moment[1];  // root moment of a root shear force of 1
  const double q = k * e / (shear[2] - k * shear[0] + r * (moment[2] - k * moment[0]));
  return q * (shear[0] + r * moment[0]);
}

}  // namespace mbd::test
