#include "libmbd/study/modes/linearize.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "libmbd/study/modes/states_of_run.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/tables.hpp"
#include "solvers/modes/eigenmodes.hpp"
#include "solvers/modes/linearizable.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

// Small motions along which outputs are looked at: of all motions u, u', u'', and multipliers.
struct Along {
  VecX u, rate, acceleration, multipliers;
  VecX inputs;
};

// What outputs change by along a motion, and how far differences over other steps are from that.
struct Change {
  VecX rate, doubt;
};

// Calls take(q, first, n) for each quantity: outputs first to first + n - 1; q: null of what is none.
template <class Take>
void each_quantity(const Model& model, const Take& take) {
  Index first = 0;
  for (const Channel& channel : model.channels)
    for (std::size_t k = 0; k < channel.columns.size();) {
      const schema::Quantity* const q = channel.columns[k].quantity;
      const Index n = q == nullptr ? 1 : q->components;
      take(q, first, n);
      first += n;
      k += static_cast<std::size_t>(n);
    }
}

// Of each output the first and the number of those that are one quantity with it: what is zero of a vector is so beside the rest.
std::vector<std::pair<Index, Index>> quantities_of(const Model& model) {
  std::vector<std::pair<Index, Index>> all;
  each_quantity(model, [&](const schema::Quantity*, Index first, Index n) {
    all.insert(all.end(), static_cast<std::size_t>(n), {first, n});
  });
  return all;
}

class Outputs {
 public:
  Outputs(const Model& model, const Linearization& linear)
      : model_(model),
        linear_(linear),
        here_(linear.outputs),
        size_(linear.outputs.size()),
        quantities_(quantities_of(model)),
        turns_(rotation_vectors(model)) {}

  const std::vector<std::pair<Index, Index>>& quantities() const { return quantities_; }

  // dy along a small motion: of each output its central difference over the step that suits it best. A mechanism may be much
  // smaller than the scene, and a stress of von Mises near zero bends within what moves it from there; so steps go down until
  // they agree, without their errors of even orders (Ridders 1982).
  Change change(const Along& along) const {
    const double L = model_.system->length_scale();
    double size = 0.0;  // of the motion, in lengths of the scene, radians, and these over a second
    for (const VecX* x : {&along.u, &along.rate})
      for (Index i = 0; i < x->size(); ++i)
        size = std::max(size, std::abs((*x)(i)) / (i % 6 < 3 ? L : 1.0));
    // Of inputs alone nearly all outputs are linear.
    double step = size > 0.0 ? largest_part / size : 1.0;
    Change best{VecX::Zero(size_), VecX::Constant(size_, std::numeric_limits<double>::infinity())};
    VecX most = VecX::Zero(size_);
    std::vector<char> is_known(static_cast<std::size_t>(size_), 0);
    std::vector<VecX> above, row;
    for (int k = 0; k < most_steps; ++k, step /= ratio) {
      row.assign(1, (at(along, step) - at(along, -step)) / (2.0 * step));
      // A step that is much too long may leave the range of a law.
      for (Index i = 0; i < size_; ++i)
        if (std::isfinite(row[0](i))) most(i) = std::max(most(i), std::abs(row[0](i)));
      double power = 1.0;
      for (std::size_t j = 0; j < above.size() && j < most_orders; ++j) {
        power *= ratio * ratio;
        row.push_back((power * row[j] - above[j]) / (power - 1.0));
        take_better(row[j + 1], row[j], above[j], most, round_off / step, is_known, best);
      }
      above = std::move(row);
      // Each by itself: where others go on, to steps that are nearly nothing, differences of round-off agree by chance.
      for (Index i = 0; i < size_ && k > 0; ++i) {
        const auto [first, count] = quantities_[static_cast<std::size_t>(i)];
        const double whole = best.rate.segment(first, count).cwiseAbs().maxCoeff(),
                     value = here_.segment(first, count).cwiseAbs().maxCoeff();
        // What is round-off of its quantity only grows with shorter steps.
        if (best.doubt(i) <= std::max({agreed * std::abs(best.rate(i)) + tiny * most(i),
                                       is_none * whole, several * round_off * value / step}))
          is_known[static_cast<std::size_t>(i)] = 1;
      }
      if (std::ranges::count(is_known, 0) == 0) break;
    }
    return best;
  }

