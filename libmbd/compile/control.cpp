#include "libmbd/compile/control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "elements/node/place_sensor.hpp"
#include "joints/coordinate_sensor.hpp"
#include "libmbd/core/hash.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

constexpr double most_instants = 1e7;  // of one controller in a run

template <class Items>
bool has_named(const Items& items, std::string_view name) {
  return std::any_of(items.begin(), items.end(), [&](const auto& x) { return x.name == name; });
}

// A controller of the scene at work.
class SampledController final : public Controller {
 public:
  // A number that its expressions know: one of its own states, or one of the motion.
  struct Reading {
    int own = -1;
    std::function<double(const State&)> sensor;
  };
  struct Law {
    Expression law;
    std::vector<Reading> readings;
  };
  struct Next {  // of an own state
    Law law;
    std::size_t own;
  };
  struct Output {
    Law law;
    std::size_t input;
    std::string name;
  };
  // Own states from `own` on: integrator, derivative, the last error, and whether there was one.
  struct Pid {
    Law error;
    std::size_t input, own;
    std::string name;
    double proportional, integral, derivative, filter;
    std::optional<std::array<double, 2>> limits;
  };
  struct Matrices {
    std::vector<Law> w;
    std::size_t own;
    std::vector<std::size_t> inputs;
    std::vector<double> A, B, C, D;
    std::string name;
  };
  using Part = std::variant<Next, Output, Pid, Matrices>;

  SampledController(std::string name, double period) : name_(std::move(name)), period_(period) {}

  std::string name() const override { return name_; }
  double period() const override { return period_; }
  std::vector<double> initial() const override { return initial_; }

  std::uint64_t signature() const override {
    Hash hash;
    hash.add(std::span<const double>(initial_));
    const auto law = [&](const Law& x) { hash.add(x.law.signature()); };
    const auto rows = [&](const auto&... row) { (hash.add(std::span<const double>(row)), ...); };
    const field::Overloaded part_of{
        [&](const Next& x) {
          law(x.law);
          hash.add(x.own);
        },
        [&](const Output& x) {
          law(x.law);
          hash.add(x.input);
        },
        [&](const Pid& x) {
          law(x.error);
          hash.add(x.input);
          for (const double number : {x.proportional, x.integral, x.derivative, x.filter})
            hash.add(number);
          if (x.limits) rows(*x.limits);
        },
        [&](const Matrices& x) {
          for (const Law& w : x.w) law(w);
          for (const std::size_t input : x.inputs) hash.add(input);
          rows(x.A, x.B, x.C, x.D);
        }};
    for (const Part& part : parts_) {
      hash.add(part.index());
      std::visit(part_of, part);
    }
    return hash.value();
  }

  std::size_t add_state(double start) {
    initial_.push_back(start);
    return initial_.size() - 1;
  }
  void add(Part part) { parts_.push_back(std::move(part)); }

