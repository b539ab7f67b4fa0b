#include "solvers/statics/path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "libmbd/core/stop.hpp"
#include "solvers/constraints/redundancy.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/newton/root.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "solvers/statics/nearest_modes.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {
namespace {

constexpr double most_turn = 0.5;  // [rad] of the tangent in a step; steps aim at half of it
constexpr int easy_iterations = 6, most_easy = 9;  // of the corrector: steps grow, stay
constexpr double located = 1e-6;  // what remains of a root's bracket, of the step's
// A root of what is continuous, not a pole: what is left there, of its change. Its bracket is at round-off; t_mu is
// known to 1e-5 where shear is 1e9 times as stiff as bending.
constexpr double continuous = 1e-4;
constexpr double no_jump = 1e-4;   // of the eigenvalue at a root's bracket, of that at the ends
constexpr double balanced = 1e-8;  // force along a mode, of the change of its eigenvalue
constexpr double most_first_steps = 20.0;  // of the load, in a step that moves nothing
constexpr int most_halvings = 10;          // of a step in which an event could not be located
constexpr int most_leaps = 4;
constexpr double most_of_a_leap =
    0.5;                           // of the motion of a step, that its tangents do not foretell
constexpr int most_refused = 8;    // steps in a row, for that
constexpr int most_in_a_step = 8;  // singular points
constexpr double on_value = 1e-9;  // of a crossing's change in a step
constexpr double smallest_step = 1e-9;  // of max_step
constexpr double corner_step = 1e-5;    // below which a step that turns too far does so at a corner
constexpr double largest_rotation = 1.0;  // [rad] of a corrector's increment

class Follower {
 public:
  Follower(const System& system, LinearSolver& solver, const PathOptions& options)
      : system_(system),
        options_(options),
        plain_(solver),
        bordered_(solver.another()),
        n_(system.unknowns()),
        w_(motion_weights(system)) {
    plain_.analyze(system.graph());
    BlockGraph graph = system.graph();
    const auto blocks = static_cast<int>(graph.blocks.size());
    graph.blocks.push_back({1, BlockGraph::Kind::multiplier});
    border_ = graph.contributions.size();
    for (int b = 0; b < blocks; ++b) {
      graph.contributions.push_back({b, blocks});
      graph.contributions.push_back({blocks, b});
    }
    graph.contributions.push_back({blocks, blocks});
    bordered_->analyze(graph);
    if (options.has_potential) stability_.emplace(system);
  }

  PathReport go(State& state) {
    state.load_factor = 0.0;
    MixedIterate mixed;
    NeutralMotions neutral;
    if (!find_equilibrium(system_, plain_, options_.newton, state, report_.counters,
                          report_.failure, &neutral, &mixed)) {
      report_.failure = "there is no equilibrium without load to start from: " + report_.failure;
      return std::move(report_);
    }
    system_.follow_angles(state);
    Point start;
    start.state = state;
    start.resultants = std::move(mixed.resultants);
    hold(start.state, neutral);
    if (!first_tangent(start)) return std::move(report_);
    if (!index_at_start(start)) return std::move(report_);
    if (!accept(start, PathEvent::none, 0)) return std::move(report_);
    last_ = start.state;
    if (options_.direction != PathDirection::backward) trace(start, 0, "");
    if (going_ && options_.direction != PathDirection::forward) {
      Point back = start;
      if (options_.direction == PathDirection::both) {
        back.tangent = -back.tangent;
        if (!index_at_start(back)) return std::move(report_);
        if (!accept(back, PathEvent::none, -1)) return std::move(report_);
      }
      trace(back, -1, options_.direction == PathDirection::both ? "backward " : "");
    }
    if (going_ && options_.branch != 0) follow_branch();
    state = last_;
    report_.complete = report_.failure.empty();
    if (stability_) report_.asymmetry = asymmetry_;
    return std::move(report_);
  }

 private:
  struct Point {
    State state;
    std::vector<Vec6> resultants;
    VecX tangent;  // of (U, lambda, mu), n_ + 1
    VecX bend;     // how it changed over the last step, per measure; empty if not known
    std::vector<Vec6> bend_of_resultants;  // the same of how resultants change along the tangent
    double arc = 0.0;
    std::optional<Index>
        index;  // negative eigenvalues; without a potential modes that went through zero
    std::shared_ptr<const NearestModes> modes;  // without a potential
    bool is_branching = false;                  // a bifurcation, left in the direction of its mode
  };
  struct Bifurcation {
    Point point;
    VecX mode;
    Index branches = 1;  // as many as eigenvalues that change their sign there
  };
  struct Event {
    double h;
    PathEvent kind;
    bool stops;
    Point point;
    VecX mode;
    std::optional<Index> before, after;
  };

  double dot(const VecX& a, const VecX& b) const {
    return a.head(n_).dot(w_.cwiseProduct(b.head(n_))) + c2_ * a(n_) * b(n_);
  }

  // What nothing answers and loads do not drive would make tangents singular.
  void hold(const State& start, const NeutralMotions& neutral) {
    if (drives(system_, start, neutral) || !lead_along_equilibria(system_, plain_, start, neutral))
      return;
    holds_ = holds_of(w_, neutral);
    for (Index i = 0; i < neutral.count(); ++i)
      report_.neutral.push_back(name_of_motion(system_, neutral.shapes.col(i)));
  }

