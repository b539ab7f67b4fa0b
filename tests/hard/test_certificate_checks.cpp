// Each check of a certificate on its own: one deliberate fault just below its bound, just above, far above, and not a
// number; the bounds are written out here. Momenta against impulses for each kind of term that acts from outside, right
// and 10 % wrong. Errors in time against closed forms.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/results/certificate.hpp"
#include "libmbd/results/summary.hpp"
#include "libmbd/results/time_error.hpp"
#include "libmbd/run/run.hpp"
#include "solvers/time/stepper.hpp"
#include "tests/support/certificates.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"

namespace mbd::test::test_certificate_checks {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double pi = std::numbers::pi;

Scene scene_of(const std::string& inside, const Overrides& overrides = {}) {
  return read_model_text("<mbd name=\"m\">" + inside + "</mbd>", "m.xml", overrides);
}

// `certificate(value)` has the fault of that size. Bounds are those of the test, not of the check.
void sees(std::string_view name, double warn, double fail,
          const std::function<Certificate(double)>& certificate, double digits = 1e-9) {
  SCOPED_TRACE(name);
  const auto verdict = [&](double value) {
    const Certificate all = certificate(value);
    const Check* const check = find(all, name);
    EXPECT_NE(check, nullptr) << words(all);
    if (check == nullptr) return Verdict::pass;
    if (value == value) {
      EXPECT_NEAR(check->value, value, (digits + 1e-3) * value) << words(all);
    }
    return check->verdict;
  };
  EXPECT_EQ(verdict(0.97 * warn), Verdict::pass);
  EXPECT_EQ(verdict(1.03 * warn), Verdict::warn);
  if (fail < 1e300) {
    EXPECT_EQ(verdict(0.97 * fail), Verdict::warn);
    EXPECT_EQ(verdict(1.03 * fail), Verdict::fail);
    EXPECT_EQ(verdict(50.0 * fail), Verdict::fail);
  }
  EXPECT_EQ(verdict(nan), Verdict::fail);
}

// A body of 2 kg on a rail along i1; the scene is 4 m long, as the other one says.
struct Rail {
  Scene scene = scene_of(R"(
      <body name="car" at="0 0 0" mass="2" inertia="1 1 1" velocity="3 0 0"/>
      <prismatic name="rail" between="ground car" axis="1 0 0"/>
      <body name="far" at="4 0 0" mass="1" inertia="1 1 1"/>
      <fixed name="weld" between="ground far"/>
      <transient duration="1" step="0.1"/>)");
  Model model = compile(scene);
  State state = model.initial;

