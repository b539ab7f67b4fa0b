// Feedback in the model file: functions of time, laws of sensors, sampled controllers. Against closed forms, differences, and
// equations integrated here.
//
// Tried in the library, and killed: the coupling left out of the tangent; its rates left out; a rate's gradient by the motion, of a
// joint and of a place, left out; states updated before what follows them; an instant missed; no limit to wind-up; the factor of a
// function's argument dropped.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "solvers/statics/statics.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_control {
namespace {

// A model that is stepped by hand.
struct Session {
  explicit Session(const std::string& inside, const Extensions& extensions = {})
      : scene(read(inside)), model(compile(scene, extensions)), state(model.initial) {
    stepper = make_stepper(*model.system, *scene.transient);
    const StepReport report = stepper->start(state);
    EXPECT_TRUE(report.converged) << report.failure;
  }
  void to(double t) {
    while (state.t < t - 1e-9) {
      const StepReport report = stepper->step(state);
      ASSERT_TRUE(report.converged) << report.failure;
    }
  }
  void land(double t) {
    stepper->stop_at(t);
    to(t);
  }
  double output(const std::string& name) const {
    std::vector<double> all(ports(model).outputs.size());
    outputs(model, state, all);
    return all[output_index(model, name)];
  }
  double held(const std::string& name) const {
    return state.inputs[input_index(model, name)].at(state.t).v;
  }

