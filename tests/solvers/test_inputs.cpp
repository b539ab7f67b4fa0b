// Inputs that a program sets between steps: against closed equations, and against the same law of time.
//
// Tried in the library, and killed: no restart where a load jumps; inputs in SI; inputs of the first value for ever; a load
// dropped because its input begins at 0; a switch of a law dropped because both sides are 0 at the start; a drive that may jump.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/study/trust/torture.hpp"
#include "solvers/time/ida.hpp"
#include "solvers/time/stepper.hpp"
#include "tests/support/machine.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_inputs {
namespace {

// A model that is stepped by hand.
struct Session {
  explicit Session(const std::string& inside, const MakeStepper& make = {})
      : scene(read(inside)), model(compile(scene)), state(model.initial) {
    stepper = make ? make(*model.system) : make_stepper(*model.system, *scene.transient);
    const StepReport report = stepper->start(state);
    EXPECT_TRUE(report.converged) << report.failure;
  }
  void to(double t) {
    while (state.t < t - 1e-9) {
      const StepReport report = stepper->step(state);
      ASSERT_TRUE(report.converged) << report.failure;
    }
  }
  double output(const std::string& name) const {
    std::vector<double> all(ports(model).outputs.size());
    outputs(model, state, all);
    return all[output_index(model, name)];
  }
  InputValue& input(const std::string& name) { return state.inputs[input_index(model, name)]; }

  Scene scene;
  Model model;
  State state;
  std::unique_ptr<Stepper> stepper;
};

// Two uniform rods of 1 kg and 1 m from the origin along x; gravity is downward. Torques in N.mm.
const std::string arm = R"(
  <input name="u1" unit="N.mm"/><input name="u2" unit="N.mm"/>
  <body name="upper" mass="1" inertia="1e-3 1/12 1/12" at="0.5 0 0"/>
  <body name="lower" mass="1" inertia="1e-3 1/12 1/12" at="1.5 0 0"/>
  <revolute name="shoulder" between="ground upper" at="0 0 0" axis="0 0 1"/>
  <revolute name="elbow" between="upper lower" at="1 0 0" axis="0 0 1"/>
  <joint_torque joint="shoulder" moment="u1"/><joint_torque joint="elbow" moment="u2"/>
  <gravity acceleration="0 -9.81 0"/>
  <record name="s" joint="shoulder" quantities="angle rate"/>
  <record name="e" joint="elbow" quantities="angle rate"/>)";

// A servo in N.m: angles [rad] and rates of the joints.
std::array<double, 2> servo(const std::array<double, 4>& x) {
  return {-200.0 * (x[0] - 0.4) - 30.0 * x[2], -100.0 * (x[1] + 0.7) - 12.0 * x[3]};
}

