#include "libmbd/results/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "elements/beam/beam_elastic_batch.hpp"
#include "elements/component/component_batch.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/scene/transient.hpp"
#include "solvers/linear/block_columns.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/statics/strain_round_off.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {
namespace {

constexpr double unit_round_off = std::numeric_limits<double>::epsilon();
constexpr double small_method_error = 0.01, much_method_error = 0.1;  // errors of a method
constexpr double by_chance =
    10.0;  // where an error in time is as large as chance has it (time_error.hpp)
constexpr double unbent = 1e-10;  // strains that are round-off, of scenes near the origin
constexpr int mesh_samples_at_a_stride = 64;
constexpr double half_damped = 0.5;  // energy that damps away: it may be meant to, up to there
constexpr double near_tolerance = 10.0, beyond_tolerance = 1000.0;  // of a tolerance
constexpr double slow_contraction = 0.5;  // contraction at which a kept tangent is renewed
constexpr double floor_units = 8.0;       // increments.cpp
constexpr double weak_round_off = 1e-6,
                 no_digits = 1e-2;  // round-off of velocities and multipliers, of themselves
constexpr double lost_momentum = 0.05;
constexpr double smooth = 0.75;  // second differences beside the first ones, at most
constexpr double energy_units =
    1e3;  // of round-off of energies: what is less than that has not two digits
constexpr double no_motion =
    1e-12;  // lengths of the scene, or rad, in the whole run: rates are round-off
// Accounts of momenta: when they start afresh, in momenta; shares of what else sets their scale.
constexpr double account_of = 20.0, share_of_passed = 0.01, share_of_linear = 1e-3,
                 share_of_reactions = 1e-5;

// Beside forces of that size, at an equilibrium; of forces that are unknowns beside stiff strains.
void add_round_off_of_forces(const System& system, const State& state, double size,
                             Certificate& all) {
  const std::optional<double> force = round_off_of_forces(system, state);
  if (!force) return;
  all.add({.name = "round-off, sectional forces",
           .value = *force / size,
           .warn = weak_round_off,
           .fail = std::numeric_limits<double>::max(),  // others may be right
           .why = "what round-off of positions makes of forces that only stretches and shears "
                  "determine, much stiffer than bending, of the largest load or reaction"});
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  return verdict == Verdict::pass ? "pass" : verdict == Verdict::warn ? "warn" : "fail";
}

std::string Check::value_in_words() const {
  if (!has_value()) return why.starts_with("not ") ? why : "not known: " + why;
  return unit.empty() ? fmt::format("{:.2g}", value) : fmt::format("{:.2g} {}", value, unit);
}

Check bounded_check(Check check) {
  check.verdict = check.value <= check.warn   ? Verdict::pass
                  : check.value <= check.fail ? Verdict::warn
                                              : Verdict::fail;  // NaN among them
  return check;
}

void Certificate::add(Check check) { checks.push_back(bounded_check(std::move(check))); }

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

namespace {

// A run that was stopped, or that says nothing, has no bound.
bool was_compared(const Certificate& certificate, std::string_view name) {
  return std::ranges::any_of(certificate.checks, [name](const Check& check) {
    return check.name == name && check.fail > 0.0;
  });
}

}  // namespace

std::vector<std::string> Certificate::covers() const {
  std::vector<std::string> result;
  const auto has = [this](std::string_view name) {
    return std::any_of(checks.begin(), checks.end(),
                       [name](const Check& check) { return check.name.starts_with(name); });
  };
  const bool moves = has("Newton");
  if (moves || has("balance of forces"))
    result.push_back("that the equations of the model were solved");
  if (has("energy") || has("linear momentum")) result.push_back("balances of energy and momenta");
  if (was_compared(*this, "error in time"))
    result.push_back("the motion's error from steps in time");
  if (was_compared(*this, mesh_run))
    result.push_back("the mesh of beams");
  else if (has("mesh"))
    result.push_back(moves ? "the mesh of beams as they bend, not their inertia"
                           : "the mesh of beams");
  if (has("invariance")) result.push_back("invariance");
  return result;
}

std::vector<std::string> Certificate::not_covered() const {
  std::vector<std::string> result;
  const auto has = [this](std::string_view name) {
    return std::ranges::any_of(checks, [name](const Check& check) { return check.name == name; });
  };
  const bool higher = was_compared(*this, mesh_run), has_mesh = has("mesh") || higher;
  const bool moves = std::any_of(checks.begin(), checks.end(), [](const Check& check) {
    return check.name.starts_with("Newton") || check.name == "error in time";
  });
  if (moves && !was_compared(*this, "error in time"))
    result.push_back("the error from steps in time");
  if (moves) result.push_back("errors of reactions and accelerations");
  if (!has_mesh) result.push_back("the mesh");
  if (moves && has("mesh") && !higher)
    result.push_back("what the mesh does to inertia (--certify)");
  if (has("component modes"))
    result.push_back("sectional forces and stresses within a <reduction> (mbd effects)");
  result.push_back("the model itself");
  return result;
}

Check check_of(const TimeError& error) {
  Check check{.name = "error in time"};
  if (!error.known) {
    check.verdict = Verdict::warn;
    check.why = "not known: " + error.why_not;
    return check;
  }
  check.value = error.relative;
  check.warn = error.kinks > 0 ? small_method_error / by_chance : small_method_error;
  check.fail = much_method_error;
  check.where = fmt::format("{}, at {:.9g} s", error.node, error.time);
  check.why = fmt::format(
      "estimate of what steps in time make of positions ({:.2g} m there) and rotations ({:.2g} "
      "rad), "
      "over the largest motion, from a second run in {}; compared up to {:.9g} s",
      error.displacement, error.rotation, error.how, error.until);
  if (error.kinks > 0)
    check.why += fmt::format(
        "; fixed steps pass {} kinks of laws of the motion, where errors go with no power of "
        "the step and may be ten times as large: a tolerance in place of a step "
        "ends steps there",
        error.kinks);
  check = bounded_check(check);
  if (check.verdict != Verdict::pass || error.recorded <= much_method_error) return check;
  check.value = error.recorded;
  check.warn = much_method_error;
  check.fail = std::numeric_limits<double>::infinity();
  check.where = fmt::format("{}, at {:.9g} s", error.record, error.recorded_time);
  check.why = fmt::format(
      "estimate of what steps in time make of what is recorded, over its own largest change "
      "(over the largest motion of the scene {:.2g}), from a second run in {}; compared up to "
      "{:.9g} s",
      error.relative, error.how, error.until);
  return bounded_check(check);
}

Audit::Audit(const Scene& scene, const System& system, bool certify)
    : scene_(scene), system_(system), certify_(certify), parts_(find_parts(system)) {
  nodes_of_.assign(static_cast<std::size_t>(parts_.count()), 0);
  for (const int part : parts_.of_node)
    if (part >= 0) ++nodes_of_[static_cast<std::size_t>(part)];
  kept_.resize(nodes_of_.size());
  outside_at_ = std::numeric_limits<double>::quiet_NaN();
  holds_.assign(system.constraints().size(), -1);
  const auto nodes = static_cast<int>(system.nodes()) - 1;
  std::vector<char> to_ground(holds_.size(), 0);
  for (const auto& [row, column] : system.graph().contributions) {
    if (row < nodes) continue;
    const auto c = static_cast<std::size_t>(row - nodes);
    if (column < 0)
      to_ground[c] = 1;
    else if (column < nodes)
      holds_[c] = parts_.of_node[static_cast<std::size_t>(column + 1)];
  }
  for (std::size_t c = 0; c < holds_.size(); ++c)
    if (to_ground[c] == 0) holds_[c] = -1;
  const auto first = system.first_contributions();
  const auto& contributions = system.graph().contributions;
  for (std::size_t b = 0; b < system.batches().size(); ++b) {
    const Batch* const batch = system.batches()[b].get();
    if (const auto* const beams = dynamic_cast<const BeamElasticBatch*>(batch))
      flexible_.push_back({beams, std::make_unique<beam::MeshErrorRule>(beams->table())});
    if (const auto* const components = dynamic_cast<const ComponentBatch*>(batch))
      components_ = components;
    if (batch->type().starts_with("inertia")) continue;
    if (!certify && batch->type().starts_with("beam")) continue;
    const bool on_one =
        std::all_of(contributions.begin() + static_cast<std::ptrdiff_t>(first[b]),
                    contributions.begin() + static_cast<std::ptrdiff_t>(first[b + 1]),
                    [](const BlockGraph::Contribution& c) { return c.row == c.column; });
    (on_one ? on_nodes_ : between_).push_back(batch);
  }
}

Audit::~Audit() = default;

void Audit::step(const StepReport& report, const State& state) {
  ++steps_;
  contraction_.look(report.contraction, state.t);
  floor_.look(report.floor, state.t);
  slow_steps_ += report.contraction > slow_contraction ? 1 : 0;
  long_steps_ += 4 * report.iterations >= 3 * NewtonOptions().max_iterations ? 1 : 0;
  last_time_ = state.t;
}

// x of (1), and its velocity.
Vec3 Audit::point_of(int part, const State& state, Vec3* velocity) const {
  if (velocity != nullptr) velocity->setZero();
  if (parts_.is_held[static_cast<std::size_t>(part)] != 0)
    return kept_[static_cast<std::size_t>(part)].point;
  Vec3 x = Vec3::Zero();
  const double share = 1.0 / nodes_of_[static_cast<std::size_t>(part)];
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    if (parts_.of_node[n] != part) continue;
    x += share * state.pose[n].r;
    if (velocity != nullptr) *velocity += share * (state.pose[n].R() * state.V[n].head<3>());
  }
  return x;
}