  Scene scene;
  Model model;
  State state;
  std::unique_ptr<Stepper> stepper;
};

std::string refusal(const std::string& inside) {
  try {
    const Scene scene = read(inside);
    const Model model = compile(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

const std::string mass = R"x(<body name="m" mass="2" inertia="1 1 1"/>)x";
const std::string transient = R"x(<transient duration="1" step="0.1"/>)x";

// The first component of a load's law.
Expression law_of(const std::string& functions, const std::string& law) {
  const Scene scene =
      read(functions + mass + R"x(<load at="m" force=")x" + law + R"x( 0 0"/>)x" + transient);
  return (*scene.loads[0].force)[0];
}

// --- functions of time ---

TEST(Functions, AreReadInPlace) {
  const std::string two = R"x(<parameter name="a" value="3"/>
    <function name="ref" value="t&lt;1?a*t^2:6*t-3"/>
    <function name="both" value="2*ref(t)+ref(2*t-1) deg"/>)x";
  constexpr double deg = 0.017453292519943295;
  const auto ref = [](double t) { return t < 1 ? 3 * t * t : 6 * t - 3; };
  const Expression both = law_of(two, "-both(t)");
  for (const double t : {0.3, 0.7, 0.95, 1.3, 4.0})
    EXPECT_NEAR(both(t).v, -deg * (2 * ref(t) + ref(2 * t - 1)), 1e-14) << t;
  EXPECT_NEAR(both(0.5).d, -deg * (2 * 3.0 + 2 * 0.0), 1e-14);
  // ref switches where its argument is 1: at t = 1 by either call.
  ASSERT_EQ(both.breakpoints().size(), 1U);
  EXPECT_EQ(both.breakpoints()[0], 1.0);
  const Expression late = law_of(two, "ref(t/2-1)");
  ASSERT_EQ(late.breakpoints().size(), 1U);
  EXPECT_NEAR(late.breakpoints()[0], 4.0, 1e-15);
  EXPECT_NEAR(late(3.0).d, 0.5 * 2 * 3 * 0.5, 1e-15);
  EXPECT_EQ(law_of(two, "ref(2)").value(), 9.0);
}

TEST(Functions, AreTables) {
  const std::string lines = R"x(<function name="f" unit="mm">0 0  1 2e3  3 -4e3</function>)x";
  const Expression f = law_of(lines, "f(t)"), fast = law_of(lines, "f(2*t-1)");
  EXPECT_NEAR(f(0.5).v, 1.0, 1e-15);
  EXPECT_NEAR(f(2.0).v, -1.0, 1e-15);
  EXPECT_NEAR(f(2.0).d, -3.0, 1e-15);
  EXPECT_NEAR(f(-1.0).v, -2.0, 1e-15);
  EXPECT_NEAR(f(4.0).v, -7.0, 1e-14);
  EXPECT_NEAR(f(1.0, Side::left).d, 2.0, 1e-15);
  EXPECT_NEAR(f(1.0, Side::right).d, -3.0, 1e-15);
  EXPECT_NEAR(fast(0.75).v, 1.0, 1e-15);
  EXPECT_NEAR(fast(0.75).d, 4.0, 1e-15);
  ASSERT_EQ(fast.breakpoints().size(), 1U);
  EXPECT_EQ(fast.breakpoints()[0], 1.0);
  // A spline through points of a cubic is that cubic.
  std::string points;
  const auto cubic = [](double t) { return t * t * t - 2 * t + 1; };
  for (int i = 0; i < 700; ++i) points += fmt::format("{} {} ", 0.01 * i, cubic(0.01 * i));
  const Expression smooth =
      law_of(R"x(<function name="f" interpolation="smooth">)x" + points + "</function>", "f(t)");
  for (const double t : {0.003, 1.2345, 3.3333, 6.9899}) {
    EXPECT_NEAR(smooth(t).v, cubic(t), 1e-11) << t;
    EXPECT_NEAR(smooth(t).d, 3 * t * t - 2, 1e-9) << t;
    EXPECT_NEAR(smooth(t).dd, 6 * t, 1e-6) << t;
  }
  const std::vector<Jump> jumps = Signal::from_expression(smooth).jumps();
  ASSERT_EQ(jumps.size(), 1U);  // where it goes on straight
  EXPECT_NEAR(jumps[0].t, 6.99, 1e-12);
  EXPECT_EQ(jumps[0].derivative, 2);
}

TEST(Functions, SayWhatIsWrong) {
  const auto said = [](const std::string& text) {
    return refusal(text + mass + R"x(<load at="m" force="f(t) 0 0"/>)x" + transient);
  };
  EXPECT_EQ(said(R"x(<function name="f" value="t"/>)x"), "no error");
  EXPECT_SAYS(said(R"x(<function name="f" value="1+f(t)"/>)x"), "a circle: f calls f");
  const std::string circle = said(R"x(<function name="f" value="g(t)"/>
    <function name="g" value="h(t)"/><function name="h" value="f(t)"/>)x");
  EXPECT_SAYS(circle, "a circle: f calls g calls h calls f");
  EXPECT_SAYS(circle, "test.xml:2:");
  EXPECT_SAYS(said(R"x(<function name="f" value="g(t)"/><function name="g" value="t"/>)x"),
              "stands after this one");
  EXPECT_SAYS(said(R"x(<function name="f" value="m.velocity.1"/>)x"), "a <function> is of time");
  EXPECT_SAYS(said(R"x(<function name="sin" value="t"/>)x"), "means something else");
  EXPECT_SAYS(said(R"x(<function name="f"/>)x"), "give the value, or a table");
  EXPECT_SAYS(said(R"x(<function name="f" value="t">0 1 2 3</function>)x"), "not both");
  EXPECT_SAYS(said(R"x(<function name="f">0 1 0 3</function>)x"), "must rise");
  EXPECT_SAYS(said(R"x(<function name="f" unit="foo">0 1 1 3</function>)x"), "foo");
  EXPECT_SAYS(said(R"x(<parameter name="f" value="1"/><function name="f" value="t"/>)x"),
              "there is a parameter");
  const auto law = [](const std::string& text) {
    return refusal(R"x(<function name="f" value="t"/>)x" + mass + R"x(<load at="m" force=")x" +
                   text + R"x( 0 0"/>)x" + transient);
  };
  EXPECT_SAYS(law("f"), "write f(t)");
  EXPECT_SAYS(law("f()"), "give the argument");
  EXPECT_SAYS(law("f(t,1)"), "one argument too many");
  EXPECT_SAYS(law("f(sin(t))"), "of the form a*t + b");
  EXPECT_SAYS(law("ff(t)"), "did you mean 'f'");
  EXPECT_SAYS(refusal(R"x(<function name="f" value="t"/>)x" + mass +
                      R"x(<parameter name="p" value="f(2)"/>)x" + transient),
              "the function of time 'f'");
}

// --- laws of sensors ---

const std::string arm = R"x(
  <body name="upper" mass="1" inertia="1e-3 1/12 1/12" at="0.5 0 0"/>
  <body name="lower" mass="1" inertia="1e-3 1/12 1/12" at="1.5 0 0"/>
  <revolute name="shoulder" between="ground upper" at="0 0 0" axis="0 0 1"/>
  <revolute name="elbow" between="upper lower" at="1 0 0" axis="0 0 1"/>
  <gravity acceleration="0 -9.81 0"/>
  <record name="s" joint="shoulder" quantities="angle rate"/>
  <record name="e" joint="elbow" quantities="angle rate"/>)x";

// The arm by Lagrange's equations in absolute angles with torques u(t, joint angles and rates), fourth order of Runge and Kutta;
// joint angles and rates at the end. `hold`: the torques are those of the beginning of each step.
using Four = std::array<double, 4>;
template <class Servo>
Four arm_by_lagrange(double step, int steps, const Servo& servo, bool hold) {
  constexpr double g = 9.81;
  const auto joints = [](const Four& x) -> Four { return {x[0], x[1] - x[0], x[2], x[3] - x[2]}; };
  std::array<double, 2> held{};
  const auto rates = [&](double t, const Four& x) -> Four {
    const std::array<double, 2> u = hold ? held : servo(t, joints(x));
    const double d = x[0] - x[1], c = 0.5 * std::cos(d), s = 0.5 * std::sin(d);
    const double a = 4.0 / 3.0, b = 1.0 / 3.0;
    const double f = u[0] - u[1] - s * x[3] * x[3] - 1.5 * g * std::cos(x[0]),
                 h = u[1] + s * x[2] * x[2] - 0.5 * g * std::cos(x[1]);
    const double det = a * b - c * c;
    return {x[2], x[3], (b * f - c * h) / det, (a * h - c * f) / det};
  };
  Four x{};
  constexpr int parts = 20;
  const double h = step / parts;
  const auto ahead = [](const Four& at, double of, const Four& rate) {
    Four y = at;
    for (std::size_t i = 0; i < 4; ++i) y[i] += of * rate[i];
    return y;
  };
  for (int k = 0; k < steps; ++k) {
    held = servo(k * step, joints(x));
    for (int i = 0; i < parts; ++i) {
      const double t = k * step + i * h;
      const Four k1 = rates(t, x), k2 = rates(t + h / 2, ahead(x, h / 2, k1)),
                 k3 = rates(t + h / 2, ahead(x, h / 2, k2)), k4 = rates(t + h, ahead(x, h, k3));
      for (std::size_t j = 0; j < 4; ++j) x[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
  }
  return joints(x);
}

Four joints_of(const Session& run) {
  return {run.output("s.angle"), run.output("e.angle"), run.output("s.rate"), run.output("e.rate")};
}
double largest_difference(const Four& a, const Four& b, std::size_t n = 4) {
  double most = 0.0;
  for (std::size_t i = 0; i < n; ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

// A servo that is not linear, with a reference of time: against equations of its own, by three methods.
TEST(Sensors, ServoOfAnArm) {
  const auto servo = [](double t, const Four& x) -> std::array<double, 2> {
    const double ref = 0.4 * std::sin(3 * t);
    return {-40.0 * std::sin(x[0] - ref) - 3.0 * x[2] * (1 + x[1] * x[1]),
            -20.0 * (x[1] + 0.7) - 1.2 * x[3] + 0.5 * x[2] * x[3]};
  };
  const Four wanted = arm_by_lagrange(2e-3, 500, servo, false);
  const std::string laws = R"x(<function name="ref" value="0.4*sin(3*t)"/>
    <joint_torque joint="shoulder"
      moment="-40*sin(shoulder.angle-ref(t)) - 3*shoulder.rate*(1+elbow.angle^2)"/>
    <joint_torque joint="elbow"
      moment="(-20*(elbow.angle+0.7) - 1.2*elbow.rate + 0.5*shoulder.rate*elbow.rate)*1e3 N.mm"/>)x";
  const auto error = [&](const std::string& settings) {
    Session run(arm + laws + settings);
    run.to(1.0);
    return largest_difference(joints_of(run), wanted);
  };
  EXPECT_LT(error(R"x(<transient duration="1" step="0.01" method="radau"/>)x"), 1e-7);
  EXPECT_LT(error(R"x(<transient duration="1" tolerance="1e-9" method="radau"/>)x"), 1e-6);
  EXPECT_LT(error(R"x(<transient duration="1" tolerance="1e-8" method="ida"/>)x"), 1e-4);
  const double coarse = error(R"x(<transient duration="1" step="2e-3"/>)x"),
               fine = error(R"x(<transient duration="1" step="1e-3"/>)x");
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.2);
}

// A linear servo of the elbow is a spring and a damper of the joint, a force of a program, and a law of sensors: to the tolerance of
// Newton's iterations the same.
TEST(Sensors, AreTheSameAsSpringsAndForces) {
  const std::string end = R"x(<transient duration="0.5" step="1e-3"/>)x";
  Session spring(arm +
                 R"x(<joint_spring name="k" joint="elbow" angular_stiffness="30" angular_damping="2"
      rest_angle="-0.5"/>)x" +
                 end);
  Session law(
      arm + R"x(<joint_torque joint="elbow" moment="-30*(elbow.angle+0.5)-2*elbow.rate"/>)x" + end);
  Extensions extensions;
  extensions.forces.push_back(
      make_force("servo", {"upper", "lower"}, [](const PlacesMotion& at, std::span<Vec6> wrenches) {
        const Vec3 a = at.poses[0].R().col(0), b = at.poses[1].R().col(0);
        const double angle = std::atan2(a(0) * b(1) - a(1) * b(0), a.dot(b));
        const double rate = at.velocities[1](5) - at.velocities[0](5);
        wrenches[1](5) = -30.0 * (angle + 0.5) - 2.0 * rate;
        wrenches[0](5) = -wrenches[1](5);
        return true;
      }));
  Session force(arm + end, extensions);
  for (Session* run : {&spring, &law, &force}) run->to(0.5);
  EXPECT_LT(largest_difference(joints_of(law), joints_of(spring)), 1e-8);
  EXPECT_LT(largest_difference(joints_of(force), joints_of(spring)), 1e-8);
  EXPECT_GT(std::abs(spring.output("e.angle")), 0.1);
  // As exact: as many iterations.
  EXPECT_LE(law.stepper->counters().iterations, spring.stepper->counters().iterations + 5);
  // Its power is that of a load.
  const Four x = joints_of(law);
  EXPECT_NEAR(law.model.system->power(law.state).loads, (-30.0 * (x[1] + 0.5) - 2.0 * x[3]) * x[3],
              1e-9);
}

const std::string frame = R"x(
  <section name="s"><stiffness EA="10" GA2="4" GA3="4" GJ="1" EI2="1" EI3="1"/>
    <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
  <beam name="c" section="s" from="2 0 0" to="2 1 0" normal="1 0 0" elements="1"/>
  <fixed name="clamp" between="ground b.start"/><fixed name="corner" between="b.end c.start"/>
  <body name="m" mass="2" inertia="0.1 0.2 0.3" at="0 3 0.5" orientation="0.3 0.2 0.1"/>
  <body name="gripper" attached_to="c.end" mass="1" inertia="1 1 1" center="0.1 0.2 0.3"/>
  <body name="slide" mass="1" inertia="0.1 0.1 0.1" at="0 3 1"/>
  <revolute name="pin" between="c.end m" at_a="2 1 0" at_b="0 3 0.5" axis="1 2 3"/>
  <prismatic name="rail" between="m slide" axis="0 1 1"/>)x";

// The tangent with loads and without, at random motions, against differences of residuals.
TEST(Sensors, TangentAgainstDifferences) {
  std::string base = frame;
  base.replace(base.find(R"x(at_a="2 1 0" at_b="0 3 0.5")x"), 27, R"x(at="2 1 0")x");
  base.replace(base.find(R"x(at="0 3 0.5")x"), 12, R"x(at="2 1 0")x");
  base.replace(base.find(R"x(at="0 3 1")x"), 10, R"x(at="2 1 0")x");
  const std::string loads = R"x(<function name="ref" value="0.3*sin(t)"/>
    <joint_torque joint="pin" moment="-20*sin(pin.angle-ref(t))-2*pin.rate*rail.displacement+3*slide.velocity.2"/>
    <joint_torque joint="rail" force="-5*rail.displacement^2-3*rail.speed*m.angular_velocity.1"/>
    <load at="c.end" offset="0.1 0.2 0.3" force="4*m.position.1 exp(-b@0.5.displacement.3^2) b.end.velocity.3"
      follower_force="0 2*gripper.velocity_local.1*pin.rate 0" follower_moment="0 0 pin.angle*gripper.angular_velocity_local.2"/>
    <load at="m" moment="tanh(slide.displacement.2) 0 t*rail.displacement"/>
    <distributed beam="b" force="0 0 -3*(1-s)*b.end.displacement.3*m.angular_velocity.3"/>)x";
  const Model plain = compile(read(base + transient)),
              with = compile(read(base + loads + transient));
  Rng rng(5);
  State state = with.initial;
  with.system->set_time(state, 0.7);
  State bare = plain.initial;
  plain.system->set_time(bare, 0.7);
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    state.pose[n] = state.pose[n] * exp_se3<double>(random_vector<6>(rng, 0.4));
    state.V[n] = random_vector<6>(rng, 2.0);
  }
  state.load_factor = 0.8;
  const auto same_motion = [&](const State& at) {
    State other = bare;
    other.pose = at.pose;
    other.V = at.V;
    other.load_factor = at.load_factor;
    return other;
  };
  const auto matrix_of = [&](const Model& model, const State& at, const TangentWeights& weights,
                             VecX& r) {
    DenseSolver solver;
    solver.analyze(model.system->graph());
    model.system->linearize(at, weights, r, solver);
    return Eigen::MatrixXd(solver.matrix());
  };
  const auto residual_of = [&](const State& at) {
    VecX r, without;
    with.system->residual(at, r);
    plain.system->residual(same_motion(at), without);
    return VecX(r - without);
  };
  const Index motions = 6 * (with.system->nodes() - 1);
  for (const bool of_motion : {true, false}) {
    const TangentWeights weights{of_motion ? 1.0 : 0.0, of_motion ? 0.0 : 1.0, 0.0, {}};
    VecX r_with, r_plain;
    const Eigen::MatrixXd K = matrix_of(with, state, weights, r_with) -
                              matrix_of(plain, same_motion(state), weights, r_plain);
    EXPECT_EQ(r_with - r_plain, residual_of(state));
    double worst = 0.0;
    for (Index j = 0; j < motions; ++j) {
      const double step = of_motion ? 1e-5 : 1e-3;
      VecX r[2];
      for (const int k : {0, 1}) {
        State moved = state;
        const auto n = static_cast<std::size_t>(j / 6 + 1);
        const Vec6 by = (k == 0 ? step : -step) * Vec6::Unit(j % 6);
        if (of_motion)
          moved.pose[n] = moved.pose[n] * exp_se3<double>(by);
        else
          moved.V[n] += by;
        r[k] = residual_of(moved);
      }
      const VecX column = ((r[0] - r[1]) / (2.0 * step)).segment(6, motions);
      worst = std::max(worst, (column - K.col(j).head(motions)).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(worst, 1e-8 * K.cwiseAbs().maxCoeff()) << of_motion;
    EXPECT_GT(K.cwiseAbs().maxCoeff(), 1.0);
  }
}

// A PD law on a pendulum about its equilibrium: J q" + c q' + (k + m g l) q = 0.
TEST(Sensors, PendulumIsLinearised) {
  const std::string pendulum =
      R"x(<body name="rod" mass="3" inertia="0.01 0.25 0.25" at="0 -0.5 0"/>
    <revolute name="hinge" between="ground rod" at="0 0 0" axis="0 0 1"/><gravity acceleration="0 -9.81 0"/>
    <input name="u"/>
    <joint_torque joint="hinge" moment="-12*(hinge.angle-u)-0.7*hinge.rate"/>
    <record name="h" joint="hinge" quantities="angle rate"/>)x";
  const double J = 0.25 + 3 * 0.25, k = 12 + 3 * 9.81 * 0.5, c = 0.7;
  const Scene scene = read(pendulum + transient);
  const Model model = compile(scene);
  const Linearization linear = linearize(model, model.initial);
  ASSERT_TRUE(linear.reduced);
  // E x' = A x + B u in a coordinate of its own scale: its frequency, its damping, and its static gain from u to the angle.
  const double E = linear.reduced->E(1, 1);
  EXPECT_NEAR(-linear.reduced->A(1, 0) / E, k / J, 1e-9 * k / J);
  EXPECT_NEAR(-linear.reduced->A(1, 1) / E, c / J, 1e-9);
  const double gain = -linear.C(0, 0) * linear.reduced->G(1, 0) / linear.reduced->A(1, 0);
  EXPECT_NEAR(gain, 12.0 / k, 1e-7);
  // In time, small.
  Session run(pendulum + R"x(<transient duration="3" step="0.01" method="radau"/>)x");
  run.state.inputs[0].hold(1e-5, 0.0);
  run.to(3.0);
  const double omega = std::sqrt(k / J), zeta = 0.5 * c / J / omega, d = zeta * omega,
               w = omega * std::sqrt(1 - zeta * zeta), t = 3.0;
  const double wanted =
      1e-5 * 12.0 / k * (1.0 - std::exp(-d * t) * (std::cos(w * t) + d / w * std::sin(w * t)));
  EXPECT_NEAR(run.output("h.angle"), wanted, 1e-6 * 1e-5);
}

