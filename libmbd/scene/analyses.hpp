// What is to be computed of a scene, and what to be written of its run, drawn, and met.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/scene/field.hpp"

namespace mbd {

inline constexpr field::Range error_range{1e-14, 0.1};  // finer is round-off, coarser is no result

struct StaticScene {
  Source source;
  int steps = 1;
  double tolerance = 1e-12;
  StaticSolver solver = StaticSolver::newton;
  bool line_search = true;  // KINSOL has its own
  LinearMethod linear_solver = LinearMethod::block;

  static constexpr field::ItemKind item{
      "static", "Static equilibrium at t = 0, before the transient if there is one."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = StaticScene;
    f(Field(&S::steps, "steps", "", preset, "the first load step is 1/steps of all loads",
            at_least_one));
    f(Field(&S::tolerance, "tolerance", "", preset, "of Newton's increments, relative", positive));
    f(Field(&S::solver, "solver", "", preset,
            "of each load step: our Newton iterations, or KINSOL's with its line search"));
    f(Field(
        &S::line_search, "line_search", "", preset,
        "of Newton's iterations: increments that do not bring equilibrium nearer are shortened"));
    f(Field(&S::linear_solver, "linear_solver", "", preset,
            "block LU along the graph of nodes and joints, with KLU where that has no good pivots; "
            "or KLU alone"));
  }
};

// Where a path is to be looked at (or ends): where a column of path.csv passes a value.
struct PathMarkScene {
  Source source;
  std::string quantity;
  double value = 0.0;
  bool stops = false;

  static void each_field(const auto& f) {
    using namespace field;
    using S = PathMarkScene;
    f(Field(&S::quantity, "quantity", "", required, "a column of path.csv"));
    f(Field(&S::value, "value", any_unit, required, "the value it passes, from either side"));
  }
};

// A path of equilibria over the load factor (path.hpp).
struct PathScene {
  Source source;
  PathMethod method = PathMethod::bordered;
  PathDirection direction = PathDirection::forward;
  double step = 0.05, max_step = 0.1;
  int points = 200;
  std::optional<double> length;
  int branch = 0;
  double tolerance = 1e-12;
  std::vector<PathMarkScene> marks;

  static constexpr field::ItemKind item{
      "path",
      "Follows the equilibria over the load factor, from 0, through limit points and bifurcations; "
      "instead of <static> and <transient>."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = PathScene;
    f(Field(
        &S::method, "method", "", preset,
        "predictor and corrector on the bordered system, or Crisfield's cylindrical arc length"));
    f(Field(&S::direction, "direction", "", preset,
            "of the load factor at the start: growing, falling, or first one and then the other"));
    f(Field(&S::step, "step", "", preset, "first step, of the load factor", positive));
    f(Field(&S::max_step, "max_step", "", preset,
            "longest step: rms over the nodes of displacement (over the scene's size) and rotation "
            "[rad]",
            positive));
    f(Field(&S::points, "points", "", preset, "most points of each branch", at_least_one));
    f(Field(&S::length, "length", "", optional,
            "most arc length of each branch, measured as max_step", positive));
    f(Field(&S::branch, "branch", "", preset,
            "number of the bifurcation whose other branch is followed too; negative: to its other "
            "side; 0: none",
            Range{-1e6, 1e6}));
    f(Field(&S::tolerance, "tolerance", "", preset, "of the corrector's increments, relative",
            Range{1e-15, 1e-8}));
    f(Parts(&S::marks));
  }
};

// Of a step of Radau IIA, or chosen as it goes (solvers/time/radau.hpp). Not its order, which of reactions, of rows inside
// steps and where things are stiff is lower.
enum class StageCount { automatic, three, five, seven };
template <>
inline constexpr std::string_view words_of<StageCount> = "auto 3 5 7";

// Integration in time. What is absent is chosen by the method, or not used.
struct TransientScene {
  Source source = {};
  double duration = 0.0;
  TimeMethod method = TimeMethod::generalized_alpha;
  // One of both: fixed steps, of which the duration is a whole number, or steps that follow an estimated error.
  std::optional<double> step = {}, tolerance = {};
  // With a tolerance only; of velocities, not of generalized_alpha.
  std::optional<double> position_tolerance = {}, rotation_tolerance = {}, velocity_tolerance = {},
                        angular_velocity_tolerance = {}, max_step = {};
  std::optional<ErrorsOf> errors = {};          // of radau with a tolerance only
  std::optional<double> newton_tolerance = {};  // of ida there is none
  std::optional<StageCount> stages = {};        // of radau only
  // Of generalized_alpha only.
  std::optional<double> rho_infinity = {};
  std::optional<Balance> balance = {};
  // When rows of results are written: in intervals, or (output_steps) where steps end and at the times of
  // expected values. With neither: where fixed steps end; with a tolerance, a thousand times.
  std::optional<double> output = {};
  bool output_steps = false;
  InertiaTerms inertia = InertiaTerms::full;
  LinearMethod linear_solver = LinearMethod::block;  // ida has klu

