// The reader: what a model says arrives in the Scene; what it should not say is refused with file, line,
// item, what is wrong and what to do. The schema agrees with the scene's own defaults.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "libmbd/language/reader.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/text/spelling.hpp"
#include "tests/support/read_text.hpp"

namespace mbd::test::test_reader {
namespace {

using test::message;
using test::read;

std::string message_of_text(const std::string& text) {
  try {
    read_model_text(text, "test.xml");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

const std::string steel =
    "<section name=\"s\"><stiffness EA=\"1\" GA2=\"2\" GA3=\"3\" GJ=\"4\" EI2=\"5\" "
    "EI3=\"6\"/></section>";
const std::string bar =
    "<beam name=\"bar\" section=\"s\" from=\"0 0 0\" to=\"1 0 0\" normal=\"0 0 1\"/>";
const std::string ball = "<body name=\"ball\" mass=\"1\" inertia=\"1 1 1\"/>";

// ---- good models ------------------------------------------------------------------------------

TEST(Reader, ReadsEveryElement) {
  const Scene scene = read(R"xml(
    <parameter name="L" value="2"/>
    <parameter name="tilt" value="5*deg"/>
    <section name="s">
      <stiffness EA="1" GA2="2" GA3="3" GJ="4" EI2="5" EI3="6" D14="0.5" D56="-0.25"/>
      <mass per_length="2" inertia="3 1 2" center="0.1 0.2"/>
    </section>
    <beam name="bar" section="s" from="0 0 0" to="L 0 L/2" normal="0 0 1" elements="4" order="5"
          metric="quaternion" rule="gauss_lobatto" form="paper"/>
    <arc name="bow" section="s" from="0 0 0" center="1 0 0" axis="0 0 -1" angle="pi/4" normal="0 0 1"/>
    <body name="top" at="0 1 0" orientation="0 0 pi/2" mass="15" center="0 0 0.5" inertia="1 2 3 .1 .2 .3"
          velocity="1 2 3" angular_velocity="0 0 tilt"/>
    <body name="disk" attached_to="bar@L/4" mass="4" inertia="1 1 1"/>
    <revolute name="A" between="ground bar.start" axis="sin(tilt) 0 cos(tilt)"/>
    <spherical name="B" between="bar.end top" at="1 2 3"/>
    <drive joint="A" rate="t > 1 ? 2 : 2*t"/>
    <load name="push" at="bar@0.5" force="0 t 1" moment="0 0 sin(t)"/>
    <gravity acceleration="0 0 -9.8"/>
    <static steps="3" tolerance="1e-11"/>
    <transient duration="2" step="1e-3" rho_infinity="0.8" newton_tolerance="1e-9"/>
    <record name="end" at="bar.end" quantities="position force"/>
    <record name="joint" joint="A" quantities="angle rate"/>
    <plot x="joint.angle" y="end.position.1 end.position.2" y_scale="1e3" x_range="0 2*pi" title="T"/>
    <expect quantity="end.position.1" at="L" value="1/3" tolerance="1e-6" source="calc"/>
    <expect quantity="end.position.1" of="maximum" value="1" tolerance="1e-6" source="calc"/>)xml");

  EXPECT_EQ(scene.name, "test");
  EXPECT_EQ(scene.file, "test.xml");
  ASSERT_EQ(scene.parameters.size(), 2u);
  ASSERT_EQ(scene.sections.size(), 1u);
  EXPECT_EQ(scene.sections[0].source.line, 5);
  const Mat6& D = scene.sections[0].stiffness;
  EXPECT_EQ(D(0, 0), 1.0);
  EXPECT_EQ(D(5, 5), 6.0);
  EXPECT_EQ(D(0, 3), 0.5);
  EXPECT_EQ(D(3, 0), 0.5);
  EXPECT_EQ(D(5, 4), -0.25);

  ASSERT_EQ(scene.beams.size(), 2u);
  const BeamScene& beam = scene.beams[0];
  EXPECT_EQ(std::get<Straight>(beam.line).to, Vec3(2, 0, 1));
  EXPECT_EQ(beam.elements, 4);
  EXPECT_EQ(beam.order, 5);
  EXPECT_EQ(beam.metric, Metric::quaternion);
  EXPECT_EQ(beam.rule, Rule::gauss_lobatto);
  EXPECT_EQ(beam.form, Form::paper);
  EXPECT_DOUBLE_EQ(std::get<Arc>(scene.beams[1].line).angle, std::acos(-1.0) / 4);

  ASSERT_EQ(scene.bodies.size(), 2u);
  const BodyScene& top = scene.bodies[0];
  EXPECT_LT((top.orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(top.inertia(0, 1), 0.1);
  EXPECT_EQ(top.inertia(2, 0), 0.2);
  EXPECT_EQ(top.inertia(1, 2), 0.3);
  EXPECT_FALSE(top.attached_to);
  ASSERT_TRUE(scene.bodies[1].attached_to);
  EXPECT_EQ(scene.bodies[1].attached_to->kind, Place::Kind::beam);
  EXPECT_EQ(scene.bodies[1].attached_to->parameter, 0.5);

  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_EQ(scene.joints[0].kind, "revolute");
  EXPECT_EQ(scene.joints[0].a.kind, Place::Kind::ground);
  EXPECT_EQ(scene.joints[0].b.name, "bar");
  EXPECT_EQ(scene.joints[0].b.parameter, 0.0);
  EXPECT_DOUBLE_EQ((*scene.joints[0].axis)(0), std::sin(std::acos(-1.0) / 36));
  EXPECT_FALSE(scene.joints[0].at);
  EXPECT_EQ(scene.joints[1].a.parameter, 1.0);
  EXPECT_EQ(scene.joints[1].b.kind, Place::Kind::body);
  EXPECT_FALSE(scene.joints[1].axis);

  ASSERT_TRUE(scene.drives.at(0).rate);
  EXPECT_EQ((*scene.drives[0].rate)(0.5).v, 1.0);
  EXPECT_EQ((*scene.loads.at(0).force)[1](3.0).v, 3.0);
  EXPECT_EQ(scene.gravity->acceleration, Vec3(0, 0, -9.8));
  EXPECT_EQ(scene.statics->steps, 3);
  EXPECT_EQ(scene.transient->rho_infinity, 0.8);
  EXPECT_EQ(*scene.transient->newton_tolerance, 1e-9);
  EXPECT_EQ(scene.records.at(1).quantities, (std::vector<std::string>{"angle", "rate"}));
  EXPECT_EQ(scene.plots.at(0).y.size(), 2u);
  EXPECT_EQ(scene.expects.at(0).at, 2.0);
  EXPECT_EQ(scene.expects.at(1).of, ExpectScene::Of::maximum);
}

TEST(Reader, DefaultsAreThoseOfTheScene) {
  const Scene scene = read(steel + bar + ball + "<static/><transient duration=\"1\" step=\"1\"/>" +
                           "<record name=\"r\" at=\"ball\" quantities=\"position\"/>" +
                           "<plot y=\"r.position.1\"/>");
  const BeamScene beam;
  EXPECT_EQ(scene.beams[0].elements, beam.elements);
  EXPECT_EQ(scene.beams[0].order, beam.order);
  EXPECT_EQ(scene.beams[0].metric, beam.metric);
  EXPECT_EQ(scene.beams[0].rule, beam.rule);
  EXPECT_EQ(scene.beams[0].form, beam.form);
  const BodyScene body;
  EXPECT_EQ(scene.bodies[0].at, body.at);
  EXPECT_EQ(scene.bodies[0].center, body.center);
  EXPECT_EQ(scene.bodies[0].orientation, body.orientation);
  EXPECT_EQ(scene.statics->steps, StaticScene().steps);
  EXPECT_EQ(scene.statics->tolerance, StaticScene().tolerance);
  EXPECT_EQ(scene.transient->rho_infinity, TransientScene().rho_infinity);
  EXPECT_EQ(scene.transient->tolerance, TransientScene().tolerance);
  EXPECT_EQ(scene.transient->method, TransientScene().method);
  EXPECT_EQ(scene.transient->output, TransientScene().output);
  EXPECT_EQ(scene.plots[0].x, PlotScene().x);
  EXPECT_EQ(scene.plots[0].x_scale, PlotScene().x_scale);
}

TEST(Reader, StiffnessAsThirtySixNumbers) {
  const Scene scene = read(R"xml(
    <parameter name="f" value="1e5"/>
    <section name="s"><stiffness>
      1254*f  0 0 .1565*f 0 0
      0 162.3*f 0 0 -.06481*f 0    <!-- comments are skipped -->
      0 0 162.3*f 0 0 -.06481*f
      .1565*f 0 0 .7474*f 0 0
      0 -.06481*f 0 0 1.449*f 0
      0 0 -.06481*f 0 0 1.449*f </stiffness></section>)xml");
  EXPECT_EQ(scene.sections[0].stiffness(0, 3), .1565 * 1e5);
  EXPECT_EQ(scene.sections[0].stiffness(5, 2), -.06481 * 1e5);
  EXPECT_FALSE(scene.sections[0].mass);
}

// Kinetic energy per length of a section moving with [v; w]: m |v + w x c|^2 / 2 for a point mass.
TEST(Reader, SectionMassIsThatOfItsPoints) {
  const double m = 2.0, x2 = 0.1, x3 = -0.2;
  const Vec3 c(0, x2, x3);
  const Mat3 J = m * (c.squaredNorm() * Mat3::Identity() - c * c.transpose());
  char mass[200];
  std::snprintf(mass, sizeof mass,
                "<mass per_length=\"2\" center=\"0.1 -0.2\" inertia=\"%.17g %.17g %.17g %.17g "
                "%.17g %.17g\"/>",
                J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(0, 2), J(1, 2));
  const Scene scene = read(
      "<section name=\"s\"><stiffness EA=\"1\" GA2=\"2\" GA3=\"3\" GJ=\"4\" EI2=\"5\" EI3=\"6\"/>" +
      std::string(mass) + "</section>");
  const Mat6& M = *scene.sections[0].mass;
  Vec6 V;
  V << 0.3, -1.2, 0.7, 2.1, -0.4, 1.3;
  const Vec3 velocity = V.head<3>() + Vec3(V.tail<3>()).cross(c);
  EXPECT_NEAR(0.5 * V.dot(M * V), 0.5 * m * velocity.squaredNorm(), 1e-14);
  EXPECT_EQ(M, Mat6(M.transpose()));
}

TEST(Reader, SetReplacesParametersBeforeOthersUseThem) {
  const std::string model =
      "<parameter name=\"a\" value=\"2\"/><parameter name=\"b\" value=\"3*a\"/>";
  EXPECT_EQ(read(model).parameters[1].second, 6.0);
  EXPECT_EQ(read(model, {{"a", "10*deg"}}).parameters[1].second, 3 * 10 * std::acos(-1.0) / 180);
  EXPECT_EQ(read(model, {{"b", "a + 1"}, {"a", "4"}}).parameters[1].second, 5.0);
  const std::string inverse =
      "<parameter name=\"a\" value=\"1/0\"/>";  // its own value is not needed
  EXPECT_EQ(read(inverse, {{"a", "1"}}).parameters[0].second, 1.0);
}

TEST(Reader, RepeatsWithItsIndexInNamesPlacesAndNumbers) {
  const Scene scene = read(R"xml(
    <parameter name="N" value="3"/>
    <repeat count="N" index="k">
      <body name="rod{k}" at="k/2 0 0" mass="1" inertia="1 1 1"/>
      <repeat count="2" index="j"><load name="p{10*k+j}" at="rod{k}" force="t*k j 0"/></repeat>
    </repeat>
    <repeat count="N-1"><spherical name="s{i}" between="rod{i} rod{i+1}"/></repeat>
    <repeat count="0"><spherical name="never{i}" between="rod{i} rod{i-1}"/></repeat>
    <record name="tip" at="rod{N-1}" quantities="position"/>)xml");
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[2].name, "rod2");
  EXPECT_EQ(scene.bodies[2].at(0), 1.0);
  ASSERT_EQ(scene.loads.size(), 6u);
  EXPECT_EQ(scene.loads[5].name, "p21");
  EXPECT_EQ((*scene.loads[5].force)[0](3.0).v, 6.0);
  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_EQ(scene.joints[1].b.name, "rod2");
  EXPECT_EQ(scene.records[0].at->name, "rod2");
  EXPECT_EQ(scene.parameters.size(), 1u);
}

TEST(Reader, ExpectationsForSomeParametersOnly) {
  const std::string model =
      "<parameter name=\"N\" value=\"10\"/><expect quantity=\"q\" of=\"minimum\" value=\"1\" "
      "tolerance=\"1\" source=\"s\" when=\"N=10\"/>";
  EXPECT_EQ(read(model).expects.size(), 1u);
  EXPECT_EQ(read(model, {{"N", "5"}}).expects.size(), 0u);
  EXPECT_SAYS(message("<expect quantity=\"q\" of=\"minimum\" value=\"1\" tolerance=\"1\" "
                      "source=\"s\" when=\"M=1\"/>"),
              "must be of the form parameter=value");
}

TEST(Reader, OrientationByMatrix) {
  const Scene scene =
      read("<body name=\"b\" mass=\"1\" inertia=\"1 1 1\" orientation=\"0 -1 0 1 0 0 0 0 1\"/>");
  EXPECT_EQ(scene.bodies[0].orientation * Vec3::UnitX(), Vec3::UnitY());
  EXPECT_SAYS(
      message(
          "<body name=\"b\" mass=\"1\" inertia=\"1 1 1\" orientation=\"0 -1 0 1 0 0 0 0 1.001\"/>"),
      "not a rotation");
  EXPECT_SAYS(
      message("<body name=\"b\" mass=\"1\" inertia=\"1 1 1\" orientation=\"1 0 0 0 1 0 0 0 -1\"/>"),
      "not a rotation");
}

// ---- bad models -------------------------------------------------------------------------------

TEST(Reader, SaysWhereWhatAndTheNearestSpelling) {
  EXPECT_EQ(message("\n<graviti acceleration=\"0 0 -9.8\"/>").substr(0, 76),
            "test.xml:3: unknown element <graviti>; did you mean \"gravity\"? The elements ");
  const std::string attribute =
      message(steel + "<beam name=\"bar\" section=\"s\"\n elemnts=\"3\"/>");
  EXPECT_SAYS(
      attribute,
      "test.xml:3: beam \"bar\": unknown attribute \"elemnts\"; did you mean \"elements\"?");
  EXPECT_SAYS(attribute, "The attributes of <beam> are: name, section, from");
  EXPECT_SAYS(message(ball + "<record name=\"r\" at=\"ball\" quantities=\"displacment\"/>"),
              "unknown quantity \"displacment\"; did you mean \"displacement\"?");
  EXPECT_SAYS(message(steel + "<beam name=\"b\" section=\"s\" from=\"0 0 0\" to=\"1 0 0\" "
                              "normal=\"0 0 1\" metric=\"quaternions\"/>"),
              "test.xml:2: beam \"b\": metric=\"quaternions\": no such choice; did you mean "
              "\"quaternion\"? "
              "The choices are: matrix, quaternion, geodesic");
}

TEST(Reader, RefusesMissingAndSuperfluousAttributes) {
  EXPECT_SAYS(message("<body name=\"b\" mass=\"1\"/>"),
              "body \"b\": attribute \"inertia\" is missing");
  EXPECT_SAYS(message("<revolute name=\"A\" between=\"ground b\"/>"),
              "revolute \"A\": attribute \"axis\" is missing");
  EXPECT_SAYS(message("<spherical name=\"A\" between=\"ground b\" axis=\"1 0 0\"/>"),
              "unknown attribute \"axis\"");
  EXPECT_SAYS(message("<drive joint=\"A\"/>"),
              "give one of the attributes rate, angle, speed and displacement");
  EXPECT_SAYS(message("<drive joint=\"A\" rate=\"1\" angle=\"t\"/>"), "not more");
  EXPECT_SAYS(message("<load at=\"b\"/>"), "give a force, a moment or both");
  EXPECT_SAYS(message("<body name=\"b\" mass=\"1\" inertia=\"1 1 1\" mass=\"2\"/>"),
              "is given twice");
  EXPECT_SAYS(
      message(
          "<body name=\"b\" attached_to=\"bar.end\" at=\"0 0 0\" mass=\"1\" inertia=\"1 1 1\"/>"),
      "body \"b\": at is taken from the place of attached_to");
  EXPECT_SAYS(message("<section name=\"s\"/>"), "<stiffness> is missing");
  EXPECT_SAYS(message("<section name=\"s\"><stiffness EA=\"1\"/></section>"),
              "attribute \"GA2\" is missing");
  EXPECT_SAYS(message("<transient duration=\"1\" step=\"0.1\"/><expect quantity=\"q\" value=\"1\" "
                      "tolerance=\"1\" source=\"s\"/>"),
              "attribute \"at\" is missing");
  EXPECT_SAYS(message("<expect quantity=\"q\" of=\"minimum\" at=\"1\" value=\"1\" tolerance=\"1\" "
                      "source=\"s\"/>"),
              "at is the time of a value; an extreme is taken over the whole run");
}

TEST(Reader, RefusesBadNumbers) {
  const auto step = [](const std::string& value) {
    return message("<transient duration=\"1\" step=\"" + value + "\"/>");
  };
  EXPECT_SAYS(step("0"), "transient: step is 0, must be positive");
  EXPECT_SAYS(step("-1e-3"), "must be positive");
  EXPECT_SAYS(step("1/0"), "test.xml:2: transient: step=\"1/0\"");
  EXPECT_SAYS(step("1e999"), "test.xml:2: transient: step=");
  EXPECT_SAYS(step("nan"), "test.xml:2: transient: step=");
  EXPECT_SAYS(step("0.1m"), "the unit \"m\" is of another quantity; give the number in s");
  EXPECT_SAYS(step("t"), "test.xml:2: transient: step=");
  EXPECT_SAYS(step(""), "test.xml:2: transient: step=");
  EXPECT_SAYS(message("<transient duration=\"1\" step=\"1\" rho_infinity=\"1.5\"/>"),
              "must lie between 0 and 1");
  EXPECT_SAYS(message("<static steps=\"2.5\"/>"), "must be a whole number");
  EXPECT_SAYS(message("<gravity acceleration=\"0 -9.8\"/>"), "has 2 components, must have 3");
  EXPECT_SAYS(message("<gravity acceleration=\"0 0 - 9.8\"/>"),
              "separated by blanks and contain none");
  EXPECT_SAYS(message("<body name=\"b\" mass=\"1\" inertia=\"1 1 1 0\"/>"),
              "has 4 components, must have 3 or 6");
  EXPECT_SAYS(message(steel + "<beam name=\"b\" section=\"s\" from=\"0 0 0\" to=\"1 0 0\" "
                              "normal=\"0 0 1\" order=\"9\"/>"),
              "is 9, must lie between 1 and 8");
  EXPECT_SAYS(message("<plot y=\"a\" x_range=\"1 0\"/>"), "the second number must be the greater");
}

TEST(Reader, RefusesBadStiffness) {
  std::string numbers;
  for (int i = 0; i < 36; ++i) numbers += i % 7 == 0 ? "1 " : i == 3 ? "0.5 " : "0 ";
  const auto with = [](const std::string& text) {
    return message("<section name=\"s\"><stiffness>" + text + "</stiffness></section>");
  };
  EXPECT_SAYS(with(numbers), "row 1, column 4 is 0.5 but row 4, column 1 is 0");
  EXPECT_SAYS(with("1 2 3"), "has 3 numbers, must have 36");
  EXPECT_SAYS(message("<section name=\"s\"><stiffness EA=\"1\">1 2</stiffness></section>"),
              "not both");
}

TEST(Reader, RefusesBadNames) {
  EXPECT_SAYS(message(ball + "\n" + ball),
              "test.xml:3: body \"ball\": the name \"ball\" is taken (line 2)");
  EXPECT_SAYS(message(steel + bar + "<body name=\"bar\" mass=\"1\" inertia=\"1 1 1\"/>"),
              "is taken (line 2)");
  EXPECT_SAYS(message("<body name=\"ground\" mass=\"1\" inertia=\"1 1 1\"/>"),
              "is the inertial frame");
  EXPECT_SAYS(message("<body name=\"a.b\" mass=\"1\" inertia=\"1 1 1\"/>"),
              "letters, digits, _ and -");
  EXPECT_SAYS(message("<parameter name=\"pi\" value=\"3\"/>"),
              "means something else in expressions");
  EXPECT_SAYS(message("<parameter name=\"t\" value=\"3\"/>"),
              "means something else in expressions");
  EXPECT_SAYS(message("<parameter name=\"a-b\" value=\"3\"/>"), "expressions cannot use the name");
  EXPECT_SAYS(message("<parameter name=\"a\" value=\"3\"/><parameter name=\"a\" value=\"3\"/>"),
              "there is a parameter \"a\" already");
  EXPECT_SAYS(message("<parameter name=\"i\" value=\"3\"/><repeat count=\"1\"/>"),
              "choose another name");
  EXPECT_SAYS(message("<gravity acceleration=\"0 0 1\"/>\n<gravity acceleration=\"0 0 1\"/>"),
              "another is on line 2");
  EXPECT_SAYS(
      message("<repeat count=\"2\"><body name=\"b\" mass=\"1\" inertia=\"1 1 1\"/></repeat>"),
      "name=\"b{i}\"");
}

TEST(Reader, RefusesBadPlaces) {
  const auto place = [](const std::string& at) {
    return message("<load at=\"" + at + "\" force=\"0 0 1\"/>");
  };
  EXPECT_SAYS(place("bar.middle"),
              "\"bar.middle\" is not a place; write ground, the name of a body");
  EXPECT_SAYS(place("bar@x"), "load: at=\"bar@x\"");
  EXPECT_SAYS(place("@0.5"), "is not a place");
  EXPECT_SAYS(place(""), "must be one place");
  EXPECT_SAYS(message("<fixed name=\"f\" between=\"ground\"/>"), "has 1 places, must have two");
  EXPECT_SAYS(message(ball + "<record name=\"r\" at=\"ball\" quantities=\"force\"/>"),
              "is a resultant of a beam");
}

TEST(Reader, RefusesBadBraces) {
  EXPECT_SAYS(message("<load at=\"rod{1/2}\" force=\"0 0 1\"/>"),
              "{1/2} is 0.5, must be a whole number");
  EXPECT_SAYS(message("<load at=\"rod{1\" force=\"0 0 1\"/>"), "{ without }");
  EXPECT_SAYS(message("<load at=\"rod1}\" force=\"0 0 1\"/>"), "} without {");
  EXPECT_SAYS(message("<load at=\"rod{k}\" force=\"0 0 1\"/>"), "load: at=\"rod{k}\"");
}

TEST(Reader, RefusesBadOverrides) {
  const std::string model = "<parameter name=\"step\" value=\"2\"/>";
  EXPECT_SAYS(message(model, {{"stp", "1"}}),
              "--set stp=1: test.xml has no such parameter; did you mean \"step\"?");
  EXPECT_SAYS(message(model, {{"step", "1"}, {"step", "2"}}), "set twice");
  EXPECT_SAYS(message(model, {{"step", "1+"}}), "--set step=1+: ");
  EXPECT_SAYS(message("", {{"a", "1"}}), "There are no parameters");
}

// Words of what is not there, which point to the chapter on what does instead.
TEST(Reader, SaysWhatIsNotThere) {
  for (const char* word : {"friction", "gear", "contact", "limit", "wheel", "shell"})
    EXPECT_SAYS(message(std::string("<") + word + "/>"), "see \"What is not there\"");
  EXPECT_SAYS(message("<control/>"), "write <controller period");
  EXPECT_SAYS(message("<pid name=\"u\" error=\"t\"/>"), "<pid> cannot stand in <mbd>");
  EXPECT_SAYS(message("<transient duration=\"1\" step=\"1\"><stop/></transient>"),
              "an end stop of a joint is a <joint_spring>");
  EXPECT_SAYS(message("<record name=\"x\" quantities=\"friction\"/>"), "of a <joint_spring>");
}

TEST(Reader, RefusesWhatDoesNotBelong) {
  EXPECT_SAYS(message("hello"), "does not belong here");
  EXPECT_SAYS(message("<mass per_length=\"1\" inertia=\"1 1 1\"/>"),
              "<mass> cannot stand in <mbd>");
  EXPECT_SAYS(message("<repeat count=\"1\"><gravity acceleration=\"0 0 1\"/></repeat>"),
              "<gravity> cannot stand in <repeat>");
  EXPECT_SAYS(message("<gravity acceleration=\"0 0 1\"><body/></gravity>"),
              "which has no elements");
}

TEST(Reader, RefusesWhatIsNoModel) {
  EXPECT_SAYS(message_of_text(""), "test.xml:1: not well-formed XML: the file is empty");
  EXPECT_SAYS(message_of_text("<scene/>"), "a model must be one <mbd name=");
  EXPECT_SAYS(message_of_text("<gravity acceleration=\"0 0 1\"/>"),
              "a model must be one <mbd name=");
  EXPECT_SAYS(message_of_text("<mbd name=\"a\">\n<body></mbd>"), "test.xml:2: not well-formed XML");
  EXPECT_SAYS(message_of_text("<mbd name=\"a\"/><mbd name=\"b\"/>"), "this is a second");
  EXPECT_SAYS(message_of_text(std::string("<mbd name=\"a\"/>\0<x/>", 20)), "zero bytes");
  EXPECT_SAYS(message_of_text("<!-- only a comment -->"), "no model");
  try {
    read_model("/nowhere/model.xml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_SAYS(std::string(error.what()), "/nowhere/model.xml: no such file");
  }
  EXPECT_THROW(read_model("/"), Error);
}

TEST(Reader, GuardsAgainstAbsurdSizes) {
  EXPECT_SAYS(message("<repeat count=\"1e7\"/>"), "must lie between 0 and 1e+06");
  std::string inner = "<plot y=\"a\"/>";
  for (const char* const index : {"i", "j", "k", "l"})
    inner = "<repeat count=\"1000\" index=\"" + std::string(index) + "\">" + inner + "</repeat>";
  EXPECT_SAYS(
      message("<repeat count=\"1000\" index=\"a\"><repeat count=\"1e6\" index=\"b\"/></repeat>"),
      "repetitions in one model");
  std::string deep;
  for (int n = 0; n < 2000; ++n)
    deep += "<repeat count=\"1\" index=\"i" + std::to_string(n) + "\">";
  for (int n = 0; n < 2000; ++n) deep += "</repeat>";
  EXPECT_SAYS(message(deep), "nested too deeply");
}

// Seen before: UTF-32 was said to be UTF-16 or "zero bytes", another encoding than is declared was read as UTF-8, &amp;lt; was
// "nothing that XML knows", and halves of letters (&#xD800;, bytes ED A0 80) went into the results.
TEST(Reader, SaysWhatIsWrongWithAnEncoding) {
  const std::string model = "<mbd name=\"m\"/>";
  const auto wide = [&](int bytes, bool least_first) {
    std::string text;
    for (const char c : model) {
      std::string letter(static_cast<std::size_t>(bytes), '\0');
      (least_first ? letter.front() : letter.back()) = c;
      text += letter;
    }
    return text;
  };
  using namespace std::string_literals;
  EXPECT_SAYS(message_of_text("\xFF\xFE\0\0"s + wide(4, true)), "UTF-32; save it in UTF-8");
  EXPECT_SAYS(message_of_text("\0\0\xFE\xFF"s + wide(4, false)), "UTF-32");
  EXPECT_SAYS(message_of_text(wide(4, true)), "UTF-32");
  EXPECT_SAYS(message_of_text(wide(4, false)), "UTF-32");
  EXPECT_SAYS(message_of_text("\xFF\xFE"s + wide(2, true)), "UTF-16");
  const auto declared = [](const std::string& encoding, const std::string& name) {
    return message_of_text("<?xml version=\"1.0\" encoding=\"" + encoding +
                           "\"?>\n<mbd name=\"m\"><plot title=\"" + name + "\"/></mbd>");
  };
  EXPECT_SAYS(declared("ISO-8859-1", "Schwingung Nr. \xC3\xA4"),
              "it says that it is in ISO-8859-1; save it in UTF-8");
  EXPECT_SAYS(declared("utf-16", "a"), "it says that it is in utf-16, and is not");
  for (const char* const fine : {"UTF-8", "utf-8", "US-ASCII"})
    EXPECT_SAYS(declared(fine, "\xC3\xA4"), "plot");
  EXPECT_SAYS(declared("ISO-8859-1", "a"), "plot");
  EXPECT_SAYS(message("<load at=\"b\" force=\"t &amp;lt; 1 ? 1 : 0 0 0\"/>"),
              "&amp;lt; is &lt; escaped twice; write &lt;");
  EXPECT_SAYS(message("<plot title=\"&#xD800;\"/>"), "holds a letter by a number");
  for (const char* const half :
       {"\xED\xA0\x80", "\xE0\x80\xAF", "\xF4\x90\x80\x80", "\xF0\x80\x80\xAF"})
    EXPECT_SAYS(message("<plot title=\""s + half + "\"/>"), "is not in UTF-8");
  for (const char* const whole :
       {"\xED\x9F\xBF", "\xEE\x80\x80", "\xE0\xA0\x80", "\xF4\x8F\xBF\xBF", "\xF0\x90\x80\x80"})
    EXPECT_SAYS(message("<plot title=\""s + whole + "\"/>"), "plot: attribute \"y\"");
}

// Beyond what can be computed with, numbers are refused for their size: a spring of 1e-300 was "free to move" before.
TEST(Reader, RefusesNumbersForTheirSize) {
  EXPECT_SAYS(
      message("<spring name=\"s\" between=\"ground b\" at_a=\"1 0 0\" stiffness=\"1e-300\"/>"),
      "stiffness");
  EXPECT_SAYS(
      message("<spring name=\"s\" between=\"ground b\" at_a=\"1 0 0\" stiffness=\"1e-300\"/>"),
      "is 1e-300, too small to compute with: it must be of a size from 1e-60 to 1e60, or 0");
  EXPECT_SAYS(message("<body name=\"c\" mass=\"1e308\" inertia=\"1 1 1\"/>"), "mass");
  EXPECT_SAYS(message("<body name=\"c\" mass=\"1e308\" inertia=\"1 1 1\"/>"),
              "too large to compute with");
  EXPECT_SAYS(message("<body name=\"c\" at=\"0 -1e200 0\" mass=\"1\" inertia=\"1 1 1\"/>"),
              "-1e+200, too large");
}

// ---- schema and spelling ----------------------------------------------------------------------

// Every attribute says what it is; every default and choice can be read.
TEST(Schema, IsComplete) {
  for (const schema::Element& element : schema::elements()) {
    EXPECT_FALSE(element.doc.empty()) << element.name;
    for (const std::string_view parent : schema::words(element.parents))
      EXPECT_NE(schema::find_element(parent), nullptr) << element.name;
    for (const schema::Attribute& attribute : element.attributes) {
      const std::string where = std::string(element.name) + "." + std::string(attribute.name);
      EXPECT_FALSE(attribute.doc.empty()) << where;
      EXPECT_FALSE(attribute.fallback.empty()) << where;
      if (attribute.kind != schema::Kind::number) {  // which may be a word instead
        EXPECT_EQ(attribute.kind == schema::Kind::choice, !attribute.choices.empty()) << where;
      }
      EXPECT_EQ(schema::find_attribute(element, attribute.name), &attribute)
          << where << " stands there twice";
      if (attribute.kind == schema::Kind::choice) {
        const std::vector<std::string_view> choices = schema::words(attribute.choices);
        if (attribute.fallback != field::optional) {  // the default depends on the scene
          EXPECT_NE(std::find(choices.begin(), choices.end(), attribute.fallback), choices.end())
              << where;
        }
      }
    }
  }
  for (const schema::JointKind& kind : schema::joint_kinds())
    EXPECT_NE(schema::find_element(kind.name), nullptr);
}

TEST(Spelling, NearestWord) {
  const std::vector<std::string_view> known = {"beam",    "arc",    "body",
                                               "gravity", "static", "transient"};
  EXPECT_EQ(nearest("baem", known), "beam");
  EXPECT_EQ(nearest("Gravity", known), "gravity");
  EXPECT_EQ(nearest("transcient", known), "transient");
  EXPECT_EQ(nearest("xyz", known), "");
  EXPECT_EQ(nearest("", known), "");
  EXPECT_EQ(nearest(std::string(100000, 'a'), known), "");
  EXPECT_EQ(list(known), "beam, arc, body, gravity, static, transient");
  EXPECT_SAYS(list(std::vector<std::string_view>(100, "w")), "and 40 more");
}

}  // namespace
}  // namespace mbd::test::test_reader
