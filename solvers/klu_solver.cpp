#include "solvers/klu_solver.hpp"

#include <klu.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

namespace mbd {
namespace {

// All columns of a block column have the same row pattern, so a block lies in the compressed columns as a
// dense block with the column's count as leading dimension: contributions are added in place.
class KluSolver : public LinearSolver {
 public:
  KluSolver() {
    klu_defaults(&common_);
    common_.ordering = 0;  // AMD
    common_.scale = 2;     // rows by their largest entry
  }
  ~KluSolver() override { release(); }
  KluSolver(const KluSolver&) = delete;
  KluSolver& operator=(const KluSolver&) = delete;

  void analyze(const BlockGraph& graph) override {
    release();
    const std::size_t blocks = graph.blocks.size();
    std::vector<int> first(blocks + 1, 0);
    for (std::size_t b = 0; b < blocks; ++b) first[b + 1] = first[b] + graph.blocks[b].size;
    n_ = first.back();

    std::vector<std::vector<int>> rows(blocks);  // row blocks of each block column
    int largest = 1;
    for (const auto& [row, column] : graph.contributions) {
      if (row >= 0 && column >= 0) rows[static_cast<std::size_t>(column)].push_back(row);
    }
    for (const auto& block : graph.blocks) largest = std::max(largest, block.size);

    Ap_.assign(1, 0);
    Ai_.clear();
    std::vector<Index> start(blocks), height(blocks, 0);
    for (std::size_t c = 0; c < blocks; ++c) {
      auto& list = rows[c];
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      for (const int r : list) height[c] += graph.blocks[static_cast<std::size_t>(r)].size;
      start[c] = static_cast<Index>(Ai_.size());
      for (int k = 0; k < graph.blocks[c].size; ++k) {
        for (const int r : list) {
          const auto R = static_cast<std::size_t>(r);
          for (int i = first[R]; i < first[R + 1]; ++i) Ai_.push_back(i);
        }
        Ap_.push_back(static_cast<int>(Ai_.size()));
      }
    }
    Ax_.assign(Ai_.size(), 0.0);
    trash_.assign(static_cast<std::size_t>(largest * largest), 0.0);

    slots_.clear();
    slots_.reserve(graph.contributions.size());
    for (const auto& [row, column] : graph.contributions) {
      if (row < 0 || column < 0) {
        slots_.push_back({trash_.data(), largest});
        continue;
      }
      const auto C = static_cast<std::size_t>(column);
      Index offset = start[C];
      for (const int r : rows[C]) {
        if (r == row) break;
        offset += graph.blocks[static_cast<std::size_t>(r)].size;
      }
      slots_.push_back({Ax_.data() + offset, height[C]});
    }
    symbolic_ = klu_analyze(n_, Ap_.data(), Ai_.data(), &common_);
    if (symbolic_ == nullptr && n_ > 0) singular_row_ = -1;
  }

  std::span<const Slot> slots() const override { return slots_; }

  void set_zero() override { std::fill(Ax_.begin(), Ax_.end(), 0.0); }

  // A refactorisation keeps the pivots of the last full one; where they have become poor it is done anew.
  FactorStatus factor() override {
    singular_row_ = -1;
    if (n_ == 0) return FactorStatus::ok;
    if (symbolic_ == nullptr) return FactorStatus::singular;
    if (numeric_ != nullptr) {
      if (klu_refactor(Ap_.data(), Ai_.data(), Ax_.data(), symbolic_, numeric_, &common_) == 1 &&
          common_.status == KLU_OK && pivots_hold()) {
        return FactorStatus::ok;
      }
      klu_free_numeric(&numeric_, &common_);
    }
    numeric_ = klu_factor(Ap_.data(), Ai_.data(), Ax_.data(), symbolic_, &common_);
    if (numeric_ == nullptr || common_.status != KLU_OK) {
      singular_row_ =
          common_.singular_col >= 0 && common_.singular_col < n_ ? common_.singular_col : -1;
      if (numeric_ != nullptr) klu_free_numeric(&numeric_, &common_);
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
    if (klu_condest(const_cast<int*>(Ap_.data()), Ax, symbolic_, numeric_, &common_) != 1)
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

  Index nonzeros() const override { return static_cast<Index>(Ai_.size()); }

  std::unique_ptr<LinearSolver> another() const override { return make_klu_solver(); }

 private:
  void release() {
    if (numeric_ != nullptr) klu_free_numeric(&numeric_, &common_);
    if (symbolic_ != nullptr) klu_free_symbolic(&symbolic_, &common_);
  }

  // Rows are scaled, so pivots are relative; one that has shrunk this much since it was chosen lets the
  // others grow. (klu_rgrowth says it exactly, at nearly the price of the refactorisation.)
  bool pivots_hold() const {
    constexpr double shrunk = 1e-3;
    const auto* U = static_cast<const double*>(numeric_->Udiag);
    for (std::size_t i = 0; i < pivots_.size(); ++i) {
      if (!(std::abs(U[i]) >= shrunk * std::abs(pivots_[i]))) return false;
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
  Index singular_row_ = -1;
  std::vector<int> Ap_, Ai_;
  std::vector<double> Ax_;
  std::vector<double> trash_;  // what is added to the ground
  std::vector<Slot> slots_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_klu_solver() { return std::make_unique<KluSolver>(); }

}  // namespace mbd