  static constexpr field::ItemKind item{
      "transient",
      "Integration in time, in fixed steps or in steps that follow an estimated error."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = TransientScene;
    f(Field(&S::duration, "duration", "s", required,
            "simulated time; of fixed steps, a whole number of them", positive));
    f(Field(
        &S::method, "method", "", preset,
        "integrator: of order 2; Radau IIA, of order 5; or IDA of SUNDIALS, of variable order"));
    f(Field(&S::step, "step", "s", optional, "time step, of fixed steps (one of step, tolerance)",
            positive));
    f(Field(&S::tolerance, "tolerance", "", optional,
            "or the relative error that steps are chosen for: of lengths of the scene, of radians, "
            "and of the fastest velocities",
            error_range));
    f(Field(&S::position_tolerance, "position_tolerance", "m", optional,
            "in place of the relative one, of positions", positive));
    f(Field(&S::rotation_tolerance, "rotation_tolerance", "rad", optional, "the same, of rotations",
            positive));
    f(Field(&S::velocity_tolerance, "velocity_tolerance", "m/s", optional,
            "the same, of velocities; not of generalized_alpha, which does not estimate them",
            positive));
    f(Field(&S::angular_velocity_tolerance, "angular_velocity_tolerance", "rad/s", optional,
            "the same, of angular velocities", positive));
    f(Field(&S::errors, "errors", "", optional,
            "of radau with a tolerance: which errors steps are held by, those of positions and "
            "rotations, relative to the largest motion so far, or of velocities as well (default: "
            "motion where all that is recorded follows from it, else velocities)"));
    f(Field(&S::stages, "stages", "", optional,
            "of radau: how many stages a step has, for order 5, 9 or 13, or chosen as it goes by "
            "what comes farthest for its work (default: auto; 3 of fixed steps)"));
    f(Field(&S::max_step, "max_step", "s", optional,
            "longest step that a tolerance may lead to (default: a part of the duration)",
            positive));
    f(Field(
        &S::output, "output", "s", optional,
        "time between rows of results, or steps: where steps end, and at the times of expected "
        "values (default: where fixed steps end; with a tolerance, a thousandth of the duration)",
        positive, OrWords{"steps"}));
    f(Field(&S::rho_infinity, "rho_infinity", "", "0",
            "of generalized_alpha: spectral radius at infinite frequency; 0 damps most, 1 nothing",
            unit_interval));
    f(Field(
        &S::balance, "balance", "", optional,
        "of inertia, of generalized_alpha: accelerations in body axes, or momenta of every node "
        "in inertial axes (default: acceleration, and each part that nothing ties to the ground, "
        "without added mass, keeps its momenta as a whole to the tolerance of Newton's "
        "iterations)"));
    f(Field(&S::newton_tolerance, "newton_tolerance", "", optional,
            "of Newton's increments, relative (default: the integrator's own)", positive));
    f(Field(&S::inertia, "inertia", "", preset,
            "its terms: all, or without the gyroscopic moment w x J w about the mass centre of "
            "what moves with a node"));
    f(Field(&S::linear_solver, "linear_solver", "", preset,
            "block LU along the graph of nodes and joints, with KLU where that has no good pivots; "
            "or KLU alone, which ida always has"));
  }
};

// Modes of small motions that the scene asks for, beside its run (libmbd/study/modes): about equilibrium, or with one of
// `rate` and `at` about a steady rotation or a state of the run.
struct ModesScene {
  Source source = {};
  int count = 10;
  double near = 0.0;
  std::optional<double> rate = {}, at = {};
  std::optional<Vec3> axis = {}, through = {};  // of the rotation
  std::vector<std::string> at_rest = {};
  bool mac = false;

  static constexpr field::ItemKind item{
      "modes",
      "Modes of small motions: frequencies, damping and shapes, in modes.csv and modes.json beside "
      "the results of a run. `mbd modes` has options of the same names, which hold before these "
      "attributes."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ModesScene;
    f(Field(&S::count, "count", "", preset, "how many", Range{1.0, 1e4}));
    f(Field(&S::near, "near", "Hz", preset, "those nearest to this frequency", not_negative));
    f(Field(&S::rate, "rate", "rad/s", optional,
            "about steady rotation of the whole at this rate (default: about equilibrium)"));
    f(Field(&S::at, "at", "s", optional,
            "about the state of a run at this time: what small motions are at that moment",
            not_negative));
    f(Field(&S::axis, "axis", "", "1 0 0", "axis of the rotation", inertial));
    f(Field(&S::through, "through", "m", "0 0 0", "a point of it", point));
    f(Field(&S::at_rest, "at_rest", "", optional,
            "bodies and flexible beams that do not turn, as the housing of a bearing"));
    f(Field(&S::mac, "mac", "", preset,
            "how alike the modes are, weighted by mass, in mac.csv and mac.json: modal assurance "
            "criterion"));
  }

