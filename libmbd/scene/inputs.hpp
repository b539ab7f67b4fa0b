// What comes from outside of a model: inputs that a program sets while it runs (libmbd/core/input.hpp), forces of plug-ins.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libmbd/scene/field.hpp"

struct mbd_plugin;  // libmbd/plugin.h

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

// A force that a plug-in computes. Studies and copies of the scene have the plug-in with it.
struct ExtensionScene {
  Source source;
  std::string name;
  std::string force;
  std::vector<std::string> at;
  std::vector<std::pair<std::string, double>>
      values;  // SI units; moving or rescaling a scene leaves them
  std::shared_ptr<const mbd_plugin>
      plugin;  // use_plugin(), libmbd/compile/plugin.hpp; null: none has been given
  std::string plugin_file;

  static constexpr field::ItemKind item{
      "extension",
      "A force that a plug-in computes, as `mbd run --plugin FILE` gives it (libmbd/plugin.h).",
      "extensions",
      field::of_loads,
      false,
      "forces of plug-ins",
      "Inputs from a program"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ExtensionScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::force, "force", "", required, "what its plug-in calls it"));
    f(Field(&S::at, "at", "", required,
            "what it acts on, in the order its plug-in wants: places with a node, or beams, which "
            "stand for all of their "
            "nodes"));
    f(Extra("values", Kind::text, "", optional,
            "numbers for it: name=expression, separated by blanks, which expressions do not "
            "contain, in SI units"));
  }
};

}  // namespace mbd
