#include "libmbd/study/modes/floquet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/se3.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/states_of_run.hpp"
#include "libmbd/text/tables.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/motion.hpp"
#include "solvers/laws/law_steps.hpp"
#include "solvers/modes/linearizable.hpp"
#include "solvers/statics/equilibrium.hpp"

namespace mbd {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;
constexpr std::array<int, 4> tried{8, 16, 32, 64};  // harmonics
constexpr double resolved = 1e-8;                   // tail of the motion
constexpr double shown = 1e-6;                      // tail of a small motion that is shown
constexpr double slow_share = 0.25;                 // of the fastest motions that harmonics resolve
constexpr int most_exponents = 256;
constexpr Index most_unknowns =
    10000;  // for which more harmonics are tried: all instants are coupled

// What a law of sensors does in time must repeat as well: at sensors that are held.
void check_held_law(const Scene& scene, const System& system, std::size_t k, double t,
                    double period) {
  constexpr double same = 1e-9;
  bool is_rate = false;
  const Expression* const law = system.signals()[k].expression(is_rate);
  if (law == nullptr || !law->has_sensors()) return;
  for (const Expression& held : held_laws(*law, t)) {
    const Taylor2 x = held(t), y = held(t + period);
    const double size =
        std::max({std::abs(x.v), std::abs(y.v), std::abs(x.d) * period, std::abs(y.d) * period});
    if (std::isfinite(size) && !(std::abs(y.v - x.v) <= 1e3 * same * size))
      throw Error(scene.source,
                  fmt::format("floquet: {} does not repeat with the period {:.9g} s: at sensors "
                              "that are held it is {:.9g} at {:.9g} s and {:.9g} a period later",
                              system.signal_name(k).empty() ? "a law" : system.signal_name(k),
                              period, x.v, t, y.v));
  }
}

// Drives may go on by whole turns.
void check_period(const Scene& scene, const System& system, const State& state, double begin,
                  double period) {
  constexpr int instants = 16;
  constexpr double same = 1e-9;
  State a = state, b = state;
  for (int i = 0; i < instants; ++i) {
    const double t = begin + period * (i + 0.37) / instants;
    system.set_time(a, t);
    system.set_time(b, t + period);
    for (std::size_t k = 0; k < a.signals.size(); ++k) {
      check_held_law(scene, system, k, t, period);
      const SignalValue &x = a.signals[k], &y = b.signals[k];
      double change = y.f - x.f;
      if (system.signal_use(k) == SignalUse::drive) change -= turn * std::round(change / turn);
      const double size = std::max({1.0, std::abs(x.f), std::abs(y.f)}),
                   rate = std::max(std::abs(x.fdot), std::abs(y.fdot)) * period;
      if (!(std::abs(change) <= same * std::max(size, rate)) ||
          !(std::abs(y.fdot - x.fdot) * period <= 1e3 * same * std::max(size, rate)))
        throw Error(scene.source,
                    fmt::format("floquet: {} does not repeat with the period {:.9g} s: it is "
                                "{:.9g} at {:.9g} s and {:.9g} a period later",
                                system.signal_name(k).empty() ? "a drive" : system.signal_name(k),
                                period, x.f, t, y.f));
    }
  }
}

std::string node_that_moves_most(const System& system, const PeriodicMotion& motion,
                                 const VecXc& p) {
  const Index each = motion.motions() / motion.instants();
  VecX sizes = VecX::Zero(each / 6);
  for (Index i = 0; i < motion.instants(); ++i)
    for (Index n = 0; n < each / 6; ++n) {
      const auto u = p.segment<6>(i * each + 6 * n);
      sizes(n) += u.head<3>().squaredNorm() / std::pow(system.length_scale(), 2) +
                  u.tail<3>().squaredNorm();
    }
  Index most = 0;
  sizes.maxCoeff(&most);
  return system.node_name(most + 1);
}

// A run, at two ends of a period and at the instants of all numbers of harmonics that may be tried.
struct RunOfPeriod {
  std::vector<int> harmonics;
  std::vector<double> times;
  std::vector<State> states;

