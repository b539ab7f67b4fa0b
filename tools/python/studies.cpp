// Studies of a model as data: JSON for Python to read, and arrays.

#include <fmt/format.h>
#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <variant>

#include "libmbd/language/schema.hpp"
#include "libmbd/study/accuracy/accuracy.hpp"
#include "libmbd/study/accuracy/accuracy_report.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/effects/effects.hpp"
#include "libmbd/study/effects/effects_report.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/rotations.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"
#include "tools/python/background.hpp"
#include "tools/python/errors.hpp"
#include "tools/python/model.hpp"

namespace mbd::python {
namespace {

void check_between(const char* name, double value, double least, double most) {
  if (!(value >= least) || !(value <= most))
    throw UseError(
        fmt::format("{} = {:g}: give a number from {:g} to {:g}", name, value, least, most));
}

// What was raised during a study, with what is there of it.
py::object done(const py::object& raised, const std::string& json) {
  return py::make_tuple(json.empty() ? py::object(py::none()) : py::object(py::str(json)), raised);
}

py::object accuracy(const ModelHandle& model, const std::vector<std::string>& quantities,
                    const std::vector<std::string>& vary,
                    const std::optional<std::string>& reference, double budget,
                    std::optional<int> refinements) {
  check_between("budget", budget, 1.0, 1e6);
  AccuracyOptions options;
  if (refinements) {
    check_between("refinements", *refinements, 1, options.refinements);
    options.refinements = *refinements;
  }
  options.quantities = quantities;
  for (const std::string& one : vary) add_variation(options.variations, one);
  if (reference) options.reference = *reference;
  options.budget = budget;
  std::string json;
  const py::object raised = in_background([&](const std::atomic<bool>& interrupted) {
    options.interrupted = &interrupted;
    json = to_json(study_accuracy(model.scene(), options));
  });
  return done(raised, json);
}

py::object effects(const ModelHandle& model, const std::vector<std::string>& quantities,
                   double tolerance, double budget) {
  check_between("budget", budget, 1.0, 1e6);
  if (!(tolerance > 0.0) || !(tolerance <= 1.0))
    throw UseError(
        fmt::format("tolerance = {:g}: give a relative change, above 0 and up to 1", tolerance));
  EffectsOptions options;
  options.quantities = quantities;
  options.tolerance = tolerance;
  options.budget = budget;
  std::string json;
  const py::object raised = in_background([&](const std::atomic<bool>& interrupted) {
    options.interrupted = &interrupted;
    json = to_json(study_effects(model.scene(), options));
  });
  return done(raised, json);
}

using Three = std::optional<std::array<double, 3>>;

// What is given of a rotation, as options of the program say it.
RotationArguments rotation_given(const Three& axis, const Three& through,
                                 const std::vector<std::string>& at_rest) {
  RotationArguments given;
  if (axis) given.axis.assign(axis->begin(), axis->end());
  if (through) given.through.assign(through->begin(), through->end());
  given.at_rest = at_rest;
  return given;
}

// f(), whose errors are of what was given here.
template <class F>
auto as_use(const F& f) {
  try {
    return f();
  } catch (const Error& error) {
    throw UseError(error.what());
  }
}

Scene scene_without(const ModelHandle& model, const std::vector<std::string>& effects) {
  return effects.empty() ? model.scene() : without(model.scene(), effects);
}

py::array_t<double> array_of(const MatX& matrix) {
  py::array_t<double> array({matrix.rows(), matrix.cols()});
  for (Index i = 0; i < matrix.rows(); ++i)
    for (Index j = 0; j < matrix.cols(); ++j) array.mutable_at(i, j) = matrix(i, j);
  return array;
}

py::dict dict_of_mac(const MacTable& table) {
  py::list pairs;
  for (const MacTable::Pair& pair : table.pairs) {
    py::dict one;
    one["modes"] = table.modes.groups[pair.group];
    one["others"] = table.others.groups[pair.other];
    one["alike"] = pair.alike;
    pairs.append(one);
  }
  py::dict all;
  all["mac"] = array_of(table.mac);
  all["mac_of_groups"] = array_of(table.groups);
  all["groups"] = table.modes.groups;
  all["other_groups"] = table.others.groups;
  all["other_names"] = table.others.names;
  all["other_frequencies"] = py::array_t<double>(
      static_cast<py::ssize_t>(table.others.frequencies.size()), table.others.frequencies.data());
  all["pairs"] = pairs;
  all["notes"] = table.notes;
  return all;
}

// Modes to compare with: of a model, or of what `mbd modes --compare` takes.
using Compared = std::variant<std::monostate, std::shared_ptr<ModelHandle>, std::string>;

std::shared_ptr<const ShapesOfModes> compared_modes(const Compared& compared,
                                                    const ModesArguments& given) {
  if (const auto* const file = std::get_if<std::string>(&compared))
    return std::make_shared<const ShapesOfModes>(modes_to_compare(*file, given));
  const auto* const other = std::get_if<std::shared_ptr<ModelHandle>>(&compared);
  if (other == nullptr) return nullptr;
  return std::make_shared<const ShapesOfModes>(modes_to_compare((*other)->scene(), given));
}

py::dict modes(const ModelHandle& model, std::optional<int> count, const std::string& near,
               const std::string& rate, const std::string& time, const Three& axis,
               const Three& through, const std::vector<std::string>& at_rest,
               const std::vector<std::string>& left_out, bool mac, const Compared& compared) {
  const Scene scene = scene_without(model, left_out);
  const ModesArguments given{
      count, near, {rate, time, rotation_given(axis, through, at_rest)}, mac};
  ModesOptions options = as_use([&] { return modes_options(given, scene); });
  std::optional<ModesStudy> study;
  raise_if(in_background([&](const std::atomic<bool>&) {
             options.compared = compared_modes(compared, given);
             study = study_modes(scene, options);
           }),
           py::none());

  const auto modes = static_cast<py::ssize_t>(study->modes.size());
  const auto nodes = static_cast<py::ssize_t>(study->nodes.size());
  using Complex = std::complex<double>;
  const double nothing = std::nan("");
  py::array_t<Complex> eigenvalues(modes), shapes({modes, nodes, py::ssize_t{6}});
  py::array_t<double> frequencies(modes), damping(modes), orbits(modes), inertial(modes),
      positions({nodes, py::ssize_t{3}}), residuals(modes), conditions(modes);
  py::list names, parts;
  for (py::ssize_t n = 0; n < nodes; ++n)
    for (py::ssize_t k = 0; k < 3; ++k)
      positions.mutable_at(n, k) = study->poses[static_cast<std::size_t>(n)].r(k);
  for (py::ssize_t m = 0; m < modes; ++m) {
    const NamedMode& mode = study->modes[static_cast<std::size_t>(m)];
    eigenvalues.mutable_at(m) = mode.eigenvalue;
    frequencies.mutable_at(m) = mode.frequency();
    damping.mutable_at(m) = mode.damping_ratio();
    orbits.mutable_at(m) = mode.orbit.value_or(nothing);
    residuals.mutable_at(m) = mode.residual;
    conditions.mutable_at(m) = mode.condition;
    const auto whirl = mode.whirl(study->rotation ? study->rotation->rate : 0.0, study->axes);
    inertial.mutable_at(m) = whirl ? *whirl / (2.0 * std::numbers::pi) : nothing;
    names.append(mode.name);
    py::dict shares;
    for (const auto& [part, share] : mode.parts) shares[py::str(part)] = share;
    parts.append(shares);
    for (py::ssize_t n = 0; n < nodes; ++n) {  // inertial axes, as modes.json has them
      const Mat3 R = study->poses[static_cast<std::size_t>(n)].R();
      for (py::ssize_t part = 0; part < 6; part += 3) {
        const Eigen::Vector3cd x = R * mode.shape.segment<3>(6 * n + part);
        for (py::ssize_t k = 0; k < 3; ++k) shapes.mutable_at(m, n, part + k) = x(k);
      }
    }
  }
  py::dict all;
  all["model"] = study->model;
  all["eigenvalues"] = eigenvalues;
  all["frequencies"] = frequencies;
  all["damping_ratios"] = damping;
  all["names"] = names;
  all["parts"] = parts;
  all["nodes"] = study->nodes;
  all["positions"] = positions;
  all["shapes"] = shapes;
  all["orbits"] = orbits;
  all["inertial_frequencies"] = inertial;
  all["residuals"] = residuals;
  all["conditions"] = conditions;
  all["axes"] = study->rotation
                    ? py::object(py::str(study->axes == ModeAxes::turning ? "turning" : "resting"))
                    : py::object(py::none());
  all["notes"] = study->notes;
  all["mac"] = study->mac ? py::object(dict_of_mac(*study->mac)) : py::object(py::none());
  return all;
}

py::dict linear(const ModelHandle& model, const std::string& time, const std::string& rate,
                const Three& axis, const Three& through, const std::vector<std::string>& at_rest,
                const std::vector<std::string>& left_out) {
  const Scene scene = scene_without(model, left_out);
  const ModesOptions options = as_use([&] {
    return about({rate, time, rotation_given(axis, through, at_rest)}, scene);
  });
  std::optional<Linearization> made;
  raise_if(in_background([&](const std::atomic<bool>&) { made = linearize(scene, options); }),
           py::none());
  return dict_of(*made);
}

// Unbalance and forces by place, the order of the forces, probes.
using Driven =
    std::tuple<std::map<std::string, std::string>,
               std::map<std::string, std::array<std::string, 2>>, double, std::vector<std::string>>;

py::list list_of(const std::vector<CampbellStudy::Response>& responses) {
  py::list all;
  for (const CampbellStudy::Response& response : responses) {
    const auto size = static_cast<py::ssize_t>(response.orbits.size());
    py::array_t<double> rates(size), besides(size);
    py::array_t<std::complex<double>> forward(size), backward(size);
    for (py::ssize_t i = 0; i < size; ++i) {
      const Orbit& orbit = response.orbits[static_cast<std::size_t>(i)];
      rates.mutable_at(i) = orbit.rate;
      forward.mutable_at(i) = orbit.forward;
      backward.mutable_at(i) = orbit.backward;
      besides.mutable_at(i) = orbit.besides;
    }
    py::dict one;
    one["place"] = response.place;
    one["rates"] = rates;
    one["forward"] = forward;
    one["backward"] = backward;
    one["besides"] = besides;
    all.append(one);
  }
  return all;
}

RangeOfRates range_given(const std::string& first, const std::string& last, const Three& axis,
                         const Three& through, const std::vector<std::string>& at_rest,
                         const Scene& scene) {
  RangeOfRates range{{}, at_rest, 0.0, 0.0};
  range.rotation = as_use([&] { return rotation_of(rotation_given(axis, through, {})); });
  range.from = option_value("rates", first, "rad/s", scene);
  range.to = option_value("rates", last, "rad/s", scene);
  as_use([&] { require_rising(range); });
  return range;
}

py::tuple campbell(const ModelHandle& model, const std::string& from, const std::string& to,
                   int points, int count, const Three& axis, const Three& through,
                   const std::vector<std::string>& at_rest,
                   const std::vector<std::string>& left_out, const Driven& driven) {
  check_between("points", points, 2, 100000);
  check_between("count", count, 1, 1000);
  const Scene scene = scene_without(model, left_out);
  CampbellOptions options;
  static_cast<RangeOfRates&>(options) = range_given(from, to, axis, through, at_rest, scene);
  options.points = points;
  options.count = count;
  for (const auto& [place, moment] : std::get<0>(driven))
    options.unbalance.push_back({place, option_value("unbalance", moment, "kg.m", scene)});
  for (const auto& [place, force] : std::get<1>(driven))
    options.forces.push_back({place, option_value("forces", force[0], "N", scene),
                              option_value("forces", force[1], "N", scene)});
  options.order = std::get<2>(driven);
  options.probes = std::get<3>(driven);
  std::optional<CampbellStudy> study;
  const py::object raised = in_background([&](const std::atomic<bool>& interrupted) {
    options.interrupted = &interrupted;
    study = study_campbell(scene, options);
  });
  if (!study) return py::make_tuple(py::none(), raised);
  py::list branches, special;
  for (const CampbellBranch& branch : study->branches) {
    const auto size = static_cast<py::ssize_t>(branch.points.size());
    py::array_t<double> rates(size), inertial(size), overlaps(size);
    py::array_t<std::complex<double>> eigenvalues(size);
    for (py::ssize_t i = 0; i < size; ++i) {
      const CampbellPoint& p = branch.points[static_cast<std::size_t>(i)];
      rates.mutable_at(i) = p.rate;
      eigenvalues.mutable_at(i) = p.eigenvalue;
      inertial.mutable_at(i) = p.inertial.value_or(std::nan(""));
      overlaps.mutable_at(i) = p.overlap;
    }
    py::dict one;
    one["name"] = branch.name;
    one["rates"] = rates;
    one["eigenvalues"] = eigenvalues;
    one["inertial_frequencies"] = inertial;
    one["overlaps"] = overlaps;
    branches.append(one);
  }
  for (const SpecialSpeed& speed : study->special) {
    py::dict one;
    one["kind"] = word_of(speed.kind);
    one["rate"] = speed.rate;
    one["branch"] = speed.branch;
    special.append(one);
  }
  py::dict all;
  all["model"] = study->model;
  all["axes"] = study->axes == ModeAxes::turning ? "turning" : "resting";
  all["rates"] =
      py::array_t<double>(static_cast<py::ssize_t>(study->rates.size()), study->rates.data());
  all["displacements"] = py::array_t<double>(static_cast<py::ssize_t>(study->displacements.size()),
                                             study->displacements.data());
  all["branches"] = branches;
  all["special"] = special;
  all["unbalance_responses"] = list_of(study->responses);
  all["force_responses"] = list_of(study->force_responses);
  all["notes"] = study->notes;
  return py::make_tuple(all, raised);
}

// `search`: searches, points, far, count.
py::tuple rotations(const ModelHandle& model, const std::string& from, const std::string& to,
                    const Three& axis, const Three& through,
                    const std::vector<std::string>& at_rest,
                    const std::vector<std::string>& left_out,
                    const std::vector<std::string>& probes,
                    const std::tuple<int, int, double, int>& search) {
  const auto [searches, points, far, count] = search;
  check_between("search", searches, 0, 1000);
  check_between("points", points, 2, 100000);
  check_between("far", far, 1e-6, 100.0);
  check_between("count", count, 1, 1000);
  const Scene scene = scene_without(model, left_out);
  RotationsOptions options;
  static_cast<RangeOfRates&>(options) = range_given(from, to, axis, through, at_rest, scene);
  options.probes = probes;
  options.searches = searches;
  options.points = points;
  options.far = far;
  options.count = count;
  std::optional<RotationsStudy> study;
  const py::object raised = in_background([&](const std::atomic<bool>& interrupted) {
    options.interrupted = &interrupted;
    study = study_rotations(scene, options);
  });
  if (!study) return py::make_tuple(py::none(), raised);
  py::list paths;
  for (const PathOfRotations& path : study->paths) {
    const auto size = static_cast<py::ssize_t>(path.points.size());
    py::array_t<double> rates(size), displacements(size), growth(size);
    py::array_t<double> moved({size, static_cast<py::ssize_t>(probes.size()), py::ssize_t{3}});
    py::array_t<int> unstable(size);
    py::list folds;
    for (py::ssize_t i = 0; i < size; ++i) {
      const RotationOnPath& point = path.points[static_cast<std::size_t>(i)];
      rates.mutable_at(i) = point.rate;
      displacements.mutable_at(i) = point.displacement;
      growth.mutable_at(i) = point.unstable ? point.growth : std::nan("");
      unstable.mutable_at(i) = point.unstable.value_or(-1);
      for (std::size_t k = 0; k < point.probes.size(); ++k)
        for (Index j = 0; j < 3; ++j)
          moved.mutable_at(i, static_cast<py::ssize_t>(k), j) = point.probes[k](j);
      if (point.is_fold) folds.append(i);
    }
    py::dict one;
    one["rates"] = rates;
    one["displacements"] = displacements;
    one["probes"] = moved;
    one["growth"] = growth;
    one["unstable"] = unstable;
    one["folds"] = folds;
    one["ends"] = path.ends;
    paths.append(one);
  }
  py::dict all;
  all["model"] = study->model;
  all["paths"] = paths;
  all["searched"] = study->searched;
  all["notes"] = study->notes;
  return py::make_tuple(all, raised);
}

// Values, rows, columns and shape, as scipy.sparse.coo_array takes them.
py::tuple sparse_of(const Eigen::SparseMatrix<double>& matrix) {
  const auto n = static_cast<py::ssize_t>(matrix.nonZeros());
  py::array_t<double> values(n);
  py::array_t<long> rows(n), columns(n);
  py::ssize_t at = 0;
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it, ++at) {
      values.mutable_at(at) = it.value();
      rows.mutable_at(at) = static_cast<long>(it.row());
      columns.mutable_at(at) = static_cast<long>(it.col());
    }
  return py::make_tuple(py::make_tuple(values, py::make_tuple(rows, columns)),
                        py::make_tuple(matrix.rows(), matrix.cols()));
}

py::list ports_of(const std::vector<Port>& ports) {
  py::list all;
  for (const Port& port : ports) all.append(py::make_tuple(port.name, port.unit));
  return all;
}

}  // namespace

