#include "solvers/modes/periodic_motion.hpp"

#include <Eigen/KLUSupport>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/stop.hpp"
#include "solvers/linear/block_columns.hpp"
#include "solvers/modes/instants_lu.hpp"
#include "solvers/statics/equilibrium.hpp"

namespace mbd {
namespace {

using Complex = std::complex<double>;
using Real3 = Eigen::Matrix3d;

constexpr double pi = std::numbers::pi;
constexpr double largest_turn = 0.5;         // of an increment [rad]
constexpr double largest_motion = 0.25;      // of the scene's length
constexpr double beside_zero = 0.05;         // shift, of 2 pi/T: exponents may be 0
constexpr double in_the_strip = 1.0 + 1e-6;  // a double exponent at its edge is known to 1e-8
constexpr double the_same = 1e-7;            // of 2 pi/T
constexpr double good_solution = 1e-12;      // its error in each row, over what is summed there
constexpr int most_refinements = 4;          // of a solution by blocks

// (1).
Eigen::MatrixXd derivative(Index n, double period) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (i != j)
        D(i, j) = pi / period * ((i - j) % 2 == 0 ? 1.0 : -1.0) /
                  std::sin(pi * static_cast<double>(i - j) / static_cast<double>(n));
  return D;
}

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

}  // namespace

// By dense blocks of all instants; where those have no good pivots of their own, by scalars.
template <class Scalar>
struct PeriodicMotion::Factors {
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  explicit Factors(const BlockGraph& graph, Index instants) : blocks(graph, instants) {}

  InstantsLu<Scalar> blocks;
  Eigen::KLU<Eigen::SparseMatrix<Scalar>> scalars;
  Scalar s = Scalar(0.0);
  bool by_blocks = true;
  int refinements = 0;

  // Without refinement.
  Columns solve(const Columns& b) const { return by_blocks ? blocks.solve(b) : scalars.solve(b); }
};

struct PeriodicMotion::Solvers {
  Solvers(const BlockGraph& graph, Index instants)
      : real(graph, instants), complex(graph, instants) {}

  PencilBlocks blocks;
  BlockColumns::Scalars scalars;
  Factors<double> real;
  Factors<Complex> complex;
};

PeriodicMotion::PeriodicMotion(const System& system, double begin, double period, int harmonics)
    : system_(system),
      period_(period),
      motions_(6 * (system.nodes() - 1)),
      unknowns_(system.unknowns()),
      solvers_(std::make_unique<Solvers>(system.graph(), 2 * harmonics + 1)) {
  const int n = 2 * harmonics + 1;
  for (int i = 0; i < n; ++i) times_.push_back(begin + period * i / n);
  D_ = derivative(n, period);
  solvers_->blocks.analyze(system.graph());
  solvers_->scalars = solvers_->blocks.columns.scalars();
}

PeriodicMotion::~PeriodicMotion() = default;

void PeriodicMotion::differentiate(std::vector<State>& states) const {
  const Index n = instants();
  for (std::size_t k = 1; k < states.front().pose.size(); ++k) {
    std::vector<Real3> R(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) R[i] = states[i].pose[k].p.toRotationMatrix();
    for (Index i = 0; i < n; ++i) {
      const auto I = static_cast<std::size_t>(i);
      Real3 dR = Real3::Zero();
      Eigen::Vector3d dr = Eigen::Vector3d::Zero();
      for (Index j = 0; j < n; ++j) {
        const auto J = static_cast<std::size_t>(j);
        dR += D_(i, j) * R[J];
        dr += D_(i, j) * Eigen::Vector3d(states[J].pose[k].r - states[I].pose[k].r);
      }
      const Real3 w = R[I].transpose() * dR;
      const Eigen::Vector3d v = R[I].transpose() * dr;
      states[I].V[k] << v, 0.5 * (w(2, 1) - w(1, 2)), 0.5 * (w(0, 2) - w(2, 0)),
          0.5 * (w(1, 0) - w(0, 1));
    }
    for (Index i = 0; i < n; ++i) {
      Vec6 sum = Vec6::Zero();
      for (Index j = 0; j < n; ++j) sum += D_(i, j) * states[static_cast<std::size_t>(j)].V[k];
      states[static_cast<std::size_t>(i)].Vdot[k] = sum;
    }
  }
}