  std::vector<State> at_instants_of(const PeriodicMotion& motion) const {
    std::vector<State> all;
    for (Index i = 0; i < motion.instants(); ++i) {
      const auto nearest = std::min_element(times.begin(), times.end(), [&](double a, double b) {
        return std::abs(a - motion.time(i)) < std::abs(b - motion.time(i));
      });
      all.push_back(states[static_cast<std::size_t>(nearest - times.begin())]);
    }
    return all;
  }
};

// The drive that turns at that rate at that time; -1: none.
std::ptrdiff_t drive_of(const System& system, State state, double t, double rate) {
  constexpr double same = 1e-9;
  system.set_time(state, t);
  for (std::size_t k = 0; k < state.signals.size(); ++k)
    if (system.signal_use(k) == SignalUse::drive &&
        std::abs(state.signals[k].fdot - rate) <= same * rate)
      return static_cast<std::ptrdiff_t>(k);
  return -1;
}

// At the times of a run the steady rotation without gravity, where its drive is.
std::vector<State> turned(const Scene& scene, const Model& model, const std::vector<double>& times,
                          const FloquetOptions& options) {
  Scene light = scene;
  light.gravity.reset();
  MotionsOfScene steady(light);
  SteadyRotation rotation = *options.rotation;
  rotation.rate = turn / options.period;
  rotation.rests = steady.nodes_of(options.at_rest);
  steady.turn(rotation);
  const System& system = *model.system;
  const std::ptrdiff_t drive = drive_of(system, model.initial, times.front(), rotation.rate);
  std::vector<State> states(times.size(), steady.state());
  for (std::size_t i = 0; i < times.size(); ++i) {
    system.set_time(states[i], times[i]);
    const double angle =
        drive < 0 ? rotation.rate * times[i] : states[i].signals[static_cast<std::size_t>(drive)].f;
    const Quaternion<double> q = exp_so3<double>(Vec3(angle * rotation.axis));
    for (std::size_t n = 1; n < states[i].pose.size(); ++n) {
      Pose<double>& H = states[i].pose[n];
      if (!rotation.turns(n)) continue;
      H = {q * H.p, rotation.through + q * Vec3(H.r - rotation.through)};
    }
  }
  return states;
}

RunOfPeriod run_period(const Scene& scene, const Model& model, const State& start, double begin,
                       const FloquetOptions& options) {
  RunOfPeriod run;
  run.harmonics.assign(tried.begin(), tried.end());
  if (options.harmonics > 0) run.harmonics = {options.harmonics};
  std::vector<double>& times = run.times;
  times = {begin, begin + options.period};
  for (const int h : run.harmonics)
    for (int i = 0; i < 2 * h + 1; ++i) times.push_back(begin + options.period * i / (2 * h + 1));
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  run.states = options.rotation
                   ? turned(scene, model, times, options)
                   : states_of_run(scene, model, start, times, "floquet", options.interrupted);
  return run;
}

bool is_seen(const FloquetMode& mode) { return mode.tail < shown; }

struct FoundMotion {
  std::unique_ptr<PeriodicMotion> motion;
  FloquetFound small;  // motions about it
};

// Where a law stays at a kink, motions near it are not linear. Going through one they are.
void refuse_kinks(const Scene& scene, const System& system, const PeriodicMotion& motion) {
  const std::span<const State> states = motion.states();
  for (std::size_t i = 0; i + 1 < states.size(); ++i)
    if (const std::string kink = kink_at(system, states.subspan(i, 2)); !kink.empty())
      throw Error(scene.source, "floquet: " + kink);
}

// With as many harmonics as resolve the motion and the small ones that are asked for.
FoundMotion find_motion(const Scene& scene, const System& system, const RunOfPeriod& run,
                        const FloquetOptions& options, FloquetStudy& study) {
  std::unique_ptr<PeriodicMotion> motion;
  FloquetFound found;
  const LawFacts laws = LawSteps(system, study.begin, study.begin + options.period).facts();
  const auto sees_laws = [&](int h) {
    return laws.longest_step == 0.0 || options.period / (2 * h + 1) <= laws.longest_step;
  };
  for (const int h : run.harmonics) {
    if (!sees_laws(h) && h != run.harmonics.back() &&
        (2 * h + 1) * system.unknowns() <= most_unknowns)
      continue;
    if (motion != nullptr && (2 * h + 1) * system.unknowns() > most_unknowns) break;
    auto next = std::make_unique<PeriodicMotion>(system, study.begin, options.period, h);
    std::vector<State> states = run.at_instants_of(*next);
    NewtonOptions newton;
    newton.max_iterations = 50;
    const PeriodicReport report = next->solve(newton, states);
    if (!report.converged && motion != nullptr) break;
    study.report = report;
    if (!report.converged) continue;
    study.harmonics = h;
    motion = std::move(next);
    found = {};
    if (report.tail > resolved && h != run.harmonics.back()) continue;
    found = find_floquet_modes(*motion, most_exponents);
    if (!found.failure.empty()) throw Error(scene.source, "floquet: " + found.failure);
    const auto many = std::count_if(found.modes.begin(), found.modes.end(), is_seen);
    if (many == static_cast<std::ptrdiff_t>(found.modes.size()) || many >= options.count) break;
  }
  if (motion == nullptr)
    throw Error(
        scene.source,
        fmt::format(
            "floquet: no periodic motion was found: {}{}", study.report.failure,
            options.rotation
                ? std::string(" (it starts from the steady rotation without gravity)")
                : fmt::format(" (over the period that was integrated the motion closes to "
                              "{:.3g} of the scene's size or rad; --settle gives it more "
                              "periods before)",
                              motion_between(system, run.states.front(), run.states.back()))));
  refuse_kinks(scene, system, *motion);
  if (!sees_laws(study.harmonics)) {
    study.undecided = fmt::format(
        "{} changes within {:.3g} s near t = {:.9g} s, and the {} instants of the motion lie "
        "{:.3g} s apart: between them it is not seen; more --harmonics, or an integration over the "
        "period, do",
        laws.which, laws.longest_step, laws.at, 2 * study.harmonics + 1,
        options.period / (2 * study.harmonics + 1));
  }
  if (study.report.tail >= resolved)
    study.notes.push_back(
        fmt::format("the motion is not smooth: of its velocities {:.2g} is in the fastest of {} "
                    "harmonics, and so large are the errors",
                    study.report.tail, study.harmonics));

  if (found.modes.empty()) found = find_floquet_modes(*motion, most_exponents);
  if (!found.failure.empty()) throw Error(scene.source, "floquet: " + found.failure);
  return {std::move(motion), std::move(found)};
}

void name_modes(const Scene& scene, const System& system, FoundMotion& found, int count,
                FloquetStudy& study) {
  std::vector<FloquetMode>& modes = found.small.modes;
  study.all = found.small.all;
  const double slow = slow_share * turn * study.fastest();
  bool may_grow = false;  // a slow motion that is not resolved: not one that is too fast to be
  for (FloquetMode& mode : modes) {
    if (!is_seen(mode)) {
      may_grow = may_grow || (std::abs(mode.frequency) < slow &&
                              mode.exponent.real() * study.period > -neutral_growth);
      continue;
    }
    ++study.resolved;
    if (study.modes.size() >= static_cast<std::size_t>(count)) continue;
    NamedFloquetMode named;
    named.most = node_that_moves_most(system, *found.motion, mode.shape);
    static_cast<FloquetMode&>(named) = std::move(mode);
    study.modes.push_back(std::move(named));
  }
  if (study.modes.empty())
    throw Error(scene.source, "floquet: no small motion is resolved; give more --harmonics");
  if (may_grow && study.undecided.empty())
    study.undecided = fmt::format(
        "a slow motion that may grow changes too much in a period for {} harmonics to judge it",
        study.harmonics);
  if (study.resolved < modes.size())
    study.notes.push_back(
        fmt::format("{} small motions are too fast, or change too much in a period, for {} "
                    "harmonics: they are not judged",
                    modes.size() - study.resolved, study.harmonics));
  if (!study.all)
    study.notes.push_back(
        fmt::format("only the {} exponents nearest to 0 were looked at; faster decay or growth may "
                    "be among the others",
                    modes.size()));
}

// What a reader would take for an exact multiplier.
void say_what_is_not_in_it(const System& system, const PeriodicMotion& motion,
                           FloquetStudy& study) {
  if (!system.controllers().empty())
    study.notes.push_back(std::string(controllers_are_held) +
                          ", and the verdict is not that of the controlled motion");
  const double slack = 1e-9 * study.period;
  for (const Breakpoint& b : system.breakpoints()) {
    if (!b.restart || b.t < study.begin - slack || b.t > study.begin + study.period + slack)
      continue;
    study.uncertain = 1.0 / static_cast<double>(motion.instants());
    study.notes.push_back(
        fmt::format("a law jumps at {:.9g} s, between two of {} instants: multipliers are known to "
                    "about {:.1g} "
                    "(more --harmonics, or an integration over the period, say more)",
                    b.t, motion.instants(), study.uncertain));
    return;
  }
}

void write_motion(const std::filesystem::path& file, const Scene& scene, const Model& model,
                  const PeriodicMotion& motion) {
  const MotionBlocks blocks = motion_blocks(model);
  MotionWriter writer(file, drawing(scene, model), blocks);
  std::vector<double> row(blocks.size());
  for (const State& state : motion.states()) {
    motion_row(model, state, row);
    writer.write(row);
  }
  writer.close();
}

// `apart`: how far the run is from the motion that was found, where that begins, of the scene's size or rad.
FloquetStudy study_from_run(const Scene& given, const FloquetOptions& options,
                            const std::filesystem::path& motion_file, double& apart) {
  if (!(options.period > 0.0) || !std::isfinite(options.period))
    throw Error(given.source, "floquet: the period must be a positive number of seconds");
  const stop::Scope scope(options.interrupted);
  FloquetStudy study;
  study.model = given.name;
  study.file = given.file;
  study.period = options.period;
  study.begin = options.settle * options.period;

  const Scene scene =
      scene_of_run(given, study.begin + 2.0 * options.period);  // loads are looked at for one more
  const Model model = compile(scene);
  const System& system = *model.system;
  const State start = options.rotation ? model.initial : start_of_run(scene, model);
  check_period(scene, system, start, study.begin, options.period);

  const RunOfPeriod run = run_period(scene, model, start, study.begin, options);
  FoundMotion found = find_motion(scene, system, run, options, study);
  name_modes(scene, system, found, options.count, study);
  say_what_is_not_in_it(system, *found.motion, study);
  apart = motion_between(system, run.states.front(), found.motion->states().front());
  if (!motion_file.empty()) write_motion(motion_file, scene, model, *found.motion);
  return study;
}

}  // namespace