 private:
  static constexpr double largest_part = 1e-4, ratio = 4.0, agreed = 1e-10, tiny = 1e-16,
                          round_off = 1.1e-16, is_none = 1e-11, several = 16.0;
  static constexpr int most_steps = 16;
  static constexpr std::size_t most_orders = 3;

  // Where differences fall more slowly than they are themselves: over steps that are far too long they are as small as they are
  // wrong, so what counts is how they agree beside their own size.
  // `of_output`: doubt of a difference, of its output, by round-off of that.
  void take_better(const VecX& rate, const VecX& of_this, const VecX& of_last, const VecX& most,
                   double of_output, const std::vector<char>& is_known, Change& best) const {
    constexpr double is_zero = 1e-6;  // of the largest difference
    for (Index i = 0; i < rate.size(); ++i) {
      if (is_known[static_cast<std::size_t>(i)] != 0) continue;
      const double doubt = std::max({std::abs(rate(i) - of_this(i)), std::abs(rate(i) - of_last(i)),
                                     of_output * std::abs(here_(i))});
      const auto share = [&](double x, double of) {
        return x / (std::abs(of) + is_zero * most(i) + std::numeric_limits<double>::min());
      };
      if (share(doubt, rate(i)) < share(best.doubt(i), best.rate(i)))
        best.rate(i) = rate(i), best.doubt(i) = doubt;
    }
  }

  // First components of rotation vectors.
  static std::vector<Index> rotation_vectors(const Model& model) {
    std::vector<Index> all;
    each_quantity(model, [&](const schema::Quantity* q, Index first, Index n) {
      if (n == 3 && q->unit == "rad") all.push_back(first);
    });
    return all;
  }

  VecX at(const Along& along, double step) const {
    const System& system = *model_.system;
    State state = linear_.state;
    for (std::size_t n = 1; n < state.pose.size(); ++n) {
      const Index i = 6 * static_cast<Index>(n - 1);
      const Vec6 u = step * along.u.segment<6>(i), rate = step * along.rate.segment<6>(i),
                 acceleration = step * along.acceleration.segment<6>(i);
      const Mat6 V_hat = twist_hat<double>(linear_.state.V[n]);
      state.pose[n] = state.pose[n] * exp_se3<double>(u);
      state.V[n] += rate + V_hat * u;
      state.Vdot[n] += acceleration + V_hat * rate;
    }
    state.lambda += step * along.multipliers;
    for (std::size_t i = 0; i < state.inputs.size(); ++i)
      state.inputs[i].f += step * along.inputs(static_cast<Index>(i));
    system.set_time(state, state.t);
    VecX y(size_);
    outputs(model_, state, {y.data(), static_cast<std::size_t>(size_)});
    // Beyond half a turn the other one of the two that are the same rotation would be a jump.
    for (const Index i : turns_) {
      const Vec3 v = y.segment<3>(i), near = here_.segment<3>(i);
      const double angle = v.norm();
      if (!(angle > 0.5 * std::numbers::pi)) continue;
      const Vec3 other = v * (1.0 - 2.0 * std::numbers::pi / angle);
      if ((other - near).norm() < (v - near).norm()) y.segment<3>(i) = other;
    }
    return y;
  }

  const Model& model_;
  const Linearization& linear_;
  const VecX& here_;
  Index size_;
  std::vector<std::pair<Index, Index>> quantities_;
  std::vector<Index> turns_;
};

