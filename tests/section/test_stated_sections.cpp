// Sections that models state by material, plies and shape: against closed forms, in other units, and what is refused;
// mbd section; the models shaft_tube and four_bar_boxes beside those that state D.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/run/describe.hpp"
#include "libmbd/run/describe_section.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_stated_sections {
namespace {

constexpr double pi = std::numbers::pi, degree = pi / 180.0;

const std::string steel = R"xml(<material name="steel" E="210 GPa" nu="0.3" rho="7850"/>)xml";
const std::string fibre =
    R"xml(<material name="ud" EL="181 GPa" ET="10.3 GPa" GLT="7.17 GPa" nuLT="0.28" nuTN="0.33" rho="1600"/>)xml";

std::string section(const std::string& shape) {
  return "<section name=\"s\">" + shape + "</section>";
}
Section one_section(const std::string& inside, const Overrides& overrides = {}) {
  return read(inside, overrides).sections.at(0);
}
Section of_steel(const std::string& shape) { return one_section(steel + section(shape)); }

void expect_near(double value, double expected, double relative, const std::string& what) {
  EXPECT_NEAR(value, expected, relative * std::abs(expected)) << what;
}
// Entries over sqrt(Dii Djj).
double difference(const Mat6& a, const Mat6& b) {
  const Vec6 root = b.diagonal().cwiseSqrt();
  return ((a - b).array() / (root * root.transpose()).array()).abs().maxCoeff();
}

// ---- what they come to ------------------------------------------------------------------------

TEST(StatedSections, TubeInClosedForm) {
  const double e = 210e9, g = e / 2.6, r = 0.05, i = 0.046;
  const Section s = of_steel(R"xml(<tube radius="50 mm" material="steel" thickness="4 mm"/>)xml");
  const double area = pi * (r * r - i * i), polar = pi / 2 * (std::pow(r, 4) - std::pow(i, 4));
  expect_near(s.stiffness(0, 0), e * area, 1e-9, "EA");
  expect_near(s.stiffness(3, 3), g * polar, 1e-9, "GJ");
  expect_near(s.stiffness(5, 5), e * polar / 2, 1e-9, "EI");
  ASSERT_TRUE(s.mass);
  expect_near((*s.mass)(0, 0), 7850 * area, 1e-9, "mass");
  expect_near((*s.mass)(3, 3), 7850 * polar, 1e-9, "inertia");
  // Of one isotropic material nothing couples, not by round-off either.
  EXPECT_TRUE(s.stiffness.isDiagonal(0.0)) << s.stiffness;
  ASSERT_TRUE(s.found);
  EXPECT_LE(s.found->error.maxCoeff(), 1e-5);
  EXPECT_GT(s.found->elements, 0);
}

TEST(StatedSections, BarAndRectangleAreSolid) {
  const double e = 210e9;
  const Section bar = of_steel(R"xml(<bar radius="0.02" material="steel"/>)xml");
  expect_near(bar.stiffness(4, 4), e * pi / 4 * std::pow(0.02, 4), 1e-7, "bar");
  const Section flat =
      of_steel(R"xml(<rectangle width="0.06" height="0.02" material="steel"/>)xml");
  expect_near(flat.stiffness(4, 4), e * 0.06 * std::pow(0.02, 3) / 12, 1e-9, "about b2");
  expect_near(flat.stiffness(5, 5), e * 0.02 * std::pow(0.06, 3) / 12, 1e-9, "about b3");
}

TEST(StatedSections, FlangedInClosedForm) {
  const double e = 210e9, b = 0.06, h = 0.1, f = 0.008, w = 0.005;
  const std::string sizes =
      R"xml( width="60 mm" height="100 mm" material="steel" flange_thickness="8 mm" web_thickness="5 mm"/>)xml";
  const Section i = of_steel("<I" + sizes), c = of_steel("<C" + sizes);
  const double area = 2 * b * f + (h - 2 * f) * w;
  const double i22 = (b * std::pow(h, 3) - (b - w) * std::pow(h - 2 * f, 3)) / 12;
  const double i33 = (2 * f * std::pow(b, 3) + (h - 2 * f) * std::pow(w, 3)) / 12;
  for (const Section* s : {&i, &c}) {
    expect_near(s->stiffness(0, 0), e * area, 1e-8, "EA");
    expect_near(s->stiffness(4, 4), e * i22, 1e-8, "EI22");
  }
  expect_near(i.stiffness(5, 5), e * i33, 1e-8, "EI33");
  // The outer face of the web of a C is at x2 = 0: the first moment about it.
  const double first = 2 * b * f * b / 2 + (h - 2 * f) * w * w / 2;
  expect_near(c.stiffness(0, 5), -e * first, 1e-8, "D16");
}

// Moved by (x2, x3) and turned: a force N1 has the moments x3 N1 about b2, -x2 N1 about b3.
TEST(StatedSections, PlaceAndTurn) {
  const double e = 210e9, w = 0.06, h = 0.02, x2 = 0.01, x3 = -0.03, turn = 30 * degree;
  const Section s = of_steel(
      R"xml(<rectangle width="0.06" height="0.02" material="steel" x2="10 mm" x3="-30 mm" turn="30 deg"/>)xml");
  const double area = w * h, i22 = w * h * h * h / 12, i33 = h * w * w * w / 12;
  const double c = std::cos(turn), n = std::sin(turn);
  const double about2 = c * c * i22 + n * n * i33, about3 = n * n * i22 + c * c * i33,
               product = c * n * (i33 - i22);  // of x2 x3
  expect_near(s.stiffness(0, 4), e * area * x3, 1e-9, "D15");
  expect_near(s.stiffness(0, 5), -e * area * x2, 1e-9, "D16");
  expect_near(s.stiffness(4, 4), e * (about2 + area * x3 * x3), 1e-9, "D55");
  expect_near(s.stiffness(5, 5), e * (about3 + area * x2 * x2), 1e-9, "D66");
  expect_near(s.stiffness(4, 5), -e * (product + area * x2 * x3), 1e-9, "D56");
  expect_near((*s.mass)(0, 4), 7850 * area * x3, 1e-9, "static moment");
  expect_near((*s.mass)(0, 5), -7850 * area * x2, 1e-9, "static moment");
}

// Plies turn with their walls: D of the turned section is D turned.
TEST(StatedSections, PliesTurnWithTheShape) {
  // On the same mesh.
  const auto c = [](const std::string& turn) {
    const Scene scene =
        read(fibre +
             section("<C width=\"30 mm\" height=\"40 mm\" material=\"ud\" angle=\"25 deg\" "
                     "flange_thickness=\"3 mm\" web_thickness=\"4 mm\" tolerance=\"0.1\" turn=\"" +
                     turn + "\"/>"));
    return section::analyse(mesher_of(scene, *scene.sections[0].shape, "it")({3, 2})).stiffness;
  };
  Mat6 both = Mat6::Zero();
  Mat3 r = Mat3::Identity();
  r(1, 1) = r(2, 2) = std::cos(0.7);
  r(2, 1) = std::sin(0.7);
  r(1, 2) = -r(2, 1);
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = r;
  EXPECT_LT(difference(c("0.7"), both * c("0") * both.transpose()), 1e-8);
}

// Of the box of the paper (models/four_bar_boxes.xml): butt corners are softer, in D22 by 14 %.
TEST(StatedSectionsSlow, CornersOfBoxes) {
  const auto box = [](const std::string& corners) {
    return one_section(
               fibre +
               R"xml(<layup name="wall"><ply material="ud" thickness="1.6 mm" angle="-30 deg"/>
                                     <ply material="ud" thickness="1.6 mm" angle="30 deg"/></layup>)xml" +
               section("<box width=\"16 mm\" height=\"16 mm\" layup=\"wall\" tolerance=\"1e-3\" "
                       "corners=\"" +
                       corners + "\"/>"))
        .stiffness;
  };
  EXPECT_NEAR(box("mitred")(1, 1) / 2516.5e3, 1.0, 2e-3);
  EXPECT_NEAR(box("butt")(1, 1) / 2516.5e3, 0.86, 5e-3);
}

