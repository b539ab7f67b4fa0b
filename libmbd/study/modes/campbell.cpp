#include "libmbd/study/modes/campbell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "libmbd/core/stop.hpp"

namespace mbd {
namespace {

using Complex = std::complex<double>;

constexpr double rather_round = 0.5;          // orbit whose larger part is meant
constexpr double sure = 0.9;                  // overlap of a mode with itself a step on
constexpr double lost = 0.3;                  // below it there is none
constexpr double smallest_step = 1.0 / 64.0;  // of the distance between points
constexpr double first_rate =
    1e-4;  // of the range, in place of 0: what is alike in all directions has no shapes there
constexpr double is_slow =
    1e-3;  // of the largest frequency: that of a mode near its critical speed
constexpr double nothing = 1e-8;    // growth beside the frequencies that is round-off
constexpr double is_growth = 1e-7;  // beside the frequency of the motion itself
constexpr double aside = 1e-2;  // of a step, where modes at its end are not told from each other
constexpr double narrow_rate =
    1e-9;                          // of a rate: where a frequency of zero is looked for no nearer
constexpr double one_rate = 1e-7;  // of a rate: an interval of zero that round-off has made
constexpr std::size_t spare = 6;   // modes more than are followed

// A mode of one rate, or its conjugate.
struct Candidate {
  Complex eigenvalue;
  VecXc shape, momentum;  // x, M x
  double weight = 0.0;    // x^H M x
  double orbit = 0.0;
  bool has_orbit = false;
  double round_off = 0.0;
  std::string name;

  Candidate conjugate() const {
    Candidate c = *this;
    c.eigenvalue = std::conj(eigenvalue);
    c.shape = shape.conjugate();
    c.momentum = momentum.conjugate();
    c.orbit = -orbit;
    return c;
  }
  bool is_round_off() const { return round_off > 0.1; }  // a free motion, or one that stands
  // Of the motion [1/s]; 0 where it is round-off of so fast a one.
  double growth() const {
    return !is_round_off() &&
                   eigenvalue.real() > std::max(is_growth, 10.0 * round_off) * std::abs(eigenvalue)
               ? eigenvalue.real()
               : 0.0;
  }
  double overlap(const Candidate& other) const {
    return std::norm(other.shape.dot(momentum)) / (weight * other.weight);
  }
};

bool oscillates(Complex l) { return std::abs(l.imag()) > nothing * std::abs(l); }

// What tells of rates at which a motion neither moves nor comes back, where a real eigenvalue, or of undamped motions the square
// of an imaginary one, goes through zero: of a damped shaft of two stiffnesses, det(K - W^2 M) = 0 whatever its damping.
struct Standing {
  int growing = 0;  // eigenvalues that are real and positive
  // Of all that were looked at, the product of the two that are nearest to zero [1/s2], which is continuous over the rate.
  double product = 0.0;
  bool is_known = false;   // nothing stands still
  double round_off = 0.0;  // as Mode::round_off, of the nearest
};
Standing standing_of(const std::vector<Candidate>& all, double zero) {
  Standing result;
  std::array<double, 2> nearest;
  nearest.fill(std::numeric_limits<double>::infinity());
  for (const Candidate& c : all) {
    const double size = std::abs(c.eigenvalue);
    if (c.is_round_off()) continue;
    for (int k = 0; k < (oscillates(c.eigenvalue) ? 2 : 1); ++k) {
      if (size < nearest[0]) {
        nearest = {size, nearest[0]};
        result.round_off = c.round_off;
      } else {
        nearest[1] = std::min(nearest[1], size);
      }
    }
    if (!oscillates(c.eigenvalue) && c.eigenvalue.real() > 0.0) ++result.growing;
  }
  if (std::isinf(nearest[1])) return result;
  result.product = nearest[0] * nearest[1];
  result.is_known = nearest[0] > zero;
  return result;
}

// The root of f between two rates, to round-off, by false position with halved ends (Illinois); none where f leaps over zero.
// f(x, is_root) may look beside x, which it then moves; `is_root`: it has come near to zero. None from it: it is not known there.
struct Root {
  double x, unknown;  // by how much it may be off, after the least |f| that was seen
};
template <class F>
std::optional<Root> root_between(double a, double b, double fa, double fb, const F& f_of) {
  constexpr double root =
      1e-3;  // f there, of what it is at the nearer end: where it leaps, it is as large
  constexpr int most = 60;
  double x0 = a, x1 = b, f0 = fa, f1 = fb;
  const auto [near, ends] = std::minmax({std::abs(fa), std::abs(fb)});
  const double small = root * std::max(near, root * ends);
  double least = ends;  // |f| so far, not halved
  int same_side = 0;
  const auto root_at = [&](double x) {
    return std::optional(Root{x, std::abs(b - a) * least / std::abs(fa - fb)});
  };
  for (int k = 0; k < most && std::abs(x1 - x0) > 4e-16 * std::abs(x1); ++k) {
    double x = x1 - f1 * (x1 - x0) / (f1 - f0);
    if (!(x > std::min(x0, x1)) || !(x < std::max(x0, x1))) {
      x = 0.5 * (x0 + x1);
      if (!(x > std::min(x0, x1)) || !(x < std::max(x0, x1))) break;
    }
    const double asked = x;
    const std::optional<double> f = f_of(x, least <= small);
    if (!f) return least <= small ? root_at(asked) : std::nullopt;
    if (*f == 0.0) return Root{x, 0.0};
    least = std::min(least, std::abs(*f));
    if (*f * f1 > 0.0) {
      x1 = x, f1 = *f;
      if (++same_side > 1) f0 *= 0.5;
    } else {
      x0 = x1, f0 = f1, x1 = x, f1 = *f;
      same_side = 0;
    }
  }
  if (!(least <= small)) return std::nullopt;
  return root_at(std::abs(f1) < std::abs(f0) ? x1 : x0);
}

class Follower {
 public:
  Follower(const Scene& scene, const CampbellOptions& options)
      : options_(options), scene_(scene), motions_(scene), rotation_(options.rotation) {
    if (!options.at_rest.empty()) rotation_.rests = motions_.nodes_of(options.at_rest);
  }

