#include "libmbd/results/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/scene/scene.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {
namespace {

constexpr double unit_round_off = std::numeric_limits<double>::epsilon();
constexpr double small_method_error = 0.01, much_method_error = 0.1;  // errors of a method
constexpr double half_damped = 0.5;  // energy that damps away: it may be meant to, up to there
constexpr double near_tolerance = 10.0, beyond_tolerance = 1000.0;  // of a tolerance
constexpr double slow_contraction = 0.5;  // contraction at which a kept tangent is renewed
constexpr double floor_units = 8.0;       // increments.cpp
constexpr double weak_round_off = 1e-6,
                 no_digits = 1e-2;  // round-off of velocities and multipliers, of themselves

bool acts_from_outside(const Scene& scene) {
  if (scene.gravity || !scene.loads.empty() || !scene.distributed_loads.empty() ||
      !scene.motions.empty() || !scene.drags.empty() || scene.base_motion)
    return true;
  const auto is_grounded = [](const auto& j) {
    return j.a.kind == Place::Kind::ground || j.b.kind == Place::Kind::ground;
  };
  return std::any_of(scene.joints.begin(), scene.joints.end(), is_grounded) ||
         std::any_of(scene.springs.begin(), scene.springs.end(), is_grounded) ||
         std::any_of(scene.bushings.begin(), scene.bushings.end(), is_grounded);
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  return verdict == Verdict::pass ? "pass" : verdict == Verdict::warn ? "warn" : "fail";
}

Check bounded_check(Check check) {
  check.verdict = check.value <= check.warn   ? Verdict::pass
                  : check.value <= check.fail ? Verdict::warn
                                              : Verdict::fail;  // NaN among them
  return check;
}

Verdict Certificate::verdict() const {
  Verdict worst = Verdict::pass;
  for (const Check& check : checks) worst = std::max(worst, check.verdict);
  return worst;
}

const Check* Certificate::culprit() const {
  const Verdict worst = verdict();
  if (worst == Verdict::pass) return nullptr;
  return &*std::find_if(checks.begin(), checks.end(),
                        [&](const Check& check) { return check.verdict == worst; });
}

Audit::Audit(const Scene& scene, const System& system, bool certify)
    : scene_(scene), system_(system), certify_(certify), free_(!acts_from_outside(scene)) {}

Audit::~Audit() = default;

void Audit::step(const StepReport& report, const State& state) {
  ++steps_;
  contraction_.look(report.contraction, state.t);
  floor_.look(report.floor, state.t);
  slow_steps_ += report.contraction > slow_contraction ? 1 : 0;
  long_steps_ += 4 * report.iterations >= 3 * NewtonOptions().max_iterations ? 1 : 0;
  last_time_ = state.t;
}

// What loads and joints do to the nodes, about the origin: the rate of momentum, since what acts between nodes cancels
// in the sum; and the sum of the sizes, of forces and of moments.
Vec6 Audit::wrench(const State& state, double& forces, double& moments) const {
  scratch_ = state;
  system_.residual(scratch_, r_);
  scratch_.load_factor = 0.0;
  scratch_.lambda.setZero();
  system_.residual(scratch_, unloaded_);
  Vec6 sum = Vec6::Zero();
  for (Index n = 1; n < system_.nodes(); ++n) {
    const Vec6 one =
        inertial_wrench<double>(state.pose[static_cast<std::size_t>(n)],
                                Vec6(unloaded_.segment<6>(6 * n) - r_.segment<6>(6 * n)));
    sum += one;
    forces += one.head<3>().norm();
    moments += one.tail<3>().norm();
  }
  return sum;
}

void Audit::piece(const DenseStep& step) {
  if (piece_.pose.empty()) piece_ = system_.reference_state();
  double forces = 0.0, moments = 0.0;
  step.at(step.begin(), piece_);
  Vec6 sum = wrench(piece_, forces, moments);
  step.at(step.end(), piece_);
  sum += wrench(piece_, forces, moments);
  const double half = 0.5 * (step.end() - step.begin());
  impulse_ += half * sum;
  linear_impulse_ += half * forces;
  angular_impulse_ += half * moments;
}

void Audit::sample(const State& state) {
  const double t = state.t;
  last_ = state;
  for (const Pose<double>& H : state.pose)
    farthest_ = std::max(farthest_, H.r.cwiseAbs().maxCoeff());
  for (const ConstraintInfo& c : system_.constraints())
    for (Index i = 0; i < c.rows; ++i)
      largest_force_ =
          std::max(largest_force_,
                   std::abs(state.lambda(c.first_row + i)) /
                       (c.is_position[static_cast<std::size_t>(i)] ? 1.0 : system_.length_scale()));
  if (!state.V.empty()) {
    system_.constraints(state, g_, gdot_);
    Index row = -1;
    const double g = largest_violation(system_, g_, &row);
    position_.look(g, t, row);
    fastest_ = std::max(fastest_, fastest(system_, state));
    const double rate = largest_violation(system_, gdot_, &row);
    velocity_.look(rate, t, row);

    const Energies energies = system_.energies(state);
    const double now = energies.total() - state.work.total();
    if (samples_ == 0) {
      energy_begin_ = now;
      least_ = most_ = energies.total();
    }
    energy_end_ = now;
    least_ = std::min(least_, energies.total());
    most_ = std::max(most_, energies.total());
    energy_moved_ =
        std::max({energy_moved_, energies.kinetic, most_ - least_, std::abs(state.work.loads),
                  std::abs(state.work.drives), std::abs(state.work.damping)});
    put_in_.look(now - energy_begin_, t);

    const Vec6 p = system_.momentum(state);
    if (samples_ == 0) momentum_begin_ = p;
    linear_ = std::max(linear_, p.head<3>().norm());
    angular_ = std::max(angular_, p.tail<3>().norm());
    const Vec6 drift = p - momentum_begin_ - impulse_;
    linear_drift_.look(drift.head<3>().norm(), t);
    angular_drift_.look(drift.tail<3>().norm(), t);

    if (certify_) {
      // B Vdot: gdot is affine in V.
      system_.constraint_rates(state, gdot_, rest_);
      scratch_ = state;
      scratch_.V = state.Vdot;
      VecX more, less, unused;
      system_.constraint_rates(scratch_, more, unused);
      for (Vec6& V : scratch_.V) V.setZero();
      system_.constraint_rates(scratch_, less, unused);
      const double a = largest_violation(system_, more - less + rest_, &row);
      acceleration_.look(a, t, row);
      scratch_.V = state.Vdot;
      quickest_ = std::max(quickest_, fastest(system_, scratch_));
    }
  }
  ++samples_;
}

std::string Audit::where(const Worst& worst) const {
  std::string text = worst.row >= 0 ? system_.name_of(6 * system_.nodes() + worst.row) : "";
  if (scene_.transient) text += fmt::format("{}at {:.9g} s", text.empty() ? "" : ", ", worst.time);
  return text;
}

// Of M + h/2 C + h^2/4 K, or of K, with constraints; forces over the largest entry k, moments over k L, motions and
// multipliers to match: a number without units.
double Audit::reciprocal_condition(double h) const {
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  solver->analyze(system_.graph());
  TangentWeights weights;
  if (h > 0.0) {
    weights.U = 0.25 * h * h;
    weights.V = 0.5 * h;
    weights.A = 1.0;
  }
  system_.linearize(last_, weights, r_, *solver);
  const double k =
      std::max(largest_stiffness(system_, *solver), std::numeric_limits<double>::min());
  const double L = system_.length_scale(), root = std::sqrt(k);
  const BlockGraph& graph = system_.graph();
  std::vector<double> scale(static_cast<std::size_t>(system_.unknowns()), 0.0);
  std::vector<Index> first;
  Index at = 0;
  for (std::size_t b = 0, c = 0; b < graph.blocks.size(); ++b) {
    first.push_back(at);
    const bool is_node = graph.blocks[b].kind == BlockGraph::Kind::node;
    for (Index i = 0; i < graph.blocks[b].size; ++i)
      scale[static_cast<std::size_t>(at + i)] =
          is_node ? (i < 3 ? 1.0 : 1.0 / L) / root
                  : root * (system_.constraints()[c].is_position[static_cast<std::size_t>(i)] ? 1.0
                                                                                              : L);
    c += is_node ? 0 : 1;
    at += graph.blocks[b].size;
  }
  std::set<const double*> done;  // contributions share places
  const std::span<const Slot> slots = solver->slots();
  for (std::size_t i = 0; i < graph.contributions.size(); ++i) {
    const auto [row, column] = graph.contributions[i];
    if (row < 0 || column < 0) continue;
    const auto R = static_cast<std::size_t>(row), C = static_cast<std::size_t>(column);
    for (Index n = 0; n < graph.blocks[C].size; ++n)
      for (Index m = 0; m < graph.blocks[R].size; ++m) {
        double* const entry = slots[i].data + n * slots[i].ld + m;
        if (done.insert(entry).second)
          *entry *= scale[static_cast<std::size_t>(first[R] + m)] *
                    scale[static_cast<std::size_t>(first[C] + n)];
      }
  }
  return solver->factor() == FactorStatus::ok ? solver->reciprocal_condition() : 0.0;
}

void Audit::add_motion(Certificate& all, const RunReport& report) const {
  const auto add = [&](Check check) { all.checks.push_back(bounded_check(std::move(check))); };
  const TransientScene& transient = *scene_.transient;
  const double moved = energy_moved_, taken = energy_begin_ - energy_end_;
  if (moved > 0.0) {
    add({.name = "energy balance",
         .value = std::abs(taken) / moved,
         .warn = small_method_error,
         .fail = taken >= 0.0 ? half_damped : much_method_error,
         .why =
             fmt::format("energy the integrator has {}, the error of the works included, over the "
                         "energy that moved: an error of the method{}",
                         taken >= 0.0 ? "taken out" : "put in",
                         taken >= 0.0 ? "; what rings faster than the step resolves is meant to "
                                        "be damped, up to half of it"
                                      : "")});
    add({.name = "spurious energy",
         .value = put_in_.value / moved,
         .warn = small_method_error,
         .fail = much_method_error,
         .where = where(put_in_),
         .why =
             "largest energy that has come from nowhere, over the energy that moved: an error of "
             "the method"});
  }
  const NewtonOptions newton = newton_options(transient);
  // Ida stabilises constraints to its tolerance; the others solve for them, or project.
  const double tolerance = transient.method == TimeMethod::ida ? transient.tolerance.value_or(0.0)
                           : transient.tolerance ? std::max(1e-9, 0.01 * *transient.tolerance)
                                                 : newton.tolerance;
  const double rounding =
      floor_units * unit_round_off * std::max(1.0, farthest_ / system_.length_scale());
  if (!system_.constraints().empty()) {
    add({.name = "constraints, position",
         .value = position_.value,
         .warn = near_tolerance * std::max(tolerance, rounding),
         .fail = beyond_tolerance * std::max(tolerance, rounding),
         .where = where(position_),
         .why = "largest gap over the scene's length, or sine of an angle; bounds: 10 and 1000 "
                "tolerances of Newton's iterations"});
    if (fastest_ > 0.0)
      add({.name = "constraints, velocity",
           .value = velocity_.value / fastest_,
           .warn = small_method_error,
           .fail = much_method_error,
           .where = where(velocity_),
           .why = "their largest rate over the fastest motion: an error of the method"});
    const double pace = std::max(quickest_, fastest_ * fastest_);
    if (certify_ && pace > 0.0)
      add({.name = "constraints, acceleration",
           .value = acceleration_.value / pace,
           .warn = much_method_error,
           .fail = 1.0,
           .where = where(acceleration_),
           .why =
               "their largest second rate over the largest acceleration: an error of the method, "
               "one order larger than that of velocities"});
  }
  if (certify_ || free_) {
    const auto drift = [&](const char* name, const Worst& worst, double size, double impulse) {
      const double scale = std::max(size, impulse);
      if (scale > 0.0)
        add({.name = name,
             .value = worst.value / scale,
             .warn = small_method_error,
             .fail = much_method_error,
             .where = where(worst),
             .why = free_
                        ? "largest change over the largest momentum: nothing acts from outside"
                        : "largest change less the impulse of loads and joints, over the larger "
                          "of momentum and impulse: an error of the method and of the quadrature"});
    };
    drift("linear momentum", linear_drift_, linear_, linear_impulse_);
    // Without the gyroscopic moment it is not kept, and its drift says nothing of the method.
    if (transient.inertia == InertiaTerms::full)
      drift("angular momentum", angular_drift_, angular_, angular_impulse_);
  }
  if (steps_ > 0) {
    add({.name = "Newton, contraction",
         .value = contraction_.value,
         .warn = 0.95,
         .fail = std::numeric_limits<double>::max(),
         .where = where(contraction_),
         .why =
             fmt::format("largest ratio of successive increments in a step that converged (0: none "
                         "was measured); above {} in {} of {} steps",
                         slow_contraction, slow_steps_, steps_)});
    add({.name = "Newton, long steps",
         .value = static_cast<double>(long_steps_) / static_cast<double>(steps_),
         .warn = small_method_error,
         .fail = 1.0,
         .why =
             fmt::format("share of steps with three quarters of the {} iterations that one try is "
                         "allowed, or more",
                         NewtonOptions().max_iterations)});
    const Counters& c = report.transient_counters;
    add({.name = "failed steps",
         .value = static_cast<double>(c.retries) / static_cast<double>(steps_),
         .warn = small_method_error,
         .fail = 1.0,
         .why = "tries that did not converge, over the number of steps"});
    if (const LawFacts& laws = report.laws; laws.laws > 0)
      add({.name = "laws of time",
           .value = laws.unresolved.empty() ? laws.reach : std::max(2.0, laws.reach),
           .warn = 1.0,
           .fail = std::numeric_limits<double>::max(),
           .where = laws.unresolved.empty() ? laws.reach > 1.0 ? laws.which : std::string()
                                            : laws.unresolved.front(),
           .why = fmt::format(
               "what a step passes over, at most, of what a step may pass over: above 1 a feature "
               "of a law of time can lie between two steps unseen; 2 or more where a law could "
               "not be resolved{}",
               laws.longest_step > 0.0 ? fmt::format("; steps of {:.3g} s resolve all, which is "
                                                     "needed near t = {:.6g} s",
                                                     laws.longest_step, laws.at)
                                       : std::string())});
    if (c.tolerant > 0)
      add({.name = "rank-tolerant steps",
           .value = static_cast<double>(c.tolerant),
           .warn = 0.0,
           .fail = std::numeric_limits<double>::max(),
           .why =
               "steps near a singular configuration: the motion is determined there, multipliers "
               "are not"});
  }
}

// Round-off of positions, and what is left of rates and multipliers where it is divided by steps.
void Audit::add_round_off(Certificate& all) const {
  const auto add = [&](Check check) { all.checks.push_back(bounded_check(std::move(check))); };
  const double L = system_.length_scale();
  const double unit = floor_units * unit_round_off * std::max(farthest_, L);
  add({.name = "round-off, position",
       .value = unit / L,
       .warn = 1e-9,
       .fail = 1e-6,
       .why =
           fmt::format("{:g} units of round-off of the farthest position, over the scene's length; "
                       "{:.2g} of Newton's tolerance",
                       floor_units, floor_.value)});
  if (!certify_ || last_.pose.empty()) return;
  double h = 0.0;
  if (scene_.transient && steps_ > 0) h = last_time_ / static_cast<double>(steps_);
  if (h > 0.0 && fastest_ > 0.0)
    add({.name = "round-off, velocity",
         .value = unit / (L * h) / fastest_,
         .warn = weak_round_off,
         .fail = no_digits,
         .why = "that of positions over the mean step and the fastest motion"});
  if (h > 0.0 && largest_force_ > 0.0) {
    const std::unique_ptr<LinearSolver> solver = make_klu_solver();
    solver->analyze(system_.graph());
    system_.linearize(last_, {.U = 0.0, .V = 0.0, .A = 1.0, .T_inv = {}}, r_, *solver);
    const double mass = largest_stiffness(system_, *solver);
    add({.name = "round-off, multipliers",
         .value = mass * unit / (h * h) / largest_force_,
         .warn = weak_round_off,
         .fail = std::numeric_limits<double>::max(),
         .why = "that of positions over the mean step squared, times the largest mass of a node, "
                "over the largest multiplier"});
  }
  const double condition = reciprocal_condition(h);
  add({.name = "condition",
       .value = condition > 0.0 ? unit_round_off / condition : 1.0,
       .warn = 1e-6,
       .fail = 1e-1,
       .why = fmt::format(
           "round-off times the estimated condition of the iteration matrix at the end "
           "({:.1e}), scaled to have no units: digits that one solution loses",
           condition > 0.0 ? 1.0 / condition : std::numeric_limits<double>::infinity())});
}

// Forces that are left at the last equilibrium.
void Audit::add_equilibrium(Certificate& all, const RunReport& report) const {
  if (last_.pose.empty() || !last_.V.empty()) return;
  const double L = system_.length_scale();
  const auto largest = [&](const VecX& f, Index* worst) {
    double size = 0.0;
    for (Index i = 6; i < 6 * system_.nodes(); ++i) {
      const double one = std::abs(f(i)) / (i % 6 < 3 ? 1.0 : L);
      if (one > size || one != one) {
        size = one;
        if (worst != nullptr) *worst = i;
      }
    }
    return size;
  };
  system_.residual(last_, r_);
  VecX load;
  system_.load_rate(last_, load);
  Index row = -1;
  if (system_.multipliers() > 0) {
    const double g = largest_violation(system_, r_.tail(system_.multipliers()), &row);
    const double rounding = floor_units * unit_round_off * std::max(farthest_, L) / L;
    all.checks.push_back(bounded_check(
        {.name = "constraints, position",
         .value = g,
         .warn = near_tolerance * std::max(1e-12, rounding),
         .fail = beyond_tolerance * std::max(1e-12, rounding),
         .where = row >= 0 ? system_.name_of(6 * system_.nodes() + row) : std::string(),
         .why =
             "largest gap over the scene's length, or sine of an angle, at the last equilibrium; "
             "bounds: 10 and 1000 times 1e-12, or round-off of positions"}));
    row = -1;
  }
  const double left = largest(r_, &row);
  const double scale = std::max(largest(load, nullptr), largest_force_);
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  solver->analyze(system_.graph());
  system_.linearize(last_, {}, unloaded_, *solver);
  // What positions that are known to round-off leave of forces.
  const double rounding =
      floor_units * unit_round_off * std::max(farthest_, L) * largest_stiffness(system_, *solver);
  if (scale > 0.0)
    all.checks.push_back(bounded_check(
        {.name = "balance of forces",
         .value = left / scale,
         .warn = near_tolerance * std::max(1e-9, rounding / scale),
         .fail = beyond_tolerance * std::max(1e-9, rounding / scale),
         .where = row >= 0 ? system_.name_of(row) : std::string(),
         .why =
             "largest force, or moment over the scene's length, that is left over at a node, of "
             "the "
             "largest load or reaction; bounds: 10 and 1000 times round-off of positions times the "
             "largest stiffness, or 1e-9"}));
  if (report.negative_eigenvalues.value_or(0) > 0)
    all.checks.push_back(
        {.name = "stability",
         .value = static_cast<double>(*report.negative_eigenvalues),
         .why = "negative eigenvalues of the tangent: the equilibrium would not stay",
         .verdict = Verdict::warn});
}

Certificate Audit::certificate(const RunReport& report) const {
  Certificate all;
  all.certified = certify_;
  if (!report.complete())
    all.checks.push_back({.name = "run",
                          .where = report.failure,
                          .why = "it did not come to its end",
                          .verdict = Verdict::fail});
  if (samples_ == 0) return all;
  if (scene_.transient)
    add_motion(all, report);
  else
    add_equilibrium(all, report);
  add_round_off(all);
  return all;
}

}  // namespace mbd