// The same by Lagrange's equations in absolute angles, fourth order of Runge and Kutta; the servo sees the joints every
// `period` and holds. Joint angles and rates at the end.
std::array<double, 4> arm_by_lagrange(double period, int periods) {
  using X = std::array<double, 4>;  // phi1, phi2 and rates
  constexpr double g = 9.81;
  std::array<double, 2> u{};
  const auto rates = [&u](const X& x) -> X {
    const double d = x[0] - x[1], c = 0.5 * std::cos(d), s = 0.5 * std::sin(d);
    const double a = 4.0 / 3.0, b = 1.0 / 3.0;
    const double f = u[0] - u[1] - s * x[3] * x[3] - 1.5 * g * std::cos(x[0]),
                 h = u[1] + s * x[2] * x[2] - 0.5 * g * std::cos(x[1]);
    const double det = a * b - c * c;
    return {x[2], x[3], (b * f - c * h) / det, (a * h - c * f) / det};
  };
  X x{};
  constexpr int parts = 20;
  const double h = period / parts;
  const auto ahead = [](const X& at, double of, const X& rate) {
    X y = at;
    for (std::size_t i = 0; i < 4; ++i) y[i] += of * rate[i];
    return y;
  };
  for (int k = 0; k < periods; ++k) {
    u = servo({x[0], x[1] - x[0], x[2], x[3] - x[2]});
    for (int i = 0; i < parts; ++i) {
      const X k1 = rates(x), k2 = rates(ahead(x, h / 2, k1)), k3 = rates(ahead(x, h / 2, k2)),
              k4 = rates(ahead(x, h, k3));
      for (std::size_t j = 0; j < 4; ++j) x[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
  }
  return {x[0], x[1] - x[0], x[2], x[3] - x[2]};
}

// Largest error of joint angles after 0.2 s of a servo that holds for 1 ms.
double servo_error(const std::string& transient, const MakeStepper& make = {}) {
  Session run(arm + transient, make);
  for (int k = 0; k < 200; ++k) {
    const std::array<double, 2> u = servo(
        {run.output("s.angle"), run.output("e.angle"), run.output("s.rate"), run.output("e.rate")});
    run.input("u1").hold(1e3 * u[0], run.state.t);
    run.input("u2").hold(1e3 * u[1], run.state.t);
    run.stepper->stop_at(1e-3 * (k + 1));
    run.to(1e-3 * (k + 1));
    if (testing::Test::HasFatalFailure()) return 1e300;
  }
  const std::array<double, 4> wanted = arm_by_lagrange(1e-3, 200);
  return std::max(std::abs(run.output("s.angle") - wanted[0]),
                  std::abs(run.output("e.angle") - wanted[1]));
}

// What is held over a step acts from its beginning: order 2 of generalised-alpha, 5 of Radau.
TEST(Inputs, ServoThatHolds) {
  double coarse = 0.0;
  for (const double step : {0.25e-3, 0.125e-3, 0.0625e-3}) {
    const double error = servo_error(fmt::format(R"(<transient duration="0.2" step="{}"/>)", step));
    EXPECT_LT(error, 1e-6) << step;
    if (coarse > 0.0) {
      EXPECT_NEAR(std::log2(coarse / error), 2.0, 0.15) << error;
    }
    coarse = error;
  }
  EXPECT_LT(servo_error(R"(<transient duration="0.2" step="1e-3"/>)"), 1e-5);
  EXPECT_LT(servo_error(R"(<transient duration="0.2" step="1e-3" method="radau"/>)"), 1e-9);
  EXPECT_LT(servo_error(R"(<transient duration="0.2" tolerance="1e-8" method="radau"/>)"), 1e-7);
  EXPECT_LT(servo_error(R"(<transient duration="0.2" tolerance="1e-5"/>)"), 1e-4);
  EXPECT_LT(servo_error(R"(<transient duration="0.2" tolerance="1e-7" method="ida"/>)"), 1e-5);
}

// A beam, a body on a bushing in a flow, loads of all kinds; each law is a polynomial of time, or an input that goes as it:
// to the tolerance of Newton's iterations the motion is the same.
std::string many_loads(const std::string& f, const std::string& q, const std::string& inputs) {
  return inputs + fmt::format(R"(
    <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="60"/>
      <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="3"/>
    <fixed name="clamp" between="ground b.start"/>
    <load name="tip" at="b.end" force="0 {0} ({0})*2" follower_moment="0 0 {1}"/>
    <load name="middle" at="b@0.5" follower_force="0 0 ({0})*-1"/>
    <distributed name="q" beam="b" force="0 ({1})*(1-s) 0"/>
    <body name="m" mass="2" inertia="0.1 0.1 0.1" at="0 3 0"/>
    <bushing name="k" between="ground m" at="0 3 0" stiffness="50 50 50" angular_stiffness="5 5 5"/>
    <drag name="d" at="m" density="1.2" area="0.5" coefficient="0.4" flow="{1} 0 0"/>
    <record name="b" at="b.end" quantities="displacement velocity"/>
    <record name="m" at="m" quantities="displacement velocity"/>
    <transient duration="0.4" step="1e-3"/>)",
                              f, q);
}

TEST(Inputs, AreTheSameAsTheirLaws) {
  Session law(many_loads("30*t", "2+5*t-20*t^2", ""));
  Session input(many_loads("u", "v", R"(<input name="u" value="0"/><input name="v" value="2"/>)"));
  ASSERT_EQ(law.model.system->signals().size(), input.model.system->signals().size());
  input.input("u") = {.f = 0.0, .fdot = 30.0, .fddot = 0.0, .since = 0.0};
  input.input("v") = {.f = 2.0, .fdot = 5.0, .fddot = -40.0, .since = 0.0};
  for (int k = 1; k <= 400; ++k) {
    law.to(1e-3 * k);
    if (k % 2 == 1) {  // said anew, from now on
      const double t = input.state.t;
      input.input("u") = {.f = 30.0 * t, .fdot = 30.0, .fddot = 0.0, .since = t};
    }
    if (k == 200) {  // in pieces that ramp: the same line
      InputValue& u = input.input("u");
      u.ramp(30.0 * (input.state.t + 0.1), input.state.t, input.state.t + 0.1);
    }
    input.to(1e-3 * k);
  }
  double size = 0.0;
  for (const Port& port : ports(law.model).outputs) {
    const double wanted = law.output(port.name);
    EXPECT_NEAR(input.output(port.name), wanted, 1e-7 * std::max(1.0, std::abs(wanted)))
        << port.name;
    size = std::max(size, std::abs(wanted));
  }
  EXPECT_GT(size, 0.05);
}

// Loads of one input, of two that begin alike, and of one that begins at 0 are as many loads.
TEST(Inputs, AreNotMerged) {
  Session run(R"(<input name="u"/><input name="v"/>
    <body name="m" mass="2" inertia="1 1 1"/>
    <load at="m" force="u 0 0"/><load at="m" force="v v 0"/><load at="m" force="0 0 t&lt;0.5?u:2*u"/>
    <record name="m" at="m" quantities="velocity"/><transient duration="1" step="0.1"/>)");
  run.input("u").hold(4.0, 0.0);
  run.to(1.0);
  EXPECT_NEAR(run.output("m.velocity.1"), 2.0, 1e-9);
  EXPECT_NEAR(run.output("m.velocity.2"), 0.0, 1e-9);
  EXPECT_NEAR(run.output("m.velocity.3"), 0.5 * 2.0 + 0.5 * 4.0, 1e-9);  // the switch is landed on
}

// A drive follows the value, the rate and the acceleration that its input is given; a jump of the first two is refused by name.
TEST(Inputs, DrivesGoOn) {
  for (const char* method : {"generalized_alpha", "radau", "ida"}) {
    SCOPED_TRACE(method);
    Session run(fmt::format(
        R"(<input name="a" unit="deg"/>
      <body name="wheel" mass="1" inertia="1 1 2"/>
      <revolute name="r" between="ground wheel" axis="0 0 1"/>
      <drive joint="r" angle="a"/>
      <record name="r" joint="r" quantities="angle rate reaction_moment"/>
      <transient duration="2" method="{}" {}/>)",
        method, std::string(method) == "ida" ? R"(tolerance="1e-8")" : R"(step="0.01")"));
    if (::testing::Test::HasFailure()) return;
    constexpr double degree = 0.017453292519943295;
    // 90 deg/s^2 for a second, then steady.
    run.input("a") = {.f = 0.0, .fdot = 0.0, .fddot = 90.0, .since = 0.0};
    run.stepper->stop_at(1.0);
    run.to(1.0);
    EXPECT_NEAR(run.output("r.angle"), 45.0 * degree, 1e-9);
    EXPECT_NEAR(run.output("r.reaction_moment.3"), 2.0 * 90.0 * degree, 1e-4);
    run.input("a") = {.f = 45.0, .fdot = 90.0, .fddot = 0.0, .since = run.state.t};
    run.stepper->stop_at(1.5);
    run.to(1.5);
    EXPECT_NEAR(run.output("r.angle"), 90.0 * degree, 1e-7);
    EXPECT_NEAR(run.output("r.reaction_moment.3"), 0.0, 1e-4);
    run.input("a").hold(run.input("a").at(run.state.t).v, run.state.t);
    StepReport report = run.stepper->step(run.state);
    EXPECT_FALSE(report.converged);
    EXPECT_SAYS(report.failure, "the rate of ");
    EXPECT_SAYS(report.failure, "joint \"r\"");
    run.input("a") = {.f = 91.0, .fdot = 90.0, .fddot = 0.0, .since = run.state.t};
    report = run.stepper->step(run.state);
    EXPECT_FALSE(report.converged);
    EXPECT_SAYS(report.failure, "an impact");
    EXPECT_EQ(report.failure.find("the rate of "), std::string::npos) << report.failure;
  }
}

