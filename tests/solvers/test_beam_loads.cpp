// Loads along beams and on nodes, sections that vary, beams joined at angles: against closed forms, the
// differential equations of the rod (support/rod.hpp), and statics of the deformed configuration.
#include <gtest/gtest.h>

#include <numbers>

#include "libmbd/compile/model.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/statics.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/random.hpp"
#include "tests/support/rod.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_beam_loads {
namespace {

using std::numbers::pi;

Scene scene_of(const std::string& inside, const Overrides& set = {}) {
  return read_model_text("<mbd name=\"x\">" + inside + "</mbd>", "x.xml", set);
}

// The last accepted state as a map of columns.
struct Result {
  Table table;
  double operator()(const std::string& name) const { return table[name].back(); }
  Vec3 vector(const std::string& name) const {
    return {(*this)(name + ".1"), (*this)(name + ".2"), (*this)(name + ".3")};
  }
};
Result solve(const Scene& scene) {
  History history = run_to_table(scene);
  EXPECT_TRUE(history.report.complete()) << history.report.failure;
  return {std::move(history.table)};
}

Vec6 resultants_of(const Result& r, const std::string& name) {
  return six<double>(r.vector(name + ".force"), r.vector(name + ".moment"));
}
Vec6 reaction_of(const Result& r, const std::string& joint) {
  return six<double>(r.vector(joint + ".reaction_force"), r.vector(joint + ".reaction_moment"));
}

// ---- small deflections ------------------------------------------------------------------------

// A cantilever along i1 with a dead load q(s) between two fractions; EI = GA = 1, L = 2, EA large. The tip
// sinks by int q (x^2 (3 L - x)/6 EI + x/GA) dx.
const std::string cantilever = R"xml(
  <parameter name="q" value="1e-5"/>
  <section name="s"><stiffness EA="1e3" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/></section>
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="3" order="4"/>
  <fixed name="clamp" between="ground b.start"/>
  <static/>
  <record name="tip" at="b.end" quantities="displacement rotation"/>)xml";

struct SmallCase {
  std::string load;
  double deflection;  // of the tip for q = 1
};
// Exact: the polynomials are within reach of the elements. What is left is the square of the deflection, so
// the error falls with the load: 1e-9 at q = 1e-5. Detects 10 % of the load, EI or GA, a `from` or `to` that
// is not a boundary, a rule that is not exact.
TEST(DistributedLoad, SmallDeflectionsOfACantilever) {
  const double L = 2;
  const auto integral = [L](double from, double to, const auto& q) {
    double sum = 0.0;
    const Quadrature rule = gauss_rule(10);
    for (std::size_t i = 0; i < rule.points.size(); ++i) {
      const double s = from + 0.5 * (to - from) * (1 + rule.points[i]), x = L * s;
      sum += 0.5 * (to - from) * L * rule.weights[i] * q(s) * (x * x * (3 * L - x) / 6 + x);
    }
    return sum;
  };
  const double uniform = L * L * L * L / 8 + L * L / 2;  // w L^4/8 EI + w L^2/2 GA
  for (const SmallCase& c :
       {SmallCase{"force=\"0 0 -q\"", uniform}, SmallCase{"follower_force=\"0 0 -q\"", uniform},
        SmallCase{"force=\"0 0 -q*(1-s)\"", L * L * L * L / 30 + L * L / 6},
        SmallCase{"force=\"0 0 -q\" from=\"0.3\" to=\"0.7\"",
                  integral(0.3, 0.7, [](double) { return 1.0; })},
        SmallCase{"force=\"0 0 -q*s*s\" from=\"0.5\"",
                  integral(0.5, 1, [](double s) { return s * s; })},
        // moments per length c about i2: M(x) = c (L - x), u = c L^3/6 * 2
        SmallCase{"moment=\"0 q 0\"", L * L * L / 3},
        SmallCase{"follower_moment=\"0 q 0\"", L * L * L / 3}}) {
    for (const double q : {1e-4, 1e-5}) {
      const Result r = solve(scene_of(cantilever + "<distributed beam=\"b\" " + c.load + "/>",
                                      {{"q", std::to_string(q)}}));
      EXPECT_NEAR(-r("tip.displacement.3") / q / c.deflection, 1.0, 30 * q * q + 1e-11) << c.load;
    }
  }
}

// A cantilever whose bending stiffness falls linearly, EI = e(s) = 1 - 0.6 s, GA likewise, L = 1, dead force
// P at the tip: u/P = int (1-s)^2/e ds + int 1/e ds, closed forms with ln. As the load vanishes.
TEST(Stations, TaperedCantilever) {
  const std::string model = R"xml(
    <parameter name="P" value="1e-5"/><parameter name="end" value="0.4"/>
    <section name="s">
      <station at="0"><stiffness EA="1e3" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/></station>
      <station at="1"><stiffness EA="1e3" GA2="1" GA3="end" GJ="1" EI2="end" EI3="1"/></station>
    </section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <fixed name="clamp" between="ground b.start"/>
    <load at="b.end" force="0 0 P"/>
    <static/>
    <record name="tip" at="b.end" quantities="displacement"/>)xml";
  const double a = 0.6, log = std::log(1 - a);
  // (1 - s)^2 = ((e - (1 - a))/a)^2 with e = 1 - a s
  const double b = 1 - a,
               bending = (0.5 * (1 - b * b) - 2 * b * (1 - b) - b * b * log) / (a * a * a),
               shear = -log / a;
  for (int N = 2; N <= 4; ++N) {
    std::vector<double> h, error;
    for (const int elements : {2, 4, 8}) {
      Scene scene = scene_of(model);
      scene.beams[0].order = N;
      scene.beams[0].elements = elements;
      h.push_back(1.0 / elements);
      error.push_back(std::abs(solve(scene)("tip.displacement.3") / 1e-5 / (bending + shear) - 1));
    }
    if (N < 4) {
      EXPECT_GT(orders(h, error).back(), 2 * N - 0.4) << testing::PrintToString(error);
    }
    EXPECT_LT(error.back(), N == 2 ? 2e-5 : N == 3 ? 1e-7 : 1e-9) << N;
  }
  // 10 % of the taper is seen
  EXPECT_GT(std::abs(solve(scene_of(model, {{"end", "0.44"}}))("tip.displacement.3") / 1e-5 /
                         (bending + shear) -
                     1),
            1e-2);
}