// Outputs whose differences over smaller and smaller steps do not approach each other.
void note_doubt(Linearization& linear, const VecX& doubt) {
  constexpr double believed = 1e-6;
  constexpr std::size_t named = 3;
  std::vector<std::string> names;
  double worst = 0.0;
  for (Index i = 0; i < doubt.size(); ++i) {
    if (!(doubt(i) > believed)) continue;
    names.push_back(linear.ports.outputs[static_cast<std::size_t>(i)].name);
    worst = std::max(worst, doubt(i));
  }
  if (names.empty()) return;
  const std::size_t more = names.size() > named ? names.size() - named : 0;
  names.resize(names.size() - more);
  linear.notes.push_back(fmt::format(
      "C and D of {}{} are {}: differences over smaller motions do not approach each other "
      "(round-off, or a kink)",
      fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "",
      std::isfinite(worst)
          ? fmt::format("known to {:.0e} of the largest of their quantities only", worst)
          : "not known"));
}

// Of constraints, those that are not idle.
std::vector<Index> rows_that_act(const Linearization& linear) {
  std::vector<Index> rows;
  const std::vector<Index>& idle = linear.state.idle;
  for (Index i = 0; i < linear.motion.B.rows(); ++i)
    if (!std::binary_search(idle.begin(), idle.end(), i)) rows.push_back(i);
  return rows;
}

// C and D of a linearization whose motion on the constraints is there.
void add_outputs(const Model& model, Linearization& linear) {
  const ReducedMotion& r = *linear.reduced;
  const LinearMotion& all = linear.motion;
  const Index m = r.N.cols(), n = all.M.rows(), inputs = all.F.cols();
  const Index outputs = linear.outputs.size();
  if (outputs == 0) {
    linear.C.resize(outputs, 2 * m);
    linear.D.resize(outputs, inputs);
    return;
  }
  const Eigen::PartialPivLU<MatX> mass(r.E.bottomRightCorner(m, m));

  // Multipliers from what is left of (1).
  const std::vector<Index> rows = rows_that_act(linear);
  MatX Bt(n, static_cast<Index>(rows.size()));
  const MatX B = all.B;
  for (std::size_t i = 0; i < rows.size(); ++i)
    Bt.col(static_cast<Index>(i)) = B.row(rows[i]).transpose();
  // Eigen's is undefined of no columns.
  std::optional<Eigen::CompleteOrthogonalDecomposition<MatX>> gradient;
  if (!rows.empty()) gradient.emplace(Bt);

  const Outputs of(model, linear);
  const auto along = [&](const VecX& q, const VecX& qdot, const VecX& w) {
    const VecX forces =
        r.A.bottomLeftCorner(m, m) * q + r.A.bottomRightCorner(m, m) * qdot + r.G.bottomRows(m) * w;
    Along a{r.N * q, r.N * qdot, r.N * VecX(mass.solve(forces)), VecX::Zero(all.B.rows()), w};
    if (!rows.empty()) {
      const VecX left = all.F * w - all.M * a.acceleration - all.C * a.rate - all.K * a.u;
      const VecX found = gradient->solve(left);
      for (std::size_t i = 0; i < rows.size(); ++i)
        a.multipliers(rows[i]) = found(static_cast<Index>(i));
    }
    return of.change(a);
  };
  const VecX none = VecX::Zero(m), no_input = VecX::Zero(inputs);
  std::vector<Change> of_states, of_inputs;
  for (Index j = 0; j < m; ++j) of_states.push_back(along(VecX::Unit(m, j), none, no_input));
  for (Index j = 0; j < m; ++j) of_states.push_back(along(none, VecX::Unit(m, j), no_input));
  for (Index j = 0; j < inputs; ++j) of_inputs.push_back(along(none, none, VecX::Unit(inputs, j)));
  VecX doubt = VecX::Zero(outputs);
  const auto matrix_of = [&](const std::vector<Change>& columns) {
    MatX matrix(outputs, static_cast<Index>(columns.size()));
    for (std::size_t j = 0; j < columns.size(); ++j)
      matrix.col(static_cast<Index>(j)) = columns[j].rate;
    for (Index i = 0; i < outputs && !columns.empty(); ++i) {
      const auto [first, count] = of.quantities()[static_cast<std::size_t>(i)];
      const double largest = matrix.middleRows(first, count).cwiseAbs().maxCoeff();
      for (const Change& column : columns)
        if (largest > 0.0 || !std::isfinite(column.doubt(i)))
          doubt(i) = std::max(doubt(i), column.doubt(i) / largest);
    }
    return matrix;
  };
  linear.C = matrix_of(of_states);
  linear.D = matrix_of(of_inputs);
  note_doubt(linear, doubt);
}