// Newton's method may go from a run that has not settled to a motion that the run does not lead to, and which is unstable
// then: it is looked for again, later in the run.
FloquetStudy study_floquet(const Scene& scene, const FloquetOptions& options,
                           const std::filesystem::path& motion_file) {
  constexpr double led_to = 1e-3;  // `apart`
  constexpr int settled = 8;
  constexpr double scale_of_transients = 0.1;  // what a run that goes there has left, at most
  double apart = 0.0;
  FloquetStudy study = study_from_run(scene, options, motion_file, apart);
  const auto is_astray = [](const FloquetStudy& of, double how_far) {
    return of.stability() == Stability::unstable && how_far > led_to;
  };
  if (options.rotation) return study;
  if (!is_astray(study, apart)) {
    // A run that has not settled is apart as well, and goes there.
    if (apart > led_to && study.stability() == Stability::stable &&
        apart > std::exp(study.growth() * options.settle) * scale_of_transients)
      study.notes.push_back(fmt::format(
          "after {} periods the run is {:.2g} of the scene's size, or rad, away from this motion: "
          "it may not have settled, or lead to another one; --settle with more periods says which",
          options.settle, apart));
    return study;
  }
  FloquetOptions longer = options;
  longer.settle = std::max(settled, 2 * options.settle);
  try {
    double far = 0.0;
    FloquetStudy other = study_from_run(scene, longer, {}, far);
    if (!is_astray(other, far)) {
      if (!motion_file.empty()) other = study_from_run(scene, longer, motion_file, far);
      other.notes.push_back(fmt::format(
          "found from {} periods of the run: from {} another motion was found, to which the run "
          "does not lead, and which is unstable (a factor {:.4g} in a period)",
          longer.settle, options.settle, std::exp(study.growth())));
      return other;
    }
  } catch (const Error&) {
    if (options.interrupted != nullptr && *options.interrupted) throw;
  }
  study.notes.push_back(
      fmt::format("the run does not lead to this motion: after {} periods it is {:.2g} of the "
                  "scene's size, or rad, away, and Newton's method went there",
                  options.settle, apart));
  return study;
}