// What one section came to is not taken for another.
TEST(StatedSections, AreKeptApart) {
  const Scene scene = read(
      R"xml(<material name="a" E="1e9" nu="0.3" rho="1000"/><material name="b" E="1e9" nu="0.3" rho="2000"/>
            <section name="a"><bar radius="0.1" material="a"/></section>
            <section name="b"><bar radius="0.1" material="b"/></section>
            <section name="c"><bar radius="0.1" material="b" x2="0.1"/></section>)xml");
  expect_near((*scene.sections[1].mass)(0, 0), 2 * (*scene.sections[0].mass)(0, 0), 1e-12, "mass");
  EXPECT_GT(std::abs(scene.sections[2].stiffness(0, 5)), 1.0);
}

// A single ply at +theta, right-handed about the outward normal: D14 < 0, D25 > 0.
TEST(StatedSections, SignOfPlies) {
  const auto tube = [](const std::string& angle) {
    return one_section(
        fibre + section("<tube radius=\"0.05\" material=\"ud\" thickness=\"0.004\" angle=\"" +
                        angle + "\"/>"));
  };
  const Section s = tube("30 deg"), other = tube("-30 deg");
  EXPECT_LT(s.stiffness(0, 3), -1e5);
  EXPECT_GT(s.stiffness(1, 4), 1e5);
  expect_near(other.stiffness(0, 3), -s.stiffness(0, 3), 1e-6, "the other sign");
}

std::string layup_of(const std::string& listed, const std::string& first,
                     const std::string& second) {
  return "<layup name=\"wall\" listed=\"" + listed +
         "\"><ply material=\"ud\" thickness=\"1 mm\" angle=\"" + first +
         "\"/><ply material=\"ud\" thickness=\"3 mm\" angle=\"" + second + "\"/></layup>";
}

TEST(StatedSections, OrderOfListing) {
  const std::string tube = section(R"xml(<tube radius="0.05" layup="wall"/>)xml");
  const std::string thin =
      R"xml(<layup name="wall" listed="outside"><ply material="ud" thickness="3 mm"/>
            <ply material="ud" thickness="1 mm" angle="60 deg"/></layup>)xml";
  const Mat6 d = one_section(fibre + layup_of("inside", "60 deg", "0") + tube).stiffness;
  EXPECT_LT(difference(one_section(fibre + thin + tube).stiffness, d), 1e-12);
  EXPECT_GT(difference(one_section(fibre + layup_of("outside", "60 deg", "0") + tube).stiffness, d),
            1e-3);
}

// What a layup repeats, and plies that are equal neighbours.
TEST(StatedSections, RepeatedPlies) {
  const std::string tube = section(R"xml(<tube radius="0.05" layup="wall"/>)xml");
  const Mat6 d =
      one_section(fibre +
                  R"xml(<layup name="wall"><repeat count="4"><ply material="ud" thickness="1 mm"
                                   angle="i > 1 ? 20*deg : 50*deg"/></repeat></layup>)xml" +
                  tube)
          .stiffness;
  const Mat6 e =
      one_section(fibre +
                  R"xml(<layup name="wall"><ply material="ud" thickness="2 mm" angle="50 deg"/>
                                   <ply material="ud" thickness="2 mm" angle="20 deg"/></layup>)xml" +
                  tube)
          .stiffness;
  EXPECT_LT(difference(d, e), 1e-12);
}

