// Joints, drives and prescribed motions in mechanisms whose motion is known in closed form, or by a
// scalar equation integrated here. Each test says which errors it would show.

#include <gtest/gtest.h>

#include <numbers>

#include "libmbd/language/schema.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_mechanisms {
namespace {

constexpr double pi = std::numbers::pi;
using std::cos, std::sin, std::sqrt;

History run_text(const std::string& inside) {
  History h = run_to_table(read_model_text("<mbd name=\"test\">" + inside + "</mbd>"));
  EXPECT_TRUE(h.report.complete()) << h.report.failure;
  return h;
}
std::string message(const std::string& inside) {
  try {
    run(read_model_text("<mbd name=\"test\">" + inside + "</mbd>", "model.xml"));
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}
Vec3 vector(const Table& t, const std::string& quantity, std::size_t k) {
  return {t[quantity + ".1"].at(k), t[quantity + ".2"].at(k), t[quantity + ".3"].at(k)};
}
Mat3 rotation_matrix(const Vec3& v) { return Pose<double>{exp_so3<double>(v), {}}.R(); }

// Half a turn away, and where axes change places, the gaps of rows of directions and angles are zero as well: no equations
// are made there. Mutations: the branch of a revolute joint, of a drive or of a fixed joint is not looked at.
TEST(Mechanisms, DoNotHoldOnAnotherBranch) {
  struct Case {
    const char* joint;
    Vec3 turn;
  };
  const Case cases[] = {
      {R"(<revolute name="J" between="ground b" axis="0 1 0"/>)", Vec3(pi, 0, 0)},
      {R"(<revolute name="J" between="ground b" axis="0 1 0"/><drive joint="J" angle="0"/>)",
       Vec3(0, pi, 0)},
      {R"(<fixed name="J" between="ground b"/>)", 2 * pi / 3 / sqrt(3.0) * Vec3(1, 1, 1)}};
  for (const Case& c : cases) {
    const Model model = compile(
        read_model_text(std::string(R"(<mbd name="m"><body name="b" mass="2" inertia="1 1 1"/>)") +
                        c.joint + R"(<transient duration="1" step="0.1"/></mbd>)"));
    State state = model.initial;
    VecX residual;
    EXPECT_TRUE(model.system->residual(state, residual)) << c.joint;
    EXPECT_EQ(model.system->out_of_range(state), "") << c.joint;
    state.pose[1].p = exp_so3<double>(c.turn);
    EXPECT_FALSE(model.system->residual(state, residual)) << c.joint;
    EXPECT_NE(model.system->out_of_range(state).find("'J'"), std::string::npos)
        << c.joint << ": " << model.system->out_of_range(state);
  }
}

// Driven for ten turns and back: the advance is the pitch a turn, of either hand. Shows an angle that is
// not followed (beyond half a turn), the sign of the pitch, 10 % of it.
TEST(Mechanisms, ScrewAdvancesByItsPitchATurn) {
  for (const char* const pitch : {"0.02", "-0.3"}) {
    const History h =
        run_text("<parameter name=\"pitch\" value=\"" + std::string(pitch) + "\"/>" + R"xml(
      <body name="nut" mass="2" inertia="1 1 1"/>
      <screw name="S" between="ground nut" axis="0 0.6 0.8" pitch="pitch"/>
      <drive joint="S" rate="60*sin(t)*sin(t)*(t > pi ? -1 : 1)"/>
      <transient duration="6.25" step="0.005" rho_infinity="0.8"/>
      <record name="S" joint="S" quantities="angle rate displacement speed"/>
      <record name="nut" at="nut" quantities="position"/>)xml");
    const double per_turn = std::stod(pitch);
    Worst angle("angle", 1e-10), advance("advance", 1e-11), speed("speed", 1e-10);
    double farthest = 0.0;
    for (std::size_t k = 0; k < h.table["time"].size(); ++k) {
      const double t = h.table["time"][k], x = std::min(t, 2 * pi - t);
      const double theta = 30 * x - 15 * sin(2 * x), now = h.table["S.angle"][k];
      angle.add(std::abs(now - theta));
      advance.add(std::abs(h.table["S.displacement"][k] - per_turn * theta / (2 * pi)));
      advance.add(
          (vector(h.table, "nut.position", k) - per_turn * theta / (2 * pi) * Vec3(0, .6, .8))
              .norm());
      speed.add(std::abs(h.table["S.speed"][k] - per_turn / (2 * pi) * h.table["S.rate"][k]) / 60);
      farthest = std::max(farthest, now);
    }
    EXPECT_GT(farthest, 10 * 2 * pi);
  }
}

// A nut on a vertical screw falls with a constant angular acceleration m g p/(J + m p^2), p = pitch/2pi,
// through 15 turns: the time scheme has no error there. Shows 10 % in mass, inertia, pitch.
TEST(Mechanisms, ScrewFallsAsItsInertiaSays) {
  const History h = run_text(R"xml(
      <body name="nut" mass="1" inertia="0.02 0.02 0.01"/>
      <screw name="S" between="ground nut" axis="0 0 1" pitch="0.5"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="2" step="0.01"/>
      <record name="S" joint="S" quantities="angle reaction_force reaction_moment"/>)xml");
  const double p = 0.5 / (2 * pi), acceleration = -9.81 * p / (0.01 + p * p);
  Worst angle("angle", 1e-8), force("force", 1e-6);
  for (std::size_t k = 1; k < h.table["time"].size(); ++k) {
    const double t = h.table["time"][k];
    angle.add(std::abs(h.table["S.angle"][k] - 0.5 * acceleration * t * t));
    force.add(std::abs(h.table["S.reaction_force.3"][k] - (9.81 + p * acceleration)));
    force.add(std::abs(h.table["S.reaction_moment.3"][k] - 0.01 * acceleration));
  }
  EXPECT_LT(h.table["S.angle"].back(), -14 * 2 * pi);
}

// Two shafts at 40 degrees; the second's axis is held by the universal joint and a point on a line, so
// nothing is held twice. With the first axis of the cross across the plane of the shafts at the start,
// tan(out) = cos(beta) tan(in). Shows the two axes interchanged, and 1 % of the angle between the shafts.
TEST(Mechanisms, UniversalJointTurnsUnevenly) {
  const History h = run_text(R"xml(
      <parameter name="beta" value="40*deg"/>
      <body name="in" at="-1 0 0" mass="1" inertia="1 1 1"/>
      <body name="out" at="0 0 0" mass="1" inertia="1 1 1"/>
      <revolute name="R" between="ground in" at="-1 0 0" axis="1 0 0"/>
      <universal name="U" between="in out" at="0 0 0" axis="0 0 1" second_axis="-sin(beta) cos(beta) 0"/>
      <point_on_line name="L" between="out ground" at="cos(beta) sin(beta) 0" axis="cos(beta) sin(beta) 0"/>
      <drive joint="R" angle="2*t^2"/>
      <transient duration="3" step="0.002" rho_infinity="0.8"/>
      <record name="out" at="out" quantities="rotation angular_velocity"/>)xml");
  const double beta = 40 * pi / 180;
  const Vec3 shaft(cos(beta), sin(beta), 0);
  Worst angle("angle", 1e-10), rate("rate", 1e-3);
  for (std::size_t k = 0; k < h.table["time"].size(); ++k) {
    const double t = h.table["time"][k], in = 2 * t * t;
    const Vec3 r = vector(h.table, "out.rotation", k);
    const double out = std::atan2(cos(beta) * sin(in), cos(in));  // the same quadrant
    angle.add((rotation_matrix(r) - rotation_matrix(out * shaft)).cwiseAbs().maxCoeff());
    const double ratio = cos(beta) / (1 - std::pow(sin(beta) * sin(in), 2));
    rate.add((vector(h.table, "out.angular_velocity", k) - 4 * t * ratio * shaft).norm() / 12);
  }
}

// A plate slides down a plane of 20 degrees with g sin(alpha), spinning freely; what holds it is its weight
// across the plane. Shows 10 % in mass (reaction), a friction of any sort, a normal taken for another.
TEST(Mechanisms, PlanarJointIsAnInclinedPlane) {
  const History h = run_text(R"xml(
      <parameter name="a" value="20*deg"/>
      <body name="plate" at="1 2 3" orientation="0 a 0" mass="3" inertia="0.1 0.2 0.3" velocity="0 0.5 0" angular_velocity="0 0 4"/>
      <planar name="P" between="ground plate" axis="sin(a) 0 cos(a)"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="3" step="0.001" rho_infinity="0.8"/>
      <record name="plate" at="plate" quantities="position"/>
      <record name="P" joint="P" quantities="angle rate reaction_force reaction_moment"/>)xml");
  const double a = 20 * pi / 180;
  Worst position("position", 2e-4), angle("angle", 1e-9), force("force", 1e-4);
  for (std::size_t k = 1; k < h.table["time"].size(); ++k) {
    const double t = h.table["time"][k], s = 0.5 * 9.81 * sin(a) * t * t;
    position.add(
        (vector(h.table, "plate.position", k) - Vec3(1 + s * cos(a), 2 + 0.5 * t, 3 - s * sin(a)))
            .norm());
    angle.add(std::abs(h.table["P.angle"][k] - 4 * t));
    force.add((vector(h.table, "P.reaction_force", k) - Vec3(0, 0, 3 * 9.81 * cos(a))).norm());
    force.add(vector(h.table, "P.reaction_moment", k).norm());
  }
}

// A conical pendulum: a ball on a rod, circling at 50 degrees from the vertical with w^2 = g/(L cos), the
// rod's tension m g/cos. Shows 10 % in mass (tension), length, gravity; a tension of the wrong sign.
TEST(Mechanisms, DistanceIsARod) {
  const History h = run_text(R"xml(
      <parameter name="b" value="50*deg"/>
      <parameter name="w" value="sqrt(9.81/(2*cos(b)))"/>
      <body name="ball" at="2*sin(b) 0 -2*cos(b)" mass="3" inertia="0.1 0.1 0.1" velocity="0 2*w*sin(b) 0"/>
      <distance name="rod" between="ground ball" at_a="0 0 0"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="4" step="0.001"/>
      <record name="ball" at="ball" quantities="position rotation"/>
      <record name="rod" joint="rod" quantities="reaction_force"/>)xml");
  const double b = 50 * pi / 180, w = sqrt(9.81 / (2 * cos(b)));
  Worst position("position", 1e-4), length("length", 1e-10), force("force", 0.03),
      turned("turned", 1e-12);
  for (std::size_t k = 1; k < h.table["time"].size(); ++k) {
    const double t = h.table["time"][k];
    const Vec3 x = vector(h.table, "ball.position", k);
    position.add((x - 2 * Vec3(sin(b) * cos(w * t), sin(b) * sin(w * t), -cos(b))).norm());
    length.add(std::abs(x.norm() - 2));
    turned.add(vector(h.table, "ball.rotation", k).norm());
    force.add((vector(h.table, "rod.reaction_force", k) + 3 * 9.81 / cos(b) * x / 2).norm());
  }
}

// Two bodies on a rigid link, swinging as a compound pendulum, and one body with their mass, mass centre and
// inertia. Shows 10 % in either mass, and a link that gives.
TEST(Mechanisms, LinkedBodiesAreOneBody) {
  const std::string common = R"xml(
      <revolute name="R" between="ground one" at="0 0 0" axis="0 1 0"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="1" step="5e-4"/>
      <record name="R" joint="R" quantities="angle reaction_force"/>)xml";
  const History two = run_text(R"xml(
      <body name="one" at="0.5 0 0" mass="2" inertia="0.1 0.1 0.1"/>
      <body name="other" at="1 0.2 -0.4" mass="1" inertia="0.2 0.2 0.2"/>
      <rigid_link name="link" between="one other"/>)xml" +
                               common);
  // Mass centre at a third of the way; Steiner's theorem.
  const History merged = run_text(R"xml(
      <parameter name="x" value="0.5/3"/>
      <parameter name="y" value="0.2/3"/>
      <parameter name="z" value="-0.4/3"/>
      <body name="one" at="0.5 0 0" mass="3" center="x y z" inertia="0.3+6*(y^2+z^2) 0.3+6*(x^2+z^2) 0.3+6*(x^2+y^2) -6*x*y -6*x*z -6*y*z"/>)xml" +
                                  common);
  Worst angle("angle", 1e-6), force("force", 1e-3);
  for (std::size_t k = 1; k < two.table["time"].size(); ++k) {
    angle.add(std::abs(two.table["R.angle"][k] - merged.table["R.angle"][k]));
    force.add(
        (vector(two.table, "R.reaction_force", k) - vector(merged.table, "R.reaction_force", k))
            .norm());
  }
  EXPECT_GT(two.table["R.angle"].back(), 1.0);
}

