#include "libmbd/core/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace mbd {

System::System() { add_node("ground", Pose<double>{}); }

Index System::add_node(std::string name, const Pose<double>& pose) {
  node_names_.push_back(std::move(name));
  reference_.push_back(pose);
  return nodes() - 1;
}

Index System::add_constraint(ConstraintInfo info) {
  info.first_row = multipliers_;
  multipliers_ += info.rows;
  constraints_.push_back(std::move(info));
  return constraints_.back().first_row;
}

Index System::add_signal(Signal signal, SignalUse use, std::string name) {
  signals_.push_back(std::move(signal));
  signal_uses_.push_back(use);
  signal_names_.push_back(std::move(name));
  return static_cast<Index>(signals_.size()) - 1;
}

Index System::add_input(InputInfo input) {
  inputs_.push_back(std::move(input));
  return static_cast<Index>(inputs_.size()) - 1;
}

Index System::add_sensor(std::unique_ptr<Sensor> sensor) {
  sensors_.push_back(std::move(sensor));
  return static_cast<Index>(sensors_.size()) - 1;
}

void System::feed_back(Index signal, std::vector<std::size_t> sensors) {
  feedback_.push_back({static_cast<std::size_t>(signal), std::move(sensors)});
}

void System::add_controller(std::unique_ptr<Controller> controller) {
  controllers_.push_back(std::move(controller));
}

Index System::add_angle() { return angles_++; }

void System::add_batch(std::unique_ptr<Batch> batch) { batches_.push_back(std::move(batch)); }

void System::finish(bool with_rates, double length_scale) {
  with_rates_ = with_rates;
  length_scale_ = length_scale;
  graph_ = {};
  for (Index n = 1; n < nodes(); ++n) graph_.blocks.push_back({6, BlockGraph::Kind::node});
  for (const ConstraintInfo& c : constraints_)
    graph_.blocks.push_back({static_cast<int>(c.rows), BlockGraph::Kind::multiplier});
  for (const auto& batch : batches_) {
    first_contributions_.push_back(graph_.contributions.size());
    batch->connect(graph_);
  }
  first_contributions_.push_back(graph_.contributions.size());
  connect_feedback();
  // Of statics nothing may touch a body, which is then neutral in all its motions.
  std::vector<char> touched(static_cast<std::size_t>(nodes() - 1), 0);
  for (const auto& [row, column] : graph_.contributions)
    if (row == column && row >= 0 && row + 1 < nodes()) touched[static_cast<std::size_t>(row)] = 1;
  for (int n = 0; n + 1 < nodes(); ++n)
    if (touched[static_cast<std::size_t>(n)] == 0) graph_.contributions.push_back({n, n});
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const int accelerates = signal_uses_[i] == SignalUse::drive ? 2 : 0;
    for (const Jump& jump : signals_[i].jumps())
      breakpoints_.push_back({jump.t, jump.derivative <= accelerates});
    for (const double t : signals_[i].breakpoints()) breakpoints_.push_back({t, false, true});
  }
  // Of equals, the restart is kept, or else what is not smooth.
  std::sort(breakpoints_.begin(), breakpoints_.end(), [](const Breakpoint& a, const Breakpoint& b) {
    return std::tuple(a.t, !a.restart, a.smooth) < std::tuple(b.t, !b.restart, b.smooth);
  });
  breakpoints_.erase(
      std::unique(breakpoints_.begin(), breakpoints_.end(),
                  [](const Breakpoint& a, const Breakpoint& b) { return a.t == b.t; }),
      breakpoints_.end());
}

void System::allow_idle_rows() {
  const int first = static_cast<int>(nodes()) - 1;
  touching_.resize(constraints_.size());
  for (std::size_t i = 0; i < graph_.contributions.size(); ++i) {
    const auto [row, column] = graph_.contributions[i];
    if (row >= first) touching_[static_cast<std::size_t>(row - first)].push_back({i, true});
    if (column >= first) touching_[static_cast<std::size_t>(column - first)].push_back({i, false});
  }
  first_own_ = graph_.contributions.size();
  for (int c = 0; c < static_cast<int>(constraints_.size()); ++c)
    graph_.contributions.push_back({first + c, first + c});
}

