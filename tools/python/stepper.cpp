// A model that Python carries through time step by step, and states of it.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/constraints/redundancy.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/statics/statics.hpp"
#include "solvers/time/stepper.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/python/background.hpp"
#include "tools/python/errors.hpp"
#include "tools/python/model.hpp"

namespace mbd::python {
namespace {

// Places and nodes of a compiled model, by all their names.
class Names {
 public:
  explicit Names(const Model& model) {
    for (NamedPlace& place : named_places(model)) {
      words_.push_back(place.name);
      places_.emplace(place.name, std::move(place));
    }
  }

  const NamedPlace& find(const std::string& name) const {
    if (const auto found = places_.find(name); found != places_.end()) return found->second;
    throw UnknownName(fmt::format("\"{}\" is not a place that has a node{}", name,
                                  known_names(name, words_, "places and nodes")));
  }
  const std::vector<std::string>& words() const { return words_; }

 private:
  std::map<std::string, NamedPlace> places_;
  std::vector<std::string> words_;
};

py::ssize_t size_of(std::size_t n) { return static_cast<py::ssize_t>(n); }

// Views of the numbers of a state by node. `writable`: into a state that Python owns.
enum class Block { position, quaternion, velocity, acceleration };
py::array view_of(const State& state, Block block, const py::object& owner, bool writable) {
  constexpr auto pose = static_cast<py::ssize_t>(sizeof(Pose<double>));
  constexpr auto number = static_cast<py::ssize_t>(sizeof(double));
  py::ssize_t rows = size_of(state.pose.size()), columns = 6, stride = 6 * number;
  const double* data = nullptr;
  switch (block) {
    case Block::position:
      data = state.pose.front().r.data(), columns = 3, stride = pose;
      break;
    case Block::quaternion:  // x y z w, as Eigen and scipy have it
      data = state.pose.front().p.coeffs().data(), columns = 4, stride = pose;
      break;
    case Block::velocity:
      data = state.V.empty() ? nullptr : state.V.front().data(), rows = size_of(state.V.size());
      break;
    case Block::acceleration:
      data = state.Vdot.empty() ? nullptr : state.Vdot.front().data();
      rows = size_of(state.Vdot.size());
      break;
  }
  static_assert(sizeof(Vec6) == 6 * sizeof(double));
  if (!writable) return view(data, {rows, columns}, {stride, number}, owner);
  return py::array(py::dtype::of<double>(), {rows, columns}, {stride, number}, data, owner);
}

// A copy of all that varies, which belongs to a model.
struct StateHandle {
  std::shared_ptr<const Compiled> of;
  State state;
};

void check_numbers(const StateHandle& handle) {
  const State& state = handle.state;
  const auto refuse = [&](std::size_t node, const char* what) {
    throw UseError(fmt::format("state: {} of node {} ({}) {}", what, node,
                               handle.of->model.system->node_name(static_cast<Index>(node)),
                               "is not finite; give numbers"));
  };
  if (!std::isfinite(state.t)) throw UseError("state: t is not finite");
  for (std::size_t n = 0; n < state.pose.size(); ++n) {
    if (!state.pose[n].r.allFinite()) refuse(n, "the position");
    if (!state.pose[n].p.coeffs().allFinite()) refuse(n, "the quaternion");
    if (!state.V[n].allFinite()) refuse(n, "the velocity");
    constexpr double unit = 1e-6;
    if (const double norm = state.pose[n].p.norm(); std::abs(norm - 1.0) > unit)
      throw UseError(
          fmt::format("state: the quaternion of node {} has length {:.9g}, must be 1", n, norm));
  }
  const Pose<double> ground;
  if (state.pose[0].r != ground.r || state.pose[0].p.coeffs() != ground.p.coeffs())
    throw UseError("state: node 0 is the ground; its pose is the identity and does not change");
  if (!state.V[0].isZero(0.0)) throw UseError("state: node 0 is the ground and does not move");
}

class StepperHandle {
 public:
  StepperHandle(std::shared_ptr<const Compiled> of, const TransientScene& transient)
      : of_(std::move(of)),
        transient_(transient),
        names_(of_->model),
        columns_(columns(of_->model)),
        row_(columns_.size()) {
    const Model& model = of_->model;
    stepper_ = make_stepper(*model.system, transient_);
    state_ = model.initial;
    shares_reactions_ = !model.redundant.empty();
  }

