#include "solvers/linear/block_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "solvers/linear/block_inertia_solver.hpp"
#include "solvers/linear/judged_lu.hpp"
#include "solvers/linear/klu_solver.hpp"

namespace mbd {
namespace {

constexpr long first_rest = 8, longest_rest = 4096;  // factorisations left to KLU after a failure

std::string_view name_of(PivotOrder order) {
  return order == PivotOrder::nodes_first ? "nodes first" : "multipliers merged";
}

template <class T>
void make_nan(std::span<T> x) {
  std::fill(x.begin(), x.end(), T(std::numeric_limits<double>::quiet_NaN()));
}

// Which order of pivots is used, when KLU stands in for it, and what is said of it.
class Choice {
 public:
  explicit Choice(PivotOrder wanted) : order(wanted), wanted_(wanted) {}

  void begin() {
    const PivotOrder wanted = wanted_;
    *this = Choice(wanted);
  }
  bool rests() { return rest_ > 0 && rest_-- > 0; }
  // Of the last factorisation. Solutions that are refined cost twice: where most are, the other order may do better.
  void refined(bool was) {
    refined_ = std::max(refined_ + (was ? 1 : -1), 0);
    if (refined_ < most_refined) return;
    refined_ = 0;
    order = PivotOrder::merged;
  }
  // It is of no use: the other order is tried next, or KLU does the next ones.
  void failed(std::string reason) {
    facts.reason = std::move(reason);
    if (order == PivotOrder::nodes_first && !both_failed_) {
      order = PivotOrder::merged;
      return;
    }
    both_failed_ = true;
    order = wanted_;
    rest_ = next_rest_;
    next_rest_ = std::min(2 * next_rest_, longest_rest);
  }

  PivotOrder order;
  LinearFacts facts;

 private:
  static constexpr int most_refined = 8;
  PivotOrder wanted_;
  long rest_ = 0, next_rest_ = first_rest;
  int refined_ = 0;
  bool both_failed_ = false;
};

constexpr const char* zero_pivot = "a block has no pivot";
constexpr const char* inaccurate = "solutions do not satisfy their equations";
constexpr const char* tolerant_diagonal = "a rank-tolerant step";

double sum_of_sizes(const std::vector<double>& x) {
  double s = 0.0;
  for (const double v : x) s += std::abs(v);
  return s;
}

// Hager's estimate of |A^-1 R^-1| in the 1-norm (Higham 1988); `row`: R^-1. Not finite, or 0, if there is none.
double norm_of_inverse(const BlockLu<double>& lu, const std::vector<double>& row) {
  const std::size_t n = row.size();
  std::vector<double> x(n, 1.0 / static_cast<double>(n)), z(n);
  const auto apply = [&](std::vector<double>& v) {  // v := A^-1 R^-1 v, rows of R A unit
    for (std::size_t i = 0; i < n; ++i) v[i] *= row[i];
    lu.solve(v.data());
  };
  double estimate = 0.0;
  std::size_t last = n;
  for (int k = 0; k < 5; ++k) {
    apply(x);
    const double now = sum_of_sizes(x);
    if (!std::isfinite(now)) return now;
    if (k > 0 && now <= estimate) break;
    estimate = now;
    for (std::size_t i = 0; i < n; ++i) z[i] = x[i] >= 0.0 ? 1.0 : -1.0;
    lu.solve_transposed(z.data());
    std::size_t largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      z[i] *= row[i];
      if (std::abs(z[i]) > std::abs(z[largest])) largest = i;
    }
    if (largest == last) break;
    last = largest;
    std::fill(x.begin(), x.end(), 0.0);
    x[largest] = 1.0;
  }
  for (std::size_t i = 0; i < n; ++i)
    x[i] = (i % 2 == 0 ? 1.0 : -1.0) *
           (1.0 + static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(n - 1, 1)));
  apply(x);
  return std::max(estimate, 2.0 * sum_of_sizes(x) / (3.0 * static_cast<double>(n)));
}