  Vec3 direction() const { return axis.value_or(Vec3::UnitX()).normalized(); }
  Vec3 point_of_axis() const { return through.value_or(Vec3::Zero()); }

  // Why what is stated cannot be together; empty if it can.
  std::string contradiction() const {
    if (rate && at)
      return "rate is of a steady rotation, at of the state of a run; give one of them";
    if (axis && !(axis->norm() > 0.0)) return "axis: give a direction that is not zero";
    if (!rate && (axis || through || !at_rest.empty()))
      return "axis, through and at_rest are of a steady rotation; give its rate, or leave them out";
    return {};
  }
};

// One line of output: quantities of a place, of a joint or motion, of a spring, or (with none) of the whole
// system, whenever a row of results is written.
struct RecordScene {
  Source source;
  std::string name;
  std::optional<Place> at;
  std::optional<std::string> joint;
  std::vector<std::string> quantities;
  std::optional<std::string> spring = {};
  std::optional<std::array<double, 2>> section_point = {};  // of `at`: x2, x3

  static constexpr field::ItemKind item{"record", "Columns of history.csv.", "records",
                                        field::of_records};
  static void each_field(const auto& f) {
    using namespace field;
    using S = RecordScene;
    f(Field(&S::name, "name", "", required, "first part of its columns in history.csv", item_name));
    f(Field(&S::at, "at", "", optional,
            "a place; without place, joint and spring: the whole system"));
    f(Field(&S::joint, "joint", "", optional,
            "name of a joint or a motion (one of at, joint, spring)"));
    f(Field(&S::spring, "spring", "", optional, "name of a spring, a bushing or a joint_spring"));
    f(Field(&S::section_point, "section_point", "m", optional,
            "of a place of a beam: x2 x3 along b2 b3 from the reference line, of stresses and "
            "strains of a "
            "section that is stated by material"));
    f(Field(&S::quantities, "quantities", "", required, "what to write, separated by blanks"));
  }
};

// The motion of all nodes is kept, in motion.bin beside history.csv (libmbd/view/motion.hpp).
struct MotionOutputScene {
  Source source;
  std::optional<int> frames = {};

  static constexpr field::ItemKind item{
      "motion_output",
      "Keeps the motion of every node, resultants along beams and reactions of joints in "
      "motion.bin, for `mbd view`. Without it nothing is kept, and `mbd run --motion` does the "
      "same for any model."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = MotionOutputScene;
    f(Field(&S::frames, "frames", "", optional,
            "of a <transient>: so many frames at equal times, the first at the start and the last "
            "at the end (default: one with each row of history.csv)",
            Range{2.0, 1e6}));
  }
};

// A panel of history.svg.
struct PlotScene {
  Source source;
  std::string x;  // empty: the first column
  std::vector<std::string> y;
  double x_scale = 1.0, y_scale = 1.0;
  std::string x_label, y_label, title;
  std::optional<std::array<double, 2>> x_range;

  static constexpr field::ItemKind item{"plot", "A panel of history.svg.", "plots"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = PlotScene;
    f(Field(&S::x, "x", "", optional,
            "a column of history.csv (default: the first, time or load_factor)"));
    f(Field(&S::y, "y", "", required, "columns of history.csv, one curve each"));
    f(Field(&S::x_scale, "x_scale", "", preset, "factor on x"));
    f(Field(&S::y_scale, "y_scale", "", preset, "factor on y"));
    f(Field(&S::x_label, "x_label", "", optional, "default: the column and its unit"));
    f(Field(&S::y_label, "y_label", "", optional, "default: the column and its unit"));
    f(Field(&S::title, "title", "", optional, "written above the panel"));
    f(Field(&S::x_range, "x_range", "", optional, "ends of the x axis, scaled"));
  }
};

// A number the model must give.
struct ExpectScene {
  Source source;
  std::string quantity;
  using Of = ExpectedOf;
  Of of = Of::value_at;
  double at = 0.0;
  int number = 1;
  double value = 0.0, tolerance = 0.0;
  std::string reference;

  static constexpr field::ItemKind item{"expect", "A number the run must give.", "expectations"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ExpectScene;
    f(Field(&S::quantity, "quantity", "", required, "a column of history.csv"));
    f(Field(&S::of, "of", "", preset,
            "its value at one time (of load steps and paths: at the end), an extreme over the run, "
            "or its value at a limit point, bifurcation or mark of a path"));
    f(Field(&S::number, "number", "", preset, "of the limit point, bifurcation or mark, in order",
            at_least_one));
    f(Field(&S::at, "at", "s", optional,
            "time of the value, one at which a row of results is written", not_negative));
    f(Field(&S::value, "value", any_unit, required, "what it must be"));
    f(Field(&S::tolerance, "tolerance", any_unit, required, "by how much it may differ", positive));
    f(Field(&S::reference, "source", "", required, "where the number comes from"));
    f(Extra("when", Kind::names, "", optional,
            "parameter=value: checked only when the parameters have these values, to 12 digits"));
  }
};

}  // namespace mbd
