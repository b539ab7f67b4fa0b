// What <fixed> joins is one node: against closed forms, independent equations (a stiffness matrix of Timoshenko members,
// Euler's equations by RK4, statics by hand), and against the same scene with the multipliers that a record asks for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "libmbd/run/describe.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_fused {
namespace {

Scene scene_of(const std::string& items) {
  return read_model_text("<mbd name=\"m\">" + items + "</mbd>", "m.xml");
}

// The same scene with a record of each fixed joint, which keeps its multipliers.
Scene kept(Scene scene) {
  for (const JointScene& joint : scene.joints) {
    if (joint.kind != "fixed") continue;
    RecordScene record;
    record.name = "of_" + joint.name;
    record.joint = joint.name;
    record.quantities = {"reaction_force", "reaction_moment"};
    scene.records.push_back(record);
  }
  return scene;
}

// Largest difference of the columns that both have, over the largest magnitude of the components of their quantity.
void expect_same(const Table& a, const Table& b, double tolerance, const std::string& what) {
  Worst worst(what, tolerance);
  for (const std::string& name : a.names) {
    const std::string quantity = name.substr(0, name.find_last_of('.'));
    double size = 1e-300, difference = 0.0;
    for (const std::string& other : a.names)
      if (other.substr(0, other.find_last_of('.')) == quantity)
        for (const double x : a[other]) size = std::max(size, std::abs(x));
    ASSERT_EQ(a[name].size(), b[name].size()) << what;
    for (std::size_t k = 0; k < a[name].size(); ++k)
      difference = std::max(difference, std::abs(a[name][k] - b[name][k]));
    worst.add(difference / size, name);
  }
}

// Members whose axes differ at every corner, a body off the axis of an inner place of one, a rigid group off the end of
// another, damping, and everything that acts on nodes. The foot alone has multipliers.
const std::string sections =
    R"(<section name="s"><stiffness EA="1e5" GA2="4e4" GA3="3e4" GJ="20" EI2="40" EI3="70"/>
       <mass per_length="2" inertia="0.006 0.002 0.004" center="0.01 0.02"/>
       <damping stiffness_proportional="1e-4" mass_proportional="0.2"/></section>
       <section name="t"><stiffness EA="2e5" GA2="5e4" GA3="6e4" GJ="30" EI2="90" EI3="50"/>
       <mass per_length="1" inertia="0.003 0.001 0.002"/></section>)";
const std::string frame =
    sections +
    R"(<beam name="a" section="s" from="0 0 0" to="0 0 1" normal="1 0.3 0" order="3"/>
       <beam name="b" section="t" from="0 0 1" to="0.8 0.2 1.1" normal="0.1 0 1" elements="2" order="2"/>
       <arc name="c" section="s" from="0.4 0.1 1.05" center="0.4 0.1 1.75" axis="1 0 0"
            angle="1.05" normal="0 0 1" order="4"/>
       <beam name="d" section="t" from="0 0 1" to="0 -0.7 1" normal="1 0 0" metric="quaternion"
             form="paper" order="3"/>
       <beam name="e" section="t" from="0 -0.7 1" to="0.3 -0.7 1" normal="0 0 1"/>
       <body name="bob" at="0.5 0.1 1.4" orientation="0.3 -0.4 0.8" mass="0.7" center="0.02 0 0.01"
             inertia="0.01 0.02 0.025"/>
       <body name="fist" at="0.3 -0.7 1" orientation="0 1 0" mass="0.5" inertia="0.01 0.01 0.01"/>
       <body name="cap" at="0.45 -0.6 1.1" mass="0.3" inertia="0.01 0.02 0.02"/>
       <rigid name="hand" of="fist e"/>
       <body name="tick" attached_to="b@0.5" mass="0.1" inertia="1e-3 1e-3 1e-3"/>
       <point_mass name="dot" at="d.start" mass="0.2" offset="0.1 0 0.05"/>
       <fixed name="foot" between="ground a.start"/>
       <fixed name="ab" between="a.end b.start"/> <fixed name="ad" between="d.start a.end"/>
       <fixed name="bc" between="b@0.5 c.start"/> <fixed name="bobs" between="bob b@0.5"/>
       <fixed name="de" between="d.end e.start"/> <fixed name="caps" between="fist cap"/>)";