// Outputs that the matrices are not for, and why.
struct LeftOut {
  std::vector<bool> which;
  std::string why;
};

void leave_out(Linearization& linear, const std::vector<LeftOut>& all) {
  std::vector<Index> kept;
  std::vector<std::vector<std::string>> names(all.size());
  std::vector<Port> ports;
  for (std::size_t i = 0; i < linear.ports.outputs.size(); ++i) {
    const auto of = std::ranges::find_if(all, [i](const LeftOut& one) { return one.which[i]; });
    if (of == all.end()) {
      kept.push_back(static_cast<Index>(i));
      ports.push_back(linear.ports.outputs[i]);
    } else {
      names[static_cast<std::size_t>(of - all.begin())].push_back(linear.ports.outputs[i].name);
    }
  }
  linear.ports.outputs = std::move(ports);
  linear.outputs = VecX(linear.outputs(kept));
  if (linear.reduced) {
    linear.C = MatX(linear.C(kept, Eigen::all));
    linear.D = MatX(linear.D(kept, Eigen::all));
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!names[i].empty())
      linear.notes.push_back(
          fmt::format("outputs left out: {}: {}", fmt::join(names[i], ", "), all[i].why));
}

LeftOut integrals(const Model& model) {
  LeftOut out{{}, "integrals over time, which the states do not tell"};
  for (const Channel& channel : model.channels)
    for (const Column& column : channel.columns)
      out.which.push_back(column.quantity != nullptr && column.quantity->is_integral);
  return out;
}

// Inputs and outputs in axes that turn with a steady rotation, in which the matrices are constant. Throws Error for an input
// whose force does not turn along: broken_symmetry() sees the forces that act, and those of an input at 0 do not.
class InTurningAxes {
 public:
  InTurningAxes(const Model& model, const SteadyRotation& rotation, const State& state)
      : model_(model), rotation_(rotation), state_(state) {}

  void check_inputs(const MatX& F) const {
    for (const double angle : angles) {
      const MatX turned = input_forces(*model_.system, turned_by(angle, rotation_, state_));
      for (Index i = 0; i < F.cols(); ++i)
        if ((turned.col(i) - F.col(i)).norm() > same * F.col(i).norm())
          throw Error(fmt::format(
              "the input \"{}\" is a force in inertial axes on what turns, whose coefficients are "
              "constant in no axes; give it as follower_force or follower_moment",
              model_.system->inputs()[static_cast<std::size_t>(i)].name));
    }
  }

  // Outputs that are not the same at all angles, in axes that turn. (Of joints with reactions multipliers would have to turn too;
  // a joint's angle goes on, and what small motions make of it does not.)
  LeftOut not_constant(const Linearization& linear) const {
    const VecX& y = linear.outputs;
    LeftOut out{std::vector<bool>(static_cast<std::size_t>(y.size()), false),
                "in axes that turn they change while nothing moves there"};
    const VecX natural = natural_sizes(linear);
    for (const double angle : angles) {
      VecX turned(y.size());
      outputs(model_, turned_by(angle, rotation_, state_),
              {turned.data(), static_cast<std::size_t>(turned.size())});
      each_quantity(model_, [&](const schema::Quantity* q, Index i, Index n) {
        if (q != nullptr && !follows(*q, angle, y.segment(i, n), turned.segment(i, n),
                                     natural.segment(i, n).maxCoeff()))
          std::fill_n(out.which.begin() + i, n, true);
      });
    }
    return out;
  }

