#include "solvers/modes/linearization.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

constexpr double independent = 1e-10;  // of the largest pivot: rank of B
constexpr double massless = 1e-13;     // reciprocal condition of N^T M N

// Refuses a law at a kink, or a jump, of an input.
void check_kink(const System& system, const State& state, std::size_t input, std::size_t signal) {
  State at = state;
  at.inputs[input].since = state.t;
  const double here = state.inputs[input].at(state.t).v;
  std::vector<SignalValue> with;
  const auto values = [&](double f, double rate) {
    at.inputs[input].f = f;
    at.inputs[input].fdot = rate;
    system.signals_at(state.t, Side::right, at.inputs, with, &state);
    return with[signal];
  };
  const auto slope = [&](double f) { return values(f, 1.0).fdot - values(f, 0.0).fdot; };
  const auto refuse = [&](const char* what, const Kink& kink) {
    throw Error(fmt::format(
        "{} is at a {} of its law: at the input {} = {:.6g} (SI) it is {:.6g} from below and "
        "{:.6g} from above, so its answer is not linear; make the law smooth there, or take "
        "another value of the input",
        system.signal_name(signal), what, system.inputs()[input].name, here, kink.below,
        kink.above));
  };
  if (const auto jump = hidden_kink([&](double f) { return values(f, 0.0).f; }, here))
    refuse("jump", *jump);
  if (const auto kink = hidden_kink(slope, here)) refuse("kink of the slope", *kink);
}

void refuse_motion(const System& system, std::size_t input) {
  throw Error(
      fmt::format("the input \"{}\" prescribes a motion; linearise about a model in which it is "
                  "a force (of the base, its acceleration), or hold it",
                  system.inputs()[input].name));
}

// -dr/dw of one input: by a difference over much, which is exact where forces go linearly with laws, or over little.
VecX force_of(const System& system, const State& state, std::size_t input) {
  // How laws go with the input, exactly: their rates as it has one, and has none.
  State moved = state;
  std::vector<SignalValue> with, without;
  moved.inputs[input].fdot = 1.0;
  moved.inputs[input].since = state.t;
  moved.inputs[input].f = state.inputs[input].at(state.t).v;
  system.signals_at(state.t, Side::right, moved.inputs, with, &state);
  moved.inputs[input].fdot = 0.0;
  system.signals_at(state.t, Side::right, moved.inputs, without, &state);
  // A law whose rate accelerates something.
  moved.inputs[input].f += 1.0;
  std::vector<SignalValue> beside;
  system.signals_at(state.t, Side::right, moved.inputs, beside, &state);
  for (std::size_t k = 0; k < with.size(); ++k)
    if (system.signal_use(k) == SignalUse::drive &&
        (with[k].fdot != without[k].fdot || with[k].fddot != without[k].fddot ||
         beside[k].f != without[k].f || beside[k].fdot != without[k].fdot ||
         beside[k].fddot != without[k].fddot))
      refuse_motion(system, input);
  double size = 1.0, most = 0.0;
  std::vector<double> rate(with.size());
  for (std::size_t k = 0; k < with.size(); ++k) {
    rate[k] = with[k].fdot - without[k].fdot;
    most = std::max(most, std::abs(rate[k]));
    if (rate[k] != 0.0) size = std::max(size, std::abs(with[k].f));
  }
  VecX force = VecX::Zero(system.rows());
  for (std::size_t k = 0; k < with.size(); ++k)
    if (system.signals()[k].has_inputs()) check_kink(system, state, input, k);
  if (most == 0.0) return force;
  VecX ahead, behind;
  const auto difference = [&](double share) {
    const double by = share * size / most;
    const auto residual = [&](double step, VecX& r) {
      moved = state;
      for (std::size_t k = 0; k < rate.size(); ++k) moved.signals[k].f += step * rate[k];
      system.residual(moved, r);
    };
    residual(by, ahead);
    residual(-by, behind);
    return VecX(-0.5 / by * (ahead - behind));
  };
  constexpr double little = 1e-4, same = 1e-6;
  force = difference(1.0);
  const VecX near = difference(little);
  if ((near - force).norm() > same * force.norm()) force = near;
  if (!force.tail(system.multipliers()).isZero(0.0)) refuse_motion(system, input);
  return force;
}