const std::string acts =
    R"(<gravity acceleration="0.4 0.2 -9.81"/>
       <load at="b.start" follower_force="1 -2 3" follower_moment="0.3 0.2 0.1" offset="0.1 0 0.1"/>
       <load at="cap" force="3*t 2 -4" moment="0.1 0.2 0.3" offset="0 0.1 0.05"/>
       <distributed beam="d" force="0 1 2" follower_force="0.3 0 s" follower_moment="0 0.2 0.1"/>
       <drag beam="b" density="1000" diameter="0.02" normal_coefficient="1.1"
             tangential_coefficient="0.02"/>
       <drag at="bob" density="1000" coefficient="0.5" area="0.01" offset="0.1 0 0"/>
       <added_mass beam="d" density="1000" diameter="0.02" coefficient="1"/>)";
const std::string records =
    R"(<record name="bob" at="bob" quantities="position rotation velocity_local angular_velocity_local"/>
       <record name="cap" at="cap" quantities="displacement acceleration"/>
       <record name="start" at="b.start" quantities="displacement rotation force moment"/>
       <record name="within" at="b@0.13" quantities="position velocity force moment"/>
       <record name="d" at="d.end" quantities="displacement force moment"/>
       <record name="c" at="c.end" quantities="displacement velocity"/>
       <record name="all" quantities="kinetic_energy strain_energy potential_energy linear_momentum
               angular_momentum"/>)";

const std::string static_records =
    R"(<record name="bob" at="bob" quantities="position rotation"/>
       <record name="start" at="b.start" quantities="displacement rotation force moment"/>
       <record name="within" at="b@0.13" quantities="position force moment"/>
       <record name="d" at="d.end" quantities="displacement force moment"/>)";

TEST(Fused, OneNodeAndNoMultipliersButOfTheFoot) {
  const Scene scene =
      scene_of(frame + acts + records + R"(<transient duration="0.1" step="1e-2"/>)");
  const Model fused = compile(scene), apart = compile(kept(scene));
  EXPECT_EQ(fused.system->multipliers(), 6);
  EXPECT_EQ(apart.system->multipliers(), 42);
  EXPECT_EQ(fused.system->nodes(), apart.system->nodes() - 6);
  ASSERT_EQ(fused.fused.size(), 6u);
  EXPECT_EQ(fused.fused[0].label, "fixed \"ab\"");
  EXPECT_TRUE(apart.fused.empty());
  EXPECT_NEAR(fused.mass, apart.mass, 1e-14 * apart.mass);
  const CheckReport a = check_model(scene, fused), b = check_model(scene, apart);
  EXPECT_EQ(a.fused, 6);
  EXPECT_EQ(a.mechanism.freedoms(), b.mechanism.freedoms());
  EXPECT_TRUE(a.low.isApprox(b.low, 1e-14) && a.high.isApprox(b.high, 1e-14));
  EXPECT_NE(to_text(a).find("fused        6 fixed joints: what they join is one node"),
            std::string::npos);
  EXPECT_NEAR(a.energy.total(), b.energy.total(), 1e-13 * std::abs(b.energy.total()));
}

// Each method in time, statics and both: difference over the largest component of each quantity. Balance of momenta, in
// ArchOnAPlate: here its start would spread what sudden loads add over the nodes, of which there are others (1e-5).
TEST(Fused, MotionsAsWithMultipliers) {
  for (const char* const transient :
       {R"(<transient duration="0.3" step="5e-3" newton_tolerance="1e-12"/>)",
        R"(<transient duration="0.3" step="2e-2" method="radau" newton_tolerance="1e-12"/>)",
        R"(<static/> <transient duration="0.1" step="5e-3" newton_tolerance="1e-12"/>)"}) {
    const Scene scene = scene_of(frame + acts + records + transient);
    const History a = run_to_table(scene), b = run_to_table(kept(scene));
    ASSERT_TRUE(a.report.complete()) << a.report.failure;
    ASSERT_TRUE(b.report.complete()) << b.report.failure;
    expect_same(a.table, b.table, 1e-9, transient);
    // A tangent that is not that of the residual costs iterations (Radau's is taken apart in powers).
    EXPECT_LE(a.report.transient_counters.iterations,
              b.report.transient_counters.iterations * 11 / 10)
        << transient;
    EXPECT_GT(std::abs(a.table["bob.rotation.1"].back()), 1e-3) << "something moves";
  }
}

