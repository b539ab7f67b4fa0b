// Forces of plug-ins (tests/plugins/forces.cpp): against closed forms, the model's own springs and loads, and forces of a program;
// and plug-ins that are none.
//
// Tried in libmbd/compile/plugin.cpp and elements/node/force_batch.cpp, and killed: rotations column by column; derivatives column by
// column; the velocity of the first place everywhere; energy left out; the version not compared; exceptions let through; numbers that are
// none let through, or not said; false taken for true; values under the name of the first; a plug-in without use taken.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libmbd/compile/plugin.hpp"
#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/run/run.hpp"
#include "tests/support/program.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_plugins {
namespace {

const std::filesystem::path forces = MBD_TEST_PLUGIN, later = MBD_LATER_PLUGIN;

Scene with_plugin(const std::string& text) {
  Scene scene = read(text);
  use_plugin(scene, forces);
  return scene;
}

struct Result {
  Model model;
  State state;
  VecX outputs;
  long iterations = 0, retries = 0;
  StepReport report;

  double output(std::string_view name) const {
    return outputs(static_cast<Index>(output_index(model, name)));
  }
};
Result run_to_end(const Scene& scene, const Extensions& extensions = {}) {
  Result ended{compile(scene, extensions), {}, {}, 0, 0, {}};
  const auto stepper = make_stepper(*ended.model.system, *scene.transient);
  ended.state = ended.model.initial;
  ended.report = stepper->start(ended.state);
  while (ended.report.converged && ended.state.t < scene.transient->duration - 1e-9)
    ended.report = stepper->step(ended.state);
  ended.outputs.resize(static_cast<Index>(ports(ended.model).outputs.size()));
  outputs(ended.model, ended.state,
          {ended.outputs.data(), static_cast<std::size_t>(ended.outputs.size())});
  ended.iterations = stepper->counters().iterations;
  ended.retries = stepper->counters().retries;
  return ended;
}

void expect_same(const VecX& a, const VecX& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (Index i = 0; i < a.size(); ++i)
    EXPECT_NEAR(a(i), b(i), tolerance * std::max(1.0, std::abs(b(i)))) << i;
}

// A body on a spring of no length to the origin, let go with a turn and a speed across: an ellipse,
// x1 = cos w t, x2 = v/w sin w t, w^2 = k/m, whatever its attitude. With damping c of the same direction c' = c/2m:
// x1 = e^-c't (cos w't + c'/w' sin w't).
TEST(Plugins, ASpringIsThatOfTheClosedForm) {
  for (const double damping : {0.0, 0.8}) {
    SCOPED_TRACE(damping);
    const Result ended =
        run_to_end(with_plugin(fmt::format(R"(
      <parameter name="k" value="18"/>
      <body name="m" at="1 0 0" orientation="0.3 0.2 0.1" mass="2" inertia="0.1 0.2 0.3" velocity="{}"
            angular_velocity="0.5 0 0.7"/>
      <extension force="pull" at="m" values="damping={} stiffness=k"/>
      <transient duration="1.7" tolerance="1e-9" method="radau"/>
      <record name="m" at="m" quantities="displacement"/>
      <record name="all" quantities="strain_energy work_of_loads"/>)",
                                           damping == 0.0 ? "0 1.5 0" : "0 0 0", damping)));
    ASSERT_TRUE(ended.report.converged) << ended.report.failure;
    const double t = 1.7, decay = damping / 4.0, w = std::sqrt(9.0 - decay * decay);
    const double x1 = std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    const double x2 = damping == 0.0 ? 0.5 * std::sin(w * t) : 0.0;
    EXPECT_NEAR(ended.output("m.displacement.1"), x1 - 1.0, 1e-7);
    EXPECT_NEAR(ended.output("m.displacement.2"), x2, 1e-7);
    if (damping == 0.0) {
      EXPECT_NEAR(ended.output("all.strain_energy"), 9.0 * (x1 * x1 + x2 * x2), 1e-6);
      EXPECT_EQ(ended.output("all.work_of_loads"), 0.0);
    } else {
      const double v = 9.0 / w * std::exp(-decay * t) * std::sin(w * t);
      EXPECT_NEAR(ended.output("all.work_of_loads"), 0.5 * 2.0 * v * v, 1e-2);  // by trapezia
    }
  }
}

