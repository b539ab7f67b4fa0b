// Structures whose equilibria turn back or branch, as rods (support/rod_path.hpp): what the path models are
// held against. Unknowns are forces in units of `force`, rotations and the load in units of `force`; the last
// unknown is the load. SI or the source's units, as the numbers come.
#pragma once

#include <numbers>

#include "tests/support/rod_path.hpp"

namespace mbd::test {

inline const Eigen::Vector3d plane_normal(0, 0, 1);

// What a load P does at a place: (u1, u2) of its point.
struct LoadedPoint {
  double P = 0.0, u1 = 0.0, u2 = 0.0;
};

// Lee's frame: two legs of 120, both feet hinged at (0, 0) and (120, 120), corner at (0, 120), load P along
// -i2 at 24 from the corner on the second leg. Lee, Manuel, Rossow, ASCE J. Eng. Mech. 94 (1968).
// z = [force at the first foot (2), its rotation, P].
struct LeeFrame {
  double EA = 7.2e6 * 6, EI = 7.2e6 * 2, GA = 1e3 * EA;
  double force = 1e4;
  int steps = 12;

  // First foot, load point, second foot.
  template <class S>
  std::array<RodSection<S>, 3> sections(const Unknowns<S>& z) const {
    RodPiece piece{120, compliance_of(EA, GA, GA, EI, EI, EI), 0, steps};
    RodSection<S> foot;
    foot.R = turn<S>(plane_normal, z(2) + std::numbers::pi / 2);
    foot.n << z(0) * force, z(1) * force, S(0);
    RodSection<S> corner = integrate(piece, foot);
    corner.R = corner.R * turn<S>(plane_normal, S(-std::numbers::pi / 2));
    piece.length = 24;
    const RodSection<S> loaded = integrate(piece, corner);
    RodSection<S> beyond = loaded;
    beyond.n(1) += z(3) * force;
    piece.length = 96;
    return {foot, loaded, integrate(piece, beyond)};
  }
  template <class S>
  Unknowns<S> operator()(const Unknowns<S>& z) const {
    const RodSection<S> end = sections(z)[2];
    return Three<S>(end.r(0) / 120.0 - 1.0, end.r(1) / 120.0 - 1.0, end.m(2) / (force * 120));
  }
  LoadedPoint loaded_point(const PathPoint& p) const {
    const auto r = sections<double>(p.z)[1].r;
    return {p.load() * force, r(0) - 24, r(1) - 120};
  }
};

// A circular arch about the origin, its opening downwards, load P along -i2 at the crown (0, R); the foot on
// the right is hinged (about i3), the other one clamped or hinged. D of the scene is diag(EA, GA, GA, GJ, EI,
// EI). z = [force at the hinge (2), its rotation, P].
struct CircularArch {
  double radius = 100, angle = 215 * std::numbers::pi / 180;  // subtended
  double EA = 1e8, GA = 1e8, GJ = 1e6, EI = 1e6;
  bool clamped = true;  // the left foot
  double force = 100;
  int steps = 12;

  // Right foot, crown, left foot. w: force along i3 and moments about i1, i2 at the right foot, in units of
  // force, force R.
  template <class S>
  std::array<RodSection<S>, 3> sections(const Unknowns<S>& z, const Three<S>& w) const {
    const double begin = (std::numbers::pi - angle) / 2;  // polar angle of the right foot
    const RodPiece half{radius * angle / 2, compliance_of(EA, GA, GA, GJ, EI, EI), 1 / radius,
                        steps};
    RodSection<S> foot;
    foot.R = turn<S>(plane_normal, z(2) + begin + std::numbers::pi / 2);
    foot.r = radius * Three<S>(S(std::cos(begin)), S(std::sin(begin)), S(0));
    foot.n = force * Three<S>(z(0), z(1), w(0));
    foot.m = force * radius * Three<S>(w(1), w(2), S(0));
    const RodSection<S> crown = integrate(half, foot);
    RodSection<S> beyond = crown;
    beyond.n(1) += z(3) * force;
    return {foot, crown, integrate(half, beyond)};
  }
  template <class S>
  Unknowns<S> operator()(const Unknowns<S>& z) const {
    const RodSection<S> end = sections<S>(z, Three<S>::Zero())[2];
    const double begin = (std::numbers::pi - angle) / 2;
    const double attitude = begin + angle + std::numbers::pi / 2;
    const S turned = (turn<S>(plane_normal, S(-attitude)) * end.R)(1, 0);
    return Three<S>(end.r(0) / radius + std::cos(begin), end.r(1) / radius - std::sin(begin),
                    clamped ? turned : end.m(2) / (force * radius));
  }
  LoadedPoint loaded_point(const PathPoint& p) const {
    const auto r = sections<double>(p.z, Three<double>::Zero())[1].r;
    return {p.load() * force, r(0), r(1) - radius};
  }
  // Vanishes where the arch, clamped on the left, can leave its plane: the determinant of position along i3
  // and attitude about i1, i2 at the left foot over w.
  double sideways(const PathPoint& p) const {
    const Unknowns<double> z = p.z;
    const auto end = [&]<class S>(const Unknowns<S>& w) {
      const RodSection<S> left = sections<S>(z.cast<S>(), Three<S>(w))[2];
      return Unknowns<S>(Three<S>(left.r(2) / radius, left.R(2, 0), left.R(2, 1)));
    };
    return dense::determinant(jacobian(end, Eigen::VectorXd::Zero(3)));
  }
};

// A circular arch with both feet hinged, of less than a half turn, load P along -i2 at the crown: the half on
// the right, in its symmetric state. z = [thrust at the foot along i1, its rotation, P].
struct SymmetricArch {
  CircularArch arch{.angle = std::numbers::pi / 6, .clamped = false};

