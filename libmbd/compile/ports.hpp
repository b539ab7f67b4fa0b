// What goes into a running model and what comes out of it, by name: its inputs, and everything that its records say.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/compile/model.hpp"

namespace mbd {

// `name` and `unit` as in the model and in history.csv; `frame`: along whose axes, "" of what has none.
struct Port {
  std::string name, unit, frame;
  std::string set_by =
      {};  // of an input: the controller of the model that sets it; empty: the program does
};

struct Ports {
  std::vector<Port> inputs;   // in the order of State::inputs
  std::vector<Port> outputs;  // in the order of outputs(): the columns of history.csv but the first
};
Ports ports(const Model& model);

// The numbers of all outputs at a state; as many as ports().outputs. Reactions that constraints share are of least norm, as in
// history.csv.
void outputs(const Model& model, const State& state, std::span<double> values);

// Everything that a node of the system can be called by: "ground", places of the scene and nodes of its beams ("arm.end",
// "arm@0.5"), names of nodes. Each name once.
struct NamedPlace {
  std::string name;
  int node = 0;
  Pose<double> frame;  // of the place, in its node
};
std::vector<NamedPlace> named_places(const Model& model);
// One of them. Throws Error as node_index() does.
NamedPlace named_place(const Model& model, std::string_view name);

// Places in State::inputs, in outputs(), and among the nodes of the system. Throw Error for a name that is not there, with
// the nearest that is.
std::size_t input_index(const Model& model, std::string_view name);
std::size_t output_index(const Model& model, std::string_view name);
int node_index(const Model& model, std::string_view name);

}  // namespace mbd
