// A random case of each kind of element on one node, on two, and on the coordinate of a joint: what the laws of
// test_laws.cpp need to know of a type. A new type has a case here and its line in a list of elements/element_list.hpp.
//
// Case<E>(rng, length): constants, for lengths of about `length` and forces of about 1 N, and
//   environment()    what acts from outside
//   place(rng, i, x) puts the nodes where the type is defined, at will
//   mutate()         makes a coefficient 10 % larger
//   move(G)          what is stated in inertial axes moves with the nodes
//   size(x)          a power [W] that is large beside round-off, where that of r and V may be too small
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "elements/node/batches.hpp"
#include "elements/pair/batches.hpp"
#include "joints/coordinate_batches.hpp"
#include "tests/elements/laws.hpp"

namespace mbd::laws {

using joint::JointDamper, joint::JointSpring, joint::JointTorque, joint::Sliding, joint::Turning;
using Nodes = std::vector<NodeState<double>>;

inline constexpr double factor_of_cases = 0.7;  // load factor

struct AnyCase {
  Environment environment() const {
    return {.t = 0, .load_factor = factor_of_cases, .signals = {}};
  }
  void place(Rng&, int, Nodes&) {}
  void move(const Pose<double>&) {}
  double size(const Nodes&) const { return 0.0; }
};

// ---- on one node --------------------------------------------------------------------------------

template <class E>
struct Case;

template <>
struct Case<Mass> : AnyCase {
  Mass::Shared shared;
  Mass::Data data;
  Case(Rng& rng, double length) : data{test::random_spd(rng, 2.0, length)} {}
  void mutate() { data.M(2, 3) *= 1.1; }
};
template <>
struct Case<MassNoGyroscopic> : AnyCase {
  MassNoGyroscopic::Shared shared;
  MassNoGyroscopic::Data data;
  Case(Rng& rng, double length)
      : data{test::random_spd(rng, 2.0, length),
             test::random_spd(rng, 2.0, length).bottomRightCorner<3, 3>()} {}
  void mutate() { data.J(0, 1) *= 1.1; }
};
template <>
struct Case<MassDamping> : AnyCase {
  MassDamping::Shared shared;
  MassDamping::Data data;
  Case(Rng& rng, double length) : data{test::random_spd(rng, 2.0, length)} {}
  void mutate() { data.P *= 1.1; }
};
template <>
struct Case<NodalGravity> : AnyCase {
  NodalGravity::Shared shared;
  NodalGravity::Data data;
  Case(Rng& rng, double length)
      : shared{test::random_vector<3>(rng, 10)}, data{3.0, length * test::random_vector<3>(rng)} {}
  void mutate() {
    data.m *= 1.1;
    data.mc *= 1.1;
  }
  void move(const Pose<double>& G) { shared.g = G.p * shared.g; }
};

template <std::size_t n>
struct WithSignals : AnyCase {
  std::array<SignalValue, n> signals{};
  Environment environment() const {
    return {.t = 0, .load_factor = factor_of_cases, .signals = signals};
  }
  // Three components from `first` on, of which -1 is zero; written, each has a place of its own.
  template <std::size_t places>
  Vec3 read(const std::array<int, places>& at, std::size_t first, double SignalValue::*of) const {
    Vec3 x = Vec3::Zero();
    for (std::size_t i = 0; i < 3; ++i)
      if (at[first + i] >= 0)
        x(static_cast<Index>(i)) = signals[static_cast<std::size_t>(at[first + i])].*of;
    return x;
  }
  template <std::size_t places>
  void write(const Vec3& x, std::array<int, places>& at, std::size_t first,
             double SignalValue::*of) {
    for (std::size_t i = 0; i < 3; ++i) {
      at[first + i] = static_cast<int>(first + i);
      signals[first + i].*of = x(static_cast<Index>(i));
    }
  }
};

template <>
struct Case<BaseMotion> : WithSignals<3> {
  BaseMotion::Shared shared;
  BaseMotion::Data data{};
  Case(Rng& rng, double length) {
    shared.law = static_cast<BaseMotion::Law>(static_cast<int>(test::uniform(rng, 0, 2.999)));
    shared.signals = {2, -1, 0};
    data = {3.0, length * test::random_vector<3>(rng)};
    for (SignalValue& s : signals)
      s = {test::uniform(rng, -9, 9), test::uniform(rng, -9, 9), test::uniform(rng, -9, 9)};
  }
  double SignalValue::*derivative() const {
    return shared.law == BaseMotion::Law::acceleration ? &SignalValue::f
           : shared.law == BaseMotion::Law::velocity   ? &SignalValue::fdot
                                                       : &SignalValue::fddot;
  }
  void mutate() {
    data.m *= 1.1;
    data.mc *= 1.1;
  }
  void move(const Pose<double>& G) {
    write(G.p * read(shared.signals, 0, derivative()), shared.signals, 0, derivative());
  }
};

// What the loads have in common: signals in any order, one of them absent.
template <class E>
struct LoadCase : WithSignals<6> {
  typename E::Shared shared;
  typename E::Data data{};
  LoadCase(Rng& rng, double length) {
    for (std::size_t i = 0; i < 6; ++i)
      signals[i] = {test::uniform(rng, -1, 1) * (i % 2 ? length : 1), 7, 7};
    signals[1].f = signals[3].f = 0.3 * length;
    data.signals = {2, -1, 0, 4, 3, 1};
    data.weight = test::uniform(rng, 0.5, 2);
    if constexpr (requires { data.offset; }) data.offset = length * test::random_vector<3>(rng);
  }
  void mutate() { signals[2].f *= 1.1; }
  Vec6 load() const {  // weighted and scaled
    return factor_of_cases * data.weight *
           Vec6(signals[2].f, 0, signals[0].f, signals[4].f, signals[3].f, signals[1].f);
  }
  double size(const Nodes& x) const {
    double arm = 1.0;
    if constexpr (requires { data.offset; }) arm += data.offset.norm();
    const Vec6 f = load();
    return linear(f).norm() * (linear(x[0].V).norm() + arm * angular(x[0].V).norm()) +
           angular(f).norm() * angular(x[0].V).norm();
  }
};
// Dead loads turn with the field.
template <class E>
struct DeadCase : LoadCase<E> {
  using LoadCase<E>::LoadCase;
  void move(const Pose<double>& G) {
    const Vec3 force = G.p * this->read(this->data.signals, 0, &SignalValue::f),
               moment = G.p * this->read(this->data.signals, 3, &SignalValue::f);
    this->write(force, this->data.signals, 0, &SignalValue::f);
    this->write(moment, this->data.signals, 3, &SignalValue::f);
  }
};
template <>
struct Case<PointLoad> : DeadCase<PointLoad> {
  using DeadCase::DeadCase;
};
template <>
struct Case<DeadForceArm> : DeadCase<DeadForceArm> {
  using DeadCase::DeadCase;
};
template <>
struct Case<FollowerLoad> : LoadCase<FollowerLoad> {  // stated in the node's axes: nothing to turn
  using LoadCase::LoadCase;
};

// In still fluid or one that flows; from at rest against it to fast.
template <class E, bool flowing>
struct DragCase : WithSignals<3> {
  typename E::Shared shared;
  typename E::Data data{};
  DragCase(Rng& rng, double length) {
    for (SignalValue& s : signals) s = {length * test::uniform(rng, -1, 1), 7, 7};
    if constexpr (flowing) data.flow.signals = {2, -1, 0};
  }
  void place(Rng& rng, int i, Nodes& x) {
    if (i % 4 == 0) x[0].V *= test::log_uniform(rng, 1e-9, 1);
  }
  void move(const Pose<double>& G) {
    if constexpr (flowing) {
      auto& at = data.flow.signals;
      this->write(G.p * this->read(at, 0, &SignalValue::f), at, 0, &SignalValue::f);
    }
  }
};
template <bool flowing, bool placed>
struct Case<LineDrag<flowing, placed>> : DragCase<LineDrag<flowing, placed>, flowing> {
  Case(Rng& rng, double length) : DragCase<LineDrag<flowing, placed>, flowing>(rng, length) {
    this->data.across = test::uniform(rng, 0.5, 2);
    this->data.along = test::uniform(rng, 0.1, 0.5);
    if constexpr (placed) {
      this->data.frame.R = exp_so3<double>(test::random_vector<3>(rng)).toRotationMatrix();
      this->data.frame.c = length * test::random_vector<3>(rng);
    }
  }
  void mutate() { this->data.across *= 1.1; }
};
template <bool flowing>
struct Case<PointDrag<flowing>> : DragCase<PointDrag<flowing>, flowing> {
  Case(Rng& rng, double length) : DragCase<PointDrag<flowing>, flowing>(rng, length) {
    this->data.b = test::uniform(rng, 0.5, 2);
    this->data.offset = length * test::random_vector<3>(rng);
  }
  void mutate() { this->data.b *= 1.1; }
};

// ---- on two nodes -------------------------------------------------------------------------------

// A nonlinear law of a variable of size `x` and a force of size `f`.
inline Law some_law(double f, double x, Variables variable) {
  const Parameters p{{"f", f}, {"s", x}};
  const std::string y = variable == Variables::x ? "(x/s)" : "(v/s)";
  return Law::of(
      Expression::parse("f*(0.3*" + y + " + 0.5*" + y + "^3 + 0.2*sin(2*" + y + "))", p, variable));
}

inline two_points::Ends random_points(Rng& rng, double length) {
  return {length * test::random_vector<3>(rng), length * test::random_vector<3>(rng), length};
}
inline two_frames::Ends random_frames(Rng& rng, double length) {
  return {test::random_pose(rng, length), test::random_pose(rng, length)};
}

template <>
struct Case<Spring> : AnyCase {
  Spring::Shared shared;
  Spring::Data data;
  Case(Rng& rng, double l)
      : shared{{some_law(1.0, l, Variables::x)}},
        data{random_points(rng, l),
             test::uniform(rng, 0, 2) * l,
             {test::uniform(rng, 0.5, 2) / l, 0}} {}
  void mutate() { data.force.coefficient *= 1.1; }
};
template <>
struct Case<Damper> : AnyCase {
  Damper::Shared shared;
  Damper::Data data;
  Case(Rng& rng, double l)
      : shared{{some_law(1.0, l, Variables::v)}},
        data{random_points(rng, l), {test::uniform(rng, 0.5, 2) / l, 0}} {}
  void mutate() { data.force.coefficient *= 1.1; }
};

// Frames of bushings turn against each other within the range of their rotation vector.
struct BushingCase : AnyCase {
  double length;
  explicit BushingCase(double l) : length(l) {}
  void place(Rng& rng, const two_frames::Ends& ends, Nodes& x) const {
    const double turn = test::uniform(rng, 0, 1) < 0.1
                            ? 1e-9
                            : test::uniform(rng, 0, 0.99 * GeodesicMetric::max_angle);
    x[1].H = x[0].H * ends.a * test::random_relative(rng, turn, test::uniform(rng, 0, 2) * length) *
             inverse(ends.b);
  }
};
template <>
struct Case<Bushing> : BushingCase {
  Bushing::Shared shared;
  Bushing::Data data;
  Case(Rng& rng, double l)
      : BushingCase(l),
        shared{{some_law(1.0, l, Variables::x), some_law(l, 1.0, Variables::x)}},
        data{random_frames(rng, l), test::random_spd(rng, 1.0 / l, l), {-1, 0, -1, 1, -1, -1}} {}
  void place(Rng& rng, int, Nodes& x) const { BushingCase::place(rng, data.ends, x); }
  void mutate() { data.K(2, 4) *= 1.1; }
};
template <>
struct Case<BushingDamper> : BushingCase {
  BushingDamper::Shared shared;
  BushingDamper::Data data;
  Case(Rng& rng, double l)
      : BushingCase(l), data{random_frames(rng, l), test::random_spd(rng, 1.0 / l, l)} {}
  void place(Rng& rng, int, Nodes& x) const { BushingCase::place(rng, data.ends, x); }
  void mutate() { data.C(2, 4) *= 1.1; }
};

// ---- on the coordinate of a joint: angles followed over turns ------------------------------------

template <class C>
struct FollowedCase : AnyCase {
  static constexpr bool turns = std::is_same_v<C, Turning>;
  double length, unit, force;  // of the coordinate, and what works on it
  std::array<double, 1> angles{};
  std::array<SignalValue, 1> signals{};
  FollowedCase(Rng& rng, double l) : length(l), unit(turns ? 1.0 : l), force(turns ? l : 1.0) {
    angles[0] = test::uniform(rng, -20, 20);
  }
  Environment environment() const {
    return {.t = 0, .load_factor = factor_of_cases, .signals = signals, .angles = angles};
  }
  // Off the place where the angle is not defined; the last accepted one lies near the present one.
  void place(Rng& rng, const two_frames::Ends& ends, Nodes& x) {
    const Pose<double> tilt{test::rotation(test::uniform(rng, 0, 0.5), test::random_direction(rng)),
                            length * test::random_vector<3>(rng)},
        turned{test::rotation(test::uniform(rng, -3, 3), Vec3::UnitZ()), Vec3::Zero()};
    x[1].H = x[0].H * ends.a * turned * tilt * inverse(ends.b);
    angles[0] =
        joint::unwrapped_angle<double>(relative(x[0].H * ends.a, x[1].H * ends.b).R(), angles[0]) +
        test::uniform(rng, -1, 1);
  }
};
template <class C>
struct Case<JointSpring<C>> : FollowedCase<C> {
  typename JointSpring<C>::Shared shared;
  typename JointSpring<C>::Data data;
  Case(Rng& rng, double l) : FollowedCase<C>(rng, l) {
    shared.laws.push_back(some_law(this->force, this->turns ? 20.0 : this->unit, Variables::x));
    data = {{random_frames(rng, l), 0},
            test::uniform(rng, -1, 1) * this->unit,
            {test::uniform(rng, 0.5, 2) * this->force / this->unit, 0}};
  }
  void place(Rng& rng, int, Nodes& x) { FollowedCase<C>::place(rng, data.axis.ends, x); }
  void mutate() { data.force.coefficient *= 1.1; }
};
template <class C>
struct Case<JointDamper<C>> : FollowedCase<C> {
  typename JointDamper<C>::Shared shared;
  typename JointDamper<C>::Data data;
  Case(Rng& rng, double l) : FollowedCase<C>(rng, l) {
    shared.laws.push_back(some_law(this->force, this->unit, Variables::v));
    data = {{random_frames(rng, l), 0}, {test::uniform(rng, 0.5, 2) * this->force / this->unit, 0}};
  }
  void place(Rng& rng, int, Nodes& x) { FollowedCase<C>::place(rng, data.axis.ends, x); }
  void mutate() { data.force.coefficient *= 1.1; }
};
template <class C>
struct Case<JointTorque<C>> : FollowedCase<C> {
  typename JointTorque<C>::Shared shared;
  typename JointTorque<C>::Data data;
  Case(Rng& rng, double l) : FollowedCase<C>(rng, l) {
    this->signals[0] = {test::uniform(rng, 0.5, 2) * this->force, 7, 7};
    data = {random_frames(rng, l), 0};
  }
  void place(Rng& rng, int, Nodes& x) { FollowedCase<C>::place(rng, data.ends, x); }
  void mutate() { this->signals[0].f *= 1.1; }
};

}  // namespace mbd::laws
