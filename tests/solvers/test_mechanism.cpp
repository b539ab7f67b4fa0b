// Ways to move and redundant constraints, against counts that can be made by hand (Grübler, and what it
// misses in planar and special mechanisms).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "solvers/constraints/mechanism.hpp"

namespace mbd::test::test_mechanism {
namespace {

struct Analysed {
  Model model;
  Mechanism mechanism;
};

Analysed analyse(const Scene& scene) {
  Analysed result{compile(scene), {}};
  result.mechanism = analyze_mechanism(*result.model.system, result.model.initial);
  return result;
}
Analysed analyse(const std::string& inside) {
  return analyse(read_model_text("<mbd name=\"m\"><transient duration=\"1\" step=\"1\"/>" + inside +
                                 "</mbd>"));
}
Analysed analyse_model(const std::string& name, const Overrides& overrides = {}) {
  return analyse(read_model(std::string(MBD_SOURCE_DIR) + "/models/" + name + ".xml", overrides));
}

// Names of the constraints that own the redundant rows.
std::multiset<std::string> blamed(const Analysed& a, const std::vector<RedundantRow>& rows) {
  std::multiset<std::string> names;
  for (const RedundantRow& row : rows) {
    const std::string words = row_in_words(*a.model.system, row.row);
    names.insert(words.substr(0, words.find(',')));
  }
  return names;
}

std::string body(const std::string& name, const std::string& at = "0 0 0") {
  return "<body name=\"" + name + "\" at=\"" + at + "\" mass=\"1\" inertia=\"1 1 1\"/>";
}
std::string revolute(const std::string& name, const std::string& between, const std::string& at,
                     const std::string& axis) {
  return "<revolute name=\"" + name + "\" between=\"" + between + "\" at=\"" + at + "\" axis=\"" +
         axis + "\"/>";
}

TEST(Mechanism, CountsOfTheModels) {
  struct Expected {
    const char* model;
    Index parts, joint_freedoms, prescribed;
  };
  for (const Expected& e :
       {Expected{"pendulum", 1, 1, 0}, Expected{"heavy_top", 1, 3, 0},
        Expected{"dzhanibekov", 1, 6, 0}, Expected{"free_beam", 1, 6, 0},
        Expected{"double_pendulum", 2, 2, 0}, Expected{"double_pendulum_beams", 2, 2, 0},
        Expected{"slider_crank", 3, 1, 1}, Expected{"bend45", 1, 0, 0},
        Expected{"swept_cantilever", 1, 0, 0}}) {
    const Analysed a = analyse_model(e.model);
    EXPECT_EQ(a.mechanism.rigid_parts, e.parts) << e.model;
    EXPECT_EQ(a.mechanism.joint_freedoms, e.joint_freedoms) << e.model;
    EXPECT_EQ(a.mechanism.prescribed, e.prescribed) << e.model;
    EXPECT_TRUE(a.mechanism.redundant.empty()) << e.model;
  }
  const Analysed chain = analyse_model("chain", {{"N", "300"}});
  EXPECT_EQ(chain.mechanism.joint_freedoms, 900);
  EXPECT_TRUE(chain.mechanism.rigid_redundant.empty());
}

// Four parallel hinges are three redundant rows if bars are rigid; flexible bars need them all. With one
// hinge out of true the rigid bars are locked, and the crank's drive contradicts that.
TEST(Mechanism, FourBar) {
  const Analysed tilted = analyse_model("four_bar");
  EXPECT_TRUE(tilted.mechanism.redundant.empty());
  EXPECT_EQ(tilted.mechanism.rigid_parts, 3);
  EXPECT_EQ(tilted.mechanism.joint_freedoms, 0);
  EXPECT_EQ(tilted.mechanism.prescribed, 0);
  EXPECT_EQ(tilted.mechanism.rigid_redundant.size(), 3u);  // 20 + 1 rows, rank 18
  const Analysed straight = analyse_model("four_bar", {{"tilt", "0"}});
  EXPECT_TRUE(straight.mechanism.redundant.empty());
  EXPECT_EQ(straight.mechanism.joint_freedoms, 1);
  EXPECT_EQ(straight.mechanism.prescribed, 1);
  EXPECT_EQ(straight.mechanism.freedoms(), 0);
  EXPECT_EQ(straight.mechanism.rigid_redundant.size(), 3u);
}

// Springs, dampers and bushings leave every motion: two sliders with one between them have two freedoms.
TEST(Mechanism, WhatIsElasticTiesNothing) {
  const std::string sliders = body("a") + body("b", "1 0 0") +
                              "<prismatic name=\"ja\" between=\"ground a\" axis=\"1 0 0\"/>"
                              "<prismatic name=\"jb\" between=\"ground b\" axis=\"1 0 0\"/>";
  for (const std::string between : {"<spring name=\"s\" between=\"a b\" stiffness=\"9\"/>",
                                    "<spring name=\"s\" between=\"a b\" damping=\"9\"/>",
                                    "<bushing name=\"s\" between=\"a b\" stiffness=\"9 9 9\"/>",
                                    "<bushing name=\"s\" between=\"a b\" damping=\"9 9 9\"/>"}) {
    SCOPED_TRACE(between);
    const Analysed a = analyse(sliders + between);
    EXPECT_EQ(a.mechanism.rigid_parts, 2);
    EXPECT_EQ(a.mechanism.joint_freedoms, 2);
  }
  const std::string arms = body("a") + body("b", "1 0 0") + body("c", "2 0 0") +
                           revolute("ja", "ground a", "0 0 0", "0 0 1") +
                           revolute("jb", "a b", "1 0 0", "0 0 1") +
                           revolute("jc", "b c", "2 0 0", "0 1 0");
  const Analysed sprung = analyse(
      arms +
      "<joint_spring name=\"s\" joint=\"jb\" angular_stiffness=\"9\" angular_damping=\"1\"/>"
      "<joint_torque joint=\"jc\" moment=\"1\"/>");
  EXPECT_EQ(sprung.mechanism.rigid_parts, 3);
  EXPECT_EQ(sprung.mechanism.joint_freedoms, 3);
  // A spring to the ground holds nothing either; a beam does what it did.
  EXPECT_EQ(analyse(body("a") + "<bushing name=\"s\" between=\"ground a\" stiffness=\"9 9 9\"/>")
                .mechanism.joint_freedoms,
            6);
}

TEST(Mechanism, DoorOnThreeHinges) {
  const Analysed a = analyse(body("door") + revolute("low", "ground door", "0 0 0", "0 0 1") +
                             revolute("middle", "ground door", "0 0 1", "0 0 1") +
                             revolute("high", "ground door", "0 0 2", "0 0 1"));
  EXPECT_EQ(a.mechanism.joint_freedoms, 1);
  EXPECT_EQ(a.mechanism.redundant.size(), 10u);
  const auto names = blamed(a, a.mechanism.redundant);
  EXPECT_EQ(names.count("revolute 'low'"), 0u);  // the first is kept
  EXPECT_EQ(names.count("revolute 'middle'"), 5u);
  EXPECT_EQ(names.count("revolute 'high'"), 5u);
  for (const RedundantRow& row : a.mechanism.redundant)
    EXPECT_NE(to_text(*a.model.system, row).find(" repeats revolute 'low'"), std::string::npos)
        << to_text(*a.model.system, row);
}

TEST(Mechanism, TheSameJointTwice) {
  const Analysed a = analyse(body("b") + revolute("one", "ground b", "1 2 3", "1 1 0") +
                             revolute("two", "ground b", "1 2 3", "1 1 0"));
  ASSERT_EQ(a.mechanism.redundant.size(), 5u);
  for (const RedundantRow& row : a.mechanism.redundant) {
    ASSERT_EQ(row.repeats.size(), 1u);  // row by row
    EXPECT_EQ(row.row, row.repeats[0] + 5);
  }
  EXPECT_EQ(to_text(*a.model.system, a.mechanism.redundant[0]),
            "revolute 'two', position 1 repeats revolute 'one', position 1");
}

// A drive of a body that a joint holds already.
TEST(Mechanism, DriveOfAHeldJoint) {
  const Analysed a = analyse(body("b") + revolute("hinge", "ground b", "0 0 0", "0 0 1") +
                             "<drive joint=\"hinge\" rate=\"0\"/>" +
                             "<fixed name=\"brake\" between=\"ground b\" at=\"1 0 0\"/>");
  EXPECT_EQ(a.mechanism.joint_freedoms, 0);
  EXPECT_EQ(a.mechanism.prescribed, 0);
  const auto names = blamed(a, a.mechanism.redundant);
  EXPECT_EQ(names.count("fixed 'brake'"), 5u);
  EXPECT_EQ(names.count("drive of 'hinge'"), 1u);  // after all joints
  EXPECT_EQ(names.size(), 6u);
}

// Bricard's linkage moves though six hinges on five bars leave no freedom by count: one row is redundant.
TEST(Mechanism, Bricard) {
  const Vec3 p[7] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}, {0, 0, 1}, {0, 0, 0}};
  const char* axes[6] = {"0 1 0", "0 0 1", "1 0 0", "0 1 0", "0 0 1", "1 0 0"};
  std::string inside;
  for (int i = 0; i < 5; ++i) inside += body("b" + std::to_string(i));
  for (int i = 0; i < 6; ++i) {
    const std::string before = i == 0 ? "ground" : "b" + std::to_string(i - 1);
    const std::string after = i == 5 ? "ground" : "b" + std::to_string(i);
    const std::string at =
        std::to_string(p[i](0)) + " " + std::to_string(p[i](1)) + " " + std::to_string(p[i](2));
    inside += revolute("h" + std::to_string(i), before + " " + after, at, axes[i]);
  }
  const Analysed a = analyse(inside);
  EXPECT_EQ(a.mechanism.constraints, 30);
  EXPECT_EQ(a.mechanism.joint_freedoms, 1);
  EXPECT_EQ(a.mechanism.redundant.size(), 1u);
}