// Rolled up by an end moment, the tapered beam turns by phi(s) = int M/e ds = -(M/a) ln(1 - a s) exactly, a
// large rotation; its tip is int (cos phi, -sin phi) ds. Order 2N for every metric, energy form. A cubic
// taper by four stations (smooth) is a cubic: as exact as if it were given by a formula.
const std::string rolled = R"xml(
  <section name="s"><stiffness EA="1e3" GA2="1e3" GA3="1e3" GJ="1" EI2="1" EI3="1"/></section>
  <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
  <fixed name="clamp" between="ground b.start"/>
  <load at="b.end" moment="0 1.5 0"/>
  <static steps="2"/>
  <record name="tip" at="b.end" quantities="position"/>)xml";

class TaperOrder : public testing::TestWithParam<Metric> {};
TEST_P(TaperOrder, RolledUp) {
  for (const bool smooth : {false, true}) {
    const auto e = [smooth](double s) {
      return smooth ? 1 - 0.9 * s + 0.3 * s * s + 0.1 * s * s * s : 1 - 0.6 * s;
    };
    const double M = 1.5;
    // composite Gauss, of phi as well
    Vec3 exact = Vec3::Zero();
    double phi = 0.0;
    const Quadrature rule = gauss_rule(12);
    const int panels = 40;
    for (int k = 0; k < panels; ++k) {
      const auto turned = [&](double from, double to) {
        double sum = 0.0;
        for (std::size_t i = 0; i < 12; ++i)
          sum += 0.5 * (to - from) * rule.weights[i] * M /
                 e(from + 0.5 * (to - from) * (1 + rule.points[i]));
        return sum;
      };
      const double s0 = double(k) / panels, s1 = double(k + 1) / panels;
      for (std::size_t i = 0; i < 12; ++i) {
        const double s = s0 + 0.5 * (s1 - s0) * (1 + rule.points[i]), angle = phi + turned(s0, s);
        exact += 0.5 * (s1 - s0) * rule.weights[i] * Vec3(std::cos(angle), 0, -std::sin(angle));
      }
      phi += turned(s0, s1);
    }
    if (!smooth) {
      EXPECT_NEAR(phi, -M / 0.6 * std::log(0.4), 1e-13);
    }

    for (int N = 2; N <= 4; ++N) {
      std::vector<double> h, error;
      for (const int elements : N == 2 ? std::vector{8, 16} : std::vector{4, 8}) {
        Scene scene = with(scene_of(rolled), GetParam(), Form::energy);
        scene.beams[0].order = N;
        scene.beams[0].elements = elements;
        Section& section = scene.sections[0];
        section.interpolation = smooth ? Interpolation::smooth : Interpolation::linear;
        for (const double at : smooth ? std::vector{0.0, 0.25, 0.6, 1.0} : std::vector{0.0, 1.0}) {
          section.stations.push_back({{}, at, section.stiffness, {}, {}, {}});
          section.stations.back().stiffness(4, 4) = e(at);
        }
        h.push_back(1.0 / elements);
        error.push_back((solve(scene).vector("tip.position") - exact).norm());
      }
      const std::string what = "N = " + std::to_string(N) + ": " + testing::PrintToString(error);
      EXPECT_GT(orders(h, error).back(), 2 * N - 0.5) << what;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Every, TaperOrder, testing::ValuesIn(all_metrics),
                         [](const auto& p) { return name_of(p.param); });

// Mass and its first moment by stations: linear in s, m = 3 - s, centre at x2 = 0.1 in both, so that
// M = int m dx and M x are those of the integrals, whatever the mesh. Detects 10 % of a mass.
TEST(Stations, MassAndItsFirstMoment) {
  const std::string station = R"xml(<station at="%"><stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1"
      EI3="1"/><mass per_length="3-%" inertia="1 1 1" center="0.1 0"/></station>)xml";
  const auto at = [&station](const std::string& x) {
    std::string text = station;
    for (std::size_t k; (k = text.find('%')) != std::string::npos;) text.replace(k, 1, x);
    return text;
  };
  const Scene scene = scene_of("<section name=\"s\">" + at("0") + at("1") + R"xml(</section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="3" order="2"/>
    <point_mass at="b@0.4" mass="0.7" offset="0 0.2 0.3"/>
    <gravity acceleration="1 10 100"/>
    <transient duration="1" step="0.1"/>)xml");
  const Model model = compile(scene);
  State state = model.initial;
  for (Vec6& V : state.V) V = Vec6(2, 0, 0, 0, 0, 0);
  const double mass = 5 + 0.7;  // int (3 - s) 2 ds
  const Vec3 moment = Vec3(4.0 * (1.5 - 1.0 / 3), 0.5, 0) + 0.7 * Vec3(0.8, 0.2, 0.3);
  const Energies e = model.system->energies(state);
  EXPECT_NEAR(e.kinetic, 0.5 * mass * 4, 1e-13);
  EXPECT_NEAR(e.potential, -moment.dot(Vec3(1, 10, 100)), 1e-12);
  // a rotation about the origin: int (x^2 + y^2) m + rotary inertia, of the point mass too
  for (std::size_t n = 1; n < state.V.size(); ++n) {
    const Vec3 r = state.pose[n].r;
    state.V[n] = six<double>(Vec3(Vec3::UnitZ().cross(r)), Vec3::UnitZ());
  }
  // int 4 s^2 (3 - s) 2 ds = 6; about z: inertia 1 per length already holds y^2 m; the point mass
  EXPECT_NEAR(model.system->energies(state).kinetic,
              0.5 * (6.0 + 2.0 + 0.7 * (0.8 * 0.8 + 0.2 * 0.2)), 1e-13);
}

// ---- large deflections against the equations of the rod ---------------------------------------

RodMatrix diagonal(double EA, double GA, double GJ, double EI) {
  RodVector d;
  d << EA, GA, GA, GJ, EI, EI;
  return d.asDiagonal();
}

// All loads follow the section: seen from the free end, this is an initial value problem. A tapered
// cantilever under a follower force and moment at an offset of its tip, and follower forces and moments along
// it: a tip that has gone half way round, out of the plane. Orders 2N; the paper's form too.
// Detects 10 % of any of the loads, of the offset, of D.
TEST(FollowerLoad, TaperedCantileverAgainstTheRod) {
  Rod rod;
  rod.D = [](double s) {
    RodMatrix D = diagonal(200, 80, 0.8, 1) * (1 - 0.5 * s);
    D(3, 4) = D(4, 3) = 0.1;
    return D;
  };
  rod.K0 = [](double) { return RodVector(RodVector::Unit(0)); };
  rod.follower = [](double s) {
    RodVector f;
    f << 0, 0.3, -2 * s, 0.1, 0, 0.2 * (1 - s);
    return f;
  };
  RodState end;
  end.n = Eigen::Vector3d(-0.4, 0.3, -0.8);
  end.m = Eigen::Vector3d(0.1, 0.2, 0.3) + Eigen::Vector3d(0.1, 0.05, -0.2).cross(end.n);
  const RodState start = integrate(rod, end, 4000, true);
  const Eigen::Vector3d exact = start.R.transpose() * (end.r - start.r);  // seen from the root
  const RodVector at_root = start.sectional();

  const std::string model = R"xml(
    <parameter name="f" value="-2"/><parameter name="m" value="0.3"/><parameter name="c" value="-0.2"/>
    <section name="s">
      <station at="0"><stiffness EA="200" GA2="80" GA3="80" GJ="0.8" EI2="1" EI3="1" D45="0.1"/></station>
      <station at="1"><stiffness EA="100" GA2="40" GA3="40" GJ="0.4" EI2=".5" EI3=".5" D45="0.1"/></station>
    </section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <fixed name="clamp" between="ground b.start"/>
    <load at="b.end" follower_force="-0.4 0.3 -0.8" follower_moment="0.1 0.2 m" offset="0.1 0.05 c"/>
    <distributed beam="b" follower_force="0 0.3 f*s" follower_moment="0.1 0 0.2*(1-s)"/>
    <static steps="4"/>
    <record name="tip" at="b.end" quantities="position"/>
    <record name="root" at="b.start" quantities="force moment"/>
    <record name="clamp" joint="clamp" quantities="reaction_force reaction_moment"/>)xml";
  for (const Form form : all_forms) {
    for (int N = 2; N <= 4; ++N) {
      std::vector<double> h, error;
      for (const int elements : N < 4 ? std::vector{4, 8, 16} : std::vector{4, 8}) {
        Scene scene = with(scene_of(model), Metric::geodesic, form);
        scene.beams[0].order = N;
        scene.beams[0].elements = elements;
        const Result r = solve(scene);
        h.push_back(1.0 / elements);
        error.push_back((r.vector("tip.position") - Vec3(exact)).norm());
        // statics: the clamp carries what the rod's equations say
        if (form == Form::energy && N == 4 && elements == 8) {
          EXPECT_LT((reaction_of(r, "clamp") + Vec6(at_root)).norm(), 1e-7)
              << reaction_of(r, "clamp");
          EXPECT_LT((resultants_of(r, "root") - Vec6(at_root)).norm(), 1e-5)
              << resultants_of(r, "root");
        }
      }
      const std::string what =
          name_of(form) + ", N = " + std::to_string(N) + ": " + testing::PrintToString(error);
      EXPECT_GT(orders(h, error).back(), 2 * N - 0.4) << what;
    }
  }
  for (const auto& [name, value] : {std::pair{"f", "-2.2"}, {"m", "0.33"}, {"c", "-0.22"}}) {
    Scene scene = scene_of(model, {{name, value}});
    scene.beams[0].order = 4;
    scene.beams[0].elements = 8;
    EXPECT_GT((solve(scene).vector("tip.position") - Vec3(exact)).norm(), 1e-3) << name;
  }
}

