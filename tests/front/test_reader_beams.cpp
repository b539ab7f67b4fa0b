// The reader: curves, stations, distributed and follower loads, point masses; and what compile refuses of
// them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/support/read_text.hpp"

namespace mbd::test::test_reader_beams {
namespace {

using test::read;

std::string message(const std::string& inside, bool compiled = false) {
  try {
    const Scene scene = read(inside);
    check_scene(scene);
    if (compiled) compile(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

const std::string D = R"xml(<stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/>)xml";
const std::string M = R"xml(<mass per_length="1" inertia="1 1 1"/>)xml";
const std::string bar = "<section name=\"s\">" + D + M + R"xml(</section>
  <beam name="bar" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/><static/>)xml";

TEST(ReaderOfBeams, Curve) {
  const Scene scene = read(R"xml(<parameter name="n" value="4"/>
    <curve name="c" section="s" normal="0 0 1" elements="2" order="5" degree="4">
      <point at="0 0 0" normal="1 0 0" twist="5*deg"/>
      <repeat count="n" index="k"><point at="1 k+1 0"/></repeat>
    </curve>)xml");
  ASSERT_EQ(scene.beams.size(), 1u);
  const auto& curve = std::get<Curve>(scene.beams[0].line);
  ASSERT_EQ(curve.points.size(), 5u);
  EXPECT_EQ(curve.degree, 4);
  EXPECT_EQ(scene.beams[0].order, 5);
  EXPECT_EQ(*curve.points[0].normal, Vec3(1, 0, 0));
  EXPECT_NEAR(curve.points[0].twist, 0.0872664625997, 1e-12);
  EXPECT_EQ(curve.points[4].at, Vec3(1, 4, 0));
  EXPECT_FALSE(curve.points[4].normal);
  EXPECT_EQ(curve.points[4].source.line, 5);
  EXPECT_EQ(
      std::get<Curve>(read(R"xml(<curve name="c" section="s" normal="0 0 1"><point at="0 0 0"/>
                           <point at="1 0 0"/></curve>)xml")
                          .beams[0]
                          .line)
          .degree,
      0);
}

TEST(ReaderOfBeams, Stations) {
  const Scene scene = read("<section name=\"s\" interpolation=\"smooth\"><station at=\"0\">" + D +
                           M + "</station><repeat count=\"2\"><station at=\"(i+1)/2\">" + D + M +
                           "</station></repeat></section>");
  const Section& s = scene.sections.at(0);
  EXPECT_EQ(s.interpolation, Interpolation::smooth);
  ASSERT_EQ(s.stations.size(), 3u);
  EXPECT_EQ(s.stations[1].at, 0.5);
  EXPECT_TRUE(s.stations[2].mass);
}

TEST(ReaderOfBeams, Loads) {
  const Scene scene = read(bar + R"xml(<parameter name="q" value="2"/>
    <load at="bar.end" follower_force="1 t 0" follower_moment="0 0 q" offset="0 q 0"/>
    <distributed name="air" beam="bar" from="0.25" force="0 0 q*s*t" follower_moment="s<0.5?1:0 0 0"/>
    <point_mass name="p" at="bar@0.5" mass="q" offset="0 0 1"/>)xml");
  const LoadScene& load = scene.loads.at(0);
  EXPECT_FALSE(load.force);
  EXPECT_EQ((*load.follower_force)[1](3.0).v, 3.0);
  EXPECT_EQ((*load.follower_moment)[2].value(), 2.0);
  EXPECT_EQ(load.offset, Vec3(0, 2, 0));
  const DistributedLoadScene& air = scene.distributed_loads.at(0);
  EXPECT_EQ(air.beam, "bar");
  EXPECT_EQ(air.from, 0.25);
  EXPECT_EQ(air.to, 1.0);
  EXPECT_EQ((*air.force)[2].at(0.5)(3.0).v, 3.0);
  EXPECT_TRUE((*air.force)[2].varies());
  EXPECT_FALSE((*air.force)[0].varies());
  EXPECT_EQ((*air.follower_moment)[0].at(0.4).value(), 1.0);
  EXPECT_EQ((*air.follower_moment)[0].at(0.6).value(), 0.0);
  EXPECT_FALSE(air.follower_force);
  EXPECT_EQ(scene.point_masses.at(0).mass, 2.0);
  EXPECT_EQ(scene.point_masses[0].offset, Vec3(0, 0, 1));
  EXPECT_EQ((FieldExpression{"sin(2)+s2+1.5e1*t", {{"s2", 1}}}).varies(), false);
}

// Fields of parts of a beam, in other axes and other units of time: sums by hand. A function of time of the model goes with
// the field (once, what transforms made of it had lost it). Fails if on_part() forgets where the part begins, or sum() its
// stretch.
TEST(ReaderOfBeams, FieldsOfPartsAndInOtherAxes) {
  const Scene scene =
      read(bar + R"xml(<function name="g" value="sin(3*t)"/><parameter name="q" value="2"/>
    <distributed beam="bar" force="q*s*t (1-s)*g(t) s<0.5?1:7*t kN/m"/>)xml");
  const std::array<FieldExpression, 3>& f = *scene.distributed_loads.at(0).force;
  EXPECT_NEAR(f[1].at(0.25)(0.3).v, 750.0 * std::sin(0.9), 1e-12);
  const FieldExpression::Term terms[] = {{0.6, &f[0]}, {-0.8, &f[1]}};
  const FieldExpression turned = FieldExpression::sum(terms, 10.0).on_part(0.2, 0.6);
  EXPECT_TRUE(turned.varies());
  for (const double s : {0.0, 0.3, 1.0})
    for (const double t : {0.0, 0.7, 5.0}) {
      const double place = 0.2 + 0.4 * s, then = t / 10.0;
      const Taylor2 is = turned.at(s)(t);
      EXPECT_NEAR(is.v, 1200.0 * place * then - 800.0 * (1.0 - place) * std::sin(3.0 * then),
                  1e-12 * 800.0);
      EXPECT_NEAR(is.d, (1200.0 * place - 2400.0 * (1.0 - place) * std::cos(3.0 * then)) / 10.0,
                  1e-11);
    }
  const FieldExpression half = f[2].on_part(0.2, 0.6).on_part(0.5, 1.0);  // 0.4 to 0.6
  EXPECT_EQ(half.at(0.4).value(), 1000.0);
  EXPECT_EQ(half.at(0.6)(2.0).v, 14000.0);
}

TEST(ReaderOfBeams, Refuses) {
  const std::string curve = R"xml(<curve name="c" section="s" normal="0 0 1">)xml";
  EXPECT_SAYS(
      message(
          bar + R"xml(<curve name="c" section="s" normal="0 0 1"><point at="0 0 0"/></curve>)xml",
          true),
      "test.xml:3: curve \"c\": has 1 <point>s; a curve needs two at least");
  EXPECT_SAYS(message(curve + "<beam/></curve>"), "<beam> cannot stand in <curve>");
  EXPECT_SAYS(message(curve + "<repeat count=\"1\">" + bar + "</repeat></curve>"),
              "<section> cannot stand in <repeat> in <curve>; the elements there are");
  EXPECT_SAYS(message("<repeat count=\"1\"><point at=\"0 0 0\"/></repeat>"),
              "<point> cannot stand in <repeat> in <mbd>");
  EXPECT_SAYS(message("<point at=\"0 0 0\"/>"), "<point> cannot stand in <mbd>");
  EXPECT_SAYS(
      message("<section name=\"s\">" + D + "<station at=\"0\">" + D + "</station></section>"),
      "stiffness and mass must stand in the stations, or there must be no stations");
  EXPECT_SAYS(message("<section name=\"s\"><station at=\"0\">" + M + "</station></section>"),
              "station: <stiffness> is missing");
  EXPECT_SAYS(message("<section name=\"s\" interpolation=\"smooth\">" + D + "</section>"),
              "section \"s\": interpolation is between stations");
  EXPECT_SAYS(message("<section name=\"s\">" + D + D + "</section>"), "has one already");
  EXPECT_SAYS(message(bar + "<load at=\"bar.end\" moment=\"0 0 1\" offset=\"1 0 0\"/>"),
              "is where a force acts, and there is none");
  EXPECT_SAYS(message(bar + "<distributed beam=\"bar\"/>"), "give a force, a moment or both");
  EXPECT_SAYS(message(bar + "<distributed beam=\"bar\" from=\"1\" to=\"0.5\" force=\"0 0 1\"/>"),
              "distributed: to is 0.5, must lie behind from, 1");
  EXPECT_SAYS(message(bar + "<distributed beam=\"bar\" force=\"0 0 1/s\"/>"),
              "distributed: force component 3, at s = 0: expression");
  EXPECT_EQ(message(bar + "<distributed beam=\"bar\" from=\"0.1\" force=\"0 0 1/s\"/>"),
            "no error");
  EXPECT_SAYS(message(bar + "<distributed beam=\"bar\" force=\"0 0 q\"/>"), "q");
  EXPECT_SAYS(message("<parameter name=\"s\" value=\"1\"/>" + bar +
                      "<distributed beam=\"bar\" force=\"0 0 s\"/>"),
              "a parameter of the model too");
  EXPECT_EQ(message("<parameter name=\"s\" value=\"1\"/>" + bar +
                    "<distributed beam=\"bar\" force=\"0 0 1\"/>"),
            "no error");
  EXPECT_SAYS(message(bar + "<point_mass at=\"bar.end\" mass=\"-1\"/>"), "must not be negative");
}

TEST(ReaderOfBeams, CompileRefuses) {
  const auto stations = [](const std::string& inside, const std::string& how = "linear") {
    return "<section name=\"s\" interpolation=\"" + how + "\">" + inside +
           R"xml(</section><beam name="bar" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" order="4"/>
           <static/>)xml";
  };
  const auto station = [](const std::string& at, const std::string& x) {
    return "<station at=\"" + at + "\">" + x + "</station>";
  };
  EXPECT_EQ(message(stations(station("0", D) + station("1", D)), true), "no error");
  EXPECT_SAYS(message(stations(station("0", D) + station("0.9", D)), true),
              "section \"s\": stations must run from at=\"0\" to at=\"1\"");
  EXPECT_SAYS(
      message(stations(station("0", D) + station("0.6", D) + station("0.5", D) + station("1", D)),
              true),
      "station at 0.5: must lie behind the one before it, at 0.6");
  EXPECT_SAYS(message(stations(station("0", D) + station("1", D + M)), true),
              "station at 1: has a mass, unlike the first");
  EXPECT_SAYS(message(stations(station("0", D) +
                               station("1", R"xml(<stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1"
                                                EI3="1" D12="2"/>)xml")),
                      true),
              "station at 1: stiffness: not positive definite: D12 is 2, larger than 1, the root "
              "of EA GA2");
  // a cubic through 1, 0.01, 0.01, 1 swings below zero
  const auto soft = [](const std::string& x) {
    return "<stiffness EA=\"" + x + "\" GA2=\"1\" GA3=\"1\" GJ=\"1\" EI2=\"1\" EI3=\"1\"/>";
  };
  const std::string swing = station("0", soft("1")) + station("0.3", soft("0.01")) +
                            station("0.7", soft("0.01")) + station("1", soft("1"));
  EXPECT_SAYS(message(stations(swing, "smooth"), true),
              "the smooth table of the stiffness is not positive definite at");
  EXPECT_EQ(message(stations(swing), true), "no error");
  EXPECT_SAYS(message(bar + "<distributed beam=\"rod\" force=\"0 0 1\"/>", true),
              "there is no beam \"rod\"");
  EXPECT_SAYS(message(bar + "<distributed name=\"q\" beam=\"bar\" force=\"0 0 1/(s-1/2)\"/>" +
                          "<load at=\"bar@0.5\" force=\"0 0 1\"/>",
                      true),
              "distributed \"q\", at s = 0.5");
  EXPECT_SAYS(message(bar + "<point_mass at=\"ground\" mass=\"1\"/>", true),
              "point_mass: on the ground it does nothing");
  EXPECT_SAYS(message(bar + "<load name=\"x\" at=\"ground\" force=\"0 0 1\"/>", true),
              "load \"x\": on the ground it does nothing");
}

}  // namespace
}  // namespace mbd::test::test_reader_beams