 private:
  static constexpr double angles[] = {0.7, -1.1}, same = 1e-6;

  // What a motion as large as the scene, or of one radian, would change outputs by: what round-off is small beside.
  VecX natural_sizes(const Linearization& linear) const {
    VecX sizes = VecX::Zero(linear.C.rows());
    for (Index j = 0; j < linear.C.cols(); ++j) {
      const bool is_length = linear.states[static_cast<std::size_t>(j)].unit.starts_with("m"),
                 is_rate = 2 * j >= linear.C.cols();
      sizes = sizes.cwiseMax(linear.C.col(j).cwiseAbs() *
                             (is_length ? model_.system->length_scale() : 1.0) *
                             (is_rate ? std::abs(rotation_.rate) : 1.0));
    }
    return sizes;
  }

  bool follows(const schema::Quantity& q, double angle, VecX y, const VecX& turned,
               double natural) const {
    constexpr double round_off = 1e-10;
    using Of = schema::Quantity::Of;
    if (q.of == Of::any_joint || q.of == Of::joint_with_angle) return true;
    double size = std::max(y.norm(), turned.norm());
    if (q.axes == schema::Quantity::Axes::inertial) {
      const Eigen::Quaterniond by(Eigen::AngleAxisd(angle, rotation_.axis));
      const bool is_point = q.moved == schema::Quantity::Moved::as_point;
      const Vec3 through = is_point ? rotation_.through : Vec3(Vec3::Zero());
      y = Vec3(through + by * Vec3(Vec3(y) - through));
      size = std::max(size, through.norm());
    }
    return (turned - y).norm() <= same * size + round_off * natural;
  }

  const Model& model_;
  const SteadyRotation& rotation_;
  const State& state_;
};

// Linearization::growth. Of slow motions, beside the fastest of which they are round-off in a dense matrix, by modes, which know
// free ones from others; of faster ones by all poles.
double growth_of(SmallMotions& motions, const ReducedMotion& reduced) {
  constexpr int slow = 20;
  constexpr double round_off = 1e-9;    // of a pole
  constexpr double of_fastest = 1e-11;  // of a dense matrix
  constexpr double beyond = 1.001;
  double growth = 0.0, reach = 0.0;  // up to which modes have been found
  const auto count = static_cast<int>(std::min<Index>(slow, reduced.E.rows() / 2));
  for (const Mode& mode : find_modes(motions, {.count = std::max(count, 1)}).modes) {
    const double size = std::abs(mode.eigenvalue);
    reach = std::max(reach, size);
    if (!mode.rigid && mode.eigenvalue.real() > std::max(10.0 * mode.round_off, round_off) * size)
      growth = std::max(growth, mode.eigenvalue.real());
  }
  const VecXc poles = eigenvalues_of(Eigen::PartialPivLU<MatX>(reduced.E).solve(reduced.A));
  const double fastest = poles.size() > 0 ? poles.cwiseAbs().maxCoeff() : 0.0;
  for (const std::complex<double>& pole : poles)
    if (std::abs(pole) > beyond * reach &&
        pole.real() > std::max(round_off * std::abs(pole), of_fastest * fastest))
      growth = std::max(growth, pole.real());
  return growth;
}