const std::string frame = R"(
  <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="60"/>
    <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
  <fixed name="clamp" between="ground b.start"/>
  <body name="m" mass="2" inertia="0.1 0.2 0.3" at="0 3 0.5" orientation="0.3 0.2 0.1"/>
  <record name="tip" at="b.end" quantities="displacement velocity"/>
  <record name="m" at="m" quantities="displacement velocity angular_velocity"/>
  <record name="all" quantities="total_energy work_of_loads"/>
  <transient duration="0.4" step="1e-3"/>)";

TEST(Plugins, SpringsAreThoseOfTheModel) {
  const Result wanted = run_to_end(read(frame + R"(
    <spring name="k1" between="ground b.end" at_a="0 0 0" at_b="2 0 0" length="1e-9" stiffness="40"/>
    <spring name="k2" between="ground m" at_a="0 0 0" at_b="0 3 0.5" length="1e-9" stiffness="40"/>)"));
  ASSERT_TRUE(wanted.report.converged) << wanted.report.failure;
  long iterations = 0;
  for (const char* force : {"pull", "plain_pull"}) {
    SCOPED_TRACE(force);
    const Result is = run_to_end(with_plugin(
        frame +
        fmt::format(R"(<extension force="{}" at="b.end m" values="stiffness=40"/>)", force)));
    ASSERT_TRUE(is.report.converged) << is.report.failure;
    VecX outputs = is.outputs;
    if (force == std::string("plain_pull")) {  // which tells no potential: its energy is work
      const auto energy = static_cast<Index>(output_index(is.model, "all.total_energy"));
      outputs(energy + 1) = wanted.outputs(energy + 1);
      outputs(energy) = wanted.outputs(energy);
    }
    expect_same(outputs, wanted.outputs, 1e-6);
    if (iterations == 0) iterations = is.iterations;
  }
  EXPECT_LE(iterations, wanted.iterations + wanted.iterations / 20);  // by an exact tangent
}

TEST(Plugins, DerivativesAreThoseOfTheForce) {
  const Scene scene =
      with_plugin(R"(<extension force="pull" at="a b" values="stiffness=3 damping=0.7"/>)");
  const std::shared_ptr<const Force> force = make_plugin_force(scene.extensions.front());
  std::vector<Pose<double>> poses;
  std::vector<Vec6> velocities;
  for (int i = 0; i < 2; ++i) {
    Vec6 x;
    x << 0.3, -0.2 + i, 0.9, 0.4, 0.5 - i, 0.6;
    poses.push_back(exp_se3<double>(x));
    velocities.push_back(2.0 * x);
  }
  const auto wrenches = [&](const std::vector<Pose<double>>& H, const std::vector<Vec6>& V) {
    std::vector<Vec6> f(2, Vec6::Zero());
    EXPECT_TRUE(force->evaluate({0.0, H, V}, f));
    VecX all(12);
    all << f[0], f[1];
    return all;
  };
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(12, 12), C = K;
  ASSERT_TRUE(force->derivatives({0.0, poses, velocities}, K, C));
  constexpr double step = 1e-6;
  for (Index j = 0; j < 12; ++j) {
    const auto place = static_cast<std::size_t>(j / 6);
    auto ahead = poses, behind = poses;
    ahead[place] = poses[place] * exp_se3<double>(Vec6(step * Vec6::Unit(j % 6)));
    behind[place] = poses[place] * exp_se3<double>(Vec6(-step * Vec6::Unit(j % 6)));
    const VecX by_motion =
        (wrenches(ahead, velocities) - wrenches(behind, velocities)) / (2.0 * step);
    EXPECT_LT((K.col(j) - by_motion).norm(), 1e-8) << j;
    auto faster = velocities;
    faster[place] += Vec6::Unit(j % 6);
    EXPECT_LT((C.col(j) - wrenches(poses, faster) + wrenches(poses, velocities)).norm(), 1e-12)
        << j;
  }
  EXPECT_GT((K - K.transpose()).norm(), 1.0);
}

// The same by a force of the program.
class Pull final : public Force {
 public:
  std::string name() const override { return "pull"; }
  std::vector<std::string> places() const override { return {"b", "m"}; }
  bool evaluate(const PlacesMotion& at, std::span<Vec6> wrenches) const override {
    for (std::size_t i = 0; i < wrenches.size(); ++i)
      wrenches[i].head<3>() =
          -4.0 * (at.poses[i].R().transpose() * at.poses[i].r) - 0.3 * at.velocities[i].head<3>();
    return true;
  }
};

TEST(Plugins, AreForcesOfAProgram) {
  const Result wanted = run_to_end(read(frame), {{std::make_shared<Pull>()}});
  const Result is = run_to_end(with_plugin(
      frame + R"(<extension force="plain_pull" at="b m" values="stiffness=4 damping=0.3"/>)"));
  ASSERT_TRUE(is.report.converged) << is.report.failure;
  expect_same(is.outputs, wanted.outputs, 1e-10);
  EXPECT_GT(wanted.outputs.norm(), 0.1);
}

TEST(Plugins, AreInEquilibriaToo) {
  const std::string arm = R"(
    <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="60"/></section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
    <fixed name="clamp" between="ground b.start"/><load at="b.end" force="0 0 20"/>
    <static/><record name="tip" at="b.end" quantities="displacement"/>)";
  const RunReport own = run(read(arm + R"(<load at="b.end" follower_force="3 0 0"/>)"), {});
  Scene scene = with_plugin(arm + R"(<extension name="jet" force="push" at="b.end"/>)");
  const RunReport report = run(scene, {});
  ASSERT_TRUE(report.complete()) << report.failure;
  ASSERT_TRUE(own.complete()) << own.failure;
  const Model model = compile(scene);
  EXPECT_NE(without_potential(scene).find("push"), std::string::npos);
  EXPECT_NEAR(report.energy_end.total(), own.energy_end.total(), 1e-8 * own.energy_end.total());
}