// Lifted and let down along a slope by a law: where it is, and the force along the axis, m (a + g sin).
// Shows 10 % in mass, and a drive's part missing from the joint's reaction.
TEST(Mechanisms, DrivenSlide) {
  const History h = run_text(
      R"xml(
      <body name="sledge" mass="4" inertia="1 1 1"/>
      <prismatic name="P" between="ground sledge" axis="0.6 0 0.8"/>
      <drive joint="P" displacement="0.1*(1 - cos(3*t))"/>
      <gravity acceleration="0 0 -10"/>
      <transient duration="2" step="0.002" rho_infinity="0.8"/>
      <record name="sledge" at="sledge" quantities="position"/>
      <record name="P" joint="P" quantities="displacement speed reaction_force"/>)xml");
  Worst position("position", 1e-12), speed("speed", 1e-4), force("force", 0.02);
  for (std::size_t k = 0; k < h.table["time"].size(); ++k) {
    const double t = h.table["time"][k], d = 0.1 * (1 - cos(3 * t));
    position.add((vector(h.table, "sledge.position", k) - d * Vec3(0.6, 0, 0.8)).norm());
    position.add(std::abs(h.table["P.displacement"][k] - d));
    speed.add(std::abs(h.table["P.speed"][k] - 0.3 * sin(3 * t)));
    if (k > 2) force.add(std::abs(h.table["P.reaction_force.3"][k] - 4 * (0.9 * cos(3 * t) + 8)));
  }
}