  std::string sample(const State& state, std::span<double> own,
                     std::vector<InputValue>& inputs) const override {
    const std::vector<double> now(own.begin(), own.end());  // the states as they are
    const auto value = [&](const Law& law) {
      std::vector<double> readings;
      for (const Reading& r : law.readings)
        readings.push_back(r.own >= 0 ? now[static_cast<std::size_t>(r.own)] : r.sensor(state));
      return law.law(state.t, Side::right, inputs, readings).v;
    };
    std::string wrong;
    const auto check = [&](double x, const std::string& of) {
      if (!std::isfinite(x) && wrong.empty())
        wrong =
            fmt::format("controller \"{}\": {} is {}; look at what it is made of", name_, of, x);
      return x;
    };
    const auto hold = [&](std::size_t input, double u, const std::string& of) {
      inputs[input].hold(check(u, of), state.t);
    };
    const field::Overloaded run{
        [&](const Next& x) { own[x.own] = check(value(x.law), "a state"); },
        [&](const Output& x) { hold(x.input, value(x.law), "the output \"" + x.name + "\""); },
        [&](const Pid& x) {
          // P = kp e; D: (Tf + T) D_k = Tf D_(k-1) + kd (e_k - e_(k-1)); I_(k+1) = I_k + ki T e_k, but
          // where the output is at a limit and the error drives it further.
          const double e = value(x.error);
          double* const s = own.data() + x.own;
          const double before = s[3] != 0.0 ? s[2] : e;
          if (x.derivative != 0.0)
            s[1] = (x.filter * s[1] + x.derivative * (e - before)) / (x.filter + period_);
          const double wanted = x.proportional * e + s[0] + s[1];
          const double u = x.limits ? std::clamp(wanted, (*x.limits)[0], (*x.limits)[1]) : wanted;
          const double growth = x.integral * period_ * e;
          if (!((wanted > u && growth > 0.0) || (wanted < u && growth < 0.0))) s[0] += growth;
          s[2] = e;
          s[3] = 1.0;
          hold(x.input, u, "the output \"" + x.name + "\"");
        },
        [&](const Matrices& x) {
          std::vector<double> w;
          for (const Law& law : x.w) w.push_back(value(law));
          const std::size_t n = x.w.empty() ? 0 : x.B.size() / x.w.size(), m = w.size();
          const auto row = [&](const std::vector<double>& of_x, const std::vector<double>& of_w,
                               std::size_t i) {
            double sum = 0.0;
            for (std::size_t j = 0; j < n; ++j) sum += of_x[i * n + j] * now[x.own + j];
            for (std::size_t j = 0; j < m; ++j) sum += of_w[i * m + j] * w[j];
            return sum;
          };
          for (std::size_t i = 0; i < x.inputs.size(); ++i)
            hold(x.inputs[i], row(x.C, x.D, i), x.name);
          for (std::size_t i = 0; i < n; ++i) own[x.own + i] = check(row(x.A, x.B, i), x.name);
        }};
    for (const Part& part : parts_) std::visit(run, part);
    return wrong;
  }

 private:
  std::string name_;
  double period_;
  std::vector<double> initial_;
  std::vector<Part> parts_;
};

using Fail = std::function<Error(const std::string&)>;  // in the name of a sensor

// The place on a beam that `rest` begins with, which is taken off.
Place place_on_beam(const std::string& beam, std::string_view& rest, const Fail& fail) {
  Place place{Place::Kind::beam, beam, 0.0};
  if (rest.starts_with(".end")) {
    place.parameter = 1.0;
    rest.remove_prefix(4);
  } else if (rest.starts_with(".start")) {
    rest.remove_prefix(6);
  } else {
    const char* const from = rest.data() + (rest.starts_with('@') ? 1 : 0);
    const auto [end, error] =
        std::from_chars(from, rest.data() + rest.size(), place.parameter, std::chars_format::fixed);
    if (!rest.starts_with('@') || error != std::errc() ||
        !(place.parameter >= 0.0 && place.parameter <= 1.0))
      throw fail(
          fmt::format("\"{}\" is a beam; write {}.start, {}.end or {}@0.5 before the "
                      "quantity, as {}.end.displacement.1",
                      beam, beam, beam, beam, beam));
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  }
  return place;
}

// What `first` names; `rest` follows it.
void find_thing(const Scene& scene, const std::string& first, std::string_view& rest,
                RecordScene& record, const Fail& fail) {
  if (has_named(scene.joints, first) || has_named(scene.motions, first)) {
    record.joint = first;
  } else if (has_named(scene.bodies, first)) {
    record.at = Place{Place::Kind::body, first, 0.0};
  } else if (has_named(scene.beams, first)) {
    record.at = place_on_beam(first, rest, fail);
  } else if (has_named(scene.springs, first) || has_named(scene.bushings, first) ||
             has_named(scene.joint_springs, first)) {
    record.spring = first;
  } else {
    std::vector<std::string_view> known;
    const auto add = [&](const auto& items) {
      for (const auto& item : items) known.push_back(item.name);
    };
    add(scene.joints);
    add(scene.motions);
    add(scene.bodies);
    add(scene.beams);
    add(scene.springs);
    add(scene.bushings);
    add(scene.joint_springs);
    throw fail(fmt::format("there is no joint, body, beam or spring \"{}\"{}", excerpt(first),
                           suggest(first, known, "things with sensors")));
  }
}

}  // namespace

