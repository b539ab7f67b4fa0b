// What laws of time do is not passed over, however short it is: by the motion that follows, in closed form.

#include "solvers/laws/law_steps.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string_view>

#include "tests/support/certificates.hpp"
#include "tests/support/landings.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_law_steps {
namespace {

constexpr double at = 44.375, width = 5e-3;  // [s]
constexpr double mass = 10.0, omega = 0.8;   // [kg], [rad/s]

// A mass on a spring at rest until a pulse moves it, by the integral of a Gaussian,
//   x'' + omega^2 x = a exp(-((t - at)/width)^2):  x = a width sqrt(pi)/omega exp(-(omega width/2)^2) sin(omega(t - at)).
double after_pulse(double t, double a) {
  return a * width * std::sqrt(std::numbers::pi) / omega *
         std::exp(-std::pow(omega * width / 2, 2)) * std::sin(omega * (t - at));
}

struct Case {
  const char* name;
  std::string items;  // with {} for the pulse, of 1
  std::string column;
  double a;  // of the closed form
};

const std::string oscillator = fmt::format(
    R"(<body name="b" at="0 0 0" mass="{}" inertia="{} 9 9"/>
       <record name="b" at="b" quantities="displacement rotation"/>
       <transient duration="100" step="1e-3" output="0.5"/>)",
    mass, mass);
const std::string slides = R"(<prismatic name="p" between="ground b" at="0 0 0" axis="1 0 0"/>)";
const std::string turns = R"(<revolute name="p" between="ground b" at="0 0 0" axis="1 0 0"/>)";
const std::string spring = fmt::format(
    R"(<spring name="s" between="ground b" at_a="-9 0 0" at_b="0 0 0" stiffness="{}"/>)",
    mass* omega* omega);
const std::string turning_spring =
    fmt::format(R"(<joint_spring name="s" joint="p" angular_stiffness="{}"/>)", mass* omega* omega);
// The spring's other end moves in place of the ground's.
const std::string led = fmt::format(
    R"(<body name="lead" at="-9 0 0" mass="1" inertia="1 1 1"/>
       <prismatic name="q" between="ground lead" at="-9 0 0" axis="1 0 0"/>
       <spring name="s" between="lead b" at_a="-9 0 0" at_b="0 0 0" stiffness="{}"/>)",
    mass* omega* omega);

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"force", oscillator + slides + spring + R"(<load at="b" force="2000*{} 0 0"/>)",
       "b.displacement.1", 200.0},
      {"follower", oscillator + slides + spring + R"(<load at="b" follower_force="300*{} 0 0"/>)",
       "b.displacement.1", 30.0},
      {"moment", oscillator + turns + turning_spring + R"(<load at="b" moment="50*{} 0 0"/>)",
       "b.rotation.1", 5.0},
      {"torque",
       oscillator + turns + turning_spring + R"(<joint_torque name="m" joint="p" moment="70*{}"/>)",
       "b.rotation.1", 7.0},
      {"base", oscillator + slides + spring + R"(<base_motion acceleration="-40*{} 0 0"/>)",
       "b.displacement.1", 40.0},
      {"drive", oscillator + slides + led + R"(<drive joint="q" displacement="0.1*{}"/>)",
       "b.displacement.1", 0.1 * omega * omega},
      {"motion",
       oscillator + slides + led + R"(<motion name="m" of="lead" displacement="0.2*{} 0 0"/>)",
       "b.displacement.1", 0.2 * omega * omega},
  };
  return all;
}

std::string with_pulse(const std::string& items) {
  std::string text = items;
  const std::string pulse = fmt::format("exp(-((t-{})/{})^2)", at, width);
  text.replace(text.find("{}"), 2, pulse);
  return text;
}

// The largest error after the pulse, over the largest value.
double error_of(const History& history, const Case& c, double rate_at = at + 0.1) {
  double error = 0.0, size = 0.0;
  const auto &t = history.table["time"], &x = history.table[c.column];
  for (std::size_t k = 0; k < t.size(); ++k) {
    const double exact = t[k] > rate_at ? after_pulse(t[k], c.a) : 0.0;
    if (t[k] > at - 0.1 && t[k] <= rate_at) continue;
    error = std::max(error, std::abs(x[k] - exact));
    size = std::max(size, std::abs(exact));
  }
  return error / size;
}

