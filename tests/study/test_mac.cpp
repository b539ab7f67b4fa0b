// How alike modes are, against closed forms: orthogonality, Euler's beams with and without a mass at the tip, two oscillators
// exchanged, the bending planes of a round beam, complex shapes of a damped pair by a dense eigenvalue problem.
#include "libmbd/study/modes/mac.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/modes_report.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/program.hpp"
#include "tests/support/program_test.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_mac {
namespace {

ModesStudy study_of(const Scene& scene, int count,
                    std::shared_ptr<const ShapesOfModes> compared = {}) {
  ModesOptions options;
  options.count = count;
  options.mac = true;
  options.compared = std::move(compared);
  return study_modes(scene, options);
}

std::shared_ptr<const ShapesOfModes> others_of(const Scene& scene, int count) {
  return std::make_shared<const ShapesOfModes>(shapes_of(study_of(scene, count)));
}

// EI2 = 100 and m = 1 over 1 m, shear, stretch, twist and rotary inertia next to none.
std::string cantilever(const std::string& EI3, const std::string& more,
                       const std::string& normal = "0 0 1") {
  return fmt::format(
      R"(<section name="s"><stiffness EA="1e9" GA2="1e9" GA3="1e9" GJ="1e7" EI2="100" EI3="{}"/>
           <mass per_length="1" inertia="2e-9 1e-9 1e-9"/></section>
         <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="{}" elements="4" order="5"/>
         <fixed name="clamp" between="ground b.start"/><static/>{})",
      EI3, normal, more);
}

// Two masses of 1 kg that slide along the first axis, each on a spring, and what is between them.
std::string pair(double k, double l, const std::string& between = "") {
  return fmt::format(
      R"(<body name="a" at="1 0 0" mass="1" inertia="1 1 1"/><body name="c" at="2 0 0" mass="1" inertia="1 1 1"/>
         <prismatic name="p" between="ground a" axis="1 0 0"/><prismatic name="q" between="ground c" axis="1 0 0"/>
         <spring name="s" between="ground a" at_a="0 0 0" stiffness="{}"/>
         <spring name="t" between="ground c" at_a="0 0 0" stiffness="{}"/>{}<static/>)",
      k, l, between);
}

