#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "solvers/linear/inertia_solver.hpp"
#include "solvers/linear/judged_lu.hpp"

namespace mbd {
namespace {

constexpr double nearly_singular = 1e-11;

class BlockInertiaSolver final : public InertiaSolver {
 public:
  void analyze(const BlockGraph& graph) override {
    graph_ = graph;
    // Each block has its mirror image.
    const std::size_t count = graph.contributions.size();
    BlockGraph both = graph;
    both.contributions.reserve(2 * count);
    for (std::size_t k = 0; k < count; ++k)
      both.contributions.push_back({graph.contributions[k].column, graph.contributions[k].row});
    columns_.analyze(both);
    columns_.allocate(values_, trash_, slots_);
    slots_.resize(count);
    symmetric_.assign(values_.size(), 0.0);
    mirrors_.clear();
    std::vector<std::size_t> next = columns_.begin;
    for (int c = 0; c < columns_.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      // Columns in their order: of each row its mirror images come by rising columns.
      for (std::size_t e = columns_.begin[C]; e < columns_.begin[C + 1]; ++e)
        mirrors_.push_back(next[static_cast<std::size_t>(columns_.entries[e].row)]++);
    }
    prepared_ = std::make_unique<Prepared>(both, columns_, PivotOrder::merged);
    judged_ = std::make_unique<Judged<double>>(prepared_->plan, columns_);
    mumps_.reset();
    negative_.reset();
    state_ = State::none;
  }

  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override { std::fill(values_.begin(), values_.end(), 0.0); }

  FactorStatus factor() override {
    negative_.reset();
    state_ = State::none;
    if (!symmetrize()) return FactorStatus::singular;
    PivotInertia inertia;
    if (prepared_->factor(judged_->lu, symmetric_.data(), &inertia) &&
        inertia.least > nearly_singular && solves()) {
      negative_ = inertia.negative;
      state_ = State::blocks;
      return FactorStatus::ok;
    }
    if (!mumps_) {
      mumps_ = make_inertia_solver();
      mumps_->analyze(graph_);
    }
    mumps_->set_zero();
    for (std::size_t k = 0; k < graph_.contributions.size(); ++k) {
      const auto [row, column] = graph_.contributions[k];
      if (row < 0 || column < 0) continue;
      for (int j = 0; j < columns_.size(column); ++j)
        for (int i = 0; i < columns_.size(row); ++i)
          mumps_->slots()[k].data[i + j * mumps_->slots()[k].ld] =
              slots_[k].data[i + j * slots_[k].ld];
    }
    const FactorStatus status = mumps_->factor();
    if (status != FactorStatus::ok) return status;
    negative_ = mumps_->negative_eigenvalues();
    state_ = State::mumps;
    return status;
  }

  Index singular_row() const override { return -1; }

  void solve(std::span<double> x) const override {
    if (state_ == State::mumps) return mumps_->solve(x);
    long refined = 0;
    if (state_ == State::none || !judged_->solve(x, symmetric_.data(), refined))
      std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
  }

  double reciprocal_condition() const override { return 0.0; }  // not estimated
  Index nonzeros() const override { return columns_.nonzeros; }
  std::unique_ptr<LinearSolver> another() const override { return make_block_inertia_solver(); }
  LinearFacts facts() const override { return {.method = "block LU of the symmetric part"}; }

  std::optional<Index> negative_eigenvalues() const override { return negative_; }
  double asymmetry() const override { return asymmetry_; }

 private:
  enum class State { none, blocks, mumps };

  // False if a number is not finite.
  bool symmetrize() {
    double largest = 0.0, difference = 0.0, sum = 0.0;
    for (int c = 0; c < columns_.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      for (std::size_t e = columns_.begin[C]; e < columns_.begin[C + 1]; ++e) {
        const auto R = static_cast<std::size_t>(columns_.entries[e].row);
        const bool nodes = columns_.kinds[C] != 0 && columns_.kinds[R] != 0;
        const Index here = columns_.entries[e].offset, there = columns_.entries[mirrors_[e]].offset;
        for (int j = 0; j < columns_.size(c); ++j)
          for (int i = 0; i < columns_.size(columns_.entries[e].row); ++i) {
            const auto place = static_cast<std::size_t>(here + i + j * columns_.height[C]);
            const double a = values_[place],
                         b = values_[static_cast<std::size_t>(there + j + i * columns_.height[R])];
            symmetric_[place] = 0.5 * (a + b);
            sum += symmetric_[place];
            if (!nodes) continue;
            largest = std::max({largest, std::abs(a), std::abs(b)});
            difference = std::max(difference, std::abs(a - b));
          }
      }
    }
    asymmetry_ = largest > 0.0 ? difference / largest : 0.0;
    return std::isfinite(sum);
  }

  // Whether the factors are those of the matrix, by one solution.
  bool solves() {
    x_.resize(static_cast<std::size_t>(columns_.n));
    for (std::size_t i = 0; i < x_.size(); ++i)
      x_[i] = std::sin(1.0 + 2.7 * static_cast<double>(i % 1009));
    judged_->begin();
    long refined = 0;
    return x_.empty() || judged_->solve(std::span<double>(x_), symmetric_.data(), refined);
  }

  BlockGraph graph_;
  BlockColumns columns_;
  std::vector<double> values_, symmetric_, trash_, x_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> mirrors_;  // by entry
  std::unique_ptr<Prepared> prepared_;
  std::unique_ptr<Judged<double>> judged_;
  std::unique_ptr<InertiaSolver> mumps_;
  std::optional<Index> negative_;
  double asymmetry_ = 0.0;
  State state_ = State::none;
};

}  // namespace

std::unique_ptr<InertiaSolver> make_block_inertia_solver() {
  return std::make_unique<BlockInertiaSolver>();
}

}  // namespace mbd