// Dead loads that vary along a cantilever, in all directions, to large rotations: n(s) is known, m(0) is found
// by shooting. Metrics and forms differ and agree. Detects 10 % of the force or of the moment.
TEST(DistributedLoad, DeadLoadAgainstTheRod) {
  Rod rod;
  rod.D = [](double) { return diagonal(200, 80, 0.8, 1); };
  rod.K0 = [](double) { return RodVector(RodVector::Unit(0)); };
  rod.dead = [](double s) {
    RodVector f;
    f << 1, 2 * s, -3 * (1 - s * s), 0.2, 0, 0.5 * s;
    return f;
  };
  const Eigen::Vector3d total(1, 1, -2);
  const auto shot = [&](const Eigen::VectorXd& m) {
    RodState x;
    x.n = total;
    x.m = m;
    return integrate(rod, x, 1500);
  };
  const Eigen::VectorXd m =
      root([&](const Eigen::VectorXd& y) { return Eigen::VectorXd(shot(y).m); },
           Eigen::Vector3d(0.1, 1, 0.5), Eigen::Vector3d::Ones());
  const Vec3 exact = shot(m).r;
  for (const Metric metric : all_metrics) {
    for (const Form form : all_forms) {
      Scene scene = with(scene_of(R"xml(
        <section name="s"><stiffness EA="200" GA2="80" GA3="80" GJ="0.8" EI2="1" EI3="1"/></section>
        <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="6" order="5"/>
        <fixed name="clamp" between="ground b.start"/>
        <distributed beam="b" force="1 2*s -3*(1-s^2)" moment="0.2 0 0.5*s"/>
        <static steps="3"/>
        <record name="tip" at="b.end" quantities="position"/>
        <record name="clamp" joint="clamp" quantities="reaction_force reaction_moment"/>)xml"),
                         metric, form);
      const Result r = solve(scene);
      EXPECT_LT((r.vector("tip.position") - exact).norm(), 1e-9)
          << name_of(metric) << name_of(form);
      EXPECT_LT((r.vector("clamp.reaction_force") + Vec3(total)).norm(),
                form == Form::energy ? 1e-11 : 1e-8);
      EXPECT_LT((r.vector("clamp.reaction_moment") + Vec3(m)).norm(), 1e-8);
      for (const std::size_t mutant : {0u, 1u}) {
        Scene wrong = scene;
        FieldExpression& f = mutant == 0 ? (*wrong.distributed_loads[0].force)[2]
                                         : (*wrong.distributed_loads[0].moment)[2];
        const FieldExpression::Term more[] = {{1.1, &f}};
        f = FieldExpression::sum(more);
        EXPECT_GT((solve(wrong).vector("tip.position") - exact).norm(), 1e-3);
      }
    }
  }
}