// In equilibria laws of positions act, whole at full load: a held cantilever against its closed form.
TEST(Sensors, ActInEquilibria) {
  const Scene scene = read(
      R"x(<body name="m" mass="2" inertia="1 1 1"/><prismatic name="p" between="ground m" axis="1 0 0"/>
    <load at="m" force="10-3*p.displacement-0.5*m.displacement.1^3-7*p.speed 0 0"/><static/>)x");
  const Model model = compile(scene);
  State state = model.initial;
  const auto solver = make_klu_solver();
  const StaticReport report = solve_statics(*model.system, *solver, {}, state);
  ASSERT_TRUE(report.converged) << report.failure;
  const double x = state.pose[1].r(0);
  EXPECT_NEAR(3 * x + 0.5 * x * x * x, 10.0, 1e-8);
}

TEST(Sensors, SayWhatIsWrong) {
  const auto law = [](const std::string& moment) {
    return refusal(arm + R"x(<joint_torque name="servo" joint="elbow" moment=")x" + moment +
                   R"x("/>)x" + transient);
  };
  EXPECT_EQ(law("-elbow.angle"), "no error");
  EXPECT_SAYS(law("-elbo.angle"), "did you mean \"elbow\"");
  EXPECT_SAYS(law("-elbo.angle"), "joint_torque \"servo\"");
  EXPECT_SAYS(law("-elbo.angle"), "test.xml:9:");
  EXPECT_SAYS(law("-elbow.angel"), "did you mean \"angle\"");
  EXPECT_SAYS(law("-elbow.angle.1"), "leave out .1");
  EXPECT_SAYS(law("-lower.velocity"), "write .1, .2 or .3");
  EXPECT_SAYS(law("-lower.velocity.4"), "write .1, .2 or .3");
  EXPECT_SAYS(law("-elbow.displacement"), "no displacement");
  EXPECT_SAYS(law("-elbow.reaction_moment.3"), "a <controller> may sample it");
  EXPECT_SAYS(law("-lower.acceleration.3"), "a <controller> may sample");
  EXPECT_SAYS(law("max(elbow.angle,1)"), "limit it smoothly");
  EXPECT_SAYS(law("elbow.angle>0?1:0"), "sensors cannot be compared");
  EXPECT_SAYS(law("elbow"), "the unknown name 'elbow'");
  const auto other = [](const std::string& item) { return refusal(arm + item + transient); };
  EXPECT_SAYS(other(R"x(<drive joint="elbow" angle="shoulder.angle"/>)x"), "let a <load>");
  EXPECT_SAYS(other(R"x(<drive joint="elbow" rate="shoulder.rate"/>)x"), "let a load");
  EXPECT_SAYS(other(R"x(<base_motion acceleration="upper.velocity.1 0 0"/>)x"), "let a <load>");
  EXPECT_SAYS(
      other(
          R"x(<drag at="lower" density="1" area="1" coefficient="1" flow="upper.velocity.1 0 0"/>)x"),
      "depends on a sensor");
  EXPECT_SAYS(other(R"x(<parameter name="p" value="elbow.angle"/>)x"), "the sensor 'elbow.angle'");
  EXPECT_SAYS(other(R"x(<joint_spring name="k" joint="elbow" moment="x*elbow.angle"/>)x"),
              "the sensor 'elbow.angle'");
  // Of a beam: a place and a quantity; where there is a node.
  const auto beam = [](const std::string& force) {
    std::string base = frame.substr(0, frame.find("<body"));
    return refusal(base + R"x(<load at="c.end" force=")x" + force + R"x( 0 0"/>)x" + transient);
  };
  EXPECT_EQ(beam("b@0.5.displacement.1"), "no error");
  EXPECT_SAYS(beam("b.displacement.1"), "write b.start, b.end or b@0.5");
  EXPECT_SAYS(beam("b@0.51.displacement.1"), "the nearest is at b@0.5");
  EXPECT_SAYS(beam("b.end"), "the quantity is missing");
  // What is not a number ends the run by the law's name.
  Session run(arm + R"x(<joint_torque name="bad" joint="elbow" moment="(0.2+elbow.angle)^1.5"/>
    <transient duration="3" step="0.01"/>)x");
  StepReport report;
  do report = run.stepper->step(run.state);
  while (report.converged && run.state.t < 2.99);
  EXPECT_FALSE(report.converged);
  EXPECT_SAYS(report.failure, "joint_torque \"bad\"");
}

