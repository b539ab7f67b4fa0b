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

// What is no property of the matrix: throws OutOfMemory.
void refuse_size(const klu_common& common, int n) {
  if (common.status == KLU_OUT_OF_MEMORY)
    throw OutOfMemory("out of memory: the factorisation of " + std::to_string(n) +
                      " equations (KLU); take fewer elements or bodies, or more memory");
  if (common.status == KLU_TOO_LARGE)
    throw OutOfMemory("the factors of " + std::to_string(n) +
                      " equations have more entries than KLU can count (2^31); take fewer elements "
                      "or bodies, or linear_solver=\"block\"");
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

// The two matrices share pattern and analysis.
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
    real_.assign(scalars_.Ai.size(), 0.0);
    complex_.assign(scalars_.Ai.size(), 0.0);
    symbolic_ = klu_analyze(blocks_.columns.n, scalars_.Ap.data(), scalars_.Ai.data(), &common_);
  }

  std::span<const Slot> slots(int power) const override { return blocks_.slots(power); }
  void set_zero() override { blocks_.set_zero(); }
  void multiply(int power, std::span<const double> x, std::span<double> y) const override {
    blocks_.multiply(power, x, y);
  }

  FactorStatus factor(double s, double x, std::complex<double> z) override {
    ++factorizations_;
    singular_row_ = -1;
    if (blocks_.columns.n == 0) return FactorStatus::ok;
    if (symbolic_ == nullptr) return FactorStatus::singular;
    const auto& P = blocks_.P;
    const std::complex<double> z1 = s * z, z2 = s * z * z;
    const double x1 = s * x, x2 = s * x * x;
    for (std::size_t i = 0; i < real_.size(); ++i) {
      if (scalars_.between_nodes[i] != 0) {
        real_[i] = s * P[0][i] + x1 * P[1][i] + x2 * P[2][i];
        complex_[i] = s * P[0][i] + z1 * P[1][i] + z2 * P[2][i];
      } else {
        real_[i] = P[0][i];
        complex_[i] = P[0][i];
      }
    }
    int* const Ap = scalars_.Ap.data();
    int* const Ai = scalars_.Ai.data();
    double* const C = reinterpret_cast<double*>(complex_.data());  // pairs, as the standard says
    if (numeric_real_ != nullptr && numeric_complex_ != nullptr) {
      if (klu_refactor(Ap, Ai, real_.data(), symbolic_, numeric_real_, &common_) == 1 &&
          common_.status == KLU_OK &&
          klu_z_refactor(Ap, Ai, C, symbolic_, numeric_complex_, &common_) == 1 &&
          common_.status == KLU_OK && pivots_hold())
        return FactorStatus::ok;
    }
    free_numeric();
    numeric_real_ = klu_factor(Ap, Ai, real_.data(), symbolic_, &common_);
    if (numeric_real_ != nullptr && common_.status == KLU_OK)
      numeric_complex_ = klu_z_factor(Ap, Ai, C, symbolic_, &common_);
    if (numeric_complex_ == nullptr || common_.status != KLU_OK) {
      singular_row_ = common_.singular_col >= 0 && common_.singular_col < blocks_.columns.n
                          ? common_.singular_col
                          : -1;
      free_numeric();
      refuse_size(common_, blocks_.columns.n);
      return FactorStatus::singular;
    }
    remember_pivots();
    return FactorStatus::ok;
  }

  Index singular_row() const override { return singular_row_; }

  void solve(std::span<double> b) const override {
    if (blocks_.columns.n == 0) return;
    if (numeric_real_ == nullptr ||
        klu_solve(symbolic_, numeric_real_, blocks_.columns.n, 1, b.data(), &common_) != 1)
      std::fill(b.begin(), b.end(), std::numeric_limits<double>::quiet_NaN());
  }
  void solve(std::span<std::complex<double>> b) const override {
    if (blocks_.columns.n == 0) return;
    if (numeric_complex_ == nullptr ||
        klu_z_solve(symbolic_, numeric_complex_, blocks_.columns.n, 1,
                    reinterpret_cast<double*>(b.data()), &common_) != 1)
      std::fill(b.begin(), b.end(), std::numeric_limits<double>::quiet_NaN());
  }

  double reciprocal_condition() const override {
    if (blocks_.columns.n == 0) return 1.0;
    if (numeric_real_ == nullptr) return 0.0;
    // KLU's interface is not const-correct.
    if (klu_condest(const_cast<int*>(scalars_.Ap.data()), const_cast<double*>(real_.data()),
                    symbolic_, numeric_real_, &common_) != 1)
      return 0.0;
    return common_.condest > 0.0 ? 1.0 / common_.condest : 0.0;
  }

  LinearFacts facts() const override {
    return {.method = "KLU", .factorizations = factorizations_};
  }

 private:
  void free_numeric() {
    if (numeric_real_ != nullptr) klu_free_numeric(&numeric_real_, &common_);
    if (numeric_complex_ != nullptr) klu_z_free_numeric(&numeric_complex_, &common_);
  }
  void release() {
    free_numeric();
    if (symbolic_ != nullptr) klu_free_symbolic(&symbolic_, &common_);
  }

  void sizes_of_pivots(std::vector<double>& sizes) const {
    const auto n = static_cast<std::size_t>(blocks_.columns.n);
    const auto* R = static_cast<const double*>(numeric_real_->Udiag);
    const auto* C = static_cast<const double*>(numeric_complex_->Udiag);
    sizes.resize(2 * n);
    for (std::size_t i = 0; i < n; ++i) {
      sizes[i] = std::abs(R[i]);
      sizes[n + i] = std::hypot(C[2 * i], C[2 * i + 1]);
    }
  }
  void remember_pivots() { sizes_of_pivots(pivots_); }
  bool pivots_hold() {
    sizes_of_pivots(now_);
    for (std::size_t i = 0; i < pivots_.size(); ++i)
      if (!(now_[i] >= shrunk_pivot * pivots_[i])) return false;
    return true;
  }

  mutable klu_common common_;
  klu_symbolic* symbolic_ = nullptr;
  klu_numeric* numeric_real_ = nullptr;
  klu_numeric* numeric_complex_ = nullptr;
  long factorizations_ = 0;
  Index singular_row_ = -1;
  PencilBlocks blocks_;
  BlockColumns::Scalars scalars_;
  std::vector<double> real_;
  std::vector<std::complex<double>> complex_;
  std::vector<double> pivots_, now_;
};

}  // namespace

std::unique_ptr<PencilSolver> make_klu_pencil_solver() {
  return std::make_unique<KluPencilSolver>();
}

std::unique_ptr<LinearSolver> make_klu_solver() { return std::make_unique<KluSolver>(); }

}  // namespace mbd
