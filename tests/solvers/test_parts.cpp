// Elements and joints of a program's own in a scene: a satellite about a fixed centre (Kepler), a point on an inclined plane (closed
// form), on what shares its node with something else as well; and what is refused.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "libmbd/compile/extending.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "tests/support/read_text.hpp"

namespace mbd::test::test_parts {
namespace {

// Attraction to the origin, f = -mu r/|r|^3 on a node:  r = -[ R^T f ; 0 ],  d(R^T f) = (R^T f)~ psi + R^T f' R u.
struct Attraction {
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;

  struct Shared {
    double mu;  // [N.m2]
  };
  struct Data {};
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  // Out of range within a millimetre.
  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data&, const NodeState<S>* x, const Environment&,
                    RateWeights, Output<S>& out) {
    const Vector3<S> b = x[0].H.p.conjugate() * x[0].H.r;
    const S r = b.norm(), k = S(shared.mu) / (r * r * r);
    const Vector3<S> f = -k * b;
    out.r = six<S>(-f, Vector3<S>::Zero());
    if constexpr (want == Want::tangent) {
      const Matrix3<S> by_u = -k * (Matrix3<S>::Identity() - S(3.0) / (r * r) * b * b.transpose());
      out.K << -by_u, -hat(f), Matrix3<S>::Zero(), Matrix3<S>::Zero();
    }
    return r - S(1e-3);
  }
  static Energies energies(const Shared& shared, const Data&, const NodeState<double>* x,
                           const Environment&) {
    return {.strain = -shared.mu / x[0].H.r.norm()};
  }
};

// a's origin stays in the plane through b's origin across b3.
struct InPlane {
  static constexpr const char* name = "in_plane";
  static constexpr const char* doc = "A point of a stays in a plane of b.";
  static constexpr std::tuple rows{joint::position(3)};
  static constexpr joint::Traits traits{.axis = true};
};
struct Hinge {
  static constexpr const char* name = "revolute";
  static constexpr const char* doc = "What the library has.";
  static constexpr std::tuple rows{joint::position(3)};
  static constexpr joint::Traits traits{.axis = true};
};

Extensions with(std::function<void(Extending&)> part) {
  Extensions own;
  own.parts.push_back(std::move(part));
  return own;
}

State run_to(const Model& model, const Scene& scene, double end) {
  const auto stepper = make_stepper(*model.system, *scene.transient);
  State state = model.initial;
  StepReport report = stepper->start(state);
  EXPECT_TRUE(report.converged) << report.failure;
  while (report.converged && state.t < end * (1.0 - 1e-12)) report = stepper->step(state);
  EXPECT_TRUE(report.converged) << report.failure;
  return state;
}

void attract(Extending& to, const std::string& what, double mu) {
  auto batch = std::make_unique<ElementBatch<Attraction>>("attraction", Attraction::Shared{mu});
  batch->add({}, std::array{to.place(what).node}, "attraction of " + what);
  to.add_batch(std::move(batch));
}

// From the far end of an ellipse: semi-axis a = r/(1 + e), period 2 pi sqrt(m a^3/mu); half of it later at a (1 - e).
TEST(Parts, SatelliteOnAnEllipse) {
  constexpr double m = 2.5, mu = 40.0, e = 0.6, far = 3.2, a = far / (1.0 + e);
  const double period = 2.0 * std::numbers::pi * std::sqrt(m * a * a * a / mu);
  const double slow = std::sqrt(mu / m * (1.0 - e) / far);
  const Scene scene = read(fmt::format(
      R"(<body name="moon" at="{0} 0 0" mass="2500 g" inertia="0.1 0.2 0.3" velocity="0 {1:.17g} 0" angular_velocity="1 2 3"/>
         <transient duration="{2:.17g}" method="radau" tolerance="1e-9"/>
         <record name="all" quantities="total_energy"/>)",
      far, slow, 0.5 * period));
  const Model model = compile(scene, with([](Extending& to) {
                                EXPECT_TRUE(to.has_rates());
                                EXPECT_EQ(to.system().nodes(), 2);
                                attract(to, "moon", mu);
                              }));
  const State state = run_to(model, scene, 0.5 * period);
  EXPECT_NEAR(state.pose[1].r(0), -a * (1.0 - e), 1e-6);
  EXPECT_NEAR(state.pose[1].r(1), 0.0, 1e-6);
  EXPECT_NEAR(model.system->energies(state).strain, -mu / (a * (1.0 - e)), 1e-4);
  EXPECT_NEAR(model.system->energies(state).total(), model.system->energies(model.initial).total(),
              1e-6);
}