void Audit::outside(const State& given, std::vector<Outside>& all) const {
  const State& state = system_.fed_back(given);
  all.assign(kept_.size(), {});
  on_nodes_r_.setZero(system_.rows());
  for (const Batch* const batch : on_nodes_) batch->residual(state, on_nodes_r_);
  r_.setZero(system_.rows());
  for (const Batch* const batch : between_) batch->residual(state, r_);
  const bool any_free = parts_.any_free();
  if (any_free) {
    p_.resize(state.pose.size());
    system_.momenta(state, p_);
  }
  std::vector<Vec3> x(kept_.size()), velocity(kept_.size());
  for (std::size_t k = 0; k < kept_.size(); ++k)
    x[k] = point_of(static_cast<int>(k), state, &velocity[k]);
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    const auto k = static_cast<std::size_t>(parts_.of_node[n]);
    const auto row = 6 * static_cast<Index>(n);
    const auto about_x = [&](const Vec6& in_body) {
      Vec6 w = inertial_wrench<double>(state.pose[n], in_body);
      w.tail<3>() -= x[k].cross(w.head<3>());
      return w;
    };
    const Vec6 on_node = about_x(-on_nodes_r_.segment<6>(row));
    all[k].forces += on_node.head<3>().norm();
    all[k].moments += on_node.tail<3>().norm();
    all[k].rate += on_node + about_x(-r_.segment<6>(row));
    if (any_free && parts_.is_held[k] == 0)
      all[k].rate.tail<3>() -=
          velocity[k].cross(inertial_wrench<double>(state.pose[n], p_[n]).head<3>());
  }
  for (std::size_t c = 0; c < holds_.size(); ++c) {
    if (holds_[c] < 0) continue;
    const ConstraintInfo& info = system_.constraints()[c];
    double force = 0.0, moment = 0.0;
    for (Index i = 0; i < info.rows; ++i) {
      double& of = info.is_position[static_cast<std::size_t>(i)] ? force : moment;
      of = std::hypot(of, state.lambda(info.first_row + i));
    }
    Outside& one = all[static_cast<std::size_t>(holds_[c])];
    one.forces += force;
    one.moments += moment + force * system_.length_scale();
  }
  for (Outside& one : all) {  // springs among them; forces between nodes have cancelled
    one.forces = std::max(one.forces, one.rate.head<3>().norm());
    one.moments = std::max(one.moments, one.rate.tail<3>().norm());
  }
}

