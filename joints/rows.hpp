// The kinds of row that joints are made of (joint.hpp (1) to (8)). A new kind is one type here and the function that
// makes it.
//
// A row says, at a relative pose g of b in a: its value; its gradient (u, psi), dg = u . u + psi . psi of the
// increment z of g in b; and what its multiplier adds to the wrench f = G^T lambda and to L = df/dz.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "elements/metrics.hpp"
#include "libmbd/core/dual.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd::joint {

// What rows depend on besides g.
template <class S>
struct Given {
  S s = S(0.0);            // prescribed angle [rad] or displacement [m]
  double parameter = 0.0;  // of the type
  double near = 0.0;       // followed angle at the last accepted state [rad]
};

// Where rows are evaluated: g = (R, x), and x_b = R^T x.
template <class S>
struct RowPlace {
  Matrix3<S> R;
  Vector3<S> x_b;
  const Given<S>& given;

  MBD_INLINE RowPlace(const Pose<S>& g, const Given<S>& with)
      : R(g.R()), x_b(R.transpose() * g.r), given(with) {}
};

// f is [force + tension x_b; moment + force x x_b].
template <class S>
struct WrenchSum {
  Vector3<S> force = Vector3<S>::Zero(), moment = Vector3<S>::Zero();
  S tension{0.0};
};

// L is [tension I, tension x_b~; force~, force~ x_b~ + turning].
template <class S>
struct StiffnessSum {
  Vector3<S> force = Vector3<S>::Zero();
  Matrix3<S> turning = Matrix3<S>::Zero();
  S tension{0.0};
};

// The angle about e3 nearest to `near`.
template <class S>
S unwrapped_angle(const Matrix3<S>& R, double near) {
  using std::atan2;
  constexpr double turn = 2.0 * std::numbers::pi;
  const S principal = atan2(R(1, 0), R(0, 0));
  return principal + S(turn * std::round((near - value_of(principal)) / turn));
}

// w of (7), and dw/dpsi.
template <class S>
Vector3<S> angle_gradient(const Matrix3<S>& R) {
  const Vector3<S> c3 = R.row(2).transpose();
  return (c3 - c3(0) * Vector3<S>::Unit(0)) / (S(1.0) - c3(0) * c3(0));
}
template <class S>
Matrix3<S> angle_curvature(const Matrix3<S>& R) {
  const Vector3<S> c3 = R.row(2).transpose(), e1 = Vector3<S>::Unit(0), dk = e1.cross(c3),
                   w = angle_gradient(R);
  return (hat(c3) + (S(2.0) * c3(0) * w - e1) * dk.transpose()) / (S(1.0) - c3(0) * c3(0));
}

namespace row {

// A length along b_i [m]; its multiplier is a force at a's origin.
struct AlongAxis {
  static constexpr bool is_length = true, is_tension = false;
  int i;  // 1, 2, 3

  template <class S>
  void gradient(const RowPlace<S>& at, Vector3<S>& u, Vector3<S>& psi) const {
    u = Vector3<S>::Unit(i - 1);
    psi = u.cross(at.x_b);
  }
  template <class S>
  void add_wrench(const RowPlace<S>&, const S& l, WrenchSum<S>& f) const {
    f.force(i - 1) += l;
  }
  template <class S>
  void add_stiffness(const RowPlace<S>&, const S& l, StiffnessSum<S>& L) const {
    L.force(i - 1) += l;
  }
};

struct Position : AlongAxis {
  std::string name() const { return "position " + std::to_string(i); }
  template <class S>
  S value(const RowPlace<S>& at) const {
    return at.x_b(i - 1);
  }
};

struct Displacement : AlongAxis {
  std::string name() const { return "displacement"; }
  template <class S>
  S value(const RowPlace<S>& at) const {
    return at.x_b(2) - at.given.s;
  }
};

struct Advance : AlongAxis {
  std::string name() const { return "advance"; }
  // Per radian of the free angle [m/rad].
  template <class S>
  static S pitch(const RowPlace<S>& at) {
    return S(at.given.parameter / (2.0 * std::numbers::pi));
  }
  template <class S>
  S value(const RowPlace<S>& at) const {
    return at.x_b(2) - pitch(at) * unwrapped_angle(at.R, at.given.near);
  }
  template <class S>
  void gradient(const RowPlace<S>& at, Vector3<S>& u, Vector3<S>& psi) const {
    AlongAxis::gradient(at, u, psi);
    psi -= pitch(at) * angle_gradient(at.R);
  }
  template <class S>
  void add_wrench(const RowPlace<S>& at, const S& l, WrenchSum<S>& f) const {
    AlongAxis::add_wrench(at, l, f);
    f.moment -= (l * pitch(at)) * angle_gradient(at.R);
  }
  template <class S>
  void add_stiffness(const RowPlace<S>& at, const S& l, StiffnessSum<S>& L) const {
    AlongAxis::add_stiffness(at, l, L);
    L.turning -= (l * pitch(at)) * angle_curvature(at.R);
  }
};

// The cosine between a direction c of a and b_j; its multiplier is a moment about b_j x c. `Self` has c(at), in b.
template <class Self>
struct AcrossAxis {
  static constexpr bool is_length = false, is_tension = false;
  int j;  // 1, 2, 3