// On a slope of angle b: g sin b along it, m g cos b across, twice, in one batch; the second on a body that a <fixed> joint holds
// in the first one's place, so that its node is another's.
TEST(Parts, PointsOnASlope) {
  for (const char* const method : {R"(step="0.01")", R"(step="0.05" method="radau")"}) {
    const Scene scene = read(fmt::format(R"(
      <body name="b" at="1 2 3" orientation="0.3 -0.2 0.9" mass="2" inertia="1 1 1"/>
      <body name="c" at="-4 0 1" mass="1.2" inertia="1 2 1"/>
      <body name="d" at="-4.5 0.25 1.5" orientation="1 0 0" mass="0.8" inertia="0.1 0.2 0.2"/>
      <fixed name="weld" between="c d"/>
      <gravity acceleration="0 0 -10"/><transient duration="1" {}/>)",
                                         method));
    // The normal is e3: (0.6, 0, 0.8).
    Mat3 R;
    R << 0.8, 0.0, 0.6, 0.0, 1.0, 0.0, -0.6, 0.0, 0.8;
    OwnJoint first, second;
    Vec3 middle = Vec3::Zero();  // of c and d
    int node = 0;
    const Model model = compile(
        scene, with([&](Extending& to) {
          first = to.add_joint<InPlane>("first", "b", "ground", make_pose(R, Vec3(1.0, 2.0, 3.0)));
          const PlaceInNode d = to.place("d"), c = to.place("c");
          node = d.node;
          EXPECT_EQ(c.node, d.node);
          EXPECT_LT((d.inertial.r - Vec3(-4.5, 0.25, 1.5)).norm(), 1e-14);
          // At the centre of mass of both, or they would turn.
          middle = (1.2 * c.inertial.r + 0.8 * d.inertial.r) / 2.0;
          second = to.add_joint<InPlane>("second", "d", "ground", make_pose(R, middle));
        }));
    EXPECT_EQ(first.batch, second.batch);
    EXPECT_EQ(model.makers.size(), 2U);
    EXPECT_EQ(model.makers[1].label, "in_plane \"second\"");
    const State state = run_to(model, scene, 1.0);
    for (const OwnJoint& joint : {first, second}) {
      const Vec6 reaction = joint.reaction(state);  // on the ground
      EXPECT_NEAR(reaction(2), -16.0, 1e-6) << method;
      EXPECT_LT(reaction.head<2>().norm(), 1e-9);
    }
    EXPECT_LT((state.pose[1].r - Vec3(1.0 + 2.4, 2.0, 3.0 - 1.8)).norm(), 1e-6) << method;
    const Vec3 moved =
        state.pose[static_cast<std::size_t>(node)].r - model.system->reference_pose(node).r;
    EXPECT_LT((moved - Vec3(2.4, 0.0, -1.8)).norm(), 1e-6) << method;
  }
}

TEST(Parts, AreRefusedByName) {
  const auto said = [](const std::function<void(Extending&)>& part) -> std::string {
    const Scene scene = read(R"(
      <body name="b" at="1 2 3" mass="2" inertia="1 1 1"/>
      <body name="anchor" attached_to="ground"><shape box="1 1 1"/></body>
      <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="60"/>
        <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
      <beam name="arm" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
      <spring name="s" between="ground b" at_a="0 0 0" stiffness="1"/>
      <transient duration="1" step="0.01"/>)");
    try {
      compile(scene, with(part));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const Pose<double> H = make_pose(Mat3::Identity(), Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(said([](Extending& to) { attract(to, "arm.end", 1.0); }), "no error");
  EXPECT_SAYS(said([](Extending& to) { to.place("bb"); }), "there is no node at \"bb\"");
  EXPECT_SAYS(said([](Extending& to) { to.place("arm"); }), "is a beam of 7 nodes");
  EXPECT_EQ(said([](Extending& to) { EXPECT_EQ(to.places("arm").size(), 7U); }), "no error");
  EXPECT_SAYS(said([](Extending& to) { to.add_batch(nullptr); }), "gives no batch");
  EXPECT_SAYS(said([](Extending& to) {
                attract(to, "b", 1.0);
                attract(to, "arm.end", 1.0);
              }),
              "batch of type \"attraction\", which there is");
  EXPECT_SAYS(said([&](Extending& to) { to.add_joint<Hinge>("h", "b", "ground", H); }),
              "the library has joints of that type");
  EXPECT_SAYS(said([&](Extending& to) { to.add_joint<InPlane>("p", "b", "b", H); }),
              "in_plane \"p\" joins a thing to itself");
  EXPECT_SAYS(said([&](Extending& to) { to.add_joint<InPlane>("p", "anchor", "ground", H); }),
              "joins a thing to itself");
  Pose<double> off = H;
  off.r(2) -= 0.25;
  EXPECT_SAYS(said([&](Extending& to) { to.add_joint<InPlane>("p", "b", "ground", H, off, 0.0); }),
              "in_plane \"p\"");
}

}  // namespace
}  // namespace mbd::test::test_parts
