#include "solvers/linear/inertia_solver.hpp"

#include <dlfcn.h>
#include <dmumps_c.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

// Jobs and parameters of MUMPS 5.5, numbered from 1 as its manual does.
enum Job { initialize = -1, terminate = -2, analyze_pattern = 1, factorize = 2, solve_system = 3 };
enum Control {
  errors_to = 1,
  diagnostics_to = 2,
  global_to = 3,
  verbosity = 4,
  root_sequential = 13,
  more_memory = 14
};
constexpr MUMPS_INT general_symmetric = 2;
constexpr MUMPS_INT integer_workspace_too_small = -8, real_workspace_too_small = -9;
constexpr MUMPS_INT numerically_singular = -10;

// What MUMPS is called by. Its library is loaded when it is first asked for: with it come LAPACK, Fortran's and Scotch's, a third
// of all that a program would load at its start. Throws Error where there is none.
decltype(&::dmumps_c) mumps() {
  static const auto entry = [] {
    void* const library = dlopen(MBD_MUMPS_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    void* const found = library == nullptr ? nullptr : dlsym(library, "dmumps_c");
    if (found == nullptr) {
      const char* const why = dlerror();
      throw Error(std::string("MUMPS cannot be loaded (") + (why ? why : MBD_MUMPS_LIBRARY) +
                  "); install libmumps-seq-5.5 (Debian)");
    }
    return reinterpret_cast<decltype(&::dmumps_c)>(found);
  }();
  return entry;
}

class MumpsSolver : public InertiaSolver {
 public:
  MumpsSolver() {
    mumps_.sym = general_symmetric;
    mumps_.par = 1;
    mumps_.comm_fortran = -987654;  // MPI_COMM_WORLD, of the sequential library
    if (run(initialize) < 0)
      throw Error("MUMPS does not start (error " + std::to_string(mumps_.infog[0]) + ")");
    for (const Control stream : {errors_to, diagnostics_to, global_to}) control(stream) = -1;
    control(verbosity) = 0;
    control(root_sequential) = 1;  // so that negative pivots of the root are counted
  }
  ~MumpsSolver() override { run(terminate); }
  MumpsSolver(const MumpsSolver&) = delete;
  MumpsSolver& operator=(const MumpsSolver&) = delete;

  void analyze(const BlockGraph& graph) override {
    const std::size_t blocks = graph.blocks.size();
    first_.assign(blocks + 1, 0);
    for (std::size_t b = 0; b < blocks; ++b)
      first_[b + 1] = first_[b] + static_cast<Index>(graph.blocks[b].size);
    n_ = first_.back();

    std::map<std::pair<int, int>, std::size_t> known;
    places_.clear();
    std::size_t size = 0;
    int largest = 1;
    for (const auto& block : graph.blocks) largest = std::max(largest, block.size);
    const auto place = [&](int row, int column) {
      const auto [it, is_new] = known.try_emplace({row, column}, places_.size());
      if (is_new) {
        const auto& r = graph.blocks[static_cast<std::size_t>(row)];
        const auto& c = graph.blocks[static_cast<std::size_t>(column)];
        const bool motion = r.kind == BlockGraph::Kind::node && c.kind == BlockGraph::Kind::node;
        places_.push_back({row, column, r.size, c.size, size, motion, 0});
        size += static_cast<std::size_t>(r.size) * static_cast<std::size_t>(c.size);
      }
      return it->second;
    };
    std::vector<std::optional<std::size_t>> of_contribution;
    for (const auto& [row, column] : graph.contributions) {
      if (row < 0 || column < 0) {
        of_contribution.emplace_back();
        continue;
      }
      of_contribution.emplace_back(place(row, column));
      place(column, row);
    }
    for (Place& p : places_) p.transposed = known.at({p.column, p.row});

    values_.assign(size, 0.0);
    trash_.assign(static_cast<std::size_t>(largest) * static_cast<std::size_t>(largest), 0.0);
    slots_.clear();
    for (const auto& p : of_contribution) {
      if (p)
        slots_.push_back({values_.data() + places_[*p].start, places_[*p].rows});
      else
        slots_.push_back({trash_.data(), largest});
    }

    analyze_entries();
  }

  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override { std::fill(values_.begin(), values_.end(), 0.0); }

  FactorStatus factor() override {
    negative_.reset();
    std::size_t k = 0;
    double largest = 0.0, difference = 0.0;
    bool finite = true;
    for (const Place& p : places_)
      for_lower(p, [&](Index, Index, double value, double mirrored) {
        entries_[k] = 0.5 * (value + mirrored);
        finite = finite && std::isfinite(entries_[k]);
        ++k;
        if (!p.motion) return;
        largest = std::max({largest, std::abs(value), std::abs(mirrored)});
        difference = std::max(difference, std::abs(value - mirrored));
      });
    asymmetry_ = largest > 0.0 ? difference / largest : 0.0;
    if (!finite) return FactorStatus::singular;
    if (n_ == 0) {
      negative_ = 0;
      return FactorStatus::ok;
    }
    // Delayed pivots may need more room than the analysis foresaw, by this many per cent.
    for (control(more_memory) = 30; control(more_memory) <= 2000; control(more_memory) *= 4) {
      const MUMPS_INT status = run(factorize);
      if (status >= 0) {
        negative_ = mumps_.infog[11];
        return FactorStatus::ok;
      }
      if (status == numerically_singular) break;
      if (status != integer_workspace_too_small && status != real_workspace_too_small)
        throw Error("the factorisation of the symmetric tangent failed (MUMPS error " +
                    std::to_string(status) + ")");
    }
    return FactorStatus::singular;
  }

  Index singular_row() const override { return -1; }

  void solve(std::span<double> x) const override {
    if (n_ == 0) return;
    mumps_.rhs = x.data();
    mumps_.nrhs = 1;
    mumps_.lrhs = static_cast<MUMPS_INT>(n_);
    if (!negative_ || run(solve_system) < 0)
      std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
  }

  double reciprocal_condition() const override { return 0.0; }  // not estimated
  Index nonzeros() const override { return static_cast<Index>(entries_.size()); }
  std::unique_ptr<LinearSolver> another() const override { return make_inertia_solver(); }

  std::optional<Index> negative_eigenvalues() const override { return negative_; }
  double asymmetry() const override { return asymmetry_; }

 private:
  // Of the lower triangle, in MUMPS's own terms.
  void analyze_entries() {
    rows_.clear();
    columns_.clear();
    for (const Place& p : places_)
      for_lower(p, [&](Index i, Index j, double, double) {
        rows_.push_back(static_cast<MUMPS_INT>(i + 1));
        columns_.push_back(static_cast<MUMPS_INT>(j + 1));
      });
    entries_.assign(rows_.size(), 0.0);
    mumps_.n = static_cast<MUMPS_INT>(n_);
    mumps_.nnz = static_cast<MUMPS_INT8>(rows_.size());
    mumps_.irn = rows_.data();
    mumps_.jcn = columns_.data();
    mumps_.a = entries_.data();
    if (n_ > 0 && run(analyze_pattern) < 0)
      throw Error("the analysis of the symmetric tangent failed (MUMPS error " +
                  std::to_string(mumps_.infog[0]) + ")");
  }
  struct Place {
    int row, column;
    int rows, columns;
    std::size_t start;
    bool motion;
    std::size_t transposed;  // place of the mirrored block
  };

  MUMPS_INT& control(Control which) { return mumps_.icntl[which - 1]; }

  MUMPS_INT run(Job job) const {
    // MUMPS keeps some of its state for the whole program: two calls at once end it.
    static std::mutex one_at_a_time;
    const std::lock_guard<std::mutex> lock(one_at_a_time);
    mumps_.job = job;
    mumps()(&mumps_);
    return mumps_.infog[0];
  }

  // visit(row, column, S_ij, S_ji) for the entries of a block that lie on or below the diagonal.
  template <class Visit>
  void for_lower(const Place& p, const Visit& visit) const {
    if (p.row < p.column) return;
    const double* block = values_.data() + p.start;
    const double* mirrored = values_.data() + places_[p.transposed].start;
    for (int c = 0; c < p.columns; ++c)
      for (int r = p.row == p.column ? c : 0; r < p.rows; ++r)
        visit(first_[static_cast<std::size_t>(p.row)] + r,
              first_[static_cast<std::size_t>(p.column)] + c, block[c * p.rows + r],
              mirrored[r * p.columns + c]);
  }

  mutable DMUMPS_STRUC_C mumps_{};  // solving writes statistics
  Index n_ = 0;
  std::vector<Index> first_;  // unknown of each block
  std::vector<Place> places_;
  std::vector<double> values_;  // blocks, each column-major
  std::vector<double> trash_;   // what is added to the ground
  std::vector<Slot> slots_;
  std::vector<MUMPS_INT> rows_, columns_;  // lower triangle, from 1
  std::vector<double> entries_;
  std::optional<Index> negative_;
  double asymmetry_ = 0.0;
};

}  // namespace

std::unique_ptr<InertiaSolver> make_inertia_solver() { return std::make_unique<MumpsSolver>(); }

}  // namespace mbd