TEST(Fused, EquilibriaAsWithMultipliers) {
  const Scene scene = scene_of(frame + acts + static_records + "<static tolerance=\"1e-11\"/>");
  const History a = run_to_table(scene), b = run_to_table(kept(scene));
  ASSERT_TRUE(a.report.complete()) << a.report.failure;
  expect_same(a.table, b.table, 1e-9, "static");
  EXPECT_LT(a.report.unknowns, b.report.unknowns);
}

// IDA chooses its steps by norms over all nodes: the same to its tolerance.
TEST(FusedSlow, IdaAsWithMultipliers) {
  const Scene scene = scene_of(frame + acts +
                               R"(<record name="bob" at="bob" quantities="position"/>)"
                               R"(<transient duration="0.01" method="ida" tolerance="1e-7"/>)");
  const History a = run_to_table(scene), b = run_to_table(kept(scene));
  ASSERT_TRUE(a.report.complete()) << a.report.failure;
  expect_same(a.table, b.table, 1e-5, "ida");
}

// The tangent of wrapped elements at random large motions: columns of differences of order 8, 1e-8 of the largest entry
// of its part. A frame's adjoint left out of K or of D fails it by 1e-2.
TEST(Fused, TangentIsTheDerivative) {
  const Scene scene = scene_of(frame + acts + R"(<transient duration="0.1" step="1e-2"/>)");
  const Model model = compile(scene);
  const System& system = *model.system;
  Rng rng(7);
  State state = model.initial;
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    Vec6 U = random_vector<6>(rng, 0.3);
    U.head<3>() *= 0.2;
    state.pose[n] = state.pose[n] * exp_se3<double>(U);
    state.V[n] = random_vector<6>(rng, 2.0);
    state.Vdot[n] = random_vector<6>(rng, 5.0);
  }
  for (Index i = 0; i < state.lambda.size(); ++i) state.lambda(i) = uniform(rng, -5, 5);
  const Index n = 6 * (system.nodes() - 1);
  const auto tangent = [&](const TangentWeights& w) {
    DenseSolver S;
    S.analyze(system.graph());
    VecX r;
    EXPECT_TRUE(system.linearize(state, w, r, S));
    VecX plain;
    system.residual(state, plain);
    EXPECT_TRUE((r.array() == plain.array()).all()) << "to the last bit";
    return S.matrix();
  };
  const auto column = [&](Index c, double h, const auto& change) {
    return first_difference(
        [&](double x) {
          State moved = state;
          change(moved, static_cast<std::size_t>(1 + c / 6), c % 6, x);
          VecX r;
          system.residual(moved, r);
          return VecX(r.tail(r.size() - 6));
        },
        h);
  };
  struct Part {
    const char* name;
    TangentWeights weights;
    double h;
    std::function<void(State&, std::size_t, Index, double)> change;
  };
  const Part parts[] = {
      {"K",
       {1, 0, 0},
       1e-3,
       [](State& s, std::size_t k, Index i, double x) {
         s.pose[k] = s.pose[k] * exp_se3<double>(Vec6(x * Vec6::Unit(i)));
       }},
      {"dr/dV",
       {0, 1, 0},
       1e-2,
       [](State& s, std::size_t k, Index i, double x) { s.V[k](i) += x; }},
      {"dr/dVdot", {0, 0, 1}, 1.0, [](State& s, std::size_t k, Index i, double x) {
         s.Vdot[k](i) += x;
       }}};
  for (const Part& part : parts) {
    const Eigen::MatrixXd S = tangent(part.weights);
    double most = 0.0, size = 0.0;
    for (Index c = 0; c < n; ++c) {
      const VecX want = column(c, part.h, part.change);
      most = std::max(most, (want.head(n) - S.col(c).head(n)).cwiseAbs().maxCoeff());
      size = std::max(size, want.head(n).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(most, 1e-8 * size) << part.name;
  }
}

// A portal of members with shear and axial flexibility under a small force: its stiffness matrix, assembled here from
// the closed form of a plane member.
TEST(Fused, PortalBySlopeDeflection) {
  const double EA = 3e6, EI = 2e3, GA = 8e5, h = 2.0, l = 3.0, F = 1e-3;
  const std::string items = fmt::format(
      R"(<section name="s"><stiffness EA="{0}" GA2="{1}" GA3="{1}" GJ="1e3" EI2="{2}" EI3="{2}"/></section>
         <beam name="left" section="s" from="0 0 0" to="0 0 {3}" normal="1 0 0"/>
         <beam name="top" section="s" from="0 0 {3}" to="{4} 0 {3}" normal="0 0 1"/>
         <beam name="right" section="s" from="{4} 0 {3}" to="{4} 0 0" normal="0 1 0"/>
         <fixed name="A" between="ground left.start"/> <fixed name="B" between="left.end top.start"/>
         <fixed name="C" between="top.end right.start"/> <fixed name="D" between="right.end ground"/>
         <load at="top.start" force="{5} 0 0"/> <static tolerance="1e-12"/>
         <record name="B" at="left.end" quantities="displacement rotation"/>
         <record name="C" at="right.start" quantities="displacement"/>
         <record name="M" at="top.start" quantities="moment force"/>
         <record name="A" joint="A" quantities="reaction_force reaction_moment"/>)",
      EA, GA, EI, h, l, F);
  const Scene scene = scene_of(items);
  EXPECT_EQ(compile(scene).fused.size(), 2u);
  const Table t = run_to_table(scene).table;
  // Unknowns: u, w, turn about i2 at B and C. A member from p to q, local axis along it.
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(12, 12);  // A B C D
  const auto member = [&](int P, int Q, double x, double z) {
    const double L = std::hypot(x, z), c = x / L, s = z / L, phi = 12 * EI / (GA * L * L);
    const double k = EI / (L * L * L * (1 + phi));
    Eigen::Matrix<double, 6, 6> m = Eigen::Matrix<double, 6, 6>::Zero();
    // Local: along, across (along turned by +90 degrees in the x-z plane, to -z x), turn in that sense.
    m(0, 0) = m(3, 3) = EA / L, m(0, 3) = m(3, 0) = -EA / L;
    m(1, 1) = m(4, 4) = 12 * k, m(1, 4) = m(4, 1) = -12 * k;
    m(1, 2) = m(2, 1) = m(1, 5) = m(5, 1) = 6 * k * L;
    m(4, 2) = m(2, 4) = m(4, 5) = m(5, 4) = -6 * k * L;
    m(2, 2) = m(5, 5) = (4 + phi) * k * L * L;
    m(2, 5) = m(5, 2) = (2 - phi) * k * L * L;
    Eigen::Matrix<double, 6, 6> R = Eigen::Matrix<double, 6, 6>::Zero();
    for (const int i : {0, 3}) {
      R(i, i) = c, R(i, i + 1) = s, R(i + 1, i) = -s, R(i + 1, i + 1) = c;
      R(i + 2, i + 2) = -1.0;  // x to z is a turn about -i2
    }
    const Eigen::Matrix<double, 6, 6> g = R.transpose() * m * R;
    const int at[] = {3 * P, 3 * P + 1, 3 * P + 2, 3 * Q, 3 * Q + 1, 3 * Q + 2};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) K(at[i], at[j]) += g(i, j);
  };
  member(0, 1, 0, h), member(1, 2, l, 0), member(2, 3, 0, -h);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(6);
  f(0) = F;
  const Eigen::VectorXd u = dense::solve(K.block(3, 3, 6, 6), f);
  const Eigen::VectorXd reaction = K.block(0, 3, 3, 6) * u;
  const auto last = [&](const char* name) { return t[name].back(); };
  const double tolerance = 1e-6 * std::abs(u(0));
  EXPECT_NEAR(last("B.displacement.1"), u(0), tolerance);
  EXPECT_NEAR(last("B.displacement.3"), u(1), tolerance);
  EXPECT_NEAR(last("B.rotation.2"), u(2), 1e-6 * std::abs(u(2)));
  EXPECT_NEAR(last("C.displacement.1"), u(3), tolerance);
  EXPECT_NEAR(last("A.reaction_force.1"), reaction(0), 1e-6 * F);
  EXPECT_NEAR(last("A.reaction_force.3"), reaction(1), 1e-6 * F);
  EXPECT_NEAR(last("A.reaction_moment.2"), reaction(2), 1e-6 * F * h);
  // Sway: each column takes half; the corner's moment from statics of the left column.
  EXPECT_NEAR(std::abs(last("M.moment.2")) + std::abs(last("M.moment.3")),
              std::abs(reaction(2) - reaction(0) * h), 1e-5 * F * h);
}