// Where nothing jumped - laws, inputs, what sampled controllers give, accelerations made consistent - the end of the piece before
// is the beginning of this one.
bool Audit::goes_on(const DenseStep& step) const {
  const double begin = step.begin();
  if (!(std::abs(outside_at_ - begin) <= 1e-12 * std::abs(begin))) return false;
  for (const Breakpoint& b : system_.breakpoints())
    if (std::abs(b.t - begin) <= 1e-9 * (step.end() - begin)) return false;
  const State* const first = step.first();
  if (first == nullptr) return system_.inputs().empty();
  const auto alike = [begin](const InputValue& a, const InputValue& b) {
    return a.at(begin).v == b.at(begin).v;
  };
  return first->lambda == ended_.lambda && first->Vdot == ended_.Vdot &&
         std::ranges::equal(first->inputs, ended_.inputs, alike);
}

void Audit::add_impulse(const std::vector<Outside>& all, double weight) {
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    kept_[k].linear.impulse += weight * all[k].rate.head<3>();
    kept_[k].angular.impulse += weight * all[k].rate.tail<3>();
    kept_[k].linear.passed += weight * all[k].forces;
    kept_[k].angular.passed += weight * all[k].moments;
  }
}

void Audit::piece(const DenseStep& step) {
  if (samples_ == 0) return;
  const double begin = step.begin(), end = step.end(), h = end - begin;
  if (const DenseStep::Balance balance = step.balance(); balance.size > 0) {
    for (std::size_t j = 0; j < balance.size; ++j) {
      outside(*balance.states[j], outside_end_);
      add_impulse(outside_end_, h * balance.weights[j]);
    }
  } else {
    impulse_of_ends(step);
  }
  for (const Outside& one : outside_end_) largest_outside_ = std::max(largest_outside_, one.forces);
}