TEST(MacOfModes, IsTheIdentityOfWhatNeitherDampsNorTurns) {
  // Bent by its load: with geometric stiffness.
  const ModesStudy study =
      study_of(read(cantilever("300", R"(<load at="b.end" force="0 5 -40"/>)")), 8);
  ASSERT_EQ(study.mac->mac.rows(), 8);
  EXPECT_LT((study.mac->mac - Eigen::MatrixXd::Identity(8, 8)).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_EQ(study.mac->modes.groups.size(), 8U);
  EXPECT_TRUE(study.mac->notes.empty());
}

// ---- Euler's beam with a mass at its tip, mu that of the beam --------------------------------------------------

double root_of(double mu, double low, double high) {
  const auto f = [mu](double b) {
    return 1.0 / std::cosh(b) + std::cos(b) + mu * b * (std::cos(b) * std::tanh(b) - std::sin(b));
  };
  EXPECT_LT(f(low) * f(high), 0.0);
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) * f(low) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double shape_at(double b, double x) {
  const double s = (std::cosh(b) + std::cos(b)) / (std::sinh(b) + std::sin(b));
  return std::cosh(b * x) - std::cos(b * x) - s * (std::sinh(b * x) - std::sin(b * x));
}

// Simpson's rule, and a mass at the tip.
double product(double a, double b, double tip) {
  constexpr int n = 2000;
  double sum = 0.0;
  for (int i = 0; i <= n; ++i) {
    const double x = static_cast<double>(i) / n;
    sum += (i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * shape_at(a, x) * shape_at(b, x);
  }
  return sum / (3.0 * n) + tip * shape_at(a, 1.0) * shape_at(b, 1.0);
}

TEST(MacOfModes, OfCantileversWithAndWithoutAMassAtTheTip) {
  constexpr double mu = 0.5;
  constexpr std::array ends{0.1, 3.1, 6.2, 9.4, 12.5};
  std::array<double, 4> bare{}, loaded{};
  for (std::size_t i = 0; i < 4; ++i) {
    bare[i] = root_of(0.0, ends[i], ends[i + 1]);
    loaded[i] = root_of(mu, ends[i], ends[i + 1]);
  }
  const Scene without = read(cantilever("1e6", ""));
  const Scene with = read(cantilever("1e6", R"(<point_mass name="m" at="b.end" mass="0.5"/>)"));
  for (const bool weighed_with : {false, true}) {
    const ModesStudy study =
        study_of(weighed_with ? with : without, 4, others_of(weighed_with ? without : with, 4));
    const auto &own = weighed_with ? loaded : bare, &others = weighed_with ? bare : loaded;
    const double tip = weighed_with ? mu : 0.0;
    double most = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      // Shear leaves b^2 EI/(GA L^2), 1e-5 of the fourth.
      EXPECT_NEAR(study.modes[i].eigenvalue.imag(), 10.0 * own[i] * own[i], 1e-4 * own[i] * own[i]);
      for (std::size_t j = 0; j < 4; ++j) {
        const double across = product(own[i], others[j], tip);
        const double wanted =
            across * across / product(own[i], own[i], tip) / product(others[j], others[j], tip);
        const double got = study.mac->mac(static_cast<Index>(i), static_cast<Index>(j));
        EXPECT_NEAR(got, wanted, 1e-5) << i << ' ' << j;
        most = std::max(most, i == j ? 0.0 : wanted);
      }
    }
    EXPECT_GT(most, 0.01);  // there is something to be found off the diagonal
    // The higher ones are alike by less than half: a mass at the tip makes a node of it.
    ASSERT_GE(study.mac->pairs.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(study.mac->pairs[i].other, i);
  }
}

// ---- which is which -------------------------------------------------------------------------------------

TEST(MacOfModes, RecognisesModesThatChangedPlaces) {
  const ModesStudy study =
      study_of(read(pair(100.0, 200.0)), 2, others_of(read(pair(300.0, 200.0)), 2));
  EXPECT_NEAR(study.mac->mac(0, 1), 1.0, 1e-12);
  EXPECT_NEAR(study.mac->mac(0, 0), 0.0, 1e-12);
  ASSERT_EQ(study.mac->pairs.size(), 2U);
  EXPECT_EQ(study.mac->pairs[0].other, 1U);
  EXPECT_EQ(study.mac->pairs[1].other, 0U);
  EXPECT_SAYS(to_text(*study.mac), "+73.2 %");  // sqrt(300/100)
}

// Any two planes are those of a round beam: only both together can be compared.
TEST(MacOfModes, TakesModesOfOneEigenvalueTogether) {
  const Scene round = read(cantilever("100", "")),
              turned = read(cantilever("100", "", "0 0.5 0.8")),
              oval = read(cantilever("104", "", "0 0.5 0.8"));
  const ModesStudy same = study_of(round, 4, others_of(turned, 4));
  using Groups = std::vector<std::vector<std::size_t>>;
  EXPECT_EQ(same.mac->modes.groups, (Groups{{0, 1}, {2, 3}}));
  EXPECT_NEAR(same.mac->groups(0, 0), 1.0, 1e-9);
  EXPECT_NEAR(same.mac->groups(1, 1), 1.0, 1e-9);
  EXPECT_LT(same.mac->groups(0, 1), 1e-9);
  EXPECT_NEAR(same.mac->mac.topLeftCorner(2, 2).sum(), 2.0, 1e-9);  // rows of an orthogonal matrix
  ASSERT_FALSE(same.mac->notes.empty());
  EXPECT_SAYS(same.mac->notes.back(), "any mixture of their shapes");
  // Each of two bending planes lies in the group.
  const ModesStudy parted = study_of(round, 2, others_of(oval, 2));
  EXPECT_EQ(parted.mac->others.groups, (Groups{{0}, {1}}));
  ASSERT_EQ(parted.mac->pairs.size(), 2U);
  for (const MacTable::Pair& one : parted.mac->pairs) EXPECT_NEAR(one.alike, 1.0, 1e-6);
}

// (l^2 M + l C + K) x = 0 of two masses by a companion matrix.
TEST(MacOfModes, OfComplexShapes) {
  const Scene scene =
      read(pair(100.0, 150.0, R"(<spring name="u" between="a c" stiffness="40" damping="6"/>)"));
  const ModesStudy study = study_of(scene, 2);
  Eigen::Matrix2d K, C;
  K << 140.0, -40.0, -40.0, 190.0;
  C << 6.0, -6.0, -6.0, 6.0;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topRightCorner<2, 2>().setIdentity();
  A.bottomLeftCorner<2, 2>() = -K;
  A.bottomRightCorner<2, 2>() = -C;
  const dense::EigenPairs exact = dense::eigenpairs(Eigen::MatrixXd(A));
  std::vector<Eigen::Vector2cd> shapes;
  for (const NamedMode& mode : study.modes) {
    Index nearest = 0;
    (exact.values.array() - mode.eigenvalue).abs().minCoeff(&nearest);
    EXPECT_LT(std::abs(exact.values(nearest) - mode.eigenvalue), 1e-12);
    shapes.emplace_back(exact.vectors.col(nearest).head<2>());
  }
  ASSERT_EQ(shapes.size(), 2U);
  const double wanted =
      std::norm(shapes[0].dot(shapes[1])) / shapes[0].squaredNorm() / shapes[1].squaredNorm();
  EXPECT_GT(wanted, 1e-3);  // they are not orthogonal
  EXPECT_NEAR(study.mac->mac(0, 1), wanted, 1e-13);
  EXPECT_NEAR(study.mac->mac(1, 0), wanted, 1e-13);
  // Nor is that a matter of units, or of how the scene lies.
  const Scene other_units = rescaled(scene, {1e3, 1e-3, 1e2}).scene,
              elsewhere = moved(scene, random_motion(3, 10.0)).scene;
  EXPECT_NEAR(study_of(other_units, 2).mac->mac(0, 1), wanted, 1e-9);
  EXPECT_NEAR(study_of(elsewhere, 2).mac->mac(0, 1), wanted, 1e-9);
}

// Two modes are all there are, whatever is asked for.
TEST(MacOfModes, OfFewerModesThanAskedFor) {
  const ModesStudy study = study_of(read(pair(100.0, 150.0)), 50);
  EXPECT_EQ(study.modes.size(), 2U);
  EXPECT_EQ(study.mac->mac.rows(), 2);
  const ModesStudy pendulum = study_of(read(R"(<body name="b" at="0 0 -1" mass="2" inertia="1 2 3"/>
              <revolute name="h" between="ground b" at="0 0 0" axis="0 1 0"/>
              <gravity acceleration="0 0 -10"/><transient duration="1" step="0.1"/>)"),
                                       9);
  EXPECT_EQ(pendulum.mac->mac.rows(), 1);
  EXPECT_NEAR(pendulum.mac->mac(0, 0), 1.0, 1e-12);
}

// Six motions that nothing answers are one group; bending is orthogonal to them.
TEST(MacOfModes, OfABeamThatFloats) {
  Scene scene = read(cantilever("300", R"(<transient duration="1" step="0.1"/>)"));
  scene.joints.clear();
  const ModesStudy study = study_of(scene, 8);
  ASSERT_EQ(study.modes.size(), 8U);
  ASSERT_FALSE(study.mac->modes.groups.empty());
  EXPECT_EQ(study.mac->modes.groups[0].size(), 6U);
  EXPECT_NEAR(study.mac->groups(0, 0), 1.0, 1e-9);
  for (Index g = 1; g < study.mac->groups.cols(); ++g) EXPECT_LT(study.mac->groups(0, g), 1e-7);
}

// ---- files ---------------------------------------------------------------------------------------------

TEST(MacOfModes, ReadsWhatWasWritten) {
  const TemporaryDirectory directory;
  const Scene scene = read(cantilever("300", ""));
  const ModesStudy study = study_of(scene, 5);
  EXPECT_EQ(write_modes(study, directory.path()),
            (std::vector<std::string>{"modes.csv", "modes.json", "mac.csv", "mac.json"}));
  const ShapesOfModes theirs = read_modes(directory.path()), ours = shapes_of(study);
  EXPECT_EQ(theirs.nodes, ours.nodes);
  EXPECT_EQ(theirs.names, ours.names);
  EXPECT_EQ(theirs.eigenvalues, ours.eigenvalues);
  EXPECT_EQ(theirs.shapes, ours.shapes);
  const ModesStudy again = study_of(scene, 5, std::make_shared<const ShapesOfModes>(theirs));
  EXPECT_NEAR(again.mac->mac.trace(), 5.0, 1e-9);
  const nlohmann::json json = nlohmann::json::parse(to_json(*again.mac));
  EXPECT_EQ(json["mac"][3][3], again.mac->mac(3, 3));
  EXPECT_EQ(json["pairs"].size(), 5U);
  // A later study without it leaves no older table beside it.
  ModesOptions plain;
  plain.count = 2;
  write_modes(study_modes(scene, plain), directory.path());
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "mac.csv"));
}