// 1 / (|R A| |A^-1 R^-1|) in the 1-norm, with rows R A of largest entry 1. (KLU takes the inverse of A itself, so that its
// estimate goes with the units.)
double reciprocal_condition(const BlockColumns& columns, const double* A,
                            const BlockLu<double>& lu) {
  const auto n = static_cast<std::size_t>(columns.n);
  std::vector<double> row(n, 0.0), column(n, 0.0);
  // use(a column of a block, its length, its first row, what `column` has of it)
  const auto visit = [&](const auto& use) {
    for (int c = 0; c < columns.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e) {
        const auto first = static_cast<std::size_t>(
            columns.first[static_cast<std::size_t>(columns.entries[e].row)]);
        for (int j = 0; j < columns.size(c); ++j)
          use(A + columns.entries[e].offset + j * columns.height[C],
              columns.size(columns.entries[e].row), first,
              column[static_cast<std::size_t>(columns.first[C] + j)]);
      }
    }
  };
  visit([&](const double* a, int count, std::size_t first, double&) {
    for (int i = 0; i < count; ++i)
      row[first + static_cast<std::size_t>(i)] =
          std::max(row[first + static_cast<std::size_t>(i)], std::abs(a[i]));
  });
  // Units of rows: R of above and its inverse.
  std::vector<double> unit(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!(row[i] > 0.0)) return 0.0;
    unit[i] = 1.0 / row[i];
  }
  visit([&](const double* a, int count, std::size_t first, double& sum) {
    for (int i = 0; i < count; ++i)
      sum += std::abs(a[i]) * unit[first + static_cast<std::size_t>(i)];
  });
  const double norm = *std::max_element(column.begin(), column.end());
  const double estimate = norm_of_inverse(lu, row);
  return estimate > 0.0 && std::isfinite(estimate) ? 1.0 / (norm * estimate) : 0.0;
}

// What has been added to `from` is written to `to`.
void copy_blocks(const BlockGraph& graph, std::span<const Slot> from, std::span<const Slot> to) {
  for (std::size_t k = 0; k < graph.contributions.size(); ++k) {
    const auto [row, column] = graph.contributions[k];
    if (row < 0 || column < 0) continue;
    for (int j = 0; j < graph.blocks[static_cast<std::size_t>(column)].size; ++j)
      for (int i = 0; i < graph.blocks[static_cast<std::size_t>(row)].size; ++i)
        to[k].data[i + j * to[k].ld] = from[k].data[i + j * from[k].ld];
  }
}

// What both solvers do alike: attempts in either order of pivots, KLU behind them, and what is said of it.
template <class Interface>
class BlockBacked : public Interface {
 public:
  Index singular_row() const override {
    return state_ == State::none && klu_ ? klu_->singular_row() : -1;
  }

  LinearFacts facts() const override {
    LinearFacts facts = choice_.facts;
    facts.method = fmt::format("block LU, {}", name_of(prepared_order_));
    if (prepared_ && !prepared_->plan.fronts.all.empty())
      facts.method += fmt::format(", {} fronts", prepared_->plan.fronts.all.size());
    if (prepared_ && prepared_->dissected) facts.method += ", nested dissection";
    if (facts.fallbacks == 0) facts.reason.clear();  // the other order did it
    return facts;
  }

 protected:
  enum class State { none, blocks, klu };

  explicit BlockBacked(PivotOrder order) : choice_(order) {}

  void begin(const BlockGraph& graph) {
    graph_ = graph;
    choice_.begin();
    klu_.reset();
    state_ = State::none;
  }

  // What the order of pivots decides, for choice_.order.
  virtual void prepare() = 0;
  // Of all that has been prepared; false without a pivot.
  virtual bool factor_prepared() = 0;
  // Whether solutions by the last factors were refined.
  virtual bool was_refined() const = 0;
  virtual std::unique_ptr<Interface> make_klu() const = 0;
  // What is to be factored, given to KLU, which is empty.
  virtual FactorStatus factor_same(Interface& klu) const = 0;

  FactorStatus factor_by_blocks() {
    for (int attempt = 0; attempt < 2; ++attempt) {
      if (state_ == State::blocks) choice_.refined(was_refined());
      if (choice_.order != prepared_order_) prepare();
      state_ = State::none;
      if (factor_prepared()) {
        state_ = State::blocks;
        return FactorStatus::ok;
      }
      const PivotOrder before = choice_.order;
      choice_.failed(zero_pivot);
      if (choice_.order == before) break;
    }
    return factor_by_klu();
  }

  FactorStatus factor_by_klu() const {
    ++choice_.facts.fallbacks;
    if (!klu_) {
      klu_ = make_klu();
      klu_->analyze(graph_);
    }
    klu_->set_zero();
    const FactorStatus status = factor_same(*klu_);
    state_ = status == FactorStatus::ok ? State::klu : State::none;
    return status;
  }

