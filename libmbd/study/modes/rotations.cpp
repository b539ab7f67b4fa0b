#include "libmbd/study/modes/rotations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libmbd/compile/ports.hpp"
#include "libmbd/core/stop.hpp"
#include "solvers/modes/rotation_path.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {
namespace {

constexpr double no_growth = 1e-7;     // growth beside the eigenvalue, or beside the rate
constexpr double one_rotation = 1e-6;  // distance of two rotations
constexpr std::size_t most_paths = 40;
constexpr int modes_to_push = 3;
constexpr int points_of_push = 100, retries_of_push = 20;
constexpr std::size_t most_met = 2;  // by a push: it leads over a fold, and over another back
constexpr double push_step = 0.04;   // of the largest force

class SearchForRotations {
 public:
  SearchForRotations(const Scene& scene, const RotationsOptions& options)
      : options_(options), scene_(scene), motions_(scene), rotation_(options.rotation) {
    if (!options.at_rest.empty()) rotation_.rests = motions_.nodes_of(options.at_rest);
    for (const std::string& name : options.probes)
      places_.push_back(named_place(motions_.model(), name));
  }

  RotationsStudy go();

 private:
  using States = std::vector<State>;  // of the points of a path

  SteadyRotation at_rate(double rate) const {
    SteadyRotation here = rotation_;
    here.rate = rate;
    return here;
  }
  RotationOnPath describe(const State& state, double rate, double arc, bool is_fold);
  std::string follow(const State& from, double rate, bool rising, PathOfRotations& path,
                     States& states);
  void add_path(const State& from, double rate);
  std::vector<VecX> pushes(const State& state, double rate, double farthest);
  void push(const State& state, double rate, std::vector<State>& known);
  void add_if_new(const State& near, double rate, std::vector<State>& known);
  bool is_one_of_many(const State& state, double rate);
  void note_many(const State& state, double rate);
  std::vector<State> known_at(double rate);
  void seek_at(double rate);