  double L() const { return model.system->length_scale(); }
  // Of the two samples, the second after `change`.
  Certificate after(const std::function<void(State&)>& change, bool certify = false,
                    const std::function<void(Audit&, RunReport&)>& more = {}) const {
    Audit audit(scene, *model.system, certify);
    State now = state;
    audit.sample(now);
    now.t = 0.5;
    if (change) change(now);
    audit.sample(now);
    RunReport report;
    if (more) more(audit, report);
    return audit.certificate(report);
  }
  // With steps that went well, but for `change`.
  Certificate after_steps(int steps, const std::function<void(int, StepReport&)>& change,
                          const std::function<void(RunReport&)>& of_report = {}) const {
    return after({}, false, [&](Audit& audit, RunReport& report) {
      for (int n = 0; n < steps; ++n) {
        StepReport step;
        step.converged = true;
        step.iterations = 2;
        if (change) change(n, step);
        State now = state;
        now.t = 0.1 * (n + 1);
        audit.step(step, now);
      }
      if (of_report) of_report(report);
    });
  }
};

TEST(CertificateChecks, BoundedCheckKnowsNaN) {
  for (const double bad : {nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(bounded_check({.value = bad, .warn = 1.0, .fail = 2.0}).verdict, Verdict::fail);
  }
  EXPECT_EQ(bounded_check({.value = 1.0, .warn = 1.0, .fail = 2.0}).verdict, Verdict::pass);
  EXPECT_EQ(bounded_check({.value = 2.0, .warn = 1.0, .fail = 2.0}).verdict, Verdict::warn);
}

// 9 J at the start.
TEST(CertificateChecks, Energies) {
  const Rail rail;
  const auto with_energy = [](double E) {
    return [E](State& s) { s.V[1](0) = std::sqrt(E); };  // E = 1/2 2 v^2
  };
  // Taken out: up to a half.
  sees(
      "energy balance", 0.01, 0.5,
      [&](double share) {
        if (share > 1.0)  // more than there was: as work that was put in and is not there
          return rail.after([&](State& s) { s.work.loads = share / (1.0 - 1e-9) * 9.0 * 1e3; });
        return rail.after(with_energy(9.0 * (1.0 - share)));
      },
      1e3);
  // Put in: of the largest there is.
  for (const char* const name : {"energy balance", "spurious energy"})
    sees(
        name, 0.01, 0.1,
        [&](double share) {
          return rail.after(with_energy(share < 1.0    ? 9.0 / (1.0 - share)
                                        : share < 10.0 ? 1e12
                                                       : nan));
        },
        1e3);
}

TEST(CertificateChecks, Constraints) {
  const Rail rail;
  const double L = rail.L();
  ASSERT_NEAR(L, 4.0, 1e-12);
  sees("constraints, position", 1e-8, 1e-6,
       [&](double gap) { return rail.after([&](State& s) { s.pose[1].r(1) = gap * L; }); });
  // Rates over the fastest motion, here 3 m/s over L.
  sees(
      "constraints, velocity", 0.01, 0.1,
      [&](double rate) {
        return rail.after([&](State& s) {
          if (rate < 1.0)
            s.V[1] << 3.0 * std::sqrt(1.0 - rate * rate), 3.0 * rate, 0, 0, 0, 0;
          else
            s.V[1](1) = rate < 10.0 ? 1e9 : nan;
        });
      },
      1e3);
  // Second rates over the largest acceleration: 1 is what a joint on the ground can open by at most.
  sees(
      "constraints, acceleration", 0.1, 1e308,
      [&](double rate) {
        return rail.after(
            [&](State& s) {
              const double a = 100.0 * L;
              s.Vdot[1] << a * std::sqrt(1.0 - rate * rate), a * rate, 0, 0, 0, 0;
            },
            true);
      },
      1e3);
}

// Without pieces there are no impulses: every change is a loss. Of 2 kg at 3 m/s.
TEST(CertificateChecks, Momenta) {
  const Rail rail;
  sees(
      "linear momentum", 0.01, 0.05,
      [&](double share) {
        return rail.after([&](State& s) {
          s.V[1](0) = 3.0 * (1.0 - (share < 1.0 ? share : share < 3.0 ? 1.0 : nan));
        });
      },
      1e3);
  Rail spinning;
  spinning.state.V[1] << 0, 0, 0, 0, 5.0, 0;
  sees(
      "angular momentum", 0.01, 0.05,
      [&](double share) {
        return spinning.after([&](State& s) {
          s.V[1](4) = 5.0 * (1.0 - (share < 1.0 ? share : share < 3.0 ? 1.0 : nan));
        });
      },
      1e3);
}

TEST(CertificateChecks, Newton) {
  const Rail rail;
  sees("Newton, contraction", 0.95, 1e308, [&](double ratio) {
    return rail.after_steps(3, [&](int n, StepReport& s) { s.contraction = n == 1 ? ratio : 0.1; });
  });
  // Of 1000 steps, those with 15 of 20 iterations.
  for (const auto& [count, verdict] :
       {std::pair{0, Verdict::pass}, {10, Verdict::pass}, {11, Verdict::warn}}) {
    const Certificate c =
        rail.after_steps(1000, [&](int n, StepReport& s) { s.iterations = n < count ? 15 : 14; });
    ASSERT_NE(find(c, "Newton, long steps"), nullptr);
    EXPECT_EQ(find(c, "Newton, long steps")->verdict, verdict);
    EXPECT_NEAR(find(c, "Newton, long steps")->value, 1e-3 * count, 1e-12);
  }
  for (const auto& [count, verdict] : {std::pair{1, Verdict::pass},
                                       {2, Verdict::warn},
                                       {100, Verdict::warn},
                                       {1000, Verdict::warn}}) {
    const Certificate c =
        rail.after_steps(100, {}, [&](RunReport& r) { r.transient_counters.retries = count; });
    EXPECT_EQ(find(c, "failed steps")->verdict, verdict) << count;
  }
  EXPECT_EQ(find(rail.after_steps(100, {}), "rank-tolerant steps"), nullptr);
  const Certificate one =
      rail.after_steps(100, {}, [&](RunReport& r) { r.transient_counters.tolerant = 1; });
  EXPECT_EQ(find(one, "rank-tolerant steps")->verdict, Verdict::warn);
}

// 8 eps of the farthest position; over the step and the fastest motion; over its square, times the mass, over forces.
TEST(CertificateChecks, RoundOff) {
  const Rail rail;
  const double L = rail.L();
  sees("round-off, position", 1e-9, 1e-6, [&](double share) {
    return rail.after(
        [&](State& s) { s.pose[2].r(0) = share == share ? share / (8 * eps) * L : nan; });
  });
  const auto of_steps = [&](double h, double force, double moment, const char* name) {
    Rail r;
    r.state.lambda.setZero();
    const ConstraintInfo& info = r.model.system->constraints()[0];
    bool forced = false, turned = false;
    for (Index i = 0; i < info.rows; ++i) {
      bool& done = info.is_position[static_cast<std::size_t>(i)] ? forced : turned;
      if (!done)
        r.state.lambda(info.first_row + i) =
            info.is_position[static_cast<std::size_t>(i)] ? force : moment;
      done = true;
    }
    const Certificate c = r.after({}, true, [&](Audit& audit, RunReport&) {
      StepReport step;
      step.converged = true;
      State now = r.state;
      now.t = h;
      audit.step(step, now);
    });
    const Check* const check = find(c, name);
    EXPECT_NE(check, nullptr);
    return check != nullptr ? *check : Check{};
  };
  const double unit = 8 * eps * L;
  // The fastest motion is 3 m/s over L.
  for (const double value : {0.9e-6, 1.1e-6, 0.9e-2, 1.1e-2}) {
    const Check check = of_steps(unit / (L * value) / (3.0 / L), 1.0, 0.0, "round-off, velocity");
    EXPECT_NEAR(check.value, value, 1e-6 * value);
    EXPECT_EQ(check.verdict, value < 1e-6   ? Verdict::pass
                             : value < 1e-2 ? Verdict::warn
                                            : Verdict::fail);
  }
  // 2 kg is the largest mass (1 kg.m2 over L^2 is less). A moment counts by L: 8 N.m as 2 N.
  for (const double value : {0.9e-6, 1.1e-6}) {
    const double h = std::sqrt(2.0 * unit / (2.0 * value));
    const Check force = of_steps(h, 2.0, 0.0, "round-off, multipliers"),
                moment = of_steps(h, 0.0, 8.0, "round-off, multipliers");
    for (const Check& check : {force, moment}) {
      EXPECT_NEAR(check.value, value, 1e-6 * value);
      EXPECT_EQ(check.verdict, value < 1e-6 ? Verdict::pass : Verdict::warn);
    }
  }
}

// The same mechanism a thousand times as large has the same condition: lengths and multipliers in units of the scene.
TEST(CertificateChecks, ConditionHasNoUnits) {
  const auto condition = [](double size) {
    const double J = size * size;
    const Scene scene = scene_of(fmt::format(
        R"(<body name="arm" at="{0} 0 0" mass="1" inertia="{1} {1} {1}"/>
           <revolute name="hinge" between="ground arm" at="0 0 0" axis="0 0 1"/>
           <joint_spring name="s" joint="hinge" angular_stiffness="{1}"/>
           <transient duration="1" step="0.01"/>)",
        size, J));
    const RunReport report = run(scene, {.certify = true, .estimate_error = false});
    const Check* const check = find(report.certificate, "condition");
    EXPECT_NE(check, nullptr);
    return check != nullptr ? check->value : nan;
  };
  const double one = condition(1.0);
  EXPECT_GT(one, eps);
  EXPECT_LT(one, 1e-6);
  for (const double size : {1e-3, 1e3}) EXPECT_NEAR(condition(size), one, 1e-3 * one) << size;
}

TEST(CertificateChecks, Equilibria) {
  const Scene scene = scene_of(R"(
      <body name="car" at="0 0 0" mass="2" inertia="1 1 1"/>
      <prismatic name="rail" between="ground car" axis="1 0 0"/>
      <body name="far" at="4 0 0" mass="1" inertia="1 1 1"/>
      <fixed name="weld" between="ground far"/>
      <spring name="s" between="ground car" at_a="-1 0 0" stiffness="100"/>
      <load at="car" force="50 0 0"/> <static/>)");
  const Model model = compile(scene);
  const auto certificate = [&](const std::function<void(State&)>& change,
                               const std::function<void(RunReport&)>& of_report = {}) {
    Audit audit(scene, *model.system, false);
    State state = model.initial;
    state.pose[1].r(0) = 0.5;  // 50 N over 100 N/m
    state.lambda.setZero();
    change(state);
    audit.sample(state);
    RunReport report;
    if (of_report) of_report(report);
    return audit.certificate(report);
  };
  sees("balance of forces", 1e-8, 1e-6,
       [&](double share) { return certificate([&](State& s) { s.pose[1].r(0) += share * 0.5; }); });
  sees("constraints, position", 10 * 8 * eps > 1e-11 ? 80 * eps : 1e-11, 1e-9,
       [&](double gap) { return certificate([&](State& s) { s.pose[2].r(1) = gap * 5.0; }); });
  const Certificate unstable =
      certificate([](State&) {}, [](RunReport& r) { r.negative_eigenvalues = 1; });
  EXPECT_EQ(find(unstable, "stability")->verdict, Verdict::warn);
  EXPECT_EQ(certificate([](State&) {}, [](RunReport& r) { r.negative_eigenvalues = 0; }).verdict(),
            Verdict::pass);
}

TEST(CertificateChecks, ErrorInTime) {
  sees("error in time", 0.01, 0.1, [](double relative) {
    Certificate c;
    c.checks.push_back(check_of(TimeError{.known = true, .relative = relative}));
    return c;
  });
  const Check unknown = check_of(TimeError{.why_not = "nothing moves"});
  EXPECT_EQ(unknown.verdict, Verdict::warn);
  Certificate c;
  c.checks.push_back(unknown);
  const auto has = [](const std::vector<std::string>& all, std::string_view what) {
    return std::any_of(all.begin(), all.end(),
                       [&](const std::string& one) { return one.find(what) != std::string::npos; });
  };
  EXPECT_TRUE(has(c.not_covered(), "steps in time"));
  EXPECT_FALSE(has(c.covers(), "steps in time"));  // it said both, and "error in time 0"
  EXPECT_EQ(unknown.value_in_words(), "not known: nothing moves");
  for (const int kinks : {0, 5})
    EXPECT_EQ(check_of(TimeError{.known = true, .relative = 2e-3, .kinks = kinks}).verdict,
              kinks > 0 ? Verdict::warn : Verdict::pass);
  c.checks[0] = check_of(TimeError{.known = true, .relative = 1e-3});
  EXPECT_FALSE(has(c.not_covered(), "steps in time"));
  EXPECT_TRUE(has(c.covers(), "steps in time"));
  EXPECT_TRUE(has(c.not_covered(), "mesh"));
}

// ---- momenta, kind by kind -----------------------------------------------------------------------

struct Kind {
  const char* what;
  const char* check;  // which judges it
  // f is 1, or 1.1 where momentum or impulse are counted wrong. What laws of time give is in the state of the run: there
  // it is the momentum, by the mass.
  const char* inside;
  const char* counted = nullptr;  // in its place where it is counted wrong
};

const Kind kinds[] = {
    {"spring", "linear momentum",
     R"(<body name="b" at="1 0 0" mass="2" inertia="1 1 1" velocity="1 0.3 0"/>
        <spring name="s" between="ground b" at_a="0 0 0" stiffness="f*50"/>)"},
    {"nonlinear spring with damper", "linear momentum",
     R"(<body name="b" at="1 0 0" mass="2" inertia="1 1 1" velocity="1 0 0"/>
        <spring name="s" between="ground b" at_a="0 0 0" force="f*20*x+f*100*x^3" damping="f*0.5"/>)"},
    {"damper", "linear momentum",
     R"(<body name="b" at="1 0 0" mass="2" inertia="1 1 1" velocity="1 0 0"/>
        <spring name="s" between="b ground" at_b="0 0 0" damping="f*3"/>)"},
    {"bushing", "linear momentum",
     R"(<body name="b" mass="2" inertia="1 1 1" velocity="0 1 0.5"/>
        <bushing name="s" between="ground b" stiffness="f*80 f*50 f*60" angular_stiffness="9 9 9"/>)"},
    {"bushing that twists", "angular momentum",
     R"(<body name="b" mass="2" inertia="1 2 1.5" angular_velocity="0.5 1 0.3"/>
        <bushing name="s" between="b ground" stiffness="9 9 9" angular_stiffness="f*40 f*50 f*60"/>)"},
    {"bushing that damps", "linear momentum",
     R"(<body name="b" mass="2" inertia="1 1 1" velocity="0 1 0.5"/>
        <bushing name="s" between="ground b" damping="f*3 f*2 f*4"/>)"},
    {"joint spring", "angular momentum",
     R"(<body name="b" at="0.3 0 0" mass="2" inertia="1 1 1" angular_velocity="0 0 2" velocity="0 0.6 0"/>
        <revolute name="j" between="ground b" at="0 0 0" axis="0 0 1"/>
        <joint_spring name="s" joint="j" angular_stiffness="f*30"/>)"},
    {"joint spring along", "linear momentum",
     R"(<body name="b" mass="2" inertia="1 1 1" velocity="1 0 0"/>
        <prismatic name="j" between="b ground" axis="1 0 0"/>
        <joint_spring name="s" joint="j" stiffness="f*50"/>)"},
    {"joint damper", "angular momentum",
     R"(<body name="b" mass="2" inertia="1 1 1" angular_velocity="0 0 2"/>
        <revolute name="j" between="ground b" axis="0 0 1"/>
        <joint_spring name="s" joint="j" angular_damping="f*1.5"/>)"},
    {"joint torque", "angular momentum",
     R"(<body name="b" mass="2" inertia="f f f"/>
        <revolute name="j" between="ground b" axis="0 0 1"/>
        <joint_torque joint="j" moment="1+t"/>)"},
    {"joint force", "linear momentum",
     R"(<body name="b" mass="f*2" inertia="1 1 1"/>
        <prismatic name="j" between="ground b" axis="1 0 0"/>
        <joint_torque joint="j" force="1+t"/>)"},
    {"load", "linear momentum",
     R"(<body name="b" mass="f*2" inertia="1 1 1"/> <load at="b" force="t 2 0"/>)"},
    {"moment", "angular momentum",
     R"(<body name="b" mass="2" inertia="f f*2 f*3"/> <load at="b" moment="t 2 0"/>)"},
    {"follower load with an arm", "angular momentum",
     R"(<body name="b" mass="2" inertia="f f*2 f*3"/> <load at="b" follower_force="0 2 0" offset="0.5 0 0"/>)"},
    {"gravity", "linear momentum",
     R"(<body name="b" mass="2" inertia="1 1 1"/> <gravity acceleration="0 0 -9.81*f"/>)"},
    {"drag in a flow", "linear momentum",
     R"(<body name="b" mass="2" inertia="1 1 1" velocity="4 0 0"/>
        <drag at="b" density="f" area="1" coefficient="1" flow="0 -2 0"/>)"},
    {"motion of the base", "linear momentum",
     R"(<body name="b" mass="2" inertia="1 1 1"/> <base_motion acceleration="3*cos(2*t) 0 1"/>)",
     R"(<body name="b" mass="2" inertia="1 1 1"/> <load at="b" force="0 0 0*t"/>)"},
    {"added mass", "linear momentum",
     R"(<body name="b" mass="2" inertia="1 1 1"/> <load at="b" force="t 2 0"/>
        <added_mass at="b" matrix="f*8 f*8 f*8 0 0 0"/>)"},
    {"mass of what a joint holds", "linear momentum",
     R"(<body name="b" at="0.5 0 0" mass="f*2" inertia="f*0.2 f*0.2 f*0.2"/>
        <revolute name="j" between="ground b" at="0 0 0" axis="0 1 0"/> <gravity acceleration="0 0 -9.81*f"/>
        <spring name="s" between="ground b" at_a="0.5 0 2" stiffness="20"/>)"},
    {"prescribed motion", "linear momentum",
     R"(<body name="b" mass="f*2" inertia="1 1 1"/>
        <motion name="m" of="b" displacement="0.2-0.2*cos(3*t) 0 -0.1*cos(2*t)+0.1"/>)"},
    {"damping in proportion to mass", "linear momentum",
     R"(<section name="s"> <stiffness EA="1e3" GA2="1e3" GA3="1e3" GJ="10" EI2="10" EI3="10"/>
          <mass per_length="1" inertia="0.2 0.1 0.1"/> <damping mass_proportional="f*0.5"/> </section>
        <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
        <load at="b.end" force="t&lt;1?2:0 0 1"/>)"},
    {"distributed load on a clamped beam", "linear momentum",
     R"(<section name="s"> <stiffness EA="1e3" GA2="1e3" GA3="1e3" GJ="10" EI2="10" EI3="10"/>
          <mass per_length="1" inertia="0.2 0.1 0.1"/> </section>
        <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
        <bushing name="clamp" between="ground b.start" stiffness="50 50 f*50" angular_stiffness="20 f*20 20"/>
        <distributed beam="b" force="0 0 3"/>)"},
};

// A run of the scene with f = 1, whose impulses are those of the scene with `f`.
Certificate audited(const Kind& kind, const std::string& transient, const char* f) {
  const auto text = [&](const char* inside) {
    return std::string("<parameter name=\"f\" value=\"1\"/>") + inside + transient;
  };
  const bool wrong = std::string(f) != "1";
  const Scene scene = scene_of(text(kind.inside));
  const Model model = compile(scene),
              counted = compile(scene_of(
                  text(wrong && kind.counted != nullptr ? kind.counted : kind.inside), {{"f", f}}));
  Audit audit(scene, *counted.system, true);
  State state = model.initial;
  const auto stepper = make_stepper(*model.system, *scene.transient);
  stepper->on_substep([&](const DenseStep& step) { audit.piece(step); });
  EXPECT_TRUE(stepper->start(state).converged);
  audit.sample(state);
  while (state.t < 2.0 - 1e-9) {
    const StepReport step = stepper->step(state);
    EXPECT_TRUE(step.converged) << step.failure;
    if (!step.converged) break;
    audit.step(step, state);
    audit.sample(state);
  }
  RunReport report;
  return audit.certificate(report);
}

TEST(Momenta, OfEveryKindOfTermThatActsFromOutside) {
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.what);
    for (const char* const transient :
         {R"(<transient duration="2" step="2e-3" rho_infinity="0.9"/>)",
          R"(<transient duration="2" method="radau" step="0.02"/>)",
          R"(<transient duration="2" method="radau" tolerance="1e-6"/>)",
          R"(<transient duration="2" method="ida" tolerance="1e-7"/>)"}) {
      SCOPED_TRACE(transient);
      const Certificate right = audited(kind, transient, "1");
      for (const char* const name : {"linear momentum", "angular momentum"})
        if (const Check* const check = find(right, name)) {
          EXPECT_EQ(check->verdict, Verdict::pass) << words(right);
        }
      EXPECT_NE(find(right, kind.check), nullptr) << words(right);
    }
    const Certificate wrong =
        audited(kind, R"(<transient duration="2" step="2e-3" rho_infinity="0.9"/>)", "1.1");
    ASSERT_NE(find(wrong, kind.check), nullptr);
    EXPECT_EQ(find(wrong, kind.check)->verdict, Verdict::fail) << words(wrong);
  }
}