// A body led through space by laws of position and rotation vector, beyond two turns: it is where they say,
// and its leader exerts m (a - g) and J w' + w x J w, in axes that turn with it. Shows 10 % in mass and
// inertia, and an error in the exponential's rates.
TEST(Mechanisms, PrescribedMotion) {
  const History h = run_text(
      R"xml(
      <body name="b" at="1 0 0" mass="2" inertia="0.3 0.4 0.5"/>
      <motion name="m" of="b" displacement="sin(t)^2 t^3 1-cos(2*t)" rotation="t^3 2*t^2 -2*t^3"/>
      <gravity acceleration="0 0 -10"/>
      <transient duration="2" step="0.001" rho_infinity="0.8"/>
      <record name="b" at="b" quantities="position rotation"/>
      <record name="m" joint="m" quantities="reaction_force reaction_moment"/>)xml");
  const auto turn = [](double t) { return Vec3(t * t * t, 2 * t * t, -2 * t * t * t); };
  EXPECT_GT(turn(2).norm(), 2.5 * 2 * pi);
  const auto w = [&](double t) {  // body axes, of R(t) = exp(turn(t)), by differences
    const Mat3 R = rotation_matrix(turn(t));
    const auto columns = [&](double h_) {
      return Eigen::Matrix<double, 9, 1>(Eigen::Map<const Eigen::Matrix<double, 9, 1>>(
          Mat3(rotation_matrix(turn(t + h_))).data()));
    };
    const Eigen::Matrix<double, 9, 1> d = first_difference(columns, 1e-3);
    return Vec3(axial<double>(Mat3(R.transpose() * Eigen::Map<const Eigen::Matrix3d>(d.data()))));
  };
  const Vec3 J(0.3, 0.4, 0.5);
  Worst position("position", 1e-11), force("force", 2e-3), moment("moment", 1e-2);
  for (std::size_t k = 0; k < h.table["time"].size(); k += 50) {
    const double t = h.table["time"][k];
    const Mat3 R = rotation_matrix(turn(t));
    position.add(
        (vector(h.table, "b.position", k) - Vec3(1 + sin(t) * sin(t), t * t * t, 1 - cos(2 * t)))
            .norm());
    position.add((rotation_matrix(vector(h.table, "b.rotation", k)) - R).cwiseAbs().maxCoeff());
    if (k < 100) continue;
    const Vec3 a(2 * cos(2 * t), 6 * t, 4 * cos(2 * t));
    const Vec3 F = 2 * (a + Vec3(0, 0, 10));
    force.add((R * vector(h.table, "m.reaction_force", k) - F).norm() / F.norm());
    const Vec3 w0 = w(t), dw = first_difference([&](double h_) { return w(t + h_); }, 1e-2);
    const Vec3 M = Vec3(J.cwiseProduct(dw)) + w0.cross(Vec3(J.cwiseProduct(w0)));
    moment.add((vector(h.table, "m.reaction_moment", k) - M).norm() / (1 + M.norm()));
  }
}

