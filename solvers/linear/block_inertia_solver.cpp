#include "solvers/linear/block_inertia_solver.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace mbd {
namespace {

constexpr double nearly_singular = 1e-11;

// By entry of columns that have a mirror image of each block, its place; empty if they have not.
std::vector<std::size_t> mirrors_of(const BlockColumns& columns) {
  std::vector<std::size_t> mirrors;
  mirrors.reserve(columns.entries.size());
  std::vector<std::size_t> next = columns.begin;
  for (int c = 0; c < columns.blocks(); ++c) {
    const auto C = static_cast<std::size_t>(c);
    // Columns in their order: of each row its mirror images come by rising columns.
    for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e) {
      const auto R = static_cast<std::size_t>(columns.entries[e].row);
      const std::size_t mirror = next[R]++;
      if (mirror >= columns.begin[R + 1] || columns.entries[mirror].row != c) return {};
      mirrors.push_back(mirror);
    }
  }
  return mirrors;
}

class BlockInertiaSolver final : public InertiaSolver {
 public:
  BlockInertiaSolver() = default;
  BlockInertiaSolver(const InertiaRoom& room, std::vector<std::size_t> mirrors)
      : room_(room), slots_(room.slots), mirrors_(std::move(mirrors)) {}

  void analyze(const BlockGraph& graph) override {
    own_ = std::make_unique<Own>();
    own_->graph = graph;
    // Each block has its mirror image.
    const std::size_t count = graph.contributions.size();
    BlockGraph both = graph;
    both.contributions.reserve(2 * count);
    for (std::size_t k = 0; k < count; ++k)
      both.contributions.push_back({graph.contributions[k].column, graph.contributions[k].row});
    own_->columns.analyze(both);
    own_->columns.allocate(own_->values, own_->trash, own_->slots);
    own_->slots.resize(count);
    slots_ = own_->slots;
    mirrors_ = mirrors_of(own_->columns);
    own_->prepared = std::make_unique<Prepared>(both, own_->columns, PivotOrder::merged);
    own_->judged = std::make_unique<Judged<double>>(own_->prepared->plan, own_->columns);
    room_ = {&own_->graph,    &own_->columns, &own_->values, own_->slots,
             &own_->prepared, &own_->judged,  [] {}};
    mumps_.reset();
    negative_.reset();
    state_ = State::none;
  }

  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override { std::fill(room_.values->begin(), room_.values->end(), 0.0); }

  FactorStatus factor() override {
    room_.taken();
    negative_.reset();
    state_ = State::none;
    if (!symmetrize()) return FactorStatus::singular;
    PivotInertia inertia;
    if ((*room_.prepared)->factor(judged(), room_.values->data(), &inertia) &&
        inertia.least > nearly_singular && are_of_one_sign()) {
      negative_ = inertia.negative;
      state_ = State::blocks;
      return FactorStatus::ok;
    }
    const BlockGraph& graph = *room_.graph;
    if (!mumps_) {
      mumps_ = make_inertia_solver();
      mumps_->analyze(graph);
    }
    mumps_->set_zero();
    for (std::size_t k = 0; k < graph.contributions.size(); ++k) {
      const auto [row, column] = graph.contributions[k];
      if (row < 0 || column < 0) continue;
      for (int j = 0; j < room_.columns->size(column); ++j)
        for (int i = 0; i < room_.columns->size(row); ++i)
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
    if (state_ == State::none || !judged().solve(x, room_.values->data(), refined))
      std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
  }

  double reciprocal_condition() const override { return 0.0; }  // not estimated
  Index nonzeros() const override { return room_.columns->nonzeros; }
  std::unique_ptr<LinearSolver> another() const override { return make_block_inertia_solver(); }
  LinearFacts facts() const override { return {.method = "block LU of the symmetric part"}; }

  std::optional<Index> negative_eigenvalues() const override { return negative_; }
  double asymmetry() const override { return asymmetry_; }

 private:
  enum class State { none, blocks, mumps };
  struct Own {
    BlockGraph graph;
    BlockColumns columns;
    std::vector<double> values, trash;
    std::vector<Slot> slots;
    std::unique_ptr<Prepared> prepared;
    std::unique_ptr<Judged<double>> judged;
  };

  Judged<double>& judged() const { return **room_.judged; }

  // In place. False if a number is not finite.
  bool symmetrize() {
    const BlockColumns& columns = *room_.columns;
    double largest = 0.0, difference = 0.0, sum = 0.0;
    for (int c = 0; c < columns.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e) {
        if (columns.entries[e].row < c) continue;
        const auto R = static_cast<std::size_t>(columns.entries[e].row);
        const bool nodes = columns.kinds[C] != 0 && columns.kinds[R] != 0;
        const int rows = columns.size(columns.entries[e].row);
        double* const here = room_.values->data() + columns.entries[e].offset;
        double* const there = room_.values->data() + columns.entries[mirrors_[e]].offset;
        for (int j = 0; j < columns.size(c); ++j)
          for (int i = columns.entries[e].row == c ? j : 0; i < rows; ++i) {
            double &a = here[i + j * columns.height[C]], &b = there[j + i * columns.height[R]];
            if (nodes) {
              largest = std::max({largest, std::abs(a), std::abs(b)});
              difference = std::max(difference, std::abs(a - b));
            }
            a = b = 0.5 * (a + b);
            sum += a;
          }
      }
    }
    asymmetry_ = largest > 0.0 ? difference / largest : 0.0;
    return std::isfinite(sum);
  }

  // Whether eigenvalues of the matrix have the signs of those of its factors. (A hub that carries all of a beam has nothing of its own:
  // pivots of round-off, which constraints hold, make others wrong by any share.)
  bool are_of_one_sign() {
    constexpr double most = 0.1;
    judged().begin();
    return room_.columns->n == 0 || judged().contraction(room_.values->data()) < most;
  }

  std::unique_ptr<Own> own_;
  InertiaRoom room_;
  std::span<const Slot> slots_;
  std::vector<std::size_t> mirrors_;  // by entry
  std::unique_ptr<InertiaSolver> mumps_;
  std::optional<Index> negative_;
  double asymmetry_ = 0.0;
  State state_ = State::none;
};

}  // namespace

std::unique_ptr<InertiaSolver> make_block_inertia_solver() {
  return std::make_unique<BlockInertiaSolver>();
}

std::unique_ptr<InertiaSolver> make_block_inertia_solver_in(const InertiaRoom& room) {
  std::vector<std::size_t> mirrors = mirrors_of(*room.columns);
  if (mirrors.size() != room.columns->entries.size()) return nullptr;
  return std::make_unique<BlockInertiaSolver>(room, std::move(mirrors));
}

}  // namespace mbd
