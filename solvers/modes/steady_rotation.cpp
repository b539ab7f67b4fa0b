#include "solvers/modes/steady_rotation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/stop.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/statics/equilibrium.hpp"

namespace mbd {
namespace {

constexpr double same =
    1e-7;  // of the scene's length and 1 rad; ten times that of what the answer is
constexpr double smallest_step = 1e-4;  // of the rate
constexpr double slightly = 1e-6;       // shift beside the fastest motion

// Motions of the nodes by one radian of the rotation.
VecX turning(const SmallMotions& motions, SteadyRotation rotation, const State& state) {
  rotation.rate = 1.0;
  VecX z = VecX::Zero(motions.motions());
  for (std::size_t n = 1; n < state.pose.size(); ++n)
    if (rotation.turns(n))
      z.segment<6>(6 * static_cast<Index>(n - 1)) = rotation.twist(state.pose[n]);
  return z;
}

// Whether no constraint holds the angle about the axis, as a drive does. K is singular then.
bool is_free_to_turn(const SmallMotions& motions, const VecX& z) {
  constexpr double none = 1e-9;
  const VecX open = motions.opening(z);
  return open.size() == 0 ||
         open.cwiseAbs().maxCoeff() < none * std::max(1.0, motions.system().length_scale());
}

// The turn of a node that is the largest of z.
Index most_turned(const VecX& z) {
  Index best = 3;
  for (Index i = 0; i < z.size(); ++i)
    if (i % 6 >= 3 && std::abs(z(i)) > std::abs(z(best))) best = i;
  return best;
}

// Where nothing holds the angle, and something acts about the axis: no rotation is steady.
std::string unheld_moment(const SmallMotions& motions, const SteadyRotation& rotation) {
  constexpr double none = 1e-7;  // of what acts on parts of it
  const VecX z = turning(motions, rotation, motions.state());
  if (!is_free_to_turn(motions, z)) return {};
  const VecX r = motions.residual().tail(motions.unknowns()).head(motions.motions());
  const double moment = z.dot(r), all = z.cwiseAbs().dot(r.cwiseAbs());
  if (!(std::abs(moment) > none * all)) return {};
  return fmt::format(
      ": a moment of {:.4g} N.m about the axis acts on what turns, of a damper or a load, and "
      "nothing holds its rate; give a joint that turns with it a <drive>, or leave out what brakes "
      "it",
      std::abs(moment));
}

bool newton_at(SmallMotions& motions, const SteadyRotation& rotation, const NewtonOptions& options,
               State& state, Counters& counters, std::string& failure) {
  const System& system = motions.system();
  IncrementNorm norm(system, options);
  double previous = 0.0;
  for (int k = 0; k < options.max_iterations; ++k) {
    stop::check();
    turn_steadily(rotation, state);
    if (!motions.about(state)) {
      failure = range_failure(system.out_of_range(state));
      return false;
    }
    ++counters.iterations;
    ++counters.residuals;
    ++counters.tangents;
    ++counters.factorizations;
    if (k == 0) norm.set_floor(state, motions.stiffness());
    // No torque acts about the axis where nothing holds the angle, so what holds it in the tangent feels none.
    hold_free_turn(motions, rotation);
    VecX x = -motions.residual().tail(motions.unknowns());
    if (!motions.factor(0.0)) {
      failure = "the tangent is singular";
      return false;
    }
    motions.solve_all(x);
    const double turn = largest_rotation_in(system, x);
    const double e = norm({x.data(), static_cast<std::size_t>(x.size())}, 1.0);
    if (!std::isfinite(e)) {
      failure = "the tangent is singular, or the residual not finite";
      return false;
    }
    const double share = turn > largest_turn_of_rotation ? largest_turn_of_rotation / turn : 1.0;
    retract(system, state, x, share);
    norm.observe(state.lambda);
    if (share == 1.0 && has_converged(e, previous)) {
      turn_steadily(rotation, state);
      if (const std::string element = system.out_of_range(state); !element.empty()) {
        failure = range_failure(element);
        return false;
      }
      return motions.about(state);
    }
    previous = e;
  }
  failure = "Newton's iterations do not converge" + unheld_moment(motions, rotation);
  return false;
}

// Whether the state that `motions` is about is in equilibrium but for round-off of its stiffness.
bool is_in_balance(const SmallMotions& motions) {
  constexpr double round_off = 10.0 * std::numeric_limits<double>::epsilon();
  const double length = motions.length_scale(), force = round_off * motions.stiffness() * length;
  const VecX r = motions.residual().tail(motions.unknowns());
  for (Index i = 0; i < r.size(); ++i) {
    const double least = i >= motions.motions() ? round_off * std::max(1.0, length)
                         : i % 6 < 3            ? force
                                                : force * length;
    if (!(std::abs(r(i)) <= least)) return false;
  }
  return true;
}

}  // namespace

bool solve_steady_rotation(SmallMotions& motions, const SteadyRotation& rotation,
                           const NewtonOptions& options, State& state, Counters& counters,
                           std::string& failure) {
  State start = state;
  if (newton_at(motions, rotation, options, state, counters, failure)) return true;
  // At its critical speed the tangent of what is in balance is singular: increments are round-off of any size.
  turn_steadily(rotation, start);
  if (!motions.about(start) || !is_in_balance(motions)) return false;
  state = std::move(start);
  failure.clear();
  return true;
}

void hold_free_turn(SmallMotions& motions, const SteadyRotation& rotation) {
  const VecX z = turning(motions, rotation, motions.state());
  if (is_free_to_turn(motions, z)) motions.hold(most_turned(z));
}

Vec6 SteadyRotation::twist(const Pose<double>& H) const {
  const Vec3 w = rate * axis;
  const auto to_body = H.p.conjugate();
  return six<double>(to_body * Vec3(w.cross(H.r - through)), to_body * w);
}

void turn_steadily(const SteadyRotation& rotation, State& state) {
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    state.V[n] = rotation.turns(n) ? rotation.twist(state.pose[n]) : Vec6(Vec6::Zero());
    state.Vdot[n].setZero();
  }
}