bool PeriodicMotion::linearize(const std::vector<State>& states, VecX& r) {
  r.resize(instants() * unknowns_);
  PencilBlocks& blocks = solvers_->blocks;
  const BlockColumns::Scalars& scalars = solvers_->scalars;
  M_.resize(states.size());
  C_.resize(states.size());
  K_.resize(states.size());
  bool in_range = true;
  stiffness_ = 0.0;
  VecX one;
  std::vector<Mat6> V_hat(states.front().V.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const State& state = states[i];
    for (std::size_t k = 0; k < V_hat.size(); ++k) V_hat[k] = twist_hat<double>(state.V[k]);
    blocks.set_zero();
    in_range &= system_.linearize_powers(state, V_hat, one,
                                         {blocks.slots(0), blocks.slots(1), blocks.slots(2)});
    r.segment(at(i) * unknowns_, unknowns_) = one.tail(unknowns_);
    stiffness_ = std::max(stiffness_, largest_stiffness(system_, blocks.slots(0)));
    const auto matrix = [&](int power) {
      std::vector<Eigen::Triplet<double>> entries;
      for (int c = 0; c < unknowns_; ++c)
        for (int e = scalars.Ap[static_cast<std::size_t>(c)];
             e < scalars.Ap[static_cast<std::size_t>(c) + 1]; ++e) {
          const auto E = static_cast<std::size_t>(e);
          const double value = blocks.P[static_cast<std::size_t>(power)][E];
          const bool kept = power == 0 || (scalars.Ai[E] < motions_ && c < motions_);
          if (value != 0.0 && kept) entries.emplace_back(scalars.Ai[E], c, value);
        }
      const Index size = power == 0 ? unknowns_ : motions_;
      Eigen::SparseMatrix<double> A(size, size);
      A.setFromTriplets(entries.begin(), entries.end());
      return A;
    };
    M_[i] = matrix(2);
    C_[i] = matrix(1);
    std::vector<Eigen::Triplet<double>> turning;  // Vdot~
    for (Index k = 0; k < motions_; k += 6) {
      const Eigen::Matrix<double, 6, 6> A =
          twist_hat<double>(state.Vdot[static_cast<std::size_t>(k / 6) + 1]);
      for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b)
          if (A(a, b) != 0.0) turning.emplace_back(k + a, k + b, A(a, b));
    }
    Eigen::SparseMatrix<double> A(motions_, motions_);
    A.setFromTriplets(turning.begin(), turning.end());
    Eigen::SparseMatrix<double> MA = M_[i] * A;
    MA.conservativeResize(unknowns_, unknowns_);
    K_[i] = matrix(0) + MA;
  }
  return in_range;
}

