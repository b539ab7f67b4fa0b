// Forces that a program computes: an aerodynamic code, a tether, a contact, a controller that acts within the step. They are
// evaluated inside Newton's iterations, so they may depend on the motion as stiffly as they like. Given to compile() in
// Extensions.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/types.hpp"

namespace mbd {

// The motion of the places that a force acts on, in the order of Force::places(), all nodes of a beam in the order of its
// reference line.
struct PlacesMotion {
  double t = 0.0;                       // [s]
  std::span<const Pose<double>> poses;  // axes of the section or body at the place, inertial
  std::span<const Vec6> velocities;     // [v; w], axes of the place [m/s, rad/s]; in statics zero
};

class Force {
 public:
  virtual ~Force() = default;

  // What messages call it.
  virtual std::string name() const = 0;

  // Places with a node ("arm.end", "hub"), or names of beams: all of their nodes, which need not be ends of elements.
  virtual std::vector<std::string> places() const = 0;

  // What acts on each place: force and moment about it, axes of the place [N, N.m]. False: not at this motion (out of the
  // range of a table, say); Newton's method then tries shorter steps. Called often; not from several threads at once unless
  // the program steps several states of the same system so. Loads of a <static> are multiplied by the load factor, these too.
  virtual bool evaluate(const PlacesMotion& at, std::span<Vec6> wrenches) const = 0;

  // Derivatives of all wrenches by increments du of all places, pose := pose exp(du), at fixed velocities, and by
  // velocities: 6 n x 6 n each, zero when called. False: it has none, and differences are taken, 24 n evaluations a tangent.
  virtual bool derivatives(const PlacesMotion& /*at*/, Eigen::MatrixXd& /*by_motion*/,
                           Eigen::MatrixXd& /*by_velocity*/) const {
    return false;
  }

  // Of a force that has a potential [J]: it is counted with strain energy, and not as work of loads.
  virtual std::optional<double> energy(const PlacesMotion& /*at*/) const { return {}; }

  // For messages, after evaluate() was false: why; empty: it is out of its range.
  virtual std::string fault() const { return {}; }
};

// A force from a function.
std::shared_ptr<const Force> make_force(
    std::string name, std::vector<std::string> places,
    std::function<bool(const PlacesMotion&, std::span<Vec6>)> evaluate);

class Extending;

// What a program adds to the scene that it compiles.
struct Extensions {
  std::vector<std::shared_ptr<const Force>> forces = {};
  // Elements, joints and batches (libmbd/compile/extending.hpp): called in turn, before the system is finished.
  std::vector<std::function<void(Extending&)>> parts = {};
};

}  // namespace mbd