// A part that nothing ties to the ground keeps its momenta by default, also beside parts that are held; where the model asks
// for the balance of accelerations, the certificate sees what is lost: 10 of 50 N.s.
TEST(Momenta, InFreeFlight) {
  const auto thrown = [](const std::string& more, const std::string& balance) {
    Scene scene = model_scene("free_beam", {{"step", "0.1"}});
    scene.transient->balance.reset();
    scene.transient->newton_tolerance.reset();
    if (balance == "acceleration") scene.transient->balance = Balance::acceleration;
    if (balance == "momentum") scene.transient->balance = Balance::momentum;
    const Scene other = scene_of(more);
    scene.bodies = other.bodies;
    scene.joints = other.joints;
    return run(scene, {.estimate_error = false});
  };
  const auto lost = [](const RunReport& report) {
    return (report.momentum_end.head<3>() - Vec3(50, 0, 0)).norm();
  };
  const auto noted = [](const RunReport& report) {
    return std::any_of(report.notes.begin(), report.notes.end(), [](const std::string& note) {
      return note.find("balance=\"momentum\"") != std::string::npos;
    });
  };
  const RunReport free = thrown("", "");
  ASSERT_TRUE(free.complete()) << free.failure;
  EXPECT_LT(lost(free), 1e-4);
  EXPECT_EQ(find(free.certificate, "linear momentum")->verdict, Verdict::pass);
  EXPECT_EQ(find(free.certificate, "angular momentum")->verdict, Verdict::pass);
  EXPECT_FALSE(noted(free));

  const RunReport accelerations = thrown("", "acceleration");
  EXPECT_GT(lost(accelerations), 10.0);
  EXPECT_EQ(find(accelerations.certificate, "linear momentum")->verdict, Verdict::fail)
      << words(accelerations.certificate);
  EXPECT_FALSE(noted(accelerations));  // it was asked for

  // Beside a pendulum far heavier and faster it keeps them as well, and that hides nothing of what is lost without.
  const std::string pendulum =
      R"(<body name="bob" at="0 50 10" mass="1e4" inertia="1 1 1" velocity="20 0 0" angular_velocity="0 2 0"/>
         <spherical name="O" between="ground bob" at="0 50 0"/>)";
  const RunReport beside = thrown(pendulum, "");
  ASSERT_TRUE(beside.complete()) << beside.failure;
  EXPECT_FALSE(noted(beside));
  EXPECT_EQ(find(beside.certificate, "linear momentum")->verdict, Verdict::pass)
      << words(beside.certificate);
  const RunReport lossy = thrown(pendulum, "acceleration");
  ASSERT_TRUE(lossy.complete()) << lossy.failure;
  const Check* const check = find(lossy.certificate, "linear momentum");
  EXPECT_EQ(check->verdict, Verdict::fail) << words(lossy.certificate);
  EXPECT_NE(check->where.find("beam 'beam'"), std::string::npos) << check->where;
}