// Motions that constraints with the gradient B leave: which coordinates are independent, and N.
void find_coordinates(const System& system, MatX B, ReducedMotion& made) {
  const Index n = B.cols();
  // Rotations as lengths, and gaps of angles too.
  const double L = system.length_scale();
  for (Index j = 0; j < n; ++j)
    if (j % 6 >= 3) B.col(j) /= L;
  Index row = 0;
  for (const ConstraintInfo& c : system.constraints())
    for (const bool is_position : c.is_position) {
      if (!is_position) B.row(row) *= L;
      ++row;
    }
  Index rank = 0;
  std::vector<Index> order(static_cast<std::size_t>(n));
  for (Index j = 0; j < n; ++j) order[static_cast<std::size_t>(j)] = j;
  MatX R;
  if (B.rows() > 0) {
    Eigen::ColPivHouseholderQR<MatX> qr;
    qr.setThreshold(independent);
    qr.compute(B);
    rank = qr.rank();
    for (Index j = 0; j < n; ++j)
      order[static_cast<std::size_t>(j)] = qr.colsPermutation().indices()(j);
    R = qr.matrixR().topRows(rank);
  }
  const Index m = n - rank;
  // Those that are left, in their own order.
  std::vector<Index> left(order.begin() + rank, order.end());
  std::vector<Index> place(left.size());
  for (std::size_t j = 0; j < place.size(); ++j) place[j] = static_cast<Index>(j);
  std::sort(place.begin(), place.end(), [&](Index a, Index b) {
    return left[static_cast<std::size_t>(a)] < left[static_cast<std::size_t>(b)];
  });
  MatX dependent(rank, m);
  if (rank > 0) dependent = -R.leftCols(rank).triangularView<Eigen::Upper>().solve(R.rightCols(m));
  const auto length = [&](Index motion) { return motion % 6 >= 3 ? L : 1.0; };
  made.N = MatX::Zero(n, m);
  for (Index j = 0; j < m; ++j) {
    const Index from = place[static_cast<std::size_t>(j)],
                motion = left[static_cast<std::size_t>(from)];
    made.coordinates.push_back(motion);
    made.N(motion, j) = 1.0;
    for (Index i = 0; i < rank; ++i) {
      const Index of = order[static_cast<std::size_t>(i)];
      made.N(of, j) = dependent(i, from) * length(motion) / length(of);
    }
  }
}

}  // namespace

LinearMotion linear_motion(const SmallMotions& motions) {
  const System& system = motions.system();
  LinearMotion all{motions.mass_matrix(),
                   motions.rate_matrix(),
                   motions.stiffness_matrix(),
                   motions.constraint_gradient(),
                   {}};
  all.F = input_forces(system, motions.state());
  return all;
}

MatX input_forces(const System& system, const State& state) {
  const auto inputs = static_cast<Index>(system.inputs().size());
  const Index motions = 6 * (system.nodes() - 1);
  MatX F(motions, inputs);
  for (Index i = 0; i < inputs; ++i)
    F.col(i) = force_of(system, state, static_cast<std::size_t>(i)).segment(6, motions);
  return F;
}

ReducedMotion reduced_motion(const System& system, const LinearMotion& all) {
  const Index n = all.M.rows();
  if (n > most_reduced)
    throw Error(
        fmt::format("{} motions: matrices on the constraints are for {} at most; use those of "
                    "all motions, which are sparse",
                    n, most_reduced));
  ReducedMotion made;
  find_coordinates(system, all.B, made);
  const auto m = static_cast<Index>(made.coordinates.size());
  const MatX M = made.N.transpose() * (all.M * made.N), C = made.N.transpose() * (all.C * made.N),
             K = made.N.transpose() * (all.K * made.N);
  // In units in which all inertias are alike.
  VecX scale = M.diagonal().cwiseAbs().cwiseSqrt();
  const MatX scaled = scale.cwiseInverse().asDiagonal() * M * scale.cwiseInverse().asDiagonal();
  if (m > 0 && (!scaled.allFinite() || !(Eigen::PartialPivLU<MatX>(scaled).rcond() > massless))) {
    Index least = 0;
    scale.minCoeff(&least);
    throw Error(
        fmt::format("there is no inertia in some motion that nothing holds ({}): the "
                    "equations on the constraints are not of second order there; give it mass",
                    name_of_coordinate(system, made.coordinates[static_cast<std::size_t>(least)])));
  }
  made.E = MatX::Identity(2 * m, 2 * m);
  made.E.bottomRightCorner(m, m) = M;
  made.A = MatX::Zero(2 * m, 2 * m);
  made.A.topRightCorner(m, m).setIdentity();
  made.A.bottomLeftCorner(m, m) = -K;
  made.A.bottomRightCorner(m, m) = -C;
  made.G = MatX::Zero(2 * m, all.F.cols());
  made.G.bottomRows(m) = made.N.transpose() * all.F;
  return made;
}

std::string name_of_coordinate(const System& system, Index motion) {
  return fmt::format("{}, {} {}", system.node_name(motion / 6 + 1),
                     motion % 6 < 3 ? "displacement" : "rotation", motion % 3 + 1);
}

}  // namespace mbd