State System::reference_state() const {
  State state;
  state.pose = reference_;
  if (with_rates_) {
    state.V.assign(reference_.size(), Vec6::Zero());
    state.Vdot.assign(reference_.size(), Vec6::Zero());
  }
  state.lambda = VecX::Zero(multipliers_);
  state.signals.resize(signals_.size());
  state.inputs = initial_inputs();
  for (const auto& controller : controllers_) {
    state.control.push_back(0.0);
    const std::vector<double> own = controller->initial();
    state.control.insert(state.control.end(), own.begin(), own.end());
  }
  state.angles.assign(static_cast<std::size_t>(angles_), 0.0);
  set_time(state, 0.0);
  return state;
}

std::vector<InputValue> System::initial_inputs() const {
  std::vector<InputValue> values;
  for (const InputInfo& input : inputs_) values.push_back({.f = input.initial});
  return values;
}

void System::set_time(State& state, double t, Side side) const {
  state.t = t;
  state.side = side;
  signals_at(t, side, state.inputs, state.signals);
}

void System::signals_at(double t, Side side, std::span<const InputValue> inputs,
                        std::vector<SignalValue>& signals, const State* motion) const {
  signals.resize(signals_.size());
  for (std::size_t i = 0; i < signals_.size(); ++i) signals[i] = signals_[i](t, side, inputs);
  std::vector<double> readings;
  for (const Feedback& f : feedback_) {
    signals[f.signal] = {0.0, 0.0, 0.0};
    if (motion == nullptr) continue;
    read(f, *motion, readings);
    const Taylor2 law = (*f.law)(t, side, inputs, readings);
    signals[f.signal] = {law.v, law.d, law.dd};
  }
}

// --- laws with sensors ---

// Where its loads act is seen in the reference configuration: a node that a load acts on it acts on everywhere.
void System::connect_feedback() {
  if (feedback_.empty()) return;
  State state = reference_state();
  VecX with, without;
  for (Feedback& f : feedback_) {
    bool is_rate = false;
    f.law = signals_[f.signal].expression(is_rate);
    std::vector<char> acts(node_names_.size(), 0);
    for (const auto& batch : batches_) {
      const auto load = [&](double value, VecX& r) {
        for (SignalValue& signal : state.signals) signal = {};
        state.signals[f.signal].f = value;
        r.setZero(rows());
        batch->load_rate(state, r);
      };
      load(1.0, with);
      load(0.0, without);
      bool any = false;
      for (Index n = 0; n < nodes(); ++n)
        if (with.segment<6>(6 * n) != without.segment<6>(6 * n)) {
          any = true;
          if (n > 0) acts[static_cast<std::size_t>(n)] = 1;
        }
      if (any) f.loads.push_back(batch.get());
    }
    for (std::size_t n = 0; n < acts.size(); ++n)
      if (acts[n] != 0) f.acts_on.push_back(static_cast<int>(n));
    for (const std::size_t s : f.sensors)
      for (const int node : sensors_[s]->nodes())
        if (std::find(f.looks_at.begin(), f.looks_at.end(), node) == f.looks_at.end())
          f.looks_at.push_back(node);
    f.first_slot = graph_.contributions.size();
    for (const int column : f.looks_at)
      for (const int row : f.acts_on) graph_.contributions.push_back({row - 1, column - 1});
  }
}

void System::read(const Feedback& f, const State& state, std::vector<double>& readings) const {
  readings.clear();
  for (const std::size_t s : f.sensors) readings.push_back(sensors_[s]->value(state));
}

double System::value_of(const Feedback& f, const State& state,
                        std::vector<double>& readings) const {
  read(f, state, readings);
  return (*f.law)(state.t, state.side, state.inputs, readings).v;
}

const State& System::fed_back(const State& state) const {
  if (feedback_.empty()) return state;
  thread_local State fed;
  thread_local std::vector<double> readings;
  fed = state;
  for (const Feedback& f : feedback_) {
    const double value = value_of(f, state, readings);
    if (std::isfinite(value)) fed.signals[f.signal].f += value;  // else feedback_finite() says it
  }
  return fed;
}

bool System::feedback_finite(const State& state) const {
  thread_local std::vector<double> readings;
  return std::all_of(feedback_.begin(), feedback_.end(), [&](const Feedback& f) {
    return std::isfinite(value_of(f, state, readings));
  });
}

void System::force_per_signal(const Feedback& f, const State& state, VecX& p) const {
  thread_local State alone;
  thread_local VecX rest;
  alone = state;
  for (SignalValue& signal : alone.signals) signal = {};
  p.setZero(rows());
  rest.setZero(rows());
  for (const Batch* const batch : f.loads) batch->load_rate(alone, rest);
  alone.signals[f.signal].f = 1.0;
  for (const Batch* const batch : f.loads) batch->load_rate(alone, p);
  p -= rest;
}

