// The format of model files beyond elements and attributes: units, includes, defaults, versions.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "libmbd/language/reader.hpp"
#include "libmbd/language/units.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_format {
namespace {

namespace fs = std::filesystem;
constexpr double pi = std::numbers::pi;

using test::message;
using test::read;

// ---- units ------------------------------------------------------------------------------------

TEST(Units, Factors) {
  EXPECT_EQ(unit_factor("mm", "m"), 1e-3);
  EXPECT_EQ(unit_factor("kN", "N"), 1e3);
  EXPECT_EQ(unit_factor("deg", "rad"), pi / 180.0);
  EXPECT_EQ(unit_factor("°", "rad"), pi / 180.0);
  EXPECT_DOUBLE_EQ(unit_factor("rpm", "rad/s"), pi / 30.0);
  EXPECT_DOUBLE_EQ(unit_factor("rev/min", "rad/s"), pi / 30.0);
  EXPECT_DOUBLE_EQ(unit_factor("deg/s", "rad/s"), pi / 180.0);
  EXPECT_DOUBLE_EQ(unit_factor("N.mm2", "N.m2"), 1e-6);
  EXPECT_DOUBLE_EQ(unit_factor("kg/mm", "kg/m"), 1e3);
  EXPECT_DOUBLE_EQ(unit_factor("lbf", "N"), 4.4482216152605);  // by definition
  EXPECT_DOUBLE_EQ(unit_factor("in", "m"), 0.0254);            // by definition
  EXPECT_DOUBLE_EQ(unit_factor("m/s^2", "m/s2"), 1.0);
  EXPECT_DOUBLE_EQ(unit_factor("min", "s"), 60.0);
  EXPECT_DOUBLE_EQ(unit_factor("kN.m", any_unit), 1e3);
  EXPECT_DOUBLE_EQ(unit_factor("rpm", any_unit), pi / 30.0);
  EXPECT_DOUBLE_EQ(unit_factor("kg.m2", "kg.m2"), 1.0);
}

std::string refusal(std::string_view unit, std::string_view wanted) {
  try {
    unit_factor(unit, wanted);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Units, Refusals) {
  EXPECT_SAYS(refusal("mm", "rad"), "is of another quantity; give the number in rad");
  EXPECT_SAYS(refusal("deg", "m"), "is of another quantity");
  EXPECT_SAYS(refusal("Hz", "rad/s"), "is of another quantity");  // 50 Hz are 100 pi rad/s
  EXPECT_SAYS(refusal("1/s", "rad/s"), "is of another quantity");
  EXPECT_SAYS(refusal("rad/s", "1/s"), "is of another quantity");
  EXPECT_SAYS(refusal("deg", pure_number), "a pure number; leave out the unit");
  EXPECT_SAYS(refusal("Nm", "N.m"), "there is no unit \"Nm\"; did you mean \"N.m\"?");
  EXPECT_SAYS(refusal("celsius", any_unit), "has a zero of its own");
  EXPECT_SAYS(refusal("seconds since 1970-01-01", any_unit), "no multiple");
}

TEST(Units, TellUnitsFromExpressions) {
  const auto split = [](std::string_view text) {
    const NumberAndUnit parts = split_unit(text);
    return std::string(parts.number) + "|" + std::string(parts.unit);
  };
  EXPECT_EQ(split("12 mm"), "12|mm");
  EXPECT_EQ(split(" 12  mm "), "12|mm");
  EXPECT_EQ(split("12mm"), "12|mm");
  EXPECT_EQ(split("-1.5e3kN"), "-1.5e3|kN");
  EXPECT_EQ(split("2*L mm"), "2*L|mm");
  EXPECT_EQ(split("t < 1 ? 2 : 3 N.m"), "t < 1 ? 2 : 3|N.m");
  EXPECT_EQ(split("5 °"), "5|°");
  for (const char* const whole : {"2 * L", "1e3", "L", "t<1 ? 2 : L", "sin (x)", "max(a, b)",
                                  "a && b", "(2) - m", "1e-3", "x1", ""})
    EXPECT_EQ(split(whole), std::string(whole) + "|");
}

TEST(Units, InEveryKindOfNumber) {
  const Scene scene = read(R"xml(
    <parameter name="L" value="12 mm"/>
    <parameter name="speed" value="60rpm"/>
    <section name="s"><stiffness EA="1 MN" GA2="2000 N" GA3="3" GJ="4 kN.mm2" EI2="5" EI3="6" D14="7 N.mm"/>
      <mass per_length="2 g/mm" inertia="1 2 3 kg.mm" center="1 2 mm"/></section>
    <beam name="bar" section="s" from="0 0 0" to="0 120 3*4 mm" normal="0 0 1"/>
    <arc name="bow" section="s" from="0 1mm 2" center="1 0 0" axis="0 0 1" angle="90 deg" normal="0 0 1"/>
    <body name="b" at="1in 0 0" orientation="0 0 90 deg" mass="2 t" inertia="1 1 1 g.mm2"
          angular_velocity="0 0 60 rpm"/>
    <revolute name="A" between="ground bar.start" axis="1 0 0"/>
    <drive joint="A" angle="5 - 5*cos(t) deg"/>
    <load at="bar.end" force="0 -10*t t&lt;1?1:2 kN" moment="1kN.m 0 2"/>
    <distributed beam="bar" force="0 0 s*t N/mm"/>
    <gravity acceleration="0 0 -1 gravity"/>
    <transient duration="2 min" step="5 ms"/>
    <expect quantity="q" at="100 ms" value="3 mm" tolerance="1 um" source="s"/>)xml");
  EXPECT_EQ(scene.parameters[0].second, 12 * 1e-3);
  EXPECT_DOUBLE_EQ(scene.parameters[1].second, 2 * pi);
  const Mat6& D = scene.sections[0].stiffness;
  EXPECT_EQ(D(0, 0), 1e6);
  EXPECT_EQ(D(1, 1), 2000.0);
  EXPECT_EQ(D(2, 2), 3.0);
  EXPECT_DOUBLE_EQ(D(3, 3), 4e-3);
  EXPECT_DOUBLE_EQ(D(0, 3), 7e-3);
  const Mat6& M = *scene.sections[0].mass;
  EXPECT_DOUBLE_EQ(M(0, 0), 2.0);
  EXPECT_DOUBLE_EQ(M(4, 4), 2e-3);
  EXPECT_DOUBLE_EQ(M(5, 0), -2e-3);  // m c~ of the centre (0, 1, 2) mm
  const auto& line = std::get<Straight>(scene.beams[0].line);
  EXPECT_DOUBLE_EQ(line.to(1), 0.12);
  EXPECT_DOUBLE_EQ(line.to(2), 12e-3);  // the unit is of all components
  const auto& arc = std::get<Arc>(scene.beams[1].line);
  EXPECT_DOUBLE_EQ(arc.from(1), 1e-3);
  EXPECT_EQ(arc.from(2), 2.0);
  EXPECT_DOUBLE_EQ(arc.angle, pi / 2);
  const BodyScene& body = scene.bodies[0];
  EXPECT_DOUBLE_EQ(body.at(0), 0.0254);
  EXPECT_LT((body.orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(body.mass, 2000.0);
  EXPECT_DOUBLE_EQ(body.inertia(0, 0), 1e-9);
  EXPECT_DOUBLE_EQ(body.angular_velocity(2), 2 * pi);
  EXPECT_NEAR((*scene.drives[0].angle)(2.0).v, (5 - 5 * std::cos(2.0)) * pi / 180, 1e-16);
  const auto& force = *scene.loads[0].force;
  EXPECT_DOUBLE_EQ(force[1](3.0).v, -3e4);
  EXPECT_DOUBLE_EQ(force[2](0.5).v, 1e3);
  EXPECT_DOUBLE_EQ(force[2](1.5).v, 2e3);
  ASSERT_EQ(force[2].breakpoints().size(), 1u);
  EXPECT_EQ(force[2].breakpoints()[0], 1.0);  // of time: not scaled
  EXPECT_DOUBLE_EQ((*scene.loads[0].moment)[0].value(), 1e3);
  EXPECT_EQ((*scene.loads[0].moment)[2].value(), 2.0);
  EXPECT_DOUBLE_EQ((*scene.distributed_loads[0].force)[2].at(0.5)(3.0).v, 1500.0);
  EXPECT_EQ(scene.gravity->acceleration(2), -9.80665);
  EXPECT_EQ(scene.transient->duration, 120.0);
  EXPECT_EQ(scene.transient->step, 5 * 1e-3);
  EXPECT_DOUBLE_EQ(scene.expects[0].at, 0.1);
  EXPECT_DOUBLE_EQ(scene.expects[0].value, 3e-3);
  EXPECT_EQ(read("<parameter name=\"a\" value=\"1\"/>", {{"a", "2 ms"}}).parameters[0].second,
            2 * 1e-3);
}

TEST(Units, WrongOnesInAModel) {
  EXPECT_SAYS(
      message("<transient duration=\"1\" step=\"5 mm\"/>"),
      "test.xml:2: transient: step=\"5 mm\": the unit \"mm\" is of another quantity; give the "
      "number in s or a multiple of it");
  EXPECT_SAYS(message("<transient duration=\"1\" step=\"5 sekunden\"/>"),
              "there is no unit \"sekunden\"");
  EXPECT_SAYS(message("<transient duration=\"1\" step=\"1 s\" rho_infinity=\"0.9 s\"/>"),
              "a pure number; leave out the unit");
  EXPECT_SAYS(message("<gravity acceleration=\"0 0 -9.8 m/s\"/>"), "is of another quantity");
  EXPECT_SAYS(message("<gravity acceleration=\"0 0 -9.8m/s2 m/s2\"/>"), "leave one of them out");
  EXPECT_SAYS(message("<gravity acceleration=\"0 0 m -9.8 m/s2\"/>"),
              "has 4 components and \"m/s2\", must have 3");
  EXPECT_SAYS(message("<body name=\"b\" mass=\"1\" inertia=\"1 1 1\" orientation=\"0 0 90 mm\"/>"),
              "give the number in rad");
  // a missing * is not taken for litres
  EXPECT_SAYS(message("<parameter name=\"L\" value=\"1\"/><parameter name=\"a\" value=\"2 L\"/>"),
              "\"L\" is a parameter and may be a unit: write a product with *");
}

// A parameter that has a unit is a number in SI units from then on.
TEST(Units, OfParametersAreConvertedOnce) {
  const std::string L = "<parameter name=\"L\" value=\"6000 mm\"/>";
  EXPECT_EQ(read(L + "<gravity acceleration=\"L 0 2*L\"/>").gravity->acceleration, Vec3(6, 0, 12));
  EXPECT_SAYS(message(L + "<gravity acceleration=\"0 0 2*L m/s2\"/>"),
              "\"L\" was given in mm and is in SI units now; leave out the unit \"m/s2\" here");
  EXPECT_SAYS(
      message(
          L +
          "<parameter name=\"w\" value=\"60 rpm\"/><transient duration=\"1\" step=\"2*w ms\"/>"),
      "\"w\" was given in rpm");
  EXPECT_SAYS(message(L + "<load at=\"b\" force=\"0 0 t*L kN\"/>"), "\"L\" was given in mm");
  EXPECT_SAYS(message(L + "<distributed beam=\"b\" force=\"0 0 s*L kN/m\"/>"),
              "\"L\" was given in mm");
  EXPECT_EQ(
      message(L + "<parameter name=\"L2\" value=\"2\"/><gravity acceleration=\"0 0 L2 m/s2\"/>"),
      "no error");
  const std::string derived = L + "<parameter name=\"M\" value=\"2*L\"/>";
  EXPECT_SAYS(message(derived + "<gravity acceleration=\"0 0 M m/s2\"/>"), "\"M\" was given in mm");
  EXPECT_SAYS(message("<parameter name=\"a\" value=\"6\"/><gravity acceleration=\"0 0 a m/s2\"/>",
                      {{"a", "6 m/s2"}}),
              "\"a\" was given in m/s2");
  for (const char* const slip : {"1.5d3", "1.5d", "2 e", "3 a", "2 L", "50 hertz", "50 Bq"})
    EXPECT_SAYS(message("<parameter name=\"x\" value=\"" + std::string(slip) + "\"/>"),
                "is none of the usual ones");
  for (const char* const usual :
       {"5 mm", "5 N.mm2", "5 kg/m3", "5 s-1", "5 rev/min", "5 m/s^2", "5 GPa"})
    EXPECT_EQ(message("<parameter name=\"x\" value=\"" + std::string(usual) + "\"/>"), "no error");
  EXPECT_EQ(
      read(
          "<parameter name=\"h\" value=\"9 mm\"/><expect quantity=\"q\" of=\"minimum\" value=\"1\" "
          "tolerance=\"1\" source=\"s\" when=\"h=9mm\"/><expect quantity=\"q\" of=\"minimum\" "
          "value=\"1\" tolerance=\"1\" source=\"s\" when=\"h=0.009\"/>")
          .expects.size(),
      2u);
  EXPECT_EQ(read(L, {{"L", "5 m"}}).parameters[0].second, 5.0);
  EXPECT_SAYS(
      message(L, {{"L", "5000"}}),
      "--set L=5000: a unit is missing: the model gives L in mm; write --set L=\"5000 mm\"");
  EXPECT_SAYS(message(L, {{"L", "5 kN"}}), "is of another quantity; give the number in mm");
  EXPECT_SAYS(message("<parameter name=\"f\" value=\"1 Hz\"/>"), "is none of the usual ones");
  EXPECT_SAYS(message("<gravity acceleration=\"-9.8 m/s2\"/>"),
              "has 1 component and \"m/s2\", must have 3");
}

TEST(Reader, KnowsUsualWords) {
  EXPECT_SAYS(message("<clamp name=\"c\"/>"), "unknown element <clamp>; write <fixed");
  EXPECT_SAYS(message("<body name=\"b\" mass=\"1\" inertia=\"1 1 1\"/>"
                      "<record name=\"r\" at=\"b\" quantities=\"deflection\"/>"),
              "unknown quantity \"deflection\"; write displacement");
}

// ---- includes ---------------------------------------------------------------------------------

class Includes : public testing::Test {
 protected:
  Includes() { fs::create_directories(dir_ / "parts"); }
  void write(const std::string& name, const std::string& inside) const {
    std::ofstream(dir_ / name) << "<mbd name=\"part\">\n" << inside << "\n</mbd>\n";
  }
  std::string read_message(const std::string& name, const Overrides& overrides = {}) const {
    try {
      check_scene(read_model(dir_ / name, overrides));
    } catch (const Error& error) {
      std::string text = error.what();  // names of files without the directory
      for (std::size_t at; (at = text.find(dir_.string() + "/")) != std::string::npos;)
        text.erase(at, dir_.string().size() + 1);
      return text;
    }
    return "no error";
  }
  const TemporaryDirectory scratch_;
  const fs::path dir_ = scratch_.path();
};

TEST_F(Includes, AreReadInPlace) {
  write("main.xml", R"xml(<parameter name="L" value="2"/>
    <include file="parts/ball.xml"/>
    <body name="second" mass="L*m" inertia="1 1 1"/>)xml");
  write("parts/ball.xml", R"xml(<parameter name="m" value="3*L"/>
    <include file="more.xml"/>
    <body name="first" mass="m" inertia="1 1 1"/>)xml");
  write("parts/more.xml", R"xml(<body name="zeroth" mass="1" inertia="1 1 1"/>)xml");
  const Scene scene = read_model(dir_ / "main.xml");
  EXPECT_EQ(scene.name, "part");
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[0].name, "zeroth");
  EXPECT_EQ(scene.bodies[0].source.file, (dir_ / "parts/more.xml").string());
  EXPECT_EQ(scene.bodies[0].source.line, 2);
  EXPECT_EQ(scene.bodies[1].mass, 6.0);
  EXPECT_EQ(scene.bodies[2].mass, 12.0);
  EXPECT_EQ(read_model(dir_ / "main.xml", {{"m", "5"}}).bodies[1].mass, 5.0);
}

TEST_F(Includes, Refusals) {
  write("self.xml", "<include file=\"self.xml\"/>");
  EXPECT_EQ(
      read_message("self.xml"),
      "self.xml:2: include: file=\"self.xml\": a circle: self.xml includes self.xml; put what both "
      "need into a third file");
  write("a.xml", "\n<include file=\"parts/b.xml\"/>");
  write("parts/b.xml", "<include file=\"../a.xml\"/>");
  EXPECT_SAYS(
      read_message("a.xml"),
      "parts/b.xml:2: include: file=\"../a.xml\": a circle: a.xml includes b.xml includes a.xml");
  write("none.xml", "<include file=\"nowhere.xml\"/>");
  EXPECT_SAYS(
      read_message("none.xml"),
      "none.xml:2: include: file=\"nowhere.xml\": no such file: nowhere.xml; give its name");
  write("broken.xml", "<include file=\"parts/bad.xml\"/>");
  std::ofstream(dir_ / "parts/bad.xml") << "<mbd name=\"x\">\n<body></mbd>";
  EXPECT_SAYS(read_message("broken.xml"), "parts/bad.xml:2: not well-formed XML");
  write("twice.xml", "<include file=\"parts/c.xml\"/><include file=\"parts/c.xml\"/>");
  write("parts/c.xml", "<body name=\"b\" mass=\"1\" inertia=\"1 1 1\"/>");
  EXPECT_SAYS(read_message("twice.xml"), "the name \"b\" is taken (line 2)");
  write("once.xml",
        "<include file=\"parts/c.xml\"/>\n<body name=\"b\" mass=\"1\" inertia=\"1 1 1\"/>");
  EXPECT_SAYS(read_message("once.xml"),
              "once.xml:3: body \"b\": the name \"b\" is taken (parts/c.xml:2)");
  EXPECT_SAYS(message("<repeat count=\"1\"><include file=\"x\"/></repeat>"),
              "<include> cannot stand in <repeat>");
  EXPECT_SAYS(read_message("a.xml", {{"x", "1"}, {"x", "2"}}), "set twice");
}

// ---- defaults ---------------------------------------------------------------------------------

TEST(Defaults, AreWhatElementsLeaveOut) {
  const Scene scene = read(R"xml(
    <parameter name="N" value="4"/>
    <defaults>
      <beam section="s" normal="0 0 1" order="N" metric="quaternion"/>
      <record quantities="displacement"/>
    </defaults>
    <beam name="a" from="0 0 0" to="1 0 0"/>
    <beam name="b" from="0 0 0" to="1 0 0" order="2"/>
    <defaults><beam order="5"/></defaults>
    <beam name="c" from="0 0 0" to="1 0 0"/>
    <record name="r" at="a.end"/>)xml");
  ASSERT_EQ(scene.beams.size(), 3u);
  EXPECT_EQ(scene.beams[0].order, 4);
  EXPECT_EQ(scene.beams[0].section, "s");
  EXPECT_EQ(scene.beams[0].metric, Metric::quaternion);
  EXPECT_EQ(scene.beams[1].order, 2);
  EXPECT_EQ(scene.beams[2].order, 5);
  EXPECT_EQ(scene.beams[2].metric, Metric::quaternion);
  EXPECT_EQ(scene.records[0].quantities, (std::vector<std::string>{"displacement"}));
}

TEST(Defaults, Refusals) {
  EXPECT_SAYS(message("<defaults><beam ordr=\"3\"/></defaults>"),
              "beam: unknown attribute \"ordr\"; did you mean \"order\"?");
  EXPECT_SAYS(message("<defaults><beam name=\"b\"/></defaults>"), "in <defaults> there is no name");
  EXPECT_SAYS(message("<defaults><curve><point at=\"0 0 0\"/></curve></defaults>"),
              "an element has attributes only");
  EXPECT_SAYS(message("<defaults><beam from=\"0 0 0\"/></defaults>"),
              "beam: from does not belong in <defaults>");
  EXPECT_SAYS(message("<defaults><parameter value=\"1\"/></defaults>"),
              "<parameter> cannot stand in <defaults>");
  EXPECT_SAYS(message("<defaults><repeat count=\"1\"/></defaults>"),
              "<repeat> cannot stand in <defaults>");
  // used or not
  EXPECT_SAYS(message("<defaults>\n<static steps=\"0\"/></defaults>"),
              "test.xml:3: static: steps is 0, must lie between");
}

// ---- version ----------------------------------------------------------------------------------

std::string with_version(const std::string& version) {
  try {
    read_model_text("<mbd\n version=\"" + version + "\" name=\"m\"><future/></mbd>", "test.xml");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Version, NewerIsRefusedBeforeAnythingElse) {
  EXPECT_SAYS(with_version("1"), "unknown element <future>");
  EXPECT_EQ(with_version("2"),
            "test.xml:2: mbd \"m\": version=\"2\": the file is of a newer format than this mbd "
            "reads, which "
            "is 1; get a newer mbd");
  EXPECT_SAYS(with_version("one"), "must be a whole number; the newest is 1");
  EXPECT_SAYS(with_version("0"), "must be a whole number; the newest is 1");
  EXPECT_SAYS(with_version("1.5"), "must be a whole number");
  EXPECT_EQ(
      read_model_text("<mbd name=\"m\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
                      "xsi:noNamespaceSchemaLocation=\"mbd.xsd\"/>")
          .name,
      "m");
}

}  // namespace
}  // namespace mbd::test::test_format