  const RotationsOptions& options_;
  const Scene& scene_;
  MotionsOfScene motions_;
  SteadyRotation rotation_;
  std::vector<NamedPlace> places_;
  std::vector<States> states_;  // of each path of study_
  Counters counters_;
  bool is_noted_ = false;
  RotationsStudy study_;
};

RotationOnPath SearchForRotations::describe(const State& state, double rate, double arc,
                                            bool is_fold) {
  motions_.settle(at_rate(rate), state);
  RotationOnPath point;
  point.rate = rate;
  point.arc = arc;
  point.is_fold = is_fold;
  const auto [moved, node] = motions_.largest_displacement();
  const System& system = *motions_.model().system;
  point.displacement = moved;
  point.displaced = system.node_name(node);
  for (const NamedPlace& place : places_) {
    const auto at = [&](const Pose<double>& H) { return Vec3((H * place.frame).r); };
    point.probes.push_back(at(state.pose[static_cast<std::size_t>(place.node)]) -
                           at(system.reference_pose(place.node)));
  }
  ModeOptions modes;
  modes.count = options_.count;
  std::vector<NamedMode> found;
  try {
    found = motions_.modes(modes);
  } catch (const Stopped&) {
    throw;
  } catch (const Error&) {  // singular, as on a fold it may be
    return point;
  }
  point.unstable = 0;
  for (const NamedMode& mode : found) {
    const double growth = mode.eigenvalue.real();
    const double least =
        std::max(no_growth, mode.round_off) * std::max(std::abs(mode.eigenvalue), std::abs(rate));
    if (mode.rigid || !(growth > least)) continue;
    point.growth = std::max(point.growth, growth);
    ++*point.unstable;
  }
  return point;
}

// Appends to a path; returns why it ends.
std::string SearchForRotations::follow(const State& from, double rate, bool rising,
                                       PathOfRotations& path, States& states) {
  RotationPathOptions along;
  along.from = options_.from;
  along.to = options_.to;
  along.rising = rising;
  along.largest_step = options_.largest_step;
  along.most_moved = 2.5 * options_.largest_step;  // so that it looks smooth
  along.points = options_.points;
  along.accepted = [&](const RotationPoint& point) {
    states.push_back(point.state);
    path.points.push_back(describe(point.state, point.parameter, point.arc, point.is_fold));
    if (options_.progress) options_.progress(study_.paths.size() + 1, point.parameter);
    return true;
  };
  return follow_rotations(motions_.motions(), at_rate(rate), from, along).end;
}

// Both ways from a rotation.
void SearchForRotations::add_path(const State& from, double rate) {
  PathOfRotations path, back;
  States states, states_back;
  path.found_at = rate;
  const auto keep = [&] {
    study_.paths.push_back(std::move(path));
    states_.push_back(std::move(states));
  };
  try {
    if (rate > options_.from) {
      path.ends.push_back(follow(from, rate, false, back, states_back));
      for (std::size_t k = back.points.size(); k-- > 0;) {
        path.points.push_back(std::move(back.points[k]));
        path.points.back().arc *= -1.0;
        states.push_back(std::move(states_back[k]));
      }
    }
    path.points.push_back(describe(from, rate, 0.0, false));
    states.push_back(from);
    const bool is_closed = !path.ends.empty() && path.ends.front() == "it is closed";
    if (rate < options_.to && !is_closed)
      path.ends.push_back(follow(from, rate, true, path, states));
  } catch (const Stopped&) {
    keep();
    throw;
  }
  keep();
}

// Of the slowest modes of a rotation, forces that move it as they do: M x, by real and imaginary parts, so large that the tangent
// would have it moved three times as far as it may.
std::vector<VecX> SearchForRotations::pushes(const State& state, double rate, double farthest) {
  motions_.settle(at_rate(rate), state);
  SmallMotions& motions = motions_.motions();
  ModeOptions options;
  options.count = modes_to_push;
  const std::vector<NamedMode> modes = motions_.modes(options);
  const SteadyRotation here = at_rate(rate);
  about_rotation(motions, here, ModeAxes::turning, state);
  hold_free_turn(motions, here);
  std::vector<VecX> all;
  if (!motions.factor(0.0)) return all;
  const VecX weights = motion_weights(motions.system()).head(motions.motions());
  for (const NamedMode& mode : modes) {
    if (mode.rigid) continue;
    for (const VecX& shape : {VecX(mode.shape.real()), VecX(mode.shape.imag())}) {
      constexpr double none = 1e-3;
      if (!(shape.norm() > none * mode.shape.norm())) continue;
      Eigen::MatrixXd force = motions.mass_times(Eigen::MatrixXd(shape)), answer = force;
      motions.solve(answer);
      const double moved = std::sqrt(answer.col(0).dot(weights.cwiseProduct(answer.col(0))));
      if (std::isfinite(moved) && moved > 0.0)
        all.emplace_back(3.0 * farthest / moved * force.col(0));
    }
  }
  return all;
}

// Rotations that pushes lead to from one, none of which is known.
void SearchForRotations::push(const State& state, double rate, std::vector<State>& known) {
  SmallMotions& motions = motions_.motions();
  State reference = state;
  for (std::size_t n = 1; n < state.pose.size(); ++n)
    reference.pose[n] = motions.system().reference_pose(static_cast<Index>(n));
  // To the other side of the axis.
  const double farthest =
      options_.far * std::max(1.0, 2.0 * distance_between(motions, reference, state));
  for (const VecX& force : pushes(state, rate, farthest))
    for (const bool rising : {true, false}) {
      std::vector<State> met;
      State last = state;
      double share = 0.0;
      RotationPathOptions along;
      along.from = -1.0;
      along.to = 1.0;
      along.rising = rising;
      along.largest_step = push_step;
      along.points = points_of_push;
      along.retries = retries_of_push;
      along.accepted = [&](const RotationPoint& point) {
        if (share * point.parameter < 0.0)
          met.push_back(std::abs(share) < std::abs(point.parameter) ? last : point.state);
        last = point.state;
        share = point.parameter;
        return met.size() < most_met && distance_between(motions, state, last) < farthest;
      };
      follow_pushed_rotations(motions, at_rate(rate), state, force, along);
      for (const State& one : met) {
        const std::size_t before = known.size();
        add_if_new(one, rate, known);
        if (known.size() == before || !is_one_of_many(known.back(), rate)) continue;
        note_many(known.back(), rate);
        known.pop_back();
      }
    }
}

// Whether a rotation is one of many that differ in nothing, as of a round rotor in balance, whose bend may point anywhere: a
// motion that nothing answers, of what otherwise does not turn freely.
bool SearchForRotations::is_one_of_many(const State& state, double rate) {
  constexpr double slow = 1e-4;  // beside the next modes
  SmallMotions& motions = motions_.motions();
  about_rotation(motions, at_rate(rate), ModeAxes::turning, state);
  const ModesFound found = find_modes(motions, {.count = 3});
  std::vector<double> sizes;
  for (const Mode& mode : found.modes)
    if (!mode.rigid) sizes.push_back(std::abs(mode.eigenvalue));
  std::ranges::sort(sizes);
  return sizes.size() > 1 && sizes.front() < slow * sizes.back();
}

// The rotation near a state, if it is none of these.
void SearchForRotations::add_if_new(const State& near, double rate, std::vector<State>& known) {
  State state = near;
  std::string failure;
  if (!solve_steady_rotation(motions_.motions(), at_rate(rate), {}, state, counters_, failure))
    return;
  for (const State& other : known)
    if (distance_between(motions_.motions(), other, state) < one_rotation) return;
  known.push_back(std::move(state));
}

// Once, the first.
void SearchForRotations::note_many(const State& state, double rate) {
  if (std::exchange(is_noted_, true)) return;
  motions_.settle(at_rate(rate), state);
  const auto [moved, node] = motions_.largest_displacement();
  study_.notes.push_back(
      fmt::format("at {:.6g} rad/s there are rotations that differ in nothing but where their bend "
                  "points, {} {:.6g} m "
                  "from the reference configuration: they are left out, and such ones elsewhere; a "
                  "small unbalance "
                  "makes one of them",
                  rate, motions_.model().system->node_name(node), moved));
}

// Rotations at a rate, of all paths, each once.
std::vector<State> SearchForRotations::known_at(double rate) {
  std::vector<State> all;
  for (std::size_t p = 0; p < states_.size(); ++p) {
    const std::vector<RotationOnPath>& points = study_.paths[p].points;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double a = points[k].rate - rate, b = points[k + 1].rate - rate;
      if (a * b <= 0.0) add_if_new(states_[p][std::abs(a) < std::abs(b) ? k : k + 1], rate, all);
    }
  }
  return all;
}