// ---- errors in time ------------------------------------------------------------------------------

// x'' = -w^2 x, w = 5/s, begins with 1 m/s: a run and its true error, the largest of all rows [m].
struct Oscillation {
  RunReport report;
  double error = 0.0;
};
Oscillation oscillation(const std::string& transient) {
  const double w = 5.0;
  const Scene scene = scene_of(R"(
        <body name="b" at="1 0 0" mass="2" inertia="1 1 1" velocity="1 0 0"/>
        <prismatic name="j" between="ground b" axis="1 0 0"/>
        <joint_spring name="s" joint="j" stiffness="50"/>
        <record name="x" joint="j" quantities="displacement"/>)" +
                               transient);
  TableMaker table(1);
  Oscillation result{run(scene, {.observers = {&table}})};
  for (std::size_t i = 0; i < table.table.rows(); ++i)
    result.error = std::max(result.error, std::abs(table.table["x.displacement"][i] -
                                                   std::sin(w * table.table["time"][i]) / w));
  return result;
}

// x'' = -w^2 x in closed form: the estimate is within a factor of 3 of the error that there is, in fixed steps of both
// methods; a coarse run fails.
TEST(ErrorInTime, OfAnOscillator) {
  const double T = 4.0;
  for (const auto& [transient, verdict] :
       {std::pair{R"(<transient duration="4" step="1e-3" rho_infinity="0.9"/>)", Verdict::pass},
        {R"(<transient duration="4" step="2e-2" rho_infinity="0.9"/>)", Verdict::warn},
        {R"(<transient duration="4" step="8e-2" rho_infinity="0.9"/>)", Verdict::fail},
        {R"(<transient duration="4" step="3.2e-2" rho_infinity="0"/>)", Verdict::fail}}) {
    SCOPED_TRACE(transient);
    const auto [report, error] = oscillation(transient);
    ASSERT_TRUE(report.complete()) << report.failure;
    ASSERT_TRUE(report.time_error && report.time_error->known);
    const double estimate = report.time_error->displacement;
    EXPECT_GT(estimate, error / 3.0);
    EXPECT_LT(estimate, error * 3.0);
    EXPECT_NEAR(report.time_error->until, T, 1e-9);
    // Over the largest motion, 0.2 m.
    EXPECT_NEAR(report.time_error->relative, 5.0 * estimate, 0.1 * 5.0 * estimate);
    EXPECT_EQ(find(report.certificate, "error in time")->verdict, verdict)
        << words(report.certificate);
    EXPECT_NE(summary(report).find("covers"), std::string::npos);
  }
}

