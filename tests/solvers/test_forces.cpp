// Forces that a program computes: against the same loads and springs of a model, closed forms, and differences.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "elements/node/force.hpp"
#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "solvers/statics/statics.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_forces {
namespace {

const std::string frame = R"(
  <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="60"/>
    <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
  <beam name="c" section="s" from="2 0 0" to="2 1 0" normal="1 0 0" elements="1"/>
  <fixed name="clamp" between="ground b.start"/><fixed name="corner" between="b.end c.start"/>
  <body name="m" mass="2" inertia="0.1 0.2 0.3" at="0 3 0.5" orientation="0.3 0.2 0.1"/>
  <record name="tip" at="c.end" quantities="displacement velocity"/>
  <record name="m" at="m" quantities="displacement velocity angular_velocity"/>
  <record name="all" quantities="total_energy work_of_loads"/>)";

// Springs to points (or between two places), with dampers, in closed form with exact derivatives.
class SpringForce final : public Force {
 public:
  SpringForce(std::vector<std::string> places, double k, double c, bool derives)
      : places_(std::move(places)), k_(k), c_(c), derives_(derives) {}
  std::string name() const override { return "pull"; }
  std::vector<std::string> places() const override { return places_; }
  bool evaluate(const PlacesMotion& at, std::span<Vec6> wrenches) const override {
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      const Mat3 R = at.poses[i].R();
      const Vec3 pull = -k_ * (R.transpose() * at.poses[i].r);  // to the origin
      wrenches[i].head<3>() = pull - c_ * at.velocities[i].head<3>();
      wrenches[i].tail<3>().setZero();
    }
    return true;
  }
  bool derivatives(const PlacesMotion& at, Eigen::MatrixXd& by_motion,
                   Eigen::MatrixXd& by_velocity) const override {
    if (!derives_) return false;
    for (std::size_t i = 0; i < at.poses.size(); ++i) {
      const auto j = 6 * static_cast<Index>(i);
      // x = R^T r, dx = du + x~ dpsi
      const Vec3 x = at.poses[i].R().transpose() * at.poses[i].r;
      by_motion.block<3, 3>(j, j) = -k_ * Eigen::Matrix3d::Identity();
      by_motion.block<3, 3>(j, j + 3) = -k_ * hat(x);
      by_velocity.block<3, 3>(j, j) = -c_ * Eigen::Matrix3d::Identity();
    }
    return true;
  }
  std::optional<double> energy(const PlacesMotion& at) const override {
    if (c_ != 0.0) return {};
    double sum = 0.0;
    for (const Pose<double>& H : at.poses) sum += 0.5 * k_ * H.r.squaredNorm();
    return sum;
  }

 private:
  std::vector<std::string> places_;
  double k_, c_;
  bool derives_;
};

struct Ended {
  VecX outputs;
  long iterations = 0;
};
Ended run_to(const std::string& text, const Extensions& extensions, double end) {
  const Scene scene = read(text);
  const Model model = compile(scene, extensions);
  const auto stepper = make_stepper(*model.system, *scene.transient);
  State state = model.initial;
  StepReport report = stepper->start(state);
  EXPECT_TRUE(report.converged) << report.failure;
  while (report.converged && state.t < end - 1e-9) report = stepper->step(state);
  EXPECT_TRUE(report.converged) << report.failure;
  Ended ended{VecX(static_cast<Index>(ports(model).outputs.size())),
              stepper->counters().iterations};
  outputs(model, state, {ended.outputs.data(), static_cast<std::size_t>(ended.outputs.size())});
  return ended;
}

void expect_same(const VecX& a, const VecX& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (Index i = 0; i < a.size(); ++i)
    EXPECT_NEAR(a(i), b(i), tolerance * std::max(1.0, std::abs(b(i)))) << i;
}