template <class F>
void System::each_feedback_block(const State& state, const F& look) const {
  VecX p;
  std::vector<double> readings;
  std::vector<Vec6> by_motion, by_velocity, of_motion, of_velocity;
  for (const Feedback& f : feedback_) {
    read(f, state, readings);
    of_motion.assign(f.looks_at.size(), Vec6::Zero());
    of_velocity = of_motion;
    for (std::size_t s = 0; s < f.sensors.size(); ++s) {
      const Sensor& sensor = *sensors_[f.sensors[s]];
      const double slope = f.law->derivative(s, state.t, state.side, state.inputs, readings);
      if (!std::isfinite(slope)) continue;  // the tangent stays finite
      const std::vector<int> seen = sensor.nodes();
      by_motion.assign(seen.size(), Vec6::Zero());
      by_velocity = by_motion;
      sensor.derive(state, by_motion, by_velocity);
      for (std::size_t i = 0; i < seen.size(); ++i) {
        const auto at = static_cast<std::size_t>(
            std::find(f.looks_at.begin(), f.looks_at.end(), seen[i]) - f.looks_at.begin());
        of_motion[at] += slope * by_motion[i];
        of_velocity[at] += slope * by_velocity[i];
      }
    }
    force_per_signal(f, state, p);
    std::size_t slot = f.first_slot;
    for (std::size_t c = 0; c < f.looks_at.size(); ++c)
      for (const int row : f.acts_on) {
        const Vec6 force = state.load_factor * p.segment<6>(6 * static_cast<Index>(row));
        look(Mat6(force * of_motion[c].transpose()), Mat6(force * of_velocity[c].transpose()),
             static_cast<std::size_t>(f.looks_at[c]), slot++);
      }
  }
}

namespace {

void add_block(const Slot& slot, const Mat6& block) {
  Eigen::Map<Mat6, 0, Eigen::OuterStride<>>(slot.data, Eigen::OuterStride<>(slot.ld)) += block;
}

}  // namespace

// U: of the increments, 0 for rates alone.
void System::add_feedback(const State& state, const TangentWeights& weights, double U,
                          std::span<const Slot> slots) const {
  if (feedback_.empty()) return;
  each_feedback_block(state, [&](const Mat6& K, const Mat6& C, std::size_t node, std::size_t slot) {
    Mat6 block = U * K;
    if (weights.V != 0.0) block += weights.V * weights.at_node(C, node);
    add_block(slots[slot], block);
  });
}

// --- controllers ---

double System::next_instant(const State& state, double slack) const {
  double next = std::numeric_limits<double>::infinity();
  std::size_t at = 0;
  for (const auto& controller : controllers_) {
    const double period = controller->period();
    double k = std::max(state.control[at], std::floor((state.t + slack) / period));
    while (k * period <= state.t + slack) ++k;
    next = std::min(next, k * period);
    at += 1 + controller->initial().size();
  }
  return next;
}

bool System::sample(State& state, double slack, std::string& failure) const {
  bool any = false;
  std::size_t at = 0;
  for (const auto& controller : controllers_) {
    const double period = controller->period(), k = std::round(state.t / period);
    const std::size_t own = controller->initial().size();
    double& next = state.control[at];
    if (std::abs(k * period - state.t) <= slack && k >= next) {
      any = true;
      next = k + 1.0;
      std::string wrong =
          controller->sample(state, std::span(state.control).subspan(at + 1, own), state.inputs);
      if (failure.empty()) failure = std::move(wrong);
    }
    at += 1 + own;
  }
  return any;
}

std::string System::unusable_signal(const State& state, bool accelerations) const {
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const auto& [f, fdot, fddot] = state.signals[i];
    const bool rates = with_rates_ && signal_uses_[i] == SignalUse::drive;
    const char* of = nullptr;
    double value = 0.0;
    const auto look = [&](double x, const char* what) {
      if (of != nullptr || std::isfinite(x)) return;
      of = what;
      value = x;
    };
    look(f, "");
    if (rates) look(fdot, ", its rate,");
    if (rates && accelerations) look(fddot, ", its second derivative,");
    if (of == nullptr) continue;
    return fmt::format(
        "{}{} is {} at t = {:.9g} s; choose another law there by condition ? value : value, or end "
        "the run before",
        signal_names_[i].empty() ? fmt::format("signal {}", i + 1) : signal_names_[i], of,
        std::isnan(value) ? "not a number" : fmt::format("{}", value), state.t);
  }
  return {};
}

