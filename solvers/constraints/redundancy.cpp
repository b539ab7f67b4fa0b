#include "solvers/constraints/redundancy.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "joints/any_joint_batch.hpp"
#include "libmbd/core/disjoint_sets.hpp"
#include "libmbd/core/error.hpp"
#include "solvers/constraints/row_echelon.hpp"
#include "solvers/newton/increments.hpp"

namespace mbd {
namespace {

constexpr double involved = 1e-6;  // least share of a row that is named
// Rows that repeat others, of constraints that they tie together: what is done with them is dense, takes seconds at
// this number, and goes with its cube.
constexpr std::ptrdiff_t most_tied = 1000;
// How far an idle row may be open: of the scene's length and of the largest velocity, and of what others are.
constexpr double open_of_size = 1e-9, open_of_others = 1e3;

using Sparse = Eigen::SparseMatrix<double>;

// Takes the constraint rows out of a linearisation; everything else is thrown away.
class ConstraintRows : public LinearSolver {
 public:
  void analyze(const BlockGraph& graph) override {
    int nodes = 0, largest = 6;
    for (const auto& block : graph.blocks) {
      nodes += block.kind == BlockGraph::Kind::node ? 1 : 0;
      largest = std::max(largest, block.size);
    }
    trash_.setZero(largest, largest);
    const auto is_row = [&](const BlockGraph::Contribution& c) {
      return c.row >= nodes && c.column >= 0 && c.column < nodes;
    };
    pieces_.reserve(static_cast<std::size_t>(
        std::count_if(graph.contributions.begin(), graph.contributions.end(), is_row)));
    for (const auto& c : graph.contributions) {
      if (!is_row(c)) {
        slots_.push_back({trash_.data(), trash_.rows()});
        continue;
      }
      const int rows = graph.blocks[static_cast<std::size_t>(c.row)].size;
      pieces_.push_back({c.row - nodes, c.column + 1, Eigen::MatrixXd::Zero(rows, 6)});
      slots_.push_back({pieces_.back().B.data(), rows});
    }
  }
  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override {
    for (GradientBlock& piece : pieces_) piece.B.setZero();
  }
  FactorStatus factor() override { return FactorStatus::singular; }
  Index singular_row() const override { return -1; }
  void solve(std::span<double> x) const override { std::fill(x.begin(), x.end(), std::nan("")); }
  double reciprocal_condition() const override { return 0.0; }
  Index nonzeros() const override { return 0; }

  const std::vector<GradientBlock>& pieces() const { return pieces_; }

