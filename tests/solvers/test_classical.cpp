// The classical beam in whole models: the bend and the four-bar against the converged solutions that the
// beam of motion interpolation is tested with, the shaft, a beam rolled up to a circle.
//
// Norms are those of test_orders.cpp (bend45), test_four_bar.cpp and test_shaft.cpp, which tell where the
// reference values come from. Every bound is shown to see 10 % of what it is about.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "libmbd/compile/model.hpp"
#include "libmbd/run/describe.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_classical {
namespace {

using Mutation = std::function<void(Scene&)>;

Mutation change_D(Index i, Index j, std::size_t section = 0) {
  return [=](Scene& scene) {
    Mat6& D = scene.sections.at(section).stiffness;
    D(i - 1, j - 1) *= 1.1;
    if (i != j) D(j - 1, i - 1) *= 1.1;
  };
}

Scene classical(Scene scene) {
  for (BeamScene& beam : scene.beams) beam.kinematics = Kinematics::classical;
  return scene;
}

Table table_of(const Scene& scene, long every = 1) {
  History history = run_to_table(scene, every);
  EXPECT_TRUE(history.report.complete()) << history.report.failure;
  return std::move(history.table);
}

Vec3 last(const Table& t, const std::string& name) {
  return {t[name + ".1"].back(), t[name + ".2"].back(), t[name + ".3"].back()};
}

std::string listed(const std::vector<double>& x) { return testing::PrintToString(x); }

TEST(ClassicalScene, HasAllItsElementsInOneBatch) {
  const Model model = compile(classical(model_scene("four_bar")));
  Index elements = 0;
  for (const auto& batch : model.system->batches()) {
    EXPECT_FALSE(batch->type().starts_with("beam elastic, geodesic")) << batch->type();
    if (batch->type() == "beam elastic, classical, N = 3, Gauss") elements += batch->size();
  }
  EXPECT_EQ(elements, 2 + 4 + 2);
}

// Both kinds in one model.
TEST(ClassicalScene, StandsBesideTheOther) {
  Scene scene = model_scene("four_bar");
  scene.beams.at(1).kinematics = Kinematics::classical;
  const Model model = compile(scene);
  int kinds = 0;
  for (const auto& batch : model.system->batches())
    kinds += batch->type().starts_with("beam elastic");
  EXPECT_EQ(kinds, 2);
}

TEST(ClassicalScene, IsReadAndDescribed) {
  const auto beam = [](const std::string& attributes) {
    return read_model_text(
        "<mbd name=\"x\">\n<section name=\"s\"><stiffness EA=\"1\" GA2=\"1\" GA3=\"1\" GJ=\"1\" "
        "EI2=\"1\" EI3=\"1\"/></section>\n<arc name=\"b\" section=\"s\" from=\"1 0 0\" "
        "center=\"0 0 0\" axis=\"0 0 1\" angle=\"190*deg\" normal=\"0 0 1\" " +
            attributes + "/>\n<static/></mbd>",
        "x.xml");
  };
  EXPECT_EQ(beam("").beams.at(0).kinematics, Kinematics::motion);
  EXPECT_EQ(beam("kinematics=\"motion\" metric=\"matrix\"").beams.at(0).kinematics,
            Kinematics::motion);
  const Scene scene = beam("kinematics=\"classical\" elements=\"2\"");
  EXPECT_EQ(scene.beams.at(0).kinematics, Kinematics::classical);
  const auto message = [](const auto& f) -> std::string {
    try {
      f();
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  // What the default is does not matter: it was stated.
  for (const char* stated : {"metric=\"geodesic\"", "form=\"energy\""}) {
    const std::string what =
        message([&] { beam(std::string("kinematics=\"classical\" ") + stated); });
    EXPECT_TRUE(what.starts_with("x.xml:3: arc \"b\": ")) << what;
    EXPECT_NE(what.find("kinematics"), std::string::npos) << what;
  }
  EXPECT_EQ(message([&] { compile(beam("kinematics=\"classical\"")); }),
            "x.xml:3: arc \"b\": element 1 of 1 turns by 190 degrees, beyond the 162 of its "
            "interpolation; give the beam more elements");
  const Model model = compile(scene);
  const std::string text = to_text(explain_model(scene, model));
  EXPECT_NE(text.find("beam elastic, classical, N = 3, Gauss"), std::string::npos) << text;
  EXPECT_NE(text.find("classical beams"), std::string::npos) << text;
  const Scene other = beam("elements=\"2\"");
  EXPECT_EQ(to_text(explain_model(other, compile(other))).find("classical"), std::string::npos);
}

// ---- bend45 -----------------------------------------------------------------------------------

const Vec3 converged_tip(-13.73548151312558962, -23.82504922387786265, 53.61385809953141840);

double bend_error(int order, int elements, Rule rule = Rule::gauss, const Mutation& mutation = {}) {
  Scene scene = classical(model_scene("bend45", {{"in", "1"}, {"lb", "1"}}));
  scene.beams.at(0).order = order;
  scene.beams.at(0).elements = elements;
  scene.beams.at(0).rule = rule;
  if (mutation) mutation(scene);
  return (last(table_of(scene), "tip.displacement") - converged_tip).norm() / converged_tip.norm();
}

// Errors with 16 elements, N = 2, 3, 4: 2.19e-6, 1.16e-9, 5.2e-13; of the geodesic metric with the paper's
// form 5.29e-7, 4.77e-10, 2.2e-13 (test_orders.cpp).
TEST(ClassicalBend45, ConvergesWithTwiceTheOrderOfTheElements) {
  struct Row {
    int order;
    std::vector<int> meshes;
    double finest;
  };
  for (const Row& row : {Row{1, {16, 32, 64}, 5e-4}, Row{2, {8, 16, 32}, 1e-6},
                         Row{3, {4, 8, 16}, 1e-8}, Row{4, {4, 8, 16}, 1e-11}}) {
    std::vector<double> length, error;
    for (const int elements : row.meshes) {
      length.push_back(1.0 / elements);
      error.push_back(bend_error(row.order, elements));
    }
    const std::vector<double> slopes = orders(length, error);
    RecordProperty("errors" + std::to_string(row.order), listed(error));
    RecordProperty("slopes" + std::to_string(row.order), listed(slopes));
    EXPECT_NEAR(slopes.back(), 2.0 * row.order, 0.06 * 2 * row.order)
        << "N = " << row.order << ": errors " << listed(error) << ", slopes " << listed(slopes);
    EXPECT_LT(error.back(), row.finest) << "N = " << row.order;
  }
}

// With 8, 16, 32 elements: N = 2 .12, .013, 9.3e-4; N = 3 4.9e-4, 1.0e-5, 1.7e-7.
TEST(ClassicalBend45, GaussLobattoLocks) {
  for (int N = 2; N <= 4; ++N) {
    std::vector<double> error;
    for (const int elements : {8, 16, 32})
      error.push_back(bend_error(N, elements, Rule::gauss_lobatto));
    RecordProperty("lobatto" + std::to_string(N), listed(error));
    EXPECT_GT(error.front(), 100 * bend_error(N, 8)) << "N = " << N;
    EXPECT_LT(error.back(), error.front() / 10) << "N = " << N;
  }
}

TEST(ClassicalBend45, FailsUnderMutation) {
  for (const auto& [i, j] : {std::pair{1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}, {6, 6}, {1, 6}})
    EXPECT_GT(bend_error(3, 16, Rule::gauss, change_D(i, j)), 1e-8) << i << j;
  EXPECT_GT(bend_error(3, 16, Rule::gauss,
                       [](Scene& s) {
                         s.loads.at(0).force->at(2) = Expression::parse("660", {}, Variables::time);
                       }),
            1e-8);
  EXPECT_GT(bend_error(3, 16, Rule::gauss,
                       [](Scene& s) { std::get<Arc>(s.beams.at(0).line).angle *= 1.1; }),
            1e-8);
}

// ---- roll_up ----------------------------------------------------------------------------------

// L = 10, moment 2 pi EI/L: a closed circle, exactly. The distance of the tip from the clamp, divided by L;
// and the rotation of the tip, which is about the same axis all along, so a chord of angles: 2 pi.
const std::string roll_up = R"xml(<mbd name="roll_up">
  <parameter name="EI" value="86.9e3"/>
  <parameter name="part" value="1"/>
  <section name="s"><stiffness EA="1770e3" GA2="1770e3" GA3="1770e3" GJ="8.16e3" EI2="EI"
                               EI3="215e3"/></section>
  <beam name="b" section="s" from="0 0 0" to="10 0 0" normal="0 0 1" kinematics="classical"/>
  <fixed name="clamp" between="ground b.start"/>
  <load at="b.end" moment="0 part*2*pi*86.9e3/10 0"/>
  <static steps="8"/>
  <record name="tip" at="b.end" quantities="position"/>
  <record name="middle" at="b@0.5" quantities="position force moment"/>
</mbd>)xml";

struct Rolled {
  double tip, middle, moment;  // errors: of positions in L, of M2 in 2 pi EI/L
};
Rolled rolled(int order, int elements, const Overrides& set = {}) {
  Scene scene = read_model_text(roll_up, "roll_up.xml", set);
  scene.beams.at(0).order = order;
  scene.beams.at(0).elements = elements;
  const Table t = table_of(scene);
  const double M = 2 * std::numbers::pi * 86.9e3 / 10;
  // A positive moment about i2 turns b1 towards -i3.
  const Vec3 opposite(0, 0, -10 / std::numbers::pi);
  return {last(t, "tip.position").norm() / 10, (last(t, "middle.position") - opposite).norm() / 10,
          (last(t, "middle.moment") - Vec3(0, M, 0)).norm() / M};
}

TEST(ClassicalRollUp, ClosesTheCircle) {
  struct Row {
    int order;
    std::vector<int> meshes;
    double finest;
  };
  for (const Row& row :
       {Row{2, {8, 16, 32}, 1e-4}, Row{3, {8, 16, 32}, 1e-6}, Row{4, {4, 8, 16}, 1e-8}}) {
    std::vector<double> length, tip, middle, moment;
    for (const int elements : row.meshes) {
      const Rolled r = rolled(row.order, elements);
      length.push_back(1.0 / elements);
      tip.push_back(r.tip);
      middle.push_back(r.middle);
      moment.push_back(r.moment);
    }
    const std::vector<double> slopes = orders(length, middle);
    RecordProperty("tip" + std::to_string(row.order), listed(tip));
    RecordProperty("middle" + std::to_string(row.order), listed(middle));
    RecordProperty("slopes" + std::to_string(row.order), listed(slopes));
    RecordProperty("moment" + std::to_string(row.order), listed(moment));
    // At the ends of elements resultants are extrapolated from the N quadrature points.
    EXPECT_GT(orders(length, moment).back(), row.order + 0.9)
        << "N = " << row.order << ": errors " << listed(moment);
    EXPECT_LT(moment.back(), row.finest) << "N = " << row.order;
    EXPECT_GT(slopes.back(), 0.94 * 2 * row.order)
        << "N = " << row.order << ": errors " << listed(middle) << ", slopes " << listed(slopes);
    EXPECT_LT(tip.back(), row.finest) << "N = " << row.order;
    EXPECT_LT(middle.back(), row.finest) << "N = " << row.order;
  }
}

TEST(ClassicalRollUp, FailsUnderMutation) {
  EXPECT_GT(rolled(2, 32, {{"EI", "95.59e3"}}).tip, 1e-2);
  EXPECT_GT(rolled(2, 32, {{"part", "1.1"}}).tip, 1e-2);
}

// ---- four_bar ---------------------------------------------------------------------------------

constexpr std::size_t samples = 601;  // of t <= 5.4 s

struct Errors {
  double u3 = 0.0, Q3 = 0.0, M2 = 0.0;
};
// As for the beam of motion interpolation, test_four_bar.cpp.
constexpr Errors bound{.u3 = 2e-7, .Q3 = 5e-7, .M2 = 2e-7};

Errors four_bar_errors(const Mutation& mutation = {}) {
  Scene scene = classical(model_scene("four_bar"));
  scene.transient->duration = 5.4;
  if (mutation) mutation(scene);
  const Table t = table_of(scene), reference = reference_table("four_bar");
  const auto error = [&](const char* column, const char* reference_column) {
    const std::vector<double>&x = t[column], &y = reference[reference_column];
    std::vector<double> e;
    for (std::size_t k = 0; k < samples; ++k) e.push_back(x.at(k) - y.at(k));
    return largest(e) / largest(y);
  };
  EXPECT_EQ(t.rows(), samples);
  return {.u3 = error("C.displacement.3", "uC3"),
          .Q3 = error("M.force.3", "Q3"),
          .M2 = error("M.moment.2", "M2")};
}

// Measured: u3 6.9e-8, Q3 1.4e-7, M2 5.2e-8, which is the error of the step.
TEST(ClassicalFourBar, AgreesWithTheReference) {
  const Errors e = four_bar_errors();
  RecordProperty("u3", testing::PrintToString(e.u3));
  RecordProperty("Q3", testing::PrintToString(e.Q3));
  RecordProperty("M2", testing::PrintToString(e.M2));
  EXPECT_LE(e.u3, bound.u3);
  EXPECT_LE(e.Q3, bound.Q3);
  EXPECT_LE(e.M2, bound.M2);
}

TEST(ClassicalFourBar, FailsUnderMutation) {
  const Mutation more_mass = [](Scene& scene) {
    for (Section& s : scene.sections) s.mass->topLeftCorner<3, 3>() *= 1.1;
  };
  for (const Mutation& mutation : {more_mass, change_D(5, 5), change_D(3, 6), change_D(4, 4, 1)}) {
    const Errors e = four_bar_errors(mutation);
    EXPECT_GT(e.u3, bound.u3);
    EXPECT_GT(e.Q3, bound.Q3);
    EXPECT_GT(e.M2, bound.M2);
  }
}

// ---- shaft ------------------------------------------------------------------------------------

// Steps of 2.5 ms: the error is that of the scheme, 9.64e-3 within 5 %.
struct Shaft {
  double error = 0.0, sag = 0.0;
};
Shaft shaft(const Mutation& mutation = {}) {
  Scene scene = classical(model_scene("shaft"));
  scene.transient->step = 2.5e-3;
  if (mutation) mutation(scene);
  const Table t = table_of(scene, 2), reference = reference_table("shaft");
  EXPECT_EQ(t.rows(), reference.rows());
  return {relative_rms({&t["M.displacement.2"], &t["M.displacement.3"]},
                       {&reference["u2"], &reference["u3"]}, 0, t.rows()),
          -t["M.displacement.3"].front()};
}
constexpr double scheme = 9.64e-3, band = 0.05;
constexpr double sag = 3.525552557e-3, sag_tolerance = 1e-9;

TEST(ClassicalShaft, HasTheErrorOfTheScheme) {
  const Shaft s = shaft();
  RecordProperty("error", testing::PrintToString(s.error));
  RecordProperty("sag", testing::PrintToString(s.sag / sag - 1));
  EXPECT_NEAR(s.error, scheme, band * scheme);
  EXPECT_NEAR(s.sag, sag, sag_tolerance * sag);
}

TEST(ClassicalShaft, FailsUnderMutation) {
  for (const Mutation& mutation :
       {Mutation([](Scene& s) { s.bodies.at(0).mass *= 1.1; }), change_D(5, 5), change_D(6, 6)}) {
    const Shaft s = shaft(mutation);
    EXPECT_GT(std::abs(s.error / scheme - 1), band);
  }
  for (const Mutation& mutation : {change_D(2, 2), change_D(2, 5)})
    EXPECT_GT(std::abs(shaft(mutation).sag / sag - 1), sag_tolerance);
}

// ---- frame invariance -------------------------------------------------------------------------

// The four-bar turned and carried elsewhere as a whole: displacements turn with it, sectional forces stay.
TEST(ClassicalFourBar, IsTheSameInAnotherPlace) {
  Scene scene = classical(model_scene("four_bar"));
  scene.transient->duration = 2.7;
  scene.transient->newton_tolerance = 1e-12;  // of Newton's increments: what is left is round-off
  const Table here = table_of(scene);
  Rng rng(7);
  const Pose<double> G = random_pose(rng, 1.0);
  const auto turn = [&](Vec3& x) { x = G.p * x; };
  const auto carry = [&](Vec3& x) { x = G * x; };
  for (BeamScene& beam : scene.beams) {
    auto& line = std::get<Straight>(beam.line);
    carry(line.from);
    carry(line.to);
    turn(beam.normal);
  }
  for (JointScene& joint : scene.joints) {
    for (auto* x : {&joint.axis, &joint.second_axis})
      if (*x) turn(**x);
    for (auto* x : {&joint.at, &joint.at_a, &joint.at_b})
      if (*x) carry(**x);
  }
  const Table there = table_of(scene);
  change_D(5, 5)(scene);
  const Table other = table_of(scene);
  const auto at = [](const Table& t, const std::string& name, std::size_t k) {
    return Vec3(t[name + ".1"][k], t[name + ".2"][k], t[name + ".3"][k]);
  };
  double u = 0, force = 0, moment = 0, mutated = 0;
  ASSERT_EQ(there.rows(), here.rows());
  for (std::size_t k = 0; k < here.rows(); ++k) {
    const Vec3 x = at(here, "C.displacement", k), y = at(there, "C.displacement", k);
    u = std::max(u, (y - G.p * x).norm());
    mutated = std::max(mutated, (at(other, "C.displacement", k) - G.p * x).norm());
    force = std::max(force, (at(there, "M.force", k) - at(here, "M.force", k)).norm());
    moment = std::max(moment, (at(there, "M.moment", k) - at(here, "M.moment", k)).norm());
  }
  RecordProperty("u", testing::PrintToString(u));
  RecordProperty("force", testing::PrintToString(force));
  RecordProperty("moment", testing::PrintToString(moment));
  EXPECT_LT(u, 1e-14);      // of 0.24 m
  EXPECT_LT(force, 1e-6);   // of 202 N, and of forces of 1e7 N per unit of strain
  EXPECT_LT(moment, 1e-8);  // of 18 N.m
  EXPECT_GT(mutated, 1e-9) << "D55 10 % off may pass unnoticed";
}

}  // namespace
}  // namespace mbd::test::test_classical
