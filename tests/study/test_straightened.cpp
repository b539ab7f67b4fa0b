// Curved beams made of straight ones: geometry, mass, places and loads are those of the curved beam to the order of
// polygons, h^2, and to round-off where nothing is curved.
#include "libmbd/study/effects/straightened.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "libmbd/compile/model.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_straightened {
namespace {

Scene scene_of(const std::string& items) {
  return read_model_text("<mbd name=\"m\">" + items + "</mbd>", "m.xml");
}

double last(const Scene& scene, const std::string& column) {
  return run_to_table(scene).table[column].back();
}

// models/bend45.xml, its converged tip in inches.
TEST(Straightened, ArcConvergesToTheCurvedOneAsPolygonsDo) {
  const double tip[] = {-13.73548151312559, -23.82504922387786, 53.61385809953142};
  std::vector<double> errors;
  for (const int elements : {8, 16, 32}) {
    Scene scene = model_scene("bend45");
    scene.expects.clear();
    scene.beams[0].elements = elements;
    scene = without(scene, std::vector<std::string>{"curvature:bend"});
    ASSERT_EQ(scene.beams.size(), static_cast<std::size_t>(elements));
    const Table result = run_to_table(scene).table;
    double squares = 0.0;
    for (int i = 0; i < 3; ++i)
      squares +=
          std::pow(result[fmt::format("tip.displacement.{}", i + 1)].back() / 0.0254 - tip[i], 2);
    errors.push_back(std::sqrt(squares));
  }
  // Chords are shorter by (h/R)^2/24 of the length, and the element's own curvature is gone: 4e-4 of the radius at 8.
  EXPECT_GT(errors[0], 1e-3);
  EXPECT_LT(errors[0], 0.2);
  for (std::size_t i = 0; i + 1 < errors.size(); ++i)
    EXPECT_NEAR(std::log2(errors[i] / errors[i + 1]), 2.0, 0.05) << errors[i];
}

// A line that is straight, but said to be a curve, with all that can lie along a beam or be attached to it: pieces are
// the same beam, and every result is the same to the solver's tolerance and the elements' error.
const std::string loaded =
    R"(<station at="0"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="300" EI2="500" EI3="400"/>
          <mass per_length="2" inertia="2e-3 1e-3 1e-3"/></station>
        <station at="0.6"><stiffness EA="8e5" GA2="3e5" GA3="3e5" GJ="200" EI2="300" EI3="250"/>
          <mass per_length="1.5" inertia="2e-3 1e-3 1e-3"/></station>
        <station at="1"><stiffness EA="6e5" GA2="2e5" GA3="2e5" GJ="100" EI2="200" EI3="150"/>
          <mass per_length="1" inertia="1e-3 5e-4 5e-4"/></station></section>
      <fixed name="root" between="ground b.start"/>
      <gravity acceleration="0 0 -9.81"/>
      <load at="b@0.35" force="0 2 0"/>
      <distributed beam="b" from="0.2" to="0.8" force="0 0 5*(1-s)^2" follower_force="0 s 0"/>
      <point_mass at="b.end" mass="0.2" offset="0 0.1 0"/>
      <record name="tip" at="b.end" quantities="displacement rotation"/>
      <record name="root" at="b.start" quantities="force moment"/>
      <record name="within" at="b@0.43" quantities="position rotation force moment"/>)";

TEST(Straightened, WhatIsStraightAlreadyStaysAsItIs) {
  const std::string section = R"(<section name="s" interpolation="linear">)";
  Scene scene = scene_of(section + loaded +
                         R"(<curve name="b" section="s" normal="0 0 1" elements="6" order="5">
                              <point at="0 0 0"/><point at="0.8 0 0"/><point at="1.2 0 0"/><point at="2 0 0"/></curve>
                            <static/>)");
  EXPECT_FALSE(can_be_straightened(scene, scene.beams[0])) << "it is straight";
  Scene pieces = scene;
  straighten(pieces, "b");
  EXPECT_EQ(pieces.beams.size(), 9u) << "6 parts, and ends at 0.2, 0.35 and 0.8";
  EXPECT_EQ(pieces.distributed_loads.size(), 5u) << "pieces between 0.2 and 0.8";
  const Table a = run_to_table(scene).table, b = run_to_table(pieces).table;
  ASSERT_EQ(a.names, b.names);
  // Of places of 2 m, eps is a strain of 10 eps in a piece of 0.2 m, and a force of 10 eps EA.
  constexpr double force_round_off = 10.0 * std::numeric_limits<double>::epsilon() * 1e6;
  for (const std::string& name : a.names)
    EXPECT_NEAR(a[name].back(), b[name].back(),
                1e-9 * (1.0 + std::abs(a[name].back())) +
                    (name.starts_with("root.force") ? force_round_off : 0.0))
        << name;
}

// Twist is curvature too; and drag and added mass along a part are divided as loads are.
TEST(Straightened, TwistedBeamsMoveAsTheyDidToSecondOrder) {
  const auto scene_with = [](int elements) {
    return scene_of(fmt::format(
        R"(<section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="300" EI2="900" EI3="100"/>
             <mass per_length="2" inertia="2e-3 1e-3 1e-3"/></section>
           <curve name="b" section="s" normal="0 0 1" elements="{}" order="3">
             <point at="0 0 0"/><point at="1 0 0" twist="1"/></curve>
           <fixed name="root" between="ground b.start"/> <gravity acceleration="0 0 -9.81"/>
           <drag beam="b" density="1000" diameter="0.02" normal_coefficient="1" tangential_coefficient="0.01" from="0.25"/>
           <added_mass beam="b" density="1000" diameter="0.02" coefficient="1" to="0.75"/>
           <transient method="radau" duration="0.05" tolerance="1e-7"/>
           <record name="tip" at="b.end" quantities="displacement"/>)",
        elements));
  };
  const Scene fine = scene_with(16);
  ASSERT_TRUE(can_be_straightened(fine, fine.beams[0]));
  const double exact2 = last(fine, "tip.displacement.2"), exact3 = last(fine, "tip.displacement.3");
  std::vector<double> errors;
  for (const int elements : {4, 8}) {
    Scene scene = scene_with(elements);
    straighten(scene, "b");
    errors.push_back(std::hypot(last(scene, "tip.displacement.2") - exact2,
                                last(scene, "tip.displacement.3") - exact3));
  }
  EXPECT_GT(errors[0], 1e-5 * std::abs(exact3));
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2.0, 0.2);
}

TEST(Straightened, OnlyWhatIsCurvedFlexibleAndOfPieces) {
  const auto offered = [](const Scene& scene) {
    const std::vector<Ablation> all = ablations_of(scene);
    return std::any_of(all.begin(), all.end(),
                       [](const Ablation& a) { return a.key.starts_with("curvature:"); });
  };
  Scene scene = model_scene("bend45");
  EXPECT_TRUE(offered(scene));
  EXPECT_TRUE(offered(model_scene("swept_cantilever")));
  EXPECT_FALSE(offered(model_scene("four_bar")));
  scene.rigids.push_back({{}, "all", {"bend"}});
  EXPECT_FALSE(offered(scene));
  // What compile refuses is left to it.
  scene = model_scene("bend45");
  scene.beams[0].section = "none";
  EXPECT_FALSE(offered(scene));
  // Of a beam that is left out as rigid, nothing is left to make straight.
  const Scene both =
      without(model_scene("bend45"), std::vector<std::string>{"curvature:bend", "rigid:bend"});
  EXPECT_EQ(both.beams.size(), 1u);
}

}  // namespace
}  // namespace mbd::test::test_straightened