// Two bodies fixed to each other, far off each other's origin and turned, tumble as one: Euler's equations of the
// combined inertia, by RK4, in 4000 steps.
TEST(Fused, TwoBodiesTumbleAsOne) {
  const double m1 = 2.0, m2 = 0.7;
  const Mat3 J1 = Vec3(0.3, 0.5, 0.6).asDiagonal(), J2 = Vec3(0.05, 0.08, 0.1).asDiagonal();
  const Vec3 r2(0.6, -0.4, 0.5), turn(0.4, 0.9, -0.3);
  const Mat3 R2 = exp_so3<double>(turn).toRotationMatrix();
  const Vec3 c = m2 * r2 / (m1 + m2);
  const auto steiner = [](double m, const Vec3& x) -> Mat3 { return -m * hat(x) * hat(x); };
  const Mat3 J = J1 + steiner(m1, c) + R2 * J2 * R2.transpose() + steiner(m2, r2 - c);
  Vec3 w(0.5, 3.0, -1.0);
  const Vec3 v1 = w.cross(Vec3(-c)), v2 = w.cross(r2 - c), own = R2.transpose() * w;
  const std::string items = fmt::format(
      R"(<body name="one" mass="{}" inertia="0.3 0.5 0.6" velocity="{} {} {}" angular_velocity="0.5 3 -1"/>
         <body name="two" at="0.6 -0.4 0.5" orientation="0.4 0.9 -0.3" mass="{}"
               inertia="0.05 0.08 0.1" velocity="{} {} {}" angular_velocity="{} {} {}"/>
         <fixed name="weld" between="one two" at="5 5 5"/>
         <transient duration="2" method="radau" tolerance="1e-11" output="1"/>
         <record name="one" at="one" quantities="angular_velocity_local"/>
         <record name="two" at="two" quantities="velocity_local angular_velocity_local"/>)",
      m1, v1(0), v1(1), v1(2), m2, v2(0), v2(1), v2(2), own(0), own(1), own(2));
  const Scene scene = scene_of(items);
  const Model model = compile(scene);
  ASSERT_EQ(model.fused.size(), 1u);
  EXPECT_EQ(model.system->unknowns(), 6);
  const Table t = run_to_table(scene).table;
  const Mat3 inverse = J.inverse();
  const auto rate = [&](const Vec3& x) -> Vec3 { return inverse * Vec3(J * x).cross(x); };
  const int steps = 4000;
  const double dt = 2.0 / steps;
  for (int k = 0; k < steps; ++k) {
    const Vec3 a = rate(w), b = rate(w + 0.5 * dt * a), d = rate(w + 0.5 * dt * b),
               e = rate(w + dt * d);
    w += dt / 6.0 * (a + 2.0 * b + 2.0 * d + e);
  }
  const Vec3 w2 = R2.transpose() * w, of_two = R2.transpose() * w.cross(r2 - c);
  for (int i = 0; i < 3; ++i) {
    const std::string k = std::to_string(i + 1);
    EXPECT_NEAR(t["one.angular_velocity_local." + k].back(), w(i), 1e-8);
    EXPECT_NEAR(t["two.angular_velocity_local." + k].back(), w2(i), 1e-8);
    EXPECT_NEAR(t["two.velocity_local." + k].back(), of_two(i), 1e-8);
  }
}

