// A tether and a wire of one's own, as forces: the library knows neither.
//
// A mass falls on a tether that is slack at first. A bead slides along a wire in the shape of a parabola: a joint that acts by a stiff
// force across the wire, so it gives by microns, where the library's own joints are exact.
//
// Build: see CMakeLists.txt beside this file. Run: own_forces
// Expect: the tether is longest by (m g/k) (1 + sqrt(1 + 2 k d/(m g))) after a fall of d; the bead passes the lowest
// point at sqrt(2 g h). Exit status 0 if so.
#include <mbd/mbd.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr double g = 9.81;

// From the origin to a place; it pulls when it is longer than its length. The potential makes it part of the energy balance.
class Tether final : public mbd::Force {
 public:
  Tether(std::string place, double length, double stiffness)
      : place_(std::move(place)), length_(length), stiffness_(stiffness) {}
  std::string name() const override { return "tether"; }
  std::vector<std::string> places() const override { return {place_}; }
  bool evaluate(const mbd::PlacesMotion& at, std::span<mbd::Vec6> wrenches) const override {
    const mbd::Vec3& r = at.poses[0].r;
    const double longer = r.norm() - length_;
    if (longer > 0)
      wrenches[0].head<3>() = at.poses[0].R().transpose() * (-stiffness_ * longer * r.normalized());
    return true;
  }
  std::optional<double> energy(const mbd::PlacesMotion& at) const override {
    const double longer = std::max(0.0, at.poses[0].r.norm() - length_);
    return 0.5 * stiffness_ * longer * longer;
  }

 private:
  std::string place_;
  double length_, stiffness_;
};

// A point stays on i3 = i1^2 / 2. G is what it is off, in metres up; the force goes along its gradient.
class Wire final : public mbd::Force {
 public:
  explicit Wire(std::string place) : place_(std::move(place)) {}
  static double gap(const mbd::Vec3& r) { return r.z() - 0.5 * r.x() * r.x(); }
  std::string name() const override { return "wire"; }
  std::vector<std::string> places() const override { return {place_}; }
  bool evaluate(const mbd::PlacesMotion& at, std::span<mbd::Vec6> wrenches) const override {
    const mbd::Vec3& r = at.poses[0].r;
    const mbd::Vec3 gradient(-r.x(), 0, 1);
    wrenches[0].head<3>() = at.poses[0].R().transpose() * (-stiffness * gap(r) * gradient);
    return true;
  }
  // df/du at fixed velocities, u along the axes of the place: exact, so that Newton's method stays quick however stiff it is.
  bool derivatives(const mbd::PlacesMotion& at, Eigen::MatrixXd& by_motion,
                   Eigen::MatrixXd&) const override {
    const mbd::Mat3 R = at.poses[0].R();
    const mbd::Vec3& r = at.poses[0].r;
    const mbd::Vec3 gradient(-r.x(), 0, 1);
    mbd::Mat3 K = -stiffness * (gradient * gradient.transpose());
    K(0, 0) += stiffness * gap(r);
    const mbd::Vec3 f = R.transpose() * (-stiffness * gap(r) * gradient);
    mbd::Mat3 f_tilde;
    f_tilde << 0, -f.z(), f.y(), f.z(), 0, -f.x(), -f.y(), f.x(), 0;
    by_motion.block<3, 3>(0, 0) = R.transpose() * K * R;
    by_motion.block<3, 3>(0, 3) = f_tilde;  // along axes that turn
    return true;
  }
  std::optional<double> energy(const mbd::PlacesMotion& at) const override {
    return 0.5 * stiffness * gap(at.poses[0].r) * gap(at.poses[0].r);
  }
  static constexpr double stiffness = 1e7;  // [N/m]

 private:
  std::string place_;
};

}  // namespace

int main() try {
  const mbd::Scene scene = mbd::read_model_text(R"(<mbd name="own">
    <body name="weight" at="0 0 -0.5" mass="2" inertia="0.01 0.01 0.01"/>
    <body name="bead" at="1 0 0.5" mass="1" inertia="0.01 0.01 0.01"/>
    <gravity acceleration="0 0 -9.81"/>
    <transient duration="2" tolerance="1e-7" method="radau"/>
    <record name="all" quantities="total_energy"/>
  </mbd>)",
                                                "own");
  const double m = 2, k = 400, length = 1.0, fall = 0.5;
  const mbd::Model model = mbd::compile(
      scene, {{std::make_shared<Tether>("weight", length, k), std::make_shared<Wire>("bead")}});
  const auto stepper = mbd::make_stepper(*model.system, *scene.transient);
  const auto weight = static_cast<std::size_t>(mbd::node_index(model, "weight")),
             bead = static_cast<std::size_t>(mbd::node_index(model, "bead"));
  mbd::State state = model.initial;
  double lowest = 0.0, fastest = 0.0, off = 0.0;
  stepper->on_substep([&](const mbd::DenseStep& step) {  // a quarter of a step at a time
    mbd::State at = model.initial;
    for (int q = 1; q <= 4; ++q) {
      step.at(q == 4 ? step.end() : step.begin() + 0.25 * q * (step.end() - step.begin()), at);
      lowest = std::min(lowest, at.pose[weight].r.z());
      fastest = std::max(fastest, at.V[bead].head<3>().norm());
      off = std::max(off, std::abs(Wire::gap(at.pose[bead].r)));
    }
  });
  mbd::StepReport report = stepper->start(state);
  const double energy = model.system->energies(state).total();
  while (report.converged && state.t < 2 - 1e-9) report = stepper->step(state);
  if (!report.converged) throw mbd::Error(report.failure, report.kind);
  const double longest = m * g / k * (1 + std::sqrt(1 + 2 * k * fall / (m * g))),
               speed = std::sqrt(2 * g * 0.5);
  std::printf(
      "tether longer by %.5f m (%.5f); bead at %.5f m/s (%.5f), off its wire by %.1e m; energy "
      "lost %.1e J\n",
      -lowest - length, longest, fastest, speed, off,
      energy - model.system->energies(state).total());
  const bool right = std::abs(-lowest - length - longest) < 1e-3 * longest &&
                     std::abs(fastest / speed - 1) < 1e-3 && off < 1e-4 &&
                     std::abs(energy - model.system->energies(state).total()) < 1e-3;
  return right ? 0 : 1;
} catch (const mbd::Error& error) {
  std::printf("%s (%s)\n", error.what(), std::string(mbd::name_of(error.kind())).c_str());
  return 2;
}