// The trapezium, or of IDA Simpson's rule. Where forces are smooth from piece to piece, what a trapezium leaves out, h^3/12 of the
// second rate, is taken from the last three values: that of a reaction that turns by 1 rad in a step is 8 % of it.
void Audit::impulse_of_ends(const DenseStep& step) {
  if (piece_.pose.empty()) piece_ = system_.reference_state();
  const auto at = [&](double t, const State* known, std::vector<Outside>& all) {
    if (known == nullptr) step.at(t, piece_);
    outside(known != nullptr ? *known : piece_, all);
  };
  const double begin = step.begin(), end = step.end(), h = end - begin;
  const bool goes = goes_on(step);
  std::swap(outside_before_, outside_begin_);
  if (goes)
    std::swap(outside_begin_, outside_end_);
  else
    at(begin, step.first(), outside_begin_);
  at(end, step.last(), outside_end_);
  outside_at_ = end;
  if (const State* const last = step.last()) {
    ended_.Vdot = last->Vdot;
    ended_.lambda = last->lambda;
    ended_.inputs = last->inputs;
  }
  if (scene_.transient->method == TimeMethod::ida) {
    at(0.5 * (begin + end), nullptr, outside_middle_);
    add_impulse(outside_begin_, h / 6.0);
    add_impulse(outside_middle_, 4.0 * h / 6.0);
    add_impulse(outside_end_, h / 6.0);
    return;
  }
  add_impulse(outside_begin_, 0.5 * h);
  add_impulse(outside_end_, 0.5 * h);
  correct_impulse(goes, h);
}

// A second rate is that in the middle of three values; of a piece the mean of both its ends, as soon as the next is known.
void Audit::correct_impulse(bool goes, double h) {
  const bool known = goes && length_before_ > 0.0 && outside_before_.size() == kept_.size();
  const double ratio = known ? h / length_before_ : 1.0;
  for (std::size_t k = 0; k < kept_.size(); ++k)
    for (const Index first : {0, 3}) {
      Account& account = first == 0 ? kept_[k].linear : kept_[k].angular;
      const Vec3 second_before = account.second;  // h^3/12 of the second rate, in the piece before
      const bool has_before = account.has_second;
      account.has_second = false;
      account.second.setZero();
      const auto part = [&](const std::vector<Outside>& all) -> Vec3 {
        return all[k].rate.segment<3>(first);
      };
      const Vec3 change = part(outside_end_) - part(outside_begin_);
      account.unsure = h / 12.0 * change.norm();
      if (!known) continue;
      const Vec3 before = ratio * (part(outside_begin_) - part(outside_before_));
      if ((change - before).norm() > smooth * (change.norm() + before.norm())) continue;
      account.has_second = true;
      account.second = h / (6.0 * (1.0 + 1.0 / ratio)) * (change - before);
      account.unsure = 0.5 * account.second.norm();
      const Vec3 now_before = account.second / (ratio * ratio * ratio);
      account.bend += account.second;
      account.bend += has_before ? Vec3(0.5 * (now_before - second_before)) : now_before;
    }
  length_before_ = h;
}