// Radau's fixed steps are of order 5, taken for 3, and tolerances for proportional: the error is not taken for smaller.
TEST(ErrorInTime, IsNotTakenForSmaller) {
  for (const char* const transient :
       {R"(<transient duration="4" method="radau" step="0.2"/>)",
        R"(<transient duration="4" method="radau" step="0.4"/>)",
        R"(<transient duration="4" tolerance="1e-3" output="0.01"/>)",
        R"(<transient duration="4" method="radau" tolerance="1e-4" output="0.01"/>)",
        R"(<transient duration="4" method="ida" tolerance="1e-4" output="0.01"/>)"}) {
    SCOPED_TRACE(transient);
    const auto [report, error] = oscillation(transient);
    ASSERT_TRUE(report.time_error && report.time_error->known);
    EXPECT_GT(report.time_error->displacement, error / 3.0);
    EXPECT_LT(report.time_error->displacement, error * 30.0);
  }
}

// A controller whose instants end all steps: with a larger tolerance the steps are the same, and so were the results. Between
// instants the held force moves the mass in closed form.
TEST(ErrorInTime, IsSeenWhereControllersEndTheSteps) {
  const double w = 20.0, period = 0.04, c = 3.0;
  TableMaker table(1);
  const Scene scene = scene_of(R"(
      <body name="m" at="0.5 0 0" mass="1" inertia="1 1 1" velocity="1 0 0"/>
      <prismatic name="rail" between="ground m" axis="1 0 0"/>
      <spring name="k" between="ground m" at_a="0 0 0" stiffness="400"/>
      <controller name="brake" period="0.04"><output name="u" value="-3*rail.speed"/></controller>
      <load at="m" force="u 0 0"/>
      <transient duration="2" method="radau" tolerance="1e-2" output="0.04"/>
      <record name="x" joint="rail" quantities="displacement"/>)");
  const RunReport report = run(scene, {.observers = {&table}});
  ASSERT_TRUE(report.complete()) << report.failure;
  double x = 0.0, v = 1.0, error = 0.0;
  for (std::size_t i = 0; i < table.table.rows(); ++i) {
    error = std::max(error, std::abs(table.table["x.displacement"][i] - x));
    const double rest = -c * v / (w * w), C = std::cos(w * period), S = std::sin(w * period);
    const double from = x - rest;
    x = rest + from * C + v / w * S;
    v = v * C - w * from * S;
  }
  ASSERT_GT(error, 1e-9);
  ASSERT_TRUE(report.time_error && report.time_error->known);
  EXPECT_GT(report.time_error->displacement, error / 3.0);
  EXPECT_LT(report.time_error->displacement, error * 30.0);
}