 private:
  std::vector<GradientBlock> pieces_;
  std::vector<Slot> slots_;
  Eigen::MatrixXd trash_;
};

Dependence dependence(const System& system, const State& state, double least) {
  const std::vector<Index> rows = rows_in_loops(system);
  if (rows.empty()) return {};
  const ConstraintEntries entries = scaled_gradient(system, state);
  return find_dependent(entries, system.multipliers(), 6 * (system.nodes() - 1), rows, least);
}

// As find_dependent().null, where it is known which rows repeat others, but the state is off the constraints, by what
// interpolation in a step leaves, and ranks cannot be seen: of the rows B, scaled to length one, the singular vectors of the
// smallest singular values, by inverse iteration from the idle rows. (Not used: of each idle row its nearest combination of the
// others; where these come near to repeating each other it errs by the distance from the constraints over theirs.)
Sparse null_of_idle(const System& system, const State& state) {
  constexpr double shift =
      1e-10;  // of squares of singular values: below it none is told from another
  constexpr int passes = 2;
  const Index multipliers = system.multipliers();
  const std::vector<Index> rows = rows_in_loops(system);
  std::vector<int> place(static_cast<std::size_t>(multipliers), -1);  // among the rows in loops
  for (std::size_t k = 0; k < rows.size(); ++k)
    place[static_cast<std::size_t>(rows[k])] = static_cast<int>(k);
  const auto count = static_cast<Index>(rows.size());
  ConstraintEntries entries;
  VecX length = VecX::Zero(count);
  for (const auto& e : scaled_gradient(system, state))
    if (const int k = place[static_cast<std::size_t>(e.row())]; k >= 0) {
      entries.emplace_back(k, e.col(), e.value());
      length(k) += e.value() * e.value();
    }
  for (double& l : length) l = l > 0.0 ? std::sqrt(l) : 1.0;
  Sparse B(count, 6 * (system.nodes() - 1)), unit(count, count);
  B.setFromTriplets(entries.begin(), entries.end());
  B = length.cwiseInverse().asDiagonal() * B;
  unit.setIdentity();
  const Eigen::SimplicialLDLT<Sparse> squares(Sparse(B * B.transpose()) + shift * unit);
  const auto idle = static_cast<Index>(state.idle.size());
  Eigen::MatrixXd n = Eigen::MatrixXd::Zero(count, idle);
  for (Index i = 0; i < idle; ++i)
    n(place[static_cast<std::size_t>(state.idle[static_cast<std::size_t>(i)])], i) = 1.0;
  for (int pass = 0; pass < passes; ++pass) {
    n = squares.solve(n).eval();
    n.colwise().normalize();
  }
  ConstraintEntries null;
  for (Index i = 0; i < idle; ++i)
    for (Index k = 0; k < count; ++k)
      if (n(k, i) != 0.0)
        null.emplace_back(static_cast<int>(rows[static_cast<std::size_t>(k)]), static_cast<int>(i),
                          n(k, i) / length(k));
  Sparse result(multipliers, idle);
  result.setFromTriplets(null.begin(), null.end());
  return result;
}

// 1 for a force, 1/L for a moment: both in the same unit.
VecX multiplier_units(const System& system) {
  VecX w(system.multipliers());
  for (const ConstraintInfo& info : system.constraints())
    for (Index i = 0; i < info.rows; ++i)
      w(info.first_row + i) =
          info.is_position[static_cast<std::size_t>(i)] ? 1.0 : 1.0 / system.reaction_length();
  return w;
}

// Dependences that share rows, and the rows: what is dense is taken of these, group by group.
struct Group {
  std::vector<Index> rows;     // of all that n_i hold, rising
  std::vector<Index> columns;  // of Dependence::null, rising
  Eigen::MatrixXd null;        // those entries
};

std::vector<Group> groups_of(const Sparse& null) {
  DisjointSets tied(static_cast<int>(null.rows()));
  for (int k = 0; k < null.outerSize(); ++k) {
    const Sparse::InnerIterator first(null, k);
    for (Sparse::InnerIterator it(null, k); it; ++it)
      tied.join(static_cast<int>(first.row()), static_cast<int>(it.row()));
  }
  std::map<int, Group> groups;  // by root
  for (int k = 0; k < null.outerSize(); ++k)
    if (const Sparse::InnerIterator first(null, k); first)
      groups[tied.root(static_cast<int>(first.row()))].columns.push_back(k);
  std::vector<Index> place(static_cast<std::size_t>(null.rows()), -1);  // of a row in its group
  for (Index i = 0; i < null.rows(); ++i)
    if (const auto it = groups.find(tied.root(static_cast<int>(i))); it != groups.end()) {
      place[static_cast<std::size_t>(i)] = std::ssize(it->second.rows);
      it->second.rows.push_back(i);
    }
  std::vector<Group> result;
  for (auto& [root, group] : groups) {
    group.null.setZero(std::ssize(group.rows), std::ssize(group.columns));
    for (Index j = 0; j < group.null.cols(); ++j)
      for (Sparse::InnerIterator it(null, group.columns[static_cast<std::size_t>(j)]); it; ++it)
        group.null(place[static_cast<std::size_t>(it.row())], j) = it.value();
    result.push_back(std::move(group));
  }
  return result;
}

// Entries of a vector over all multipliers.
VecX part_of(const VecX& all, const std::vector<Index>& rows) {
  VecX part(std::ssize(rows));
  for (Index i = 0; i < part.size(); ++i) part(i) = all(rows[static_cast<std::size_t>(i)]);
  return part;
}

// Columns of length one, of the group's in one unit.
Eigen::MatrixXd unit_columns(const VecX& units, const Group& group) {
  return (part_of(units, group.rows).asDiagonal() * group.null).colwise().normalized();
}

// Rows that repeat others, of constraints that are tied to each other by that.
void refuse_too_many(const System& system, const Dependence& found) {
  if (found.null.cols() <= most_tied) return;
  const std::vector<ConstraintInfo>& constraints = system.constraints();
  std::vector<int> owner;  // of each row
  for (int c = 0; c < static_cast<int>(constraints.size()); ++c)
    owner.resize(
        owner.size() + static_cast<std::size_t>(constraints[static_cast<std::size_t>(c)].rows), c);
  const auto owner_of = [&owner](const Sparse::InnerIterator& it) {
    return owner[static_cast<std::size_t>(it.row())];
  };
  DisjointSets tied(static_cast<int>(constraints.size()));
  for (int k = 0; k < found.null.outerSize(); ++k) {
    const Sparse::InnerIterator first(found.null, k);
    for (Sparse::InnerIterator it(found.null, k); it; ++it)
      tied.join(owner_of(first), owner_of(it));
  }
  std::map<int, std::ptrdiff_t> count;
  for (int k = 0; k < found.null.outerSize(); ++k) {
    const int root = tied.root(owner_of(Sparse::InnerIterator(found.null, k)));
    if (++count[root] <= most_tied) continue;
    throw Error(fmt::format(
        "more than {} constraint rows repeat others of the same joints, and fewer are sorted out "
        "(which of them to leave out, and reactions of least norm, take dense matrices of their "
        "number): {}; leave joints out that hold what others hold",
        most_tied, to_text(system, found.redundant[static_cast<std::size_t>(k)])));
  }
}

}  // namespace

std::vector<char> prescribed_constraints(const System& system) {
  const auto nodes = static_cast<int>(system.nodes()) - 1;
  std::vector<char> result(system.constraints().size(), 0);
  const auto first = system.first_contributions();
  const auto& contributions = system.graph().contributions;
  for (std::size_t b = 0; b < system.batches().size(); ++b) {
    const auto* const joints = dynamic_cast<const joint::AnyJointBatch*>(system.batches()[b].get());
    if (joints == nullptr || joints->traits().law == joint::Law::none) continue;
    for (std::size_t i = first[b]; i < first[b + 1]; ++i)
      if (contributions[i].row >= nodes)
        result[static_cast<std::size_t>(contributions[i].row - nodes)] = 1;
  }
  return result;
}

std::vector<GradientBlock> constraint_gradients(const System& system, const State& state) {
  ConstraintRows rows;
  rows.analyze(system.graph());
  VecX r(system.rows());
  if (state.idle.empty()) {
    system.linearize(state, {}, r, rows);
  } else {
    State all = state;
    all.idle.clear();
    system.linearize(all, {}, r, rows);
  }
  std::vector<GradientBlock> pieces = rows.pieces();
  std::erase_if(pieces, [&system](const GradientBlock& piece) {
    return system.constraints()[static_cast<std::size_t>(piece.constraint)].gives;
  });
  return pieces;
}

std::vector<Index> rows_in_loops(const System& system) {
  const auto nodes = static_cast<int>(system.nodes()) - 1;
  DisjointSets tied(nodes);
  const std::size_t count = system.constraints().size();
  std::vector<std::vector<int>> nodes_of(count);
  for (const auto& c : system.graph().contributions)
    if (c.row >= nodes && c.column >= 0 && c.column < nodes &&
        !system.constraints()[static_cast<std::size_t>(c.row - nodes)].gives)
      nodes_of[static_cast<std::size_t>(c.row - nodes)].push_back(c.column);
  for (const auto& ends : nodes_of)
    for (std::size_t i = 1; i < ends.size(); ++i) tied.join(ends[0], ends[i]);
  // A tree of n nodes has n - 1 constraints inside and one to the ground at most.
  std::vector<int> inside(static_cast<std::size_t>(nodes), 1), grounded(inside.size(), 0);
  for (int n = 0; n < nodes; ++n) --inside[static_cast<std::size_t>(tied.root(n))];
  for (const auto& ends : nodes_of)
    if (!ends.empty())
      ++(ends.size() > 1 ? inside : grounded)[static_cast<std::size_t>(tied.root(ends[0]))];
  std::vector<std::size_t> looped;
  for (std::size_t c = 0; c < count; ++c) {
    if (system.constraints()[c].gives) continue;
    const auto part = nodes_of[c].empty() ? -1 : tied.root(nodes_of[c][0]);
    if (part >= 0 && inside[static_cast<std::size_t>(part)] <= 0 &&
        grounded[static_cast<std::size_t>(part)] <= 1)
      continue;
    looped.push_back(c);
  }
  // Joints first, so that a drive is blamed before the joint it drives.
  const std::vector<char> is_prescribed = prescribed_constraints(system);
  std::vector<Index> rows;
  for (const bool prescribed : {false, true})
    for (const std::size_t c : looped)
      for (Index i = 0; (is_prescribed[c] != 0) == prescribed && i < system.constraints()[c].rows;
           ++i)
        rows.push_back(system.constraints()[c].first_row + i);
  return rows;
}

namespace {

// tied_lengths(), by the blocks of B.
std::vector<double> lengths_of(const System& system, const State& state,
                               const std::vector<GradientBlock>& blocks) {
  constexpr double none = 1e-9;  // of the scene: round-off of places
  const double L = system.length_scale();
  DisjointSets tied(static_cast<int>(system.nodes()));
  std::vector<int> first(system.constraints().size(), 0);  // node of a constraint; 0: none yet
  for (const GradientBlock& block : blocks) {
    int& other = first[static_cast<std::size_t>(block.constraint)];
    if (other == 0) other = block.node;
    tied.join(other, block.node);
  }
  std::vector<double> size(static_cast<std::size_t>(system.nodes()), 0.0);  // by root
  const auto of_part = [&](int node) -> double& {
    return size[static_cast<std::size_t>(tied.root(node))];
  };
  for (int n = 1; n < static_cast<int>(system.nodes()); ++n) {
    const Vec3& here = state.pose[static_cast<std::size_t>(n)].r;
    const Vec3& there = state.pose[static_cast<std::size_t>(tied.root(n))].r;
    of_part(n) = std::max(of_part(n), (here - there).norm());
  }
  for (const GradientBlock& block : blocks)
    for (Index i = 0; i < block.B.rows(); ++i)
      if (const double moves = block.B.row(i).head<3>().norm();
          moves > 0.0 && system.constraints()[static_cast<std::size_t>(block.constraint)]
                             .is_position[static_cast<std::size_t>(i)])
        of_part(block.node) =
            std::max(of_part(block.node), block.B.row(i).tail<3>().norm() / moves);
  std::vector<double> lengths(size.size(), L);
  for (int n = 1; n < static_cast<int>(system.nodes()); ++n)
    if (const double own = of_part(n); own > none * L) lengths[static_cast<std::size_t>(n)] = own;
  return lengths;
}

ConstraintEntries scaled(const System& system, const std::vector<GradientBlock>& blocks,
                         const std::vector<double>& lengths) {
  ConstraintEntries entries;
  for (const GradientBlock& block : blocks) {
    const ConstraintInfo& info = system.constraints()[static_cast<std::size_t>(block.constraint)];
    const double length = lengths[static_cast<std::size_t>(block.node)];
    for (Index i = 0; i < info.rows; ++i)
      for (int j = 0; j < 6; ++j)
        if (block.B(i, j) != 0.0)
          entries.emplace_back(static_cast<int>(info.first_row + i), 6 * (block.node - 1) + j,
                               (j < 3 ? 1.0 : 1.0 / length) * block.B(i, j));
  }
  return entries;
}

}  // namespace

std::vector<double> tied_lengths(const System& system, const State& state) {
  return lengths_of(system, state, constraint_gradients(system, state));
}

ConstraintEntries scaled_gradient(const System& system, const State& state) {
  const std::vector<GradientBlock> blocks = constraint_gradients(system, state);
  return scaled(system, blocks, lengths_of(system, state, blocks));
}

ConstraintEntries scaled_gradient(const System& system, const State& state,
                                  const std::vector<double>& lengths) {
  return scaled(system, constraint_gradients(system, state), lengths);
}

Dependence find_dependent(const ConstraintEntries& entries, Index all_rows, Index columns,
                          const std::vector<Index>& order, double least) {
  const auto rows = static_cast<Index>(order.size());
  Dependence result;
  result.rank_of_first.assign(order.size() + 1, 0);
  result.null.resize(all_rows, 0);
  if (rows == 0) return result;

  std::vector<Index> place(static_cast<std::size_t>(all_rows), -1);  // row -> column of B^T
  for (Index i = 0; i < rows; ++i)
    place[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = i;
  VecX size = VecX::Zero(rows);
  for (const auto& e : entries) {
    const Index i = place[static_cast<std::size_t>(e.row())];
    if (i >= 0) size(i) = std::hypot(size(i), e.value());
  }
  // B^T with unit columns; an empty column stays empty and is dependent.
  ConstraintEntries scaled;
  scaled.reserve(entries.size());
  for (const auto& e : entries) {
    const Index i = place[static_cast<std::size_t>(e.row())];
    if (i >= 0 && size(i) > 0.0)
      scaled.emplace_back(e.col(), static_cast<int>(i), e.value() / size(i));
  }
  const RowEchelon R(scaled, columns, rows, least);
  std::vector<Index> dependent;  // by row of the matrix, places in `order`
  for (Index k = 0; k < rows; ++k) {
    const auto n = static_cast<std::size_t>(k);
    result.rank_of_first[n + 1] = result.rank_of_first[n] + (R.is_independent(k) ? 1 : 0);
    if (!R.is_independent(k)) dependent.push_back(k);
  }
  const auto row_at = [&](Index k) { return order[static_cast<std::size_t>(k)]; };
  std::sort(dependent.begin(), dependent.end(),
            [&](Index a, Index b) { return row_at(a) < row_at(b); });
  ConstraintEntries null;
  for (const Index k : dependent) {
    std::vector<std::pair<Index, double>> share = R.combination(k);
    const auto column = static_cast<int>(result.redundant.size());
    RedundantRow row;
    row.row = row_at(k);
    null.emplace_back(static_cast<int>(row.row), column, size(k) > 0.0 ? 1.0 / size(k) : 1.0);
    for (const auto& [i, x] : share)
      null.emplace_back(static_cast<int>(row_at(i)), column, -x / size(i));
    std::erase_if(share, [](const auto& s) { return !(std::abs(s.second) > involved); });
    std::sort(share.begin(), share.end(), [](const auto& a, const auto& b) {
      const double x = std::abs(a.second), y = std::abs(b.second);
      return x != y ? x > y : a.first < b.first;
    });
    for (const auto& [i, x] : share) row.repeats.push_back(row_at(i));
    result.redundant.push_back(std::move(row));
  }
  result.null.resize(all_rows, std::ssize(dependent));
  result.null.setFromTriplets(null.begin(), null.end());
  return result;
}

bool has_loops(const System& system) { return !rows_in_loops(system).empty(); }

namespace {

Redundancy redundancy(const System& system, const State& state, double least) {
  Redundancy result;
  Dependence found = dependence(system, state, least);
  if (found.redundant.empty()) return result;
  refuse_too_many(system, found);
  const std::vector<Group> groups = groups_of(found.null);
  const VecX units = multiplier_units(system);
  for (const Group& group : groups) {
    const Eigen::MatrixXd null = unit_columns(units, group).transpose();
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(null);
    const auto& order = qr.colsPermutation().indices();
    for (Index k = 0; k < null.rows(); ++k)
      result.idle.push_back(group.rows[static_cast<std::size_t>(order(k))]);
  }
  std::sort(result.idle.begin(), result.idle.end());
  result.rows = std::move(found.redundant);
  result.null = std::move(found.null);
  return result;
}

}  // namespace

Redundancy find_redundancy(const System& system, const State& state) {
  return redundancy(system, state, independent);
}

Redundancy find_redundancy_nearby(const System& system, const State& state) {
  constexpr double moved = 100.0, most = 1e-4;  // rows of B, by what the state is off; at most
  State all = state;
  all.idle.clear();
  VecX g, gdot;
  system.constraints(all, g, gdot);
  return redundancy(system, state,
                    std::clamp(moved * largest_violation(system, g), independent, most));
}

VecX minimum_norm(const System& system, const State& state) {
  const Dependence found = dependence(system, state, independent);
  const bool unseen = found.redundant.size() < state.idle.size();
  if (found.redundant.empty() && !unseen) return state.lambda;
  const VecX units = multiplier_units(system);
  VecX result = state.lambda;
  for (const Group& group : groups_of(unseen ? null_of_idle(system, state) : found.null)) {
    const Eigen::MatrixXd null = unit_columns(units, group);
    const VecX unit = part_of(units, group.rows);
    const VecX lambda = unit.cwiseProduct(part_of(state.lambda, group.rows));
    const VecX least = (lambda - null * null.householderQr().solve(lambda)).cwiseQuotient(unit);
    for (Index i = 0; i < least.size(); ++i)
      result(group.rows[static_cast<std::size_t>(i)]) = least(i);
  }
  return result;
}

VecX without_idle(const System& system, const State& state, const std::vector<Index>& idle) {
  const Dependence found = dependence(system, state, independent);
  if (idle.empty() || found.null.cols() != std::ssize(idle)) return state.lambda;
  VecX result = state.lambda;
  for (const Group& group : groups_of(found.null)) {
    std::vector<Index> places;  // of its idle rows among its rows
    for (Index i = 0; i < std::ssize(group.rows); ++i)
      if (std::binary_search(idle.begin(), idle.end(), group.rows[static_cast<std::size_t>(i)]))
        places.push_back(i);
    const Eigen::MatrixXd null = group.null(places, Eigen::all);
    const VecX lambda = part_of(state.lambda, group.rows);
    const VecX rest = lambda - group.null * null.colPivHouseholderQr().solve(VecX(lambda(places)));
    for (Index i = 0; i < rest.size(); ++i)
      result(group.rows[static_cast<std::size_t>(i)]) = rest(i);
  }
  for (const Index row : idle) result(row) = 0.0;
  return result;
}

std::optional<std::string> idle_rows_open(const System& system, const State& state,
                                          double tolerated) {
  if (state.idle.empty()) return std::nullopt;
  State all = state;
  all.idle.clear();
  VecX r, rest, gdot = VecX::Zero(system.multipliers());
  system.residual(all, r);
  const VecX g = r.tail(system.multipliers());
  double fastest = 0.0;
  if (!state.V.empty()) system.constraint_rates(all, gdot, rest);
  for (const Vec6& V : state.V) fastest = std::max(fastest, V.cwiseAbs().maxCoeff());
  double gap = 0.0, rate = 0.0;  // of the rows that are imposed
  for (Index i = 0, next = 0; i < g.size(); ++i) {
    if (next < static_cast<Index>(state.idle.size()) &&
        state.idle[static_cast<std::size_t>(next)] == i) {
      ++next;
      continue;
    }
    gap = std::max(gap, std::abs(g(i)));
    rate = std::max(rate, std::abs(gdot(i)));
  }
  const double L = system.length_scale();
  const double of_size = std::max(open_of_size, tolerated);
  const double most_gap = std::max(of_size * L, open_of_others * gap);
  const double most_rate =
      std::max({of_size * fastest, open_of_others * rate, open_of_others * gap / L * fastest});
  Index worst = -1;
  double size = 1.0;
  for (const Index i : state.idle) {
    double by = std::abs(g(i)) / most_gap;
    if (most_rate > 0.0) by = std::max(by, std::abs(gdot(i)) / most_rate);
    if (by > size) {
      size = by;
      worst = i;
    }
  }
  if (worst < 0) return std::nullopt;
  std::string others;
  for (const RedundantRow& row : find_redundancy(system, state).rows)
    if (row.row == worst ||
        std::find(row.repeats.begin(), row.repeats.end(), worst) != row.repeats.end()) {
      others = to_text(system, row);
      break;
    }
  return fmt::format(
      "constraints that repeated each other contradict each other, or repeated each other in one "
      "position only (a change point, which radau and generalized_alpha pass): {} is open by "
      "{:.3g}, and opens at {:.3g}/s, while the others hold{}{}",
      row_in_words(system, worst), std::abs(g(worst)), std::abs(gdot(worst)),
      others.empty() ? "" : "; ", others);
}

std::string row_in_words(const System& system, Index row) {
  return system.name_of(6 * system.nodes() + row);
}

std::string to_text(const System& system, const RedundantRow& row) {
  constexpr std::size_t most = 3;
  std::string text = row_in_words(system, row.row);
  if (row.repeats.empty()) return text + " holds nothing that moves";
  text += " repeats ";
  for (std::size_t i = 0; i < std::min(most, row.repeats.size()); ++i)
    text += (i == 0 ? "" : ", ") + row_in_words(system, row.repeats[i]);
  if (row.repeats.size() > most) text += fmt::format(" and {} more", row.repeats.size() - most);
  return text;
}

}  // namespace mbd