  // The crown; v: more force along i2 at the foot.
  template <class S>
  RodSection<S> crown(const Unknowns<S>& z, const S& v) const {
    Unknowns<S> all(4);
    all << z(0), -z(2) / 2.0 + v, z(1), z(2);
    return arch.sections<S>(all, Three<S>::Zero())[1];
  }
  // The crown stays in the middle and does not turn: its tangent is -i1.
  template <class S>
  Unknowns<S> operator()(const Unknowns<S>& z) const {
    const RodSection<S> c = crown(z, S(0));
    Unknowns<S> y(2);
    y << c.r(0) / arch.radius, c.R(1, 0);
    return y;
  }
  LoadedPoint loaded_point(const PathPoint& p) const {
    const auto r = crown<double>(p.z, 0.0).r;
    return {p.load() * arch.force, r(0), r(1) - arch.radius};
  }
  double thrust(const PathPoint& p) const { return p.z(0) * arch.force; }
  // Vanishes where the arch can leave its symmetry: the determinant of the crown's height and moment, which
  // an antisymmetric increment does not change, over the foot's force along i2 and rotation.
  double antisymmetric(const PathPoint& p) const {
    const Unknowns<double> z = p.z;
    const auto middle = [&]<class S>(const Unknowns<S>& w) {
      Unknowns<S> y = z.cast<S>();
      y(1) += w(1);
      const RodSection<S> c = crown<S>(y, w(0));
      Unknowns<S> at(2);
      at << c.r(1) / arch.radius, c.m(2) / (arch.force * arch.radius);
      return at;
    };
    return dense::determinant(jacobian(middle, Eigen::VectorXd::Zero(2)));
  }
};

// Two legs at a right angle, clamped at the origin, the first along i1, the second from its end along i2;
// thin strips that bend easily out of the plane. Dead force P at the free end, in the plane.
// z = [moment at the clamp about i3 over force * leg, P].
struct RightAngleFrame {
  double leg = 0.24, width = 0.03, thickness = 0.0006, E = 7.124e10, nu = 0.31;
  double torsion = width * thickness * thickness * thickness / 3;  // constant of a thin strip
  double shear_factor = 5.0 / 6;
  Eigen::Vector3d direction{0, 1, 0};  // of the load
  double force = 1;
  int steps = 8;

  RodPiece piece() const {
    const double G = E / 2 / (1 + nu), A = width * thickness, w = width, t = thickness;
    return {leg,
            compliance_of(E * A, shear_factor * G * A, shear_factor * G * A, G * torsion,
                          E * w * t * t * t / 12, E * t * w * w * w / 12),
            0, steps};
  }
  // The free end; w: moments about i1, i2 at the clamp.
  template <class S>
  RodSection<S> end(const Unknowns<S>& z, const Three<S>& w) const {
    RodSection<S> clamp;
    clamp.n = direction.cast<S>() * z(1) * force;
    clamp.m = force * leg * Three<S>(w(0), w(1), z(0));
    RodSection<S> corner = integrate(piece(), clamp);
    corner.R = corner.R * turn<S>(plane_normal, S(std::numbers::pi / 2));
    return integrate(piece(), corner);
  }
  template <class S>
  Unknowns<S> operator()(const Unknowns<S>& z) const {
    Unknowns<S> y(1);
    y << end<S>(z, Three<S>::Zero()).m(2) / (force * leg);
    return y;
  }
  // Vanishes where the frame can leave its plane.
  double sideways(const PathPoint& p) const {
    const Unknowns<double> z = p.z;
    const auto moment = [&]<class S>(const Unknowns<S>& w) {
      return Unknowns<S>(Three<S>(end<S>(z.cast<S>(), Three<S>(w(0), w(1), S(0))).m).head(2) /
                         (force * leg));
    };
    return dense::determinant(jacobian(moment, Eigen::VectorXd::Zero(2)));
  }
};

}  // namespace mbd::test
