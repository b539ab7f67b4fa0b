#include "solvers/linear/krylov.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace mbd {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

constexpr Index few = 120;    // unknowns of T: all its eigenvalues are found
constexpr Index at_once = 4;  // products of T outside of Krylov's subspaces
constexpr Index large =
    20000;  // unknowns from which on bases do not fit into caches, and blocks are larger
constexpr Index degrees = 12;  // of polynomials that a restart adds, at least
constexpr Index spare =
    4;  // looked for beyond those wanted, so that the next start is well apart from them
constexpr double converged = 1e-12;  // residual, relative
constexpr double enough = 1e-6;      // of those that are spare
constexpr double at_rest = 1e-6;     // residual that may be accepted if restarts do not improve it
constexpr double no_larger =
    1.0 - 1e-9;  // what is as large as the last of those wanted may be its twin
constexpr long most_restarts = 1000;  // of a start
constexpr int most_starts = 40;

// By size, the largest first.
std::vector<Index> order_of(const VectorXcd& values) {
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return std::abs(values(a)) > std::abs(values(b)); });
  return order;
}

// Of a dense matrix, the largest first.
struct DensePairs {
  VectorXcd values;
  MatrixXcd vectors;
  bool ok = false;

  explicit DensePairs(const MatrixXd& H) {
    const Eigen::EigenSolver<MatrixXd> dense(H);
    ok = dense.info() == Eigen::Success;
    if (!ok) return;
    const std::vector<Index> order = order_of(dense.eigenvalues());
    const MatrixXcd all = dense.eigenvectors();
    values.resize(H.cols());
    vectors.resize(H.rows(), H.cols());
    for (std::size_t k = 0; k < order.size(); ++k) {
      values(static_cast<Index>(k)) = dense.eigenvalues()(order[k]);
      vectors.col(static_cast<Index>(k)) = all.col(order[k]);
    }
  }
};

// Orthonormal columns of the span of the first `count` of conjugate pairs of columns, and of the other halves of those.
MatrixXd real_basis(const MatrixXcd& Y, Index count) {
  constexpr double independent = 1e-6;
  MatrixXd Z(Y.rows(), std::min(2 * count, Y.cols()));
  Index n = 0;
  for (Index i = 0; i < count; ++i)
    for (VecX y : {VecX(Y.col(i).real()), VecX(Y.col(i).imag())}) {
      if (n == Z.cols() || !(y.norm() > independent)) continue;
      y.normalize();
      for (int twice = 0; twice < 2; ++twice)
        y -= (Z.leftCols(n) * (Z.leftCols(n).transpose() * y)).eval();
      if (!(y.norm() > independent)) continue;
      Z.col(n++) = y.normalized();
    }
  return Z.leftCols(n);
}

// V^T Y and Y -= V C of few columns Y: V is read once, in rows that stay in the cache beside those of Y. (Eigen's products pack
// V first, which takes longer than these.)
constexpr Index rows_at_once = 1024;

MatrixXd transposed_times(const Eigen::Ref<const MatrixXd>& V, const MatrixXd& Y) {
  MatrixXd C = MatrixXd::Zero(V.cols(), Y.cols());
  for (Index r = 0; r < V.rows(); r += rows_at_once) {
    const Index n = std::min(rows_at_once, V.rows() - r);
    for (Index j = 0; j < V.cols(); ++j)
      for (Index k = 0; k < Y.cols(); ++k)
        C(j, k) += V.col(j).segment(r, n).dot(Y.col(k).segment(r, n));
  }
  return C;
}

void subtract(const Eigen::Ref<const MatrixXd>& V, const MatrixXd& C, MatrixXd& Y) {
  for (Index r = 0; r < V.rows(); r += rows_at_once) {
    const Index n = std::min(rows_at_once, V.rows() - r);
    for (Index j = 0; j < V.cols(); ++j)
      for (Index k = 0; k < Y.cols(); ++k)
        Y.col(k).segment(r, n) -= C(j, k) * V.col(j).segment(r, n);
  }
}