// Turned about an axis at a rate, the position free to fall. Shows a motion that holds what is not given.
TEST(Mechanisms, PrescribedRotationAlone) {
  const History h = run_text(R"xml(
      <body name="b" mass="2" inertia="0.3 0.4 0.5"/>
      <motion name="m" of="b" axis="1 2 2" rate="10*sin(t)"/>
      <gravity acceleration="0 0 -10"/>
      <transient duration="2" step="0.001" rho_infinity="0.8"/>
      <record name="b" at="b" quantities="position rotation"/>)xml");
  Worst position("position", 1e-3), turned("turned", 1e-10);
  for (std::size_t k = 0; k < h.table["time"].size(); ++k) {
    const double t = h.table["time"][k];
    position.add((vector(h.table, "b.position", k) + Vec3(0, 0, 5 * t * t)).norm());
    turned.add((rotation_matrix(vector(h.table, "b.rotation", k)) -
                rotation_matrix(10 * (1 - cos(t)) * Vec3(1, 2, 2) / 3))
                   .cwiseAbs()
                   .maxCoeff());
  }
}

// Energy and the work of drives at accepted states.
class WorkMeter : public Observer {
 public:
  void accepted(const Sample& s) override {
    const double power = s.model.system->power(s.state).drives,
                 energy = s.model.system->energies(s.state).total();
    if (count_++ > 0) work_ += 0.5 * (power + power_) * (s.state.t - t_);
    if (count_ == 1) first_ = energy;
    t_ = s.state.t;
    power_ = power;
    largest = std::max(largest, std::abs(energy - first_));
    worst = std::max(worst, std::abs(energy - first_ - work_));
  }
  double worst = 0.0, largest = 0.0;