  // From the initial state of the model: its equilibrium first, if it has a <static>. As run() does.
  void start(const std::atomic<bool>& interrupted) {
    const Scene& scene = *of_->scene;
    const System& system = *of_->model.system;
    if (scene.statics) {
      StaticOptions options = static_options(scene, *scene.statics);
      options.accepted = [&](const State&) { return !interrupted; };
      const auto solver = make_linear_solver(scene.statics->linear_solver, PivotOrder::merged);
      const StaticReport report = solve_statics(system, *solver, options, state_);
      if (!report.converged) throw Error(scene.statics->source, "static: " + report.failure);
    }
    check_initial_state(system, state_, 1.0 / transient_.duration);
    begin();
  }

  // From another state: accelerations and multipliers are found anew.
  void start_from(const StateHandle& from) {
    const Lock lock(*this);
    if (from.of != of_)
      throw UseError(
          fmt::format("the state is of another model ({}), not of this one ({}); take it "
                      "from a stepper of the same Model",
                      from.of->scene->name, of_->scene->name));
    check_numbers(from);
    if (from.state.t < 0.0 || !(from.state.t < transient_.duration))
      throw UseError(fmt::format("the state is at t = {:.9g} s; a stepper goes from 0 to {:.9g} s",
                                 from.state.t, transient_.duration));
    const py::gil_scoped_release release;
    State state = from.state;
    for (Pose<double>& H : state.pose) H.p.normalize();
    const System& system = *of_->model.system;
    system.set_time(state, state.t);
    try {
      check_initial_state(system, state, 1.0 / transient_.duration);
    } catch (const Error& error) {
      throw UseError(std::string("the state does not satisfy its constraints: ") + error.what());
    }
    state_ = state;
    begin();
  }

  // `count` steps. Nothing of Python is touched while the lock is released.
  void step(long count) {
    if (count < 1) throw UseError(fmt::format("step({}): give 1 or more", count));
    const Lock lock(*this);
    take_steps(count);
  }