TEST(MacOfModes, SaysWhatCannotBeCompared) {
  const TemporaryDirectory directory;
  const auto of_file = [&](const char* text) {
    std::ofstream(directory.path() / "modes.json") << text;
    return refusal([&] { read_modes(directory.path()); });
  };
  EXPECT_SAYS(refusal([&] { read_modes(directory.path() / "none.json"); }), "cannot be read");
  for (
      const char* const text :
      {"", "{", "[1]", R"({"model": "m"})",
       R"({"model":"m","nodes":[{"name":"n","position":[0,0,0]}],"modes":[{"name":"x","eigenvalue":[0,1],
            "frequency":1,"round_off":0,"shape":[]}]})"})
    EXPECT_SAYS(of_file(text), "is not what `mbd modes` writes");
  const Scene beam = read(cantilever("300", ""));
  EXPECT_SAYS(refusal([&] { study_of(beam, 2, others_of(read(pair(1.0, 2.0)), 2)); }),
              "has no node of a name that");
  // Another mesh, and a longer beam: said, and compared where names are the same.
  Scene finer = beam;
  finer.beams[0].elements = 5;
  const std::vector<std::string> notes = study_of(beam, 2, others_of(finer, 2)).mac->notes;
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_SAYS(notes[0], "compared at the 21 nodes whose names both have, of 21 here and 26 there");
  EXPECT_SAYS(notes[1], "another mesh, or another state");
}