 private:
  int count_ = 0;
  double t_ = 0.0, power_ = 0.0, work_ = 0.0, first_ = 0.0;
};

// What drives and motions deliver is what the energy rises by: a slide driven along its axis, a pendulum
// driven about its own, another led about by its pivot. Shows the sign and 1 % of the power.
TEST(Mechanisms, EnergyIsTheWorkOfDrives) {
  WorkMeter meter;
  const RunReport report = run(read_model_text(
                                   R"xml(<mbd name="test">
      <body name="slide" mass="2" inertia="1 1 1"/>
      <cylindrical name="C" between="ground slide" axis="0.6 0 0.8"/>
      <drive joint="C" displacement="0.3*sin(2*t)^2"/>
      <drive joint="C" rate="3*sin(t)"/>
      <body name="arm" at="0 0 0" center="0.5 0 0" mass="3" inertia="0.1 0.2 0.3"/>
      <revolute name="R" between="slide arm" at="0 0 0" axis="0 1 0"/>
      <body name="led" at="5 0 0" mass="1" inertia="0.1 0.2 0.3"/>
      <body name="bob" at="5 0 -1" mass="1" inertia="0.1 0.2 0.3"/>
      <spherical name="S" between="led bob" at="5 0 0"/>
      <motion name="m" of="led" velocity="sin(2*t) 0 t^2" rotation="t^2 t^3 0"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="3" step="5e-4" rho_infinity="0.9"/>
      </mbd>)xml"),
                               {.output = {}, .observers = {&meter}, .progress = {}});
  EXPECT_TRUE(report.complete()) << report.failure;
  EXPECT_LT(meter.worst, 1e-4 * meter.largest);
  RecordProperty("worst", testing::PrintToString(meter.worst / meter.largest));
}