// `rotation`: in whose axes; null: at rest, or about a state that moves.
Linearization of_motions(const Model& model, const SmallMotions& motions, bool constant,
                         const SteadyRotation* rotation = nullptr) {
  Linearization linear;
  const System& system = *model.system;
  linear.state = motions.state();
  linear.motion = linear_motion(motions);
  linear.ports = ports(model);
  linear.outputs.resize(static_cast<Index>(linear.ports.outputs.size()));
  outputs(model, linear.state,
          {linear.outputs.data(), static_cast<std::size_t>(linear.outputs.size())});
  if (!constant) {
    linear.notes.emplace_back(
        "the state moves, and its constraints with it: there are the equations of all motions, and "
        "no matrices on the constraints");
    leave_out(linear, {integrals(model)});
    return linear;
  }
  linear.reduced = reduced_motion(system, linear.motion);
  for (const bool rate : {false, true})
    for (const Index motion : linear.reduced->coordinates)
      linear.states.push_back({(rate ? "rate of " : "") + name_of_coordinate(system, motion),
                               std::string(motion % 6 < 3 ? "m" : "rad") + (rate ? "/s" : ""),
                               "axes of the node"});
  add_outputs(model, linear);
  std::vector<LeftOut> left{integrals(model)};
  if (rotation != nullptr) {
    const InTurningAxes turning(model, *rotation, linear.state);
    turning.check_inputs(linear.motion.F);
    left.push_back(turning.not_constant(linear));
    for (Port& port : linear.ports.outputs)
      if (port.frame == schema::in_words(schema::Quantity::Axes::inertial))
        port.frame = "axes that turn, at t = 0 inertial";
  }
  leave_out(linear, left);
  return linear;
}

Json rows_of(const MatX& matrix) {
  Json rows = Json::array();
  for (Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json names_of(const std::vector<Port>& all) {
  Json names = Json::array();
  for (const Port& port : all) {
    names.push_back({{"name", port.name}, {"unit", port.unit}});
    if (!port.frame.empty()) names.back()["frame"] = port.frame;
  }
  return names;
}

std::string matrix_market(const Eigen::SparseMatrix<double>& matrix) {
  std::string text = fmt::format("%%MatrixMarket matrix coordinate real general\n{} {} {}\n",
                                 matrix.rows(), matrix.cols(), matrix.nonZeros());
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it)
      text += fmt::format("{} {} {:.17g}\n", it.row() + 1, it.col() + 1, it.value());
  return text;
}

}  // namespace

Linearization linearize(const Scene& scene, const ModesOptions& options, bool growth) {
  if (options.rotation && options.time)
    throw Error(scene.source,
                "linearize: about a steady rotation, or about a state of a run, not both");
  MotionsOfScene of_scene(scene, options.time);
  if (options.rotation) {
    SteadyRotation rotation = *options.rotation;
    if (!options.at_rest.empty()) rotation.rests = of_scene.nodes_of(options.at_rest);
    of_scene.turn(rotation);
    if (of_scene.axes() == ModeAxes::resting)
      throw Error(scene.source,
                  "linearize: the coefficients are constant in axes that rest only, in which nodes "
                  "turn; name what does not turn, or make it alike in all directions");
  }
  of_scene.require_linear();
  try {
    Linearization linear =
        of_motions(of_scene.model(), of_scene.motions(), !options.time, of_scene.rotation());
    if (growth && linear.reduced) linear.growth = growth_of(of_scene.motions(), *linear.reduced);
    linear.model = scene.name;
    linear.file = scene.file;
    linear.rotation = options.rotation;
    linear.time = options.time;
    const std::vector<std::string> notes = of_scene.notes_on_state();
    linear.notes.insert(linear.notes.end(), notes.begin(), notes.end());
    return linear;
  } catch (const Error& error) {
    throw Error(scene.source, std::string("linearize: ") + error.what());
  }
}