// ---- the command, and <modes> of a scene -------------------------------------------------------------------

class ModesOfScenes : public ProgramTest {
 protected:
  void write(const std::string& name, const std::string& modes,
             const std::string& more = "") const {
    std::ofstream(file(name + ".xml"))
        << "<mbd name=\"" << name << "\">" << cantilever("300", modes + more)
        << R"(<record name="tip" at="b.end" quantities="displacement"/></mbd>)";
  }
  std::string text(const std::string& name) const { return contents(file(name)); }
};

TEST_F(ModesOfScenes, AreWrittenByRunsAsByTheCommand) {
  write("asks", R"(<modes count="3" near="10 Hz" mac="on"/>)");
  write("silent", "");
  const Output ran = mbd("run asks.xml -o asks"), found = mbd("modes asks.xml -o found");
  ASSERT_EQ(ran.status, 0) << ran.text;
  ASSERT_EQ(found.status, 0) << found.text;
  for (const char* const name : {"modes.csv", "modes.json", "mac.csv", "mac.json"}) {
    EXPECT_FALSE(text(std::string("asks/") + name).empty()) << name;
    EXPECT_EQ(text(std::string("asks/") + name), text(std::string("found/") + name)) << name;
  }
  EXPECT_SAYS(found.text, "asked for: count 3 (<modes>), near 10 Hz (<modes>), mac on (<modes>)");
  EXPECT_SAYS(ran.text, found.text.substr(0, found.text.find("\nwritten to")));
  // Nothing of it without the element; and of an earlier run nothing stays.
  ASSERT_EQ(mbd("run silent.xml -q -o asks").status, 0);
  EXPECT_FALSE(std::filesystem::exists(file("asks/modes.csv")));
  EXPECT_FALSE(std::filesystem::exists(file("asks/mac.json")));
}