// A moment that follows the section and turns with it about its own axis is a dead one: the beam closes to a
// circle under either (scene roll_up).
TEST(FollowerLoad, RollUp) {
  for (const std::string moment : {"moment", "follower_moment"}) {
    const Result r = solve(scene_of(R"xml(
      <section name="s"><stiffness EA="1770e3" GA2="1770e3" GA3="1770e3" GJ="8.16e3" EI2="86.9e3"
               EI3="215e3"/></section>
      <beam name="b" section="s" from="0 0 0" to="10 0 0" normal="0 0 1" elements="4" order="6"/>
      <fixed name="clamp" between="ground b.start"/>
      <load at="b.end" )xml" + moment +
                                    R"xml(="0 2*pi*86.9e3/10 0"/>
      <static steps="4"/>
      <record name="tip" at="b.end" quantities="displacement"/>)xml"));
    EXPECT_LT((r.vector("tip.displacement") - Vec3(-10, 0, 0)).norm(), 1e-6) << moment;
  }
}

// The clamp of a cantilever that all kinds of loads have bent carries their sum: force, and moment about the
// root with the arms of the deformed configuration. Exact for the discrete beam (energy form), to the
// convergence of Newton's iteration. Detects 10 % of any load, a missing offset.
TEST(Loads, ReactionIsTheirResultant) {
  const Result r = solve(scene_of(R"xml(
    <section name="s"><stiffness EA="200" GA2="80" GA3="80" GJ="0.8" EI2="1" EI3="1"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
    <fixed name="clamp" between="ground b.start"/>
    <load at="b@0.6" force="0.3 0.2 -1" moment="0 0.1 0.1" offset="0.1 0.2 0.3"/>
    <load at="b.end" follower_force="0 0.4 0.3" follower_moment="0.1 0 0" offset="0 0 0.2"/>
    <static steps="3"/>
    <record name="middle" at="b@0.6" quantities="position rotation"/>
    <record name="tip" at="b.end" quantities="position rotation"/>
    <record name="clamp" joint="clamp" quantities="reaction_force reaction_moment"/>)xml"));
  const auto R = [&r](const std::string& name) {
    return exp_so3<double>(r.vector(name + ".rotation")).toRotationMatrix();
  };
  const Vec3 dead(0.3, 0.2, -1), follower = R("tip") * Vec3(0, 0.4, 0.3);
  const Vec3 a = r.vector("middle.position") + R("middle") * Vec3(0.1, 0.2, 0.3),
             b = r.vector("tip.position") + R("tip") * Vec3(0, 0, 0.2);
  const Vec3 moment =
      a.cross(dead) + Vec3(0, 0.1, 0.1) + b.cross(follower) + R("tip") * Vec3(0.1, 0, 0);
  EXPECT_LT((r.vector("clamp.reaction_force") + dead + follower).norm(), 1e-11);
  EXPECT_LT((r.vector("clamp.reaction_moment") + moment).norm(), 1e-11);
  EXPECT_GT(r.vector("tip.rotation").norm(), 0.3);
}

// ---- in time ----------------------------------------------------------------------------------

// The energy a swinging beam gains is the work of its loads, int load_power dt, to the second order of the
// time scheme. Detects 10 % of a load in the power, or a kind of load that it leaves out.
TEST(Loads, WorkIsTheGainInEnergy) {
  std::vector<double> h = {4e-3, 2e-3, 1e-3}, error;
  double gain = 0.0;
  for (const double step : h) {
    Scene scene = scene_of(R"xml(
      <section name="s"><stiffness EA="200" GA2="80" GA3="80" GJ="0.8" EI2="1" EI3="1"/>
                        <mass per_length="1" inertia="0.02 0.01 0.01"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
      <revolute name="hinge" between="ground b.start" axis="0 1 0.3"/>
      <point_mass at="b.end" mass="0.5" offset="0 0.1 0.1"/>
      <load at="b.end" force="0 0 t" moment="0.1*t 0 0" offset="0 0.2 0.1"/>
      <load at="b@0.5" follower_force="0 0.1 sin(3*t)" offset="0.1 0 0.1"/>
      <distributed beam="b" force="0 0 s*t" follower_force="0.1 0 t*(1-s)" follower_moment="0.1*t 0 0"/>
      <transient duration="1" step="1e-3" rho_infinity="0.9"/>)xml");
    const Model model = compile(scene);
    GeneralizedAlpha stepper(*model.system, make_klu_solver(),
                             {.step = step, .rho_infinity = 0.9, .newton = {}});
    State state = model.initial;
    EXPECT_TRUE(stepper.start(state).converged);
    double work = 0.0, before = model.system->power(state).loads;
    const double start = model.system->energies(state).total();
    while (state.t < 1.0 - 0.5 * step) {
      ASSERT_TRUE(stepper.step(state).converged);
      const double now = model.system->power(state).loads;
      work += 0.5 * step * (before + now);
      before = now;
    }
    gain = model.system->energies(state).total() - start;
    error.push_back(std::abs(work / gain - 1));
  }
  EXPECT_GT(gain, 0.05);
  EXPECT_LT(error.back(), 1e-4) << testing::PrintToString(error);
  EXPECT_GT(fitted_order(h, error), 1.8) << testing::PrintToString(error);
}

// Weight is a dead force at the mass centre, of a body too. By Radau: from when on generalized-alpha projects velocities
// hangs on the last bits. Detects a body's load without its offset.
TEST(Loads, WeightIsADeadForceAtTheMassCentre) {
  const auto top = [](const std::string& load) {
    return solve(
        scene_of(R"xml(<body name="top" mass="2" center="0.3 0.1 0.4" inertia="0.1 0.2 0.25"
        angular_velocity="1 2 9"/><spherical name="O" between="ground top"/>)xml" +
                 load + R"xml(<transient method="radau" duration="0.5" step="0.01"/>
        <record name="top" at="top" quantities="rotation angular_velocity"/>)xml"));
  };
  const Result a = top("<gravity acceleration=\"0 1 -9\"/>"),
               b = top("<load at=\"top\" force=\"0 2 -18\" offset=\"0.3 0.1 0.4\"/>"),
               c = top("<load at=\"top\" force=\"0 2 -18\"/>");
  for (const std::string name : {"top.rotation", "top.angular_velocity"}) {
    EXPECT_LT((a.vector(name) - b.vector(name)).norm(), 1e-11) << name;
    EXPECT_GT((a.vector(name) - c.vector(name)).norm(), 1e-2) << name;
  }
}

// A point mass on a beam is a body without inertia at the same offset, to the last digits of a motion.
TEST(PointMass, IsABodyWithoutInertia) {
  const std::string model = R"xml(
    <section name="s"><stiffness EA="200" GA2="80" GA3="80" GJ="0.8" EI2="1" EI3="1"/>
                      <mass per_length="1" inertia="0.02 0.01 0.01"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
    <spherical name="hinge" between="ground b.start"/>
    <body name="ball" at="1 0 0" mass="1" inertia="1 1 1" center="0.1 0 0"/>
    <fixed name="weld" between="b.end ball"/>
    <gravity acceleration="0 1 -9"/>
    <transient duration="0.2" step="1e-2"/>
    <record name="x" at="b.end" quantities="position velocity"/>)xml";
  const Result a = solve(scene_of(model + R"xml(<point_mass at="b@0.3" mass="2" offset="0 0.1 0.2"/>
                                             <point_mass at="ball" mass="0.5" offset="0 0 0.3"/>)xml")),
               b = solve(scene_of(model + R"xml(
      <body name="p" attached_to="b@0.3" mass="2" center="0 0.1 0.2" inertia="0 0 0"/>
      <body name="q" at="1 0 0" mass="0.5" center="0 0 0.3" inertia="0 0 0"/>
      <fixed name="w" between="ball q"/>)xml")),
               without = solve(scene_of(model));
  for (const std::string name : {"x.position", "x.velocity"}) {
    EXPECT_LT((a.vector(name) - b.vector(name)).norm(), 1e-9) << name;
    EXPECT_GT((a.vector(name) - without.vector(name)).norm(), 1e-3) << name;
  }
}

// ---- beams joined at angles -------------------------------------------------------------------

// Three beams in three directions welded in one point, loaded at two ends: what the sections of the three
// transmit there is in equilibrium, in the deformed configuration, and the clamp carries the loads. The
// resultants are those of the elements: they converge. Detects 10 % of a load or of one beam's D in the sum.
TEST(Joined, TreeIsInEquilibrium) {
  std::vector<double> h, error;
  for (const int elements : {2, 4, 8}) {
    Scene scene = scene_of(R"xml(
      <section name="s"><stiffness EA="200" GA2="80" GA3="80" GJ="0.8" EI2="1" EI3="1"/></section>
      <beam name="trunk" section="s" from="0 0 0" to="0 0 1" normal="1 0 0"/>
      <beam name="left" section="s" from="0 0 1" to="-0.5 0 1.5" normal="0 1 0"/>
      <beam name="right" section="s" from="0 0 1" to="0.6 0.3 1.2" normal="0 0 1"/>
      <fixed name="root" between="ground trunk.start"/>
      <fixed name="weld1" between="trunk.end left.start"/>
      <fixed name="weld2" between="trunk.end right.start"/>
      <load at="left.end" force="0 0.4 -0.3"/>
      <load at="right.end" force="-0.2 0.3 0.2" moment="0 0.1 0"/>
      <static steps="2"/>
      <record name="t" at="trunk.end" quantities="force moment rotation"/>
      <record name="l" at="left.start" quantities="force moment rotation"/>
      <record name="r" at="right.start" quantities="force moment rotation"/>
      <record name="root" joint="root" quantities="reaction_force reaction_moment"/>
      <record name="le" at="left.end" quantities="position"/>
      <record name="re" at="right.end" quantities="position"/>)xml");
    for (BeamScene& beam : scene.beams) {
      beam.order = 3;
      beam.elements = elements;
    }
    const Result r = solve(scene);
    const auto inertial = [&r](const std::string& name, const Mat3& R0) {
      const Mat3 R = exp_so3<double>(r.vector(name + ".rotation")).toRotationMatrix() * R0;
      return six<double>(R * r.vector(name + ".force"), R * r.vector(name + ".moment"));
    };
    const auto axes = [](Vec3 b1, Vec3 b3) {
      b1.normalize();
      b3 = (b3 - b3.dot(b1) * b1).normalized();
      Mat3 R;
      R << b1, b3.cross(b1), b3;
      return R;
    };
    const Vec6 trunk = inertial("t", axes({0, 0, 1}, {1, 0, 0})),
               left = inertial("l", axes({-0.5, 0, 0.5}, {0, 1, 0})),
               right = inertial("r", axes({0.6, 0.3, 0.2}, {0, 0, 1}));
    EXPECT_LT((r.vector("t.rotation") - r.vector("l.rotation")).norm(), 1e-12);
    EXPECT_GT(r.vector("t.rotation").norm(), 0.2);
    const Vec3 f1(0, 0.4, -0.3), f2(-0.2, 0.3, 0.2);
    EXPECT_LT((r.vector("root.reaction_force") + f1 + f2).norm(), 1e-11);
    EXPECT_LT((r.vector("root.reaction_moment") + r.vector("le.position").cross(f1) +
               r.vector("re.position").cross(f2) + Vec3(0, 0.1, 0))
                  .norm(),
              1e-11);
    h.push_back(1.0 / elements);
    error.push_back((trunk - left - right).norm() / trunk.norm());
    EXPECT_GT((trunk - 1.1 * left - right).norm() / trunk.norm(), 1e-2);
  }
  EXPECT_LT(error.back(), 2e-5) << testing::PrintToString(error);
  EXPECT_GT(fitted_order(h, error), 2.9) << testing::PrintToString(error);
}

// Fixed-base portal frame, columns h = 1, beam L = 1.5 of twice the stiffness, load H at the left corner.
// As the load vanishes: the slope-deflection method with extension and shear, a 6x6 system of two corners
// (u, w, rotation); and for stiff EA, GA Kleinlogel's formulae with k = (I_b/I_c)(h/L):
//   sway H h^3 (3k + 2)/(12 E I_c (6k + 1)),   moment at the feet H h/2 (3k + 1)/(6k + 1).
// Detects 10 % of the load or of any stiffness that matters.
struct Member {
  double EA, GA, EI, length, c, s;  // direction in the plane (x, z)
  // Stiffness in the axes of the frame, of the ends' (u, w, rotation about -i2 ...): Timoshenko.
  Eigen::Matrix<double, 6, 6> K() const {
    const double f = 12 * EI / (GA * length * length),
                 k = EI / (length * length * length * (1 + f)), a = EA / length, l = length;
    Eigen::Matrix<double, 6, 6> local, T;
    local << a, 0, 0, -a, 0, 0,                                                 //
        0, 12 * k, 6 * k * l, 0, -12 * k, 6 * k * l,                            //
        0, 6 * k * l, (4 + f) * k * l * l, 0, -6 * k * l, (2 - f) * k * l * l,  //
        -a, 0, 0, a, 0, 0,                                                      //
        0, -12 * k, -6 * k * l, 0, 12 * k, -6 * k * l,                          //
        0, 6 * k * l, (2 - f) * k * l * l, 0, -6 * k * l, (4 + f) * k * l * l;
    Eigen::Matrix3d R;
    R << c, s, 0, -s, c, 0, 0, 0, 1;
    T << R, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), R;
    return T.transpose() * local * T;
  }
};

std::string portal(double EA, double GA, double H) {
  const auto stiffness = [&](double factor) {
    const auto x = [factor](double v) { return std::to_string(v * factor); };
    return "<stiffness EA=\"" + x(EA) + "\" GA2=\"" + x(GA) + "\" GA3=\"" + x(GA) + "\" GJ=\"" +
           x(1) + "\" EI2=\"" + x(1) + "\" EI3=\"" + x(1) + "\"/>";
  };
  return "<section name=\"column\">" + stiffness(1) + "</section><section name=\"beam\">" +
         stiffness(2) + R"xml(</section>
    <beam name="left" section="column" from="0 0 0" to="0 0 1" normal="1 0 0" elements="3" order="4"/>
    <beam name="top" section="beam" from="0 0 1" to="1.5 0 1" normal="0 0 1" elements="3" order="4"/>
    <beam name="right" section="column" from="1.5 0 1" to="1.5 0 0" normal="1 0 0" elements="3" order="4"/>
    <fixed name="A" between="ground left.start"/><fixed name="B" between="left.end top.start"/>
    <fixed name="C" between="top.end right.start"/><fixed name="D" between="right.end ground"/>
    <load at="left.end" force=")xml" +
         std::to_string(H) + R"xml( 0 0"/>
    <static/>
    <record name="B" at="left.end" quantities="displacement"/>
    <record name="C" at="right.start" quantities="displacement"/>
    <record name="foot" at="left.start" quantities="moment"/>)xml";
}

