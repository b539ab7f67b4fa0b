#include "tests/support/rod.hpp"

namespace mbd::test {

RodState integrate(const Rod& rod, RodState x, int steps, bool backward) {
  using Eigen::Matrix3d, Eigen::Vector3d;
  const auto hat = [](const Vector3d& v) {
    Matrix3d M;
    M << 0, -v(2), v(1), v(2), 0, -v(0), -v(1), v(0), 0;
    return M;
  };
  const auto rate = [&](double s, const RodState& y) {
    const RodVector K = rod.K0(s) + dense::solve_definite(rod.D(s), y.sectional());
    RodState d;
    d.R = y.R * hat(K.tail<3>());
    d.r = y.R * K.head<3>();
    RodVector load = rod.dead ? rod.dead(s) : RodVector(RodVector::Zero());
    if (rod.follower) {
      const RodVector b = rod.follower(s);
      load.head<3>() += y.R * b.head<3>();
      load.tail<3>() += y.R * b.tail<3>();
    }
    d.n = -load.head<3>();
    d.m = -d.r.cross(y.n) - load.tail<3>();
    return d;
  };
  const auto moved = [](RodState y, double h, const RodState& d) {
    y.R += h * d.R, y.r += h * d.r, y.n += h * d.n, y.m += h * d.m;
    return y;
  };
  const double h = (backward ? -1.0 : 1.0) * rod.length / steps;
  double s = backward ? rod.length : 0.0;
  for (int k = 0; k < steps; ++k, s += h) {
    const RodState a = rate(s, x), b = rate(s + h / 2, moved(x, h / 2, a)),
                   c = rate(s + h / 2, moved(x, h / 2, b)), d = rate(s + h, moved(x, h, c));
    x = moved(moved(moved(moved(x, h / 6, a), h / 3, b), h / 3, c), h / 6, d);
  }
  return x;
}

Eigen::VectorXd root(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f,
                     Eigen::VectorXd x, const Eigen::VectorXd& scale) {
  for (int i = 0; i < 30; ++i) {
    const Eigen::VectorXd y = f(x);
    Eigen::MatrixXd J(y.size(), x.size());
    for (Eigen::Index c = 0; c < x.size(); ++c) {
      const Eigen::VectorXd e = 1e-5 * scale(c) * Eigen::VectorXd::Unit(x.size(), c);
      J.col(c) = (f(x + e) - f(x - e)) / (2e-5 * scale(c));
    }
    const Eigen::VectorXd step = dense::solve(J, y);
    x -= step;
    if ((step.cwiseQuotient(scale)).norm() < 1e-13) break;
  }
  return x;
}

}  // namespace mbd::test