// --- sampled controllers ---

// The servo of test_inputs, in the model: against equations of its own that see the joints every millisecond.
TEST(Controllers, ServoThatHolds) {
  const auto servo = [](double, const Four& x) -> std::array<double, 2> {
    return {-200.0 * (x[0] - 0.4) - 30.0 * x[2], -100.0 * (x[1] + 0.7) - 12.0 * x[3]};
  };
  const Four wanted = arm_by_lagrange(1e-3, 200, servo, true);
  const std::string in_model = R"x(
    <controller name="servo" period="1 ms">
      <output name="u1" value="-200*(shoulder.angle-0.4)-30*shoulder.rate"/>
      <output name="u2" value="(-100*(elbow.angle+0.7)-12*elbow.rate)*1e3 N.mm"/>
    </controller>
    <joint_torque joint="shoulder" moment="u1"/><joint_torque joint="elbow" moment="u2"/>)x";
  const auto error = [&](const std::string& settings) {
    Session run(arm + in_model + settings);
    run.land(0.2);
    return largest_difference(joints_of(run), wanted, 2);
  };
  EXPECT_LT(error(R"x(<transient duration="0.2" step="1e-3" method="radau"/>)x"), 1e-9);
  EXPECT_LT(error(R"x(<transient duration="0.2" tolerance="1e-8" method="radau"/>)x"), 1e-7);
  EXPECT_LT(error(R"x(<transient duration="0.2" tolerance="1e-7" method="ida"/>)x"), 1e-5);
  const double coarse = error(R"x(<transient duration="0.2" step="0.25e-3"/>)x"),
               fine = error(R"x(<transient duration="0.2" step="0.125e-3"/>)x");
  EXPECT_LT(fine, 1e-6);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.15);
}