// In a material whose axes are all the same, angles do not matter: the constants by name, one by one.
TEST(StatedSections, OrthotropicConstants) {
  const std::string box = section(
      R"xml(<box width="30 mm" height="20 mm" material="m" thickness="2 mm" angle="0.4" tolerance="1e-3"/>)xml");
  const Section a = one_section(R"xml(<material name="m" E="7e10" nu="0.3"/>)xml" + box);
  const Section b = one_section(
      R"xml(<material name="m" EL="7e10" ET="7e10" EN="7e10" GLT="7e10/2.6" GLN="7e10/2.6" GTN="7e10/2.6"
             nuLT="0.3" nuLN="0.3" nuTN="0.3"/>)xml" +
      box);
  EXPECT_LT(difference(a.stiffness, b.stiffness), 1e-9);
  EXPECT_FALSE(a.mass);  // no rho
  // Each of them counts.
  const Section ud = one_section(
      fibre +
      section(
          R"xml(<box width="30 mm" height="20 mm" material="ud" thickness="2 mm" angle="0.4" tolerance="1e-3"/>)xml"));
  for (const char* const other :
       {"EN=\"20 GPa\"", "GLN=\"3 GPa\"", "GTN=\"2 GPa\"", "nuLN=\"0.4\""}) {
    std::string changed = fibre;
    changed.replace(changed.find("rho"), 0, std::string(other) + " ");
    const Section s = one_section(
        changed +
        section(
            R"xml(<box width="30 mm" height="20 mm" material="ud" thickness="2 mm" angle="0.4" tolerance="1e-3"/>)xml"));
    EXPECT_GT(difference(s.stiffness, ud.stiffness), 1e-7) << other;
  }
}

TEST(StatedSections, OtherUnits) {
  const Section si = one_section(
      fibre + layup_of("inside", "30 deg", "-0.2") +
      section(R"xml(<box width="0.04" height="0.03" layup="wall" tolerance="1e-3"/>)xml"));
  const Section mm = one_section(
      R"xml(<material name="ud" EL="181000 MPa" ET="10300 N/mm2" GLT="7.17e6 kN/m2" nuLT="0.28" nuTN="0.33" rho="1.6 g/cm3"/>
            <layup name="wall"><ply material="ud" thickness="1000 um" angle="30 deg"/>
            <ply material="ud" thickness="0.3 cm" angle="-0.2 rad"/></layup>)xml" +
      section(R"xml(<box width="40 mm" height="3 cm" layup="wall" tolerance="1e-3"/>)xml"));
  EXPECT_LT(difference(mm.stiffness, si.stiffness), 1e-9);
  EXPECT_LT(difference(*mm.mass, *si.mass), 1e-9);
}

TEST(StatedSections, ParametersAndSet) {
  const std::string model =
      R"xml(<parameter name="wall" value="4 mm"/><parameter name="E" value="200 GPa"/>
            <material name="m" E="E" nu="0.25"/>)xml" +
      section(R"xml(<tube radius="0.05" material="m" thickness="wall"/>)xml");
  const Section a = one_section(model), b = one_section(model, {{"wall", "2 mm"}}),
                c = one_section(model, {{"E", "100 GPa"}});
  expect_near(b.stiffness(0, 0) / a.stiffness(0, 0),
              (0.05 * 0.05 - 0.048 * 0.048) / (0.05 * 0.05 - 0.046 * 0.046), 1e-9, "thinner");
  EXPECT_LT(difference(c.stiffness, 0.5 * a.stiffness), 1e-9);
}

// Names may be used before they are given; defaults hold for shapes and plies.
TEST(StatedSections, OrderOfItemsAndDefaults) {
  const Section a = one_section(
      "<defaults><ply material=\"ud\" thickness=\"1 mm\"/><tube radius=\"0.05\"/></defaults>" +
      section(R"xml(<tube layup="wall"/>)xml") +
      R"xml(<layup name="wall"><ply/><ply angle="45 deg"/></layup>)xml" + fibre);
  const Section b = one_section(fibre +
                                R"xml(<layup name="wall"><ply material="ud" thickness="0.001"/>
            <ply material="ud" thickness="0.001" angle="45 deg"/></layup>)xml" +
                                section(R"xml(<tube radius="0.05" layup="wall"/>)xml"));
  EXPECT_LT(difference(a.stiffness, b.stiffness), 1e-12);
}

TEST(StatedSections, AtStations) {
  const Section s = one_section(
      steel +
      R"xml(<section name="s"><repeat count="3"><station at="i/2"><tube radius="0.05 - 0.01*i"
            material="steel" thickness="4 mm"/></station></repeat></section>)xml");
  ASSERT_EQ(s.stations.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    const double r = 0.05 - 0.01 * static_cast<double>(k);
    expect_near(s.stations[k].stiffness(0, 0), 210e9 * pi * (r * r - std::pow(r - 0.004, 2)), 1e-9,
                "station");
    EXPECT_TRUE(s.stations[k].mass);
  }
}

