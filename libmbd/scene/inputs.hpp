// What a program sets while a model runs (libmbd/core/input.hpp).
#pragma once

#include <string>

#include "libmbd/scene/field.hpp"

namespace mbd {

struct InputScene {
  Source source;
  std::string name;
  std::string unit;
  double value = 0.0;
  double factor = 1.0;     // what makes SI of its values
  std::string controller;  // that sets it, as its output; empty: an <input>

  static constexpr field::ItemKind item{
      "input",
      "A value that a program sets while the model runs; the laws of loads, joint torques, flows "
      "and drives use it by its "
      "name, as they use t. In a run of `mbd run` it keeps its `value`.",
      "inputs",
      field::of_inputs,
      false,
      "inputs that a program sets"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = InputScene;
    f(Field(&S::name, "name", "", required,
            "what expressions of time call it: letters, digits and _, after its <input>",
            item_name));
    f(Field(&S::unit, "unit", "", optional,
            "of its values, which expressions know in SI units; without one they are taken as they "
            "are"));
    f(Field(&S::value, "value", pure_number, preset, "at the start, in that unit"));
  }
};

}  // namespace mbd