const std::string cart = R"x(<body name="m" mass="2" inertia="1 1 1"/>
  <prismatic name="p" between="ground m" axis="1 0 0"/>
  <record name="p" joint="p" quantities="displacement speed"/>)x";

// A mass under a force that is held: x and v one period on are exact. `next` gives the force at an instant.
template <class Next>
std::array<double, 2> held_mass(double period, int periods, const Next& next) {
  double x = 0.0, v = 0.0;
  for (int k = 0; k < periods; ++k) {
    const double a = next(k, x, v) / 2.0;
    x += period * v + 0.5 * period * period * a;
    v += period * a;
  }
  return {x, v};
}

// Steps that a period divides, that it does not divide, and shorter and longer ones: the instants are landed on.
TEST(Controllers, DoubleIntegrator) {
  const std::string law = R"x(<controller name="c" period="0.07">
      <output name="u" value="-8*(p.displacement-1)-5*p.speed"/></controller>
    <load at="m" force="u 0 0"/>)x";
  const auto wanted =
      held_mass(0.07, 30, [](int, double x, double v) { return -8 * (x - 1) - 5 * v; });
  for (const char* settings :
       {R"x(step="0.07")x", R"x(step="0.03")x", R"x(step="0.1")x",
        R"x(step="0.033" method="radau")x", R"x(tolerance="1e-6")x",
        R"x(tolerance="1e-6" method="radau")x", R"x(tolerance="1e-9" method="ida")x"}) {
    SCOPED_TRACE(settings);
    Session run(cart + law + fmt::format(R"x(<transient duration="2.1" {}/>)x", settings));
    // The state at the last instant: from fixed steps that do not end there, by dense output.
    State at = run.state;
    const double end = 30 * 0.07;
    run.stepper->on_substep([&](const DenseStep& step) {
      if (step.begin() < end && end <= step.end() + 1e-12) step.at(std::min(end, step.end()), at);
    });
    run.land(2.1);
    std::vector<double> values(ports(run.model).outputs.size());
    outputs(run.model, at, values);
    const double slack = std::string(settings).find("ida") != std::string::npos ? 1e-6 : 1e-10;
    EXPECT_NEAR(values[0], wanted[0], slack);
    EXPECT_NEAR(values[1], wanted[1], slack);
  }
}

// What it holds acts from the instant on, before any step: the accelerations at t = 0 are those of the first output, and in
// history the reaction at an instant is that of the new output.
TEST(Controllers, ActAtOnce) {
  Session run(cart + R"x(<controller name="c" period="0.5">
      <output name="u" start="7" value="4+t"/></controller><load at="m" force="u 0 0"/>)x" +
              transient);
  EXPECT_EQ(run.held("u"), 4.0);
  EXPECT_NEAR(run.state.Vdot[1](0), 2.0, 1e-12);
  run.to(0.4);
  EXPECT_EQ(run.held("u"), 4.0);
  run.to(0.5);
  EXPECT_EQ(run.held("u"), 4.5);
  EXPECT_NEAR(run.state.Vdot[1](0), 2.25, 1e-12);
  // start() again does not sample again.
  const StepReport again = run.stepper->start(run.state);
  EXPECT_TRUE(again.converged);
  EXPECT_EQ(run.state.control[0], 2.0);
  const Ports all = ports(run.model);
  ASSERT_EQ(all.inputs.size(), 1U);
  EXPECT_EQ(all.inputs[0].set_by, "c");
}