#if defined(__SSE2__)
// Numbers below 2.2e-308, with which processors are slow, are zero inside steps, and there alone.
// Killed: steps without FlushToZero; one that does not restore what was.
TEST(Forces, SeeNoDenormalNumbersInSteps) {
  static double seen;
  class Probe final : public Force {
   public:
    std::string name() const override { return "probe"; }
    std::vector<std::string> places() const override { return {"m"}; }
    bool evaluate(const PlacesMotion&, std::span<Vec6> wrenches) const override {
      volatile double small = 1e-160;
      seen = std::max(seen, small * small);
      wrenches[0].setZero();
      return true;
    }
  };
  for (const char* method : {R"(step="1e-3")", R"(method="radau" tolerance="1e-4")",
                             R"(method="ida" tolerance="1e-4")"}) {
    SCOPED_TRACE(method);
    const Scene scene = read(frame + fmt::format(R"(<transient duration="0.01" {}/>)", method));
    Extensions extensions;
    extensions.forces.push_back(std::make_shared<Probe>());
    const Model model = compile(scene, extensions);
    const auto stepper = make_stepper(*model.system, *scene.transient);
    State state = model.initial;
    ASSERT_TRUE(stepper->start(state).converged);
    seen = 0.0;
    ASSERT_TRUE(stepper->step(state).converged);
    EXPECT_EQ(seen, 0.0);
    volatile double small = 1e-160;
    EXPECT_GT(small * small, 0.0);
  }
}
#endif

// A dead force and a follower moment of time, at the end of a beam and on a turned body.
TEST(Forces, AreTheSameAsLoads) {
  for (const char* method : {R"(step="1e-3")", R"(step="2e-3" method="radau")"}) {
    SCOPED_TRACE(method);
    const std::string end = fmt::format(R"(<transient duration="0.3" {}/>)", method);
    const Ended wanted = run_to(frame + R"(
        <load at="c.end" force="0 30*t 60*t" follower_moment="0 2-5*t 0"/>
        <load at="m" force="3 0 t"/>)" +
                                    end,
                                {}, 0.3);
    Extensions extensions;
    extensions.forces.push_back(
        make_force("push", {"c.end", "m"}, [](const PlacesMotion& at, std::span<Vec6> wrenches) {
          const Vec3 dead[] = {{0.0, 30.0 * at.t, 60.0 * at.t}, {3.0, 0.0, at.t}};
          for (std::size_t i = 0; i < 2; ++i)
            wrenches[i].head<3>() = at.poses[i].R().transpose() * dead[i];
          wrenches[0](4) = 2.0 - 5.0 * at.t;
          return true;
        }));
    const Ended is = run_to(frame + end, extensions, 0.3);
    expect_same(is.outputs, wanted.outputs, 1e-7);
    EXPECT_GT(wanted.outputs.head<3>().norm(), 0.05);
  }
}

// Springs of bushings to the origin, on all nodes of a beam and a body: motion and energies, with exact derivatives and by
// differences, which cost no iterations more than a few.
TEST(Forces, AreTheSameAsSprings) {
  const std::string end = R"(<transient duration="0.4" step="1e-3"/>)";
  const std::string springs =
      R"(<spring name="k1" between="ground c.end" at_a="0 0 0" at_b="2 1 0" length="1e-9" stiffness="40"/>
      <spring name="k2" between="ground m" at_a="0 0 0" at_b="0 3 0.5" length="1e-9" stiffness="40"/>)";
  const Ended wanted = run_to(frame + springs + end, {}, 0.4);
  long most = 0;
  for (const bool derives : {true, false}) {
    Extensions extensions;
    extensions.forces.push_back(
        std::make_shared<SpringForce>(std::vector<std::string>{"c.end", "m"}, 40.0, 0.0, derives));
    const Ended is = run_to(frame + end, extensions, 0.4);
    expect_same(is.outputs, wanted.outputs, 2e-6);
    if (derives) {
      EXPECT_LE(is.iterations, wanted.iterations + 5);
    }
    most = std::max(most, is.iterations);
  }
  EXPECT_LE(most, wanted.iterations + 20);
  EXPECT_GT(wanted.outputs.head<3>().norm(), 0.05);
}