  // A: what `judged` has factored; a nullptr: it is no longer there. `which` as solve() has it.
  template <class T, class... Which>
  void solve_with(std::span<T> b, Judged<T>* judged, const T* A, Which... which) const {
    if (state_ == State::klu) return klu_->solve(b, which...);
    if (state_ == State::none) return make_nan(b);
    if (b.empty() || judged->solve(b, A, choice_.facts.refinements)) return;
    choice_.failed(inaccurate);
    factor_by_klu();
    if (state_ == State::klu)
      klu_->solve(b, which...);
    else
      make_nan(b);
  }

  BlockGraph graph_;
  PivotOrder prepared_order_ = PivotOrder::nodes_first;
  std::unique_ptr<Prepared> prepared_;
  // A solution that is no good makes KLU factorise.
  mutable std::unique_ptr<Interface> klu_;
  mutable Choice choice_;
  mutable State state_ = State::none;
};

class BlockSolver final : public BlockBacked<LinearSolver> {
 public:
  explicit BlockSolver(PivotOrder order)
      : BlockBacked(order),
        refinement_(order == PivotOrder::merged ? refinement_in_statics : refinement_in_time) {}

  void analyze(const BlockGraph& graph) override {
    begin(graph);
    columns_.analyze(graph);
    columns_.allocate(values_, trash_, slots_);
    prepare();
  }

  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override {
    std::fill(values_.begin(), values_.end(), 0.0);
    unchanged_ = false;
  }

  FactorStatus factor() override {
    ++choice_.facts.factorizations;
    unchanged_ = true;
    return choice_.rests() ? factor_by_klu() : factor_by_blocks();
  }

  void solve(std::span<double> x) const override {
    solve_with(x, judged_.get(), unchanged_ ? values_.data() : nullptr);
  }

  double reciprocal_condition() const override {
    judge();
    if (state_ == State::klu) return klu_->reciprocal_condition();
    if (state_ == State::none) return 0.0;
    return columns_.n == 0 ? 1.0 : mbd::reciprocal_condition(columns_, values_.data(), judged_->lu);
  }

  int determinant_sign() const override {
    judge();
    if (state_ == State::klu) return klu_->determinant_sign();
    return state_ == State::none ? 0 : judged_->lu.determinant_sign();
  }

  Index nonzeros() const override { return columns_.nonzeros; }
  std::unique_ptr<LinearSolver> another() const override { return make_klu_solver(); }

  std::unique_ptr<InertiaSolver> inertia() {
    if (prepared_order_ != PivotOrder::merged) return nullptr;
    return make_block_inertia_solver_in(
        {&graph_, &columns_, &values_, slots_, &prepared_, &judged_, [this] {
           state_ = State::none;
           unchanged_ = false;
         }});
  }

 private:
  void prepare() override {
    prepared_order_ = choice_.order;
    judged_.reset();
    prepared_ = std::make_unique<Prepared>(graph_, columns_, prepared_order_);
    judged_ = std::make_unique<Judged<double>>(prepared_->plan, columns_, refinement_);
  }
  bool factor_prepared() override {
    if (!prepared_->factor(*judged_, values_.data())) return false;
    judged_->begin();
    return true;
  }
  bool was_refined() const override { return judged_->was_refined(); }
  std::unique_ptr<LinearSolver> make_klu() const override { return make_klu_solver(); }
  FactorStatus factor_same(LinearSolver& klu) const override {
    copy_blocks(graph_, slots_, klu.slots());
    return klu.factor();
  }

  // What is said of factors is said of good ones: by a solution of any right-hand side, if none has been asked for.
  void judge() const {
    if (state_ != State::blocks || columns_.n == 0 || !unchanged_ || judged_->is_judged()) return;
    probe_.resize(static_cast<std::size_t>(columns_.n));
    for (std::size_t i = 0; i < probe_.size(); ++i)
      probe_[i] = std::sin(1.0 + 2.7 * static_cast<double>(i % 1009));
    solve(probe_);
  }

  BlockColumns columns_;
  std::vector<double> values_, trash_;
  std::vector<Slot> slots_;
  bool unchanged_ = false;  // the values, since they were factored
  const Refinement refinement_;
  std::unique_ptr<Judged<double>> judged_;
  mutable std::vector<double> probe_;
};