TEST(StatedSections, MassThatIsStatedStays) {
  const Section s =
      one_section(steel + section(R"xml(<mass per_length="3" inertia="3e-3 1e-3 2e-3"/>
                            <tube radius="0.05" material="steel" thickness="4 mm"/>)xml"));
  EXPECT_EQ((*s.mass)(0, 0), 3.0);
  EXPECT_EQ((*s.mass)(4, 4), 1e-3);
  EXPECT_GT(s.stiffness(0, 0), 1e6);
}

// To the first order of k, D16 = E k I33 of k3 = -k.
TEST(StatedSections, Curved) {
  const Section s = one_section(
      "<material name=\"m\" E=\"100 GPa\" nu=\"0\"/>" +
      section(R"xml(<rectangle width="0.1" height="0.1" material="m" curvature="0 0 -0.01"/>)xml"));
  expect_near(s.stiffness(0, 5), 100e9 * 0.01 * 1e-4 / 12, 1e-6, "D16");
}

// ---- with what else there is ------------------------------------------------------------------

const std::string cantilever =
    R"xml(<beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
  <fixed name="wall" between="ground b.start"/><load at="b.end" force="0 0 100"/><static/>
  <record name="tip" at="b.end" quantities="displacement"/>)xml";

// Its material and shape in other units come to its D and M in other units.
TEST(StatedSections, InOtherUnitsOfTheScene) {
  const Scene scene = read(
      fibre + layup_of("inside", "30 deg", "-10 deg") +
      section(R"xml(<C width="40 mm" height="50 mm" flange="wall" web="wall" x2="3 mm" turn="0.3"
                       tolerance="0.01" curvature="0.5 0 1"/>)xml") +
      cantilever);
  for (const UnitChange& units : {UnitChange{1e3, 1e-3, 1.0}, UnitChange{0.5, 7.0, 20.0}}) {
    const Scene other = rescaled(scene, units).scene;
    Scene again = other;
    again.sections[0].stiffness.setZero();
    again.sections[0].mass->setZero();
    analyse_shapes(again);
    EXPECT_LT(difference(again.sections[0].stiffness, other.sections[0].stiffness), 1e-8);
    EXPECT_LT(difference(*again.sections[0].mass, *other.sections[0].mass), 1e-8);
  }
}

// As if the numbers stood there.
TEST(StatedSections, MoveAsMatricesDo) {
  const Scene shaped =
      read(steel + section(R"xml(<tube radius="0.02" material="steel" thickness="2 mm"/>)xml") +
           cantilever);
  Scene written = shaped;
  written.materials.clear();
  written.sections[0].shape.reset();
  written.sections[0].found.reset();
  const History a = run_to_table(shaped), b = run_to_table(written);
  EXPECT_EQ(a.table["tip.displacement.3"].back(), b.table["tip.displacement.3"].back());
  const double i = pi / 4 * (std::pow(0.02, 4) - std::pow(0.018, 4));
  expect_near(a.table["tip.displacement.3"].back(), 100.0 / (3 * 210e9 * i), 5e-3, "P L^3/(3 EI)");
}

// What is said of where the numbers come from.
TEST(StatedSections, AreExplained) {
  const Scene scene =
      read(steel +
           section("\n"
                   R"xml(<tube radius="0.02" material="steel" thickness="2 mm"/>)xml") +
           cantilever);
  const std::string text = to_text(explain_model(scene, compile(scene)));
  EXPECT_NE(text.find("stiffness and mass computed from material and shape"), std::string::npos);
  EXPECT_NE(text.find("section \"s\" by <tube>"), std::string::npos) << text;
  EXPECT_NE(text.find("line 3 (D to "), std::string::npos) << text;
  // A scene of matrices says nothing of it.
  const Scene other = model_scene("shaft");
  EXPECT_EQ(to_text(explain_model(other, compile(other))).find("computed from"), std::string::npos);
}

// ---- refused ----------------------------------------------------------------------------------

struct Bad {
  std::string inside, line, part;
};