  static std::span<double> span(VecX& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

  // r and the matrix of (1) at a state; of a corrector with its resultants.
  bool factor_bordered(const State& state, const VecX& normal, VecX& r,
                       std::span<const Vec6> resultants = {}) {
    system_.linearize_mixed(state, resultants, r, *bordered_);
    add_holds(system_, bordered_->slots(), holds_);
    system_.load_rate(state, rate_);
    count_tangent();
    const std::span<const Slot> slots = bordered_->slots();
    const BlockGraph& graph = system_.graph();
    Index at = 0;
    for (std::size_t b = 0; b < graph.blocks.size(); ++b) {
      const Slot& column = slots[border_ + 2 * b];
      const Slot& row = slots[border_ + 2 * b + 1];
      for (int i = 0; i < graph.blocks[b].size; ++i, ++at) {
        column.data[i] = rate_(6 + at);
        row.data[i * row.ld] = w_(at) * normal(at);
      }
    }
    *slots[border_ + 2 * graph.blocks.size()].data = c2_ * normal(n_);
    stiffness_ = largest_stiffness_behind(system_, bordered_->slots());
    return bordered_->factor() == FactorStatus::ok;
  }

  void count_tangent() {
    ++report_.counters.residuals;
    ++report_.counters.tangents;
    ++report_.counters.factorizations;
  }

  bool first_tangent(Point& start) {
    VecX r;
    system_.linearize(start.state, {}, r, plain_);
    add_holds(system_, plain_.slots(), holds_);
    system_.load_rate(start.state, rate_);
    count_tangent();
    if (plain_.factor() != FactorStatus::ok) {
      report_.failure = "the tangent is singular at the start: the structure can move freely";
      return false;
    }
    VecX z = -rate_.tail(n_);
    if (z.cwiseAbs().maxCoeff() == 0.0) {
      report_.failure = "no load and no prescribed motion grows with the load factor";
      return false;
    }
    plain_.solve(span(z));
    c2_ = z.dot(w_.cwiseProduct(z));
    if (!std::isfinite(c2_)) {
      report_.failure = "the tangent is singular at the start: the structure can move freely";
      return false;
    }
    // Where the loads hardly move anything, as along a straight column, a step is one of the load.
    const double least = options_.max_step / (most_first_steps * options_.step);
    c2_ = std::max(c2_, least * least);
    start.tangent.resize(n_ + 1);
    start.tangent << z, 1.0;
    start.tangent /= std::sqrt(dot(start.tangent, start.tangent));
    if (options_.direction == PathDirection::backward) start.tangent = -start.tangent;
    return true;
  }

  bool index_at_start(Point& start) {
    const VecX ahead = start.tangent;
    if (!tangent(start, ahead)) {
      report_.failure = "the tangent is singular at the start: the structure can move freely";
      return false;
    }
    start.index = index(start);
    return true;
  }

  bool tangent(Point& point, const VecX& before) {
    VecX r;
    if (!factor_bordered(point.state, before, r, point.resultants)) return false;
    point.tangent = VecX::Zero(n_ + 1);
    point.tangent(n_) = 1.0;
    bordered_->solve(span(point.tangent));
    const double size = std::sqrt(dot(point.tangent, point.tangent));
    if (!std::isfinite(size) || size == 0.0) return false;
    point.tangent /= size;
    return true;
  }

  // Of a point, or where there is no potential that of the point `beside` it and what has changed since.
  std::optional<Index> index(Point& point, const Point* beside = nullptr) {
    ++report_.counters.tangents;
    if (!stability_) return index_beside(point, beside);
    const std::optional<Index> count = (*stability_)(point.state, holds_, point.resultants);
    asymmetry_ = std::max(asymmetry_, stability_->asymmetry());
    return count;
  }

  // Where modes cannot be matched the sign of the determinant has to do, and told_ becomes false.
  std::optional<Index> index_beside(Point& point, const Point* beside) {
    ++report_.counters.factorizations;
    std::optional<NearestModes> modes =
        nearest_modes(system_, plain_, point.state, point.resultants, holds_);
    if (!modes) return std::nullopt;
    point.modes = std::make_shared<const NearestModes>(std::move(*modes));
    if (beside == nullptr || !beside->index || !beside->modes) return 0;
    if (const auto count = through_zero(w_, *beside->modes, *point.modes))
      return *beside->index + *count;
    told_ = false;
    const bool changes = beside->modes->determinant_sign * point.modes->determinant_sign < 0;
    return *beside->index + (changes ? 1 : 0);
  }

  // How resultants change along the tangent of a point.
  std::vector<Vec6> rate_of_resultants(const Point& point) const {
    return rates_of_resultants(system_, point.state, point.tangent.head(n_));
  }

  // Where the tangent and how it bends lead to from a point, with the resultants there.
  Point foretold(const Point& from, double h) const {
    Point point;
    point.state = from.state;
    VecX ahead = h * from.tangent;
    if (from.bend.size() > 0) ahead += (0.5 * h * h) * from.bend;
    retract(system_, point.state, ahead);
    point.state.load_factor += ahead(n_);
    point.resultants = rate_of_resultants(from);
    std::vector<Vec6>& resultants = point.resultants;
    for (std::size_t i = 0; i < resultants.size(); ++i)
      resultants[i] = from.resultants[i] + h * resultants[i];
    for (std::size_t i = 0; i < from.bend_of_resultants.size(); ++i)
      resultants[i] += (0.5 * h * h) * from.bend_of_resultants[i];
    return point;
  }

  // The point at h from another, by mixed Newton (equilibrium.hpp). Empty if the corrector does not converge quickly.
  std::optional<Point> correct(const Point& from, double h, int& iterations) {
    Point point = foretold(from, h);
    std::vector<Vec6>& resultants = point.resultants;
    // Where nothing moves the cylinder is a line, and the step one of the load.
    constexpr double moves = 1e-6;
    const double moved = displacement(from.tangent);
    const bool on_cylinder = options_.method == PathMethod::crisfield && moved > moves;
    const double radius = on_cylinder ? std::abs(h) * moved : 0.0;
    IncrementNorm norm(system_, options_.newton);
    norm.observe(from.state.lambda);
    VecX r, x(n_ + 1);
    // Beside a bifurcation the matrix is nearly singular, and the first iterations lead about.
    const int patience = from.is_branching ? 10 : 3;
    double previous = 0.0;
    for (int k = 0; k < options_.newton.max_iterations; ++k) {
      stop::check();
      ++report_.counters.iterations;
      ++iterations;
      if (on_cylinder) {
        if (!increment_on_cylinder(from, point.state, resultants, radius, r, x))
          return std::nullopt;
      } else {
        if (!factor_bordered(point.state, from.tangent, r, resultants)) return std::nullopt;
        x << -r.tail(n_), 0.0;
        bordered_->solve(span(x));
      }
      if (k == 0) norm.set_floor(point.state, stiffness_);
      if (deflated_.size() > 0) x -= dot(deflated_, x) * deflated_;
      if (!x.allFinite() || largest_rotation_in(system_, x) > largest_rotation) return std::nullopt;
      system_.linearized_resultants(point.state, x.head(n_), resultants);
      retract(system_, point.state, x);
      point.state.load_factor += x(n_);
      norm.observe(point.state.lambda);
      const double e = norm({x.data(), static_cast<std::size_t>(n_)}, 1.0);
      if (!std::isfinite(e)) return std::nullopt;
      if (e < 1.0 || (k > 2 && e < 1e3 && e > 0.5 * previous && previous < 1e3)) {
        // Without motion along the mode the force along it must vanish by itself.
        if (deflated_.size() > 0 &&
            !(std::abs(deflated_.head(n_).dot(r.tail(n_))) <= balanced * scale_))
          return std::nullopt;
        report_.most_iterations = std::max(report_.most_iterations, k + 1);
        if (!is_admissible(point.state)) return std::nullopt;
        point.arc = from.arc + sign_of_branch_ * size_of(moved_between(from.state, point.state));
        return point;
      }
      if (k > patience && e > 0.9 * previous && e > 1e3) return std::nullopt;
      previous = e;
    }
    return std::nullopt;
  }

  // Whether what the iterations have converged to is an equilibrium.
  bool is_admissible(const State& state) {
    if (const std::string element = system_.out_of_range(state); !element.empty())
      why_ = range_failure(element);
    else if (std::optional<std::string> open = idle_rows_open(system_, state))
      why_ = std::move(*open), is_open_ = true;
    else
      return true;
    return false;
  }

  // Motions of the nodes from one state to another, and of such their measure, rms (W).
  VecX moved_between(const State& from, const State& to) const {
    VecX moved(6 * (system_.nodes() - 1));
    for (Index n = 0; n < moved.size(); n += 6) {
      const auto k = static_cast<std::size_t>(n / 6 + 1);
      moved.segment<6>(n) = log_se3<double>(relative(from.pose[k], to.pose[k]));
    }
    return moved;
  }
  double size_of(const VecX& moved) const {
    return std::sqrt(moved.dot(w_.head(moved.size()).cwiseProduct(moved)));
  }

  double displacement(const VecX& x) const {
    double sum = 0.0;
    for (Index n = 0; n < 6 * (system_.nodes() - 1); n += 6)
      sum += w_(n) * x.segment<3>(n).squaredNorm();
    return std::sqrt(sum);
  }

  // Inertial displacements that belong to an increment of the nodes.
  VecX inertial(const State& state, const VecX& x) const {
    const Index nodes = system_.nodes() - 1;
    VecX d(3 * nodes);
    for (Index n = 0; n < nodes; ++n)
      d.segment<3>(3 * n) =
          state.pose[static_cast<std::size_t>(n + 1)].p * Vec3(x.segment<3>(6 * n));
    return d;
  }

  // Solutions of S dU + p dmu = -r are a line, a + s b, whose direction is the tangent there; the one with
  // |d + a + s b| = radius in displacements, d those since `from`. From the matrix of (1), so that the
  // line is known at limit points too.
  bool increment_on_cylinder(const Point& from, const State& state,
                             std::span<const Vec6> resultants, double radius, VecX& r, VecX& x) {
    if (!factor_bordered(state, from.tangent, r, resultants)) return false;
    VecX a(n_ + 1), b = VecX::Unit(n_ + 1, n_);
    a << -r.tail(n_), 0.0;
    bordered_->solve(span(a));
    bordered_->solve(span(b));
    const Index nodes = system_.nodes() - 1;
    VecX d(3 * nodes);
    for (Index n = 0; n < nodes; ++n) {
      const auto k = static_cast<std::size_t>(n + 1);
      d.segment<3>(3 * n) = state.pose[k].r - from.state.pose[k].r;
    }
    const VecX moved = d + inertial(state, a), along = inertial(state, b);
    const double weight = nodes > 0 ? w_(0) : 1.0;
    const double A = weight * along.squaredNorm(), B = weight * along.dot(moved),
                 C = weight * moved.squaredNorm() - radius * radius;
    const double root = B * B - A * C;
    if (!std::isfinite(root) || !(A > 0.0)) return false;
    const double s =
        std::sqrt(std::max(root, 0.0));  // a line that misses the cylinder: its nearest point
    const double first = (-B + s) / A, second = (-B - s) / A;
    // Both ends have the same length: the one more along d.
    x = a + (d.dot(along) * (first - second) >= 0.0 ? first : second) * b;
    return true;
  }

  // --- what happens between two points ---

  std::optional<Point> between(const Point& from, double h) {
    int iterations = 0;
    std::optional<Point> point = correct(from, h, iterations);
    if (!point || !tangent(*point, from.tangent)) return std::nullopt;
    return point;
  }

  // Away from a mode: near a singular point the motion along it is known to round-off over the eigenvalue only, and a path
  // that does not move along it is found without it. `scale`: of eigenvalues.
  std::optional<Point> between_off(const VecX& mode, double scale, const Point& from, double h) {
    deflated_.resize(n_ + 1);
    deflated_ << mode, 0.0;
    deflated_ -= dot(deflated_, from.tangent) * from.tangent;
    deflated_ /= std::sqrt(dot(deflated_, deflated_));
    scale_ = scale;
    std::optional<Point> point = between(from, h);
    deflated_.resize(0);
    return point;
  }

  // At h, or beside it: where the matrix is singular to the last bit there is no tangent. `off`: away from this mode, if any.
  std::optional<Point> between_near(const VecX& off, double scale, const Point& from, double& h,
                                    double bracket) {
    for (const double aside : {0.0, 1e-6, -1e-6}) {
      const double x = h + aside * bracket;
      std::optional<Point> point;
      if (off.size() > 0) point = between_off(off, scale, from, x);
      if (!point) point = between(from, x);
      if (!point) continue;
      h = x;
      return point;
    }
    return std::nullopt;
  }

  // Where the load is extreme, near h. It is known to more digits than its rate along the path, in which resultants of what is
  // stiff are: by differences over a thousandth of the step.
  double extreme_load(const Point& from, double h, double whole) {
    const double d = 1e-3 * whole;
    std::array<double, 5> mu{};
    for (int k = -2; k <= 2; ++k) {
      int iterations = 0;
      const std::optional<Point> point = correct(from, h + k * d, iterations);
      if (!point) return h;
      mu[static_cast<std::size_t>(k + 2)] = point->state.load_factor;
    }
    const double slope = (8.0 * (mu[3] - mu[1]) - (mu[4] - mu[0])) / 12.0,
                 curvature = (16.0 * (mu[3] + mu[1]) - (mu[4] + mu[0]) - 30.0 * mu[2]) / 12.0;
    const double step = -slope / curvature;
    return std::abs(step) < 0.1 ? h + step * d : h;
  }

  // Of a bracket of a singular point: its measure from the last point, and the eigenvalue nearest to 0 with its mode.
  struct End {
    double h, value;
    VecX shape;
  };

  End end_at(double h, const Point& point) {
    const std::optional<CriticalMode> mode =
        critical_mode(system_, plain_, point.state, guess_, point.resultants, holds_);
    ++report_.counters.factorizations;
    if (!mode) return {h, 0.0, {}};
    return {h, mode->eigenvalue, mode->shape};
  }

  // Far from the root the eigenvalues nearest to zero may be others at the two ends.
  bool are_of_one_mode(const End& left, const End& right) const {
    return left.shape.size() > 0 && right.shape.size() > 0 &&
           std::abs(left.shape.dot(w_.cwiseProduct(right.shape))) > 0.9 &&
           (left.value < 0.0) != (right.value < 0.0);
  }

  // Where between h = a, with index ia, and b the index first changes. Narrows the bracket by counting
  // and, once both its ends know the eigenvalue that crosses, by that.
  std::optional<Event> find_singular(const Point& from, double a, const Point& at_a, double b,
                                     const Point& at_b) {
    guess_.resize(0);
    End left = end_at(a, at_a), right = end_at(b, at_b);
    Point best = at_b;
    Index after = at_b.index.value_or(0);
    End found = right;
    const double scale = std::max(std::abs(left.value), std::abs(right.value));
    double f_left = left.value, f_right = right.value;  // Illinois' weights on values
    bool singular = false;                              // to round-off
    int last_side = 0;
    for (int k = 0; k < 40 && !singular; ++k) {
      if (std::abs(right.h - left.h) <= 1e-14 * std::abs(b)) break;
      double h = 0.5 * (left.h + right.h);
      const bool same = are_of_one_mode(left, right);
      if (same && k % 5 != 4) {
        const double secant = right.h - f_right * (right.h - left.h) / (f_right - f_left);
        if ((secant - left.h) * (secant - right.h) < 0.0) h = secant;
      }
      std::optional<Point> point =
          between_near(same ? found.shape : VecX(), scale, from, h, right.h - left.h);
      if (!point) break;
      point->index = index(*point, &at_a);
      End middle = end_at(h, *point);
      // Singular to the last bit: of the mode that crosses.
      if (middle.shape.size() == 0 && same) middle.shape = found.shape;
      if (found.shape.size() == 0 || std::abs(middle.value) < std::abs(found.value)) {
        found = middle;
        best = *point;
      }
      singular = !point->index || std::abs(middle.value) <= 1e-13 * scale;
      if (!point->index) break;
      const int side = point->index == at_a.index ? -1 : 1;
      if (side < 0) {
        left = middle;
        f_left = middle.value;
        if (side == last_side) f_right *= 0.5;
      } else {
        right = middle;
        f_right = middle.value;
        if (side == last_side) f_left *= 0.5;
        after = *point->index;
      }
      last_side = side;
    }
    // Where the corrector leads to another path from some h on the eigenvalue jumps, and has no root.
    const bool narrow = std::abs(right.h - left.h) <= located * std::abs(b - a) &&
                        std::abs(found.value) <= no_jump * scale;
    if (found.shape.size() == 0 ||
        !(singular || narrow || std::abs(found.value) <= located * scale))
      return std::nullopt;
    // The matrix of (1) is singular here, and its tangent holds some of the mode: the tangents of the ends do
    // not.
    const double share = (found.h - a) / (b - a);
    best.tangent = (1.0 - share) * at_a.tangent + share * at_b.tangent;
    best.tangent /= std::sqrt(dot(best.tangent, best.tangent));
    return Event{found.h, PathEvent::bifurcation, false, best, found.shape, at_a.index, after};
  }

  // Where in a step a value of its points, f0 at its beginning and f1 at its end, is zero.
  template <class Value>
  double root_along(const Point& from, double whole, double f0, double f1, const Value& value) {
    return find_root(
        [&](double x) -> std::optional<double> {
          int iterations = 0;
          const std::optional<Point> point = correct(from, x, iterations);
          if (!point) return std::nullopt;
          return value(*point);
        },
        0.0, f0, whole, f1, 1e-14 * std::abs(whole));
  }

  // Whether a quantity jumps over its value near h, as a rotation vector does at half a turn, rather than to cross it.
  bool jumps(const PathCrossing& crossing, const Point& from, double h, double whole,
             double change) {
    constexpr double beside = 1e-7, all_of_it = 0.5;
    int iterations = 0;
    const std::optional<Point> before = correct(from, h - beside * whole, iterations),
                               after = correct(from, h + beside * whole, iterations);
    return before && after &&
           std::abs(crossing.excess(after->state) - crossing.excess(before->state)) >
               all_of_it * std::abs(change);
  }

  // Events with 0 < h < whole, in order. `all` is false if one of them could not be located: in a shorter step
  // it can. A stop is always there, at the end of the step if not where it is.
  struct Met {
    std::vector<Event> events;
    bool all = true;
  };
  Met events(const Point& from, const Point& to, double whole) {
    Met met;
    const double tolerance = 1e-14 * std::abs(whole);
    // Roots of t_mu.
    std::vector<double> limits;
    if (from.tangent(n_) * to.tangent(n_) < 0.0 && !from.is_branching) {
      const double h = extreme_load(from,
                                    find_root(
                                        [&](double x) -> std::optional<double> {
                                          const std::optional<Point> point = between(from, x);
                                          if (!point) return std::nullopt;
                                          return point->tangent(n_);
                                        },
                                        0.0, from.tangent(n_), whole, to.tangent(n_), tolerance),
                                    whole);
      std::optional<Point> point = between(from, h);
      const double change = std::abs(from.tangent(n_) - to.tangent(n_));
      if (point && std::abs(point->tangent(n_)) <= continuous * change) {
        limits.push_back(h);
        const VecX mode = point->tangent.head(n_);
        met.events.push_back(
            {h, PathEvent::limit, false, std::move(*point), mode, std::nullopt, std::nullopt});
      } else {
        met.all = false;
      }
    }
    find_crossings(from, to, whole, met);
    if (!find_bifurcations(from, to, whole, limits, met.events)) met.all = false;
    std::sort(met.events.begin(), met.events.end(),
              [](const Event& a, const Event& b) { return a.h < b.h; });
    return met;
  }

  // Values that stops and marks are at.
  void find_crossings(const Point& from, const Point& to, double whole, Met& met) {
    for (const PathCrossing& crossing : options_.crossings) {
      const double f0 = crossing.excess(from.state), f1 = crossing.excess(to.state);
      // What begins on the value, to round-off, does not cross it; what ends on it does.
      const double near = on_value * std::abs(f1 - f0);
      if (std::abs(f0) <= near) continue;
      if (std::abs(f1) <= near) {
        met.events.push_back({whole, PathEvent::crossing, crossing.stops, to, {}, {}, {}});
        continue;
      }
      if ((f0 < 0.0) == (f1 < 0.0)) continue;
      double h = root_along(from, whole, f0, f1,
                            [&](const Point& point) { return crossing.excess(point.state); });
      std::optional<Point> point = between(from, h);
      if (!point || std::abs(crossing.excess(point->state)) > located * std::abs(f1 - f0)) {
        if (jumps(crossing, from, h, whole, f1 - f0)) continue;
        met.all = false;
        point = to;
        h = whole;
      } else {
        point->index = index(*point, &from);
      }
      met.events.push_back({h, PathEvent::crossing, crossing.stops, std::move(*point), {}, {}, {}});
    }
  }

  struct Piece {  // of a step, from a to b
    double a, b;
    Point at_a, at_b;
  };

  // All changes of the index in a piece; false if one of them could not be located.
  bool search(const Point& from, double whole, Piece& piece, std::vector<Event>& found) {
    for (int k = 0; k < most_in_a_step && piece.at_a.index != piece.at_b.index; ++k) {
      std::optional<Event> event = find_singular(from, piece.a, piece.at_a, piece.b, piece.at_b);
      if (!event) return false;
      const double h = event->h;
      // Goes on behind it, as near to it as it shows there.
      std::optional<Point> behind;
      double next = h;
      for (double ahead = 1e-4; ahead < 2e-2; ahead *= 10.0) {
        next = h + ahead * (piece.b - piece.a);
        if ((next - piece.b) * whole >= 0.0) {
          next = piece.b;
          behind = piece.at_b;
          break;
        }
        behind = between(from, next);
        if (behind) behind->index = index(*behind, &piece.at_a);
        if (!behind || !behind->index) return false;
        if (behind->index != piece.at_a.index) break;
      }
      if (behind->index == piece.at_a.index) return false;
      event->after = behind->index;
      found.push_back(std::move(*event));
      piece.a = next;
      piece.at_a = std::move(*behind);
    }
    return true;
  }

  // Changes of the index that are no limit points.
  bool find_bifurcations(const Point& from, const Point& to, double whole,
                         const std::vector<double>& limits, std::vector<Event>& found) {
    if (!from.index || !to.index) return true;
    std::vector<Piece> pieces;
    double a = 0.0;
    Point at_a = from;
    const auto end_piece = [&](double h, Point at) {
      pieces.push_back({a, h, at_a, at});
      a = h;
      at_a = std::move(at);
    };
    for (const double h : limits) {
      // Near enough to tell it from others, far enough to see it: where it is, is known to a share only.
      double margin = 1e-5;
      std::optional<Point> left, right;
      for (; margin < 2e-3; margin *= 10.0) {
        left = between(from, h - margin * whole);
        if (left) left->index = index(*left, &at_a);
        right = between(from, h + margin * whole);
        if (right) right->index = index(*right, left ? &*left : &at_a);
        if (!left || !right || !left->index || !right->index) return false;
        if (left->index != right->index) break;
      }
      for (Event& event : found)
        if (event.kind == PathEvent::limit && event.h == h) {
          event.before = left->index;
          event.after = right->index;
        }
      end_piece(h - margin * whole, *left);
      a = h + margin * whole;
      at_a = *right;
    }
    end_piece(whole, to);
    return std::ranges::all_of(pieces,
                               [&](Piece& piece) { return search(from, whole, piece, found); });
  }

  // --- along the path ---

  bool accept(const Point& point, PathEvent event, int branch) {
    last_ = point.state;
    report_.least_load = std::min(report_.least_load, point.state.load_factor);
    report_.most_load = std::max(report_.most_load, point.state.load_factor);
    if (!options_.accepted) return true;
    going_ = options_.accepted(
        {point.state, point.arc, branch, event, stability_ ? point.index : std::nullopt});
    return going_;
  }

  void note(const Event& event, int branch) {
    SpecialPoint special;
    special.event = event.kind;
    special.branch = branch;
    special.number = 1 + static_cast<int>(std::count_if(
                             report_.special.begin(), report_.special.end(),
                             [&](const SpecialPoint& s) { return s.event == event.kind; }));
    special.load_factor = event.point.state.load_factor;
    special.arc_length = event.point.arc;
    if (stability_) {
      special.before = event.before;
      special.after = event.after;
    }
    const Index at_once =
        event.before && event.after ? std::abs(*event.after - *event.before) : Index{1};
    if (event.mode.size() > 0) special.motion = name_of_motion(system_, event.mode);
    if (!stability_ && event.kind == PathEvent::bifurcation && at_once > 1)
      special.motion = fmt::format("{} at once, one of them {}", at_once, special.motion);
    special.mode = event.mode;
    report_.special.push_back(std::move(special));
    if (event.kind == PathEvent::bifurcation)
      bifurcations_.push_back({event.point, event.mode, at_once});
  }

  void finish(const std::string& who, const std::string& why) {
    report_.end += (report_.end.empty() ? "" : "; ") + who + why;
  }

  // A step of length h; empty if there is none, or it turns too far. `turn`: between the tangents.
  std::optional<Point> step(const Point& at, double h, int& iterations, double& turn) {
    turn = 0.0;
    std::optional<Point> next = correct(at, h, iterations);
    if (!next || !tangent(*next, at.tangent)) return std::nullopt;
    turn = std::acos(std::clamp(dot(at.tangent, next->tangent), -1.0, 1.0));
    if (turn > (at.is_branching ? 2.0 * most_turn : most_turn)) return std::nullopt;
    return next;
  }

  // Whether the motion of a step is not what the tangents of its ends make of it: another part of the path was met, or another
  // path. The load does not tell, which is most of a step where loads move little of the scene. `far`: none that steps cut
  // often enough may make, as they may where a law has a kink.
  enum class Leap { none, near, far };
  Leap leap(const Point& at, const Point& next, double h) const {
    constexpr double none = 1e-8;  // of the scene: the tolerance of Newton's iterations, and more
    constexpr double far = 1e-3, longer = 3.0;
    const VecX moved = moved_between(at.state, next.state);
    const VecX foretold = 0.5 * h * (at.tangent + next.tangent).head(moved.size());
    const double way = size_of(moved), most = std::max(way, size_of(foretold));
    if (!(most > none && size_of(moved - foretold) > most_of_a_leap * most)) return Leap::none;
    return way > far && way > longer * size_of(foretold) ? Leap::far : Leap::near;
  }

  void note_not_located(const Point& at, const Point& next) {
    report_.notes.push_back(
        fmt::format("between load factors {:.9g} and {:.9g} the path has a point that could not be "
                    "located{}",
                    at.state.load_factor, next.state.load_factor,
                    at.index && next.index && at.index != next.index && stability_
                        ? fmt::format(": negative eigenvalues {} -> {}", *at.index, *next.index)
                        : std::string()));
  }

  void set_bend(const Point& at, Point& next, double h) const {
    next.bend = (next.tangent - at.tangent) / h;
    next.bend_of_resultants = rate_of_resultants(next);
    const std::vector<Vec6> before = rate_of_resultants(at);
    for (std::size_t i = 0; i < before.size(); ++i)
      next.bend_of_resultants[i] = (next.bend_of_resultants[i] - before[i]) / h;
  }

  double first_step(const Point& at, int branch) const {
    const double per_load = std::abs(at.tangent(n_));
    return std::min(
        per_load > 0.0 && branch <= 0 ? options_.step / per_load : 0.1 * options_.max_step,
        options_.max_step);
  }

  // False: the path ends.
  bool accept_events(Met& met, int branch, const std::string& who, int& count) {
    for (Event& event : met.events) {
      note(event, branch);
      system_.follow_angles(event.point.state);
      ++count;
      if (!accept(event.point, event.kind, branch)) return false;
      if (event.stops) {
        finish(who, "a stop is reached");
        return false;
      }
    }
    return true;
  }

  // A step from `at` for one of h that failed. False where none is left: the report says why.
  bool shorten(const Point& at, double& h, int& leaps) {
    h *= 0.5;
    // Rows that open do so beyond, with steps of any size.
    const bool opens = is_open_ && h < 1e-3 * options_.max_step;
    if (h >= smallest_step * options_.max_step && !opens) return true;
    // Within round-off of a singular point small steps do not converge; a large one may get past it.
    if (leaps < most_leaps && !opens) {
      h = options_.max_step / std::pow(4.0, ++leaps);
      return true;
    }
    report_.failure = fmt::format(
        "the path cannot be followed beyond load factor {:.9g}: {}", at.state.load_factor,
        why_.empty() ? "the corrector does not converge in the smallest step" : why_);
    return false;
  }

  // Shortens a step that goes beyond the length asked for.
  void end_at_length(const Point& at, Point& next, double& h) {
    const auto beyond = [&](const Point& point) { return std::abs(point.arc) - options_.length; };
    const double end = root_along(at, h, beyond(at), beyond(next), beyond);
    if (std::optional<Point> point = between(at, end)) {
      next = std::move(*point);
      h = end;
    }
  }

  // Whether the argument of a law goes to the other side of a kink. Beside a far part of the scene a smooth path turns within as
  // small a step.
  bool passes_kink(const State& before, const State& after) const {
    const std::vector<NearKink> here = system_.near_kinks(before),
                                there = system_.near_kinks(after);
    if (here.size() != there.size()) return false;
    for (std::size_t k = 0; k < here.size(); ++k)
      if (here[k].element == there[k].element && here[k].of == there[k].of &&
          (here[k].x < here[k].kink.at) != (there[k].x < here[k].kink.at))
        return true;
    return false;
  }

  // The path beyond a corner, as the kink of a law makes one, within h: no smaller step turns it less. Along the tangent that there
  // is where the last one leads to, or against it: a path that turns by more than a right angle goes on that way.
  std::optional<Point> past_corner(const Point& at, double h) {
    constexpr double farther = 8.0, no_corner = 0.999;
    Point there = foretold(at, h);
    if (!passes_kink(at.state, there.state)) return std::nullopt;
    if (!tangent(there, at.tangent)) return std::nullopt;
    if (std::abs(dot(there.tangent, at.tangent)) > no_corner) return std::nullopt;
    for (const double sign : {1.0, -1.0}) {
      Point from = at;
      from.tangent = sign * there.tangent;
      from.bend.resize(0);
      from.bend_of_resultants.clear();
      int iterations = 0;
      double turn = 0.0;
      std::optional<Point> next = step(from, farther * h, iterations, turn);
      if (!next || leap(from, *next, farther * h) != Leap::none) continue;
      next->index = index(*next, &at);
      std::string changes;
      if (stability_ && at.index && next->index && at.index != next->index)
        changes = fmt::format(", negative eigenvalues {} -> {}", *at.index, *next->index);
      if (at.tangent(n_) * next->tangent(n_) < 0.0) changes += ", the load is extreme";
      report_.notes.push_back(
          fmt::format("at load factor {:.6g} the path has a corner, where a law "
                      "has a kink{}",
                      at.state.load_factor, changes));
      system_.follow_angles(next->state);
      return next;
    }
    return std::nullopt;
  }

  // Takes `beyond`, past a corner, for `at`. False: the path ends.
  bool accept_beyond(Point& at, Point beyond, double h, int branch, const std::string& who,
                     int& count) {
    Met met;  // a step so short meets nothing else
    for (const PathCrossing& crossing : options_.crossings)
      if ((crossing.excess(at.state) < 0.0) != (crossing.excess(beyond.state) < 0.0))
        met.events.push_back({h, PathEvent::crossing, crossing.stops, beyond, {}, {}, {}});
    if (!accept_events(met, branch, who, count)) return false;
    at = std::move(beyond);
    ++count;
    ++report_.counters.steps;
    return accept(at, PathEvent::none, branch);
  }

  void trace(Point at, int branch, const std::string& who) {
    sign_of_branch_ = branch < 0 ? -1.0 : 1.0;
    double h = first_step(at, branch);
    int halvings = 0, leaps = 0, refused = 0;
    bool passing = false;  // an event that cannot be located
    for (int count = 1; count < options_.points;) {
      constexpr double round_off = 1e-12;
      if (std::abs(at.arc) >= options_.length * (1.0 - round_off))
        return finish(who, "the length asked for is reached");
      int iterations = 0;
      why_.clear();
      is_open_ = false;
      double turn = 0.0;
      std::optional<Point> next = step(at, h, iterations, turn);
      if (!next && h <= corner_step * options_.max_step && !at.is_branching) {
        if (std::optional<Point> beyond = past_corner(at, h)) {
          if (!accept_beyond(at, std::move(*beyond), h, branch, who, count)) return;
          halvings = leaps = refused = 0;
          continue;
        }
      }
      if (!next) {
        ++report_.counters.retries;
        if (!shorten(at, h, leaps)) return;
        continue;
      }
      const Leap leaps_off = at.is_branching ? Leap::none : leap(at, *next, h);
      if (leaps_off == Leap::far || (leaps_off == Leap::near && refused < most_refused)) {
        ++refused;
        ++report_.counters.retries;
        if (!shorten(at, h, leaps)) return;
        continue;
      }
      if (std::abs(next->arc) > options_.length) end_at_length(at, *next, h);
      told_ = true;
      next->index = index(*next, &at);
      if (!next->index) next->index = at.index, next->modes = at.modes;  // singular, to round-off
      Met met = told_ || passing ? events(at, *next, h) : Met{{}, false};
      if (!met.all && !passing) {
        ++report_.counters.retries;
        passing = ++halvings == most_halvings;
        h *= passing ? std::pow(2.0, most_halvings - 1) : 0.5;  // small steps have not helped
        continue;
      }
      passing = false;
      halvings = leaps = refused = 0;
      if (!met.all) note_not_located(at, *next);
      if (!accept_events(met, branch, who, count)) return;
      system_.follow_angles(next->state);
      ++count;
      ++report_.counters.steps;
      if (!accept(*next, PathEvent::none, branch)) return;
      set_bend(at, *next, h);
      at = std::move(*next);
      double factor = iterations <= easy_iterations ? 2.0 : iterations <= most_easy ? 1.0 : 0.7;
      if (turn > 0.0) factor = std::min(factor, 0.5 * most_turn / turn);
      h = std::min(h * std::clamp(factor, 0.5, 2.0), options_.max_step);
    }
    finish(who, "the points asked for are reached");
  }

  void follow_branch() {
    const auto number = static_cast<std::size_t>(std::abs(options_.branch));
    if (number > bifurcations_.size()) {
      report_.failure = fmt::format(
          "there is no bifurcation {} to follow a branch from: {} on the path", number,
          bifurcations_.empty() ? "none was met" : fmt::format("{} met", bifurcations_.size()));
      return;
    }
    Bifurcation& from = bifurcations_[number - 1];
    if (from.branches > 1) {
      report_.failure = fmt::format(
          "{} branches or more leave bifurcation {} at once, by symmetry: hold the others by "
          "joints, or "
          "break the symmetry a little, to follow one",
          from.branches, number);
      return;
    }
    VecX direction = VecX::Zero(n_ + 1);
    direction.head(n_) = from.mode;
    direction -= dot(direction, from.point.tangent) * from.point.tangent;
    // The sign of a mode means nothing: its largest motion is positive.
    Index largest = 0;
    (w_.cwiseProduct(from.mode.cwiseAbs2())).maxCoeff(&largest);
    if ((from.mode(largest) < 0.0) != (options_.branch < 0)) direction = -direction;
    direction /= std::sqrt(dot(direction, direction));
    Point start = from.point;
    start.tangent = direction;
    start.bend.resize(0);
    start.bend_of_resultants.clear();
    start.index.reset();  // of the path it leaves
    start.modes.reset();
    start.is_branching = true;
    start.arc = 0.0;
    if (!accept(start, PathEvent::none, 1)) return;
    trace(start, 1, "branch: ");
  }

  const System& system_;
  const PathOptions& options_;
  LinearSolver& plain_;
  std::unique_ptr<LinearSolver> bordered_;
  std::optional<StabilityCount> stability_;
  std::size_t border_ = 0;  // first contribution of the border
  Index n_;
  VecX w_;
  double c2_ = 1.0, sign_of_branch_ = 1.0, asymmetry_ = 0.0, stiffness_ = 0.0;
  VecX rate_, guess_;
  Holds holds_;         // of neutral motions
  VecX deflated_;       // mode along which the corrector does not move; usually empty
  double scale_ = 0.0;  // of its eigenvalue
  State last_;
  bool going_ = true;
  std::string why_;
  bool told_ = true;      // of the last index without a potential: by how much it has changed
  bool is_open_ = false;  // that is because rows that repeated others no longer do
  std::vector<Bifurcation> bifurcations_;
  PathReport report_;
};

}  // namespace

PathReport follow_path(const System& system, LinearSolver& solver, const PathOptions& options,
                       State& state) {
  return Follower(system, solver, options).go(state);
}

}  // namespace mbd