TEST(Joined, PortalFrame) {
  const double EA = 50, GA = 20;
  Eigen::Matrix<double, 6, 6> K = Member{2 * EA, 2 * GA, 2, 1.5, 1, 0}.K();
  K.topLeftCorner<3, 3>() += Member{EA, GA, 1, 1, 0, 1}.K().bottomRightCorner<3, 3>();
  K.bottomRightCorner<3, 3>() += Member{EA, GA, 1, 1, 0, -1}.K().topLeftCorner<3, 3>();
  const Eigen::VectorXd u = dense::solve(K, Eigen::VectorXd(Eigen::VectorXd::Unit(6, 0)));
  std::vector<double> error;
  for (const double H : {1e-2, 1e-3}) {
    const Result r = solve(scene_of(portal(EA, GA, H)));
    Eigen::Vector4d got(r("B.displacement.1"), r("B.displacement.3"), r("C.displacement.1"),
                        r("C.displacement.3"));
    error.push_back((got / H - Eigen::Vector4d(u(0), u(1), u(3), u(4))).norm() / u.norm());
  }
  EXPECT_LT(error[1], 1e-4);
  EXPECT_NEAR(error[0] / error[1], 10, 1) << "the first-order term of the deflection remains";

  const double k = 2 / 1.5, H = 1e-4;
  const Result stiff = solve(scene_of(portal(1e7, 1e7, H)));
  EXPECT_NEAR(stiff("B.displacement.1") / H, (3 * k + 2) / (12 * (6 * k + 1)), 1e-5);
  EXPECT_NEAR(std::abs(stiff("foot.moment.2")) / H, 0.5 * (3 * k + 1) / (6 * k + 1), 1e-4);
}

