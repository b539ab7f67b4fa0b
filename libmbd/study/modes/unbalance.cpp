#include "libmbd/study/modes/unbalance.hpp"

#include <cmath>
#include <numbers>

#include "libmbd/compile/ports.hpp"

namespace mbd {
namespace {

using Complex = std::complex<double>;

NamedPlace place_of(const Model& model, const std::string& name) {
  const int node = node_index(model, name);  // says which there are
  for (NamedPlace& place : named_places(model))
    if (place.name == name) return std::move(place);
  return {name, node, {}};
}

// A place of the scene in its equilibrium, and the axes across.
struct Across {
  Index first;             // row of its node
  Eigen::Matrix3d R;       // from the node's axes
  Eigen::Vector3d point;   // in the node
  Eigen::Vector3d e2, e3;  // inertial

  Across(const MotionsOfScene& motions, const SteadyRotation& rotation, const NamedPlace& place)
      : first(6 * (Index{place.node} - 1)),
        R(motions.state().pose[static_cast<std::size_t>(place.node)].p.toRotationMatrix()),
        point(place.frame.r) {
    const Vec3 e = first_across(rotation.axis);
    e2 = e;
    e3 = Vec3(rotation.axis.cross(e));
  }

  // A force along y e2 + z e3.
  Eigen::Matrix<Complex, 6, 1> force(Complex y, Complex z) const {
    const Eigen::Vector3cd f = R.transpose() * (e2 * y + e3 * z);
    Eigen::Matrix<Complex, 6, 1> all;
    all.head<3>() = f;
    all.tail<3>() = point.cast<Complex>().cross(f);
    return all;
  }
  // y and z of a motion.
  Eigen::Vector2cd moved(const Eigen::MatrixXcd& u) const {
    const Eigen::Vector3cd displacement = u.block<3, 1>(first, 0),
                           tilt = u.block<3, 1>(first + 3, 0);
    const Eigen::Vector3cd d = R * (displacement - point.cast<Complex>().cross(tilt));
    return {e2.cast<Complex>().dot(d), e3.cast<Complex>().dot(d)};
  }
};

}  // namespace

double Orbit::lag() const {
  const double angle = -std::arg(forward);
  return angle < -0.5 * std::numbers::pi ? angle + 2.0 * std::numbers::pi : angle + 0.0;  // not -0
}

Vec3 first_across(const Vec3& axis) {
  Index longest = 0;
  axis.cwiseAbs().maxCoeff(&longest);
  const Vec3 next = Vec3::Unit((longest + 1) % 3);
  const Vec3 across = next - axis * axis.dot(next);
  return across / across.norm();
}

std::optional<std::vector<Orbit>> response_to_unbalance(MotionsOfScene& motions,
                                                        const SteadyRotation& rotation,
                                                        const std::vector<Unbalance>& unbalance,
                                                        const std::vector<std::string>& places) {
  SmallMotions& small = motions.motions();
  const bool rests = motions.axes() == ModeAxes::resting;
  const Complex i(0.0, 1.0);
  const double square = rotation.rate * rotation.rate;
  Eigen::MatrixXcd u = Eigen::MatrixXcd::Zero(small.motions(), 1);
  for (const Unbalance& one : unbalance) {
    const NamedPlace place = place_of(motions.model(), one.place);
    if (place.node == 0 || !rotation.turns(static_cast<std::size_t>(place.node)))
      throw Error("unbalance: \"" + one.place + "\" does not turn");
    const Across at(motions, rotation, place);
    u.block<6, 1>(at.first, 0) += one.moment * square * at.force(1.0, rests ? -i : 0.0);
  }
  if (rests) {
    if (!small.factor(i * rotation.rate)) return std::nullopt;
    small.solve(u);
  } else {
    hold_free_turn(small, rotation);
    if (!small.factor(0.0)) return std::nullopt;
    Eigen::MatrixXd real = u.real();
    small.solve(real);
    u = real.cast<Complex>();
  }
  if (!u.allFinite()) return std::nullopt;
  std::vector<Orbit> orbits;
  for (const std::string& name : places) {
    const NamedPlace place = place_of(motions.model(), name);
    if (place.node == 0) throw Error("unbalance: the ground has no orbit");
    const Eigen::Vector2cd w = Across(motions, rotation, place).moved(u);
    Orbit orbit{rotation.rate, w(0) + i * w(1), 0.0};
    if (rests) orbit = {rotation.rate, 0.5 * orbit.forward, 0.5 * std::conj(w(0) - i * w(1))};
    orbits.push_back(orbit);
  }
  return orbits;
}

}  // namespace mbd