SensorName find_sensor(const Scene& scene, const std::string& name, const std::string& who) {
  const std::size_t cut = std::min(name.find_first_of(".@"), name.size());
  const std::string first = name.substr(0, cut);
  std::string_view rest = std::string_view(name).substr(cut);
  const auto fail = [&](const std::string& what) -> Error {
    return Error(fmt::format("{}: sensor \"{}\": {}", who, excerpt(name), what));
  };
  SensorName found;
  RecordScene& record = found.record;
  record.name = name;
  find_thing(scene, first, rest, record, fail);
  if (rest.starts_with('.')) rest.remove_prefix(1);
  const std::size_t dot = std::min(rest.find('.'), rest.size());
  const std::string_view quantity = rest.substr(0, dot);
  const auto all = schema::quantities_of(record);
  found.quantity = schema::find_quantity(all, quantity);
  if (found.quantity == nullptr) {
    const std::vector<std::string_view> known = schema::names(all);
    throw fail(quantity.empty()
                   ? "the quantity is missing, as in " + name + "." + std::string(known.front())
                   : "there is no quantity \"" + excerpt(quantity) + "\"" +
                         suggest(quantity, known, "quantities"));
  }
  if (schema::needs_beam(record, *found.quantity))
    throw fail(
        fmt::format("{} is a resultant of a beam; read it at a beam, as beam@0.5.{}.1, or "
                    "of a joint, as its reaction_{}",
                    quantity, quantity, quantity == "moment" ? "moment" : "force"));
  if (found.quantity->of_section_point())
    throw fail(
        fmt::format("{} is of a point of a section, which sensors do not name; read "
                    "the beam's force and moment",
                    quantity));
  record.quantities = {std::string(quantity)};
  const std::string_view component = dot < rest.size() ? rest.substr(dot + 1) : "";
  if (found.quantity->components == 1) {
    if (!component.empty())
      throw fail(fmt::format("{} is one number; leave out .{}", quantity, component));
    return found;
  }
  if (component.size() != 1 || component[0] < '1' || component[0] > '3')
    throw fail(fmt::format("{} has three components; write .1, .2 or .3 behind it", quantity));
  found.component = component[0] - '1';
  return found;
}