// Mutation: laws_ not set in OneStep::start, or in Ida::start: error 1.
TEST(LawSteps, PulsesOfEveryLawMoveWhatTheyShould) {
  for (const Case& c : cases())
    for (const auto& [method, tolerance, bound] :
         {std::tuple{TimeMethod::radau, 1e-3, 0.05}, std::tuple{TimeMethod::radau, 1e-6, 1e-4},
          std::tuple{TimeMethod::ida, 1e-5, 0.1},
          std::tuple{TimeMethod::generalized_alpha, 1e-4, 0.05}}) {
      // What is driven so fast is what errors are measured by: what follows it is a 1e-4 of that.
      const bool is_led =
          std::string_view(c.name) == "drive" || std::string_view(c.name) == "motion";
      if (is_led && (tolerance > 1e-5 || method == TimeMethod::generalized_alpha)) continue;
      Scene scene = scene_of(with_pulse(c.items));
      change_stepping(*scene.transient, {.method = method, .tolerance = tolerance});
      const History history = run_to_table(scene);
      ASSERT_EQ(history.report.failure, "") << c.name;
      EXPECT_LT(error_of(history, c), bound)
          << c.name << " " << name_of(method) << " " << tolerance;
      EXPECT_LT(history.report.transient_counters.steps, 20'000) << c.name << name_of(method);
      EXPECT_GT(history.report.laws.laws, 0);
      EXPECT_LT(history.report.laws.longest_step, 4.0 * width);
      EXPECT_NEAR(history.report.laws.at, at, 4.0 * width);
      EXPECT_EQ(history.report.laws.unresolved.size(), 0u);
    }
}

// Fixed steps cannot be made shorter: what they pass over is said, in the report and in the certificate.
TEST(LawSteps, FixedStepsSayWhatTheyPassOver) {
  Scene scene = scene_of(with_pulse(cases().front().items));
  for (const TimeMethod method : {TimeMethod::radau, TimeMethod::generalized_alpha}) {
    for (const double step : {0.1, 2e-3}) {
      change_stepping(*scene.transient, {.method = method, .step = step});
      const RunReport report = run(scene);
      const bool passes_over = step > width;
      const auto note = std::find_if(report.notes.begin(), report.notes.end(), [](const auto& n) {
        return n.find("faster than steps of 0.1 s resolve") != std::string::npos;
      });
      EXPECT_EQ(note != report.notes.end(), passes_over) << step;
      if (passes_over) {
        EXPECT_NE(note->find("force 1"), std::string::npos) << *note;
        EXPECT_NE(note->find("near t = 44.3"), std::string::npos) << *note;
      }
      EXPECT_EQ(report.laws.reach > 1.0, passes_over);
      const auto& checks = report.certificate.checks;
      const auto check = std::find_if(checks.begin(), checks.end(),
                                      [](const Check& c) { return c.name == "laws of time"; });
      ASSERT_NE(check, checks.end());
      EXPECT_EQ(check->verdict, passes_over ? Verdict::warn : Verdict::pass) << step;
    }
  }
}

// A blow beside a damper that is written as a law of a sensor, or times what a sensor reads: it is found at sensors that are
// held. m v' = -c v + blow: x = (1 - e^(-c (T - t0)))/c + v0 (1 - e^(-c T))/c.
TEST(LawSteps, PulsesBesideSensors) {
  constexpr double T = 10.0, c = 0.1, v0 = 0.3, t0 = 3.3;
  const double want = (1.0 - std::exp(-c * (T - t0))) / c + v0 * (1.0 - std::exp(-c * T)) / c;
  for (const char* const w : {"2e-4", "0.01"})
    for (const char* const law : {"exp(-((t-3.3)/w)^2)/(w*sqrt(pi))-c*rail.speed",
                                  "3*rail.speed*exp(-((t-3.3)/w)^2)/(w*sqrt(pi))-c*rail.speed"}) {
      const Scene scene =
          scene_of(std::string(R"(<parameter name="c" value="0.1"/><parameter name="w" value=")") +
                   w + R"("/>
          <body name="cart" mass="1" inertia="1 1 1" velocity="0.3 0 0"/>
          <prismatic name="rail" between="ground cart" axis="1 0 0"/><load at="cart" force=")" +
                   law + R"( 0 0"/><transient duration="10" method="radau" tolerance="1e-6"/>
          <record name="cart" joint="rail" quantities="displacement"/>)");
      const History history = run_to_table(scene);
      ASSERT_EQ(history.report.failure, "");
      // By 3 v blow the speed grows by e^3.
      const double kick = law[0] == 'e' ? 1.0 : (std::exp(3.0) - 1.0) * v0 * std::exp(-c * t0);
      EXPECT_NEAR(history.table["cart.displacement"].back(),
                  want + (kick - 1.0) * (1.0 - std::exp(-c * (T - t0))) / c,
                  2e-4 + 3.0 * std::stod(w))  // the blow takes time
          << w << " " << law;
      EXPECT_LT(history.report.laws.longest_step, 3.0 * std::stod(w));
    }
}

// A blow times a difference: e = exp(-sqrt(pi)) is left of it. What nothing resolves is said, beside sensors too.
TEST(LawSteps, PulsesTimesDifferences) {
  const auto model = [](const std::string& law) {
    return scene_of(
        R"(<body name="a" mass="1" inertia="1 1 1" velocity="1 0 0"/><body name="c" mass="1" inertia="1 1 1"/>
           <prismatic name="ra" between="ground a" axis="1 0 0"/><prismatic name="rc" between="ground c" axis="1 0 0"/>
           <load at="c" force=")" +
        law + R"( 0 0"/><transient duration="2" method="radau" tolerance="1e-6"/>
           <record name="c" joint="rc" quantities="speed"/>)");
  };
  const History history = run_to_table(model("1000*exp(-((t-1.0371)/1e-3)^2)*(ra.speed-rc.speed)"));
  EXPECT_NEAR(history.table["c.speed"].back(), 1.0 - std::exp(-std::sqrt(std::numbers::pi)), 1e-4);
  const RunReport sharp = run(model("1e13*exp(-((t-1.0371)/1e-13)^2)*ra.speed"));
  ASSERT_EQ(sharp.laws.unresolved.size(), 1U);
  EXPECT_NE(sharp.laws.unresolved[0].find("near t = 1.037"), std::string::npos);
}

// A pole where a sensor need not come asks for nothing.
TEST(LawSteps, PolesOfHeldSensorsAreNone) {
  const RunReport report = run(scene_of(
      R"(<body name="cart" mass="1" inertia="1 1 1"/><prismatic name="rail" between="ground cart" axis="1 0 0"/>
         <load at="cart" force="1/(t+1+2*rail.displacement)+1/(t-5+5*(1+rail.displacement)^2+1) 0 0"/>
         <transient duration="2" method="radau" tolerance="1e-6"/>
         <record name="cart" joint="rail" quantities="displacement"/>)"));
  EXPECT_EQ(report.failure, "");
  EXPECT_TRUE(report.laws.unresolved.empty());
  EXPECT_LT(report.transient_counters.steps, 200);
}

// What is too fast to be resolved is said as well.
TEST(LawSteps, LawsThatAreNotResolvedAreSaid) {
  Scene scene = scene_of(oscillator + slides + spring + R"(<load at="b" force="sin(1e9*t) 0 0"/>)");
  change_stepping(*scene.transient, {.method = TimeMethod::radau, .step = 0.1});
  const RunReport report = run(scene);
  ASSERT_EQ(report.laws.unresolved.size(), 1u);
  EXPECT_NE(report.laws.unresolved.front().find("too often"), std::string::npos)
      << report.laws.unresolved.front();
  EXPECT_NE(report.certificate.verdict(), Verdict::pass);
}

// A force whose period is the step, or a part or a multiple of it: at the ends of steps it looks constant, and would push far
// away what it shakes by a few micrometres, x = F/(m w^2) (1 - cos wt). No certificate passes what is a tenth of that off, and
// steps that an error chooses see the force. Steps of a hundredth are right: nothing turns here, and rates of angles, which are
// of round-off, are not taken for ringing. Mutations: an error in time taken for a tenth of it; an angular velocity of
// round-off as what rates of angles are measured by.
TEST(LawSteps, NoStepIsAnAliasOfALaw) {
  constexpr double period = 0.01, force = 10.0, w = 2.0 * std::numbers::pi / period;
  Scene scene =
      scene_of(oscillator + slides +
               fmt::format(R"(<load at="b" force="{}*cos(2*pi*t/{}) 0 0"/>)", force, period));
  scene.transient->duration = 1.2;
  scene.transient->output.reset();
  const auto error = [&](const History& history) {
    double most = 0.0;
    const auto &t = history.table["time"], &x = history.table["b.displacement.1"];
    for (std::size_t k = 0; k < t.size(); ++k)
      most = std::max(most, std::abs(x[k] - force / (mass * w * w) * (1.0 - std::cos(w * t[k]))));
    return most / (2.0 * force / (mass * w * w));
  };
  int off = 0;
  for (const TimeMethod method : {TimeMethod::generalized_alpha, TimeMethod::radau})
    for (const double share : {3.0, 2.0, 1.5, 1.0, 2.0 / 3.0, 0.5, 1.0 / 3.0, 0.25, 0.01}) {
      change_stepping(*scene.transient, {.method = method, .step = share * period});
      TableMaker maker(1);
      History history;
      history.report = run(scene, {.observers = {&maker}});  // with its estimate of errors
      history.table = std::move(maker.table);
      SCOPED_TRACE(fmt::format("{} {}: {}", name_of(method), share, error(history)));
      const Check* const estimate = find(history.report.certificate, "error in time");
      const Check* const laws = find(history.report.certificate, "laws of time");
      ASSERT_TRUE(estimate != nullptr && laws != nullptr);
      if (share >= 0.6) {
        EXPECT_NE(laws->verdict, Verdict::pass);
      }
      if (share < 0.1) {
        EXPECT_LT(error(history), 0.01);
      }
      if (!(error(history) > 0.1)) continue;
      EXPECT_EQ(estimate->verdict, Verdict::fail);
      ++off;
    }
  EXPECT_GE(off, 8);
  for (const TimeMethod method :
       {TimeMethod::generalized_alpha, TimeMethod::radau, TimeMethod::ida}) {
    change_stepping(*scene.transient, {.method = method, .tolerance = 1e-8});
    EXPECT_LT(error(run_to_table(scene)), 0.05) << name_of(method);
  }
}

// Laws that are smooth in the steps that an error asks for do not change them; those of time that are constant cost
// nothing.
TEST(LawSteps, LimitNothingWhereLawsAreSlow) {
  const auto limit = [](const std::string& force) {
    const Scene scene =
        scene_of(oscillator + slides + R"(<load at="b" force=")" + force + R"( 0 0"/>)");
    const Model model = compile(scene);
    return LawSteps(*model.system, 0.0, 100.0);
  };
  EXPECT_EQ(limit("7").facts().laws, 0);
  EXPECT_EQ(limit("3*t-1").facts().longest_step, 0.0);
  EXPECT_TRUE(std::isinf(limit("3*t-1").end_of_step(3.0)));
  // Half a period of a sine and more; less than one.
  const LawSteps sine = limit("sin(2*pi*t)");
  for (double t = 0.0; t < 98.0; t += 0.37) {
    EXPECT_GT(sine.end_of_step(t) - t, 0.2);
    EXPECT_LT(sine.end_of_step(t) - t, 1.0);
  }
  // Never over all of a bump, wherever a step begins.
  const LawSteps bump = limit(fmt::format("exp(-((t-{})/{})^2)", at, width));
  for (double t = 0.0; t < at - 2.0 * width; t += 0.0137)
    EXPECT_LT(bump.end_of_step(t), at + 2.0 * width) << t;
}

}  // namespace
}  // namespace mbd::test::test_law_steps
