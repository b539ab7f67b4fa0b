#include "solvers/linear/klu_solver.hpp"

#include <klu.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "libmbd/core/stop.hpp"
#include "solvers/linear/block_columns.hpp"
#include "solvers/linear/pencil_solver.hpp"

namespace mbd {
namespace {

klu_common common_settings() {
  klu_common common;
  klu_defaults(&common);
  common.ordering = 0;  // AMD
  common.scale = 2;     // rows by their largest entry
  return common;
}

// Rows are scaled, so pivots are relative; one that has shrunk this much since it was chosen lets the
// others grow. (klu_rgrowth says it exactly, at nearly the price of the refactorisation.)
constexpr double shrunk_pivot = 1e-3;

// What is no property of the matrix: throws OutOfMemory, or Error for what KLU calls invalid.
void refuse_size(const klu_common& common, int n) {
  if (common.status == KLU_OUT_OF_MEMORY)
    throw OutOfMemory("out of memory: the factorisation of " + std::to_string(n) +
                      " equations (KLU); take fewer elements or bodies, or more memory");
  if (common.status == KLU_TOO_LARGE)
    throw OutOfMemory("the factors of " + std::to_string(n) +
                      " equations have more entries than KLU can count (2^31); take fewer elements "
                      "or bodies, or linear_solver=\"block\"");
  if (common.status == KLU_INVALID)
    throw Error("KLU refuses the matrix of " + std::to_string(n) +
                " equations; this is a fault of libmbd: please report the model");
}

class KluSolver : public LinearSolver {
 public:
  KluSolver() : common_(common_settings()) {}
  ~KluSolver() override { release(); }
  KluSolver(const KluSolver&) = delete;
  KluSolver& operator=(const KluSolver&) = delete;

  void analyze(const BlockGraph& graph) override {
    release();
    factorizations_ = 0;
    columns_.analyze(graph);
    scalars_ = columns_.scalars();
    n_ = columns_.n;
    columns_.allocate(Ax_, trash_, slots_);
    symbolic_ = klu_analyze(n_, scalars_.Ap.data(), scalars_.Ai.data(), &common_);
    if (symbolic_ == nullptr && n_ > 0) {
      refuse_size(common_, n_);
      singular_row_ = -1;
    }
  }

  std::span<const Slot> slots() const override { return slots_; }

  void set_zero() override { std::fill(Ax_.begin(), Ax_.end(), 0.0); }

  // A refactorisation keeps the pivots of the last full one; where they have become poor it is done anew.
  FactorStatus factor() override {
    ++factorizations_;
    singular_row_ = -1;
    if (n_ == 0) return FactorStatus::ok;
    if (symbolic_ == nullptr) return FactorStatus::singular;
    if (numeric_ != nullptr) {
      if (klu_refactor(scalars_.Ap.data(), scalars_.Ai.data(), Ax_.data(), symbolic_, numeric_,
                       &common_) == 1 &&
          common_.status == KLU_OK && pivots_hold()) {
        return FactorStatus::ok;
      }
      klu_free_numeric(&numeric_, &common_);
    }
    numeric_ = klu_factor(scalars_.Ap.data(), scalars_.Ai.data(), Ax_.data(), symbolic_, &common_);
    if (numeric_ == nullptr || common_.status != KLU_OK) {
      singular_row_ =
          common_.singular_col >= 0 && common_.singular_col < n_ ? common_.singular_col : -1;
      if (numeric_ != nullptr) klu_free_numeric(&numeric_, &common_);
      refuse_size(common_, n_);
      return FactorStatus::singular;
    }
    const auto* U = static_cast<const double*>(numeric_->Udiag);
    pivots_.assign(U, U + n_);
    return FactorStatus::ok;
  }

  Index singular_row() const override { return singular_row_; }

  void solve(std::span<double> x) const override {
    if (n_ == 0) return;
    if (numeric_ == nullptr || klu_solve(symbolic_, numeric_, n_, 1, x.data(), &common_) != 1)
      std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
  }