namespace {

std::string verdict(const FloquetStudy& study) {
  switch (study.stability()) {
    case Stability::unstable:
      return fmt::format("unstable: what disturbs it grows by a factor {:.6g} in a period",
                         std::exp(study.growth()));
    case Stability::stable:
      return fmt::format(
          "stable, of motions up to {:.4g} Hz ({} harmonics): what disturbs it shrinks to {:.6g} "
          "or less in a period",
          study.fastest(), study.harmonics, std::exp(study.growth()));
    case Stability::neutral:
      break;
  }
  if (!study.undecided.empty())
    return fmt::format(
        "not decided: {}; of what was judged, what disturbs it changes by {:.6g} or "
        "less in a period",
        study.undecided, std::exp(study.growth()));
  if (std::abs(study.growth()) > neutral_growth)
    return fmt::format(
        "not decided: what disturbs it changes by a factor {:.6g} in a period, and laws that jump "
        "make that uncertain by about {:.1g}",
        std::exp(study.growth()), study.uncertain);
  return fmt::format(
      "neutral: some disturbance neither grows nor decays, of motions up to {:.4g} Hz",
      study.fastest());
}

}  // namespace

std::string to_text(const FloquetStudy& study) {
  std::string text = fmt::format(
      "{}: periodic motion of {:.10g} s, by {} harmonics (velocities to {:.2g})\n{}\n\n",
      study.model, study.period, study.harmonics, study.report.tail, verdict(study));
  std::vector<std::vector<std::string>> rows{
      {"", "|multiplier|", "multiplier", "growth 1/s", "inertial Hz", "moves most"}};
  for (std::size_t i = 0; i < study.modes.size(); ++i) {
    const NamedFloquetMode& mode = study.modes[i];
    rows.push_back({std::to_string(i + 1), fmt::format("{:.9g}", std::abs(mode.multiplier)),
                    fmt::format("{:.6g} {:+.6g}i", mode.multiplier.real(), mode.multiplier.imag()),
                    fmt::format("{:.6g}", mode.exponent.real()),
                    fmt::format("{:.8g}", mode.inertial / turn), mode.most});
  }
  study::table(text, rows);
  for (const std::string& note : study.notes) text += "\nnote: " + note + "\n";
  return text;
}

std::string to_csv(const FloquetStudy& study) {
  std::string text =
      "mode,re_exponent,im_exponent,re_multiplier,im_multiplier,frequency,inertial_frequency,"
      "tail,residual,moves_most\n"
      "# -,1/s,1/s,-,-,Hz,Hz,-,-,-\n";
  for (std::size_t i = 0; i < study.modes.size(); ++i) {
    const NamedFloquetMode& mode = study.modes[i];
    text += fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.3g},{:.3g},{}\n",
                        i + 1, mode.exponent.real(), mode.exponent.imag(), mode.multiplier.real(),
                        mode.multiplier.imag(), mode.frequency / turn, mode.inertial / turn,
                        mode.tail, mode.residual, study::csv_cell(mode.most));
  }
  return text;
}

}  // namespace mbd
