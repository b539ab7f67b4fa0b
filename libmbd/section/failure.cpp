#include "libmbd/section/failure.hpp"

#include <algorithm>
#include <cmath>

namespace mbd::section {
namespace {

double square(double x) { return x * x; }

// The positive f with a/f^2 + b/f = 1.
double share(double a, double b) { return 0.5 * (b + std::sqrt(b * b + 4.0 * std::max(a, 0.0))); }

double max_stress(const Vec6& s, const Strengths& of) {
  const auto normal = [](double x, double tension, double compression) {
    return x >= 0.0 ? x / tension : -x / compression;
  };
  return std::max({normal(s(0), of.lt, of.lc), normal(s(1), of.tt, of.tc),
                   normal(s(2), of.nt, of.nc), std::abs(s(3)) / of.s_tn, std::abs(s(4)) / of.s_ln,
                   std::abs(s(5)) / of.s_lt});
}

double tsai_hill(const Vec6& s, const Strengths& of) {
  const auto side = [](double stress, double tension, double compression) {
    return 1.0 / square(stress >= 0.0 ? tension : compression);
  };
  const double x = side(s(0), of.lt, of.lc), y = side(s(1), of.tt, of.tc),
               z = side(s(2), of.nt, of.nc);
  // The third strength of a pair is of the side of the stress across the fibres: with that of its own, whose sign may be that of
  // round-off, the index would jump, and sums be negative. Between both across, that along the weaker side.
  const double z_beside_t = side(s(1), of.nt, of.nc), y_beside_n = side(s(2), of.tt, of.tc),
               x_least = 1.0 / square(std::min(of.lt, of.lc));
  const double sum = x * s(0) * s(0) + y * s(1) * s(1) + z * s(2) * s(2) -
                     (x + y - z_beside_t) * s(0) * s(1) - (x + z - y_beside_n) * s(0) * s(2) -
                     (y + z - x_least) * s(1) * s(2) + square(s(3) / of.s_tn) +
                     square(s(4) / of.s_ln) + square(s(5) / of.s_lt);
  return share(sum, 0.0);
}

double tsai_wu(const Vec6& s, const Strengths& of) {
  const double linear = (1.0 / of.lt - 1.0 / of.lc) * s(0) + (1.0 / of.tt - 1.0 / of.tc) * s(1) +
                        (1.0 / of.nt - 1.0 / of.nc) * s(2);
  const double l = s(0) / std::sqrt(of.lt * of.lc), t = s(1) / std::sqrt(of.tt * of.tc),
               n = s(2) / std::sqrt(of.nt * of.nc);
  const double squares = l * l + t * t + n * n - l * t - l * n - t * n + square(s(3) / of.s_tn) +
                         square(s(4) / of.s_ln) + square(s(5) / of.s_lt);
  return share(squares, linear);
}

double hashin(const Vec6& s, const Strengths& of) {
  const double along = square(s(5) / of.s_lt) + square(s(4) / of.s_ln);  // shear on fibres
  const double across = (s(3) * s(3) - s(1) * s(2)) / square(of.s_tn), both = s(1) + s(2);
  const double fibre =
      s(0) >= 0.0 ? std::sqrt(square(s(0) / of.lt) + along) : std::abs(s(0)) / of.lc;
  const double matrix = both >= 0.0 ? share(square(both / of.tt) + across + along, 0.0)
                                    : share(square(both / (2.0 * of.s_tn)) + across + along,
                                            (square(of.tc / (2.0 * of.s_tn)) - 1.0) * both / of.tc);
  return std::max(fibre, matrix);
}

}  // namespace

double failure_index(Criterion criterion, const Vec6& stress, const Strengths& strengths) {
  switch (criterion) {
    case Criterion::max_stress:
      return max_stress(stress, strengths);
    case Criterion::tsai_hill:
      return tsai_hill(stress, strengths);
    case Criterion::tsai_wu:
      return tsai_wu(stress, strengths);
    case Criterion::hashin:
      break;
  }
  return hashin(stress, strengths);
}

double von_mises(const Vec6& s) {
  return std::sqrt(0.5 * (square(s(0) - s(1)) + square(s(1) - s(2)) + square(s(2) - s(0))) +
                   3.0 * (s(3) * s(3) + s(4) * s(4) + s(5) * s(5)));
}

Mat6 von_mises_form() {
  Mat6 A = Mat6::Zero();
  A.topLeftCorner<3, 3>().setConstant(-0.5);
  A.diagonal() << 1.0, 1.0, 1.0, 3.0, 3.0, 3.0;
  return A;
}

}  // namespace mbd::section