// The windows' pendulum (models/windows.xml), integrated here to 1e-10 by steps of 1e-4 and half of it.
// Angle after T of the pendulum that N windows are, by Runge and Kutta's method of order 4.
double windows_angle(double N, double T, int steps) {
  const double I = (N + 1) / 3 + N, V = (N + 1) / 2 + N, h = T / steps;
  const auto acceleration = [&](double q) { return -V / I * 9.81 * cos(q); };
  double q = pi / 2, w = -1;
  for (int k = 0; k < steps; ++k) {
    const double a = acceleration(q), b = acceleration(q + h / 2 * w),
                 c = acceleration(q + h / 2 * (w + h / 2 * a)),
                 d = acceleration(q + h * (w + h / 2 * b));
    q += h * w + h * h / 6 * (a + b + c);
    w += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return q;
}
// All links come into line every half turn; how near to it a step ends depends on N, on the step and, to the
// last bits, on round-off (Stepping.EndsStepsInASingularConfiguration ends one there).
void check_windows(const std::string& N, const std::string& step, double duration) {
  const double q = windows_angle(std::stod(N), duration, 100000);
  EXPECT_NEAR(q, windows_angle(std::stod(N), duration, 200000), 1e-9);
  Scene scene = model_scene("windows", {{"N", N}, {"step", step}});
  scene.transient->duration = duration;
  const History h = run_to_table(scene);
  EXPECT_TRUE(h.report.complete()) << h.report.failure;
  EXPECT_EQ(h.report.transient_counters.retries, 0);
  EXPECT_LT(h.report.position.value, 1e-9);
  EXPECT_NEAR(h.table["A.angle"].back(), q - pi / 2, 200 * std::pow(std::stod(step), 2));
  EXPECT_NEAR(h.table["last.position.2"].back(), h.table["P.position.2"].back(), 1e-8);
}
TEST(Mechanisms, WindowsAreOnePendulum) {
  check_windows("1", "5e-4", 2);
  EXPECT_NEAR(windows_angle(2, 10, 200000), -30.17980086019, 1e-9) << "of the model's expectations";
}
TEST(MechanismsSlow, WindowsAreOnePendulumPastEverySingularity) {
  for (const char* const N : {"1", "2", "3", "5", "8"})
    for (const char* const step : {"1e-3", "5e-4"}) check_windows(N, step, 10);
}

// The slider of models/slider_crank.xml goes where a rigid mechanism has it, at first order in
// 1/stiffness. At the full speed of 150 rad/s: the bars are stiff enough that no ringing hides it.
TEST(Mechanisms, SliderCrankBecomesRigid) {
  std::vector<double> compliance, error;
  for (const char* const stiffness : {"100", "1000", "10000"}) {
    Scene scene = model_scene("slider_crank", {{"stiffness", stiffness}, {"duration", "0.1"}});
    const Table t = run_to_table(scene).table;
    double worst = 0;
    for (std::size_t k = 0; k < t["time"].size(); ++k) {
      const double phi = t["drive.angle"][k];
      const double rigid = .15 * cos(phi) + sqrt(.09 - std::pow(.15 * sin(phi), 2)) - .45;
      worst = std::max(worst, std::abs(t["slider.displacement"][k] - rigid));
    }
    compliance.push_back(1 / std::stod(stiffness));
    error.push_back(worst);
  }
  EXPECT_LT(error.back(), 2e-6);
  for (const double order : orders(compliance, error)) EXPECT_NEAR(order, 1, 0.1);
}

// ---- reactions of every type ------------------------------------------------------------------

// A body with its mass centre off its reference point, held by a joint to the ground at (0.3, -0.2, 0.4)
// with axes i3 and i1, under gravity, a force and a moment. The joint axes in the reference configuration
// are e3 = i3, and e1 = i1 where it is given, otherwise i1 x i3 (NOTATION.md); inertial for types without.
struct Held {
  const Vec3 gravity{1, -2, -9}, force{3, 2, 1}, moment{0.3, -0.4, 0.6}, center{0.1, 0.2, -0.3},
      at{0.3, -0.2, 0.4};
  const double mass = 2;
  Mat3 axes = Mat3::Identity();

  std::string text(const schema::JointKind& kind) {
    std::string joint = "<" + std::string(kind.name) + " name=\"J\" between=\"ground b\"";
    if (kind.traits.points == joint::Points::two)
      joint += " at_a=\"0.3 0.5 1.4\" at_b=\"0.3 -0.2 0.4\"";
    else
      joint += " at=\"0.3 -0.2 0.4\"";
    if (kind.traits.axis) joint += " axis=\"0 0 1\"";
    if (kind.traits.second_axis) joint += " second_axis=\"1 0 0\"";
    if (*kind.traits.parameter.name)
      joint += " " + std::string(kind.traits.parameter.name) + "=\"0.7\"";
    if (kind.traits.axis && !kind.traits.second_axis) axes << 0, 1, 0, -1, 0, 0, 0, 0, 1;
    return joint + R"xml(/>
      <body name="b" mass="2" center="0.1 0.2 -0.3" inertia="0.4 0.5 0.6 0.05 -0.02 0.03"/>
      <gravity acceleration="1 -2 -9"/>
      <load at="b" force="3 2 1" moment="0.3 -0.4 0.6"/>
      <record name="J" joint="J" quantities="reaction_force reaction_moment"/>)xml";
  }
};

