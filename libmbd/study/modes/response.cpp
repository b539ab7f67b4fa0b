#include "libmbd/study/modes/response.hpp"

#include <cmath>
#include <numbers>

#include "libmbd/compile/ports.hpp"

namespace mbd {
namespace {

using Complex = std::complex<double>;

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

constexpr Complex one_i(0.0, 1.0);

std::vector<Across> places_of(const MotionsOfScene& motions, const SteadyRotation& rotation,
                              const std::vector<std::string>& names) {
  std::vector<Across> all;
  for (const std::string& name : names) {
    const NamedPlace place = named_place(motions.model(), name);
    if (place.node == 0) throw Error("response: the ground has no orbit");
    all.emplace_back(motions, rotation, place);
  }
  return all;
}

// (3) of y and z, amplitudes at exp(i w t).
Orbit ellipse(double rate, const Eigen::Vector2cd& w) {
  return {rate, 0.5 * (w(0) + one_i * w(1)), 0.5 * std::conj(w(0) - one_i * w(1))};
}

// u at exp(i w t) from forces there; false where the equations are singular.
bool solve_at(SmallMotions& small, double w, Eigen::MatrixXcd& u) {
  if (!small.factor(one_i * w)) return false;
  small.solve(u);
  return u.allFinite();
}

// Amplitudes at exp(i w t) of what moves under forces, (y, z) of each; nothing where the equations are singular.
template <class Amplitudes>
std::optional<Eigen::MatrixXcd> driven(MotionsOfScene& motions, const SteadyRotation& rotation,
                                       const std::vector<HarmonicForce>& forces, double w,
                                       const Amplitudes& of) {
  SmallMotions& small = motions.motions();
  Eigen::MatrixXcd u = Eigen::MatrixXcd::Zero(small.motions(), 1);
  for (const HarmonicForce& one : forces) {
    const NamedPlace place = named_place(motions.model(), one.place);
    if (place.node == 0) throw Error("force: \"" + one.place + "\" is on the ground");
    const Across at(motions, rotation, place);
    const auto [y, z] = of(one);
    u.block<6, 1>(at.first, 0) += at.force(y, z);
  }
  if (w == 0.0) hold_free_turn(small, rotation);
  if (!solve_at(small, w, u)) return std::nullopt;
  return u;
}

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
  const double square = rotation.rate * rotation.rate;
  Eigen::MatrixXcd u = Eigen::MatrixXcd::Zero(small.motions(), 1);
  for (const Unbalance& one : unbalance) {
    const NamedPlace place = named_place(motions.model(), one.place);
    if (place.node == 0 || !rotation.turns(static_cast<std::size_t>(place.node)))
      throw Error("unbalance: \"" + one.place + "\" does not turn");
    const Across at(motions, rotation, place);
    u.block<6, 1>(at.first, 0) += one.moment * square * at.force(1.0, rests ? -one_i : 0.0);
  }
  if (rests) {
    if (!solve_at(small, rotation.rate, u)) return std::nullopt;
  } else {
    hold_free_turn(small, rotation);
    if (!small.factor(0.0)) return std::nullopt;
    Eigen::MatrixXd real = u.real();
    small.solve(real);
    u = real.cast<Complex>();
  }
  if (!u.allFinite()) return std::nullopt;
  std::vector<Orbit> orbits;
  for (const Across& at : places_of(motions, rotation, places)) {
    const Eigen::Vector2cd w = at.moved(u);
    Orbit orbit{rotation.rate, w(0) + one_i * w(1), 0.0};
    if (rests) orbit = ellipse(rotation.rate, w);
    orbits.push_back(orbit);
  }
  return orbits;
}

std::optional<std::vector<Orbit>> response_to_forces(MotionsOfScene& motions,
                                                     const SteadyRotation& rotation,
                                                     const std::vector<HarmonicForce>& forces,
                                                     double order,
                                                     const std::vector<std::string>& places) {
  const double W = rotation.rate, w = order * W;
  const std::vector<Across> at = places_of(motions, rotation, places);
  std::vector<Orbit> orbits(places.size());
  if (motions.axes() == ModeAxes::resting) {
    const auto u = driven(motions, rotation, forces, w, [](const HarmonicForce& f) {
      return std::pair<Complex, Complex>(f.y, f.z);
    });
    if (!u) return std::nullopt;
    for (std::size_t k = 0; k < at.size(); ++k) orbits[k] = ellipse(W, at[k].moved(*u));
    return orbits;
  }
  const auto turning = [](const HarmonicForce& f) {  // p exp(i v t): y = p, z = -i p
    const Complex p(0.5 * f.y, 0.5 * f.z);
    return std::pair<Complex, Complex>(p, -one_i * p);
  };
  // What holds a free spin stays in the equations, so this one first: it is never at rest there.
  const auto backward = driven(motions, rotation, forces, -(w + W), turning);
  const auto forward = driven(motions, rotation, forces, w - W, turning);
  if (!backward || !forward) return std::nullopt;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const Orbit first = ellipse(W, at[k].moved(*forward)),
                second = ellipse(W, at[k].moved(*backward));
    orbits[k] = {W, first.forward, second.forward, std::abs(second.backward)};
    if (w == W)  // at rest there: exp(i W t)
      orbits[k].forward += first.backward;
    else
      orbits[k].besides += std::abs(first.backward);
  }
  return orbits;
}

}  // namespace mbd