std::unique_ptr<Sensor> ControlCompiler::make_sensor(const SensorName& of,
                                                     const std::string& who) const {
  const schema::Quantity& q = *of.quantity;
  const auto refuse = [&](std::string_view instead) -> Error {
    return Error(fmt::format("{}: sensor \"{}\": a law that acts at once cannot use {}: {}", who,
                             of.record.name, q.name, instead));
  };
  if (of.record.joint) {
    using Of = schema::Quantity::Of;
    if (q.of != Of::joint_with_angle && q.of != Of::joint_with_displacement)
      throw refuse("it follows from the accelerations; a <controller> may sample it");
    const bool turns = q.of == Of::joint_with_angle;
    const bool rate = q.from == schema::Quantity::From::velocity;
    const joint::Definition& d = joints_.coordinate(
        *of.record.joint, turns, Source{}, fmt::format("{}: sensor \"{}\"", who, of.record.name));
    const joint::Axis axis{{d.a, d.b}, d.angle};
    if (turns)
      return std::make_unique<joint::CoordinateSensor<joint::Turning>>(axis, d.P, d.Q, rate);
    return std::make_unique<joint::CoordinateSensor<joint::Sliding>>(axis, d.P, d.Q, rate);
  }
  if (of.record.at) {
    using Motion = PlaceSensor::Of;
    constexpr std::array<std::pair<std::string_view, Motion>, 6> known{
        {{"position", Motion::position},
         {"displacement", Motion::position},
         {"velocity", Motion::velocity},
         {"angular_velocity", Motion::angular_velocity},
         {"velocity_local", Motion::velocity_local},
         {"angular_velocity_local", Motion::angular_velocity_local}}};
    for (const auto& [name, kind] : known) {
      if (name != q.name) continue;
      const SensorPlace place = find_(of, who);
      if (place.node == 0)
        throw Error(
            fmt::format("{}: sensor \"{}\": it is fixed to the ground and does not move; "
                        "leave it out",
                        who, of.record.name));
      const double from = name == "displacement" ? place.start.r(of.component) : 0.0;
      return std::make_unique<PlaceSensor>(kind, place.node, place.frame, of.component, from);
    }
    throw refuse(
        "it may use position, displacement, velocity, angular_velocity, velocity_local and "
        "angular_velocity_local of places; a <controller> may sample all quantities");
  }
  throw refuse(
      "springs and bushings act at once by themselves, with laws of their own; a <controller> may "
      "sample what they exert");
}

std::size_t ControlCompiler::sensor(const std::string& name, const std::string& who) {
  if (const auto it = known_.find(name); it != known_.end()) return it->second;
  const auto place = static_cast<std::size_t>(
      system_.add_sensor(make_sensor(find_sensor(scene_, name, who), who)));
  known_.emplace(name, place);
  return place;
}

void ControlCompiler::feed_back() {
  for (std::size_t i = 0; i < system_.signals().size(); ++i) {
    if (!system_.signals()[i].has_sensors()) continue;
    bool is_rate = false;
    const Expression& law = *system_.signals()[i].expression(is_rate);
    std::vector<std::size_t> all;
    for (const std::string& name : law.sensors())
      all.push_back(sensor(name, system_.signal_name(i)));
    system_.feed_back(static_cast<Index>(i), std::move(all));
  }
}

// What is held jumps, and a motion must not.
void ControlCompiler::refuse_held_motions() const {
  std::vector<InputValue> held = system_.initial_inputs();
  bool any = false;
  for (std::size_t i = 0; i < held.size(); ++i)
    if (!system_.inputs()[i].set_by.empty()) {
      held[i].f = std::numeric_limits<double>::quiet_NaN();
      any = true;
    }
  if (!any) return;
  for (std::size_t i = 0; i < system_.signals().size(); ++i) {
    const Signal& signal = system_.signals()[i];
    if (system_.signal_use(i) == SignalUse::drive && signal.has_inputs() &&
        std::isnan(signal(0.0, Side::right, held).f) &&
        !std::isnan(signal(0.0, Side::right, system_.initial_inputs()).f))
      throw Error(fmt::format(
          "{}: depends on what a controller holds, which jumps at its instants; a motion must not: "
          "let the controller set a force or a moment (<load>, <joint_torque>)",
          system_.signal_name(i)));
  }
}

namespace {

// One controller of a scene, whose parts are added to `made`.
struct ControllerCompiler {
  const Scene& all;
  const System& system;
  const ReadRecord& read;
  const ControllerScene& scene;
  SampledController& made;
  std::map<std::string, int, std::less<>> own{};  // states

  // What the record of a sensor is refused for, in the sensor's name.
  auto values_of(const SensorName& sensor, const std::string& who) const {
    try {
      return read(sensor);
    } catch (const Error& e) {
      std::string_view why = e.what();
      const std::string as_record = label(sensor.record) + ": ";
      if (why.starts_with(as_record)) why.remove_prefix(as_record.size());
      throw Error(fmt::format("{}: sensor \"{}\": {}", who, sensor.record.name, why), e.kind());
    }
  }