bool System::residual(const State& given, VecX& r) const {
  const State& state = fed_back(given);
  r.setZero(rows());
  bool in_range = feedback_finite(state);
  for (const auto& batch : batches_) in_range &= batch->residual(state, r);
  clear_idle(state, r, 6 * nodes());
  return in_range;
}

void System::clear_idle(const State& state, VecX& multipliers, Index first) const {
  for (const Index row : state.idle) multipliers(first + row) = 0.0;
}

bool System::linearize(const State& state, const TangentWeights& weights, VecX& r,
                       LinearSolver& S) const {
  S.set_zero();
  return linearize(state, weights, r, S.slots());
}

bool System::linearize(const State& given, const TangentWeights& weights, VecX& r,
                       std::span<const Slot> slots) const {
  const State& state = fed_back(given);
  r.setZero(rows());
  bool in_range = feedback_finite(state);
  for (const auto& batch : batches_) in_range &= batch->linearize(state, weights, r, slots);
  add_feedback(state, weights, weights.U, slots);
  leave_out_idle(state, r, slots);
  return in_range;
}

bool System::linearize_powers(const State& given, std::span<const Mat6> V_hat, VecX& r,
                              const std::array<std::span<const Slot>, 3>& P) const {
  const State& state = fed_back(given);
  r.setZero(rows());
  bool in_range = feedback_finite(state);
  for (const auto& batch : batches_) in_range &= batch->linearize_powers(state, V_hat, r, P);
  if (feeds_back())
    each_feedback_block(state,
                        [&](const Mat6& K, const Mat6& C, std::size_t node, std::size_t slot) {
                          add_block(P[0][slot], K + C * V_hat[node]);
                          add_block(P[1][slot], C);
                        });
  leave_out_idle(state, r, P[0]);
  return in_range;
}

Index System::resultant_count() const {
  Index sum = 0;
  for (const auto& batch : batches_) sum += batch->resultant_count();
  return sum;
}

void System::linearized_resultants(const State& state, const VecX& dU, std::vector<Vec6>& S) const {
  S.resize(static_cast<std::size_t>(resultant_count()));
  std::size_t first = 0;
  for (const auto& batch : batches_) {
    const auto count = static_cast<std::size_t>(batch->resultant_count());
    if (count == 0) continue;
    batch->linearized_resultants(state, {dU.data(), static_cast<std::size_t>(dU.size())},
                                 std::span(S).subspan(first, count));
    first += count;
  }
}

bool System::linearize_mixed(const State& given, std::span<const Vec6> S, VecX& r,
                             LinearSolver& solver) const {
  if (S.empty()) return linearize(given, {}, r, solver);
  const State& state = fed_back(given);
  solver.set_zero();
  r.setZero(rows());
  bool in_range = feedback_finite(state);
  std::size_t first = 0;
  for (const auto& batch : batches_) {
    const auto count = static_cast<std::size_t>(batch->resultant_count());
    in_range &= batch->linearize_mixed(state, S.subspan(first, count), r, solver.slots());
    first += count;
  }
  add_feedback(state, {}, 1.0, solver.slots());
  leave_out_idle(state, r, solver.slots());
  return in_range;
}

void System::leave_out_idle(const State& state, VecX& r, std::span<const Slot> slots) const {
  if (state.idle.empty()) return;
  clear_idle(state, r, 6 * nodes());
  for (std::size_t c = 0, next = 0; c < constraints_.size() && next < state.idle.size(); ++c)
    for (; next < state.idle.size() &&
           state.idle[next] < constraints_[c].first_row + constraints_[c].rows;
         ++next) {
      const Index i = state.idle[next] - constraints_[c].first_row;
      for (const Touching& t : touching_[c]) {
        const Slot& slot = slots[t.contribution];
        for (Index j = 0; j < 6; ++j)
          slot.data[t.in_rows ? i + j * slot.ld : j + i * slot.ld] = 0.0;
      }
      const Slot& own = slots[first_own_ + c];
      own.data[i * (own.ld + 1)] -= 1.0;
    }
}