void Audit::sample_momenta(const State& state) {
  p_.resize(state.pose.size());
  system_.momenta(state, p_);
  if (samples_ == 0)
    for (std::size_t n = 1; n < state.pose.size(); ++n) {
      const auto k = static_cast<std::size_t>(parts_.of_node[n]);
      kept_[k].point += state.pose[n].r / nodes_of_[k];
    }
  std::vector<Vec6> sum(kept_.size(), Vec6::Zero());
  std::vector<std::array<double, 2>> size(kept_.size(), {0.0, 0.0});
  std::vector<Vec3> x(kept_.size());
  for (std::size_t k = 0; k < kept_.size(); ++k) x[k] = point_of(static_cast<int>(k), state);
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    const auto k = static_cast<std::size_t>(parts_.of_node[n]);
    Vec6 p = inertial_wrench<double>(state.pose[n], p_[n]);
    p.tail<3>() -= x[k].cross(p.head<3>());
    sum[k] += p;
    size[k][0] += p.head<3>().norm();
    size[k][1] += p.tail<3>().norm();
  }
  const auto look = [&](Account& account, const Vec3& now, double size_now) {
    if (samples_ == 0) account.begin = now;
    account.size = std::max(account.size, size_now);
    account.most_passed = std::max(account.most_passed, account.passed);
    // Of steps that are too long for either, it is not told which of both quadratures errs.
    const Vec3 gap = now - account.begin - account.impulse;
    const double off = gap.norm(), corrected = (gap + account.bend).norm() - account.unsure;
    account.drift.look(off != off ? off : std::clamp(corrected, 0.0, off), state.t);
    if (!(account.passed > account_of * account.size)) return;
    account.begin = now;
    account.impulse.setZero();
    account.bend.setZero();
    account.passed = 0.0;
  };
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    look(kept_[k].linear, sum[k].head<3>(), size[k][0]);
    look(kept_[k].angular, sum[k].tail<3>(), size[k][1]);
  }
}

void Audit::sample(const State& state) {
  const double t = state.t;
  last_ = state;
  const auto look_at = [](double& largest, double x) {  // keeps what is not a number
    if (x > largest || x != x) largest = x;
  };
  for (const Pose<double>& H : state.pose)
    for (Index i = 0; i < 3; ++i) look_at(farthest_, std::abs(H.r(i)));
  look_at(largest_force_, largest_force(system_, state.lambda));
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
    energy_size_ = std::max(energy_size_, std::abs(energies.kinetic) + std::abs(energies.strain) +
                                              std::abs(energies.potential));
    energy_moved_ =
        std::max({energy_moved_, energies.kinetic, most_ - least_, std::abs(state.work.loads),
                  std::abs(state.work.drives), std::abs(state.work.damping)});
    put_in_.look(now - energy_begin_, t);

    sample_momenta(state);

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
  if (samples_ % mesh_stride_ == 0) sample_mesh(state);
  if (components_ != nullptr) sample_components(state);
  ++samples_;
}

// At fewer and fewer samples, so that it costs no more than they do.
void Audit::sample_mesh(const State& state) {
  if (flexible_.empty()) return;
  if (++mesh_samples_ % mesh_samples_at_a_stride == 0) mesh_stride_ *= 2;
  beam::MeshError sum, worst;
  const std::string* name = nullptr;
  for (const Flexible& f : flexible_)
    for (Index e = 0; e < f.batch->size(); ++e) {
      const beam::MeshError one = f.batch->mesh_error(state, e, *f.rule);
      sum.error += one.error;
      sum.energy += one.energy;
      sum.unit += one.unit;
      if (one.error > worst.error) {
        worst = one;
        name = &f.batch->name_of(e);
      }
    }
  bent_ = std::max(bent_, sum.energy);
  unit_ = sum.unit;
  if (sum.error > missed_.value && name != nullptr) missed_most_by_ = *name;
  missed_.look(sum.error, state.t);
}