  SampledController::Law law(const Expression& expression, const auto& part) const {
    SampledController::Law result{expression, {}};
    for (const std::string& name : expression.sensors()) {
      if (const auto it = own.find(name); it != own.end()) {
        result.readings.push_back({it->second, {}});
        continue;
      }
      const std::string of = said(part.source, fmt::format("{}: {}", label(scene), label(part)));
      const SensorName sensor = find_sensor(all, name, of);
      result.readings.push_back(
          {-1, [values = values_of(sensor, of), n = sensor.quantity->components,
                i = sensor.component](const State& state) {
             std::array<double, 3> numbers{};
             values(state, std::span(numbers).first(static_cast<std::size_t>(n)));
             return numbers[static_cast<std::size_t>(i)];
           }});
    }
    return result;
  }

  std::size_t input(const std::string& name) const {
    const auto& inputs = system.inputs();
    const auto it = std::find_if(inputs.begin(), inputs.end(),
                                 [&](const InputInfo& info) { return info.name == name; });
    if (it == inputs.end())
      throw Error(scene.source, fmt::format("{}: \"{}\" is not among the scene's inputs; a "
                                            "program that makes a scene adds an InputScene for "
                                            "each output",
                                            label(scene), name));
    return static_cast<std::size_t>(it - inputs.begin());
  }

  void operator()(const ControlStateScene& x) const {
    made.add(SampledController::Next{law(x.next, x), static_cast<std::size_t>(own.at(x.name))});
  }

  void operator()(const ControlOutputScene& x) const {
    made.add(SampledController::Output{law(x.value, x), input(x.name), x.name});
  }

  void operator()(const PidScene& x) const {
    const std::size_t first = made.add_state(x.start);
    for (int i = 0; i < 3; ++i) made.add_state(0.0);
    made.add(SampledController::Pid{law(x.error, x), input(x.name), first, x.name, x.proportional,
                                    x.integral, x.derivative, x.filter, x.limits});
  }

  void operator()(const StateSpaceScene& x) const {
    SampledController::Matrices matrices{{}, 0, {}, x.A, x.B, x.C, x.D, label(x)};
    for (const Expression& w : x.inputs) matrices.w.push_back(law(w, x));
    for (const std::string& name : x.outputs) matrices.inputs.push_back(input(name));
    for (std::size_t i = 0; i < x.start.size(); ++i) {
      const std::size_t place = made.add_state(x.start[i]);
      if (i == 0) matrices.own = place;
    }
    made.add(std::move(matrices));
  }
};

}  // namespace

void ControlCompiler::add_controllers() {
  refuse_held_motions();
  for (const ControllerScene& scene : scene_.controllers) {
    if (!scene_.transient)
      throw Error(scene.source, label(scene) +
                                    ": it samples a motion, and there is none; give a <transient>, "
                                    "or leave it out");
    const double instants = scene_.transient->duration / scene.period;
    if (!(instants <= most_instants))
      throw Error(scene.source,
                  fmt::format("{}: period: {:g} s makes {:.3g} instants in the run, more than "
                              "{:g}; give a longer one",
                              label(scene), scene.period, instants, most_instants));
    auto made = std::make_unique<SampledController>(scene.name, scene.period);
    ControllerCompiler compiler{scene_, system_, read_, scene, *made};
    for (const ControlPart& part : scene.parts)
      if (const auto* const state = std::get_if<ControlStateScene>(&part))
        compiler.own[state->name] = static_cast<int>(made->add_state(state->start));
    for (const ControlPart& part : scene.parts) std::visit(compiler, part);
    system_.add_controller(std::move(made));
  }
}

std::string first_feedback(const Scene& scene) {
  std::string found;
  each_item(scene, [&](const auto& item) {
    if (found.empty() && has_sensors(item)) found = label(item);
  });
  if (found.empty() && !scene.controllers.empty()) found = label(scene.controllers.front());
  return found;
}

}  // namespace mbd