class BlockPencilSolver final : public BlockBacked<PencilSolver> {
 public:
  explicit BlockPencilSolver(PivotOrder order) : BlockBacked(order) {}

  void analyze(const BlockGraph& graph) override {
    begin(graph);
    blocks_.analyze(graph);
    real_.assign(blocks_.P[0].size(), 0.0);
    parts_.clear();
    own_.clear();
    const BlockColumns& columns = blocks_.columns;
    for (int c = 0; c < columns.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      if (columns.kinds[C] != 0) continue;
      for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e)
        if (columns.entries[e].row == c)
          for (int i = 0; i < columns.size(c); ++i)
            own_.push_back(columns.entries[e].offset + i * (columns.height[C] + 1));
    }
    prepare();
  }

  std::span<const Slot> slots(int power) const override { return blocks_.slots(power); }
  void set_zero() override { blocks_.set_zero(); }
  void multiply(int power, std::span<const double> x, std::span<double> y) const override {
    blocks_.multiply(power, x, y);
  }

  using PencilSolver::factor;
  FactorStatus factor(double s, double x, std::span<const std::complex<double>> z) override {
    ++choice_.facts.factorizations;
    s_ = s;
    x_ = x;
    z_.assign(z.begin(), z.end());
    while (parts_.size() < z.size()) parts_.push_back(new_part());
    if (is_tolerant()) {
      choice_.facts.reason = tolerant_diagonal;
      return factor_by_klu();
    }
    if (choice_.rests()) return factor_by_klu();
    combine();
    return factor_by_blocks();
  }

  void solve(std::span<double> b) const override { solve_with(b, of_real_.get(), real_.data()); }
  void solve(std::span<std::complex<double>> b, std::size_t which) const override {
    const Part& part = parts_[which];
    solve_with(b, part.judged.get(), part.values.data(), which);
  }

  double reciprocal_condition() const override {
    if (state_ == State::klu) return klu_->reciprocal_condition();
    if (state_ == State::none) return 0.0;
    const BlockColumns& columns = blocks_.columns;
    return columns.n == 0 ? 1.0 : mbd::reciprocal_condition(columns, real_.data(), of_real_->lu);
  }

 private:
  using Complex = std::complex<double>;
  // E(z) of one z.
  struct Part {
    std::vector<Complex> values;
    std::unique_ptr<Judged<Complex>> judged;
  };
  Part new_part() const {
    return {std::vector<Complex>(blocks_.P[0].size()),
            std::make_unique<Judged<Complex>>(prepared_->plan, blocks_.columns)};
  }

  void prepare() override {
    prepared_order_ = choice_.order;
    of_real_.reset();
    for (Part& part : parts_) part.judged.reset();
    prepared_ = std::make_unique<Prepared>(graph_, blocks_.columns, prepared_order_);
    of_real_ = std::make_unique<Judged<double>>(prepared_->plan, blocks_.columns);
    for (Part& part : parts_)
      part.judged = std::make_unique<Judged<Complex>>(prepared_->plan, blocks_.columns);
  }
  bool factor_prepared() override {
    if (!prepared_->factor(*of_real_, real_.data())) return false;
    of_real_->begin();
    for (std::size_t k = 0; k < z_.size(); ++k) {
      if (!prepared_->factor(*parts_[k].judged, parts_[k].values.data())) return false;
      parts_[k].judged->begin();
    }
    return true;
  }
  bool was_refined() const override {
    return of_real_->was_refined() ||
           std::any_of(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(z_.size()),
                       [](const Part& part) { return part.judged->was_refined(); });
  }
  std::unique_ptr<PencilSolver> make_klu() const override { return make_klu_pencil_solver(); }
  FactorStatus factor_same(PencilSolver& klu) const override {
    for (int power = 0; power < 3; ++power)
      copy_blocks(graph_, blocks_.slots(power), klu.slots(power));
    return klu.factor(s_, x_, z_);
  }

  // A diagonal that is neither empty nor that of an idle row.
  bool is_tolerant() const {
    for (const Index i : own_) {
      const double x = blocks_.P[0][static_cast<std::size_t>(i)];
      if (x != 0.0 && x != -1.0) return true;
    }
    return false;
  }

  // use(first place, their number, whether they are of two nodes) of each column of each block.
  template <class Use>
  void each_column(const Use& use) const {
    const BlockColumns& columns = blocks_.columns;
    for (int c = 0; c < columns.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e) {
        const auto R = static_cast<std::size_t>(columns.entries[e].row);
        const bool nodes = columns.kinds[C] != 0 && columns.kinds[R] != 0;
        const auto rows = static_cast<std::size_t>(columns.size(columns.entries[e].row));
        for (int j = 0; j < columns.size(c); ++j)
          use(static_cast<std::size_t>(columns.entries[e].offset + j * columns.height[C]), rows,
              nodes);
      }
    }
  }

  void combine() {
    const auto& P = blocks_.P;
    const std::complex<double> z1 = s_ * z_[0], z2 = s_ * z_[0] * z_[0];
    const double x1 = s_ * x_, x2 = s_ * x_ * x_;
    std::vector<Complex>& first = parts_[0].values;
    each_column([&](std::size_t start, std::size_t rows, bool nodes) {
      for (std::size_t i = start; i < start + rows; ++i) {
        const double p0 = P[0][i];
        if (nodes) {
          const double p1 = P[1][i], p2 = P[2][i];
          real_[i] = s_ * p0 + x1 * p1 + x2 * p2;
          first[i] = {s_ * p0 + z1.real() * p1 + z2.real() * p2, z1.imag() * p1 + z2.imag() * p2};
        } else {
          real_[i] = p0;
          first[i] = p0;
        }
      }
    });
    for (std::size_t k = 1; k < z_.size(); ++k) combine_into(parts_[k].values, z_[k]);
  }
  void combine_into(std::vector<Complex>& values, Complex z) const {
    const auto& P = blocks_.P;
    const Complex z1 = s_ * z, z2 = s_ * z * z;
    each_column([&](std::size_t start, std::size_t rows, bool nodes) {
      for (std::size_t i = start; i < start + rows; ++i)
        values[i] = nodes ? Complex(s_ * P[0][i] + z1.real() * P[1][i] + z2.real() * P[2][i],
                                    z1.imag() * P[1][i] + z2.imag() * P[2][i])
                          : Complex(P[0][i]);
    });
  }

  PencilBlocks blocks_;
  std::vector<double> real_;
  std::vector<Index> own_;  // places of the diagonals of multipliers
  double s_ = 0.0, x_ = 0.0;
  std::vector<Complex> z_;
  std::unique_ptr<Judged<double>> of_real_;
  std::vector<Part> parts_;  // those of z_ first
};

}  // namespace