// ---- models -----------------------------------------------------------------------------------

// The numbers of models/portal_frame.xml: one rod A-B-C-D with corners. Unknown: force and moment at A, in
// the plane; known: the foot D does not move and does not turn. Detects 10 % of any load or stiffness in the
// plane.
TEST(Joined, PortalFrameModelAgainstTheRod) {
  const double h = 4, L = 6, H = 20e3, q = 5e3;
  const auto rod = [](double length, RodMatrix D, double load) {
    Rod r;
    r.length = length;
    r.D = [D](double) { return D; };
    r.K0 = [](double) { return RodVector(RodVector::Unit(0)); };
    if (load != 0.0) r.dead = [load](double) { return RodVector(-load * RodVector::Unit(2)); };
    return r;
  };
  const Rod column = rod(h, diagonal(5e7, 2e7, 2e5, 2e5), 0),
            beam = rod(L, diagonal(8e7, 3e7, 4e5, 4e5), q);
  const auto axes = [](const Vec3& b1, const Vec3& b3) {
    Eigen::Matrix3d R;
    R << b1, b3.cross(b1), b3;
    return R;
  };
  const Eigen::Matrix3d left = axes(Vec3(0, 0, 1), Vec3(1, 0, 0)),
                        top = axes(Vec3(1, 0, 0), Vec3(0, 0, 1)),
                        right = axes(Vec3(0, 0, -1), Vec3(1, 0, 0));
  struct Frame {
    RodState A, B, C, D;
  };
  const auto shot = [&](const Eigen::VectorXd& x) {  // in units of H and H h
    Frame f;
    f.A.R = left;
    f.A.n = H * Eigen::Vector3d(x(0), 0, x(1));
    f.A.m = H * h * Eigen::Vector3d(0, x(2), 0);
    f.B = integrate(column, f.A, 400);
    RodState start = f.B;
    start.R = f.B.R * left.transpose() * top;
    start.n -= Eigen::Vector3d(H, 0, 0);
    f.C = integrate(beam, start, 600);
    start = f.C;
    start.R = f.C.R * top.transpose() * right;
    f.D = integrate(column, start, 400);
    return f;
  };
  const Eigen::VectorXd x = root(
      [&](const Eigen::VectorXd& y) {
        const RodState D = shot(y).D;
        return Eigen::VectorXd(
            Eigen::Vector3d(D.r(0) / L - 1, D.r(2) / L, D.R.col(0).dot(right.col(2))));
      },
      Eigen::Vector3d(0.5, -0.3, 0.3), Eigen::Vector3d::Ones());
  const Frame f = shot(x);
  const Result r = solve(model_scene("portal_frame"));
  EXPECT_LT((r.vector("B.displacement") + Vec3(0, 0, h) - f.B.r).norm(), 1e-9);
  EXPECT_LT((r.vector("C.displacement") + Vec3(L, 0, h) - f.C.r).norm(), 1e-9);
  EXPECT_LT((reaction_of(r, "A") + six<double>(Vec3(f.A.n), Vec3(f.A.m))).norm() / (H * h), 1e-9);
  EXPECT_LT((reaction_of(r, "D") - six<double>(Vec3(f.D.n), Vec3(f.D.m))).norm() / (H * h), 1e-9);
}