// One start: the largest eigenvalues of T beside a subspace that it maps into itself.
class BlockKrylov {
 public:
  // `Q`: that subspace, orthonormal. Only what is larger than `floor` is of interest. Of those wanted the last `spare` need not
  // be known well.
  BlockKrylov(const WeightedOperator& T, const MatrixXd& Q, Index block, Index wanted,
              Index spare_ones, double floor, KrylovWork& work)
      : T_(T),
        Q_(Q),
        block_(std::min(block, T.size() - Q.cols())),
        wanted_(wanted),
        spare_(spare_ones),
        floor_(floor),
        work_(work) {
    const Index most = std::min(wanted + std::max(wanted, degrees * block), T.size() - Q.cols());
    V_.resize(T.size(), most + block_);
    H_.setZero(most + block_, most);
  }

  // Orthonormal columns that T maps into themselves and Q, by falling eigenvalues; none if nothing is above the floor.
  MatrixXd run(std::mt19937& random, std::string& failure);

  VectorXcd values() const { return values_; }

 private:
  MatrixXd times(const MatrixXd& X) {
    work_.products += X.cols();
    return T_.times(X);
  }
  void add(MatrixXd Y, Index column);
  bool judge();
  bool is_stalled() const;
  void restart();

  const WeightedOperator& T_;
  const MatrixXd& Q_;
  const Index block_, wanted_, spare_;
  const double floor_;
  KrylovWork& work_;
  MatrixXd V_, H_;             // of (1); B is below H
  Index closed_ = 0;           // columns of V that T has been applied to
  Index used_ = 0;             // and those that were added by it
  VectorXcd values_;           // of H, the largest first
  MatrixXcd y_;                // vectors
  Index found_ = 0;            // so many of them are asked for and above the floor
  Index known_ = 0;            // and well known
  std::vector<double> worst_;  // residual at each restart
};

// Adds to V what of the columns is independent of it: Y = V H.middleCols(column, …).
void BlockKrylov::add(MatrixXd Y, Index column) {
  constexpr double cancels =
      0.1;  // of a length: what is left is orthogonal to its last digits only if it was so before
  const Index before = used_;
  VecX sizes;
  for (int twice = 0; twice < 2; ++twice) {
    MatrixXd WY = T_.weigh(Y);
    if (twice == 1)
      sizes = Y.cwiseProduct(WY).colwise().sum().cwiseMax(0.0).cwiseSqrt().transpose();
    const MatrixXd C = transposed_times(V_.leftCols(before), WY);
    subtract(Q_, transposed_times(Q_, WY), Y);
    subtract(V_.leftCols(before), C, Y);
    if (column >= 0) H_.block(0, column, before, Y.cols()) += C;
  }
  const MatrixXd WY = T_.weigh(Y);
  for (Index i = 0; i < Y.cols(); ++i) {
    MatrixXd y = Y.col(i), Wy = WY.col(i);
    const auto size_of = [&] { return std::sqrt(std::max(0.0, y.col(0).dot(Wy.col(0)))); };
    double length = size_of();
    bool is_sure = length > cancels * sizes(i);
    double factor = 1.0;  // Y.col(i) = V c + factor y
    constexpr int most = 4;
    for (int pass = 0; pass < most; ++pass) {
      if (!(length > 0.0) || !std::isfinite(length)) break;
      y /= length, Wy /= length, factor *= length;
      // Beside what this block has added; where that leaves little, beside all, once more.
      const Index from = pass == 0 ? before : 0;
      const auto others = V_.middleCols(from, used_ - from);
      const MatrixXd c = transposed_times(others, Wy);
      if (pass > 0) subtract(Q_, transposed_times(Q_, Wy), y);
      subtract(others, c, y);
      if (column >= 0) H_.block(from, column + i, used_ - from, 1) += factor * c;
      Wy = T_.weigh(y);
      length = size_of();
      if (is_sure && length > cancels) {
        y /= length, factor *= length;
        V_.col(used_) = y;
        if (column >= 0) H_(used_, column + i) = factor;
        ++used_;
        break;
      }
      is_sure = true;
    }
  }
}

