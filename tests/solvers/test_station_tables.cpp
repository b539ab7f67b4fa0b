// Sections given by stations: mass, its moments, and stiffness of any mesh against integrals of the tables in closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libmbd/compile/model.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_station_tables {
namespace {

// Of a blade: stations where no mesh of equal elements has ends, a root far heavier than the rest, jumps within a
// hundredth of the length.
struct Station {
  double at, mass, torsion;  // [kg/m], [N.m2]
};
const std::vector<Station> blade = {
    {0.0, 1400.0, 2.1e10}, {0.013, 1380.0, 2.0e10}, {0.021, 610.0, 1.9e10}, {0.05, 580.0, 1.2e10},
    {0.11, 600.0, 6.0e9},  {0.17, 470.0, 2.3e9},    {0.28, 455.0, 1.1e9},   {0.285, 390.0, 1.0e9},
    {0.41, 330.0, 5.2e8},  {0.55, 240.0, 2.6e8},    {0.67, 185.0, 1.3e8},   {0.79, 118.0, 5.5e7},
    {0.88, 71.0, 1.9e7},   {0.96, 33.0, 5.0e6},     {1.0, 6.0, 9.0e5}};
constexpr double length = 62.5;

// Integral of the linear table of masses times s^power, s from 0 to the length: Simpson's rule, which is exact for it.
double moment_of_mass(const std::vector<Station>& table, int power) {
  double sum = 0.0;
  for (std::size_t i = 1; i < table.size(); ++i) {
    const Station &a = table[i - 1], &b = table[i];
    const auto f = [&](double at, double m) { return m * std::pow(at * length, power); };
    sum +=
        (b.at - a.at) * length / 6.0 *
        (f(a.at, a.mass) + 4.0 * f(0.5 * (a.at + b.at), 0.5 * (a.mass + b.mass)) + f(b.at, b.mass));
  }
  return sum;
}

// Stiff against its weight, so that its root's moment is that of the straight blade.
Scene blade_scene(const std::string& beam, const std::string& more, bool stiff,
                  const std::vector<Station>& table = blade) {
  std::string stations;
  for (const Station& s : table)
    stations += fmt::format(
        R"(<station at="{0:.17g}"><stiffness EA="{1:.17g}" GA2="{1:.17g}" GA3="{1:.17g}" GJ="{2:.17g}" EI2="{1:.17g}"
           EI3="{1:.17g}"/><mass per_length="{3:.17g}" inertia="{3:.17g} {3:.17g} {3:.17g}"/></station>)",
        s.at, stiff ? 1e18 : 1e12, s.torsion, s.mass);
  return read_model_text(fmt::format(R"(<mbd name="blade"><section name="s">{}</section>
      <beam name="b" section="s" from="0 0 0" to="{} 0 0" normal="0 0 1" {}/>{}</mbd>)",
                                     stations, length, beam, more),
                         "blade.xml");
}

double last(const History& history, const std::string& column) {
  EXPECT_TRUE(history.report.complete()) << history.report.failure;
  return history.table[column].back();
}

const std::string meshes[] = {R"(elements="1")",
                              R"(elements="2")",
                              R"(elements="3")",
                              R"(elements="7")",
                              R"(elements="40")",
                              R"(mesh="stations")",
                              R"(mesh="stations" elements="2")"};

// Denominators: the integrals themselves. A mutation that fails: the table at the nodes in place of its integral (4 % of
// the mass with one element of order 5).
TEST(StationTables, MassIsThatOfTheTableOnAnyMesh) {
  const double mass = moment_of_mass(blade, 0);
  for (const std::string& mesh : meshes)
    for (int order = 1; order <= 8; ++order)
      for (const std::string kind :
           {R"(rule="gauss")", R"(rule="gauss_lobatto")", R"(kinematics="classical")"}) {
        const Model model = compile(blade_scene(
            fmt::format(R"({} order="{}" {})", mesh, order, kind), R"(<static/>)", true));
        EXPECT_NEAR(model.mass / mass, 1.0, 1e-13) << mesh << ' ' << order << ' ' << kind;
      }
}

// Held at its root, under its weight.
const std::string hanging =
    R"(<fixed name="root" between="ground b.start"/><gravity acceleration="0 0 -1"/><static/>
       <record name="root" joint="root" quantities="reaction_force reaction_moment"/>)";

