// An element and a joint of one's own, written as those of the library are: exact, with their tangents, in its batches.
//
// A satellite goes round a heavy centre, which attracts it by an element; a puck slides down a slope, which a joint of one row
// keeps it on.
//
// Build: see CMakeLists.txt beside this file. Run: own_parts
// Expect: half a turn of the ellipse ends where Kepler says; the puck has gone g sin b t^2/2 along the slope and presses on it
// with m g cos b. Exit status 0 if so.
#include <mbd/compile/extending.hpp>
#include <mbd/mbd.hpp>
#include <mbd/scene/reference_line.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

namespace {

// On its node acts f = -mu r/|r|^3, axes of the node. Residual: internal minus external forces; u and psi are increments of
// place and turn, axes of the node:  d(R^T f) = (R^T f)~ psi + R^T (df/dr) R u.
struct Attraction {
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;         // a tangent by motion
  static constexpr bool has_D = false;        // none by velocity
  static constexpr bool needs_rates = false;  // nor velocities at all

  struct Shared {  // by all elements of the batch
    double mu;     // [N.m2]
  };
  struct Data {};  // of an element
  template <class S>
  using Output = mbd::ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <mbd::Want want, class S>
  static S evaluate(const Shared& shared, const Data&, const mbd::NodeState<S>* x,
                    const mbd::Environment&, mbd::RateWeights, Output<S>& out) {
    const mbd::Vector3<S> b = x[0].H.p.conjugate() * x[0].H.r;  // R^T r
    const S r = b.norm(), k = S(shared.mu) / (r * r * r);
    const mbd::Vector3<S> f = -k * b, no_moment = mbd::Vector3<S>::Zero();
    out.r = mbd::six<S>(-f, no_moment);
    if constexpr (want == mbd::Want::tangent) {
      const mbd::Matrix3<S> one = mbd::Matrix3<S>::Identity(), none = mbd::Matrix3<S>::Zero();
      out.K << k * (one - S(3) / (r * r) * b * b.transpose()), -mbd::hat(f), none, none;
    }
    return r - S(1e-3);  // out of range nearer than that: Newton's method tries shorter steps
  }
  static mbd::Energies energies(const Shared& shared, const Data&, const mbd::NodeState<double>* x,
                                const mbd::Environment&) {
    return {.strain = -shared.mu / x[0].H.r.norm()};
  }
};

// The origin of frame a stays in the plane of e1 and e2 of frame b.
struct InPlane {
  static constexpr const char* name = "in_plane";
  static constexpr const char* doc = "A point of a stays in a plane of b.";
  static constexpr std::tuple rows{mbd::joint::position(3)};
  static constexpr mbd::joint::Traits traits{.axis = true};
};

}  // namespace

int main() try {
  constexpr double m = 2, mu = 40, far = 3, e = 0.5, a = far / (1 + e);
  const double half = M_PI * std::sqrt(m * a * a * a / mu);
  mbd::Scene scene = mbd::read_model_text(R"(<mbd name="own">
    <body name="moon" at="3 0 0" mass="2" inertia="0.1 0.1 0.1"/>
    <body name="puck" at="0 0 100" mass="0.5" inertia="0.01 0.01 0.01"/>
    <load at="puck" force="0 0 -5"/>
    <transient duration="1" tolerance="1e-9" method="radau"/>
  </mbd>)",
                                          "own");
  scene.bodies[0].velocity = mbd::Vec3(0, std::sqrt(mu / m * (1 - e) / far), 0);
  scene.transient->duration = half;

  mbd::OwnJoint slope;
  mbd::Extensions own;
  own.parts.push_back([&slope](mbd::Extending& to) {
    auto attraction =
        std::make_unique<mbd::ElementBatch<Attraction>>("attraction", Attraction::Shared{mu});
    attraction->add({}, std::array{to.place("moon").node}, "attraction of the moon");
    to.add_batch(std::move(attraction));
    mbd::Mat3 axes;  // e3, the normal, is (0.6, 0, 0.8)
    axes << 0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8;
    slope = to.add_joint<InPlane>("slope", "puck", "ground",
                                  mbd::make_pose(axes, mbd::Vec3(0, 0, 100)));
  });
  const mbd::Model model = mbd::compile(scene, own);
  const auto stepper = mbd::make_stepper(*model.system, *scene.transient);
  mbd::State state = model.initial;
  mbd::StepReport report = stepper->start(state);
  while (report.converged && state.t < half * (1 - 1e-12)) report = stepper->step(state);
  if (!report.converged) throw mbd::Error(report.failure, report.kind);

  const auto moon = static_cast<std::size_t>(mbd::node_index(model, "moon")),
             puck = static_cast<std::size_t>(mbd::node_index(model, "puck"));
  const mbd::Vec3 near = state.pose[moon].r, slid = state.pose[puck].r - mbd::Vec3(0, 0, 100);
  const double presses = -slope.reaction(state)(2);
  std::printf(
      "moon at %.6f %.6f m (%.6f 0); puck has gone %.6f m (%.6f), presses with %.6f N (4)\n",
      near.x(), near.y(), -a * (1 - e), slid.norm(), 3 * half * half, presses);
  const bool right = std::abs(near.x() + a * (1 - e)) < 1e-5 && std::abs(near.y()) < 1e-5 &&
                     std::abs(slid.norm() - 3 * half * half) < 1e-5 && std::abs(presses - 4) < 1e-6;
  return right ? 0 : 1;
} catch (const mbd::Error& error) {
  std::printf("%s (%s)\n", error.what(), std::string(mbd::name_of(error.kind())).c_str());
  return 2;
}