bool about_rotation(SmallMotions& motions, const SteadyRotation& rotation, ModeAxes axes,
                    const State& state) {
  std::vector<Vec6> W(state.pose.size(), Vec6::Zero());
  if (axes == ModeAxes::turning)
    for (std::size_t n = 1; n < W.size(); ++n) W[n] = rotation.twist(state.pose[n]);
  return motions.about(state, W);
}

SteadyReport find_steady_rotation(SmallMotions& motions, const SteadyRotation& rotation,
                                  double from, const NewtonOptions& options, State& state) {
  SteadyReport report;
  double reached = 0.0, step = 1.0;  // shares of the way from `from`
  const auto at = [&](double share) {
    SteadyRotation here = rotation;
    here.rate = from + share * (rotation.rate - from);
    return here;
  };
  report.rate = from;
  State last = state;
  while (reached < 1.0) {
    const double share = std::min(1.0, reached + step);
    State trial = last;
    std::string failure;
    if (solve_steady_rotation(motions, at(share), options, trial, report.counters, failure)) {
      last = std::move(trial);
      reached = share;
      ++report.steps;
      report.rate = at(share).rate;
      step *= 2.0;
      continue;
    }
    step *= 0.5;
    if (step < smallest_step) {
      report.failure =
          fmt::format("no steady rotation was found beyond {:.6g} rad/s: {}", report.rate, failure);
      break;
    }
  }
  state = std::move(last);
  report.converged = reached >= 1.0;
  if (!report.converged) {
    turn_steadily(at(reached), state);
    motions.about(state);
  }
  return report;
}

std::string held_fast(const SmallMotions& motions, const SteadyRotation& rotation,
                      const State& state, const IsDriven& driven) {
  const System& system = motions.system();
  const VecX open = motions.opening(turning(motions, rotation, state));
  for (Index row = 0; row < open.size(); ++row)
    if (std::abs(open(row)) > same * std::max(1.0, system.length_scale()) && !driven(row))
      return fmt::format("{} does not let it turn about the axis",
                         system.name_of(row + motions.motions() + 6));
  // It follows no angle beyond half a turn, and at rest would seem to turn along by half.
  constexpr double beyond = 3.0;  // [rad], of its range
  const std::string name = system.out_of_range(turned_by(beyond, rotation, state));
  if (name.starts_with("bushing "))
    return name + " does not let it turn about the axis, its range is 0.9 of half a turn";
  return {};
}