void Audit::add_mesh(Certificate& all) const {
  const double round_off = unbent * std::max(1.0, farthest_ / system_.length_scale());
  if (flexible_.empty() || !(bent_ > round_off * round_off * unit_)) return;
  all.add({.name = "mesh",
           .value = missed_.value / bent_,
           .warn = small_method_error,
           .fail = certify_ ? much_method_error : std::numeric_limits<double>::max(),
           .where = fmt::format("{}{}", missed_most_by_, where(missed_).empty() ? "" : ", ") +
                    where(missed_),
           .why =
               "energy of what the elements of beams leave out of the resultants, estimated, over "
               "the largest energy of these: about the relative error of deflections at rest, "
               "which says nothing of inertia; more or higher elements lessen it"});
}

void Audit::add_loads(Certificate& all) const {
  if (!loads_.any) return;
  all.add({.name = "distributed loads",
           .value = loads_.error,
           .warn = small_method_error,
           .fail = certify_ ? much_method_error : std::numeric_limits<double>::max(),
           .where = loads_.where,
           .why = "forces on nodes, at which distributed loads are taken, against their integrals "
                  "over the elements: about the relative error of what these loads do; more or "
                  "higher elements lessen it, and ends of elements where the load jumps"});
}

void Audit::sample_components(const State& state) {
  for (Index k = 0; k < components_->size(); ++k) {
    const ComponentBatch::Wrong wrong = components_->wrong_by(state, k);
    if (!(wrong.error > linear_.value)) continue;
    linear_.look(wrong.error, state.t);
    linear_in_ = components_->name_of(k);
    turned_ = wrong.turn;
    stiffened_ = wrong.share;
  }
}

void Audit::add_components(Certificate& all) const {
  if (components_ == nullptr) return;
  all.add(
      {.name = "component modes",
       .value = linear_.value,
       .warn = small_method_error,
       .fail = much_method_error,
       .where = linear_in_ + (where(linear_).empty() ? "" : ", ") + where(linear_),
       .why = fmt::format(
           "half the square of the largest turn within a <reduction> ({:.2g} rad), which linear "
           "modes leave out, or what they are wrong by where forces change its stiffness ({:+.2g} "
           "of it), relative to deflections; leave the reduction out, or divide it",
           turned_, stiffened_)});
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

// Energies and momenta of what rests are of round-off, and so is all that is put in relation to them. What is not a number moves.
bool Audit::moves() const { return !(fastest_ * last_.t <= no_motion); }

// The worst part of each.
void Audit::add_momenta(Certificate& all) const {
  const double L = system_.length_scale();
  const auto add = [&](const char* name, const char* of, bool angular) {
    std::optional<Check> worst;
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      const Account &linear = kept_[k].linear, &account = angular ? kept_[k].angular : linear;
      const double reactions = share_of_reactions * largest_force_ * last_time_;
      const double scale_p = std::max({linear.size, share_of_passed * linear.most_passed,
                                       parts_.is_held[k] != 0 ? reactions : 0.0});
      const double scale = angular ? std::max({account.size, share_of_passed * account.most_passed,
                                               share_of_linear * L * scale_p})
                                   : scale_p;
      const double value = account.drift.value / scale;
      if (scale == 0.0 && account.drift.value == 0.0) continue;  // at rest, with nothing to move it
      if (worst && !(value > worst->value) && value == value) continue;
      const std::string node = system_.node_name(static_cast<Index>(parts_.first[k]));
      worst = Check{
          .name = name,
          .value = value,
          .warn = small_method_error,
          .fail = lost_momentum,
          .where = fmt::format("{}{}", kept_.size() > 1 ? "of the part with " + node + ", " : "",
                               where(account.drift)),
          .why = fmt::format(
              "largest change of {}, less the impulse of all that acts from outside{}, over "
              "the sum of the sizes of the nodes' momenta: an error of the method and of the "
              "quadrature of the impulse",
              of, parts_.is_held[k] != 0 ? "" : " (nothing ties it to the ground)")};
    }
    if (worst) all.add(*worst);
  };
  add("linear momentum", "momentum", false);
  // Without the gyroscopic moment it is not kept, and its drift says nothing of the method.
  if (scene_.transient->inertia == InertiaTerms::full) add("angular momentum", "its moment", true);
}