// States as they were, outputs in order, conditions, kinks: against a loop.
TEST(Controllers, StatesAndOrder) {
  const std::string law = R"x(<function name="ref" value="t&lt;0.5?1:-1"/>
    <controller name="c" period="0.05">
      <state name="count" next="count+1"/>
      <output name="wanted" value="count&lt;4 ? 2 : min(max(6*(ref(t)-p.displacement)-last/4,-3),abs(last)+1)"/>
      <state name="last" start="3" next="wanted"/>
      <output name="u" value="wanted+(count>=7 &amp;&amp; !(wanted==2) ? floor(last) : 0)"/>
    </controller><load at="m" force="u 0 0"/>)x";
  double last = 3.0;
  const auto wanted = held_mass(0.05, 20, [&](int k, double x, double) {
    const double ref = 0.05 * k < 0.5 - 1e-12 ? 1.0 : -1.0;
    const double w =
        k < 4 ? 2.0 : std::min(std::max(6 * (ref - x) - last / 4, -3.0), std::abs(last) + 1);
    const double u = w + (k >= 7 && w != 2.0 ? std::floor(last) : 0.0);
    last = w;
    return u;
  });
  Session run(cart + law + R"x(<transient duration="1" step="0.05"/>)x");
  run.to(1.0);
  EXPECT_NEAR(run.output("p.displacement"), wanted[0], 1e-10);
  EXPECT_NEAR(run.output("p.speed"), wanted[1], 1e-10);
}

// Integrator, filtered derivative, limits that the integrator does not run into; discrete matrices. A second controller, slower, sees
// what the first gives at the same instant.
TEST(Controllers, PidAndMatrices) {
  const std::string law = R"x(
    <controller name="fast" period="0.02">
      <pid name="u" error="1-p.displacement" proportional="30" integral="40" derivative="12" filter="0.03"
        limits="-8 8"/>
      <state_space inputs="p.speed u" outputs="y z" A="0.9 0.1 -0.2 0.8" B="0.1 0 0 0.05" C="1 0 0.5 2"
        D="0 0 0.25 0" start="0.1 -0.3"/>
    </controller>
    <controller name="slow" period="0.06"><output name="w" value="u/8"/></controller>
    <load at="m" force="u-y+0.1*z+w 0 0"/>)x";
  constexpr double T = 0.02;
  double I = 0, D = 0, before = 1.0, x1 = 0.1, x2 = -0.3, w = 0, most = 0;
  const auto wanted = held_mass(T, 50, [&](int k, double x, double v) {
    const double e = 1 - x;
    D = (0.03 * D + 12 * (e - before)) / (0.03 + T);
    before = e;
    const double all = 30 * e + I + D, u = std::min(8.0, std::max(-8.0, all));
    most = std::max(most, std::abs(all));
    const double growth = 40 * T * e;
    if (!((all > u && growth > 0) || (all < u && growth < 0))) I += growth;
    const double y = x1, z = 0.5 * x1 + 2 * x2 + 0.25 * v;
    const double n1 = 0.9 * x1 + 0.1 * x2 + 0.1 * v, n2 = -0.2 * x1 + 0.8 * x2 + 0.05 * u;
    x1 = n1;
    x2 = n2;
    if (k % 3 == 0) w = u / 8;
    return u - y + 0.1 * z + w;
  });
  EXPECT_GT(most, 16.0);  // far in the limits
  Session run(cart + law + R"x(<transient duration="1" step="0.02"/>)x");
  run.to(1.0);
  EXPECT_NEAR(run.output("p.displacement"), wanted[0], 1e-10);
  EXPECT_NEAR(run.output("p.speed"), wanted[1], 1e-10);
}

// All recorded quantities may be sampled: accelerations and reactions are those before the instant, between nodes of a beam too.
TEST(Controllers, SampleWhatIsRecorded) {
  Session run(cart + R"x(<controller name="c" period="0.25">
      <output name="a" value="m.acceleration.1"/><output name="f" value="p.reaction_force.1"/>
      <output name="u" value="t+3"/></controller>
    <load at="m" force="u u u"/><record name="m" at="m" quantities="acceleration"/>
    <transient duration="1" step="0.125"/>)x");
  EXPECT_EQ(run.held("a"), 0.0);
  run.to(0.25);
  EXPECT_NEAR(run.held("a"), 1.5, 1e-10);
  EXPECT_NEAR(std::abs(run.held("f")), 3.0, 1e-9);
  EXPECT_NEAR(run.output("m.acceleration.1"), 1.625, 1e-10);
}

// Goes on from a checkpoint to the last bit, states of controllers included.
TEST(Controllers, AreInCheckpoints) {
  const std::string law = R"x(<controller name="c" period="0.03">
      <pid name="u" error="1-p.displacement" proportional="30" integral="40" derivative="12" filter="0.03"/>
    </controller><load at="m" force="u-0.3*p.speed^3 0 0"/>)x";
  for (const char* settings :
       {R"x(step="0.02")x", R"x(step="0.02" method="radau")x", R"x(tolerance="1e-5")x"}) {
    SCOPED_TRACE(settings);
    const std::string text =
        cart + law + fmt::format(R"x(<transient duration="2" {}/>)x", settings);
    Session whole(text), part(text);
    for (int k = 0; k < 17; ++k) ASSERT_TRUE(whole.stepper->step(whole.state).converged);
    const Checkpoint kept = whole.stepper->save(whole.state);
    const auto other = make_stepper(*part.model.system, *part.scene.transient);
    State state = part.model.initial;
    other->restore(kept, state);
    EXPECT_EQ(state.control, whole.state.control);
    for (int k = 0; k < 23; ++k) {
      ASSERT_TRUE(whole.stepper->step(whole.state).converged);
      ASSERT_TRUE(other->step(state).converged);
    }
    EXPECT_EQ(state.t, whole.state.t);
    EXPECT_EQ(state.pose[1].r(0), whole.state.pose[1].r(0));
    EXPECT_EQ(state.V[1](0), whole.state.V[1](0));
    EXPECT_EQ(state.control, whole.state.control);
    EXPECT_GT(state.control[0], 1.0);
  }
}