namespace {

// Rates of a law over a while, and how far accelerations there would change them [1/s].
struct RatesOfLaw {
  double least = std::numeric_limits<double>::infinity(), most = -least, change = 0.0;
  bool is_constant() const {
    constexpr double hardly = 1e-6;
    return change <= hardly * std::max(std::abs(least), std::abs(most));
  }
};

// After the last breakpoint between two times.
RatesOfLaw rates_of(const Signal& signal, double from, double to) {
  bool is_rate = false;
  const Expression* const law = signal.expression(is_rate);
  for (const double t : law->breakpoints())
    if (t > from && t < to) from = t;
  RatesOfLaw rates;
  constexpr int samples = 64;
  constexpr double golden = 0.6180339887498949;  // no period of a law is a multiple of it
  for (int i = 1; i <= samples; ++i) {
    const Taylor2 f = (*law)(from + std::fmod(i * golden, 1.0) * (to - from));
    const double rate = is_rate ? f.v : f.d, acceleration = is_rate ? f.d : f.dd;
    rates.least = std::min(rates.least, rate);
    rates.most = std::max(rates.most, rate);
    rates.change = std::max(rates.change, std::abs(acceleration) * (to - from));
  }
  return rates;
}

// Whether a signal drives what the rotation turns, and whether it drives anything.
struct Driven {
  bool rotation = false, any = false;
};

Driven driven_by(const System& system, const VecX& open, State state, std::size_t k) {
  for (Vec6& V : state.V) V.setZero();
  for (SignalValue& signal : state.signals) signal.fdot = 0.0;
  state.signals[k].fdot = 1.0;
  VecX g, gdot;
  system.constraints(state, g, gdot);
  const double none = same * std::max(1.0, system.length_scale());
  Driven driven;
  for (Index row = 0; row < gdot.size(); ++row) {
    if (gdot(row) == 0.0) continue;
    driven.any = true;
    driven.rotation = driven.rotation || std::abs(open(row)) > none;
  }
  return driven;
}

}  // namespace

std::string unsteady_drive(const SmallMotions& motions, const SteadyRotation& rotation,
                           const State& state, double duration) {
  const System& system = motions.system();
  const VecX open = motions.opening(turning(motions, rotation, state));
  for (std::size_t k = 0; k < state.signals.size(); ++k) {
    const Signal& signal = system.signals()[k];
    if (system.signal_use(k) != SignalUse::drive || signal.is_constant() || signal.has_inputs())
      continue;
    const Driven driven = driven_by(system, open, state, k);
    if (driven.any && !driven.rotation)
      return fmt::format(
          "{} moves, and steady rotation changes no shape: give it a constant value, or leave it "
          "out",
          system.signal_name(k));
    const RatesOfLaw rates = rates_of(signal, 0.9 * duration, duration);
    if (!rates.is_constant() && !rates_of(signal, duration, 2.0 * duration).is_constant())
      return fmt::format(
          "{} has no constant rate at the end of the run (from {:.6g} to {:.6g} 1/s in its last "
          "tenth), as a steady rotation has: end it with one",
          system.signal_name(k), rates.least, rates.most);
  }
  return {};
}

namespace {

Pose<double> turned_pose(double angle, const SteadyRotation& rotation, const Pose<double>& H) {
  const Eigen::Quaterniond by(Eigen::AngleAxisd(angle, rotation.axis));
  Pose<double> after = H;
  after.r = rotation.through + by * (H.r - rotation.through);
  after.p = by * H.p;
  return after;
}

}  // namespace

State turned_by(double angle, const SteadyRotation& rotation, const State& state) {
  State turned = state;
  for (std::size_t k = 1; k < state.pose.size(); ++k)
    if (rotation.turns(k)) turned.pose[k] = turned_pose(angle, rotation, state.pose[k]);
  return turned;
}