  CampbellStudy go();

 private:
  struct Found {
    bool ok = false;
    std::vector<Candidate> now;  // by branch
    std::vector<Candidate> all;  // of conjugates one
    std::vector<double> overlaps;
    double growth = 0.0;  // the largest of all motions that were looked at, followed or not [1/s]
    Standing standing;
    bool is_sure_of(std::size_t branch) const { return ok && overlaps[branch] > 0.7; }
    double least() const {
      return overlaps.empty() ? 1.0 : *std::min_element(overlaps.begin(), overlaps.end());
    }
  };

  void turn(double rate) {
    rotation_.rate = rate;
    motions_.turn(rotation_);
  }
  // `beneath`: below the frequencies at the rate before [rad/s], 0 at the first, which tells whether there are free motions, as
  // the spin of a rotor that no drive holds: those are left out.
  std::vector<Candidate> candidates(std::size_t count, double beneath) {
    ModeOptions options;
    options.count = static_cast<int>(count);
    options.expected = beneath;
    options.free_motions = free_motions_;
    if (free_motions_ == FreeMotions::looked_for) free_motions_ = FreeMotions::none;
    std::vector<Candidate> result;
    for (NamedMode& mode : motions_.modes(options)) {
      if (mode.rigid) {
        free_motions_ = FreeMotions::some;
        continue;
      }
      Candidate c;
      c.eigenvalue = mode.eigenvalue;
      c.shape = std::move(mode.shape);
      c.momentum = motions_.motions().mass_times(c.shape);
      c.weight = std::abs(c.shape.dot(c.momentum));
      c.has_orbit = mode.orbit.has_value();
      c.orbit = mode.orbit.value_or(0.0);
      c.round_off = mode.round_off;
      c.name = std::move(mode.name);
      if (c.weight > 0.0) result.push_back(std::move(c));
    }
    return result;
  }
  std::vector<Candidate> begin(double rate);
  void keep(double rate);
  using Orbits = std::optional<std::vector<Orbit>>;
  template <class Acting>
  std::vector<std::string> places_of(const std::vector<Acting>& acting) const;
  void respond();
  Orbits of_forces();
  Orbits of_unbalance();
  std::vector<std::array<double, 2>> resonances(
      double order, const std::vector<CampbellStudy::Response>& responses) const;
  void respond_at_resonances(double order, std::vector<CampbellStudy::Response>& responses,
                             Orbits (Follower::*respond_now)());
  void note_round_off();
  std::optional<Found> found_at(double& next, double rate, const std::vector<Candidate>& last,
                                bool is_smallest);
  void go_through(std::vector<Candidate> last, double& rate);
  void take(double rate, double next, const std::vector<Candidate>& last, const Found& found);
  // `wider`: how often more modes are asked for where one is lost.
  Found follow(const std::vector<Candidate>& last, int wider = 2);
  CampbellPoint point(double rate, const Candidate& c, double overlap) const;
  using EventFunction = double (*)(Complex eigenvalue, double rate);
  std::optional<Root> locate(double a, double b, const std::vector<Candidate>& at_a,
                             const std::vector<Candidate>& at_b, std::size_t branch,
                             EventFunction f_of);
  Standing standing_at(double rate, const std::vector<Candidate>& last) {
    turn(rate);
    return follow(last, 0).standing;
  }
  void standings_between(double a, const Standing& at_a, double b, const Standing& at_b,
                         const std::vector<Candidate>& last, std::vector<Root>& found);
  void look_for_standing(double next, const std::vector<Candidate>& last, const Found& found);
  struct Standstill {
    double below, above;  // rates beside it
  };
  std::optional<Standstill> standstill(double a, double b, double f_a, double f_b,
                                       const Candidate& at_a);
  bool look_between(double a, double b, const std::vector<Candidate>& at_a, const Found& at_b,
                    std::size_t branch);
  std::optional<Complex> slow_one(double rate, const Candidate& last, double fastest);
  void look_at_growth(double rate, double next, const std::vector<Candidate>& last,
                      const Found& found);
  SpecialSpeed limit_of_growth(double rate, double next, const std::vector<Candidate>& last,
                               bool begins, double growth);
  double zero() const { return nothing * fastest_; }  // eigenvalues below are round-off [1/s]
  bool has_special(double from, double to, bool critical) const;
  void refine(double a, double b, const std::vector<Candidate>& at_a, const Found& at_b,
              std::size_t branch);