// The count does not depend on units or on where the scene lies.
TEST(Mechanism, InvariantToUnitsAndPlace) {
  for (const double length : {1e-6, 1.0, 1e6})
    for (const double away : {0.0, 1e3}) {
      char text[2000];
      std::snprintf(text, sizeof text,
                    "<body name=\"a\" at=\"%g %g 0\" mass=\"1\" inertia=\"1 1 1\"/>"
                    "<body name=\"b\" at=\"%g %g 0\" mass=\"1\" inertia=\"1 1 1\"/>"
                    "<body name=\"c\" at=\"%g %g 0\" mass=\"1\" inertia=\"1 1 1\"/>"
                    "<revolute name=\"A\" between=\"ground a\" at=\"%g %g 0\" axis=\"0 0 1\"/>"
                    "<revolute name=\"B\" between=\"a b\" at=\"%g %g 0\" axis=\"0 0 1\"/>"
                    "<revolute name=\"C\" between=\"b c\" at=\"%g %g 0\" axis=\"0 0 1\"/>"
                    "<revolute name=\"D\" between=\"c ground\" at=\"%g %g 0\" axis=\"0 0 1\"/>",
                    away * length, 0.0, away * length, length, (away + 2) * length, length,
                    away * length, 0.0, away * length, length, (away + 2) * length, length,
                    (away + 2) * length, 0.0);
      const Analysed a = analyse(text);
      EXPECT_EQ(a.mechanism.joint_freedoms, 1) << length << " " << away;
      EXPECT_EQ(a.mechanism.redundant.size(), 3u) << length << " " << away;
    }
}

// Two hinges almost in line are not called redundant: they lock.
TEST(Mechanism, AlmostRedundantIsNotRedundant) {
  const auto hinged = [](double tilt) {
    return analyse(body("b") + revolute("one", "ground b", "0 0 0", "0 0 1") +
                   revolute("two", "ground b", "0 0 1", std::to_string(tilt) + " 0 1"));
  };
  EXPECT_EQ(hinged(0.0).mechanism.joint_freedoms, 1);
  EXPECT_EQ(hinged(1e-5).mechanism.joint_freedoms, 0);
}

}  // namespace
}  // namespace mbd::test::test_mechanism