class LastState : public Observer {
 public:
  void accepted(const Sample& sample) override {
    state = sample.state;
    row.assign(sample.row.begin(), sample.row.end());
  }
  Vec3 at(std::size_t i) const { return {row[i], row[i + 1], row[i + 2]}; }
  State state;
  std::vector<double> row;
};

// Newton's and Euler's equations of the body in motion, with its accelerations and the recorded reaction.
// Shows 10 % in mass, centre or inertia, a reaction of another sign, at another point or in other axes.
TEST(Reactions, BalanceTheMotion) {
  for (const schema::JointKind& kind : schema::joint_kinds()) {
    Held held;
    LastState last;
    const RunReport report = run(
        read_model_text("<mbd name=\"test\">" + held.text(kind) +
                        "<transient duration=\"0.3\" step=\"0.005\" rho_infinity=\"0.8\"/></mbd>"),
        {.output = {}, .observers = {&last}, .progress = {}});
    EXPECT_TRUE(report.complete()) << kind.name << report.failure;
    const State& s = last.state;
    const Mat3 R = s.pose[1].R();
    const Vec3 w = angular(s.V[1]), dw = angular(s.Vdot[1]), v = linear(s.V[1]);
    Mat3 J;
    J << 0.4, 0.05, -0.02, 0.05, 0.5, 0.03, -0.02, 0.03, 0.6;
    const Vec3 c = held.center,
               p = held.at;  // from the reference point, which starts at the origin
    const Vec3 a = linear(s.Vdot[1]) + w.cross(v) + dw.cross(c) + w.cross(w.cross(c));
    const Vec3 F = held.axes * last.at(1), M = held.axes * last.at(4);  // body axes
    const Vec3 f = R.transpose() * held.force, m = R.transpose() * held.moment;
    const Vec3 forces = F + f + held.mass * (R.transpose() * held.gravity) - held.mass * a;
    const Vec3 moments = M + (p - c).cross(F) + m - c.cross(f) - J * dw - w.cross(Vec3(J * w));
    EXPECT_LT(forces.norm(), 1e-6) << kind.name;
    EXPECT_LT(moments.norm(), 1e-6) << kind.name;
    EXPECT_GT(last.at(1).norm(), 0.5) << kind.name << " holds nothing";
    if (kind.name != "fixed" && kind.name != "rigid_link") {
      EXPECT_GT(v.norm() + w.norm(), 0.1) << kind.name << " does not move";
    }
  }
}

// At rest, what the joint leaves free held by a flexible beam from the body to a clamp: both reactions
// balance the weight and the loads. The same errors show.
TEST(Reactions, BalanceTheLoads) {
  for (const schema::JointKind& kind : schema::joint_kinds()) {
    Held held;
    LastState last;
    const RunReport report = run(read_model_text("<mbd name=\"test\">" + held.text(kind) + R"xml(
      <section name="s"><stiffness EA="1e4" GA2="1e4" GA3="1e4" GJ="40" EI2="40" EI3="40"/></section>
      <beam name="arm" section="s" from="0 0 0" to="0.5 -1 -0.5" normal="0 0 1" elements="2" order="3"/>
      <fixed name="weld" between="b arm.start" at="0 0 0"/>
      <fixed name="clamp" between="ground arm.end"/>
      <record name="K" joint="clamp" quantities="reaction_force reaction_moment"/>
      <static steps="4"/></mbd>)xml"),
                                 {.output = {}, .observers = {&last}, .progress = {}});
    EXPECT_TRUE(report.complete()) << kind.name << report.failure;
    const Pose<double>& H = last.state.pose[1];
    const Mat3 R = H.R();
    const Vec3 F = R * Vec3(held.axes * last.at(1)), M = R * Vec3(held.axes * last.at(4));
    const Vec3 K = last.at(7), L = last.at(10);  // at the clamp, whose axes are inertial
    const Vec3 weight = held.mass * held.gravity;
    const Vec3 x = H.r + R * held.at, c = H.r + R * held.center, k(0.5, -1, -0.5);
    EXPECT_LT((F + K + weight + held.force).norm(), 1e-8) << kind.name;
    EXPECT_LT(
        (M + x.cross(F) + L + k.cross(K) + held.moment + c.cross(weight) + H.r.cross(held.force))
            .norm(),
        1e-8)
        << kind.name;
    if (kind.name != "fixed" && kind.name != "rigid_link") {
      EXPECT_GT(H.r.norm(), 1e-5) << kind.name << " does not move";
      EXPECT_GT(K.norm() + L.norm(), 1.0) << kind.name << " carries all";
    }
  }
}

