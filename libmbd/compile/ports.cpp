#include "libmbd/compile/ports.hpp"

#include <fmt/format.h>

#include <optional>
#include <set>

#include "libmbd/scene/places.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

// The place of a name in a list.
template <class Named>
std::size_t find(const std::vector<Named>& all, std::string_view name, const char* one,
                 const char* many) {
  std::vector<std::string_view> names;
  for (const Named& known : all) {
    if (known.name == name) return names.size();
    names.push_back(known.name);
  }
  throw Error(fmt::format("there is no {} \"{}\"{}", one, name, suggest(name, names, many)));
}

}  // namespace

Ports ports(const Model& model) {
  Ports all;
  for (const InputInfo& input : model.system->inputs())
    all.inputs.push_back({input.name, input.unit, {}, input.set_by});
  for (const Channel& channel : model.channels)
    for (const Column& column : channel.columns)
      all.outputs.push_back({column.name, column.unit, column.frame});
  return all;
}

void outputs(const Model& model, const State& state, std::span<double> values) {
  std::size_t at = 0;
  std::optional<State> shared;
  if (!model.redundant.empty()) {
    shared = state;
    shared->lambda = minimum_norm(*model.system, state);
  }
  for (const Channel& channel : model.channels) {
    channel.sample(shared ? *shared : state, values.subspan(at, channel.columns.size()));
    at += channel.columns.size();
  }
}

std::vector<NamedPlace> named_places(const Model& model) {
  std::vector<NamedPlace> all;
  std::set<std::string, std::less<>> known;
  const auto add = [&](const std::string& name, int node, const Pose<double>& frame) {
    if (known.insert(name).second) all.push_back({name, node, frame});
  };
  add("ground", 0, {});
  for (const Model::PlaceFrame& place : model.places)
    add(text_of(place.place), place.node, place.frame);
  for (const Model::Line& line : model.lines)
    for (std::size_t k = 0; k < line.size(); ++k)
      add(text_of({Place::Kind::beam, line.name, line.s[k]}), line.nodes[k], line.frames[k]);
  const System& system = *model.system;
  for (Index n = 1; n < system.nodes(); ++n) add(system.node_name(n), static_cast<int>(n), {});
  return all;
}

std::size_t input_index(const Model& model, std::string_view name) {
  return find(model.system->inputs(), name, "input", "inputs");
}

std::size_t output_index(const Model& model, std::string_view name) {
  return find(ports(model).outputs, name, "output", "outputs");
}

NamedPlace named_place(const Model& model, std::string_view name) {
  std::vector<NamedPlace> all = named_places(model);
  return std::move(all[find(all, name, "place that has a node", "places and nodes")]);
}

int node_index(const Model& model, std::string_view name) { return named_place(model, name).node; }

}  // namespace mbd