// The same in fixed steps of a period each: steps 1.75 times as long would be cut to the same. And of an output that never changes,
// at whose instants nothing begins anew: the run is that without a controller.
// Killed: longer steps all the same (an estimate six times too small); restarts where outputs stay (an error four times as large).
TEST(ErrorInTime, IsSeenWhereInstantsAreAsManyAsSteps) {
  const double w = 10.0, period = 0.01;
  const std::string body = R"(<body name="m" mass="1" inertia="1 1 1" velocity="1 0 0"/>
      <prismatic name="rail" between="ground m" axis="1 0 0"/>
      <joint_spring name="k" joint="rail" stiffness="100"/>
      {}<load at="m" force="{} 0 0"/>
      <transient duration="2" step="0.01" rho_infinity="0.9"/>
      <record name="x" joint="rail" quantities="displacement"/>)";
  const auto of = [&](const std::string& force, const std::string& controller, double gain,
                      double constant) {
    TableMaker table(1);
    const RunReport report =
        run(scene_of(fmt::format(fmt::runtime(body), controller, force)), {.observers = {&table}});
    EXPECT_TRUE(report.complete()) << report.failure;
    double x = 0.0, v = 1.0, error = 0.0;
    for (std::size_t i = 0; i < table.table.rows(); ++i) {
      error = std::max(error, std::abs(table.table["x.displacement"][i] - x));
      const double rest = (constant - gain * v) / (w * w), C = std::cos(w * period),
                   S = std::sin(w * period), from = x - rest;
      x = rest + from * C + v / w * S;
      v = v * C - w * from * S;
    }
    EXPECT_TRUE(report.time_error && report.time_error->known);
    EXPECT_GT(report.time_error->displacement, error / 3.0);
    EXPECT_LT(report.time_error->displacement, error * 3.0);
    return error;
  };
  of("u",
     R"(<controller name="c" period="0.01"><output name="u" value="-0.5*rail.speed"/></controller>)",
     0.5, 0.0);
  const double held =
      of("u", R"(<controller name="c" period="0.01"><output name="u" value="1"/></controller>)",
         0.0, 1.0);
  EXPECT_NEAR(held, of("1", "", 0.0, 1.0), 1e-9);
}