// ---- messages ---------------------------------------------------------------------------------

void expect_says(const std::string& inside, const std::string& words) {
  const std::string m = message(R"xml(<body name="b" mass="1" inertia="1 1 1"/>
    <transient duration="1" step="0.1"/>)xml" +
                                inside);
  EXPECT_NE(m.find(words), std::string::npos) << m;
}

TEST(JointMessages, SayWhatIsWrong) {
  expect_says(R"(<universal name="U" between="ground b" axis="0 0 1" second_axis="1 0 1"/>)",
              "model.xml:2: universal \"U\": second_axis must be perpendicular to axis; they are "
              "at 45 degrees");
  expect_says(R"(<universal name="U" between="ground b" axis="0 0 1"/>)",
              "\"second_axis\" is missing");
  expect_says(R"(<screw name="S" between="ground b" axis="0 0 1"/>)", "\"pitch\" is missing");
  expect_says(R"(<screw name="S" between="ground b" axis="0 0 1" pitch="0"/>)",
              "the pitch is zero");
  expect_says(R"(<distance name="D" between="ground b"/>)",
              "the ground has no point of its own; give at_a");
  expect_says(R"(<distance name="D" between="ground b" at_a="0 0 0"/>)",
              "its two points are the same");
  expect_says(R"(<revolute name="R" between="ground b" axis="0 0 1"/><drive joint="R" speed="0"/>)",
              "drive: revolute \"R\" has no displacement to drive; joints that "
              "have one: prismatic");
  expect_says(R"(<prismatic name="P" between="ground b" axis="0 0 1"/><drive joint="P" rate="0"/>)",
              "drive: prismatic \"P\" has no angle to drive; joints that have "
              "one: revolute");
  expect_says(R"(<screw name="S" between="ground b" axis="0 0 1" pitch="1"/>
                 <drive joint="S" rate="0"/><drive joint="S" speed="0"/>)",
              "is driven twice");
  expect_says(R"(<prismatic name="P" between="ground b" axis="0 0 1"/>
                 <drive joint="P" displacement="1"/>)",
              "the displacement is 1 at t = 0, but must start at 0");
  expect_says(R"(<revolute name="P" between="ground x" axis="0 0 1"/>)",
              "The beams and bodies are: b");
  expect_says(R"(<prismatic name="P" between="ground b" axis="0 0 1"/>
                 <drive joint="P" displacement="t > 0.5 ? 1 : 0"/>)",
              "the displacement jumps by 1");
  expect_says(R"(<motion name="m" of="b"/>)", "prescribes nothing");
  expect_says(R"(<motion name="m" of="ground" displacement="t t t"/>)", "the ground does not move");
  expect_says(R"(<motion name="m" of="b" angle="t"/>)", "needs an axis");
  expect_says(R"(<motion name="m" of="b" axis="0 0 1"/>)", "an axis needs an angle or a rate");
  expect_says(R"(<motion name="m" of="b" displacement="0 0 0" velocity="0 0 0"/>)", "not both");
  expect_says(R"(<prismatic name="P" between="ground b" axis="0 0 1"/>
                 <record name="r" joint="P" quantities="angle"/>)",
              "record \"r\": prismatic \"P\" has no angle");
  expect_says(R"(<motion name="m" of="b" rotation="0 0 0"/>
                 <record name="r" joint="m" quantities="angle"/>)",
              "record \"r\": motion \"m\" has no angle");
}

}  // namespace
}  // namespace mbd::test::test_mechanisms