TEST(StatedSections, Refused) {
  const std::string ply = "<layup name=\"wall\"><ply material=\"ud\" thickness=\"1 mm\"/></layup>";
  const auto tube = [](const std::string& rest) {
    return steel + "\n" + section("<tube radius=\"0.05\" " + rest + "/>");
  };
  const Bad all[] = {
      // materials
      {R"xml(<material name="m" E="1e9" nu="0.5"/>)xml", "2",
       "material \"m\": nu is 0.5, must lie between -1 and 0.5"},
      {R"xml(<material name="m" E="1e9" nu="-1"/>)xml", "2",
       "nu is -1, must lie between -1 and 0.5"},
      {R"xml(<material name="m" E="-1e9" nu="0.3"/>)xml", "2",
       "material \"m\": E is -1e+09, must be positive"},
      {R"xml(<material name="m" E="1e9"/>)xml", "2", "\"nu\" is missing"},
      {R"xml(<material name="m" nu="0.3"/>)xml", "2", "\"E\" is missing"},
      {R"xml(<material name="m" rho="1"/>)xml", "2", "it has no stiffness; give E and nu"},
      {R"xml(<material name="m" E="1e9" nu="0.3" GLT="1e9"/>)xml", "2", "give one or the other"},
      {R"xml(<material name="m" EL="1e9" ET="1e9" nuLT="0.3" nuTN="0.3"/>)xml", "2",
       "\"GLT\" is missing"},
      {R"xml(<material name="m" EL="1e9" ET="1e9" GLT="1e9" nuLT="1.1" nuTN="0.3"/>)xml", "2",
       "not positive definite: |nuLT| = 1.1 is not below"},
      {R"xml(<material name="m" EL="1e9" ET="1e9" GLT="1e9" nuLT="0.9" nuTN="0.9"/>)xml", "2",
       "the Poisson's ratios are too large"},
      {R"xml(<material name="m" EL="1e9" ET="1e9" GLT="1e9" nuLT="0.3" nuTN="-1.5"/>)xml", "2",
       "nuTN is -1.5"},
      {R"xml(<material name="m" E="1e9 Hz" nu="0.3"/>)xml", "2", "of another quantity"},
      {R"xml(<material name="m" E="1e9" nu="0.3" rho="-2"/>)xml", "2", "must be positive"},
      {R"xml(<material name="m" E="1e9" nu="0.3"/>)xml"
       "\n"
       R"xml(<material name="m" E="1e9" nu="0.3"/>)xml",
       "3", "is taken"},
      // layups
      {"<layup name=\"wall\"/>", "2", "it has no plies"},
      {fibre + "\n<layup name=\"wall\">\n<ply material=\"du\" thickness=\"1 mm\"/></layup>", "4",
       "layup \"wall\", ply: material \"du\" is not in the model; did you mean \"ud\""},
      {fibre + "\n<layup name=\"wall\"><ply material=\"ud\" thickness=\"0\"/></layup>", "3",
       "must be positive"},
      {fibre +
           "\n<layup name=\"wall\" listed=\"top\"><ply material=\"ud\" thickness=\"1\"/></layup>",
       "3", "listed=\"top\""},
      {fibre +
           "\n<layup name=\"wall\"><repeat count=\"101\"><ply material=\"ud\" thickness=\"1e-5\" "
           "angle=\"i\"/></repeat></layup>" +
           section("<tube radius=\"1\" layup=\"wall\"/>"),
       "3", "101 plies, must have 100 at most"},
      // shapes
      {tube("layup=\"wall\""), "3", "section \"s\": layup \"wall\" is not in the model"},
      {tube("material=\"stel\" thickness=\"1 mm\""), "3", "did you mean \"steel\""},
      {tube("material=\"steel\""), "3", "\"thickness\" is missing"},
      {tube("thickness=\"1 mm\""), "3", "give layup, or material and thickness"},
      {tube("material=\"steel\" thickness=\"50 mm\""), "3", "do not fit: the outer radius is 0.05"},
      {tube("material=\"steel\" thickness=\"-1 mm\""), "3", "must be positive"},
      {tube("material=\"steel\" thickness=\"1 mm\" tolerance=\"0\""), "3", "tolerance"},
      {tube("material=\"steel\" thickness=\"1 mm\" width=\"1\""), "3",
       "unknown attribute \"width\""},
      {tube("material=\"steel\" thickness=\"1 mm\" curvature=\"0 0 20\""), "3",
       "the curvature is too strong"},
      {tube("material=\"steel\" thickness=\"1 mm\" curvature=\"0 -20 0\""), "3",
       "the curvature is too strong"},
      {fibre + ply + "\n" + section("<tube radius=\"0.05\" layup=\"wall\" material=\"ud\"/>"), "3",
       "not both"},
      {fibre + ply + "\n" + section("<tube radius=\"0.05\" layup=\"wall\" thickness=\"1\"/>"), "3",
       "thickness is that of the layup"},
      {fibre + ply + "\n" + section("<tube radius=\"0.05\" layup=\"wall\" angle=\"1\"/>"), "3",
       "stand in the layup"},
      {fibre + ply + "\n" + section("<tube radius=\"0.5 mm\" layup=\"wall\"/>"), "3", "do not fit"},
      {steel + "\n" +
           section("<box width=\"1\" height=\"0.1\" material=\"steel\" thickness=\"50 mm\"/>"),
       "3", "do not fit: half its smaller side"},
      {steel + "\n" +
           section("<I width=\"0.1\" height=\"0.1\" material=\"steel\" flange_thickness=\"1 mm\" "
                   "web_thickness=\"0.2\"/>"),
       "3", "web of the I: its plies are 0.2 thick"},
      {steel + "\n" +
           section("<C width=\"0.1\" height=\"0.1\" material=\"steel\" flange_thickness=\"51 mm\" "
                   "web_thickness=\"1 mm\"/>"),
       "3", "flange of the C: its plies are 0.051 thick"},
      {steel + "\n" +
           section(
               "<C width=\"0.1\" height=\"0.1\" material=\"steel\" flange_thickness=\"5 mm\"/>"),
       "3", "\"web_thickness\" is missing"},
      {steel + "\n" + section("<bar radius=\"0.1\"/>"), "3", "\"material\" is missing"},
      {steel + fibre +
           "<material name=\"light\" E=\"1e9\" nu=\"0.3\"/><layup name=\"wall\"><ply "
           "material=\"light\" "
           "thickness=\"1 mm\"/><ply material=\"steel\" thickness=\"1 mm\"/></layup>\n" +
           section("<tube radius=\"0.05\" layup=\"wall\"/>"),
       "3", "material \"light\" has no density rho"},
      {steel + "\n" + section("<rectangle width=\"100 mm\" height=\"0.1 mm\" material=\"steel\"/>"),
       "3", "its parts are too slender"},
      // what else the section has
      {steel + "\n<section name=\"s\"><bar radius=\"1\" material=\"steel\"/>\n<tube radius=\"1\" "
               "material=\"steel\" thickness=\"1 mm\"/></section>",
       "4", "has a shape already"},
      {steel + "\n<section name=\"s\"><bar radius=\"1\" material=\"steel\"/>\n<stiffness EA=\"1\" "
               "GA2=\"1\" GA3=\"1\" GJ=\"1\" EI2=\"1\" EI3=\"1\"/></section>",
       "4", "both a stiffness and a shape"},
      {steel + "\n<section name=\"s\"><stiffness EA=\"1\" GA2=\"1\" GA3=\"1\" GJ=\"1\" EI2=\"1\" "
               "EI3=\"1\"/>\n<bar radius=\"1\" material=\"steel\"/></section>",
       "4", "both a stiffness and a shape"},
      {steel + "\n<section name=\"s\"><bar radius=\"1\" material=\"steel\"/><station at=\"0\"><bar "
               "radius=\"1\" material=\"steel\"/></station></section>",
       "3", "must stand in the stations"},
      {"<section name=\"s\"></section>", "2", "or 36 numbers, a shape, or stations"},
  };
  for (const Bad& bad : all) {
    const std::string said = message(bad.inside);
    EXPECT_TRUE(said.starts_with("test.xml:" + bad.line + ": ")) << said << "\n" << bad.inside;
    EXPECT_NE(said.find(bad.part), std::string::npos) << said << "\nwanted: " << bad.part;
  }
}

