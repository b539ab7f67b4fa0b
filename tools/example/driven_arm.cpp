// A program that has libmbd as a part: it moves a flexible arm to a target by a motor whose torque it sets a thousand times
// a second, in a wind that it computes on all nodes of the arm; keeps a checkpoint and goes on from it to the last bit; and has
// the equations of motion as matrices.
//
// Build: see CMakeLists.txt beside this file. Run: driven_arm
// Expect: the arm stands at its target after two seconds; both ways there are the same; the matrices know the inertia about the
// motor. Exit status 0 if so.
#include <mbd/mbd.hpp>

#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr const char* arm = R"(<mbd name="driven_arm">
  <input name="torque" unit="N.mm"/>
  <section name="strip"><stiffness EA="2e6" GA2="8e5" GA3="8e5" GJ="40" EI2="60" EI3="60"/>
    <mass per_length="0.8" inertia="4e-4 2e-4 2e-4"/></section>
  <beam name="arm" section="strip" from="0 0 0" to="1 0 0" normal="0 0 1" elements="3"/>
  <body name="rotor" attached_to="arm.start" mass="1" inertia="0.03 0.03 0.05"/>
  <revolute name="motor" between="ground arm.start" axis="0 0 1"/>
  <joint_torque joint="motor" moment="torque"/>
  <transient duration="2" step="1 ms"/>
  <record name="motor" joint="motor" quantities="angle rate"/>
  <record name="tip" at="arm.end" quantities="displacement"/>
</mbd>)";

// Drag across the arm, of the velocities of its nodes, in section axes.
bool wind(const mbd::PlacesMotion& at, std::span<mbd::Vec6> wrenches) {
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    const double v = at.velocities[i].y();
    wrenches[i].y() = -0.02 * v * std::abs(v);
  }
  return true;
}

// Holds the torque of a servo over each step, until t.
bool go_to(double t, double target, const mbd::Model& model, mbd::Stepper& stepper,
           mbd::State& state) {
  const std::size_t torque = mbd::input_index(model, "torque"),
                    angle = mbd::output_index(model, "motor.angle"),
                    rate = mbd::output_index(model, "motor.rate");
  std::vector<double> y(mbd::ports(model).outputs.size());
  while (state.t < t - 1e-9) {
    mbd::outputs(model, state, y);
    state.inputs[torque].hold(1e3 * (8.0 * (target - y[angle]) - 3.0 * y[rate]), state.t);
    if (const mbd::StepReport report = stepper.step(state); !report.converged) {
      std::printf("t = %g s: %s\n", state.t, report.failure.c_str());
      return false;
    }
  }
  return true;
}

}  // namespace

int main() {
  const double target = 0.7;
  const mbd::Scene scene = mbd::read_model_text(arm, "driven_arm");
  const mbd::Model model = mbd::compile(scene, {{mbd::make_force("wind", {"arm"}, wind)}});
  const auto stepper = mbd::make_stepper(*model.system, *scene.transient);
  mbd::State state = model.initial;
  if (!stepper->start(state).converged) return 1;
  if (!go_to(0.5, target, model, *stepper, state)) return 1;
  const mbd::Checkpoint checkpoint = stepper->save(state);
  if (!go_to(2.0, target, model, *stepper, state)) return 1;

  // Another stepper, as another process would have one.
  const auto other = mbd::make_stepper(*model.system, *scene.transient);
  mbd::State again;
  other->restore(checkpoint, again);
  if (!go_to(2.0, target, model, *other, again)) return 1;
  bool same = true;
  for (std::size_t n = 0; n < state.pose.size(); ++n)
    same = same && again.pose[n].r == state.pose[n].r && again.V[n] == state.V[n];

  std::vector<double> y(mbd::ports(model).outputs.size());
  mbd::outputs(model, state, y);
  const double angle = y[mbd::output_index(model, "motor.angle")];

  // From the torque in N.mm to the angle, slowly: 1/(J s^2), J of rotor and arm; bending is much faster.
  const mbd::Linearization linear = mbd::linearize(mbd::compile(scene), model.initial);
  const mbd::ReducedMotion& r = *linear.reduced;
  const double rate = 3.0;
  const Eigen::PartialPivLU<Eigen::MatrixXd> at(rate * r.E - r.A);
  const double transfer = (linear.C * at.solve(r.G))(0, 0) + linear.D(0, 0);
  const double inertia = 1e-3 / (transfer * rate * rate);
  std::printf("at %.4f rad, to go to %.4f; restored %s; inertia about the motor %.4f kg.m2\n",
              angle, target, same ? "to the last bit" : "otherwise", inertia);
  const bool right = std::abs(angle - target) < 1e-3 && same &&
                     std::abs(inertia / (0.05 + 0.8 / 3.0) - 1.0) < 0.01;
  return right ? 0 : 1;
}