// Checkpoints of a model that differs in one number of a law, wherever it stands and whether or not it shows at t = 0, are refused.
// Mutations: signatures of laws, of controllers, of tables left out of the fingerprint.
TEST(Controllers, CheckpointsAreOfTheseLaws) {
  const std::string text = cart + R"x(
    <input name="in1" value="2"/>
    <function name="tab">0 0  0.2 0.3  1 -0.5</function>
    <function name="ex" value="0.2*sin(9*t)"/>
    <function name="ld">0 0  0.2 0.3  1 -0.5</function>
    <function name="le" value="0.5*cos(3*t)"/>
    <controller name="c" period="0.01">
      <state name="s" next="0.9*s+p.displacement+0.05*in1"/>
      <output name="y" value="5*(tab(t)-p.displacement)-0.1*s+ex(t)+(p.displacement &gt; 5 ? 1 : 0)"/>
      <state_space inputs="p.speed" outputs="z" A="0.5" B="0.1" C="1" D="0.02"/>
      <pid name="u" error="tab(t)-p.displacement" proportional="1" derivative="0.1" filter="1e-3" limits="-3 3"/>
    </controller>
    <load at="m" force="y-z+u-0.3*p.speed+ld(t)+le(t) 0 0"/>
    <transient duration="1" step="0.001"/>)x";
  Session run(text);
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(run.stepper->step(run.state).converged);
  const Checkpoint kept = run.stepper->save(run.state);
  const auto restored = [&](const std::string& other) {
    Session again(other);
    State state = again.model.initial;
    try {
      again.stepper->restore(kept, state);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(restored(text), "");
  for (const auto& [from, to] : std::vector<std::array<std::string, 2>>{
           {R"x("tab">0 0  0.2 0.3)x", R"x("tab">0 0  0.2 0.9)x"},
           {"0.2*sin(9*t)", "5*sin(9*t)"},
           {R"x("ld">0 0  0.2 0.3)x", R"x("ld">0 0  0.2 0.9)x"},
           {"0.5*cos(3*t)", "0.5*cos(5*t)"},
           {"0.9*s+", "0.8*s+"},
           {"5*(tab", "6*(tab"},
           {"p.displacement &gt; 5", "p.displacement &gt; 4"},
           {R"x(A="0.5")x", R"x(A="0.4")x"},
           {R"x(D="0.02")x", R"x(D="0.03")x"},
           {R"x(inputs="p.speed")x", R"x(inputs="p.displacement")x"},
           {R"x(proportional="1")x", R"x(proportional="2")x"},
           {R"x(filter="1e-3")x", R"x(filter="2e-3")x"},
           {R"x(limits="-3 3")x", R"x(limits="-3 4")x"},
           {R"x(period="0.01")x", R"x(period="0.02")x"}}) {
    std::string other = text;
    ASSERT_NE(other.find(from), std::string::npos) << from;
    other.replace(other.find(from), from.size(), to);
    EXPECT_SAYS(restored(other), "another model");
  }
}

TEST(Controllers, SayWhatIsWrong) {
  const auto said = [](const std::string& inside, const std::string& load = "u") {
    return refusal(cart + R"x(<controller name="c" period="0.1">)x" + inside +
                   R"x(</controller><load at="m" force=")x" + load + R"x( 0 0"/>)x" + transient);
  };
  EXPECT_EQ(said(R"x(<output name="u" value="1"/>)x"), "no error");
  EXPECT_SAYS(said("", "0"), "it does nothing");
  EXPECT_SAYS(said(R"x(<output name="u" value="x"/>)x"), "the unknown name 'x'");
  EXPECT_SAYS(said(R"x(<state name="x" next="x+1"/><output name="u" value="x"/>)x", "x"),
              "the unknown name 'x'");
  EXPECT_SAYS(said(R"x(<output name="u" value="v"/><output name="v" value="1"/>)x"),
              "the unknown name 'v'");
  EXPECT_SAYS(said(R"x(<output name="u" value="q.angle"/>)x"), "there is no joint, body, beam");
  EXPECT_SAYS(said(R"x(<output name="u" value="q.angle"/>)x"), "controller \"c\"");
  EXPECT_SAYS(said(R"x(<output name="u" value="1"/><output name="u" value="1"/>)x"), "already");
  EXPECT_SAYS(said(R"x(<output name="u" value="m.force.1"/>)x"), "force is a resultant of a beam");
  EXPECT_SAYS(said(R"x(<output name="u" value="m.moment.2"/>)x"),
              "or of a joint, as its reaction_moment");
  EXPECT_SAYS(said(R"x(<output name="u" value="m.von_mises"/>)x"), "point of a section");
  EXPECT_SAYS(said(R"x(<output name="u" value="p.angle"/>)x"), "test.xml:");
  EXPECT_SAYS(said(R"x(<output name="u" value="p.angle"/>)x"), "sensor \"p.angle\": ");
  EXPECT_SAYS(said(R"x(<pid name="u" error="1"/>)x"), "it gives nothing");
  EXPECT_SAYS(said(R"x(<pid name="u" error="1" integral="1" limits="1 -1"/>)x"), "must rise");
  EXPECT_SAYS(said(R"x(<pid name="u" error="1" integral="1" limits="-1 1" start="2"/>)x"),
              "start is the output before the first instant");
  EXPECT_SAYS(said(R"x(<state_space inputs="1" outputs="u" A="1 2" B="1" C="1"/>)x"),
              "A has 2 numbers");
  EXPECT_SAYS(said(R"x(<state_space inputs="1" outputs="u" A="1" B="1 2" C="1"/>)x"),
              "B has 2 numbers");
  const auto whole = [](const std::string& controller, const std::string& end = transient) {
    return refusal(cart + controller + end);
  };
  EXPECT_SAYS(
      whole(R"x(<controller name="c" period="0"><output name="u" value="1"/></controller>)x"),
      "must be positive");
  EXPECT_SAYS(
      whole(R"x(<controller name="c" period="1e-9"><output name="u" value="1"/></controller>)x"),
      "instants in the run");
  EXPECT_SAYS(
      whole(R"x(<controller name="c" period="1"><output name="u" value="1"/></controller>)x",
            "<static/>"),
      "it samples a motion");
  EXPECT_SAYS(whole(R"x(<controller name="c" period="1"><output name="u" value="1"/></controller>
      <drive joint="p" displacement="u"/>)x"),
              "what a controller holds");
  EXPECT_SAYS(whole(R"x(<controller name="c" period="1"><output name="u" value="1"/></controller>
      <drive joint="p" displacement="t&lt;0.5 ? 0 : u"/>)x"),
              "depends on an input and switches in time");
  // An output that is not a number ends the run by its name.
  Session run(
      cart +
      R"x(<controller name="c" period="0.3"><output name="u" value="sqrt(0.5-t)"/></controller>
    <load at="m" force="u 0 0"/>)x" +
      transient);
  StepReport report;
  do report = run.stepper->step(run.state);
  while (report.converged && run.state.t < 0.95);
  EXPECT_FALSE(report.converged);
  EXPECT_NEAR(run.state.t, 0.6, 1e-9);
  EXPECT_SAYS(report.failure, "controller \"c\": the output \"u\" is ");
}