  double reciprocal_condition() const override {
    if (n_ == 0) return 1.0;
    if (numeric_ == nullptr) return 0.0;
    auto* Ax = const_cast<double*>(Ax_.data());  // KLU's interface is not const-correct
    if (klu_condest(const_cast<int*>(scalars_.Ap.data()), Ax, symbolic_, numeric_, &common_) != 1)
      return 0.0;
    return common_.condest > 0.0 ? 1.0 / common_.condest : 0.0;
  }

  // P S Q = L U with unit L and positive row scales.
  int determinant_sign() const override {
    if (n_ == 0) return 1;
    if (numeric_ == nullptr) return 0;
    const auto* U = static_cast<const double*>(numeric_->Udiag);
    bool negative = is_odd(numeric_->Pnum) != is_odd(symbolic_->Q);
    for (int i = 0; i < n_; ++i) negative = negative != (U[i] < 0.0);
    return negative ? -1 : 1;
  }

  Index nonzeros() const override { return static_cast<Index>(scalars_.Ai.size()); }

  LinearFacts facts() const override {
    return {.method = "KLU", .factorizations = factorizations_};
  }

  std::unique_ptr<LinearSolver> another() const override { return make_klu_solver(); }

 private:
  void release() {
    if (numeric_ != nullptr) klu_free_numeric(&numeric_, &common_);
    if (symbolic_ != nullptr) klu_free_symbolic(&symbolic_, &common_);
  }

  bool pivots_hold() const {
    const auto* U = static_cast<const double*>(numeric_->Udiag);
    for (std::size_t i = 0; i < pivots_.size(); ++i) {
      if (!(std::abs(U[i]) >= shrunk_pivot * std::abs(pivots_[i]))) return false;
    }
    return true;
  }

  // Of a permutation of n_.
  bool is_odd(const int* permutation) const {
    std::vector<bool> seen(static_cast<std::size_t>(n_), false);
    bool odd = false;
    for (int i = 0; i < n_; ++i) {
      int length = 0;  // of the cycle through i; it takes length - 1 exchanges
      for (int k = i; !seen[static_cast<std::size_t>(k)]; k = permutation[k], ++length)
        seen[static_cast<std::size_t>(k)] = true;
      if (length > 0 && length % 2 == 0) odd = !odd;
    }
    return odd;
  }

  std::vector<double> pivots_;   // of the last full factorisation
  mutable klu_common common_{};  // KLU writes statistics even when solving
  klu_symbolic* symbolic_ = nullptr;
  klu_numeric* numeric_ = nullptr;
  int n_ = 0;
  long factorizations_ = 0;
  Index singular_row_ = -1;
  BlockColumns columns_;
  BlockColumns::Scalars scalars_;
  std::vector<double> Ax_;
  std::vector<double> trash_;  // what is added to the ground
  std::vector<Slot> slots_;
};

// The matrices share pattern and analysis.
class KluPencilSolver final : public PencilSolver {
 public:
  KluPencilSolver() : common_(common_settings()) {}
  ~KluPencilSolver() override { release(); }
  KluPencilSolver(const KluPencilSolver&) = delete;
  KluPencilSolver& operator=(const KluPencilSolver&) = delete;

  void analyze(const BlockGraph& graph) override {
    release();
    factorizations_ = 0;
    blocks_.analyze(graph);
    scalars_ = blocks_.columns.scalars();
    symbolic_ = klu_analyze(blocks_.columns.n, scalars_.Ap.data(), scalars_.Ai.data(), &common_);
    if (symbolic_ == nullptr && blocks_.columns.n > 0) refuse_size(common_, blocks_.columns.n);
  }

  std::span<const Slot> slots(int power) const override { return blocks_.slots(power); }
  void set_zero() override { blocks_.set_zero(); }
  void forget_pivots() override { free_numerics(); }
  void multiply(int power, std::span<const double> x, std::span<double> y) const override {
    blocks_.multiply(power, x, y);
  }