// Longer steps that are hard to take cost more than the shorter ones that are taken then (a chain of 1000 rods that whips, steps of
// 1 ms: ten times the run; now 2.3 times). Here the run's own work is understated in place of that. Both errors are right.
// Killed: iterations of longer steps that are not bounded; the substeps'.
TEST(ErrorInTime, GivesUpLongerStepsThatCostMoreThanTheRun) {
  const Scene scene = scene_of(R"(
      <body name="m" mass="1" inertia="1 1 1" velocity="1 0 0"/>
      <prismatic name="rail" between="ground m" axis="1 0 0"/>
      <joint_spring name="k" joint="rail" stiffness="100"/>
      <transient duration="2" step="0.01" rho_infinity="0.9"/>)");
  const Model model = compile(scene);
  TimeErrorMeter meter(*model.system, *scene.transient);
  State state = model.initial;
  meter.start(state);
  const std::unique_ptr<Stepper> stepper = make_stepper(*model.system, *scene.transient);
  ASSERT_TRUE(stepper->start(state).converged);
  double error = 0.0;
  while (state.t < 2.0 - 1e-9) {
    ASSERT_TRUE(stepper->step(state).converged);
    meter.sample(state);
    error = std::max(error, std::abs(state.pose[1].r[0] - std::sin(10.0 * state.t) / 10.0));
  }
  const Counters own = stepper->counters();
  Counters few_iterations = own, few_steps = own;
  few_iterations.iterations = few_steps.substeps = 10;
  for (const auto& [work, way] : {std::pair{own, "long"}, std::pair{few_iterations, "short"},
                                  std::pair{few_steps, "short"}}) {
    const TimeError estimate = meter.measure(work);
    ASSERT_TRUE(estimate.known) << estimate.why_not;
    EXPECT_SAYS(estimate.how, std::string("1.75 times as ") + way);
    EXPECT_NEAR(estimate.displacement / error, 1.0, 0.2);
  }
}

// Found by a reviewer: where fixed steps pass kinks of a law, errors go with no power of the step, and estimates by one were 3.5 to 19
// times too small, and passed. A mass between two elastic stops, in closed form: no run passes whose error is above the bound.
// Killed: powers of the step; the bound of smooth motions.
TEST(ErrorInTime, DoesNotPassByChanceWhereFixedStepsPassStops) {
  const double v = 2.9, d = 0.235, k = 3.25e4, w = std::sqrt(k), way = 2.0 * d / v;
  const auto exact = [&](double t) {
    const double half = way + pi / w;
    const double since = std::fmod(t + 0.5 * way, 2.0 * half);
    const double sign = since < half ? 1.0 : -1.0, tau = std::fmod(since, half);
    return sign * (tau < way ? v * tau - d : d + v / w * std::sin(w * (tau - way)));
  };
  int passed = 0;
  for (const char* settings : {R"(method="radau" step="4e-3")", R"(method="radau" step="2e-3")",
                               R"(method="radau" step="1e-3")", R"(method="radau" step="5e-4")",
                               R"(method="radau" step="1e-4")", R"(step="4e-4")", R"(step="2e-4")",
                               R"(step="1e-4")", R"(step="5e-5")"}) {
    TableMaker table(1);
    const RunReport report = run(scene_of(fmt::format(R"x(
          <body name="b" mass="1" inertia="1 1 1" velocity="{0} 0 0"/>
          <prismatic name="r" between="ground b" axis="1 0 0"/>
          <joint_spring name="s" joint="r" force="x > {1} ? {2}*(x-{1}) : (-{1} > x ? {2}*(x+{1}) : 0)"/>
          <transient duration="2" {3} output="0.01"/>
          <record name="r" joint="r" quantities="displacement"/>)x",
                                                      v, d, k, settings)),
                                 {.observers = {&table}});
    ASSERT_TRUE(report.complete()) << report.failure;
    double error = 0.0;
    for (std::size_t i = 0; i < table.table.rows(); ++i)
      error = std::max(error,
                       std::abs(table.table["r.displacement"][i] - exact(table.table["time"][i])));
    error /= d + v / w;
    ASSERT_TRUE(report.time_error && report.time_error->known) << settings;
    EXPECT_GT(report.time_error->kinks, 10) << settings;
    const double off =
        std::string_view(settings).find("radau") != std::string_view::npos ? 2.0 : 20.0;
    EXPECT_GT(report.time_error->relative, error / off) << settings << ": " << error;
    const Check& check = *find(report.certificate, "error in time");
    if (check.verdict == Verdict::pass) {
      ++passed;
      EXPECT_LT(error, 0.01) << settings;
    }
    EXPECT_SAYS(check.why, "may be ten times as large");
  }
  EXPECT_GT(passed, 0);
}