// Whether what is wanted has converged, or nothing of it is above the floor.
bool BlockKrylov::judge() {
  const DensePairs dense(H_.topLeftCorner(closed_, closed_));
  if (!dense.ok) return false;
  values_ = dense.values;
  y_ = dense.vectors;
  const MatrixXcd By = H_.block(closed_, 0, used_ - closed_, closed_) * y_;
  const Index asked = std::min(wanted_, closed_);
  const double largest = std::abs(values_(0));
  double worst = 0.0;
  bool may_be_larger = false;
  found_ = known_ = 0;
  for (Index i = 0; i < asked; ++i) {
    constexpr double margin = 3.0;
    const double theta = std::abs(values_(i)), error = By.col(i).norm();
    if (theta + margin * error > floor_) may_be_larger = true;
    if (!(theta > least_share * largest) || theta + margin * error < floor_) continue;
    const double round_off = 4.0 * std::numeric_limits<double>::epsilon() * largest;
    const double tolerance = i < wanted_ - spare_ ? converged : enough;
    if (!(error <= std::max(tolerance * theta, round_off))) worst = std::max(worst, error / theta);
    found_ = i + 1;
    if (known_ == i && error <= std::max(at_rest * theta, round_off)) known_ = i + 1;
  }
  if (!may_be_larger) {
    found_ = 0;
    return true;
  }
  worst_.push_back(worst);
  const std::size_t n = worst_.size();
  return worst == 0.0 || used_ == closed_ ||
         (n > 2 && worst <= at_rest && worst > 0.5 * worst_[n - 3]);
}

// Beside an eigenvalue of T that is 1e10 times as large, as where the shift is nearly an eigenvalue, others never get better.
bool BlockKrylov::is_stalled() const {
  constexpr std::size_t long_since = 60;
  const std::size_t n = worst_.size();
  return n > long_since && worst_.back() > 0.5 * worst_[n - 1 - long_since];
}

void BlockKrylov::restart() {
  ++work_.restarts;
  const Index front = used_ - closed_;
  const MatrixXd Z = real_basis(y_, wanted_ + std::max(Index{0}, closed_ - wanted_) / 4);
  const Index kept = Z.cols();
  const MatrixXd H = Z.transpose() * H_.topLeftCorner(closed_, closed_) * Z,
                 B = H_.block(closed_, 0, front, closed_) * Z, next = V_.middleCols(closed_, front);
  // By rows, so that no second V is needed.
  for (Index r = 0; r < V_.rows(); r += rows_at_once) {
    const Index n = std::min(rows_at_once, V_.rows() - r);
    V_.block(r, 0, n, kept) = (V_.block(r, 0, n, closed_) * Z).eval();
  }
  V_.middleCols(kept, front) = next;
  H_.setZero();
  H_.topLeftCorner(kept, kept) = H;
  H_.block(kept, 0, front, kept) = B;
  closed_ = kept;
  used_ = kept + front;
}

MatrixXd BlockKrylov::run(std::mt19937& random, std::string& failure) {
  ++work_.starts;
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  MatrixXd X(T_.size(), block_);
  for (double& entry : X.reshaped()) entry = number(random);
  X = times(X);  // into the null space of the constraints
  if (!X.allFinite()) {
    failure = "the matrix of the shift is singular";
    return {};
  }
  add(std::move(X), -1);
  const Index most = H_.cols();
  for (const long begun = work_.restarts; used_ > closed_;) {
    while (used_ > closed_ && used_ <= most) {
      const Index first = closed_, count = used_ - closed_;
      closed_ = used_;
      add(times(V_.middleCols(first, count)), first);
    }
    if (judge()) break;
    if (work_.restarts - begun >= most_restarts || is_stalled() || wanted_ + 1 >= closed_) {
      found_ = known_;
      break;
    }
    restart();
  }
  if (found_ == 0) return {};
  return V_.leftCols(closed_) * real_basis(y_, found_);
}

