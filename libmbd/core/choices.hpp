// What a user may choose by a word: each enum with the words for it, in its order.
//
// The words are those of model files, of the command line and of reports. They are what name_of() gives and what the
// schema offers (libmbd/language/schema.hpp).
#pragma once

#include <string_view>

namespace mbd {

// What is interpolated between the nodes of an element: their motion (elements/beam/beam_elastic.hpp), or displacement
// and rotation apart (elements/beam/beam_classical.hpp), which has neither a metric nor a choice of form.
enum class Kinematics { motion, classical };

// How the relative motion of two nodes is measured (metrics.hpp).
enum class Metric { matrix, quaternion, geodesic };

// Quadrature over an element (spectral.hpp).
enum class Rule { gauss, gauss_lobatto };

// Of a beam's elastic force: the energy form is the gradient of a discrete energy, the paper's a Petrov-Galerkin one.
enum class Form { energy, paper };

// How a scene is integrated in time (solvers/time).
enum class TimeMethod { generalized_alpha, radau, ida };

// How a time stepper balances inertia: by accelerations in body axes, or by momenta in inertial axes
// (solvers/time/generalized_alpha.hpp).
enum class Balance { acceleration, momentum };

// Of which estimated errors steps are held below a tolerance: of positions and rotations alone, or of velocities as well
// (solvers/time/error_control.hpp).
enum class ErrorsOf { motion, velocities };

// Which terms inertia has (elements/node/mass.hpp). no_gyroscopic: without the moment w x J w about the mass centre of
// what moves with a node.
enum class InertiaTerms { full, no_gyroscopic };

// What finds an equilibrium: our Newton iterations, or KINSOL of SUNDIALS (solvers/statics/equilibrium.hpp).
enum class StaticSolver { newton, kinsol };

// What solves the linear systems of Newton's iterations: block LU on the graph of nodes and joints, with KLU where that has
// no good pivots, or KLU alone (solvers/linear/block_solver.hpp).
enum class LinearMethod { block, klu };

// How a path of equilibria is followed, and which way of the load factor it starts (solvers/statics/path.hpp).
enum class PathMethod { bordered, crisfield };
enum class PathDirection { forward, backward, both };

// How a table is interpolated: by straight lines, or by the interpolating spline of degree 3 (or less, with fewer than 4
// points).
enum class Interpolation { linear, smooth };

// How a beam is divided: into elements of equal length, or so between each two stations of its section.
enum class Mesh { equal, stations };

// What of a quantity is expected: its value at one time, an extreme, or its value at a special point of a path.
enum class ExpectedOf { value_at, minimum, maximum, limit, bifurcation, mark };

// What kind of thing went wrong, for programs that act on it: of mbd::Error, of steps and of runs that ended. Messages say it to
// people, with names and remedies.
enum class Failure {
  none,
  request,  // what a program or a command asked for: a setting, a size, a name, a file that is not there
  model,    // what the model says
  plug_in,  // a shared object that is no plug-in, or one whose force throws or gives no numbers
  file,     // could not be written, or not read
  order,    // step() before start(), or with a state of another time
  inconsistent,  // the state breaks its constraints
  law,           // a law, an input or a controller cannot be used at that time, or jumps
  range,         // out of what an element or a force is defined for, or numbers that are none
  singular,      // the equations do not determine the motion
  convergence,   // Newton's iterations do not come to their end, also in shorter steps
  step_size,     // steps have become as short as round-off of times
  end,           // of the time that adaptive steps were made for, or stop_at()
  stopped,       // asked to
  memory
};

// The words of an enum, separated by blanks.
template <class Enum>
inline constexpr std::string_view words_of = {};
template <>
inline constexpr std::string_view words_of<Kinematics> = "motion classical";
template <>
inline constexpr std::string_view words_of<Metric> = "matrix quaternion geodesic";
template <>
inline constexpr std::string_view words_of<Rule> = "gauss gauss_lobatto";
template <>
inline constexpr std::string_view words_of<Form> = "energy paper";
template <>
inline constexpr std::string_view words_of<TimeMethod> = "generalized_alpha radau ida";
template <>
inline constexpr std::string_view words_of<Balance> = "acceleration momentum";
template <>
inline constexpr std::string_view words_of<ErrorsOf> = "motion velocities";
template <>
inline constexpr std::string_view words_of<InertiaTerms> = "full no_gyroscopic";
template <>
inline constexpr std::string_view words_of<StaticSolver> = "newton kinsol";
template <>
inline constexpr std::string_view words_of<LinearMethod> = "block klu";
template <>
inline constexpr std::string_view words_of<PathMethod> = "bordered crisfield";
template <>
inline constexpr std::string_view words_of<PathDirection> = "forward backward both";
template <>
inline constexpr std::string_view words_of<Interpolation> = "linear smooth";
template <>
inline constexpr std::string_view words_of<Mesh> = "equal stations";
template <>
inline constexpr std::string_view words_of<Failure> =
    "none request model plug_in file order inconsistent law range singular convergence step_size "
    "end stopped memory";
template <>
inline constexpr std::string_view words_of<ExpectedOf> =
    "value minimum maximum limit bifurcation mark";

// "radau". Of the enums above only.
template <class Enum>
requires(!words_of<Enum>.empty()) constexpr std::string_view name_of(Enum choice) {
  std::string_view words = words_of<Enum>;
  for (int skip = static_cast<int>(choice); skip > 0; --skip)
    words.remove_prefix(words.find(' ') + 1);
  return words.substr(0, words.find(' '));
}

}  // namespace mbd