  const CampbellOptions& options_;
  const Scene& scene_;
  MotionsOfScene motions_;
  SteadyRotation rotation_;
  FreeMotions free_motions_ = FreeMotions::looked_for;
  double fastest_ = 0.0;                 // [1/s] at the first rate
  double least_ = 1.0, least_at_ = 0.0;  // overlap, and the rate there
  double growth_ = 0.0;                  // of the last rate, as of Found
  Standing standing_;                    // of the last rate where it was known, and that rate
  double standing_at_ = 0.0;
  int lost_crossings_ = 0;                     // of zero, by frequencies that were lost on the way
  std::array<double, 2> lost_at_{};            // the first, between these rates
  double components_ = small_component_error;  // the largest error of reductions
  std::string components_note_;
  CampbellStudy study_;
};

// The modes that go on from those of another rate.
Follower::Found Follower::follow(const std::vector<Candidate>& last, int wider) {
  Found found;
  double beneath = fastest_;
  for (const Candidate& c : last)
    if (std::abs(c.eigenvalue) > is_slow * fastest_)
      beneath = std::min(beneath, 0.5 * std::abs(c.eigenvalue));
  const double scale =
      motions_.axes() == ModeAxes::turning ? std::abs(rotation_.rate) + 1e-300 : 1e-300;
  std::size_t count = last.size() + spare;
  for (; wider >= 0; --wider, count *= 2) {
    std::vector<Candidate> all;
    std::vector<Candidate> these = candidates(count, beneath);
    found.standing = standing_of(these, zero());
    for (const Candidate& c : these) {
      all.push_back(c);
      all.push_back(c.conjugate());
    }
    struct Match {
      double score, overlap;
      std::size_t branch, candidate;
    };
    std::vector<Match> matches;
    for (std::size_t b = 0; b < last.size(); ++b)
      for (std::size_t c = 0; c < all.size(); ++c) {
        const double overlap = last[b].overlap(all[c]);
        // In turning axes frequencies change as the rate does. (Of a shape that circles there are two, w - W and -w - W.)
        const double apart = std::abs(last[b].eigenvalue - all[c].eigenvalue) /
                             (std::abs(last[b].eigenvalue) + std::abs(all[c].eigenvalue) + scale);
        matches.push_back({overlap - 0.1 * apart, overlap, b, c});
      }
    std::stable_sort(matches.begin(), matches.end(),
                     [](const Match& a, const Match& b) { return a.score > b.score; });
    found.now.assign(last.size(), {});
    found.overlaps.assign(last.size(), 0.0);
    std::vector<char> has(last.size(), 0), taken(all.size() / 2, 0);
    for (const Match& match : matches) {
      if (has[match.branch] != 0 || taken[match.candidate / 2] != 0) continue;
      has[match.branch] = taken[match.candidate / 2] = 1;
      found.now[match.branch] = all[match.candidate];
      found.overlaps[match.branch] = match.overlap;
    }
    found.growth = 0.0;
    for (const Candidate& c : all) found.growth = std::max(found.growth, c.growth());
    found.all = std::move(these);
    found.ok = std::all_of(has.begin(), has.end(), [](char one) { return one != 0; });
    if (found.ok && found.least() > lost) break;
  }
  return found;
}

CampbellPoint Follower::point(double rate, const Candidate& c, double overlap) const {
  CampbellPoint p;
  p.rate = rate;
  p.eigenvalue = c.eigenvalue;
  p.orbit = c.orbit;
  p.overlap = overlap;
  p.has_orbit = c.has_orbit;
  p.round_off = c.round_off;
  const double sense = c.orbit > 0.0 ? 1.0 : -1.0;
  if (motions_.axes() == ModeAxes::resting) {
    if (c.has_orbit) p.inertial = sense * c.eigenvalue.imag();
  } else if (c.has_orbit && std::abs(c.orbit) > rather_round) {
    p.inertial = sense * c.eigenvalue.imag() + rate;
  }
  return p;
}

// From one that swings, through two that are real, to the one of them that is zero: without a leap.
double standing_of(Complex l) {
  if (!oscillates(l)) return l.real();
  return l.real() > is_growth * std::abs(l) ? std::abs(l) : -std::abs(l);
}

double frequency_of(Complex l, double) { return l.imag(); }

// Whether a critical speed, or one where stability changes, lies between, and where.
void Follower::refine(double a, double b, const std::vector<Candidate>& at_a, const Found& found,
                      std::size_t branch) {
  const std::vector<Candidate>& at_b = found.now;
  const Complex la = at_a[branch].eigenvalue, lb = at_b[branch].eigenvalue;
  const double size = std::max(std::abs(la), std::abs(lb));
  using F = EventFunction;
  struct Event {
    SpecialSpeed::Kind kind;
    F f;
  };
  std::vector<Event> events;
  const F synchronous = [](Complex l, double rate) { return std::abs(l.imag()) - rate; };
  const F standing = [](Complex l, double) { return standing_of(l); };
  const bool is_counted =
      standing_.is_known && found.standing.is_known && standing_.growing != found.standing.growing;
  const F growth = [](Complex l, double) { return l.real(); };
  if (motions_.axes() == ModeAxes::resting) {
    if (at_a[branch].has_orbit && synchronous(la, a) * synchronous(lb, b) < 0.0)
      events.push_back({SpecialSpeed::Kind::critical, synchronous});
  } else if (std::abs(lb) <= zero() && std::abs(la) > zero()) {
    study_.special.push_back({SpecialSpeed::Kind::critical, b, branch});
  } else if (oscillates(la) && oscillates(lb) && la.imag() * lb.imag() < 0.0) {
    events.push_back({SpecialSpeed::Kind::critical, frequency_of});
  } else if (!is_counted && !(oscillates(la) && oscillates(lb)) &&
             standing_of(la) * standing_of(lb) < 0.0) {
    events.push_back({SpecialSpeed::Kind::critical, standing});
  }
  if (la.real() * lb.real() < 0.0 &&
      std::max(std::abs(la.real()), std::abs(lb.real())) > is_growth * size &&
      std::min(std::abs(la.real()), std::abs(lb.real())) > nothing * size && oscillates(la) &&
      oscillates(lb))
    events.push_back(
        {la.real() < 0.0 ? SpecialSpeed::Kind::unstable_above : SpecialSpeed::Kind::stable_above,
         growth});
  for (const Event& event : events) {
    const std::optional<Root> at = locate(a, b, at_a, at_b, branch, event.f);
    constexpr double narrow = 1e-9, believed = 1e-5;
    const bool is_known = at && at->unknown <= narrow * at->x;
    if (event.f == frequency_of && !is_known && look_between(a, b, at_a, found, branch)) continue;
    if (!at || (event.f == frequency_of && !(at->unknown <= believed * at->x))) {
      if (event.f == frequency_of && lost_crossings_++ == 0) lost_at_ = {a, b};
      continue;
    }
    SpecialSpeed special{event.kind, at->x, branch};
    // What is unknown of l^2, or of growth, over how it changes with the rate.
    const double unknown = at_b[branch].round_off;
    special.round_off =
        event.kind == SpecialSpeed::Kind::critical
            ? unknown * std::norm(lb / special.rate)
            : unknown * std::abs(lb) * std::abs((b - a) / (lb.real() - la.real()) / special.rate);
    special.round_off = std::max(special.round_off, at->unknown / special.rate);
    study_.special.push_back(special);
  }
}

// The root of f of a branch's eigenvalue between two rates, to round-off; none where f leaps over zero, because the branch goes
// over to another mode.
std::optional<Root> Follower::locate(double a, double b, const std::vector<Candidate>& at_a,
                                     const std::vector<Candidate>& at_b, std::size_t branch,
                                     EventFunction f_of) {
  // Of the way to the end: a mode that is at rest has no whirl, and is looked for beside that.
  constexpr double beside = 1e-4;
  std::vector<Candidate> from = at_a;
  bool was_aside = false;
  const double f_a = f_of(at_a[branch].eigenvalue, a), f_b = f_of(at_b[branch].eigenvalue, b);
  const double ends = std::max(std::abs(f_a), std::abs(f_b));
  const bool is_frequency = f_of == frequency_of;
  const auto f = [&](double& x, bool is_root) -> std::optional<double> {
    turn(x);
    Found found = follow(from);
    if (!found.is_sure_of(branch)) {
      if (was_aside && is_root) return std::nullopt;
      was_aside = true;
      x += beside * (b - x);
      turn(x);
      found = follow(from);
      if (!found.is_sure_of(branch)) return std::nullopt;
    }
    // Zero over an interval, or another mode: look_between().
    const Complex l = found.now[branch].eigenvalue;
    const double f_now = f_of(l, x);
    if (is_frequency && (!oscillates(l) || std::abs(f_now) > ends)) return std::nullopt;
    from = found.now;
    return f_now;
  };
  return root_between(a, b, f_a, f_b, f);
}

bool Follower::has_special(double from, double to, bool critical) const {
  return std::ranges::any_of(study_.special, [&](const SpecialSpeed& one) {
    return (one.kind == SpecialSpeed::Kind::critical) == critical && one.rate >= from &&
           one.rate <= to;
  });
}

// Rates between `a` and `b` where real eigenvalues go through zero, each as often as there are of them. Where two that swing and
// grow become two that do not, their number changes as well, but nothing is zero.
void Follower::standings_between(double a, const Standing& at_a, double b, const Standing& at_b,
                                 const std::vector<Candidate>& last, std::vector<Root>& found) {
  constexpr double apart = 1e-9;    // of the rate: beneath it they are one
  constexpr double is_zero = 1e-6;  // a product of two, of the largest frequency's square
  const int passed = std::abs(at_b.growing - at_a.growing);
  if (passed == 0) return;
  if (passed == 1) {
    const auto f = [&](double& x, bool) -> std::optional<double> {
      const Standing here = standing_at(x, last);
      return here.growing == at_a.growing ? here.product : -here.product;
    };
    const std::optional<Root> at = root_between(a, b, at_a.product, -at_b.product, f);
    const double round_off = std::max(at_a.round_off, at_b.round_off);
    if (at) found.push_back({at->x, std::max(at->unknown, round_off * (b - a))});
    return;
  }
  const double middle = 0.5 * (a + b);
  if (b - a <= apart * b) {
    if (std::min(at_a.product, at_b.product) <= is_zero * fastest_ * fastest_)
      found.insert(found.end(), static_cast<std::size_t>(passed), Root{middle, b - a});
    return;
  }
  const Standing between = standing_at(middle, last);
  standings_between(a, at_a, middle, between, last, found);
  standings_between(middle, between, b, at_b, last, found);
}

// By the number of real eigenvalues, so that none is missed where modes that are alike change places.
void Follower::look_for_standing(double next, const std::vector<Candidate>& last,
                                 const Found& found) {
  if (motions_.axes() == ModeAxes::resting || !found.standing.is_known) return;
  const Standing was = std::exchange(standing_, found.standing);
  const double from = std::exchange(standing_at_, next);
  if (!was.is_known || was.growing == standing_.growing) return;
  std::vector<Root> roots;
  standings_between(from, was, next, standing_, last, roots);
  // Of those that go through zero, and of the others, the slowest first.
  std::vector<std::size_t> order(found.now.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto rank = [&](std::size_t b) {
    const Complex before = last[b].eigenvalue, now = found.now[b].eigenvalue;
    return std::pair(standing_of(before) * standing_of(now) > 0.0, std::abs(now));
  };
  std::ranges::sort(order, {}, rank);
  for (std::size_t k = 0; k < roots.size(); ++k)
    study_.special.push_back({SpecialSpeed::Kind::critical, roots[k].x,
                              order[std::min(k, order.size() - 1)], roots[k].unknown / roots[k].x});
}

// The eigenvalue of a branch that goes through zero, by its shape, among those that are not faster than it was.
std::optional<Complex> Follower::slow_one(double rate, const Candidate& last, double fastest) {
  turn(rate);
  const Found found = follow({last}, 0);
  std::optional<Complex> result;
  double most = lost;
  for (const Candidate& c : found.all) {
    if (std::abs(c.eigenvalue) > fastest) continue;
    const double with = last.overlap(c), against = last.overlap(c.conjugate());
    if (std::max(with, against) <= most) continue;
    most = std::max(with, against);
    result = with >= against ? c.eigenvalue : std::conj(c.eigenvalue);
  }
  return result;
}

// Where the frequency of a branch is zero between two rates, at which it is f_a and f_b; none where it leaps over zero.
std::optional<Follower::Standstill> Follower::standstill(double a, double b, double f_a, double f_b,
                                                         const Candidate& at_a) {
  constexpr double small = 1e-2, nearly = 1e-5;  // of the frequency at the ends
  constexpr int most = 80;
  const double ends = std::max(std::abs(f_a), std::abs(f_b));
  const auto eigenvalue = [&](double x) { return slow_one(x, at_a, 1.1 * ends); };
  double below = a, above = b, f_below = f_a, f_above = f_b;
  const auto is_above = [&](double part) {
    return std::max(std::abs(f_below), std::abs(f_above)) > part * ends;
  };
  std::optional<double> inside;
  for (int k = 0; k < most && !inside && above - below > narrow_rate * above; ++k) {
    const double share = k % 2 == 0 ? f_below / (f_below - f_above) : 0.5;
    const double x = below + std::clamp(share, 0.01, 0.99) * (above - below);
    const std::optional<Complex> l = eigenvalue(x);
    if (!l) return std::nullopt;
    if (!oscillates(*l))
      inside = x;
    else if ((l->imag() > 0.0) == (f_below > 0.0))
      below = x, f_below = l->imag();
    else
      above = x, f_above = l->imag();
    if (above - below < small * (b - a) && is_above(0.5)) return std::nullopt;
  }
  const auto come_near = [&](double& edge, double& f) {
    for (double in = *inside; std::abs(in - edge) > 1e-3 * one_rate * in;) {
      const double x = 0.5 * (in + edge);
      const std::optional<Complex> l = eigenvalue(x);
      if (l && oscillates(*l))
        edge = x, f = l->imag();
      else
        in = x;
    }
  };
  if (inside) come_near(below, f_below), come_near(above, f_above);
  if (is_above(inside ? small : nearly)) return std::nullopt;
  return Standstill{below, above};
}

// A frequency goes through zero, and the motion is lost on the way: that of a shaft that is nearly alike in both planes is zero
// over an interval, with two eigenvalues that are real, one of which is positive there.
bool Follower::look_between(double a, double b, const std::vector<Candidate>& at_a,
                            const Found& at_b, std::size_t branch) {
  const std::optional<Standstill> zero = standstill(
      a, b, at_a[branch].eigenvalue.imag(), at_b.now[branch].eigenvalue.imag(), at_a[branch]);
  if (!zero) return false;
  const double middle = 0.5 * (zero->below + zero->above), width = zero->above - zero->below;
  const Standing at_start = standing_at(a, at_a), between = standing_at(middle, at_a);
  std::vector<Root> roots;
  if (width > one_rate * middle && at_start.growing == at_b.standing.growing) {
    standings_between(a, at_start, middle, between, at_a, roots);
    standings_between(middle, between, b, at_b.standing, at_a, roots);
  }
  const bool grows_between = !roots.empty();
  if (!grows_between) roots.push_back({middle, std::max(0.5 * width, narrow_rate * middle)});
  // Another branch that is alike has found them.
  std::erase_if(roots, [&](const Root& root) {
    const double same = std::max(one_rate * root.x, 3.0 * root.unknown);
    return has_special(root.x - same, root.x + same, true);
  });
  for (const Root& root : roots) {
    study_.special.push_back({SpecialSpeed::Kind::critical, root.x, branch, root.unknown / root.x});
    const double same = one_rate * root.x;
    if (!grows_between || growth_ > 0.0 || at_b.growth > 0.0 ||  // look_at_growth()
        has_special(root.x - same, root.x + same, false))
      continue;
    study_.special.push_back(
        {root.x < middle ? SpecialSpeed::Kind::unstable_above : SpecialSpeed::Kind::stable_above,
         root.x, branch, root.unknown / root.x});
  }
  return true;
}

// Where growth begins or ends between two rates, one of which has `growth` [1/s]: at a critical speed between them, or else by halving.
SpecialSpeed Follower::limit_of_growth(double rate, double next, const std::vector<Candidate>& last,
                                       bool begins, double growth) {
  const auto is_below = [&](double x) {
    turn(x);
    const bool grows = follow(last, 0).growth > 0.0;
    return grows != begins;
  };
  double a = rate, b = next;
  for (const SpecialSpeed& one : study_.special) {
    const double beside = std::max(1e-6, 3.0 * one.round_off) * one.rate;
    if (one.kind == SpecialSpeed::Kind::critical && one.rate - beside > a &&
        one.rate + beside < b && is_below(one.rate - beside) && !is_below(one.rate + beside))
      return one;
  }
  constexpr double narrow = 1e-10;
  while (b - a > narrow * b) {
    const double x = 0.5 * (a + b);
    (is_below(x) ? a : b) = x;
  }
  // Growth that rises evenly from zero is seen a little later.
  turn(begins ? b : a);
  const double seen = follow(last, 0).growth,
               rises = begins ? (growth - seen) / (next - b) : (growth - seen) / (a - rate);
  const double late = rises > 0.0 ? seen / rises : 0.0;
  const double at = 0.5 * (a + b);
  return {.rate = at,
          .branch = study_.branches.size(),
          .round_off = std::max(narrow, std::min(late, next - rate) / at)};
}

// Limits of stability other than those of modes that swing on both sides: motions that go away without swinging, two that swing
// and meet, and motions that are followed by nobody.
void Follower::look_at_growth(double rate, double next, const std::vector<Candidate>& last,
                              const Found& found) {
  const bool was = growth_ > 0.0, is = found.growth > 0.0;
  const double largest = std::max(growth_, found.growth);
  growth_ = found.growth;
  if (was == is || has_special(rate, next, false)) return;
  SpecialSpeed limit = limit_of_growth(rate, next, last, is, largest);
  limit.kind = is ? SpecialSpeed::Kind::unstable_above : SpecialSpeed::Kind::stable_above;
  if (limit.branch == study_.branches.size()) {
    const std::vector<Candidate>& growing = is ? found.now : last;
    const auto fastest = std::ranges::max_element(growing, {}, &Candidate::growth);
    if (fastest->growth() > 0.5 * largest)
      limit.branch = static_cast<std::size_t>(fastest - growing.begin());
  }
  if (limit.branch < study_.branches.size()) {
    study_.special.push_back(limit);
    return;
  }
  study_.notes.push_back(fmt::format(
      "at {:.6g} rad/s a motion that is none of those followed {} to grow (by {:.4g} 1/s at the "
      "rate beside): follow more modes to see which",
      limit.rate, is ? "begins" : "ceases", largest));
}

std::vector<Candidate> Follower::begin(double rate) {
  study_.model = scene_.name;
  study_.file = scene_.file;
  study_.rotation = options_.rotation;
  study_.order = options_.order;
  study_.notes = motions_.notes();
  for (const std::string& place : places_of(options_.forces))
    if (!options_.forces.empty()) study_.force_responses.push_back({place, {}});
  for (const std::string& place : places_of(options_.unbalance))
    if (!options_.unbalance.empty()) study_.responses.push_back({place, {}});
  if (rate > options_.from)
    study_.notes.push_back(
        fmt::format("begins at {:.6g} rad/s: at rest, modes that are alike in all directions have "
                    "no whirl",
                    rate));
  turn(rate);
  study_.axes = motions_.axes();
  const auto count = static_cast<std::size_t>(options_.count);
  std::vector<Candidate> first = candidates(count + spare, 0.0);
  if (first.empty())
    throw Error(scene_.source, "nothing but free motions: there are no modes to follow");
  double fastest = 0.0;
  for (const Candidate& c : first) {
    growth_ = std::max(growth_, c.growth());
    fastest = std::max(fastest, std::abs(c.eigenvalue));
  }
  standing_ = standing_of(first, nothing * fastest);
  standing_at_ = rate;
  if (first.size() > count) first.resize(count);
  for (const Candidate& c : first) {
    fastest_ = std::max(fastest_, std::abs(c.eigenvalue));
    study_.branches.push_back({c.name, {point(rate, c, 1.0)}});
  }
  keep(rate);
  return first;
}

// Turns there already; what is assembled is not used after it.
void Follower::keep(double rate) {
  study_.rates.push_back(rate);
  study_.displacements.push_back(motions_.largest_displacement().first);
  std::string why;
  if (const double error = motions_.error_of_components(&why); error > components_) {
    components_ = error;
    components_note_ = fmt::format("at {:.6g} rad/s {}", rate, why);
  }
  respond();
}

// At the places where something acts, each once, and those that are asked for.
template <class Acting>
std::vector<std::string> Follower::places_of(const std::vector<Acting>& acting) const {
  std::vector<std::string> places, each;
  for (const Acting& one : acting) places.push_back(one.place);
  places.insert(places.end(), options_.probes.begin(), options_.probes.end());
  for (const std::string& place : places)
    if (std::find(each.begin(), each.end(), place) == each.end()) each.push_back(place);
  return each;
}

// At the present rate. Forces first: they move what another response may hold.
void Follower::respond() {
  const auto add = [](std::vector<CampbellStudy::Response>& responses, const Orbits& orbits) {
    for (std::size_t k = 0; orbits && k < responses.size(); ++k)
      responses[k].orbits.push_back((*orbits)[k]);
  };
  if (!options_.forces.empty()) add(study_.force_responses, of_forces());
  if (!options_.unbalance.empty()) add(study_.responses, of_unbalance());
}

Follower::Orbits Follower::of_forces() {
  return response_to_forces(motions_, rotation_, options_.forces, options_.order,
                            places_of(options_.forces));
}
Follower::Orbits Follower::of_unbalance() {
  return response_to_unbalance(motions_, rotation_, options_.unbalance,
                               places_of(options_.unbalance));
}

// Intervals of rates with a resonance in them: where a mode has the frequency of what acts, or a response is larger than at the
// rates beside.
std::vector<std::array<double, 2>> Follower::resonances(
    double order, const std::vector<CampbellStudy::Response>& responses) const {
  std::vector<std::array<double, 2>> found;
  for (const CampbellBranch& branch : study_.branches)
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      const auto beyond = [&](const CampbellPoint& p) {
        const double frequency = motions_.axes() == ModeAxes::resting ? p.eigenvalue.imag()
                                 : p.inertial.has_value()             ? *p.inertial
                                                          : p.rate + p.eigenvalue.imag();
        return std::abs(frequency) > order * p.rate;
      };
      const CampbellPoint &a = branch.points[i - 1], &b = branch.points[i];
      if (beyond(a) != beyond(b)) found.push_back({a.rate, b.rate});
    }
  for (const SpecialSpeed& special : study_.special) {
    const auto above = std::ranges::upper_bound(study_.rates, special.rate);
    if (order == 1.0 && above != study_.rates.end() && above != study_.rates.begin())
      found.push_back({*std::prev(above), *above});
  }
  for (const CampbellStudy::Response& response : responses)
    for (std::size_t i = 1; i + 1 < response.orbits.size(); ++i) {
      const Orbit* const at = &response.orbits[i];
      if (at->major() >= at[-1].major() && at->major() >= at[1].major())
        found.push_back({at[-1].rate, at[1].rate});
    }
  std::ranges::sort(found);
  const auto is_same = [](const auto& a, const auto& b) {
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) < 1e-9 * b[1];
  };
  found.erase(std::unique(found.begin(), found.end(), is_same), found.end());
  return found;
}

// Resonances are far narrower than steps between rates: each response is followed to the top of its own, by the golden
// section; what that passes belongs to the response.
void Follower::respond_at_resonances(double order, std::vector<CampbellStudy::Response>& responses,
                                     Orbits (Follower::*respond_now)()) {
  constexpr double golden = 0.6180339887498949;
  constexpr int most = 40;
  const std::vector<std::array<double, 2>> intervals = resonances(order, responses);
  std::map<double, Orbits> known;
  std::set<double> without;  // where no steady rotation is found
  const auto at = [&](double rate, std::size_t k) {
    const auto [it, is_new] = known.try_emplace(rate);
    if (is_new) {
      stop::check();
      try {
        turn(rate);
        it->second = (this->*respond_now)();
      } catch (const Stopped&) {
        throw;
      } catch (const Error&) {
        without.insert(rate);
      }
    }
    if (it->second) return (*it->second)[k].major();
    return without.contains(rate) ? 0.0 : std::numeric_limits<double>::infinity();
  };
  for (const auto& [first, last] : intervals)
    for (std::size_t k = 0; k < responses.size(); ++k) {
      double a = first, b = last, x = b - golden * (b - a), y = a + golden * (b - a);
      double f = at(x, k), g = at(y, k);
      for (int i = 0; i < most && b - a > 1e-9 * b; ++i) {
        if (f > g) {
          b = y, y = x, g = f, x = b - golden * (b - a), f = at(x, k);
        } else {
          a = x, x = y, f = g, y = a + golden * (b - a), g = at(y, k);
        }
      }
    }
  for (std::size_t k = 0; k < responses.size(); ++k) {
    for (const auto& [rate, orbits] : known)
      if (orbits) responses[k].orbits.push_back((*orbits)[k]);
    std::ranges::sort(responses[k].orbits, {}, &Orbit::rate);
  }
}

// The modes at `next`, or, where they are not found or in a smallest step not told from each other (at a critical speed one is at
// rest and has no whirl), beside it, that go on from those at `rate`; none, with a note, where that ends.
std::optional<Follower::Found> Follower::found_at(double& next, double rate,
                                                  const std::vector<Candidate>& last,
                                                  bool is_smallest) {
  try {
    turn(next);
    Found found = follow(last);
    if (!found.ok || (is_smallest && found.least() < sure)) {
      const double other = next - aside * (next - rate);
      turn(other);
      Found beside = follow(last);
      if (beside.ok && (!found.ok || beside.least() > found.least())) {
        next = other;
        found = std::move(beside);
      }
    }
    if (found.ok) return found;
    study_.notes.push_back(fmt::format("ends at {:.6g} rad/s: modes are lost there", rate));
  } catch (const Stopped&) {
    throw;
  } catch (const Error& error) {
    if (study_.rates.size() == 1) throw;  // a diagram of one rate is none
    study_.notes.push_back(fmt::format("ends at {:.6g} rad/s: {}", rate, error.what()));
  }
  return std::nullopt;
}

// Whole, or, interrupted, not at all.
void Follower::take(double rate, double next, const std::vector<Candidate>& last,
                    const Found& found) {
  const auto look = [&](const auto& at) {
    try {
      at();
    } catch (const Stopped&) {
      throw;
    } catch (const Error& error) {
      study_.notes.push_back(error.what());
    }
  };
  for (std::size_t b = 0; b < last.size(); ++b) look([&] { refine(rate, next, last, found, b); });
  look([&] { look_for_standing(next, last, found); });
  look([&] { look_at_growth(rate, next, last, found); });
  turn(next);
  for (std::size_t b = 0; b < last.size(); ++b)
    study_.branches[b].points.push_back(point(next, found.now[b], found.overlaps[b]));
  keep(next);
}

// Steps from `rate` to where the points are, halved where modes change quickly; `rate` is the last that was taken.
void Follower::go_through(std::vector<Candidate> last, double& rate) {
  const double range = options_.to - options_.from;
  const int intervals = std::max(1, options_.points - 1);
  const double between = range / intervals;
  double step = between;
  for (int k = 1; k < options_.points;) {
    stop::check();
    const double goal = options_.from + range * k / intervals;
    const bool reaches = !(rate + step < goal * (1.0 - 1e-12));
    double next = reaches ? goal : rate + step;
    const bool is_smallest = step <= smallest_step * between;
    std::optional<Found> found = found_at(next, rate, last, is_smallest);
    if (!found) return;
    if (found->least() < sure && !is_smallest) {
      step *= 0.5;
      turn(rate);
      continue;
    }
    if (found->least() < least_) least_ = found->least(), least_at_ = next;
    take(rate, next, last, *found);
    step = reaches ? between : 2.0 * step;
    if (reaches) {
      ++k;
      if (options_.progress)
        options_.progress(static_cast<std::size_t>(k), static_cast<std::size_t>(options_.points));
    }
    rate = next;
    last = std::move(found->now);
  }
}

// Where digits are lost that a reader would believe.
void Follower::note_round_off() {
  constexpr double believed = 1e-6;
  double worst = believed;
  std::size_t branch = study_.branches.size();
  for (std::size_t b = 0; b < study_.branches.size(); ++b)
    for (const CampbellPoint& p : study_.branches[b].points)
      if (p.round_off > worst) worst = p.round_off, branch = b;
  if (branch < study_.branches.size())
    study_.notes.push_back(fmt::format(
        "round-off leaves about {:.0e} of mode {} unknown, in whose stiffness nearly all cancels: "
        "fewer elements, of a higher order, keep more digits",
        worst, branch + 1));
}

CampbellStudy Follower::go() {
  double rate = std::max(options_.from, first_rate * (options_.to - options_.from));
  std::vector<Candidate> first = begin(rate);
  try {
    go_through(std::move(first), rate);
    respond_at_resonances(options_.order, study_.force_responses, &Follower::of_forces);
    respond_at_resonances(1.0, study_.responses, &Follower::of_unbalance);
  } catch (const Stopped&) {
    study_.notes.push_back(fmt::format("interrupted at {:.6g} rad/s", rate));
  }
  if (least_ < sure)
    study_.notes.push_back(fmt::format(
        "the overlap of a mode with itself a step before falls to {:.2f} at {:.6g} rad/s: which is "
        "which is not sure there",
        least_, least_at_));
  if (lost_crossings_ > 0)
    study_.notes.push_back(
        fmt::format("between {:.6g} and {:.6g} rad/s a frequency changes its sign where modes that "
                    "are alike are "
                    "not told from each other{}: a critical speed may be missed there",
                    lost_at_[0], lost_at_[1],
                    lost_crossings_ > 1 ? fmt::format(", and {} times more", lost_crossings_ - 1)
                                        : std::string()));
  note_round_off();
  if (!components_note_.empty()) study_.notes.push_back(components_note_);
  std::stable_sort(study_.special.begin(), study_.special.end(),
                   [](const SpecialSpeed& a, const SpecialSpeed& b) { return a.rate < b.rate; });
  return std::move(study_);
}

}  // namespace

CampbellStudy study_campbell(const Scene& scene, const CampbellOptions& options) {
  require_rising(options);
  if (!options.probes.empty() && options.unbalance.empty() && options.forces.empty())
    throw Error("a response is asked for, and there is no unbalance and no force");
  if (!(options.order > 0.0) || !std::isfinite(options.order))
    throw Error("the order of forces: give a positive number");
  if (options.points < 2 || options.count < 1)
    throw Error("a Campbell diagram needs two points and one mode at least");
  const stop::Scope scope(options.interrupted);
  return Follower(scene, options).go();
}

}  // namespace mbd