// Eigenpairs of T in the span of columns that it maps into itself. Q^T W Q = I, or Q = I and W is left out.
EigenPairs within(const WeightedOperator& T, const MatrixXd& Q, bool is_whole, KrylovWork& work) {
  EigenPairs pairs;
  MatrixXd TQ(Q.rows(), Q.cols()), H(Q.cols(), Q.cols());
  for (Index i = 0; i < Q.cols(); i += at_once) {
    const Index n = std::min(at_once, Q.cols() - i);
    TQ.middleCols(i, n) = T.times(Q.middleCols(i, n));
    if (!is_whole) H.middleCols(i, n) = transposed_times(Q, T.weigh(TQ.middleCols(i, n)));
  }
  work.products += Q.cols();
  const DensePairs dense(is_whole ? TQ : H);
  if (!dense.ok) {
    pairs.failure = "the eigenvalues of a small dense matrix do not converge";
    return pairs;
  }
  pairs.values = dense.values;
  pairs.vectors.resize(Q.rows(), Q.cols());
  for (Index i = 0; i < Q.cols(); ++i) {
    const VectorXcd y = dense.vectors.col(i);
    auto x = pairs.vectors.col(i);
    x.real() = Q * y.real();
    x.imag() = Q * y.imag();
    VectorXcd left = -dense.values(i) * x;
    left.real() += TQ * y.real();
    left.imag() += TQ * y.imag();
    pairs.residuals.push_back(
        left.norm() / (std::abs(dense.values(i)) * x.norm() + std::numeric_limits<double>::min()));
  }
  return pairs;
}

// But for twins of what is wanted.
void leave_out_spare(EigenPairs& pairs, Index wanted) {
  Index n = std::min(wanted, pairs.values.size());
  while (n > 0 && n < pairs.values.size() &&
         std::abs(pairs.values(n)) > no_larger * std::abs(pairs.values(wanted - 1)))
    ++n;
  pairs.values.conservativeResize(n);
  pairs.vectors.conservativeResize(pairs.vectors.rows(), n);
  pairs.residuals.resize(std::min(pairs.residuals.size(), static_cast<std::size_t>(n)));
}

}  // namespace

EigenPairs largest_eigenpairs(const WeightedOperator& T, Index wanted, KrylovWork& work) {
  const Index n = T.size();
  wanted = std::min(wanted, n);
  if (n <= few || 3 * wanted >= n) return within(T, MatrixXd::Identity(n, n), true, work);
  std::mt19937 random(1);  // the same start in every run
  MatrixXd Q(n, 0);
  std::vector<double> sizes;  // of eigenvalues found, the largest first
  EigenPairs pairs;
  for (int start = 0; start < most_starts && Q.cols() < n; ++start) {
    const auto last = static_cast<std::size_t>(wanted - 1);
    double floor = sizes.empty() ? 0.0 : least_share * sizes.front();
    if (last < sizes.size()) floor = std::max(floor, no_larger * sizes[last]);
    const bool is_first = start == 0;
    BlockKrylov krylov(T, Q,
                       !is_first   ? 1
                       : n > large ? 4
                                   : 2,
                       is_first ? wanted + spare : 2, is_first ? spare : 0, floor, work);
    const MatrixXd more = krylov.run(random, pairs.failure);
    if (!pairs.failure.empty()) return pairs;
    if (more.cols() == 0) break;
    const Index before = Q.cols();
    Q.conservativeResize(n, before + more.cols());
    Q.rightCols(more.cols()) = more;
    for (Index i = 0; i < std::min(more.cols(), krylov.values().size()); ++i)
      sizes.push_back(std::abs(krylov.values()(i)));
    std::sort(sizes.begin(), sizes.end(), std::greater<>());
  }
  if (Q.cols() == 0) {
    pairs.failure = "Arnoldi's method does not converge";
    return pairs;
  }
  pairs = within(T, Q, false, work);
  leave_out_spare(pairs, wanted);
  return pairs;
}

}  // namespace mbd
