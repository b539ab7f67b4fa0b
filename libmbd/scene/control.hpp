// Functions of time that laws share, and controllers that sample the motion.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "libmbd/scene/field.hpp"

namespace mbd {

// A named function of time: an expression of t, or a table of t and its values.
struct FunctionScene {
  Source source;
  std::string name;
  std::optional<Expression> value;
  std::optional<TableScene> table;  // values in SI units

  static constexpr field::ItemKind item{
      "function",
      "A function of time that the laws of loads, drives and controllers call by its name, as "
      "ref(t) or ref(2*t+1): an expression, or as text a table of t [s] and its value in turn, t "
      "rising.",
      "functions", field::of_functions};
  static void each_field(const auto& f) {
    using namespace field;
    using S = FunctionScene;
    f(Field(&S::name, "name", "", required,
            "what expressions of time call it: letters, digits and _, after its <function>",
            item_name));
    f(Field(&S::value, "value", any_unit, optional,
            "an expression of t, of inputs and of functions before it, or a table as text"));
    f(Extra("unit", Kind::text, "", optional,
            "of the values of a table (default: SI units; those of t are s)"));
  }
};

// What a controller consists of, in the order in which it is evaluated.
struct ControlStateScene {
  Source source;
  std::string name;
  double start = 0.0;
  Expression next;

  static constexpr field::ItemKind item{
      "state", "A number that a controller keeps from one instant to the next."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ControlStateScene;
    f(Field(&S::name, "name", "", required, "what expressions of its controller call it"));
    f(Field(&S::start, "start", pure_number, "0", "at the first instant"));
    f(Field(&S::next, "next", any_unit, required,
            "at the next instant, of t, sensors, inputs and the states as they are now"));
  }
};

struct ControlOutputScene {
  Source source;
  std::string name;
  double start = 0.0;
  Expression value;

  static constexpr field::ItemKind item{
      "output", "What a controller gives: laws use it by its name, as an input."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ControlOutputScene;
    f(Field(&S::name, "name", "", required, "what laws after it call it: letters, digits and _"));
    f(Field(&S::start, "start", any_unit, "0", "before the first instant, and in a <static>"));
    f(Field(&S::value, "value", any_unit, required,
            "from the instant on until the next: an expression of t, sensors, inputs, states and "
            "outputs before it, in SI units or the one behind it"));
  }
};

struct PidScene {
  Source source;
  std::string name;
  double start = 0.0;
  Expression error;
  double proportional = 0.0, integral = 0.0, derivative = 0.0, filter = 0.0;
  std::optional<std::array<double, 2>> limits;

  static constexpr field::ItemKind item{
      "pid", "A PID controller: an output with an integrator and a filtered derivative."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = PidScene;
    f(Field(&S::name, "name", "", required,
            "of its output: what laws after it call it: letters, digits and _"));
    f(Field(&S::error, "error", any_unit, required,
            "what it is to bring to 0, as ref(t)-elbow.angle: an expression as of an output"));
    f(Field(&S::proportional, "proportional", any_unit, "0", "output per error"));
    f(Field(&S::integral, "integral", any_unit, "0", "rate of the output per error"));
    f(Field(&S::derivative, "derivative", any_unit, "0", "output per rate of the error"));
    f(Field(&S::filter, "filter", "s", "0", "time constant of the derivative", not_negative));
    f(Field(&S::limits, "limits", any_unit, optional,
            "least and largest output; while it is there, the integrator does not run further into "
            "them"));
    f(Field(&S::start, "start", any_unit, "0",
            "of the integrator, and the output before the first instant"));
  }
};

// x(k+1) = A x + B w, outputs C x + D w. Matrices row by row.
struct StateSpaceScene {
  Source source;
  std::vector<Expression> inputs;
  std::vector<std::string> outputs;
  std::vector<double> A, B, C, D, start;

  static constexpr field::ItemKind item{
      "state_space",
      "Outputs y = C x + D w of states x, which at the next instant are A x + B w, w the values of "
      "expressions. Matrices row by row."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = StateSpaceScene;
    f(Extra("inputs", Kind::text, "", required,
            "w: expressions as of an output, separated by blanks, which they do not contain"));
    f(Field(&S::outputs, "outputs", "", required, "y: what laws after it call them"));
    f(Extra("A", Kind::text, "", optional, "of states by states (none: there are no states)"));
    f(Extra("B", Kind::text, "", optional, "of states by inputs"));
    f(Extra("C", Kind::text, "", optional, "of outputs by states"));
    f(Extra("D", Kind::text, "", optional, "of outputs by inputs (default 0)"));
    f(Extra("start", Kind::text, "", optional, "of the states (default 0)"));
  }
};

using ControlPart = std::variant<ControlStateScene, ControlOutputScene, PidScene, StateSpaceScene>;

struct ControllerScene {
  Source source;
  std::string name;
  double period = 0.0;
  std::vector<ControlPart> parts;  // moving or rescaling a scene leaves them as they are

  static constexpr field::ItemKind item{
      "controller",
      "Samples the motion at t = 0, period, 2 period, … and holds its outputs until the next "
      "instant: what it consists of is evaluated in its order, with states as they were; what it "
      "gives acts from that instant on, without delay. Steps end there.",
      "controllers", field::of_controllers};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ControllerScene;
    f(Field(&S::name, "name", "", required, "name, for messages and results", item_name));
    f(Field(&S::period, "period", "s", required, "between its instants", positive));
  }
};

}  // namespace mbd