// Found by a reviewer: errors over the largest motion of anything passed for errors of what is recorded. The length of a spring between
// two bodies that fly, and an oscillator beside one that does; both in closed form.
// Killed: what is recorded not looked at; measured by the largest motion.
TEST(ErrorInTime, IsThatOfWhatIsRecordedToo) {
  const auto judge = [](const std::string& scene, const std::string& column, double size,
                        const auto& exact) {
    TableMaker table(1);
    const RunReport report = run(scene_of(scene), {.observers = {&table}});
    ASSERT_TRUE(report.complete()) << report.failure;
    double error = 0.0;
    for (std::size_t i = 0; i < table.table.rows(); ++i)
      error = std::max(error, std::abs(table.table[column][i] - exact(table.table["time"][i])));
    ASSERT_GT(error, 0.3 * size);
    ASSERT_TRUE(report.time_error && report.time_error->known);
    EXPECT_GT(report.time_error->recorded, error / size / 3.0);
    EXPECT_LT(report.time_error->recorded, error / size * 3.0);
    EXPECT_EQ(report.time_error->record, column);
    const Check* const check = find(report.certificate, "error in time");
    EXPECT_NE(check->verdict, Verdict::pass) << words(report.certificate);
  };
  for (const double v : {0.0, 1e4})
    judge(fmt::format(R"(<body name="m" mass="1" inertia="1 1 1" velocity="1 {0} 0"/>
        <body name="n" at="1 0 0" mass="1" inertia="1 1 1" velocity="-1 {0} 0"/>
        <spring name="s" between="m n" stiffness="200" length="1"/>
        <transient duration="2" step="0.02" rho_infinity="0.9"/>
        <record name="s" spring="s" quantities="length"/>)",
                      v),
          "s.length", 0.1, [](double t) { return 1.0 - 0.1 * std::sin(20.0 * t); });
  judge(R"(<body name="m" mass="1" inertia="1 1 1" velocity="0.001 0 0"/>
        <body name="B" at="100 0 0" mass="1" inertia="1 1 1" velocity="0 10 0"/>
        <prismatic name="rail" between="ground m" axis="1 0 0"/>
        <joint_spring name="k" joint="rail" stiffness="400"/>
        <transient duration="2" step="0.02" rho_infinity="0.9"/>
        <record name="r" joint="rail" quantities="displacement speed"/>)",
        "r.displacement", 5e-5, [](double t) { return 5e-5 * std::sin(20.0 * t); });
}

// A top that spins at 1000 rad/s in steps of 1 ms misses its precession, by 0.4 m; two such runs agree in that to 3 mm. Its
// moments are not kept, which is seen, and of the error nothing is said. At 200 rad/s the estimate is right.
TEST(ErrorInTime, IsNotBelievedOfWhatTurnsTooFar) {
  const auto top = [](double spin) {
    Scene scene = scene_of(fmt::format(R"(
        <body name="top" at="0 0.25 0.4330127018922193" orientation="-pi/6 0 0" mass="2"
              inertia="0.02 0.02 0.01" angular_velocity="0 0 {}"/>
        <spherical name="tip" between="ground top" at="0 0 0"/> <gravity acceleration="0 0 -9.81"/>
        <transient duration="2" step="1e-3" rho_infinity="0.9"/>)",
                                       spin));
    return scene;
  };
  const RunReport wild = run(top(1000.0));
  ASSERT_TRUE(wild.complete() && wild.time_error);
  EXPECT_FALSE(wild.time_error->known);
  EXPECT_NE(wild.time_error->why_not.find("turns by 1"), std::string::npos);
  EXPECT_EQ(wild.certificate.verdict(), Verdict::fail) << words(wild.certificate);
  // Against Radau at a tolerance of 1e-10.
  Scene scene = top(200.0);
  struct Last : Observer {
    void accepted(const Sample& sample) override { at = sample.state.pose[1]; }
    Pose<double> at;
  } coarse, fine;
  const RunReport tame = run(scene, {.observers = {&coarse}});
  scene.transient->step.reset();
  scene.transient->rho_infinity.reset();
  scene.transient->method = TimeMethod::radau;
  scene.transient->tolerance = 1e-10;
  ASSERT_TRUE(run(scene, {.observers = {&fine}, .estimate_error = false}).complete());
  const double error = (coarse.at.r - fine.at.r).norm();
  EXPECT_GT(error, 0.01);
  ASSERT_TRUE(tame.time_error && tame.time_error->known);
  EXPECT_GT(tame.time_error->displacement, error / 3.0);
  EXPECT_EQ(find(tame.certificate, "error in time")->verdict, Verdict::fail);
}

// What does not move is not believed to be exact, nor wrong by what round-off makes of its energies and momenta. Mutation: these
// are judged whether it moves or not.
TEST(ErrorInTime, IsNotKnownWhereNothingMoves) {
  const RunReport report = run(scene_of(R"(<body name="b" mass="2" inertia="1 1 1"/>
      <revolute name="j" between="ground b" axis="1 0 0"/> <transient duration="1" step="0.1"/>)"));
  ASSERT_TRUE(report.time_error.has_value());
  EXPECT_FALSE(report.time_error->known);
  EXPECT_EQ(find(report.certificate, "error in time")->verdict, Verdict::warn);
  for (const char* const at : {"1 0 0", "0.3 0 0", "7 0 0"})
    EXPECT_EQ(run(scene_of(fmt::format(R"(<body name="b" at="{}" mass="4" inertia="1 1 1"/>
                <prismatic name="p" between="ground b" axis="1 0 0"/>
                <spring name="s" between="ground b" at_a="0 0 0" stiffness="100"/>
                <transient duration="1" step="0.01"/>)",
                                       at)))
                  .certificate.verdict(),
              Verdict::warn)
        << at;
}

}  // namespace
}  // namespace mbd::test::test_certificate_checks