void System::add_rate_tangent(const State& given, const TangentWeights& weights,
                              std::span<const Slot> slots) const {
  const State& state = fed_back(given);
  for (const auto& batch : batches_) batch->add_rate_tangent(state, weights, slots);
  add_feedback(state, weights, 0.0, slots);
}

void System::load_rate(const State& given, VecX& r) const {
  const State& state = fed_back(given);
  r.setZero(rows());
  for (const auto& batch : batches_) batch->load_rate(state, r);
  clear_idle(state, r, 6 * nodes());
}

std::string System::out_of_range(const State& given) const {
  const State& state = fed_back(given);
  std::vector<double> readings;
  for (const Feedback& f : feedback_)
    if (!std::isfinite(value_of(f, given, readings)))
      return signal_names_[f.signal] + " is not finite";
  for (const auto& batch : batches_) {
    if (std::string name = batch->out_of_range(state); !name.empty()) return name;
  }
  return {};
}

void System::law_arguments(const State& given, std::vector<LawArgument>& all) const {
  const State& state = fed_back(given);
  all.clear();
  for (const auto& batch : batches_) batch->law_arguments(state, all);
}

std::vector<NearKink> System::near_kinks(const State& state) const {
  std::vector<LawArgument> arguments;
  law_arguments(state, arguments);
  std::vector<NearKink> all;
  for (const LawArgument& one : arguments)
    if (const auto kink = one.law->nearest_kink(one.x))
      all.push_back({*one.element, one.x, *kink, one.of});
  return all;
}

void System::each_law_of_sensors(const State& state,
                                 const std::function<void(const std::string&, const Expression&,
                                                          std::span<const double>)>& look) const {
  std::vector<double> readings;
  for (const Feedback& f : feedback_) {
    read(f, state, readings);
    look(signal_names_[f.signal], *f.law, readings);
  }
}

void System::constraints(const State& state, VecX& g, VecX& gdot) const {
  g.setZero(multipliers_);
  gdot.setZero(multipliers_);
  for (const auto& batch : batches_) batch->constraints(state, g, gdot);
  clear_idle(state, g, 0);
  clear_idle(state, gdot, 0);
}

void System::constraint_rates(const State& state, VecX& gdot, VecX& gddot_rest) const {
  gdot.setZero(multipliers_);
  gddot_rest.setZero(multipliers_);
  for (const auto& batch : batches_) batch->constraint_rates(state, gdot, gddot_rest);
  clear_idle(state, gdot, 0);
  clear_idle(state, gddot_rest, 0);
}

void System::follow_angles(State& state) const {
  for (const auto& batch : batches_) batch->follow_angles(state);
}

Energies System::energies(const State& state) const {
  Energies sum;
  for (const auto& batch : batches_) {
    const Energies one = batch->energies(state);
    sum.kinetic += one.kinetic;
    sum.strain += one.strain;
    sum.potential += one.potential;
  }
  return sum;
}

Work System::power(const State& given) const {
  const State& state = fed_back(given);
  Work sum;
  for (const auto& batch : batches_)
    sum += {batch->load_power(state), batch->drive_power(state), batch->damping_power(state)};
  return sum;
}

void System::momenta(const State& state, std::span<Vec6> p) const {
  std::fill(p.begin(), p.end(), Vec6::Zero());
  for (const auto& batch : batches_) batch->add_momenta(state, p);
}

Vec6 System::momentum(const State& state) const {
  std::vector<Vec6> p(state.pose.size());
  momenta(state, p);
  Vec6 sum = Vec6::Zero();
  for (std::size_t n = 1; n < p.size(); ++n) sum += inertial_wrench(state.pose[n], p[n]);
  return sum;
}

std::string System::name_of(Index row) const {
  static constexpr std::array components{"force 1",  "force 2",  "force 3",
                                         "moment 1", "moment 2", "moment 3"};
  if (row < 0 || row >= rows()) return "no equation";
  if (row < 6 * nodes())
    return fmt::format("{}, {}", node_name(row / 6), components[static_cast<std::size_t>(row % 6)]);
  const Index multiplier = row - 6 * nodes();
  const auto behind =
      std::upper_bound(constraints_.begin(), constraints_.end(), multiplier,
                       [](Index m, const ConstraintInfo& c) { return m < c.first_row + c.rows; });
  return fmt::format("{}, {}", behind->name,
                     behind->row_names[static_cast<std::size_t>(multiplier - behind->first_row)]);
}

}  // namespace mbd