// Where it says that it is out of its range, shorter steps are tried; then the run ends with its name.
TEST(Plugins, FalseCutsTheStep) {
  const Result ended = run_to_end(with_plugin(R"(
    <body name="m" at="1 0 0" mass="2" inertia="0.1 0.1 0.1" velocity="1 0 0"/>
    <extension force="pull" at="m" values="stiffness=0.1 reach=1.5"/>
    <transient duration="2" step="0.02"/><record name="m" at="m" quantities="displacement"/>)"));
  EXPECT_FALSE(ended.report.converged);
  EXPECT_EQ(ended.report.kind, Failure::range);
  EXPECT_GT(ended.retries, 3);
  EXPECT_SAYS(ended.report.failure, "force 'pull of ");
  EXPECT_SAYS(ended.report.failure, "is out of its range");
  EXPECT_NEAR(ended.output("m.displacement.1"), 0.5, 0.02);
  EXPECT_LE(ended.output("m.displacement.1"), 0.5);
}

std::string refused(const std::string& extension, const std::filesystem::path& file = forces) {
  try {
    Scene scene = read(R"(<body name="m" at="1 0 0" mass="2" inertia="0.1 0.1 0.1"/>)" + extension +
                       R"(<transient duration="1" step="0.1"/>)");
    if (!file.empty()) use_plugin(scene, file);
    const Result ended = run_to_end(scene);
    return "step: " + ended.report.failure;
  } catch (const Error& error) {
    EXPECT_TRUE(error.kind() == Failure::plug_in || error.kind() == Failure::model ||
                error.kind() == Failure::request)
        << error.what();
    return error.what();
  }
}

TEST(Plugins, BadOnesAreRefusedByName) {
  const TemporaryDirectory directory;
  const std::string pull = R"(<extension name="e" force="pull" at="m" values="stiffness=1"/>)";
  const std::filesystem::path text = directory.path() / "text.so",
                              copy = directory.path() / "copy.so";
  std::ofstream(text) << "this is no shared object";
  std::filesystem::copy_file(forces, copy);
  const auto named = [](const std::string& said, const std::filesystem::path& file,
                        const std::string& part) {
    EXPECT_SAYS(said, file.string());
    EXPECT_SAYS(said, part);
  };
  named(refused(pull, later), later, "is for version 2 of plug-ins, and this libmbd has version 1");
  named(refused(pull, text), text, "cannot be loaded");
  named(refused(pull, directory.path() / "none.so"), "none.so", "there is no such file");
  named(refused(pull, MBD_FAULTS), MBD_FAULTS, "it has no function mbd_get_plugin");
  named(refused(""), forces, "the model has no <extension>");
  named(refused(R"(<extension force="puII" at="m"/>)"), forces, "the model asks for puII only");
  EXPECT_SAYS(refused(pull, {}),
              "extension \"e\": no plug-in has its force \"pull\"; give it by --plugin");
  EXPECT_SAYS(refused(R"(<extension force="pull" at="m" values="stiffness=0"/>)"),
              "says: stiffness must be positive");
  EXPECT_SAYS(refused(R"(<extension force="pull" at="m" values="stifness=1"/>)"),
              "says: there is no value \"stifness\"");
  EXPECT_SAYS(refused(R"(<extension force="push" at="m" values="a=1"/>)"), "takes no values");
  EXPECT_SAYS(refused(R"(<extension force="push" at="n"/>)"), "there is no node at \"n\"");
  Scene twice = read(R"(<body name="m" at="1 0 0" mass="2" inertia="0.1 0.1 0.1"/>)" + pull);
  use_plugin(twice, forces);
  try {
    use_plugin(twice, copy);
    ADD_FAILURE() << "two plug-ins with one force";
  } catch (const Error& error) {
    EXPECT_SAYS(std::string(error.what()), "both have such a force");
  }
}

TEST(Plugins, ValuesAreReadStrictly) {
  const auto said = [](const std::string& values) {
    return message(
        R"(<body name="m" mass="1" inertia="1 1 1"/><extension force="f" at="m" values=")" +
        values + R"("/><transient duration="1" step="0.1"/>)");
  };
  EXPECT_EQ(said("a=1 b=2*pi"), "no error");
  EXPECT_SAYS(said("1"), "write name=expression");
  EXPECT_SAYS(said("a="), "write name=expression");
  EXPECT_SAYS(said("a=1 a=2"), "twice");
  EXPECT_SAYS(said("a=q"), "q");
}