// A damper on every node of a beam, inner ones too: what it takes is booked, and the structure comes to rest.
TEST(Forces, OnAllNodesOfABeam) {
  Extensions extensions;
  extensions.forces.push_back(
      std::make_shared<SpringForce>(std::vector<std::string>{"b", "c"}, 0.0, 3.0, true));
  const Scene scene = read(frame + R"(<load at="c.end" force="0 0 t&lt;0.05?40:0"/>
      <transient duration="4" step="2e-3" method="radau"/>)");
  const Model model = compile(scene, extensions);
  Index nodes = 0;
  for (const auto& batch : model.system->batches())
    if (batch->type() == "force 'pull'") nodes = batch->size();
  EXPECT_EQ(nodes, static_cast<Index>(model.lines[0].size() + model.lines[1].size()));
  EXPECT_GT(nodes, 8);
  const auto stepper = make_stepper(*model.system, *scene.transient);
  State state = model.initial;
  ASSERT_TRUE(stepper->start(state).converged);
  double most = 0.0, initial = model.system->energies(state).total();
  while (state.t < 4.0 - 1e-9) {
    ASSERT_TRUE(stepper->step(state).converged);
    const double gained = model.system->energies(state).total() - initial;
    most = std::max(most, gained);
    EXPECT_NEAR(gained, state.work.loads, 1e-4 * std::max(most, 1e-3)) << state.t;
  }
  EXPECT_GT(most, 0.02);
  EXPECT_LT(model.system->energies(state).total() - initial, 0.02 * most);
}

// A cantilever under a constant end moment is an arc, load step by load step: the load factor scales the force.
TEST(Forces, GrowWithTheLoadFactor) {
  const Scene scene = read(
      R"(<section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="4"/>
    <fixed name="clamp" between="ground b.start"/><static/>)");
  Extensions extensions;
  extensions.forces.push_back(
      make_force("bend", {"b.end"}, [](const PlacesMotion&, std::span<Vec6> wrenches) {
        wrenches[0](4) = -60.0;
        return true;
      }));
  const Model model = compile(scene, extensions);
  State state = model.initial;
  const auto solver = make_klu_solver();
  const StaticReport report = solve_statics(*model.system, *solver, {}, state);
  ASSERT_TRUE(report.converged) << report.failure;
  const double radius = 100.0 / 60.0, angle = 2.0 / radius;
  const Vec3 tip = state.pose[static_cast<std::size_t>(node_index(model, "b.end"))].r;
  EXPECT_NEAR(tip(0), radius * std::sin(angle), 1e-7);
  EXPECT_NEAR(tip(2), radius * (1.0 - std::cos(angle)), 1e-7);
}