  using PencilSolver::factor;
  FactorStatus factor(double s, double x, std::span<const std::complex<double>> z) override {
    ++factorizations_;
    singular_row_ = -1;
    FactorStatus status = factor_part(real_, s, x);
    keep_parts(z.size());
    for (std::size_t k = 0; k < z.size() && status == FactorStatus::ok; ++k)
      status = factor_part(complex_[k], s, z[k]);
    return status;
  }
  FactorStatus factor_real(double s, double x) override {
    ++factorizations_;
    singular_row_ = -1;
    keep_parts(0);
    return factor_part(real_, s, x);
  }
  FactorStatus factor_complex(double s, std::complex<double> z) override {
    ++factorizations_;
    singular_row_ = -1;
    free_numeric(real_);
    keep_parts(1);
    return factor_part(complex_[0], s, z);
  }

  Index singular_row() const override { return singular_row_; }

  void solve(std::span<double> b) const override { solve_columns(b, 1); }
  void solve(std::span<std::complex<double>> b, std::size_t which) const override {
    solve_columns(b, 1, which);
  }
  // KLU reads its factors once for four columns.
  void solve_columns(std::span<double> B, Index columns) const override {
    const int n = blocks_.columns.n;
    if (n == 0) return;
    if (real_.numeric == nullptr ||
        klu_solve(symbolic_, real_.numeric, n, static_cast<int>(columns), B.data(), &common_) != 1)
      std::fill(B.begin(), B.end(), std::numeric_limits<double>::quiet_NaN());
  }
  void solve_columns(std::span<std::complex<double>> B, Index columns) const override {
    solve_columns(B, columns, 0);
  }
  void solve_transposed(std::span<std::complex<double>> b) const override {
    const int n = blocks_.columns.n;
    constexpr int conjugated = 0;
    if (n == 0) return;
    if (complex_.empty() || complex_.front().numeric == nullptr ||
        klu_z_tsolve(symbolic_, complex_.front().numeric, n, 1, reinterpret_cast<double*>(b.data()),
                     conjugated, &common_) != 1)
      std::fill(b.begin(), b.end(), std::numeric_limits<double>::quiet_NaN());
  }

  double reciprocal_condition() const override {
    if (blocks_.columns.n == 0) return 1.0;
    if (real_.numeric == nullptr) return 0.0;
    // KLU's interface is not const-correct.
    if (klu_condest(const_cast<int*>(scalars_.Ap.data()), const_cast<double*>(real_.values.data()),
                    symbolic_, real_.numeric, &common_) != 1)
      return 0.0;
    return common_.condest > 0.0 ? 1.0 / common_.condest : 0.0;
  }

  LinearFacts facts() const override {
    return {.method = "KLU", .factorizations = factorizations_};
  }

 private:
  // E(x) or E(z).
  template <class T>
  struct Part {
    std::vector<T> values;
    klu_numeric* numeric = nullptr;
    std::vector<double> pivots;  // of the last full factorisation, sizes
  };

  void solve_columns(std::span<std::complex<double>> B, Index columns, std::size_t which) const {
    const int n = blocks_.columns.n;
    if (n == 0) return;
    if (which >= complex_.size() || complex_[which].numeric == nullptr ||
        klu_z_solve(symbolic_, complex_[which].numeric, n, static_cast<int>(columns),
                    reinterpret_cast<double*>(B.data()), &common_) != 1)
      std::fill(B.begin(), B.end(), std::numeric_limits<double>::quiet_NaN());
  }