// Corners of plies that turn are singular: 1e-10 is out of reach, and the message says what is known.
TEST(StatedSectionsSlow, ToleranceOutOfReach) {
  const std::string said = message(
      fibre + "\n" +
      section(
          R"xml(<C width="10 mm" height="20 mm" material="ud" flange_thickness="1 mm" web_thickness="2 mm"
                       angle="30 deg" tolerance="1e-10"/>)xml"));
  EXPECT_TRUE(said.starts_with("test.xml:3: section \"s\": tolerance 1e-10 is not reached"))
      << said;
  EXPECT_NE(said.find("ask for a tolerance above"), std::string::npos) << said;
}

// ---- hostile ----------------------------------------------------------------------------------

// Sizes and moduli far apart: a wire, a tower, a foil.
TEST(StatedSections, FarApart) {
  const Section wire = one_section(R"xml(<material name="m" E="3 MPa" nu="0.49" rho="1100"/>)xml" +
                                   section(R"xml(<bar radius="5 um" material="m"/>)xml"));
  expect_near(wire.stiffness(0, 0), 3e6 * pi * 25e-12, 1e-7, "wire");
  const Section tower =
      one_section(R"xml(<material name="m" E="210 GPa" nu="0.3" rho="8500"/>)xml" +
                  section(R"xml(<tube radius="5 m" material="m" thickness="20 mm"/>)xml"));
  expect_near(tower.stiffness(3, 3), 210e9 / 2.6 * pi / 2 * (std::pow(5.0, 4) - std::pow(4.98, 4)),
              1e-7, "tower");
  const Section foil = one_section(
      steel + section(R"xml(<rectangle width="10 mm" height="0.1 mm" material="steel"/>)xml"));
  // Saint-Venant, thin: G b t^3/3 (1 - 0.630 t/b).
  expect_near(foil.stiffness(3, 3), 210e9 / 2.6 * 0.01 * 1e-12 / 3 * (1 - 0.63025 * 1e-2), 1e-5,
              "foil");
}

// A sandwich: foam between skins ten thousand times as stiff. EI by the skins, shear by the core to the first order.
TEST(StatedSections, Sandwich) {
  const Section s = one_section(
      R"xml(<material name="skin" E="70 GPa" nu="0.3" rho="2700"/><material name="foam" E="7 MPa" nu="0.3" rho="50"/>
            <layup name="plate"><ply material="skin" thickness="1 mm"/><ply material="foam" thickness="20 mm"/>
            <ply material="skin" thickness="1 mm"/></layup>)xml" +
      section(R"xml(<rectangle width="50 mm" layup="plate" tolerance="1e-4"/>)xml"));
  const double i = 0.05 * (std::pow(0.022, 3) - std::pow(0.02, 3)) / 12;
  expect_near(s.stiffness(4, 4), 70e9 * i, 3e-3, "EI");
  const double core = 7e6 / 2.6 * 0.05 * 0.021 * 0.021 / 0.02;
  expect_near(s.stiffness(2, 2), core, 3e-2, "GA of the core");
  expect_near((*s.mass)(0, 0), 2700 * 0.05 * 0.002 + 50 * 0.05 * 0.02, 1e-9, "mass");
}

// Steel in psi and inches, as another would write the same tube.
TEST(StatedSections, Inches) {
  const Section s =
      one_section(R"xml(<material name="m" E="30e6 psi" nu="0.29" rho="0.284 lb/in3"/>)xml" +
                  section(R"xml(<tube radius="1 in" material="m" thickness="0.125 in"/>)xml"));
  const double inch = 0.0254, psi = 6894.757293168, r = inch, q = 0.875 * inch;
  expect_near(s.stiffness(0, 0), 30e6 * psi * pi * (r * r - q * q), 1e-8, "EA");
  expect_near((*s.mass)(0, 0), 0.284 * 0.45359237 / std::pow(inch, 3) * pi * (r * r - q * q), 1e-8,
              "mass");
}

// ---- mbd section ------------------------------------------------------------------------------

double renton(double nu, double a, double b) {  // of the force along a, over G A
  double sum = 0.0;
  for (int m = 1; m < 200; ++m) sum += std::tanh(m * pi * a / b) / std::pow(m, 5);
  const double f = nu / (1 + nu);
  return 1.0 / (1.2 + f * f * std::pow(b / a, 4) * (0.2 - 18.0 / std::pow(pi, 5) * b / a * sum));
}

