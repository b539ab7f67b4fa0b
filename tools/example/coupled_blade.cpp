// Two codes in one step: a blade of 50 nodes in a wind that another code computes, which cannot be called within Newton's iterations.
// Loads of that code are held within a step; the step is taken again with those of its end until they agree, and the
// factorisation is kept (remember(), go_back()). The same with a force inside the iterations is the reference.
//
// Build: see CMakeLists.txt beside this file. Run: coupled_blade
// Expect: both ways end at the same place, to a millionth of the deflection, in about 4 repetitions a step. Exit status 0 if so.
#include <mbd/mbd.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr const char* blade = R"(<mbd name="blade">
  <section name="strip"><stiffness EA="4e6" GA2="1e6" GA3="1e6" GJ="200" EI2="300" EI3="4e3"/>
    <mass per_length="1.5" inertia="4e-3 1e-3 3e-3"/></section>
  <beam name="blade" section="strip" from="0 0 0" to="3 0 0" normal="0 0 1" elements="7" order="7"/>
  <fixed name="root" between="ground blade.start"/>
  <transient duration="0.2" step="2 ms" rho_infinity="0.8"/>
  <record name="tip" at="blade.end" quantities="displacement"/>
</mbd>)";

// The aerodynamic code: strips in a wind of 12 m/s along i3 that has come to its strength after 20 ms.
bool strips(const mbd::PlacesMotion& at, std::span<mbd::Vec6> wrenches) {
  const double gust = at.t < 0.02 ? at.t / 0.02 : 1.0;
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    const mbd::Vec3 wind =
        at.poses[i].R().transpose() * mbd::Vec3(0, 0, 12 * gust) - at.velocities[i].head<3>();
    wrenches[i].z() = 0.3 * wind.z() * std::abs(wind.z()) / 50;
  }
  return true;
}

// What the other code has said last.
struct Held final : mbd::Force {
  std::vector<mbd::Vec6> wrenches;
  std::string name() const override { return "held"; }
  std::vector<std::string> places() const override { return {"blade"}; }
  // Nothing at t = 0, where checkpoints look at what tells one model from another: its loads may not have changed there.
  bool evaluate(const mbd::PlacesMotion& at, std::span<mbd::Vec6> now) const override {
    if (at.t <= 0) return true;
    for (std::size_t i = 0; i < now.size() && i < wrenches.size(); ++i) now[i] = wrenches[i];
    return true;
  }
  // It does not depend on the motion: without this, differences would be taken, 24 evaluations a node.
  bool derivatives(const mbd::PlacesMotion&, Eigen::MatrixXd&, Eigen::MatrixXd&) const override {
    return true;
  }
};

double tip(const mbd::Model& model, const mbd::State& state) {
  std::vector<double> y(mbd::ports(model).outputs.size());
  mbd::outputs(model, state, y);
  return y[mbd::output_index(model, "tip.displacement.3")];
}

}  // namespace

int main() try {
  const mbd::Scene scene = mbd::read_model_text(blade, "blade");

  const mbd::Model whole = mbd::compile(scene, {{mbd::make_force("wind", {"blade"}, strips)}});
  const auto inside = mbd::make_stepper(*whole.system, *scene.transient);
  mbd::State reference = whole.initial;
  mbd::StepReport report = inside->start(reference);
  while (report.converged && reference.t < 0.2 - 1e-9) report = inside->step(reference);
  if (!report.converged) throw mbd::Error(report.failure, report.kind);

  const auto held = std::make_shared<Held>();
  const mbd::Model model = mbd::compile(scene, {{held}});
  const auto stepper = mbd::make_stepper(*model.system, *scene.transient);
  mbd::State state = model.initial;
  // Nodes of the blade, and the code's answer to a state.
  std::vector<mbd::NamedPlace> places;  // a node may have several names
  std::vector<bool> seen(static_cast<std::size_t>(model.system->nodes()));
  for (const mbd::NamedPlace& place : mbd::named_places(model)) {
    const auto node = static_cast<std::size_t>(place.node);
    if (node > 0 && !seen[node]) places.push_back(place);
    seen[node] = true;
  }
  std::vector<mbd::Pose<double>> poses(places.size());
  std::vector<mbd::Vec6> velocities(places.size()), answer(places.size());
  const auto ask = [&](const mbd::State& now) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      poses[i] = now.pose[static_cast<std::size_t>(places[i].node)];
      velocities[i] = now.V[static_cast<std::size_t>(places[i].node)];
      answer[i].setZero();
    }
    strips({now.t, poses, velocities}, answer);
  };
  held->wrenches.assign(places.size(), mbd::Vec6::Zero());
  report = stepper->start(state);
  long steps = 0, takes = 0;
  while (report.converged && state.t < 0.2 - 1e-9) {
    const mbd::Checkpoint before = stepper->remember(state);
    for (int k = 0; k < 20; ++k) {
      if (k > 0) stepper->go_back(before, state);
      report = stepper->step(state);
      ++takes;
      if (!report.converged) break;
      ask(state);
      double change = 0.0;
      for (std::size_t i = 0; i < answer.size(); ++i)
        change = std::max(change, (answer[i] - held->wrenches[i]).norm());
      held->wrenches = answer;
      if (change < 1e-9) break;
    }
    ++steps;
  }
  if (!report.converged) throw mbd::Error(report.failure, report.kind);
  const double z = tip(model, state), wanted = tip(whole, reference);
  std::printf("%zu nodes, %ld steps, %.1f takes each: tip %.6f m; within the iterations %.6f m\n",
              places.size(), steps, static_cast<double>(takes) / static_cast<double>(steps), z,
              wanted);
  return places.size() == 50 && std::abs(z / wanted - 1) < 1e-6 && wanted > 0.01 ? 0 : 1;
} catch (const mbd::Error& error) {
  std::printf("%s (%s)\n", error.what(), std::string(mbd::name_of(error.kind())).c_str());
  return 2;
}