// The tangent of the system with and without the force, at random motions, against differences of residuals: places with
// frames that differ from their nodes' (a body in a corner, and one attached to a beam).
TEST(Forces, TangentAgainstDifferences) {
  const std::string text =
      frame +
      R"(<body name="gripper" attached_to="c.end" mass="1" inertia="1 1 1" center="0.1 0.2 0.3"/>
      <transient duration="1" step="1e-3"/>)";
  // A force that couples its places, velocities included.
  class Coupled final : public Force {
   public:
    std::string name() const override { return "coupled"; }
    std::vector<std::string> places() const override { return {"c.end", "m", "b@0.5"}; }
    bool evaluate(const PlacesMotion& at, std::span<Vec6> w) const override {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const Vec3 x = at.poses[i].R().transpose() * Vec3(at.poses[j].r - at.poses[i].r);
        const Vec3 turned = at.poses[i].R().transpose() * Vec3(at.poses[j].R().col(1));
        w[i].head<3>() = 30.0 * x.norm() * x + 2.0 * at.velocities[j].head<3>();
        w[i].tail<3>() = 5.0 * turned - 0.3 * at.velocities[i].tail<3>();
      }
      return true;
    }
  };
  const Scene scene = read(text);
  Extensions extensions;
  extensions.forces.push_back(std::make_shared<Coupled>());
  const Model plain = compile(scene), with = compile(scene, extensions);
  Rng rng(5);
  State state = with.initial;
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    state.pose[n] = state.pose[n] * exp_se3<double>(random_vector<6>(rng, 0.3));
    state.V[n] = random_vector<6>(rng, 2.0);
  }
  const auto matrix_of = [&](const Model& model, const TangentWeights& weights) {
    DenseSolver solver;
    solver.analyze(model.system->graph());
    VecX r;
    model.system->linearize(state, weights, r, solver);
    return Eigen::MatrixXd(solver.matrix());
  };
  const auto residual_of = [&](const State& at) {
    VecX r, without;
    with.system->residual(at, r);
    plain.system->residual(at, without);
    return VecX(r - without);
  };
  const Index motions = 6 * (with.system->nodes() - 1);
  for (const bool of_motion : {true, false}) {
    const TangentWeights weights{of_motion ? 1.0 : 0.0, of_motion ? 0.0 : 1.0, 0.0, {}};
    const Eigen::MatrixXd K = matrix_of(with, weights) - matrix_of(plain, weights);
    double worst = 0.0;
    for (Index j = 0; j < motions; ++j) {
      const double step = of_motion ? 1e-5 : 1e-2;  // linear in velocities
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
    EXPECT_LT(worst, 1e-6 * K.cwiseAbs().maxCoeff()) << of_motion;
    EXPECT_GT(K.cwiseAbs().maxCoeff(), 0.1);
  }
}

TEST(Forces, AreLinearised) {
  const Scene scene = read(R"(<body name="m" mass="2" inertia="1 1 1"/>
    <prismatic name="p" between="ground m" axis="1 0 0"/><transient duration="1" step="0.01"/>)");
  Extensions extensions;
  extensions.forces.push_back(
      std::make_shared<SpringForce>(std::vector<std::string>{"m"}, 72.0, 0.4, false));
  const Linearization linear = [&] {
    const Model model = compile(scene, extensions);
    return linearize(model, model.initial);
  }();
  ASSERT_TRUE(linear.reduced);
  EXPECT_NEAR(linear.reduced->A(1, 0), -72.0, 1e-6);
  EXPECT_NEAR(linear.reduced->A(1, 1), -0.4, 1e-6);
  EXPECT_NEAR(linear.reduced->E(1, 1), 2.0, 1e-12);
}

TEST(Forces, SayWhatIsWrong) {
  const std::string end = R"(<transient duration="0.3" step="0.01"/>)";
  const auto said = [&](const std::vector<std::string>& places) -> std::string {
    Extensions extensions;
    extensions.forces.push_back(std::make_shared<SpringForce>(places, 1.0, 0.0, true));
    try {
      compile(read(frame + end), extensions);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(said({"b", "m"}), "no error");
  EXPECT_SAYS(said({"b.en"}), "b.end");
  EXPECT_SAYS(said({"b.en"}), "force \"pull\"");
  EXPECT_SAYS(said({"b@0.123"}), "there is no node at");
  EXPECT_SAYS(said({}), "acts on no place");
  // What is not a number, or is refused, ends the run by the force's name.
  for (const bool refuses : {true, false}) {
    Extensions extensions;
    extensions.forces.push_back(
        make_force("table", {"m"}, [refuses](const PlacesMotion& at, std::span<Vec6> wrenches) {
          if (at.t > 0.1) wrenches[0](0) = std::nan("");
          return !refuses || at.t <= 0.1;
        }));
    const Scene scene = read(frame + end);
    const Model model = compile(scene, extensions);
    const auto stepper = make_stepper(*model.system, *scene.transient);
    State state = model.initial;
    StepReport report = stepper->start(state);
    while (report.converged && state.t < 0.3 - 1e-9) report = stepper->step(state);
    EXPECT_FALSE(report.converged);
    EXPECT_NEAR(state.t, 0.1, 1e-3);
    EXPECT_SAYS(report.failure, "table");
  }
}

}  // namespace
}  // namespace mbd::test::test_forces