TEST(SectionReport, CentresAndAxes) {
  const Scene scene = read(
      steel +
      section(
          R"xml(<rectangle width="0.06" height="0.02" material="steel" x2="10 mm" x3="-30 mm" turn="30 deg"/>)xml"));
  const SectionReport r = describe_sections(scene).at(0);
  EXPECT_NEAR(r.tension_centre[0], 0.01, 1e-10);
  EXPECT_NEAR(r.tension_centre[1], -0.03, 1e-10);
  EXPECT_NEAR(r.shear_centre[0], 0.01, 1e-7);
  EXPECT_NEAR(r.shear_centre[1], -0.03, 1e-7);
  EXPECT_NEAR((*r.mass_centre)[0], 0.01, 1e-12);
  EXPECT_NEAR((*r.mass_centre)[1], -0.03, 1e-12);
  // Stiffer about what was b3, now 120 degrees from b2, or -60.
  expect_near(r.bending[0], 210e9 * 0.02 * std::pow(0.06, 3) / 12, 1e-8, "stiff");
  expect_near(r.bending[1], 210e9 * 0.06 * std::pow(0.02, 3) / 12, 1e-8, "soft");
  EXPECT_NEAR(r.bending_axis, -60 * degree, 1e-8);
}

TEST(SectionReport, ShearCoefficientsOfRenton) {
  const Scene scene = read(
      steel +
      section(
          R"xml(<rectangle width="0.06" height="0.02" material="steel" tolerance="1e-7"/>)xml"));
  const SectionReport r = describe_sections(scene).at(0);
  ASSERT_TRUE(r.shear_coefficients);
  expect_near((*r.shear_coefficients)[0], renton(0.3, 0.06, 0.02), 1e-6, "along the width");
  expect_near((*r.shear_coefficients)[1], renton(0.3, 0.02, 0.06), 1e-6, "along the height");
  EXPECT_FALSE(
      describe_sections(read(fibre + section(R"xml(<bar radius="0.1" material="ud"/>)xml")))
          .at(0)
          .shear_coefficients);
}

// Thin walls of equal thickness: 3 b^2/(h + 6 b) outside the middle line of the web, b and h of the middle lines.
TEST(SectionReport, ShearCentreOfThinC) {
  const double t = 0.0005, b = 0.05, h = 0.1;
  std::ostringstream c;
  c.precision(12);
  c << "<C width=\"" << b + t / 2 << "\" height=\"" << h + t
    << "\" material=\"steel\" flange_thickness=\"" << t << "\" web_thickness=\"" << t << "\"/>";
  const SectionReport r = describe_sections(read(steel + section(c.str()))).at(0);
  EXPECT_NEAR(r.shear_centre[0] - t / 2, -3 * b * b / (h + 6 * b), 2e-3 * b);
  EXPECT_NEAR(r.shear_centre[1], 0.0, 1e-6);
}

class SectionCommand : public testing::Test {
 protected:
  void SetUp() override {
    test::write_text(model_, "<mbd name=\"m\">\n" + steel + R"xml(
      <section name="tube"><tube radius="0.05" material="steel" thickness="4 mm"/></section>
      <section name="rod"><stiffness EA="1" GA2="2" GA3="3" GJ="4" EI2="5" EI3="6" D16="0.5"/></section>)xml" +
                                 "\n</mbd>\n");
  }
  Output call(const std::string& arguments) const {
    return shell(quote(test::mbd_program) + " section " + arguments);
  }
  const TemporaryDirectory directory_;
  const std::filesystem::path model_ = directory_.path() / "m.xml";
};

TEST_F(SectionCommand, SaysWhatThereIs) {
  const Output all = call(model_.string());
  EXPECT_EQ(all.status, 0) << all.text;
  for (const char* const part :
       {"section \"tube\": tube, ", "m.xml:3", "section \"rod\": matrices, ", "Error of D",
        "tension centre", "shear coefficients", "kg/m", "elements of order"})
    EXPECT_NE(all.text.find(part), std::string::npos) << part << "\n" << all.text;
  const Output one = call(model_.string() + " rod --json");
  EXPECT_EQ(one.status, 0);
  const auto json = nlohmann::json::parse(one.text);
  ASSERT_EQ(json.size(), 1u);
  EXPECT_EQ(json[0]["D"][0][5], 0.5);
  EXPECT_EQ(json[0]["D"][5][5], 6.0);
  EXPECT_FALSE(json[0].contains("mesh"));
  // An axial force at x2 = -D16/EA: -0.5/1.
  EXPECT_NEAR(json[0]["tension_centre"][0].get<double>(), -0.5, 1e-12);
}

TEST_F(SectionCommand, WritesCsv) {
  const std::filesystem::path file = directory_.path() / "out.csv";
  const Output run = call(model_.string() + " --out " + file.string() + " rod");
  EXPECT_EQ(run.status, 0) << run.text;
  const std::string text = test::read_text(file);
  EXPECT_TRUE(text.starts_with("section,at,matrix,row,1,2,3,4,5,6\nrod,,D,1,1,0,0,0,0,0.5\n"))
      << text;
}

TEST_F(SectionCommand, RefusesWrongUse) {
  const Output name = call(model_.string() + " tubes");
  EXPECT_EQ(name.status, 1);
  EXPECT_NE(name.text.find("there is no section \"tubes\"; did you mean \"tube\""),
            std::string::npos)
      << name.text;
  EXPECT_GE(call("").status, 100);
  EXPECT_GE(call(model_.string() + " tube rod").status, 100);
  EXPECT_EQ(call((directory_.path() / "none.xml").string()).status, 1);
  EXPECT_EQ(call(model_.string() + " --out " + directory_.path().string()).status, 1);
  test::write_text(directory_.path() / "empty.xml", "<mbd name=\"m\"/>\n");
  const Output empty = call((directory_.path() / "empty.xml").string());
  EXPECT_EQ(empty.status, 1);
  EXPECT_NE(empty.text.find("the model has no <section>"), std::string::npos) << empty.text;
}