// --- hostile ---

// Millimetres and degrees, another order of the file: the controlled joint after its controller. The same motion as in metres.
// An upright pole that a controller holds is unstable in linear analyses, which say why.
TEST(Controllers, AreHeldInLinearAnalyses) {
  const std::string pole = R"x(<body name="rod" mass="2" inertia="1e-4 0.05 0.05" at="0 0 0.5"/>
    <revolute name="foot" between="ground rod" at="0 0 0" axis="0 1 0"/><gravity acceleration="0 0 -9.81"/>)x";
  const Linearization held = linearize(
      read(
          R"x(<controller name="c" period="1 ms"><output name="u" value="-40*foot.angle"/></controller>)x" +
          pole + R"x(<joint_torque joint="foot" moment="u"/>)x" + transient),
      ModesOptions());
  ASSERT_EQ(held.notes.size(), 1u);
  EXPECT_SAYS(held.notes.front(), "outputs of controllers are held");
  EXPECT_GT(held.reduced->A(1, 0), 0.0);
  const Linearization whole = linearize(
      read(pole + R"x(<joint_torque joint="foot" moment="-40*foot.angle"/>)x" + transient),
      ModesOptions());
  EXPECT_TRUE(whole.notes.empty());
  EXPECT_LT(whole.reduced->A(1, 0), 0.0);
}

TEST(HostileControl, OtherUnitsAndOrder) {
  const std::string end = R"x(<transient duration="400 ms" step="2 ms"/>)x";
  Session plain(arm + R"x(<controller name="c" period="0.005">
      <output name="u" value="-60*(elbow.angle+0.5)-4*elbow.rate"/></controller>
    <joint_torque joint="elbow" moment="u-3*(lower.position.2+0.2)"/>)x" +
                end);
  Session other(R"x(<transient duration="400 ms" step="2 ms"/>
    <parameter name="stiffness" value="60*pi/180*1e3 N.mm"/><function name="target" unit="deg">0 -28.64788975654116  9 -28.64788975654116</function>
    <controller name="c" period="5 ms">
      <output name="u" value="-(stiffness/deg)*(elbow.angle-target(t))-4*elbow.rate"/></controller>
    <joint_torque joint="elbow" moment="(u-3*(lower.position.2+0.2))*1e3 N.mm"/>
    <record name="e" joint="elbow" quantities="angle rate"/>
    <record name="s" joint="shoulder" quantities="angle rate"/>
    <gravity acceleration="0 -9810 0 mm/s2"/>
    <revolute name="elbow" between="upper lower" at="1000 0 0 mm" axis="0 0 2"/>
    <revolute name="shoulder" between="ground upper" at="0 0 0" axis="0 0 1"/>
    <body name="lower" mass="1000 g" inertia="1e-3 1/12 1/12" at="1500 0 0 mm"/>
    <body name="upper" mass="1" inertia="1e-3 1/12 1/12" at="50 0 0 cm"/>)x");
  plain.to(0.4);
  other.to(0.4);
  EXPECT_LT(largest_difference(joints_of(other), joints_of(plain)), 1e-8);
  EXPECT_GT(std::abs(plain.output("e.rate")), 1e-3);
}

// A sensor in axes that turn, with an offset: a wheel, and a follower force on it that goes with its own velocity along its own x.
// In own axes v1 = 0 under steady turning about its centre, though the place moves; the inertial component is not 0.
TEST(HostileControl, SensorOnAWheel) {
  const std::string wheel = R"x(<body name="hub" mass="1" inertia="1 1 2" angular_velocity="0 0 3"/>
    <body name="rim" attached_to="hub" mass="0" inertia="0 0 0" {}/>
    <revolute name="axle" between="ground hub" axis="0 0 1"/>
    <record name="hub" joint="axle" quantities="angle rate"/>)x";
  // Drag by the velocity of the hub's own axes: M = -c w, w' = -c w / J.
  Session run(fmt::format(fmt::runtime(wheel), "") + R"x(
    <load at="hub" follower_moment="0 0 -1.5*hub.angular_velocity_local.3"/>
    <load at="hub" moment="5*hub.velocity_local.1 0 0"/>
    <transient duration="1" step="0.01" method="radau"/>)x");
  run.to(1.0);
  EXPECT_NEAR(run.output("hub.rate"), 3.0 * std::exp(-0.75), 1e-8);
  EXPECT_NEAR(run.output("hub.angle"), 4.0 * (1 - std::exp(-0.75)), 1e-8);
  // Many turns: the angle of a joint is followed, not wrapped.
  Session turns(fmt::format(fmt::runtime(wheel), "") + R"x(
    <joint_torque joint="axle" moment="-0.02*axle.angle"/>
    <transient duration="20" step="0.02" method="radau"/>)x");
  turns.to(20.0);
  EXPECT_NEAR(turns.output("hub.angle"), 30.0 * std::sin(2.0), 1e-6);
}

// A period that does not divide the step, nor the duration; adaptive steps with long ones between; rows between them.
TEST(HostileControl, PeriodBesideTheSteps) {
  const std::string law = R"x(<controller name="c" period="1/3">
      <state name="n" next="n+1"/><output name="u" value="n"/></controller><load at="m" force="2*u 0 0"/>)x";
  // x = sum of (t - t_k)^2/2 of unit steps at t_k = k/3, k >= 1.
  const auto wanted = [](double t) {
    double x = 0.0;
    for (int k = 1; k / 3.0 < t; ++k) x += 0.5 * (t - k / 3.0) * (t - k / 3.0);
    return x;
  };
  for (const char* settings : {R"x(step="0.25")x", R"x(step="0.1")x", R"x(tolerance="1e-6")x",
                               R"x(step="0.7" method="radau")x"}) {
    SCOPED_TRACE(settings);
    Session run(cart + law + fmt::format(R"x(<transient duration="7" {}/>)x", settings));
    run.to(7.0);
    EXPECT_NEAR(run.output("p.displacement"), wanted(7.0), 1e-10 * wanted(7.0));
    EXPECT_EQ(run.state.control[1], 22.0);  // instants at 0, 1/3, …, 7: 22 of them
  }
}

}  // namespace
}  // namespace mbd::test::test_control