namespace {

// A state turned about the axis.
struct Turned {
  State state;
  std::vector<Pose<double>> to_body;  // g of small_motions.hpp, by node
};

Turned turned_by(double angle, const SteadyRotation& rotation, ModeAxes axes, const State& state) {
  Turned turned{turned_by(angle, rotation, state), std::vector<Pose<double>>(state.pose.size())};
  for (std::size_t k = 1; k < state.pose.size(); ++k)
    turned.to_body[k] = relative(
        axes == ModeAxes::turning ? turned_pose(angle, rotation, state.pose[k]) : state.pose[k],
        turned.state.pose[k]);
  return turned;
}

// `held`: the coordinate that a free spin is held at, the same at all angles; it is chosen where there is none.
bool factor_about(SmallMotions& motions, const SteadyRotation& rotation, ModeAxes axes,
                  State& turned, double shift, std::optional<Index>& held) {
  turn_steadily(rotation, turned);
  if (!about_rotation(motions, rotation, axes, turned)) return false;
  // A spin that nothing holds would answer more than all else.
  const VecX z = turning(motions, rotation, turned);
  if (is_free_to_turn(motions, z)) {
    if (!held) held = most_turned(z);
    motions.hold(*held);
  }
  return motions.factor(shift);
}

// The motion that answers a force; both in axes that have not turned.
VecX answer_to(VecX force, SmallMotions& motions, const Turned& turned) {
  const auto each_node = [&](const auto& turn) {
    for (Index i = 0; i < force.size(); i += 6) {
      const Mat6 Ad = adjoint(turned.to_body[static_cast<std::size_t>(i / 6 + 1)]).matrix();
      force.segment<6>(i) = turn(Ad, force.segment<6>(i));
    }
  };
  each_node([](const Mat6& Ad, const auto& f) -> Vec6 { return Ad.transpose() * f; });
  Eigen::MatrixXd answer = force;
  motions.solve(answer);
  force = answer.col(0);
  each_node([](const Mat6& Ad, const auto& u) -> Vec6 { return Ad * u; });
  return force;
}

VecX random_force(Index n, double length) {
  VecX force(n);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (double& entry : force) entry = number(random);
  for (Index i = 0; i < n; i += 6) force.segment<3>(i) /= length;
  return force;
}

// Where one of the answers is farthest from the first, if by more than `none` of its largest; -1: nowhere, and where answers
// are smaller than `any`: nothing is left to move, and they are round-off.
Index most_changed(const VecX& first, const std::vector<VecX>& answers, double none, double any) {
  if (!(first.cwiseAbs().maxCoeff() > any)) return -1;
  for (const VecX& answer : answers) {
    Index worst = 0;
    if (!((answer - first).cwiseAbs().maxCoeff(&worst) < none * first.cwiseAbs().maxCoeff()))
      return worst;
  }
  return -1;
}

// In answers at a shift s.
std::string broken_at(double s, SmallMotions& motions, const SteadyRotation& rotation,
                      ModeAxes axes, const State& state, const IsDriven& driven) {
  const std::string singular = "small motions turned about the axis are singular";
  const System& system = motions.system();
  const Index n = motions.motions();
  const double length = system.length_scale();
  const VecX force = random_force(n, length);
  constexpr double hardly = 1e-9;
  const double any = hardly * force.maxCoeff() / (motions.stiffness() + s * s * motions.mass());
  VecX first;
  std::optional<Index> held;
  std::vector<VecX> answers;
  double noise = 0.0;  // round-off, of another angle that is nearly the same
  std::string broken;
  for (const double angle : {0.0, 0.7, 0.7 + hardly, -1.1}) {
    Turned turned = turned_by(angle, rotation, axes, state);
    const auto assemble = [&] {
      return factor_about(motions, rotation, axes, turned.state, s, held);
    };
    if (!assemble()) return singular;
    VecX x = -motions.residual().tail(motions.unknowns());
    for (Index row = n; row < x.size(); ++row) {
      if (std::abs(x(row)) > same * std::max(1.0, length) && !driven(row - n))
        return fmt::format("{} does not let it turn about the axis", system.name_of(row + 6));
      x(row) = 0.0;
    }
    // Multipliers in axes that do not turn are others there; motion must not answer.
    motions.solve_all(x);
    double most = 0.0;
    Index where = 0;
    for (Index k = 0; k < n; ++k) {
      const double size = std::abs(x(k)) / (k % 6 < 3 ? length : 1.0);
      if (size > most) most = size, where = k;
    }
    if (!(most < same)) {
      broken = fmt::format(
          "forces in inertial axes act on what turns, most on {} (weight, dead loads, springs or "
          "drag of the surroundings)",
          system.name_of(where + 6));
      break;
    }
    turned.state.lambda += x.tail(turned.state.lambda.size());
    if (!assemble()) return singular;
    VecX answer = answer_to(force, motions, turned);
    if (angle == 0.0) {
      first = answer;
      continue;
    }
    const double size = first.cwiseAbs().maxCoeff();
    if (angle == 0.7 + hardly) noise = (answer - answers.back()).cwiseAbs().maxCoeff() / size;
    answers.push_back(std::move(answer));
  }
  if (broken.empty())
    if (const Index worst = most_changed(first, answers, std::max(10.0 * same, 30.0 * noise), any);
        worst >= 0)
      broken = fmt::format("it is not the same in all directions about the axis, most felt by {}",
                           system.name_of(worst + 6));
  return broken;
}

}  // namespace

std::string broken_symmetry(SmallMotions& motions, const SteadyRotation& rotation, ModeAxes axes,
                            const State& state, const IsDriven& driven) {
  // Not at the rate itself, where what is free to leave the axis is as light as it is heavy. And near the fastest motion: at a small
  // shift what nothing holds answers so much more than all else that nothing else is seen.
  constexpr double beside = 1.37, near = 0.1;
  const double fastest = std::sqrt(motions.stiffness() / motions.mass()),
               slow = std::max({beside * std::abs(rotation.rate), slightly * fastest, 1e-300});
  std::string broken = broken_at(slow, motions, rotation, axes, state, driven);
  if (broken.empty() && near * fastest > slow)
    broken = broken_at(near * fastest, motions, rotation, axes, state, driven);
  about_rotation(motions, rotation, axes, state);
  return broken;
}

}  // namespace mbd