// A recorded joint among fused ones: its reaction is the load beyond it, its moment that about where it has gone to.
TEST(Fused, ReactionWithinAFusedFrameIsStatics) {
  const Scene scene =
      scene_of(sections +
               R"(<beam name="a" section="s" from="0 0 0" to="0 0 1" normal="1 0 0"/>
         <beam name="b" section="t" from="0 0 1" to="1 0 1" normal="0 0 1"/>
         <beam name="c" section="s" from="1 0 1" to="1 0.5 1" normal="0 0 1"/>
         <fixed name="foot" between="ground a.start"/> <fixed name="ab" between="a.end b.start"/>
         <fixed name="bc" between="b.end c.start"/>
         <load at="c.end" force="3 2 -5"/> <static tolerance="1e-12"/>
         <record name="tip" at="c.end" quantities="position"/>
         <record name="corner" at="b.start" quantities="position rotation"/>
         <record name="ab" joint="ab" quantities="reaction_force reaction_moment"/>)");
  const Model model = compile(scene);
  ASSERT_EQ(model.fused.size(), 1u);
  EXPECT_EQ(model.fused[0].label, "fixed \"bc\"");
  const Table t = run_to_table(scene).table;
  const auto at = [&](const std::string& name) {
    return Vec3(t[name + ".1"].back(), t[name + ".2"].back(), t[name + ".3"].back());
  };
  const Vec3 F(3, 2, -5), arm = at("tip.position") - at("corner.position");
  const Mat3 R = exp_so3<double>(at("corner.rotation")).toRotationMatrix();
  const Vec3 force = R.transpose() * Vec3(-F), moment = R.transpose() * Vec3(-arm.cross(F));
  EXPECT_LE((at("ab.reaction_force") - force).norm(), 1e-7 * F.norm());
  EXPECT_LE((at("ab.reaction_moment") - moment).norm(), 1e-7 * arm.cross(F).norm());
  EXPECT_GT((R - Mat3::Identity()).norm(), 0.02) << "it turns";
}