// The numbers of models/swept_cantilever.xml, on the exact curve. Unknown: the attitude of the tip, at which
// force and moment are known; known: that of the root. Detects 10 % of any entry of a station, a load, the
// twist, the point mass or its offset, and a linear table without its kink.
TEST(Curve, SweptCantileverModelAgainstTheRod) {
  using Eigen::Vector3d, Eigen::Matrix3d;
  const auto line = [](double u) { return Vector3d(10 * u, -1.5 * u * u, 0.6 * u * u * u); };
  const auto speed = [](double u) { return Vector3d(10, -3 * u, 1.8 * u * u).norm(); };
  const auto frame = [](double u) {
    const Vector3d t = Vector3d(10, -3 * u, 1.8 * u * u).normalized();
    const Vector3d b3 = (Vector3d::UnitZ() - t(2) * t).normalized();
    Matrix3d R;
    R << t, b3.cross(t), b3;
    return Matrix3d(R * Eigen::AngleAxisd(12 * pi / 180 * (1 - u), Vector3d::UnitX()));
  };
  // at half steps: parameter u by integrating du/ds, K0 by differences, D, mass
  const int steps = 1600;
  const Quadrature rule = gauss_rule(12);
  const auto length_to = [&](double u) {
    double sum = 0.0;
    for (int k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < 12; ++i)
        sum += u / 8 * rule.weights[i] * speed(u / 4 * (k + 0.5 * (1 + rule.points[i])));
    return sum;
  };
  const double length = length_to(1);
  std::vector<RodMatrix> D;
  std::vector<RodVector> K0;
  std::vector<double> mass;
  const auto table = [](double s, double a, double b, double c) {
    return s < 0.5 ? a + 2 * s * (b - a) : b + (2 * s - 1) * (c - b);
  };
  double u = 0.0;
  for (int k = 0; k <= 2 * steps; ++k) {
    const double s = 0.5 * k / steps;
    for (int i = 0; i < 8; ++i) u -= (length_to(u) - s * length) / speed(u);
    const Matrix3d dR = first_difference([&](double e) { return frame(u + e); }, 0.02);
    const Matrix3d W = frame(u).transpose() * dR / speed(u);
    RodVector one;
    one << 1, 0, 0, W(2, 1), W(0, 2), W(1, 0);
    K0.push_back(one);
    RodVector d;
    d << table(s, 4e8, 2e8, 8e7), table(s, 8e7, 4e7, 2e7), table(s, 6e7, 3e7, 1.5e7),
        table(s, 2e6, 6e5, 2e5), table(s, 4e6, 1.2e6, 4e5), table(s, 2e7, 6e6, 2e6);
    D.emplace_back(d.asDiagonal());
    D.back()(3, 4) = D.back()(4, 3) = table(s, 4e5, 1.2e5, 4e4);
    mass.push_back(table(s, 120, 60, 30));
  }
  const auto at = [&](double s) {
    return static_cast<std::size_t>(std::lround(2 * steps * s / length));
  };
  Rod rod;
  rod.length = length;
  rod.D = [&](double s) { return D[at(s)]; };
  rod.K0 = [&](double s) { return K0[at(s)]; };
  rod.dead = [&](double s) { return RodVector(-9.81 * mass[at(s)] * RodVector::Unit(2)); };
  rod.follower = [&](double s) {
    return RodVector(4e3 * (1 - 0.5 * s / length) * RodVector::Unit(2));
  };
  const auto end = [&](const Eigen::VectorXd& phi) {
    RodState x;
    x.R = exp_so3<double>(Vec3(phi)).toRotationMatrix() * frame(1);
    x.n = Vector3d(0, 0, -40 * 9.81);
    x.m = (x.R * Vector3d(0, 0.3, 0.05)).cross(x.n);
    return x;
  };
  const Eigen::VectorXd phi = root(
      [&](const Eigen::VectorXd& y) {
        const RodState start = integrate(rod, end(y), steps, true);
        const Matrix3d W = frame(0).transpose() * start.R;
        return Eigen::VectorXd(Vector3d(W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1)) /
                               2);
      },
      Vector3d(0, -0.5, 0), Vector3d::Ones());
  const RodState tip = end(phi), start = integrate(rod, tip, steps, true);
  const Vec3 exact = tip.r - start.r - line(1);
  const Result r = solve(model_scene("swept_cantilever"));
  EXPECT_LT((r.vector("tip.displacement") - exact).norm(), 1e-9);
  const Vec6 at_root = six<double>(Vec3(start.n), Vec3(start.m));
  EXPECT_LT((reaction_of(r, "root") + at_root).norm() / at_root.norm(), 1e-9);
}

}  // namespace
}  // namespace mbd::test::test_beam_loads