TEST(Inputs, ArePorts) {
  const Model model = compile(read(arm + R"(<transient duration="1" step="0.1"/>)"));
  const Ports all = ports(model);
  ASSERT_EQ(all.inputs.size(), 2U);
  EXPECT_EQ(all.inputs[1].name, "u2");
  EXPECT_EQ(all.inputs[1].unit, "N.mm");
  ASSERT_EQ(all.outputs.size(), 4U);
  EXPECT_EQ(all.outputs[3].name, "e.rate");
  EXPECT_EQ(all.outputs[3].unit, "rad/s");
  const auto said = [&](const auto& f) -> std::string {
    try {
      f();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_SAYS(said([&] { input_index(model, "u3"); }), "u1");
  EXPECT_SAYS(said([&] { output_index(model, "e.rat"); }), "e.rate");
  EXPECT_SAYS(said([&] { node_index(model, "uper"); }), "upper");
  EXPECT_EQ(node_index(model, "ground"), 0);
}

// Steps from a state that is not the stepper's, and states of other models, are refused.
TEST(Inputs, StatesAreTheSteppersOwn) {
  Session run(arm + R"(<transient duration="1" step="0.1"/>)");
  const auto fresh = make_stepper(*run.model.system, *run.scene.transient);
  StepReport report = fresh->step(run.state);
  EXPECT_FALSE(report.converged);
  EXPECT_SAYS(report.failure, "start()");
  run.to(0.2);
  State other = run.state;
  other.t = 0.1;
  report = run.stepper->step(other);
  EXPECT_FALSE(report.converged);
  EXPECT_SAYS(report.failure, "call start()");
  const Model less = compile(read(R"(<body name="m" mass="2" inertia="1 1 1"/>
    <transient duration="1" step="0.1"/>)"));
  State wrong = less.initial;
  EXPECT_THROW(run.stepper->start(wrong), Error);
}

// Moved, turned, in other units and in another order, a model with inputs is the same model.
TEST(Inputs, HoldThroughTransforms) {
  Scene scene = read(many_loads(
      "u", "v+0*t", R"(<input name="u" unit="kN" value="0.004"/><input name="v" value="2"/>)"));
  scene.transient->duration = 0.05;
  const Torture trials =
      torture(scene, {.kinds = {"motion", "units", "order"}, .budget = no_limit, .progress = {}});
  EXPECT_GE(trials.trials.size(), 4U);
  for (const TortureTrial& trial : trials.trials)
    EXPECT_EQ(trial.verdict, Verdict::pass) << trial.kind << trial.name << trial.reason;
}

TEST(Inputs, SayWhatIsWrong) {
  const std::string end = R"(<body name="m" mass="1" inertia="1 1 1"/><load at="m" force="{} 0 0"/>
      <revolute name="r" between="ground m" axis="0 0 1"/><transient duration="1" step="0.1"/>)";
  const auto with_force = [&](const std::string& force) {
    return R"(<input name="u"/>)" + fmt::format(fmt::runtime(end), force);
  };
  EXPECT_EQ(message(with_force("2*u+t")), "no error");
  EXPECT_SAYS(message(with_force("w")), "inputs u");
  EXPECT_SAYS(message(with_force("min(u,1)")), "limit inputs in the program");
  EXPECT_SAYS(message(with_force("u&lt;1?0:1")), "inputs cannot be compared");
  EXPECT_SAYS(message(R"(<load at="m" force="u 0 0"/>)" + with_force("1")), "unknown name 'u'");
  EXPECT_SAYS(message(R"(<input name="u"/>)" + with_force("1")), "there is an input \"u\" already");
  EXPECT_SAYS(message(R"(<parameter name="u" value="1"/>)" + with_force("1")), "parameter \"u\"");
  EXPECT_SAYS(message(R"(<input name="t"/>)" + with_force("1")), "means something else");
  EXPECT_SAYS(message(R"(<input name="a" unit="furlings"/>)" + with_force("1")), "furlings");
  EXPECT_SAYS(message(R"(<input name="a" unit="celsius"/>)" + with_force("1")), "celsius");
  EXPECT_SAYS(message(with_force("1") + R"(<body name="n" mass="u" inertia="1 1 1"/>)"),
              "inputs vary in time");
  const auto compiled = [&](const std::string& more) -> std::string {
    try {
      compile(read(with_force("1") + more));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_SAYS(compiled(R"(<drive joint="r" rate="u"/>)"), "whose future is not known");
  EXPECT_SAYS(compiled(R"(<drive joint="r" angle="t&lt;1 ? u : u"/>)"),
              "depends on an input and switches in time");
}

}  // namespace
}  // namespace mbd::test::test_inputs