void Audit::add_energy(Certificate& all) const {
  const double moved = energy_moved_, taken = energy_begin_ - energy_end_;
  if (!(moved > energy_units * unit_round_off * energy_size_)) return;
  all.add(
      {.name = "energy balance",
       .value = std::abs(taken) / moved,
       .warn = small_method_error,
       .fail = taken >= 0.0 ? half_damped : much_method_error,
       .why = fmt::format("energy the integrator has {}, the error of the works included, over the "
                          "energy that moved: an error of the method{}",
                          taken >= 0.0 ? "taken out" : "put in",
                          taken >= 0.0 ? "; what rings faster than the step resolves is meant to "
                                         "be damped, up to half of it"
                                       : "")});
  all.add({.name = "spurious energy",
           .value = put_in_.value / moved,
           .warn = small_method_error,
           .fail = much_method_error,
           .where = where(put_in_),
           .why =
               "largest energy that has come from nowhere, over the energy that moved: an error of "
               "the method"});
}

void Audit::add_constraints(Certificate& all) const {
  if (system_.constraints().empty()) return;
  const TransientScene& transient = *scene_.transient;
  const NewtonOptions newton = newton_options(transient);
  // Ida stabilises constraints to its tolerance; the others solve for them, or project.
  const double tolerance = transient.method == TimeMethod::ida ? transient.tolerance.value_or(0.0)
                           : transient.tolerance ? std::max(1e-9, 0.01 * *transient.tolerance)
                                                 : newton.tolerance;
  const double rounding =
      floor_units * unit_round_off * std::max(1.0, farthest_ / system_.length_scale());
  all.add({.name = "constraints, position",
           .value = position_.value,
           .warn = near_tolerance * std::max(tolerance, rounding),
           .fail = beyond_tolerance * std::max(tolerance, rounding),
           .where = where(position_),
           .why = "largest gap over the scene's length, or sine of an angle; bounds: 10 and 1000 "
                  "tolerances of Newton's iterations"});
  if (moves())
    all.add({.name = "constraints, velocity",
             .value = velocity_.value / fastest_,
             .warn = small_method_error,
             .fail = much_method_error,
             .where = where(velocity_),
             .why = "their largest rate over the fastest motion: an error of the method"});
  const double pace = std::max(quickest_, fastest_ * fastest_);
  if (certify_ && moves() && pace > 0.0)
    all.add({.name = "constraints, acceleration",
             .value = acceleration_.value / pace,
             .warn = much_method_error,
             .fail = 1.0,
             .where = where(acceleration_),
             .why =
                 "their largest second rate over the largest acceleration: an error of the method, "
                 "one order larger than that of velocities"});
}