// ---- the models -------------------------------------------------------------------------------

TEST(StatedModels, TubeHasThePaperDigits) {
  const Section s = model_scene("shaft_tube").sections.at(0);
  const Mat6& d = s.stiffness;
  // /1e5, to the last digit of these numbers.
  EXPECT_NEAR(d(0, 0) / 1e5, 1254.407, 6e-4);
  EXPECT_NEAR(d(1, 1) / 1e5, 162.2863, 6e-5);
  EXPECT_NEAR(d(0, 3) / 1e5, .1565394, 3e-7);
  EXPECT_NEAR(d(1, 4) / 1e5, -.06481396, 3e-8);
  EXPECT_NEAR(d(3, 3) / 1e5, .7473838, 6e-7);
  EXPECT_NEAR(d(4, 4) / 1e5, 1.448911, 6e-7);
  EXPECT_NEAR((*s.mass)(0, 0), 1.930195, 6e-7);
  EXPECT_NEAR((*s.mass)(3, 3), 4.454889e-3, 6e-10);
  // As the paper's text has it.
  const Mat6 literal = model_scene("shaft_tube", {{"GLT", "4.17 GPa"}, {"second", "45 deg"}})
                           .sections.at(0)
                           .stiffness;
  EXPECT_NEAR(literal(1, 1) / 1e5, 66.72583, 6e-5);
  EXPECT_NEAR(literal(0, 3) / 1e5, -3.066570, 3e-6);
}

// The motion differs from that of the printed D as D does: half way from one D to the other it is half way, and it is
// no more than what 1/(1 - 0.8^2) makes of the change of bending, which is the largest that matters.
TEST(StatedModels, ShaftMovesAsItsDifferenceOfD) {
  const auto motion = [](const Mat6& D, const Mat6& M) {
    Scene scene = model_scene("shaft");
    scene.transient->duration = 0.5;
    scene.sections[0].stiffness = D;
    scene.sections[0].mass = M;
    const History h = run_to_table(scene);
    EXPECT_TRUE(h.report.complete()) << h.report.failure;
    return h.table;
  };
  const Section printed = model_scene("shaft").sections[0],
                found = model_scene("shaft_tube").sections[0];
  const Table a = motion(printed.stiffness, *printed.mass);
  const Table b =
      motion(0.5 * (printed.stiffness + found.stiffness), 0.5 * (*printed.mass + *found.mass));
  Scene stated = model_scene("shaft_tube");
  stated.transient->duration = 0.5;
  const Table c = run_to_table(stated).table;
  double whole = 0.0, bent = 0.0, size = 0.0;
  ASSERT_EQ(a.rows(), c.rows());
  for (std::size_t k = 0; k < a.rows(); ++k)
    for (const char* const u : {"M.displacement.2", "M.displacement.3"}) {
      whole = std::max(whole, std::abs(c[u][k] - a[u][k]));
      bent = std::max(bent, std::abs(c[u][k] - 2 * b[u][k] + a[u][k]));
      size = std::max(size, std::abs(a[u][k]));
    }
  const double change = difference(found.stiffness, printed.stiffness);
  EXPECT_GT(change, 1e-5);
  EXPECT_LT(change, 4e-4);
  EXPECT_LT(whole, 3 * change * size) << whole << " " << change << " " << size;
  EXPECT_GT(whole, 1e-3 * change * size);
  EXPECT_LT(bent, 1e-2 * whole);
}

// Forces that a misfit makes are in proportion to D where all of it changes alike; here they lie between the least and the
// most that a part of it changes.
TEST(StatedModels, FourBarMovesAsItsDifferenceOfD) {
  const Scene printed = model_scene("four_bar");
  Scene stated = model_scene("four_bar_boxes", {{"tolerance", "1e-4"}});
  const Mat6 &p = printed.sections[0].stiffness, &d = stated.sections[0].stiffness;
  EXPECT_NEAR(d(0, 0) / 10660.1e3, 1.0, 1e-4);
  EXPECT_NEAR(d(1, 1) / 2516.5e3, 1.0, 1e-4);
  EXPECT_NEAR(d(3, 3) / .24455e3, 1.0, 1e-4);
  // Of half the size: a quarter and a sixteenth.
  EXPECT_NEAR(stated.sections[1].stiffness(0, 0) / d(0, 0), 0.25, 1e-6);
  EXPECT_NEAR(stated.sections[1].stiffness(4, 4) / d(4, 4), 0.0625, 1e-6);
  const double least = std::min({d(3, 3) / p(3, 3), d(4, 4) / p(4, 4), d(2, 2) / p(2, 2)});
  stated.transient->duration = 3.006;
  Scene with_d = printed;
  with_d.transient->duration = 3.006;
  const Table a = run_to_table(with_d).table, c = run_to_table(stated).table;
  const double ratio = c["M.moment.2"].back() / a["M.moment.2"].back();
  EXPECT_LT(ratio, 1.0);
  EXPECT_GT(ratio, least - 1e-3);
  EXPECT_NE(ratio, 1.0);
  EXPECT_NEAR(c["C.displacement.3"].back() / a["C.displacement.3"].back(), 1.0, 1.0 - least);
}

}  // namespace
}  // namespace mbd::test::test_stated_sections
