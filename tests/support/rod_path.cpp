#include "tests/support/rod_path.hpp"

namespace mbd::test {

template <class S>
RodSection<S> integrate(const RodPiece& piece, const RodSection<S>& start) {
  using State = Eigen::Matrix<S, 15, 1>;  // columns of R, r, m
  using Six = Eigen::Matrix<S, 6, 1>;
  const Eigen::Matrix<S, 6, 6> C = piece.compliance.cast<S>();
  const Three<S> n = start.n;
  const auto rate = [&](const State& y) {
    const Rotation<S> R = Eigen::Map<const Rotation<S>>(y.data());
    Six F, K;
    F << R.transpose() * n, R.transpose() * y.template tail<3>();
    K.noalias() = C * F;
    K(0) += 1.0;
    K(5) += piece.curvature;
    State d;
    Eigen::Map<Rotation<S>>(d.data()) = R * cross_matrix<S>(K.template tail<3>());
    const Three<S> t = R * K.template head<3>();
    d.template segment<3>(9) = t;
    d.template tail<3>() = -cross_matrix<S>(t) * n;
    return d;
  };
  State y;
  Eigen::Map<Rotation<S>>(y.data()) = start.R;
  y.template segment<3>(9) = start.r;
  y.template tail<3>() = start.m;
  constexpr int columns = 6;  // order 2 * columns
  const double H = piece.length / piece.steps;
  for (int step = 0; step < piece.steps; ++step) {
    const State f = rate(y);
    std::array<State, columns> T;  // a row of the extrapolation, in place
    for (int j = 0; j < columns; ++j) {
      const int substeps = 2 * (j + 1);
      const double h = H / substeps;
      State before = y, now = y + h * f;
      for (int k = 1; k < substeps; ++k) {
        const State next = before + 2 * h * rate(now);
        before = now;
        now = next;
      }
      State entry = now;
      for (int k = 1; k <= j; ++k) {  // (substeps_j / substeps_(j-k))^2 - 1
        const double ratio = double(j + 1) / double(j + 1 - k);
        const State better = entry + (entry - T[std::size_t(k - 1)]) / (ratio * ratio - 1);
        T[std::size_t(k - 1)] = entry;
        entry = better;
      }
      T[std::size_t(j)] = entry;
    }
    y = T[columns - 1];
  }
  RodSection<S> end = start;
  end.R = Eigen::Map<const Rotation<S>>(y.data());
  end.r = y.template segment<3>(9);
  end.m = y.template tail<3>();
  return end;
}

template RodSection<double> integrate(const RodPiece&, const RodSection<double>&);
template RodSection<Complex> integrate(const RodPiece&, const RodSection<Complex>&);

}  // namespace mbd::test
