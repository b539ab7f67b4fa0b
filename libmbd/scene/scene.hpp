// What a model says: plain data, SI units, each item with its place in the file. A Scene is made by
// the XML reader or by a C++ program; compile() turns it into a Model. Nothing here computes.
//
// Vectors are inertial (i1 i2 i3) in the reference configuration unless a member says otherwise.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "libmbd/core/choices.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/core/expression.hpp"
#include "libmbd/core/types.hpp"
#include "libmbd/scene/field_expression.hpp"

namespace mbd {

// A place things attach to: "ground", a body's reference frame ("top"), or a parameter of a beam
// ("bar2.start", "bar2.end", "bar2@0.5"; 0 at the start, 1 at the end of the reference line).
struct Place {
  enum class Kind { ground, body, beam };
  Kind kind = Kind::ground;
  std::string name;        // of the body or beam; empty for ground
  double parameter = 0.0;  // beam only, in [0, 1]
};

// A section at one place of a beam.
struct Station {
  Source source;
  double at = 0.0;  // fraction of the reference length of the beam that has the section
  Mat6 stiffness = Mat6::Zero();  // as in Section
  std::optional<Mat6> mass;
};

// Of a section: what resists rates of strain and velocities. Viscous sectional forces are
// (stiffness_proportional D + viscous) times the rates of strain, D where the section varies being that of
// the place; on all masses of the beam act -mass_proportional times their momenta, as in a medium at rest.
struct SectionDamping {
  Source source;
  double stiffness_proportional = 0.0;  // beta [s]
  double mass_proportional = 0.0;       // alpha [1/s]
  Mat6 viscous = Mat6::Zero();          // rows and columns as D, not negative [N.s, N.m.s, N.m2.s]
};

struct Section {
  Source source;
  std::string name;
  Mat6 stiffness = Mat6::Zero();  // D: [N1 Q2 Q3 M1 M2 M3] vs [gamma; kappa]   [N, N.m, N.m2]
  std::optional<Mat6> mass;       // M per unit length about the reference line  [kg/m, kg, kg.m]

  // Where there are any, D and M vary along the beam and those above are not used. Entry by entry: linear
  // between stations, or the interpolating spline of degree 3 (or less, with fewer than 4 stations). A kink
  // of the linear table is best placed where two elements meet: within one it costs the element its order.
  std::vector<Station> stations;  // at least two, rising from 0 to 1; all with mass, or none
  Interpolation interpolation = Interpolation::linear;