Linearization linearize(const Model& model, const State& given) {
  const System& system = *model.system;
  check_motion(system, 0.0);
  check_sizes(system, given);
  State state = given;
  if (const std::string failure = make_consistent(system, state); !failure.empty())
    throw Error("linearize: " + failure);
  if (const std::string why = why_not_linear(system, state); !why.empty())
    throw Error("linearize: " + why);
  SmallMotions motions(system);
  const double L = system.length_scale();
  const auto rests = [&](const std::vector<Vec6>& all) {
    constexpr double still = 1e-6;
    return std::all_of(all.begin(), all.end(), [&](const Vec6& v) {
      return v.head<3>().norm() <= still * L && v.tail<3>().norm() <= still;
    });
  };
  const bool equilibrium = rests(state.V) && rests(state.Vdot);
  if (!(equilibrium ? motions.about(state) : motions.frozen_at(state)))
    throw Error("linearize: " + range_failure(system.out_of_range(state)));
  return of_motions(model, motions, equilibrium);
}

void write_linearization(const Linearization& linear, const std::filesystem::path& directory) {
  Json all = Json::object();
  all["model"] = linear.model;
  all["file"] = linear.file;
  if (linear.rotation) all["rate"] = {{"value", linear.rotation->rate}, {"unit", "rad/s"}};
  if (linear.time) all["time"] = {{"value", *linear.time}, {"unit", "s"}};
  all["inputs"] = names_of(linear.ports.inputs);
  for (std::size_t i = 0; i < linear.state.inputs.size(); ++i)
    all["inputs"][i]["value"] = linear.state.inputs[i].at(linear.state.t).v;
  all["outputs"] = names_of(linear.ports.outputs);
  for (std::size_t i = 0; i < linear.ports.outputs.size(); ++i)
    all["outputs"][i]["value"] = linear.outputs(static_cast<Index>(i));
  if (linear.reduced) {
    all["states"] = names_of(linear.states);
    all["E"] = rows_of(linear.reduced->E);
    all["A"] = rows_of(linear.reduced->A);
    all["B"] = rows_of(linear.reduced->G);
    all["C"] = rows_of(linear.C);
    all["D"] = rows_of(linear.D);
  }
  all["notes"] = linear.notes;
  write_file(directory / "linear.json", all.dump() + "\n");
  write_file(directory / "M.mtx", matrix_market(linear.motion.M));
  write_file(directory / "C.mtx", matrix_market(linear.motion.C));
  write_file(directory / "K.mtx", matrix_market(linear.motion.K));
  write_file(directory / "G.mtx", matrix_market(linear.motion.B));
  write_file(directory / "F.mtx", matrix_market(linear.motion.F.sparseView(0.0, 0.0)));
}

std::string to_text(const Linearization& linear) {
  std::string text = fmt::format("{}, linearised about {}\n", linear.model,
                                 linear.rotation ? "a steady rotation"
                                 : linear.time ? fmt::format("its state at {:.9g} s", *linear.time)
                                               : std::string("its equilibrium"));
  text += fmt::format("{} motions of nodes, {} rows of constraints, {} inputs, {} outputs\n",
                      linear.motion.M.rows(), linear.motion.B.rows(), linear.ports.inputs.size(),
                      linear.ports.outputs.size());
  if (linear.reduced) {
    text += fmt::format("{} states", linear.states.size());
    if (linear.growth)
      text += *linear.growth > 0.0
                  ? fmt::format("; unstable: something grows as exp({:.6g} t)", *linear.growth)
                  : std::string("; nothing grows (mbd modes has the poles)");
    text += "\n";
    std::vector<std::vector<std::string>> table{{"state", "unit"}};
    constexpr std::size_t most = 12;
    for (std::size_t i = 0; i < linear.states.size() / 2 && i < most; ++i)
      table.push_back({linear.states[i].name, linear.states[i].unit});
    if (linear.states.size() / 2 > most)
      table.push_back({fmt::format("and {} more", linear.states.size() / 2 - most), ""});
    table.push_back({"and their rates", ""});
    text += "\n";
    study::table(text, table);
  }
  for (const std::string& note : linear.notes) text += "\nnote: " + note + "\n";
  return text;
}

}  // namespace mbd
