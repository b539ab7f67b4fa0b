// KINSOL over a System: y = [U of each node from the state at the start; multipliers], H = H_0 exp(U). The
// residual is taken in the present node frames, so J = S diag(T(U), I): the linear solver is ours, wrapped.
#include <kinsol/kinsol.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "libmbd/core/stop.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/newton/sundials.hpp"
#include "solvers/statics/equilibrium.hpp"

namespace mbd {
namespace {

MBD_LOADED(MBD_SUNDIALS_KINSOL, KINFree);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetErrHandlerFn);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetUserData);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINInit);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetLinearSolver);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetJacFn);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetMaxSetupCalls);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetNumMaxIters);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetFuncNormTol);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetScaledStepTol);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSetMaxNewtonStep);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINSol);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINGetNumNonlinSolvIters);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINGetReturnFlagName);
MBD_LOADED(MBD_SUNDIALS_KINSOL, KINCreate);

struct KinsolDeleter {
  void operator()(void* memory) const { KINFree(&memory); }
};

class Kinsol {
 public:
  Kinsol(const System& system, LinearSolver& solver, const NewtonOptions& options, State& state,
         Counters& counters)
      : system_(system),
        solver_(solver),
        options_(options),
        state_(state),
        counters_(counters),
        start_(state),
        motions_(6 * (system.nodes() - 1)) {
    for (sundials::Vector* const v : {&y_, &u_scale_, &f_scale_})
      *v = sundials::make_vector(system.unknowns(), context_);
    if (!memory_) throw std::bad_alloc();
  }

  bool go(std::string& failure) {
    set_scales();
    void* const memory = memory_.get();
    const auto check = [](int status) {
      if (status != KIN_SUCCESS) throw std::runtime_error("KINSOL refuses a setting");
    };
    check(KINSetErrHandlerFn(
        memory, [](int, const char*, const char*, char*, void*) {}, nullptr));
    check(KINSetUserData(memory, this));
    check(KINInit(
        memory,
        [](N_Vector y, N_Vector f, void* self) {
          return static_cast<Kinsol*>(self)->residual(y, f);
        },
        y_.get()));
    check(KINSetLinearSolver(memory, linear_.solver.get(), linear_.matrix.get()));
    check(KINSetJacFn(memory, [](N_Vector y, N_Vector, SUNMatrix, void* self, N_Vector, N_Vector) {
      return static_cast<Kinsol*>(self)->tangent(y);
    }));
    check(KINSetMaxSetupCalls(memory, 1));  // the tangent anew in each iteration
    check(KINSetNumMaxIters(memory, 10 * options_.max_iterations));
    check(KINSetFuncNormTol(memory, near_));
    check(KINSetScaledStepTol(memory, 1e-14));
    check(KINSetMaxNewtonStep(memory, std::sqrt(static_cast<double>(motions_))));
    const int status = KINSol(memory, y_.get(), KIN_LINESEARCH, u_scale_.get(), f_scale_.get());
    long iterations = 0;
    KINGetNumNonlinSolvIters(memory, &iterations);
    counters_.iterations += iterations;
    stop::check();
    move_to(y_.get());
    if (status >= 0) return true;
    char* const name = KINGetReturnFlagName(status);
    VecX r;
    system_.residual(state_, r);
    failure = fmt::format("KINSOL ends with {} (worst equation: {})", name,
                          system_.name_of(worst_row(system_, r)));
    std::free(name);
    return false;
  }

  // Of the linear solver that KINSOL calls.
  int factor() {
    ++counters_.factorizations;
    return solver_.factor() == FactorStatus::ok ? 0 : 1;
  }
  int solve(N_Vector x, N_Vector b) const {
    auto y = map(x);
    y = map(b);
    solver_.solve({y.data(), static_cast<std::size_t>(y.size())});
    for (Index n = 0; n < motions_; n += 6)
      y.segment<6>(n) = T_inverse_times<double>(at_.segment<6>(n), y.segment<6>(n));
    return y.allFinite() ? 0 : 1;
  }

 private:
  static Eigen::Map<VecX> map(N_Vector v) {
    const auto x = sundials::values(v);
    return {x.data(), static_cast<Index>(x.size())};
  }

  // Lengths by the scene's, forces by the largest stiffness times that length, moments by length more;
  // multipliers by the same forces. Residuals are of order one where strains are.
  void set_scales() {
    VecX r;
    system_.linearize(start_, {}, r, solver_);
    const double length = system_.length_scale(),
                 force =
                     std::max(largest_stiffness_behind(system_, solver_.slots()) * length, 1e-300);
    auto u = map(u_scale_.get()), f = map(f_scale_.get());
    for (Index i = 0; i < motions_; ++i) {
      const bool turns = i % 6 >= 3;
      u(i) = turns ? 1.0 : 1.0 / length;
      f(i) = 1.0 / (turns ? force * length : force);
    }
    for (const ConstraintInfo& c : system_.constraints())
      for (Index i = 0; i < c.rows; ++i) {
        const bool is_moment = !c.is_position[static_cast<std::size_t>(i)];
        u(motions_ + c.first_row + i) = 1.0 / (is_moment ? force * length : force);
        f(motions_ + c.first_row + i) = is_moment ? 1.0 : 1.0 / length;
      }
  }

  void move_to(N_Vector y) {
    state_.pose = start_.pose;
    state_.lambda = start_.lambda;
    state_.angles = start_.angles;
    retract(system_, state_, map(y));
  }

  int residual(N_Vector y, N_Vector f) {
    if (stop::requested()) return -1;  // go() says so: nothing may be thrown through KINSOL
    move_to(y);
    ++counters_.residuals;
    // Out of the elements' range: a recoverable error, for which KINSOL takes a shorter step.
    if (!system_.residual(state_, r_) || !r_.allFinite()) return 1;
    map(f) = r_.tail(system_.unknowns());
    return 0;
  }
  int tangent(N_Vector y) {
    if (stop::requested()) return -1;
    move_to(y);
    at_ = map(y);
    ++counters_.tangents;
    return system_.linearize(state_, {}, r_, solver_) ? 0 : 1;
  }
  static constexpr double near_ = 1e-9;  // of the scaled residual: our Newton does the rest

  const System& system_;
  LinearSolver& solver_;
  const NewtonOptions& options_;
  State& state_;
  Counters& counters_;
  const State start_;
  const Index motions_;
  VecX r_, at_;
  sundials::Context context_ = sundials::make_context();
  sundials::Vector y_, u_scale_, f_scale_;
  sundials::OwnSolver linear_{*this, context_};
  std::unique_ptr<void, KinsolDeleter> memory_{KINCreate(context_.get())};
};

}  // namespace

bool kinsol_equilibrium(const System& system, LinearSolver& solver, const NewtonOptions& options,
                        State& state, Counters& counters, std::string& failure,
                        NeutralMotions* neutral, MixedIterate* mixed) {
  if (!Kinsol(system, solver, options, state, counters).go(failure)) return false;
  if (mixed != nullptr) mixed->resultants.clear();  // foretold for another way here
  return newton_equilibrium(system, solver, options, state, counters, failure, neutral, mixed);
}

}  // namespace mbd