  // Under the lock of who calls it.
  void take_steps(long count) {
    constexpr long looks = 64;  // steps between two looks for Ctrl-C
    StepReport report;
    for (long done = 0; done < count;) {
      {
        const py::gil_scoped_release release;
        const double before = state_.t;
        for (const long until = std::min(count, done + looks); done < until; ++done) {
          if (!transient_.step && at_end()) {
            report.failure.clear();
            break;
          }
          report = stepper_->step(state_);
          if (!report.converged) break;
          last_ = report;
          last_step_ = state_.t - before;
        }
      }
      if (!transient_.step && done < count && report.failure.empty() && at_end())
        raise_run_error(
            fmt::format("{}: the end is reached, t = {:.9g} s; give the stepper a longer "
                        "duration",
                        of_->scene->name, state_.t),
            state_.t, py::none());
      if (done < count && !report.converged)
        raise_run_error(of_->scene->name + ": " + report.failure, state_.t, py::none());
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
  }

  py::array sample(const std::string& name) {
    const Lock lock(*this);
    const Range range = find_columns(columns_, name, of_->scene->name);
    fill_row();
    py::array_t<double> values(size_of(range.count));
    std::copy_n(row_.begin() + static_cast<std::ptrdiff_t>(range.first), range.count,
                values.mutable_data());
    if (range.is_column) return values.attr("reshape")(py::tuple());
    return values;
  }

  py::dict record() {
    const Lock lock(*this);
    fill_row();
    py::dict all;
    for (std::size_t i = 0; i < columns_.size(); ++i) all[py::str(columns_[i].name)] = row_[i];
    return all;
  }

  double angle(const std::string& name) {
    const Lock lock(*this);
    const Model::JointFrames& joint = joint_of(name);
    if (!joint.angle)
      throw UseError(
          fmt::format("joint \"{}\" has no angle; those of revolute, cylindrical and "
                      "screw joints have one",
                      name));
    return joint.angle(state_);
  }

  py::array reaction(const std::string& name) {
    const Lock lock(*this);
    const Model::JointFrames& joint = joint_of(name);
    if (!joint.reaction) throw UseError(fmt::format("joint \"{}\" has no reaction", name));
    const Vec6 reaction = joint.reaction(with_shared_reactions());
    return py::array_t<double>(6, reaction.data());
  }

  // Of a place: p and r of its frame, and its velocity in that frame.
  struct Motion {
    Pose<double> H;
    Vec6 V;
  };
  Motion motion(const std::string& name) {
    const Lock lock(*this);
    const NamedPlace& spot = names_.find(name);
    const auto n = static_cast<std::size_t>(spot.node);
    // A point that moves with the node: v + w x r, then to the axes of the place.
    const Mat3 R = spot.frame.R();
    const Vec3 v = linear<double>(state_.V[n]), w = angular<double>(state_.V[n]);
    const Vec3 at = v + w.cross(spot.frame.r);
    return {state_.pose[n] * spot.frame,
            six<double>(Vec3(R.transpose() * at), Vec3(R.transpose() * w))};
  }

  // ---- inputs
  void set_input(const std::string& name, double value, const std::optional<double>& over,
                 double rate, double acceleration) {
    const Lock lock(*this);
    InputValue& input = state_.inputs[find_input(name)];
    const auto refuse = [&](const std::string& why) {
      return UseError(fmt::format("input \"{}\": {}", name, why));
    };
    if (!std::isfinite(value)) throw refuse("the value is not finite; give a number");
    if (!std::isfinite(rate) || !std::isfinite(acceleration))
      throw refuse("the rate or the acceleration is not finite; give numbers");
    if (!over) {
      input = {value, rate, acceleration, state_.t};
      return;
    }
    constexpr double round_off = 1e-12;  // of times
    if (!(*over > round_off * std::max(1.0, std::abs(state_.t))) || !std::isfinite(*over))
      throw refuse(
          fmt::format("over = {:g}; give seconds, more than the round-off of the time", *over));
    if (rate != 0.0 || acceleration != 0.0)
      throw refuse("over says its rate already; leave out rate and acceleration, or over");
    input.ramp(value, state_.t, state_.t + *over);
  }
  double input(const std::string& name) {
    const Lock lock(*this);
    return state_.inputs[find_input(name)].at(state_.t).v;
  }
  py::dict inputs() {
    const Lock lock(*this);
    py::dict all;
    const std::vector<InputInfo>& known = of_->model.system->inputs();
    for (std::size_t i = 0; i < known.size(); ++i)
      all[py::str(known[i].name)] = state_.inputs[i].at(state_.t).v;
    return all;
  }
  std::vector<std::pair<std::string, std::string>> input_names() const {
    std::vector<std::pair<std::string, std::string>> all;
    for (const InputInfo& input : of_->model.system->inputs())
      all.emplace_back(input.name, input.unit);
    return all;
  }

  // To a time; adaptive steps end there.
  void step_to(double t) {
    if (!std::isfinite(t) || t > transient_.duration * (1.0 + 1e-12))
      throw UseError(fmt::format("step_to({:g}): give a time up to the duration, {:g} s", t,
                                 transient_.duration));
    const Lock lock(*this);
    const double enough = 1e-9 * (transient_.step ? *transient_.step : transient_.duration);
    if (t < state_.t - enough - transient_.step.value_or(0.0))  // a fixed step may have passed it
      throw UseError(fmt::format("step_to({:g}): the time is {:.9g} s already; restore() goes back",
                                 t, state_.t));
    struct Stop {
      explicit Stop(Stepper& of, double at) : stepper(of) { stepper.stop_at(at); }
      ~Stop() { stepper.stop_at(std::numeric_limits<double>::infinity()); }
      Stepper& stepper;
    } const stop(*stepper_, std::min(t, transient_.duration));
    while (state_.t < t - enough) take_steps(1);
  }

  // ---- checkpoints
  py::bytes keep(bool goes_back) {
    const Lock lock(*this);
    const Checkpoint made = goes_back ? stepper_->remember(state_) : stepper_->save(state_);
    return {made.bytes.data(), made.bytes.size()};
  }
  void resume(const py::bytes& bytes, bool goes_back) {
    const Lock lock(*this);
    const std::string text = bytes;
    const Checkpoint from{{text.begin(), text.end()}};
    try {
      if (goes_back)
        stepper_->go_back(from, state_);
      else
        stepper_->restore(from, state_);
    } catch (const Error& error) {
      throw UseError(error.what());
    }
  }

  const Model& model() const { return of_->model; }

  StateHandle copy() {
    const Lock lock(*this);
    return {of_, state_};
  }

  py::dict energies() {
    const Lock lock(*this);
    const Energies e = of_->model.system->energies(state_);
    py::dict all;
    all["kinetic"] = e.kinetic;
    all["strain"] = e.strain;
    all["potential"] = e.potential;
    all["total"] = e.total();
    return all;
  }

  int node(const std::string& name) const { return names_.find(name).node; }
  const std::vector<std::string>& names() const { return names_.words(); }
  std::vector<std::string> joints() const {
    std::vector<std::string> all;
    for (const Model::JointFrames& joint : of_->model.joints) all.push_back(joint.name);
    return all;
  }
  std::vector<std::string> nodes() const {
    std::vector<std::string> all;
    for (Index n = 0; n < of_->model.system->nodes(); ++n)
      all.push_back(of_->model.system->node_name(n));
    return all;
  }
  py::dict counters() {
    const Lock lock(*this);
    py::dict all;
    for (const NamedCounter& named : named_counters)
      all[py::str(std::string(named.name))] = stepper_->counters().*named.counter;
    return all;
  }
  const State& state() const { return state_; }
  double t() const { return state_.t; }
  double duration() const { return transient_.duration; }
  int iterations() const { return last_.iterations; }
  std::string method() const { return std::string(name_of(transient_.method)); }
  const std::vector<Column>& column_names() const { return columns_; }

 private:
  // Another thread must not look while one steps; it is told so.
  class Lock {
   public:
    explicit Lock(StepperHandle& of) : of_(of) {
      if (of_.busy_.exchange(true))
        throw UseError("the stepper is in use by another thread; give each thread its own");
    }
    ~Lock() { of_.busy_ = false; }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    StepperHandle& of_;
  };

  void begin() {
    const std::array before = {static_cast<const void*>(state_.pose.data()),
                               static_cast<const void*>(state_.V.data()),
                               static_cast<const void*>(state_.Vdot.data())};
    const StepReport report = stepper_->start(state_);
    if (!report.converged)
      throw Error(of_->scene->transient->source, "transient: " + report.failure);
    const std::array after = {static_cast<const void*>(state_.pose.data()),
                              static_cast<const void*>(state_.V.data()),
                              static_cast<const void*>(state_.Vdot.data())};
    if (before != after) throw std::logic_error("a stepper has moved the arrays of its state");
  }

  std::size_t find_input(const std::string& name) const {
    try {
      return input_index(of_->model, name);
    } catch (const Error& error) {
      throw UnknownName(error.what());
    }
  }

  bool at_end() const { return state_.t > transient_.duration * (1.0 - 1e-12); }

  const State& with_shared_reactions() {
    if (!shares_reactions_) return state_;
    shared_ = state_;
    shared_.lambda = minimum_norm(*of_->model.system, state_);
    return shared_;
  }
  void fill_row() {
    if (const Index bad = sample_row(of_->model, with_shared_reactions(), row_); bad >= 0)
      raise_run_error(fmt::format("{}: column {} is not finite at t = {:.9g} s", of_->scene->name,
                                  columns_[static_cast<std::size_t>(bad)].name, state_.t),
                      state_.t, py::none());
  }

  const Model::JointFrames& joint_of(const std::string& name) const {
    for (const Model::JointFrames& joint : of_->model.joints)
      if (joint.name == name) return joint;
    throw UnknownName(fmt::format("{}: there is no joint \"{}\" with multipliers{}",
                                  of_->scene->name, name, known_names(name, joints(), "joints")));
  }

  std::shared_ptr<const Compiled> of_;
  TransientScene transient_;
  Names names_;
  std::vector<Column> columns_;
  std::vector<double> row_;
  State state_, shared_;
  std::unique_ptr<Stepper> stepper_;
  bool shares_reactions_ = false;
  StepReport last_;
  double last_step_ = 0.0;
  std::atomic<bool> busy_ = false;
};

py::object make(const ModelHandle& handle, const std::string& method, const std::string& step,
                const std::string& tolerance, const std::string& duration) {
  std::shared_ptr<StepperHandle> made;
  const py::object raised = in_background([&](const std::atomic<bool>& interrupted) {
    Scene scene = handle.scene();
    if (!scene.transient)
      throw Error(scene.source,
                  label("mbd", scene.name) + ": there is no <transient> to step through; add one");
    apply({method, step, tolerance, {}}, scene);
    if (!duration.empty()) {
      scene.transient->duration = option_value("duration", duration, "s", scene);
      if (!(scene.transient->duration > 0.0) || !std::isfinite(scene.transient->duration))
        throw UseError(fmt::format("duration = {}: give a time that is positive", duration));
    }
    made = std::make_shared<StepperHandle>(handle.compiled(), *scene.transient);
    made->start(interrupted);
  });
  raise_if(raised, py::none());
  return py::cast(made);
}

template <Block block>
py::array block_of(const py::object& self) {
  return view_of(py::cast<const StepperHandle&>(self).state(), block, self, false);
}
template <Block block>
py::array block_of_state(const py::object& self) {
  return view_of(py::cast<const StateHandle&>(self).state, block, self, true);
}

// Right shape and finite, then copied.
template <Block block>
void set_block(const py::object& self, const py::object& values) {
  const auto given = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(values);
  if (!given) throw UseError("the values are not numbers; give an array");
  py::array to = block_of_state<block>(self);
  if (given.ndim() != 2 || given.shape(0) != to.shape(0) || given.shape(1) != to.shape(1))
    throw UseError(fmt::format("the array must have the shape ({}, {}), one row a node",
                               to.shape(0), to.shape(1)));
  to[py::ellipsis()] = given;
}

// What Stepper.input is: it and its stepper live as long as either is held.
struct InputsHandle {
  std::shared_ptr<StepperHandle> of;
};

py::object checkpoints() { return py::module_::import("mbd.checkpoints"); }

py::bytes save(const py::object& self, const py::object& file) {
  const py::bytes bytes = py::cast<StepperHandle&>(self).keep(false);
  if (!file.is_none()) checkpoints().attr("write")(file, bytes, self);
  return bytes;
}

py::bytes checkpoint_of(const py::object& from) {
  if (py::isinstance<py::bytes>(from)) return py::reinterpret_borrow<py::bytes>(from);
  return checkpoints().attr("read")(from);
}

py::dict linearized(StepperHandle& s) {
  const StateHandle about = s.copy();
  std::optional<Linearization> linear;
  raise_if(
      in_background([&](const std::atomic<bool>&) { linear = linearize(s.model(), about.state); }),
      py::none());
  return dict_of(*linear);
}

py::array three(const Vec3& x) { return py::array_t<double>(3, x.data()); }

}  // namespace

void bind_stepper(py::module_& module) {
  py::class_<StateHandle>(module, "State",
                          "A copy of the state of a stepper, which Stepper.start() takes. Arrays "
                          "have a row for each node, "
                          "node 0 is the ground.")
      .def_property(
          "t", [](const StateHandle& s) { return s.state.t; },
          [](StateHandle& s, double t) {
            if (!std::isfinite(t)) throw UseError("t is not finite");
            s.state.t = t;
          },
          "Time [s].")
      .def_property(
          "positions", &block_of_state<Block::position>, &set_block<Block::position>,
          "Positions of the nodes, inertial axes [m], (nodes, 3): a view that can be written to.")
      .def_property("quaternions", &block_of_state<Block::quaternion>,
                    &set_block<Block::quaternion>,
                    "Orientations as unit quaternions x y z w, from node axes to inertial ones, "
                    "(nodes, 4): a view that can be written to.")
      .def_property(
          "velocities", &block_of_state<Block::velocity>, &set_block<Block::velocity>,
          "[v; w] of the nodes, node axes [m/s, rad/s], (nodes, 6): a view that can be written to.")
      .def("__copy__", [](const StateHandle& s) { return s; })
      .def(
          "__deepcopy__", [](const StateHandle& s, const py::dict&) { return s; }, py::arg("memo"))
      .def(
          "copy", [](const StateHandle& s) { return s; }, "Another copy.");

  py::class_<InputsHandle>(module, "Inputs",
                           "Inputs of a Stepper, by name: s.input[\"torque\"] is what it is now, "
                           "in its unit, and what is assigned is held from now on.")
      .def(
          "__getitem__",
          [](const InputsHandle& h, const std::string& name) { return h.of->input(name); },
          py::arg("name"))
      .def(
          "__setitem__",
          [](const InputsHandle& h, const std::string& name, double value) {
            h.of->set_input(name, value, std::nullopt, 0.0, 0.0);
          },
          py::arg("name"), py::arg("value"))
      .def("__len__", [](const InputsHandle& h) { return h.of->input_names().size(); })
      .def("__iter__", [](const InputsHandle& h) { return py::iter(h.of->inputs()); })
      .def("__contains__", [](const InputsHandle& h,
                              const py::object& name) { return h.of->inputs().contains(name); })
      .def(
          "keys", [](const InputsHandle& h) { return py::list(h.of->inputs()); },
          "Names of the inputs.")
      .def("__repr__", [](const InputsHandle& h) {
        return "<mbd.Inputs " + std::string(py::str(h.of->inputs())) + ">";
      });

  py::class_<StepperHandle, std::shared_ptr<StepperHandle>>(
      module, "Stepper",
      "Carries a model through time. Made by Model.stepper(). Arrays have a row for each node, "
      "node 0 is the ground.")
      .def("step", &StepperHandle::step, py::arg("count") = 1,
           "Takes `count` steps: whole fixed ones, or such as the tolerance asks for, of which the "
           "last ends at the "
           "duration. Raises mbd.RunError where one fails (the state is then the last that was "
           "reached) and, with a tolerance, after the end; "
           "Ctrl-C is looked for every 64 steps.")
      .def("start", &StepperHandle::start_from, py::arg("state"),
           "Goes on from a State of the same Model. Accelerations and multipliers are found anew "
           "and the method forgets what "
           "was before, as after a jump: no continuation to the last bit. Raises mbd.UseError for "
           "states of other "
           "models, numbers that are not finite, and states that do not satisfy their constraints.")
      .def("step_to", &StepperHandle::step_to, py::arg("t"),
           "Steps until that time [s]: adaptive ones end there, fixed ones at the first of theirs "
           "that is not before it. Raises mbd.UseError for times before the present one and after "
           "the "
           "duration.")
      .def_property_readonly(
          "inputs", &StepperHandle::inputs,
          "dict: inputs of the model as they are now, in their units (`input_names`).")
      .def_property_readonly("input_names", &StepperHandle::input_names,
                             "Names and units of the model's inputs.")
      .def_property_readonly(
          "input", [](std::shared_ptr<StepperHandle> s) { return InputsHandle{std::move(s)}; },
          "Inputs by name: s.input[\"torque\"] = 3 is set_input(\"torque\", 3).")
      .def("set_input", &StepperHandle::set_input, py::arg("name"), py::arg("value"),
           py::arg("over") = py::none(), py::kw_only(), py::arg("rate") = 0.0,
           py::arg("acceleration") = 0.0,
           "Sets an input from now on, in its unit, until it is set again: to `value`, from where "
           "it "
           "goes on at `rate` and `acceleration` (in its unit by s and s2); or, with `over`, in a "
           "straight line from where it is, which is at `value` after `over` seconds and goes on. "
           "One that drives a joint has to go on from its value and rate, since a motion must not "
           "jump. Raises mbd.UnknownName and mbd.UseError.")
      .def(
          "save", &save, py::arg("file") = py::none(),
          "The whole of the stepper as bytes, also written to `file` if there is one; to x.h5 with "
          "h5py, and the poses and velocities of the nodes beside it. It and who restores that go "
          "on alike to the last bit. Raises mbd.Error for ida, and mbd.UseError where the file "
          "cannot be written.")
      .def(
          "restore",
          [](StepperHandle& s, const py::object& from) { s.resume(checkpoint_of(from), false); },
          py::arg("checkpoint"),
          "Goes on from what save() gave, bytes or a file, of the same model with the same method "
          "and settings. Raises mbd.UseError for others.")
      .def(
          "remember", [](StepperHandle& s) { return s.keep(true); },
          "As save(), for go_back(), which takes steps again with other inputs: the tangent is "
          "kept.")
      .def(
          "go_back", [](StepperHandle& s, const py::bytes& bytes) { s.resume(bytes, true); },
          py::arg("checkpoint"), "To where remember() was called.")
      .def("linearize", &linearized, "As mbd.linearize(), about the present state.")
      .def("linearise", &linearized, "The same as linearize().")
      .def("state", &StepperHandle::copy, "A copy of the present state.")
      .def_property_readonly("t", &StepperHandle::t, "Time [s].")
      .def_property_readonly("duration", &StepperHandle::duration, "Of the transient [s].")
      .def_property_readonly("method", &StepperHandle::method, "generalized_alpha, radau or ida.")
      .def_property_readonly("iterations", &StepperHandle::iterations,
                             "Of Newton's method, in the last step.")
      .def_property_readonly(
          "counters", &StepperHandle::counters,
          "dict: steps, retries, iterations … since the start, as report.json has them.")
      .def_property_readonly("positions", &block_of<Block::position>,
                             "Positions of the nodes, inertial axes [m], (nodes, 3): a view, which "
                             "changes with each step.")
      .def_property_readonly("quaternions", &block_of<Block::quaternion>,
                             "Orientations as unit quaternions x y z w, from node axes to inertial "
                             "ones, (nodes, 4): a view.")
      .def_property_readonly("velocities", &block_of<Block::velocity>,
                             "[v; w] of the nodes, node axes [m/s, rad/s], (nodes, 6): a view.")
      .def_property_readonly(
          "accelerations", &block_of<Block::acceleration>,
          "Time derivatives of the velocities, node axes [m/s2, rad/s2], (nodes, 6): a view.")
      .def_property_readonly(
          "multipliers",
          [](const StepperHandle& s) {
            return py::array_t<double>(s.state().lambda.size(), s.state().lambda.data());
          },
          "Of the constraints [N, N.m], in the order of the compiled model: a copy.")
      .def_property_readonly("nodes", &StepperHandle::nodes,
                             "Names of the nodes, in the order of the arrays.")
      .def_property_readonly("places", &StepperHandle::names,
                             "Names that node(), position() … know.")
      .def_property_readonly("joints", &StepperHandle::joints,
                             "Names of joints that have multipliers.")
      .def_property_readonly(
          "columns",
          [](const StepperHandle& s) {
            std::vector<std::pair<std::string, std::string>> all;
            for (const Column& c : s.column_names()) all.emplace_back(c.name, c.unit);
            return all;
          },
          "Names and units of what is recorded.")
      .def("node", &StepperHandle::node, py::arg("place"),
           "Row of a place (\"arm.end\", \"arm@0.5\", \"body\") in the arrays. Raises "
           "mbd.UnknownName.")
      .def(
          "position",
          [](StepperHandle& s, const std::string& name) { return three(s.motion(name).H.r); },
          py::arg("place"), "Of a place, inertial axes [m], (3,).")
      .def(
          "orientation",
          [](StepperHandle& s, const std::string& name) {
            const Mat3 R = s.motion(name).H.R();
            py::array_t<double> out({3, 3});
            for (int i = 0; i < 3; ++i)
              for (int k = 0; k < 3; ++k) out.mutable_at(i, k) = R(i, k);
            return out;
          },
          py::arg("place"), "Of a place: matrix from its axes to inertial ones, (3, 3).")
      .def(
          "velocity",
          [](StepperHandle& s, const std::string& name) {
            const auto m = s.motion(name);
            return three(m.H.p * linear<double>(m.V));
          },
          py::arg("place"), "Of a place, inertial axes [m/s], (3,).")
      .def(
          "angular_velocity",
          [](StepperHandle& s, const std::string& name) {
            return three(angular<double>(s.motion(name).V));
          },
          py::arg("place"), "Of a place, axes of the place [rad/s], (3,).")
      .def("angle", &StepperHandle::angle, py::arg("joint"),
           "Of a joint that has one, counted on over whole turns [rad].")
      .def("reaction", &StepperHandle::reaction, py::arg("joint"),
           "Force [N] and moment [N.m] on the joint's second part, joint axes, (6,).")
      .def("record", &StepperHandle::record,
           "dict: all that the model records, at the present state, by column.")
      .def("__getitem__", &StepperHandle::sample, py::arg("name"),
           "What the model records, at the present state: a column (0-dimensional), a quantity or "
           "a record (1-dimensional), "
           "in the units of `columns`. Raises mbd.UnknownName.")
      .def_property_readonly("energies", &StepperHandle::energies,
                             "dict: kinetic, strain, potential and total energy [J].");

  module.def("stepper", &make, py::arg("model"), py::arg("method"), py::arg("step"),
             py::arg("tolerance"), py::arg("duration"));
}

}  // namespace mbd::python
