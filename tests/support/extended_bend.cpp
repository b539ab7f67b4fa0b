#include "tests/support/extended_bend.hpp"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "elements/beam/beam_elastic.hpp"

namespace mbd::test {
namespace {

using Real = long double;
using VectorX = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using MatrixX = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

// Pose on the arc after an angle t from its start; 1 - cos t without cancellation.
Pose<Real> on_arc(Real radius, Real t) {
  const Real half = 0.5L * (0.5L * std::numbers::pi_v<Real> - t), s = std::sin(0.5L * t);
  return {Quaternion<Real>(std::cos(half), 0.0L, 0.0L, std::sin(half)),
          {2.0L * radius * s * s, radius * std::sin(t), 0.0L}};
}

template <class Metric, class Form>
class Cantilever {
  using Kernel = beam::Elastic<Metric, Form, 0, Real>;
  using Output = typename Kernel::template Output<Real>;

 public:
  explicit Cantilever(const ExtendedBend& bend) : bend_(bend) {
    const auto table = spectral_table<Real>(bend.order, bend.rule);
    shared_ = {beam::make_table<0>(table), {bend.D}};
    const Real step = bend.angle / Real(bend.elements);
    const std::vector<Real> J(static_cast<std::size_t>(bend.order) + 1, 0.5L * bend.radius * step);
    for (int e = 0; e < bend.elements; ++e) {
      for (int k = e == 0 ? 0 : 1; k <= bend.order; ++k) {
        const Real xi = table.nodes.points[static_cast<std::size_t>(k)];
        pose_.push_back(on_arc(bend.radius, step * (Real(e) + 0.5L * (1.0L + xi))));
      }
      data_.push_back(beam::make_data<Metric, 0>(table, J, {&pose_[first(e)], J.size()}, 0, 0));
    }
  }

  ExtendedSolution solve() {
    const Vector3<Real> start = pose_.back().r;
    ExtendedSolution solution;
    Real reached = 0.0L, step = 0.25L;
    while (reached < 1.0L && step > 1e-3L) {
      const std::vector<Pose<Real>> before = pose_;
      const Real next = std::min(reached + step, 1.0L);
      if (equilibrium(next, solution)) {
        reached = next;
      } else {
        pose_ = before;
        step *= 0.5L;
      }
    }
    solution.converged = reached == 1.0L;
    solution.tip = pose_.back().r - start;
    return solution;
  }

 private:
  bool equilibrium(Real factor, ExtendedSolution& solution) {
    Real before = 1.0L;
    for (solution.iterations = 1; solution.iterations <= 15; ++solution.iterations) {
      const Real now = solution.increment = iterate(factor);
      if (!(now < 100.0L)) return false;
      if (now < 1e-14L && now > 0.1L * before) return true;  // no longer falling: round-off
      before = now;
    }
    return false;
  }

  std::size_t first(int element) const {
    return static_cast<std::size_t>(element) * static_cast<std::size_t>(bend_.order);
  }

  // One iteration; the norm of the increments of the positions over the radius. The nodes 1 … N of each
  // element are eliminated from the tip to the root: what is right of an element acts on its last node as a
  // stiffness C and a force c.
  Real iterate(Real factor) {
    const Index m = 6 * bend_.order;
    const auto count = static_cast<std::size_t>(bend_.elements);
    const Vector3<Real> body = pose_.back().p.conjugate() * (factor * bend_.force);
    // -R^T F of the residual; R^T F turns with R <- R exp(psi~) by (R^T F)~ psi.
    Vector6<Real> c = six<Real>(body, Vector3<Real>::Zero());
    Matrix6<Real> C = Matrix6<Real>::Zero();
    C.topRightCorner<3, 3>() = -hat(body);
    std::vector<VectorX> z(count);
    std::vector<MatrixX> X(count);
    std::vector<NodeState<Real>> x(static_cast<std::size_t>(bend_.order) + 1);
    Output out;
    for (std::size_t e = count; e-- > 0;) {
      for (std::size_t k = 0; k < x.size(); ++k) x[k].H = pose_[first(static_cast<int>(e)) + k];
      Kernel::template evaluate<Want::tangent>(shared_, data_[e], x.data(), {}, {}, out);
      MatrixX S = out.K.bottomRightCorner(m, m);
      S.bottomRightCorner<6, 6>() += C;
      VectorX b = -out.r.tail(m);
      b.tail<6>() += c;
      const Eigen::PartialPivLU<MatrixX> lu(S);
      X[e] = lu.solve(MatrixX(out.K.bottomLeftCorner(m, 6)));
      z[e] = lu.solve(b);
      const MatrixX right = out.K.topRightCorner(6, m);
      C = Matrix6<Real>(out.K.topLeftCorner(6, 6)) - right * X[e];
      c = -Vector6<Real>(out.r.head(6)) - right * z[e];
    }
    VectorX end = VectorX::Zero(6);  // increment of an element's first node; the root is clamped
    Real sum = 0.0L;
    for (std::size_t e = 0; e < count; ++e) {
      const VectorX U = z[e] - X[e] * end;
      for (Index k = 0; k < bend_.order; ++k) {
        const Vector6<Real> u = U.segment<6>(6 * k);
        Pose<Real>& H = pose_[first(static_cast<int>(e)) + static_cast<std::size_t>(k) + 1];
        H = H * exp_se3<Real>(u);
        H.p.normalize();
        sum += u.head<3>().squaredNorm();
      }
      end = U.tail<6>();
    }
    return std::sqrt(sum) / bend_.radius;
  }

  ExtendedBend bend_;
  typename Kernel::Shared shared_;
  std::vector<Pose<Real>> pose_;
  std::vector<typename Kernel::Data> data_;
};

template <class Metric>
ExtendedSolution solve_with(const ExtendedBend& bend) {
  return bend.form == Form::energy ? Cantilever<Metric, beam::EnergyForm>(bend).solve()
                                   : Cantilever<Metric, beam::PaperForm>(bend).solve();
}

}  // namespace

Matrix6<long double> ExtendedBend::printed_stiffness() {
  Vector6<Real> diagonal;
  diagonal << 1.00e7L, 4.17e6L, 4.17e6L, 7.03e5L, 8.33e5L, 8.33e5L;
  Matrix6<Real> D = diagonal.asDiagonal();
  D(0, 5) = D(5, 0) = -8.33e3L;
  return D;
}

ExtendedSolution solve(const ExtendedBend& bend) {
  switch (bend.metric) {
    case Metric::matrix:
      return solve_with<MatrixMetric>(bend);
    case Metric::quaternion:
      return solve_with<QuaternionMetric>(bend);
    case Metric::geodesic:
      break;
  }
  return solve_with<GeodesicMetric>(bend);
}

}  // namespace mbd::test