// A beam with both its ends on one plate, which is a node with that element alone: in free flight momenta stay.
TEST(Fused, ArchOnAPlateInFreeFlight) {
  const Scene scene =
      scene_of(sections +
               R"(<arc name="arch" section="t" from="-0.5 0 0" center="0 0 0" axis="0 1 0"
              angle="pi" normal="0 1 0" order="3" elements="2"/>
         <body name="plate" at="0 0 -0.1" mass="3" inertia="0.2 0.2 0.3"/>
         <fixed name="l" between="plate arch.start"/> <fixed name="r" between="arch.end plate"/>
         <load at="arch@0.5" force="(0.1>t?1e3*sin(pi*t/0.1):0) 0 0"/>)"
               R"(<transient duration="0.3" step="2e-3" newton_tolerance="1e-12"/>
         <record name="all" quantities="linear_momentum angular_momentum strain_energy"/>
         <record name="crown" at="arch@0.25" quantities="displacement force moment"/>)");
  const Model model = compile(scene);
  EXPECT_EQ(model.fused.size(), 2u);
  EXPECT_EQ(model.system->multipliers(), 0);
  EXPECT_EQ(model.system->nodes(), 2 + 5);
  const History a = run_to_table(scene), b = run_to_table(kept(scene));
  ASSERT_TRUE(a.report.complete()) << a.report.failure;
  expect_same(a.table, b.table, 1e-9, "arch");
  const Table& t = a.table;
  const double p = 1e3 * 0.2 / std::numbers::pi;                // the impulse [N.s]
  EXPECT_NEAR(t["all.linear_momentum.1"].back(), p, 2e-3 * p);  // of the trapezoidal rule
}