void Audit::add_steps(Certificate& all, const RunReport& report) const {
  if (steps_ == 0) return;
  all.add({.name = "Newton, contraction",
           .value = contraction_.value,
           .warn = 0.95,
           .fail = std::numeric_limits<double>::max(),
           .where = where(contraction_),
           .why = fmt::format(
               "largest ratio of successive increments in a step that converged (0: none "
               "was measured); above {} in {} of {} steps",
               slow_contraction, slow_steps_, steps_)});
  all.add(
      {.name = "Newton, long steps",
       .value = static_cast<double>(long_steps_) / static_cast<double>(steps_),
       .warn = small_method_error,
       .fail = 1.0,
       .why = fmt::format("share of steps with three quarters of the {} iterations that one try is "
                          "allowed, or more",
                          NewtonOptions().max_iterations)});
  const Counters& c = report.transient_counters;
  all.add({.name = "failed steps",
           .value = static_cast<double>(c.retries) / static_cast<double>(steps_),
           .warn = small_method_error,
           .fail = std::numeric_limits<double>::max(),
           .why =
               "tries that did not converge, over the number of steps; their steps were taken in "
               "parts (of fixed steps also where something turns by more than half a turn in "
               "one)"});
  if (const LawFacts& laws = report.laws; laws.laws > 0)
    all.add(
        {.name = "laws of time",
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
  add_troubles(all, c);
}

// Of steps that went on where something could not be done as usual.
void Audit::add_troubles(Certificate& all, const Counters& c) {
  if (c.passed_kinks > 0)
    all.add({.name = "kinks passed over",
             .value = static_cast<double>(c.passed_kinks),
             .warn = 0.0,
             .fail = std::numeric_limits<double>::max(),
             .why = "steps between whose ends a stop, a rope or another law with a kink, or with a "
                    "peak, was met and left again, or in a few of which it was: neither the motion "
                    "nor an estimate of its error knows of it; take shorter steps"});
  if (c.tolerant > 0)
    all.add({.name = "rank-tolerant steps",
             .value = static_cast<double>(c.tolerant),
             .warn = 0.0,
             .fail = std::numeric_limits<double>::max(),
             .why = "steps in which constraints that were independent come close to repeating each "
                    "other, as near a singular configuration: the motion is determined there, "
                    "multipliers may not be"});
}

void Audit::add_motion(Certificate& all, const RunReport& report) const {
  if (moves()) add_energy(all);
  add_constraints(all);
  if (moves()) add_momenta(all);
  add_steps(all, report);
}

// Round-off of positions, and what is left of rates and multipliers where it is divided by steps.
void Audit::add_round_off(Certificate& all) const {
  const double L = system_.length_scale();
  // (max() would pass the other of a number and none)
  const double unit = floor_units * unit_round_off * (farthest_ < L ? L : farthest_);
  all.add({.name = "round-off, position",
           .value = unit / L,
           .warn = 1e-9,
           .fail = 1e-6,
           .why = fmt::format(
               "{:g} units of round-off of the farthest position, over the scene's length; "
               "{:.2g} of Newton's tolerance",
               floor_units, floor_.value)});
  if (!certify_ || last_.pose.empty()) return;
  double h = 0.0;
  if (scene_.transient && steps_ > 0) h = last_time_ / static_cast<double>(steps_);
  if (h > 0.0 && moves())
    all.add({.name = "round-off, velocity",
             .value = unit / (L * h) / fastest_,
             .warn = weak_round_off,
             .fail = no_digits,
             .why = "that of positions over the mean step and the fastest motion"});
  const double force = std::max(largest_force_, largest_outside_);
  if (h > 0.0 && largest_force_ > 0.0) {
    const double mass =
        largest_stiffness(system_, last_, {.U = 0.0, .V = 0.0, .A = 1.0, .T_inv = {}});
    all.add({.name = "round-off, multipliers",
             .value = mass * unit / (h * h) / force,
             .warn = weak_round_off,
             .fail = std::numeric_limits<double>::max(),
             .why =
                 "that of positions over the mean step squared, times the largest mass of a node, "
                 "over the largest multiplier, or force from outside"});
  }
  const double condition = reciprocal_condition(h);
  all.add({.name = "condition",
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
    all.add(
        {.name = "constraints, position",
         .value = g,
         .warn = near_tolerance * std::max(1e-12, rounding),
         .fail = beyond_tolerance * std::max(1e-12, rounding),
         .where = row >= 0 ? system_.name_of(6 * system_.nodes() + row) : std::string(),
         .why =
             "largest gap over the scene's length, or sine of an angle, at the last equilibrium; "
             "bounds: 10 and 1000 times 1e-12, or round-off of positions"});
    row = -1;
  }
  const double left = largest(r_, &row);
  const double scale = std::max(largest(load, nullptr), largest_force_);
  // What positions that are known to round-off leave of forces.
  const double rounding =
      floor_units * unit_round_off * std::max(farthest_, L) * largest_stiffness(system_, last_);
  constexpr double no_force = 1e-13;  // [N] where nothing is loaded
  if (scale > no_force)
    all.add(
        {.name = "balance of forces",
         .value = left / scale,
         .warn = near_tolerance * std::max(1e-9, rounding / scale),
         .fail = beyond_tolerance * std::max(1e-9, rounding / scale),
         .where = row >= 0 ? system_.name_of(row) : std::string(),
         .why =
             "largest force, or moment over the scene's length, that is left over at a node, of "
             "the "
             "largest load or reaction; bounds: 10 and 1000 times round-off of positions times the "
             "largest stiffness, or 1e-9"});
  if (scale > no_force && system_.multipliers() > 0)
    add_round_off_of_forces(system_, last_, scale, all);
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
  if (scene_.transient) {
    if (report.time_error) all.checks.push_back(check_of(*report.time_error));
    add_motion(all, report);
  }
  if (!scene_.transient) add_equilibrium(all, report);
  add_mesh(all);
  add_loads(all);
  add_components(all);
  add_round_off(all);
  return all;
}

}  // namespace mbd