// From all that are known, and from those that are found.
void SearchForRotations::seek_at(double rate) {
  std::vector<State> known = known_at(rate);
  for (std::size_t from = 0; from < known.size(); ++from) {
    std::vector<State> now = known;
    push(State(known[from]), rate, now);
    for (std::size_t k = known.size(); k < now.size() && study_.paths.size() < most_paths; ++k) {
      const std::size_t before = known.size();
      add_if_new(now[k], rate, known);
      if (known.size() == before) continue;  // on a path that has been found since
      add_path(State(now[k]), rate);
      for (const State& one : known_at(rate)) add_if_new(one, rate, known);
    }
  }
}

RotationsStudy SearchForRotations::go() {
  study_.model = scene_.name;
  study_.file = scene_.file;
  study_.from = options_.from;
  study_.to = options_.to;
  study_.count = options_.count;
  study_.probes = options_.probes;
  motions_.turn(at_rate(options_.from));
  study_.notes = motions_.notes();
  try {
    add_path(State(motions_.state()), options_.from);
    for (int k = 0; k < options_.searches; ++k) {
      const double share =
          options_.searches == 1 ? 1.0 : static_cast<double>(k) / (options_.searches - 1);
      const double rate = options_.from + share * (options_.to - options_.from);
      seek_at(rate);
      study_.searched.push_back(rate);
    }
  } catch (const Stopped&) {
    study_.notes.push_back("interrupted: paths may be missing, or end too soon");
  }
  if (study_.paths.size() >= most_paths)
    study_.notes.push_back(fmt::format("{} paths are found, and no more are sought", most_paths));
  return std::move(study_);
}

}  // namespace

RotationsStudy study_rotations(const Scene& scene, const RotationsOptions& options) {
  require_rising(options);
  if (options.count < 1 || options.points < 2 || options.searches < 0 ||
      !(options.largest_step > 0.0) || !(options.far > 0.0))
    throw Error("steady rotations need one mode, two points and a step at least");
  const stop::Scope scope(options.interrupted);
  return SearchForRotations(scene, options).go();
}

}  // namespace mbd