  // So many complex ones: those beyond are lost.
  void keep_parts(std::size_t count) {
    for (std::size_t k = count; k < complex_.size(); ++k) free_numeric(complex_[k]);
    if (count > complex_.size()) complex_.resize(count);
  }
  void free_numerics() {
    free_numeric(real_);
    keep_parts(0);
  }
  void free_numeric(Part<double>& part) {
    if (part.numeric != nullptr) klu_free_numeric(&part.numeric, &common_);
  }
  void free_numeric(Part<std::complex<double>>& part) {
    if (part.numeric != nullptr) klu_z_free_numeric(&part.numeric, &common_);
  }
  void release() {
    free_numerics();
    if (symbolic_ != nullptr) klu_free_symbolic(&symbolic_, &common_);
  }

  bool refactor(Part<double>& part) {
    return klu_refactor(scalars_.Ap.data(), scalars_.Ai.data(), part.values.data(), symbolic_,
                        part.numeric, &common_) == 1;
  }
  bool refactor(Part<std::complex<double>>& part) {
    return klu_z_refactor(scalars_.Ap.data(), scalars_.Ai.data(), numbers(part), symbolic_,
                          part.numeric, &common_) == 1;
  }
  void factor_anew(Part<double>& part) {
    part.numeric =
        klu_factor(scalars_.Ap.data(), scalars_.Ai.data(), part.values.data(), symbolic_, &common_);
  }
  void factor_anew(Part<std::complex<double>>& part) {
    part.numeric =
        klu_z_factor(scalars_.Ap.data(), scalars_.Ai.data(), numbers(part), symbolic_, &common_);
  }
  static double* numbers(Part<std::complex<double>>& part) {
    return reinterpret_cast<double*>(part.values.data());  // pairs, as the standard says
  }

  // A refactorisation keeps the pivots of the last full one; where they have become poor it is done anew.
  template <class T>
  FactorStatus factor_part(Part<T>& part, double s, T x) {
    if (blocks_.columns.n == 0) return FactorStatus::ok;
    if (symbolic_ == nullptr) return FactorStatus::singular;
    const auto& P = blocks_.P;
    const T x1 = s * x, x2 = s * x * x;
    part.values.resize(scalars_.Ai.size());
    for (std::size_t i = 0; i < part.values.size(); ++i)
      part.values[i] =
          scalars_.between_nodes[i] != 0 ? s * P[0][i] + x1 * P[1][i] + x2 * P[2][i] : T(P[0][i]);
    if (part.numeric != nullptr && refactor(part) && common_.status == KLU_OK && pivots_hold(part))
      return FactorStatus::ok;
    free_numeric(part);
    factor_anew(part);
    if (part.numeric == nullptr || common_.status != KLU_OK) {
      singular_row_ = common_.singular_col >= 0 && common_.singular_col < blocks_.columns.n
                          ? common_.singular_col
                          : -1;
      free_numerics();
      refuse_size(common_, blocks_.columns.n);
      return FactorStatus::singular;
    }
    sizes_of_pivots(part, part.pivots);
    return FactorStatus::ok;
  }

  template <class T>
  void sizes_of_pivots(const Part<T>& part, std::vector<double>& sizes) const {
    const auto* U = static_cast<const T*>(part.numeric->Udiag);
    sizes.resize(static_cast<std::size_t>(blocks_.columns.n));
    for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = std::abs(U[i]);
  }
  template <class T>
  bool pivots_hold(const Part<T>& part) {
    sizes_of_pivots(part, now_);
    for (std::size_t i = 0; i < now_.size(); ++i)
      if (!(now_[i] >= shrunk_pivot * part.pivots[i])) return false;
    return true;
  }

  mutable klu_common common_;
  klu_symbolic* symbolic_ = nullptr;
  long factorizations_ = 0;
  Index singular_row_ = -1;
  PencilBlocks blocks_;
  BlockColumns::Scalars scalars_;
  Part<double> real_;
  std::vector<Part<std::complex<double>>> complex_;
  std::vector<double> now_;
};

}  // namespace

std::unique_ptr<PencilSolver> make_klu_pencil_solver() {
  return std::make_unique<KluPencilSolver>();
}

std::unique_ptr<LinearSolver> make_klu_solver() { return std::make_unique<KluSolver>(); }

}  // namespace mbd