  std::optional<SectionDamping> damping;
};

// A straight reference line.
struct Straight {
  Vec3 from = Vec3::Zero();  // [m]
  Vec3 to = Vec3::Zero();    // [m]
};

// A circular reference line: `from` turned about the line through `center` along `axis`.
struct Arc {
  Vec3 from = Vec3::Zero();    // [m]
  Vec3 center = Vec3::Zero();  // [m]
  Vec3 axis = Vec3::
      UnitZ();  // right-handed; need not be a unit vector, must be perpendicular to from - center
  double angle = 0.0;  // subtended angle, > 0  [rad]
};

// A smooth reference line through points (reference_line.hpp). b3 lies in the plane of the tangent and the
// normal, both interpolated, turned by the twist about the tangent. Two points: a straight line.
struct CurvePoint {
  Source source;
  Vec3 at = Vec3::Zero();      // [m]
  std::optional<Vec3> normal;  // default: that of the beam
  double twist = 0.0;          // right-handed about the tangent [rad]
};
struct Curve {
  std::vector<CurvePoint> points;  // at least two
  int degree = 0;                  // of the spline; 0: min(points - 1, 2 order + 1)
};

struct BeamScene {
  Source source;
  std::string name;
  std::string section;
  std::variant<Straight, Arc, Curve> line;
  Vec3 normal =
      Vec3::UnitZ();  // b3 at the start (of a curve: everywhere), made perpendicular to the
                      // tangent; b2 = b3 x b1
  int elements = 1;   // equal in reference length, before boundaries are added at attachments
  int order = 3;      // N, 1 … 8: N + 1 nodes an element
  Kinematics kinematics = Kinematics::motion;
  Metric metric = Metric::geodesic;  // of motion; so is the form
  Rule rule = Rule::gauss;
  Form form = Form::energy;
};

struct BodyScene {
  Source source;
  std::string name;
  std::optional<Place> attached_to;     // fixed to this place's node; otherwise a free body
  Vec3 at = Vec3::Zero();               // reference point of a free body [m]
  Mat3 orientation = Mat3::Identity();  // columns: body axes of a free body in inertial axes
  double mass = 0.0;                    // [kg]
  Vec3 center = Vec3::Zero();           // mass centre from the reference point, body axes [m]
  Mat3 inertia = Mat3::Zero();          // about the mass centre, body axes [kg.m2]
  Vec3 velocity =
      Vec3::Zero();  // initial, of the reference point, inertial axes [m/s]; free bodies only
  Vec3 angular_velocity = Vec3::Zero();  // initial, body axes [rad/s]; free bodies only
};

// Beams and free bodies that together are one rigid body: one node, with the mass of them all. Its frame is that of the
// first: of a body, or of a beam's start. What joins two of them among themselves does nothing.
struct RigidScene {
  Source source;
  std::string name;
  std::vector<std::string> of;  // at least one; none of them in another
};

struct JointScene {
  Source source;
  std::string kind;  // a name of joints/joint_list.hpp
  std::string name;
  Place a, b;
  std::optional<Vec3> at;  // joint's point [m]; default: the point of b (of a if b is the ground)
  // Required by kinds that have them, refused by others.
  std::optional<Vec3> axis, second_axis;
  std::optional<double> parameter;  // of a screw: its pitch [m per turn]
  std::optional<Vec3> at_a, at_b;   // of kinds with two points [m]; default: those of the places
};

struct DriveScene {
  Source source;
  std::string joint;
  // One of these, of b relative to a, about or along the axis.
  std::optional<Expression> rate, angle;          // [rad/s], [rad]
  std::optional<Expression> speed, displacement;  // [m/s], [m]
};

// The motion of a place from its reference configuration, inertial axes, expressions of t. What is not
// given is free.
struct MotionScene {
  Source source;
  std::string name;
  Place of;
  std::optional<std::array<Expression, 3>> displacement;  // [m], or
  std::optional<std::array<Expression, 3>> velocity;      // [m/s]
  std::optional<std::array<Expression, 3>> rotation;  // rotation vector, of any length [rad]; or
  std::optional<Vec3> axis;                           // of turning, and
  std::optional<Expression> angle, rate;              // one of these [rad], [rad/s]
};

struct LoadScene {
  Source source;
  std::string name;
  Place at;
  std::optional<std::array<Expression, 3>>
      force;  // dead: fixed inertial direction, expressions of t [N]
  std::optional<std::array<Expression, 3>> moment;           // dead, inertial axes [N.m]
  std::optional<std::array<Expression, 3>> follower_force;   // axes of the section or body [N]
  std::optional<std::array<Expression, 3>> follower_moment;  // axes of the section or body [N.m]
  Vec3 offset =
      Vec3::Zero();  // of the forces' point from the place, axes of the section or body [m]
};

// Along a beam, per unit of its reference length. s is the fraction of that length, 0 … 1. Where a load
// begins or ends is best said by `from` and `to`, which make ends of elements, not by a condition on s.
struct DistributedLoadScene {
  Source source;
  std::string name;
  std::string beam;
  double from = 0.0, to = 1.0;  // where it begins and ends, fractions of the reference length
  std::optional<std::array<FieldExpression, 3>> force;            // dead, inertial axes [N/m]
  std::optional<std::array<FieldExpression, 3>> moment;           // dead, inertial axes [N]
  std::optional<std::array<FieldExpression, 3>> follower_force;   // section axes [N/m]
  std::optional<std::array<FieldExpression, 3>> follower_moment;  // section axes [N]
};

// A force or moment as a function of one variable (law.hpp): an expression, or a table.
struct TableScene {
  Source source;
  std::vector<std::array<double, 2>>
      points;  // variable and force; the variable rising; two at least
  // Straight lines, or the interpolating spline of degree 3 (or less, with fewer than 4 points). Beyond the
  // ends: linear, with the slope there.
  Interpolation interpolation = Interpolation::linear;
};
using LawScene = std::variant<Expression, TableScene>;

// A spring, a damper or both along the line between two points; what is stated adds up.
struct SpringScene {
  Source source;
  std::string name;
  Place a, b;
  std::optional<Vec3> at_a, at_b;  // the points [m]; default: those of the places
  double stiffness = 0.0;          // [N/m]
  double damping = 0.0;            // [N.s/m]
  std::optional<double> length;    // free length [m]; default: that of the reference configuration
  std::optional<LawScene> force;   // tension [N] over extension x [m]
  std::optional<LawScene> damping_force;  // tension [N] over its rate v [m/s]
};

// A law of one component of a bushing's motion parameters (elements/pair/bushing.hpp).
struct BushingLawScene {
  Source source;
  int component = 1;  // 1 … 3 along, 4 … 6 about the first, second and third axis
  LawScene force;     // [N] over [m], or [N.m] over [rad]
};

// An elastic, damped connection of two frames in all six directions.
struct BushingScene {
  Source source;
  std::string name;
  Place a, b;
  std::optional<Vec3> at;  // its point [m]; default as of joints
  std::optional<Vec3> axis,
      second_axis;                    // third and first axis of its frames; default: inertial axes
  Mat6 stiffness = Mat6::Zero();      // [N/m, N; N, N.m]
  Mat6 damping = Mat6::Zero();        // [N.s/m, N.s; N.s, N.m.s]
  std::vector<BushingLawScene> laws;  // added to the stiffness
};

// A spring, a damper or both on the free coordinate of a joint; what is stated adds up.
struct JointSpringScene {
  Source source;
  std::string name;
  std::string joint;
  enum class Coordinate { angle, displacement } coordinate = Coordinate::angle;
  double stiffness = 0.0;                 // [N.m], or [N/m] of a displacement
  double damping = 0.0;                   // [N.m.s], or [N.s/m]
  double rest = 0.0;                      // coordinate where the spring exerts nothing [rad, m]
  std::optional<LawScene> force;          // moment [N.m] or force [N] over coordinate less rest
  std::optional<LawScene> damping_force;  // the same over the coordinate's rate
};

// What acts along the free coordinates of a joint on b, and its opposite on a: expressions of t.
struct JointTorqueScene {
  Source source;
  std::string name;
  std::string joint;
  std::optional<Expression> moment;  // about the axis [N.m]
  std::optional<Expression> force;   // along it [N]
};

struct PointMassScene {
  Source source;
  std::string name;
  Place at;
  double mass = 0.0;           // [kg]
  Vec3 offset = Vec3::Zero();  // from the place, axes of the section or body [m]
};

struct Gravity {
  Source source;
  Vec3 acceleration = Vec3::Zero();  // [m/s2]
};

// Quadratic drag of a fluid (elements/node/drag.hpp): along a beam, or at a place.
struct DragScene {
  Source source;
  std::string name;
  double density = 0.0;  // of the fluid [kg/m3]
  std::optional<std::array<Expression, 3>>
      flow;  // its velocity, inertial axes [m/s]; default: still
  // Along a beam.
  std::string beam;                // empty: at a place
  std::optional<double> from, to;  // fractions of the reference length; default: all of it
  std::optional<double> diameter;  // [m]
  std::optional<double> normal_coefficient, tangential_coefficient;  // [-]
  // At a place.
  std::optional<Place> at;
  std::optional<double> area;         // [m2]
  std::optional<double> coefficient;  // [-]
  std::optional<Vec3> offset;  // of what is dragged, axes of the section or body [m]; default: 0
};

// Inertia of the fluid that moves with a beam, or with a body at a place (NOTATION.md): of inertia, not of gravity.
struct AddedMassScene {
  Source source;
  std::string name;
  // Of a beam, across it and per length: density pi diameter^2 / 4 times coefficient.
  std::string beam;                // empty: at a place
  std::optional<double> from, to;  // fractions of the reference length; default: all of it
  std::optional<double> density;   // of the fluid [kg/m3]
  std::optional<double> diameter, coefficient;  // [m], [-]
  // At a place: M of [v; w], its axes.
  std::optional<Place> at;
  std::optional<Mat6> matrix;  // [kg, kg.m, kg.m2]
};

// The base, which is called the ground, is accelerated without turning: everything is relative to it
// (elements/node/base_motion.hpp). One of these, inertial axes, expressions of t.
struct BaseMotionScene {
  Source source;
  std::optional<std::array<Expression, 3>> acceleration;  // [m/s2]
  std::optional<std::array<Expression, 3>> velocity;      // [m/s]
  std::optional<std::array<Expression, 3>> displacement;  // [m]
};

struct StaticScene {
  Source source;
  int steps = 1;             // first size of the load steps: 1/steps
  double tolerance = 1e-12;  // relative, on increments
  StaticSolver solver = StaticSolver::newton;
  bool line_search = true;  // of Newton's iterations; KINSOL has its own
};

// Where a path is to be looked at (or ends): where a column of path.csv passes a value.
struct PathMarkScene {
  Source source;
  std::string quantity;
  double value = 0.0;
  bool stops = false;
};

// A path of equilibria over the load factor (path.hpp).
struct PathScene {
  Source source;
  PathMethod method = PathMethod::bordered;
  PathDirection direction = PathDirection::forward;
  double step = 0.05;     // first step of the load factor
  double max_step = 0.1;  // of motion: rms of displacement over the scene's size and rotation
  int points = 200;       // most on each branch
  std::optional<double> length;  // most arc length of each branch
  int branch = 0;            // bifurcation whose branch is followed too; negative: its other side
  double tolerance = 1e-12;  // relative, on increments
  std::vector<PathMarkScene> marks;
};

// Integration in time. What is absent is chosen by the method, or not used.
struct TransientScene {
  Source source = {};
  double duration = 0.0;  // [s]
  TimeMethod method = TimeMethod::generalized_alpha;
  // One of both: fixed steps, of which the duration is a whole number, or steps that follow an estimated error.
  std::optional<double> step = {};       // [s]
  std::optional<double> tolerance = {};  // relative (ErrorTolerances)
  // With a tolerance only.
  std::optional<double> position_tolerance = {};          // [m]
  std::optional<double> rotation_tolerance = {};          // [rad]
  std::optional<double> velocity_tolerance = {};          // [m/s]; not of generalized_alpha
  std::optional<double> angular_velocity_tolerance = {};  // [rad/s]
  std::optional<double> max_step = {};                    // [s]
  std::optional<double> newton_tolerance =
      {};  // of Newton's increments, relative; of ida there is none
  // Of generalized_alpha only.
  std::optional<double> rho_infinity =
      {};  // spectral radius at infinite frequency, [0, 1]; default 0
  std::optional<Balance> balance =
      {};  // of inertia: in body axes (default), or of momenta in inertial ones
  // When rows of results are written: in intervals [s], or (output_steps) where steps end and at the times of
  // expected values. With neither: where fixed steps end; with a tolerance, a thousand times.
  std::optional<double> output = {};
  bool output_steps = false;
  InertiaTerms inertia = InertiaTerms::full;
};

// One line of output: quantities of a place, of a joint or motion, of a spring, or (with none) of the whole
// system, whenever a row of results is written.
struct RecordScene {
  Source source;
  std::string name;
  std::optional<Place> at;
  std::optional<std::string> joint;
  std::vector<std::string> quantities;
  std::optional<std::string> spring = {};  // name of a spring, a bushing or a joint spring
};

// A panel of history.svg: column names of history.csv; x is the first of them unless told.
struct PlotScene {
  Source source;
  std::string x;  // empty: the first column, time or load_factor
  std::vector<std::string> y;
  double x_scale = 1.0, y_scale = 1.0;
  std::string x_label, y_label, title;
  std::optional<std::array<double, 2>> x_range;
};

// A number the model must give: of a column of history.csv, its value at one time or an extreme over
// the run.
struct ExpectScene {
  Source source;
  std::string quantity;
  enum class Of { value_at, minimum, maximum, limit, bifurcation, mark } of = Of::value_at;
  double at = 0.0;  // [s]
  int number = 1;   // of a limit point, bifurcation or mark of a path, in order
  double value = 0.0;
  double tolerance = 0.0;  // absolute
  std::string reference;   // where the number comes from
};

struct Scene {
  std::string file;                   // for messages; empty when built in C++
  std::vector<std::string> includes;  // files it was read from besides, in order
  Source source;                      // of the <mbd> element
  std::string name;
  std::vector<std::pair<std::string, double>> parameters;
  std::vector<Section> sections;
  std::vector<BeamScene> beams;
  std::vector<BodyScene> bodies;
  std::vector<RigidScene> rigids;
  std::vector<JointScene> joints;
  std::vector<DriveScene> drives;
  std::vector<MotionScene> motions;
  std::vector<LoadScene> loads;
  std::vector<DistributedLoadScene> distributed_loads;
  std::vector<PointMassScene> point_masses;
  std::vector<SpringScene> springs;
  std::vector<BushingScene> bushings;
  std::vector<JointSpringScene> joint_springs;
  std::vector<JointTorqueScene> joint_torques;
  std::vector<DragScene> drags;
  std::vector<AddedMassScene> added_masses;
  std::optional<Gravity> gravity;
  std::optional<BaseMotionScene> base_motion;
  std::optional<StaticScene> statics;  // equilibrium at t = 0, before the transient if there is one
  std::optional<TransientScene> transient;
  std::optional<PathScene> path;  // instead of both
  std::vector<RecordScene> records;
  std::vector<PlotScene> plots;
  std::vector<ExpectScene> expects;
};

}  // namespace mbd