// (3) with D + s in place of D.
template <class Scalar, class Add>
void PeriodicMotion::each_entry(Scalar s, const Add& add) const {
  const Index n = instants();
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> D1 = D_.cast<Scalar>();
  D1.diagonal().array() += s;
  const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> D2 = D1 * D1;
  const auto each = [](const Eigen::SparseMatrix<double>& A, const auto& entry) {
    for (Index c = 0; c < A.outerSize(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator e(A, c); e; ++e) entry(e.row(), c, e.value());
  };
  for (Index i = 0; i < n; ++i) {
    const auto I = static_cast<std::size_t>(i);
    each(M_[I], [&](Index row, Index column, double value) {
      for (Index j = 0; j < n; ++j) add(i, row, j, column, D2(i, j) * value);
    });
    each(C_[I], [&](Index row, Index column, double value) {
      for (Index j = 0; j < n; ++j)
        if (D1(i, j) != Scalar(0.0)) add(i, row, j, column, D1(i, j) * value);
    });
    each(K_[I],
         [&](Index row, Index column, double value) { add(i, row, i, column, Scalar(value)); });
  }
}

template <class Scalar>
Eigen::SparseMatrix<Scalar> PeriodicMotion::assemble(Scalar s) const {
  std::vector<Eigen::Triplet<Scalar>> entries;
  each_entry(s, [&](Index i, Index row, Index j, Index column, Scalar value) {
    entries.emplace_back(i * unknowns_ + row, j * unknowns_ + column, value);
  });
  Eigen::SparseMatrix<Scalar> J(instants() * unknowns_, instants() * unknowns_);
  J.setFromTriplets(entries.begin(), entries.end());
  return J;
}

template <class Scalar>
void PeriodicMotion::subtract_times(Scalar s, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& x,
                                    Eigen::Ref<Eigen::Matrix<Scalar, Eigen::Dynamic, 1>> r,
                                    VecX* sizes) const {
  each_entry(s, [&](Index i, Index row, Index j, Index column, Scalar value) {
    const Scalar one = value * x(j * unknowns_ + column);
    r(i * unknowns_ + row) -= one;
    if (sizes != nullptr) (*sizes)(i * unknowns_ + row) += std::abs(one);
  });
}

// How often solutions by these factors have to be refined until the largest residual of a row, over what is summed there, is
// small (Oettli & Prager 1964); none if that does not help.
template <class Scalar>
std::optional<int> PeriodicMotion::refinements_of(const Factors<Scalar>& factors) const {
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  Vector b(instants() * unknowns_);
  for (Index k = 0; k < b.size(); ++k)
    b(k) = Scalar(std::cos(static_cast<double>(k) * static_cast<double>(k)));
  Vector x = factors.solve(b);
  for (int n = 0; n <= most_refinements && x.allFinite(); ++n) {
    Vector r = b;
    VecX sum = b.cwiseAbs();
    subtract_times<Scalar>(factors.s, x, r, &sum);
    double worst = 0.0;
    for (Index k = 0; k < b.size(); ++k) worst = std::max(worst, std::abs(r(k)) / sum(k));
    if (worst < good_solution) return n;
    x += factors.solve(r);
  }
  return std::nullopt;
}

template <class Scalar>
bool PeriodicMotion::factor_with(Factors<Scalar>& factors, Scalar s) {
  factors.s = s;
  factors.by_blocks = true;
  factors.blocks.set_zero();
  each_entry(s, [&](Index i, Index row, Index j, Index column, Scalar value) {
    factors.blocks.add(i, row, j, column, value);
  });
  if (factors.blocks.factor())
    if (const std::optional<int> refinements = refinements_of(factors)) {
      factors.refinements = *refinements;
      return true;
    }
  factors.by_blocks = false;
  factors.refinements = 0;
  factors.scalars.compute(assemble<Scalar>(s));
  return factors.scalars.info() == Eigen::Success;
}

bool PeriodicMotion::factor(double s) { return factor_with(solvers_->real, s); }
bool PeriodicMotion::factor(Complex s) { return factor_with(solvers_->complex, s); }

// Motions of all instants among all unknowns, and back.
template <class Scalar>
void PeriodicMotion::solve_with(const Factors<Scalar>& factors,
                                Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& B) const {
  using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  Columns b = Columns::Zero(instants() * unknowns_, B.cols());
  for (Index i = 0; i < instants(); ++i)
    b.middleRows(i * unknowns_, motions_) = B.middleRows(i * motions_, motions_);
  Columns x = factors.solve(b);
  for (int n = 0; n < factors.refinements; ++n) {
    Columns r = b;
    for (Index k = 0; k < b.cols(); ++k)
      subtract_times<Scalar>(factors.s, x.col(k), r.col(k), nullptr);
    x += factors.solve(r);
  }
  for (Index i = 0; i < instants(); ++i)
    B.middleRows(i * motions_, motions_) = x.middleRows(i * unknowns_, motions_);
}

void PeriodicMotion::solve(Eigen::MatrixXd& B) const { solve_with(solvers_->real, B); }
void PeriodicMotion::solve(Eigen::MatrixXcd& B) const { solve_with(solvers_->complex, B); }

Eigen::MatrixXd PeriodicMotion::mass_times(const Eigen::MatrixXd& X) const {
  Eigen::MatrixXd Y(X.rows(), X.cols());
  for (Index i = 0; i < instants(); ++i)
    Y.middleRows(i * motions_, motions_) =
        M_[static_cast<std::size_t>(i)] * X.middleRows(i * motions_, motions_);
  return Y;
}

// l (2 M D + C) is what is linear in l.
Eigen::MatrixXd PeriodicMotion::rate_times(const Eigen::MatrixXd& X) const {
  using Instants = Eigen::Map<const Eigen::MatrixXd>;
  Eigen::MatrixXd Y(X.rows(), X.cols());
  for (Index k = 0; k < X.cols(); ++k) {
    const Eigen::MatrixXd dx = Instants(X.col(k).data(), motions_, instants()) * D_.transpose();
    for (Index i = 0; i < instants(); ++i)
      Y.block(i * motions_, k, motions_, 1) =
          C_[static_cast<std::size_t>(i)] * X.block(i * motions_, k, motions_, 1) +
          2.0 * (M_[static_cast<std::size_t>(i)] * dx.col(i));
  }
  return Y;
}

VecX PeriodicMotion::harmonics(const VecXc& p, bool inertial) const {
  const Index n = instants(), h = (n - 1) / 2;
  VecXc q = p;
  for (Index i = 0; inertial && i < n; ++i)
    for (Index m = 0; m < motions_; m += 3) {
      const State& state = states_[static_cast<std::size_t>(i)];
      const Real3 R = state.pose[static_cast<std::size_t>(m / 6) + 1].p.toRotationMatrix();
      auto part = q.segment<3>(i * motions_ + m);
      part = (R * part).eval();
    }
  VecX sizes(n);
  for (Index k = -h; k <= h; ++k) {
    VecXc sum = VecXc::Zero(motions_);
    for (Index i = 0; i < n; ++i)
      sum += std::polar(1.0 / static_cast<double>(n),
                        -2.0 * pi * static_cast<double>(k * i) / static_cast<double>(n)) *
             q.segment(i * motions_, motions_);
    for (Index m = 0; m < motions_; m += 6) sum.segment<3>(m) /= length_scale();
    sizes(k + h) = sum.norm();
  }
  return sizes;
}

namespace {

// Of harmonics -h … h: the largest of the fastest two, beside the largest of all.
double tail_of(const VecX& sizes) {
  const Index n = sizes.size();
  double tail = std::max(sizes(0), sizes(n - 1));
  if (n > 3) tail = std::max({tail, sizes(1), sizes(n - 2)});
  const double most = sizes.maxCoeff();
  return most > 0.0 ? tail / most : 0.0;
}

}  // namespace

double PeriodicMotion::share_of(const VecX& x, const IncrementNorm& norm, double& e) const {
  double share = 1.0;
  e = 0.0;
  for (Index i = 0; i < instants(); ++i) {
    const VecX one = x.segment(i * unknowns_, unknowns_);
    const double size = norm({one.data(), static_cast<std::size_t>(one.size())}, 1.0);
    if (!std::isfinite(size)) {
      e = size;
      return share;
    }
    e = std::max(e, size);
    const double turn = largest_rotation_in(system_, one);
    double moved = 0.0;
    for (Index k = 0; k < motions_; k += 6)
      moved = std::max(moved, one.segment<3>(k).norm() / length_scale());
    share = std::min({share, turn > largest_turn ? largest_turn / turn : 1.0,
                      moved > largest_motion ? largest_motion / moved : 1.0});
  }
  return share;
}

double PeriodicMotion::tail(const std::vector<State>& states) const {
  VecXc V(motions());
  for (std::size_t i = 0; i < states.size(); ++i)
    for (Index k = 0; k < motions_; k += 6)
      V.segment<6>(at(i) * motions_ + k) =
          states[i].V[static_cast<std::size_t>(k / 6) + 1].cast<Complex>();
  const VecX sizes = harmonics(V);
  constexpr double rests = 1e-9;  // in a period, of the scene's length, or rad: of round-off
  return sizes.maxCoeff() * period_ > rests ? tail_of(sizes) : 0.0;
}

PeriodicReport PeriodicMotion::solve(const NewtonOptions& options, std::vector<State>& states) {
  PeriodicReport report;
  for (std::size_t i = 0; i < states.size(); ++i) {
    system_.set_time(states[i], times_[i]);
    states[i].load_factor = 1.0;
  }
  IncrementNorm norm(system_, options);
  for (const State& state : states) norm.observe(state.lambda);
  double previous = 0.0;
  VecX r;
  for (report.iterations = 1; report.iterations <= options.max_iterations; ++report.iterations) {
    stop::check();
    differentiate(states);
    if (!linearize(states, r)) {
      for (const State& state : states)
        if (const std::string element = system_.out_of_range(state); !element.empty())
          report.failure = range_failure(element);
      return report;
    }
    if (report.iterations == 1) norm.set_floor(states.front(), stiffness_);
    if (!r.allFinite()) {
      report.failure = "the residual is not finite";
      return report;
    }
    if (!factor(0.0)) {
      report.failure =
          "the equations of the periodic motion are singular: it is one of many (nothing holds a "
          "motion, or fixes its phase), or on a limit of stability";
      return report;
    }
    const VecX x = solvers_->real.solve(-r);
    double e = 0.0;
    const double share = share_of(x, norm, e);
    if (!std::isfinite(e)) {
      report.failure = "the increments of Newton's iterations are not finite";
      return report;
    }
    for (std::size_t i = 0; i < states.size(); ++i) {
      retract(system_, states[i], x.segment(at(i) * unknowns_, unknowns_), share);
      norm.observe(states[i].lambda);
    }
    if (share == 1.0 && has_converged(e, previous)) {
      differentiate(states);
      if (!linearize(states, r)) break;
      report.tail = tail(states);
      report.converged = true;
      states_ = states;
      return report;
    }
    previous = e;
  }
  report.failure =
      "Newton's iterations do not converge: what they start from is too far away, or the motion is "
      "one of many (nothing holds a motion, or fixes its phase)";
  return report;
}

FloquetFound find_floquet_modes(PeriodicMotion& motion, int most) {
  FloquetFound result;
  const double omega = 2.0 * pi / motion.period(), shift = beside_zero * omega;
  const double edge = std::hypot(0.5 * omega, shift);
  ModesFound found;
  for (int count = std::min(16, most);; count = std::min(4 * count, most)) {
    found = find_modes_near(motion, shift, omega, count);
    if (!found.failure.empty()) {
      result.failure = found.failure;
      return result;
    }
    double farthest = 0.0;
    for (const Mode& mode : found.modes)
      farthest = std::max(farthest, std::abs(mode.eigenvalue - shift));
    result.all =
        farthest > edge * in_the_strip || found.modes.size() < static_cast<std::size_t>(count);
    if (result.all || count >= most) break;
  }
  const Index h = (motion.instants() - 1) / 2;
  for (Mode& mode : found.modes) {
    if (mode.eigenvalue.imag() > 0.5 * omega * in_the_strip) continue;
    // Beside the edge an exponent and the conjugate of its next are one.
    const Complex next = std::conj(mode.eigenvalue) + Complex(0.0, omega);
    if (std::any_of(result.modes.begin(), result.modes.end(), [&](const FloquetMode& other) {
          return std::abs(other.exponent - next) < the_same * omega;
        }))
      continue;
    FloquetMode one;
    one.exponent = mode.eigenvalue;
    one.multiplier = std::exp(mode.eigenvalue * motion.period());
    one.residual = mode.residual;
    const auto largest = [&](const VecX& of) {
      Index k = 0;
      of.maxCoeff(&k);
      return std::abs(mode.eigenvalue.imag() + static_cast<double>(k - h) * omega);
    };
    const VecX sizes = motion.harmonics(mode.shape);
    one.frequency = largest(sizes);
    one.inertial = largest(motion.harmonics(mode.shape, true));
    one.tail = tail_of(sizes);
    one.shape = std::move(mode.shape);
    result.modes.push_back(std::move(one));
  }
  std::stable_sort(result.modes.begin(), result.modes.end(),
                   [](const FloquetMode& a, const FloquetMode& b) {
                     return a.exponent.real() > b.exponent.real();
                   });
  return result;
}

}  // namespace mbd