  template <class S>
  Vector3<S> c(const RowPlace<S>& at) const {
    return static_cast<const Self*>(this)->in_b(at);
  }
  template <class S>
  S value(const RowPlace<S>& at) const {
    return c(at)(j - 1);
  }
  template <class S>
  void gradient(const RowPlace<S>& at, Vector3<S>& u, Vector3<S>& psi) const {
    u.setZero();
    psi = Vector3<S>(Vector3<S>::Unit(j - 1)).cross(c(at));
  }
  template <class S>
  void add_wrench(const RowPlace<S>& at, const S& l, WrenchSum<S>& f) const {
    f.moment += l * Vector3<S>(Vector3<S>::Unit(j - 1)).cross(c(at));
  }
  template <class S>
  void add_stiffness(const RowPlace<S>& at, const S& l, StiffnessSum<S>& L) const {
    L.turning += l * (hat(Vector3<S>(Vector3<S>::Unit(j - 1))) * hat(c(at)));
  }
};

struct Direction : AcrossAxis<Direction> {
  int i;  // axis of a; 1, 2, 3
  constexpr Direction(int of_a, int of_b) : AcrossAxis{of_b}, i(of_a) {}
  std::string name() const { return "direction a" + std::to_string(i) + ".b" + std::to_string(j); }
  template <class S>
  Vector3<S> in_b(const RowPlace<S>& at) const {
    return at.R.row(i - 1).transpose();
  }
};

// The direction that stands for a_i in (3).
struct Angle : AcrossAxis<Angle> {
  constexpr Angle() : AcrossAxis{1} {}
  std::string name() const { return "angle"; }
  template <class S>
  Vector3<S> in_b(const RowPlace<S>& at) const {
    using std::cos, std::sin;
    const S& s = at.given.s;
    return (cos(s) * at.R.row(1) - sin(s) * at.R.row(0)).transpose();
  }
};

// Between the origins; its multiplier is a tension.
struct Distance {
  static constexpr bool is_length = true, is_tension = true;
  std::string name() const { return "distance"; }
  template <class S>
  S value(const RowPlace<S>& at) const {
    const double p = at.given.parameter;
    return (at.x_b.squaredNorm() - S(p * p)) / S(2.0 * p);
  }
  template <class S>
  void gradient(const RowPlace<S>& at, Vector3<S>& u, Vector3<S>& psi) const {
    u = at.x_b / S(at.given.parameter);
    psi.setZero();
  }
  template <class S>
  void add_wrench(const RowPlace<S>& at, const S& l, WrenchSum<S>& f) const {
    f.tension += l / S(at.given.parameter);
  }
  template <class S>
  void add_stiffness(const RowPlace<S>& at, const S& l, StiffnessSum<S>& L) const {
    L.tension += l / S(at.given.parameter);
  }
};

}  // namespace row

// What a row is called, and whether it is a length [m] with a force; otherwise a sine with a moment.
struct RowFacts {
  std::string name;
  bool is_length;
};

constexpr row::Position position(int i) { return {{i}}; }
constexpr row::Direction direction(int i, int j) { return {i, j}; }
constexpr row::Angle angle() { return {}; }
constexpr row::Displacement displacement() { return {{3}}; }
constexpr row::Advance advance() { return {{3}}; }
constexpr row::Distance distance() { return {}; }

}  // namespace mbd::joint