TEST(StationTables, MassOfARigidBladeToo) {
  const double mass = moment_of_mass(blade, 0), moment = moment_of_mass(blade, 1);
  const Scene scene = blade_scene("", R"(<rigid name="r" of="b"/>)" + hanging, true);
  const History history = run_to_table(scene);
  EXPECT_NEAR(std::abs(last(history, "root.reaction_force.3")) / mass, 1.0, 1e-13);
  EXPECT_NEAR(std::abs(last(history, "root.reaction_moment.2")) / moment, 1.0, 1e-13);
}

// Weight and its moment at the root. The moment is right to what the blade bends: below 1e-8 of it.
TEST(StationTables, FirstMomentIsThatOfTheTableOnAnyMesh) {
  const double mass = moment_of_mass(blade, 0), moment = moment_of_mass(blade, 1);
  for (const std::string& mesh : meshes)
    for (const int order : {1, 2, 5}) {
      SCOPED_TRACE(fmt::format("{} order {}", mesh, order));
      const Scene scene = blade_scene(fmt::format(R"({} order="{}")", mesh, order), hanging, true);
      const History history = run_to_table(scene);
      EXPECT_NEAR(std::abs(last(history, "root.reaction_force.3")) / mass, 1.0, 1e-12);
      EXPECT_NEAR(std::abs(last(history, "root.reaction_moment.2")) / moment, 1.0, 1e-8);
    }
}

// A table that falls by a factor of 1e4 within a hundredth: the polynomials of its element have negative parts there. No
// node may get a negative mass, nor the whole another one.
TEST(StationTables, NoNodeHasANegativeMass) {
  const std::vector<Station> jump = {
      {0.0, 1e4, 1e8}, {0.03, 1e4, 1e8}, {0.04, 1.0, 1e8}, {1.0, 1.0, 1e8}};
  for (const int order : {3, 5, 8}) {
    const Scene scene =
        blade_scene(fmt::format(R"(elements="1" order="{}")", order),
                    R"(<fixed name="root" between="ground b.start"/><gravity acceleration="0 0 -1"/>
             <transient duration="0.01" step="0.001"/>
             <record name="tip" at="b.end" quantities="position"/>)",
                    false, jump);
    const Model model = compile(scene);
    EXPECT_NEAR(model.mass / moment_of_mass(jump, 0), 1.0, 1e-13);
    EXPECT_TRUE(std::isfinite(last(run_to_table(scene), "tip.position.3")));
  }
}

// Twist of the tip under a torque T: the integral of T/GJ, a logarithm between two stations.
double twist(double torque) {
  double sum = 0.0;
  for (std::size_t i = 1; i < blade.size(); ++i) {
    const Station &a = blade[i - 1], &b = blade[i];
    const double slope = (b.torsion - a.torsion) / ((b.at - a.at) * length);
    sum += torque * std::log(b.torsion / a.torsion) / slope;
  }
  return sum;
}

// Relative errors over 8, 16, 32 elements between each two stations (the torsional stiffness falls by a factor of five between
// two of them); order 2N, as for one smooth table.
TEST(StationTables, TwistConvergesAtTheElementsOrder) {
  constexpr double torque = 1e3;
  for (const int order : {1, 2, 3}) {
    std::vector<double> h, error;
    for (const int elements : {8, 16, 32}) {
      const Scene scene =
          blade_scene(fmt::format(R"(mesh="stations" elements="{}" order="{}")", elements, order),
                      fmt::format(R"(<fixed name="root" between="ground b.start"/>
              <load at="b.end" moment="{:.17g} 0 0"/><static/><record name="tip" at="b.end" quantities="rotation"/>)",
                                  torque),
                      false);
      h.push_back(1.0 / elements);
      error.push_back(std::abs(last(run_to_table(scene), "tip.rotation.1") / twist(torque) - 1.0));
    }
    EXPECT_NEAR(fitted_order(h, error), 2.0 * order, 0.35)
        << order << ": " << error.front() << " … " << error.back();
  }
}

TEST(StationTables, MeshOfStationsNeedsThem) {
  const std::string text =
      R"(<mbd name="x"><section name="s"><stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/>
      </section><beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" mesh="stations"/><static/></mbd>)";
  try {
    (void)compile(read_model_text(text, "x.xml"));
    FAIL() << "no error";
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find("has none; leave mesh out or give stations"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace mbd::test::test_station_tables