TEST_F(ModesOfScenes, GiveWayToOptions) {
  std::string rotor =
      R"(<mbd name="asks"><body name="disk" at="0 0 0" mass="20" inertia="0.5 0.9 0.9"/>)";
  for (const auto& [name, x] : {std::pair{"A", -0.4}, std::pair{"B", 0.4}})
    rotor += fmt::format(
        R"(<body name="{0}" at="{1} 0 0" mass="1e-6" inertia="1e-9 1e-9 1e-9"/>
           <bushing name="k{0}" between="ground {0}" at="{1} 0 0" stiffness="1e6 3e5 3e5"
                    angular_stiffness="1e4 1e4 1e4"/>
           <spherical name="J{0}" between="{0} disk" at="{1} 0 0"/>)",
        name, x);
  std::ofstream(file("asks.xml")) << rotor << R"(<transient duration="1" step="0.1"/>
      <modes count="3" rate="20 rpm" axis="1 0 0" at_rest="A B"/></mbd>)";
  const std::string by_scene = mbd("modes asks.xml").text;
  EXPECT_SAYS(by_scene, "steady rotation at 2.0943951");
  EXPECT_SAYS(by_scene,
              "count 3 (<modes>), rate 2.0943951023931953 rad/s (<modes>), axis 1 0 0 (<modes>)");
  const std::string both = mbd("modes asks.xml -n 2 --rate 5").text;
  EXPECT_SAYS(both, "count 2 (option), rate 5 rad/s (option), axis 1 0 0 (<modes>)");
  const std::string at = mbd("modes asks.xml --at 0").text;
  EXPECT_SAYS(at, "about the state of a run at 0 s");
  EXPECT_SAYS(at, "rate none (option), at 0 s (option), axis none (option)");
  EXPECT_SAYS(mbd("modes asks.xml --at 0 --rate 1").text, "give --rate or --at, one of them");
  EXPECT_SAYS(mbd("modes asks.xml --at 0 --axis 0 0 1").text,
              "--axis, --through and --at-rest are of");
  EXPECT_SAYS(mbd("modes asks.xml --count 0").text, "--count 0: is 0, must lie between 1 and 1");
  EXPECT_SAYS(mbd("modes asks.xml --near \"-3 Hz\"").text, "must not be negative");
  EXPECT_SAYS(mbd("modes asks.xml --near \"3 kg\"").text, "--near 3 kg: ");
}

// The run went well, its modes did not: its results stay, the status says it.
TEST_F(ModesOfScenes, FailByThemselves) {
  write("hangs", R"(<modes rate="3" axis="0 0 1"/>)");
  const Output ran = mbd("run hangs.xml -q -o hangs");
  EXPECT_EQ(ran.status, 1);
  EXPECT_SAYS(ran.text, "its run went well, its <modes> did not");
  EXPECT_TRUE(std::filesystem::exists(file("hangs/history.csv")));
  EXPECT_TRUE(std::filesystem::exists(file("hangs/report.json")));
  EXPECT_FALSE(std::filesystem::exists(file("hangs/modes.csv")));
  // Of a state that the run does not come to: before it runs. (Studies that run the scene for a shorter time do not mind.)
  write("late", R"(<modes at="1.5"/><transient duration="1" step="0.1"/>)");
  const Output late = mbd("run late.xml -q -o late");
  EXPECT_EQ(late.status, 1);
  EXPECT_SAYS(late.text, "ends at 1 s, there is no state of it at 1.5 s");
  EXPECT_FALSE(std::filesystem::exists(file("late")));
}

TEST_F(ModesOfScenes, AreComparedByTheCommand) {
  write("one", "");
  write("two", "", R"(<point_mass name="m" at="b.end" mass="0.5"/>)");
  ASSERT_EQ(mbd("modes two.xml -n 4 -q -o of_two").status, 0);
  const Output with_model = mbd("modes one.xml -n 4 --compare two.xml -o a");
  ASSERT_EQ(with_model.status, 0) << with_model.text;
  EXPECT_SAYS(with_model.text, "MAC, weighted by mass, of modes with those of two.xml");
  EXPECT_SAYS(with_model.text, "written to a: modes.csv, modes.json, mac.csv, mac.json");
  for (const char* const other : {"of_two", "of_two/modes.json"})
    ASSERT_EQ(mbd(std::string("modes one.xml -n 4 -q -o b --compare ") + other).status, 0);
  EXPECT_EQ(text("a/mac.csv"), text("b/mac.csv"));
  EXPECT_SAYS(mbd("modes one.xml --compare nothing").text, "nothing");
}

}  // namespace
}  // namespace mbd::test::test_mac