// Where something would be said of a joint, it keeps its multipliers.
TEST(Fused, KeptWhereMoreIsSaid) {
  const std::string three = sections +
                            R"(<beam name="a" section="s" from="0 0 0" to="0 0 1" normal="1 0 0"/>
         <beam name="b" section="t" from="0 0 1" to="1 0 1" normal="0 0 1"/>
         <beam name="c" section="s" from="0 0 1" to="0 1 1" normal="0 0 1"/>
         <fixed name="foot" between="ground a.start"/> <fixed name="ab" between="a.end b.start"/>
         <fixed name="ac" between="a.end c.start"/> <load at="c.end" force="0 0 -5"/> <static/>)";
  EXPECT_EQ(compile(scene_of(three)).fused.size(), 2u);
  // A loop: six rows repeat others.
  const Model loop = compile(scene_of(three + R"(<fixed name="bc" between="b.start c.start"/>)"));
  EXPECT_TRUE(loop.fused.empty());
  EXPECT_EQ(loop.redundant.size(), 6u);
  // Another joint in the same group.
  EXPECT_EQ(compile(scene_of(three + R"(<spherical name="bc" between="b.start c.start"/>)"))
                .redundant.size(),
            3u);
  // A spring, which would have two points on one node.
  EXPECT_TRUE(compile(scene_of(three + R"(<bushing name="k" between="b.start c.start"
                                 stiffness="1 1 1" angular_stiffness="1 1 1"/>)"))
                  .fused.empty());
  const auto message = [](const std::string& items) -> std::string {
    try {
      (void)compile(scene_of(items));
    } catch (const Error& e) {
      return e.what();
    }
    return "none";
  };
  // Velocities that disagree.
  const std::string bodies =
      R"(<body name="p" mass="1" inertia="1 1 1" velocity="1 0 0"/>
         <body name="q" at="1 0 0" mass="1" inertia="1 1 1" velocity="{} 0 0"/>
         <fixed name="pq" between="p q"/> <transient duration="1" step="0.1"/>)";
  EXPECT_EQ(message(fmt::format(fmt::runtime(bodies), "1")), "none");
  EXPECT_NE(
      message(fmt::format(fmt::runtime(bodies), "1.01"))
          .find("fixed \"pq\": position 1: the initial velocities open the joint at 0.01 m/s"),
      std::string::npos)
      << message(fmt::format(fmt::runtime(bodies), "1.01"));
  // Beams whose ends do not meet, near the origin and where round-off is a thousandth of the gap.
  EXPECT_NE(message(sections +
                    R"(<beam name="a" section="s" from="1e6 0 0" to="1e6 0 1" normal="1 0 0"/>
                       <beam name="b" section="t" from="1000000.0000001 0 1" to="1000001 0 1"
                             normal="0 0 1"/>
                       <fixed name="foot" between="ground a.start"/>
                       <fixed name="ab" between="a.end b.start"/> <static/>)")
                .find("fixed \"ab\": it is open"),
            std::string::npos);
  EXPECT_NE(
      message(sections +
              R"(<beam name="a" section="s" from="0 0 0" to="0 0 1" normal="1 0 0"/>
                       <beam name="b" section="t" from="0 0 1.001" to="1 0 1" normal="0 0 1"/>
                       <fixed name="foot" between="ground a.start"/>
                       <fixed name="ab" between="a.end b.start"/> <static/>)")
          .find("fixed \"ab\": it is open: beam 'a' node 4 is 0.001 m from the joint's point"),
      std::string::npos);
}

// Far from the origin and near it, the end of an arc and the start of a beam meet but for round-off.
TEST(Fused, EndsThatMeetButForRoundOff) {
  for (const double far : {0.0, 1.0, 1e6}) {
    const double third = 1.0 / 3.0;
    const Scene scene =
        scene_of(sections + fmt::format(R"(<arc name="a" section="s" from="{} 0 0" center="{} {} {}"
                                       axis="1 1 1" angle="2*pi/3" normal="1 1 1"/>
                                  <beam name="b" section="t" from="{} 1 0" to="{} 2 0"
                                        normal="0 0 1"/>
                                  <fixed name="foot" between="ground a.start"/>
                                  <fixed name="ab" between="a.end b.start"/>
                                  <load at="b.end" force="0 0 1e-2"/> <static/>)",
                                        far + 1.0, far + third, third, third, far, far));
    EXPECT_EQ(compile(scene).fused.size(), 1u) << far;
  }
}

}  // namespace
}  // namespace mbd::test::test_fused
