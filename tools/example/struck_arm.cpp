// A flexible arm with a tip mass swings from a hinge and is struck: how a program builds a Scene, steps it,
// and reads and perturbs its State.
//
//     i3 ^
//        |
//        O=================o          released horizontal, at rest;  g = 9.81 along -i3
//      hinge (i2)   arm    tip mass   struck after half a second
//
// Build: see CMakeLists.txt beside this file. Run: struck_arm
// Expect: before and after the blow the energy is constant, but for what the integrator damps; the blow adds
// what the change of velocity says. Exit status 0 if so.
#include <mbd/mbd.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

// A plain rubber rod, 1 m long, 2 cm thick.
mbd::Scene make_scene() {
  constexpr double pi = std::numbers::pi;
  constexpr double L = 1.0, d = 0.02, E = 1e8, nu = 0.45, density = 1100.0;
  const double A = pi * d * d / 4.0, I = pi * std::pow(d, 4) / 64.0, G = E / (2.0 * (1.0 + nu));

  mbd::Scene scene;
  scene.name = "struck_arm";

  mbd::Section rod;
  rod.name = "rod";
  rod.stiffness.diagonal() << E * A, 0.9 * G * A, 0.9 * G * A, G * 2.0 * I, E * I, E * I;
  rod.mass.emplace(mbd::Mat6::Zero());
  rod.mass->diagonal() << density * A, density * A, density * A, density * 2.0 * I, density * I,
      density * I;
  scene.sections.push_back(rod);

  mbd::BeamScene arm;
  arm.name = "arm";
  arm.section = "rod";
  arm.line = mbd::Straight{mbd::Vec3(0, 0, 0), mbd::Vec3(L, 0, 0)};
  arm.normal = mbd::Vec3(0, 0, 1);
  arm.elements = 4;
  arm.order = 3;
  scene.beams.push_back(arm);

  mbd::BodyScene tip;
  tip.name = "tip";
  tip.attached_to = mbd::Place{mbd::Place::Kind::beam, "arm", 1.0};
  tip.mass = 0.1;
  tip.inertia = 1e-5 * mbd::Mat3::Identity();
  scene.bodies.push_back(tip);

  mbd::JointScene hinge;
  hinge.kind = "revolute";
  hinge.name = "hinge";
  hinge.b = mbd::Place{mbd::Place::Kind::beam, "arm", 0.0};
  hinge.axis = mbd::Vec3(0, 1, 0);
  scene.joints.push_back(hinge);

  scene.gravity.emplace().acceleration = mbd::Vec3(0, 0, -9.81);
  scene.transient.emplace().duration = 1.0;
  scene.transient->step = 1e-3;
  return scene;
}

// Turns every node about the hinge by 2 rad/s more: it agrees with the joint, as it must. Returns the energy that this adds.
double strike(const mbd::System& system, mbd::State& state) {
  const mbd::Vec3 spin(0, 2, 0);  // [rad/s], inertial
  const mbd::State quiet = state;
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    const mbd::Pose<double>& H = state.pose[n];
    const mbd::Vec3 v = H.p.conjugate() * spin.cross(H.r), w = H.p.conjugate() * spin;
    state.V[n] += mbd::six<double>(v, w);
  }
  mbd::State mean =
      quiet;  // kinetic energy gained = momentum at the mean velocity times the change
  for (std::size_t n = 1; n < mean.V.size(); ++n) mean.V[n] = 0.5 * (quiet.V[n] + state.V[n]);
  std::vector<mbd::Vec6> p(mean.V.size());
  system.momenta(mean, p);
  double gained = 0.0;  // to first and second order in the change of velocity
  for (std::size_t n = 1; n < p.size(); ++n) gained += p[n].dot(state.V[n] - quiet.V[n]);
  return gained;
}

}  // namespace

int main() {
  try {
    const mbd::Model model = mbd::compile(make_scene());
    const mbd::System& system = *model.system;
    const int tip = static_cast<int>(system.nodes()) - 1;  // the last node of the only beam

    mbd::GeneralizedAlphaOptions options;
    options.step = 1e-3;
    options.rho_infinity = 0.9;
    mbd::GeneralizedAlpha integrator(system, mbd::make_klu_solver(), options);

    mbd::State state = model.initial;
    mbd::StepReport report = integrator.start(state);
    const auto swing_until = [&](double t) {
      while (report.converged && state.t < t - 0.5 * options.step) report = integrator.step(state);
      if (!report.converged) throw mbd::Error(report.failure);
    };
    const auto show = [&](const char* when) {
      const mbd::Vec3 x = state.pose[static_cast<std::size_t>(tip)].r;
      const double energy = system.energies(state).total();
      std::printf("%-14s t = %.3f s   tip (%.4f, %.4f, %.4f) m   energy %.6f J\n", when, state.t,
                  x(0), x(1), x(2), energy);
      return energy;
    };

    const double released = show("released");
    swing_until(0.5);
    const double before = show("before blow");

    const double gained = strike(system, state);

    report = integrator.start(state);  // the state was changed: new accelerations and reactions
    const double after = show("after blow");
    swing_until(1.0);
    const double end = show("end");

    const bool kept =
        std::abs(before - released) < 1e-3 * after && std::abs(end - after) < 1e-3 * after;
    const bool added = std::abs(after - before - gained) < 1e-9 * after;
    if (!kept || !added)
      std::printf("the energy is not what it should be (gained %.9f J)\n", gained);
    return kept && added ? 0 : 1;
  } catch (const mbd::Error& error) {
    std::printf("%s\n", error.what());
    return 2;
  }
}