py::dict dict_of(const Linearization& linear) {
  py::dict all;
  all["inputs"] = ports_of(linear.ports.inputs);
  all["outputs"] = ports_of(linear.ports.outputs);
  all["y"] = py::array_t<double>(linear.outputs.size(), linear.outputs.data());
  if (linear.reduced) {
    all["states"] = ports_of(linear.states);
    all["E"] = array_of(linear.reduced->E);
    all["A"] = array_of(linear.reduced->A);
    all["B"] = array_of(linear.reduced->G);
    all["C"] = array_of(linear.C);
    all["D"] = array_of(linear.D);
    all["N"] = array_of(linear.reduced->N);
  }
  py::dict motion;
  motion["M"] = sparse_of(linear.motion.M);
  motion["C"] = sparse_of(linear.motion.C);
  motion["K"] = sparse_of(linear.motion.K);
  motion["G"] = sparse_of(linear.motion.B);
  motion["F"] = array_of(linear.motion.F);
  all["motion"] = motion;
  all["notes"] = linear.notes;
  return all;
}

void bind_studies(py::module_& module) {
  module.def("accuracy", &accuracy, py::arg("model"), py::arg("quantities"), py::arg("vary"),
             py::arg("reference"), py::arg("budget"), py::arg("refinements"));
  module.def("effects", &effects, py::arg("model"), py::arg("quantities"), py::arg("tolerance"),
             py::arg("budget"));
  module.def("linearize", &linear, py::arg("model"), py::arg("at"), py::arg("rate"),
             py::arg("axis"), py::arg("through"), py::arg("at_rest"), py::arg("without"));
  module.def("modes", &modes, py::arg("model"), py::arg("count"), py::arg("near"), py::arg("rate"),
             py::arg("at"), py::arg("axis"), py::arg("through"), py::arg("at_rest"),
             py::arg("without"), py::arg("mac"), py::arg("compare"));
  module.def("campbell", &campbell, py::arg("model"), py::arg("first"), py::arg("last"),
             py::arg("points"), py::arg("count"), py::arg("axis"), py::arg("through"),
             py::arg("at_rest"), py::arg("without"), py::arg("driven"));
  module.def("rotations", &rotations, py::arg("model"), py::arg("first"), py::arg("last"),
             py::arg("axis"), py::arg("through"), py::arg("at_rest"), py::arg("without"),
             py::arg("probes"), py::arg("search"));
}

}  // namespace mbd::python