std::unique_ptr<LinearSolver> make_block_solver(PivotOrder order) {
  return std::make_unique<BlockSolver>(order);
}

std::unique_ptr<InertiaSolver> make_block_inertia_solver_in(LinearSolver& solver) {
  auto* const blocks = dynamic_cast<BlockSolver*>(&solver);
  return blocks != nullptr ? blocks->inertia() : nullptr;
}

std::unique_ptr<PencilSolver> make_block_pencil_solver(PivotOrder order) {
  return std::make_unique<BlockPencilSolver>(order);
}

std::unique_ptr<LinearSolver> make_linear_solver(LinearMethod method, PivotOrder order) {
  return method == LinearMethod::klu ? make_klu_solver() : make_block_solver(order);
}

std::unique_ptr<PencilSolver> make_pencil_solver(LinearMethod method) {
  return method == LinearMethod::klu ? make_klu_pencil_solver() : make_block_pencil_solver();
}

std::string describe_linear_solver(LinearMethod method, PivotOrder order, const BlockGraph& graph) {
  if (method == LinearMethod::klu) return "KLU";
  const Elimination elimination = eliminate(graph, order);
  int most = 0;
  for (const auto& pivot : elimination.pivots) most = std::max(most, pivot.size);
  std::string text =
      fmt::format("block LU, {}: {} pivots of at most {} unknowns, {:.2g} flops a factorisation",
                  name_of(order), elimination.pivots.size(), most, elimination.flops);
  if (!elimination.fronts.empty())
    text += fmt::format(", {:.0f} % of them in {} fronts",
                        100.0 * std::min(1.0, elimination.front_flops / elimination.flops),
                        elimination.fronts.size());
  if (elimination.dissected) text += "; ordered by nested dissection (METIS)";
  return text;
}

}  // namespace mbd