// Exceptions and numbers that are none: at the start before anything is run, later as the end of the run.
TEST(Plugins, ExceptionsAndNoNumbersAreSaid) {
  for (const auto& [force, part] : {std::pair{"throws", "throws an exception: boom"},
                                    std::pair{"no_number", "gives numbers that are none"}}) {
    SCOPED_TRACE(force);
    const auto extension = [&](double after) {
      return fmt::format(R"(<extension force="{}" at="m" values="stiffness=1 after={}"/>)", force,
                         after);
    };
    const std::string before = refused(extension(0.0)), later_on = refused(extension(0.45));
    for (const std::string& said : {before, later_on}) {
      EXPECT_SAYS(said, fmt::format("force '{} of {}'", force, forces.string()));
      EXPECT_SAYS(said, part);
    }
    EXPECT_FALSE(before.starts_with("step: "));
    EXPECT_TRUE(later_on.starts_with("step: ")) << later_on;
  }
}

// By the program: the same numbers, and without the plug-in a message.
TEST(Plugins, ByTheProgram) {
  const TemporaryDirectory directory;
  const std::string model = (directory.path() / "arm.xml").string(),
                    out = (directory.path() / "out").string();
  const std::string text = "<mbd name=\"arm\">" + frame +
                           R"(<extension force="pull" at="b.end m" values="stiffness=40"/></mbd>)";
  std::ofstream(model) << text;
  const auto call = [&](const std::vector<std::string>& arguments) {
    return Program(arguments, directory.path() / "said").wait();
  };
  const test::Ended good =
      call({"run", model, "--out", out, "--plugin", forces.string(), "--quiet"});
  EXPECT_EQ(good.status, 0) << good.err;
  std::ifstream history(directory.path() / "out" / "history.csv");
  std::string line, last;
  while (std::getline(history, line)) last = line;
  const Result wanted = run_to_end(
      with_plugin(frame + R"(<extension force="pull" at="b.end m" values="stiffness=40"/>)"));
  double t = 0.0, u1 = 0.0, u2 = 0.0;
  ASSERT_EQ(std::sscanf(last.c_str(), "%lf,%lf,%lf", &t, &u1, &u2), 3) << last;
  EXPECT_NEAR(u1, wanted.outputs(0), 1e-9);
  EXPECT_NEAR(u2, wanted.outputs(1), 1e-9);
  const test::Ended bad = call({"run", model, "--out", out});
  EXPECT_EQ(bad.status, 1);
  EXPECT_SAYS(bad.err, "no plug-in has its force \"pull\"");
  EXPECT_EQ(call({"check", model, "--plugin", forces.string()}).status, 0);
  const test::Ended explained = call({"explain", model, "--plugin", forces.string()});
  EXPECT_EQ(explained.status, 0);
  EXPECT_SAYS(explained.out, "forces of plug-ins");
}

}  // namespace
}  // namespace mbd::test::test_plugins
