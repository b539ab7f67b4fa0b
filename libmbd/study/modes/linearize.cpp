#include "libmbd/study/modes/linearize.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libmbd/study/modes/states_of_run.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/tables.hpp"
#include "solvers/modes/eigenmodes.hpp"
#include "solvers/modes/linearizable.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

// Small motions along which outputs are looked at: of all motions u, u', u'', and multipliers.
struct Along {
  VecX u, rate, acceleration, multipliers;
  VecX inputs;
};

class Outputs {
 public:
  Outputs(const Model& model, const Linearization& linear)
      : model_(model), linear_(linear), size_(linear.outputs.size()) {}

  // dy along a small motion.
  VecX change(const Along& along) const {
    const double L = model_.system->length_scale();
    double size = 0.0;  // of the motion, in lengths of the scene, radians, and these over a second
    for (const VecX* x : {&along.u, &along.rate})
      for (Index i = 0; i < x->size(); ++i)
        size = std::max(size, std::abs((*x)(i)) / (i % 6 < 3 ? L : 1.0));
    constexpr double part = 1e-5;
    const double step = size > 0.0 ? part / size : 1.0;  // of inputs alone all outputs are linear
    return (at(along, step) - at(along, -step)) / (2.0 * step);
  }

 private:
  VecX at(const Along& along, double step) const {
    const System& system = *model_.system;
    State state = linear_.state;
    for (std::size_t n = 1; n < state.pose.size(); ++n) {
      const Index i = 6 * static_cast<Index>(n - 1);
      const Vec6 u = step * along.u.segment<6>(i), rate = step * along.rate.segment<6>(i),
                 acceleration = step * along.acceleration.segment<6>(i);
      const Mat6 V_hat = twist_hat<double>(linear_.state.V[n]);
      state.pose[n] = state.pose[n] * exp_se3<double>(u);
      state.V[n] += rate + V_hat * u;
      state.Vdot[n] += acceleration + V_hat * rate;
    }
    state.lambda += step * along.multipliers;
    for (std::size_t i = 0; i < state.inputs.size(); ++i)
      state.inputs[i].f += step * along.inputs(static_cast<Index>(i));
    system.set_time(state, state.t);
    VecX y(size_);
    outputs(model_, state, {y.data(), static_cast<std::size_t>(size_)});
    return y;
  }

  const Model& model_;
  const Linearization& linear_;
  Index size_;
};

// C and D of a linearization whose motion on the constraints is there.
void add_outputs(const Model& model, Linearization& linear) {
  const ReducedMotion& r = *linear.reduced;
  const LinearMotion& all = linear.motion;
  const Index m = r.N.cols(), n = all.M.rows(), inputs = all.F.cols();
  const Index outputs = linear.outputs.size();
  linear.C.resize(outputs, 2 * m);
  linear.D.resize(outputs, inputs);
  if (outputs == 0) return;
  const Eigen::PartialPivLU<MatX> mass(r.E.bottomRightCorner(m, m));

  // Multipliers from what is left of (1), of the rows that are not idle.
  std::vector<Index> rows;
  const std::vector<Index>& idle = linear.state.idle;
  for (Index i = 0; i < all.B.rows(); ++i)
    if (!std::binary_search(idle.begin(), idle.end(), i)) rows.push_back(i);
  MatX Bt(n, static_cast<Index>(rows.size()));
  const MatX B = all.B;
  for (std::size_t i = 0; i < rows.size(); ++i)
    Bt.col(static_cast<Index>(i)) = B.row(rows[i]).transpose();
  const Eigen::CompleteOrthogonalDecomposition<MatX> gradient(Bt);

  const Outputs of(model, linear);
  const auto along = [&](const VecX& q, const VecX& qdot, const VecX& w) {
    const VecX forces =
        r.A.bottomLeftCorner(m, m) * q + r.A.bottomRightCorner(m, m) * qdot + r.G.bottomRows(m) * w;
    Along a{r.N * q, r.N * qdot, r.N * VecX(mass.solve(forces)), VecX::Zero(all.B.rows()), w};
    if (!rows.empty()) {
      const VecX left = all.F * w - all.M * a.acceleration - all.C * a.rate - all.K * a.u;
      const VecX found = gradient.solve(left);
      for (std::size_t i = 0; i < rows.size(); ++i)
        a.multipliers(rows[i]) = found(static_cast<Index>(i));
    }
    return of.change(a);
  };
  const VecX none = VecX::Zero(m), no_input = VecX::Zero(inputs);
  for (Index j = 0; j < m; ++j) {
    linear.C.col(j) = along(VecX::Unit(m, j), none, no_input);
    linear.C.col(m + j) = along(none, VecX::Unit(m, j), no_input);
  }
  for (Index j = 0; j < inputs; ++j) linear.D.col(j) = along(none, none, VecX::Unit(inputs, j));
}

Linearization of_motions(const Model& model, const SmallMotions& motions, bool constant) {
  Linearization linear;
  const System& system = *model.system;
  linear.state = motions.state();
  linear.motion = linear_motion(motions);
  linear.ports = ports(model);
  linear.outputs.resize(static_cast<Index>(linear.ports.outputs.size()));
  outputs(model, linear.state,
          {linear.outputs.data(), static_cast<std::size_t>(linear.outputs.size())});
  if (!constant) {
    linear.notes.emplace_back(
        "the state moves, and its constraints with it: there are the equations of all motions, and "
        "no matrices on the constraints");
    return linear;
  }
  linear.reduced = reduced_motion(system, linear.motion);
  for (const bool rate : {false, true})
    for (const Index motion : linear.reduced->coordinates)
      linear.states.push_back({(rate ? "rate of " : "") + name_of_coordinate(system, motion),
                               std::string(motion % 6 < 3 ? "m" : "rad") + (rate ? "/s" : ""),
                               "axes of the node"});
  add_outputs(model, linear);
  return linear;
}

Json rows_of(const MatX& matrix) {
  Json rows = Json::array();
  for (Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json names_of(const std::vector<Port>& all) {
  Json names = Json::array();
  for (const Port& port : all) {
    names.push_back({{"name", port.name}, {"unit", port.unit}});
    if (!port.frame.empty()) names.back()["frame"] = port.frame;
  }
  return names;
}

std::string matrix_market(const Eigen::SparseMatrix<double>& matrix) {
  std::string text = fmt::format("%%MatrixMarket matrix coordinate real general\n{} {} {}\n",
                                 matrix.rows(), matrix.cols(), matrix.nonZeros());
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it)
      text += fmt::format("{} {} {:.17g}\n", it.row() + 1, it.col() + 1, it.value());
  return text;
}

}  // namespace

Linearization linearize(const Scene& scene, const ModesOptions& options) {
  if (options.rotation && options.time)
    throw Error(scene.source,
                "linearize: about a steady rotation, or about a state of a run, not both");
  MotionsOfScene of_scene(scene, options.time);
  if (options.rotation) {
    SteadyRotation rotation = *options.rotation;
    if (!options.at_rest.empty()) rotation.rests = of_scene.nodes_of(options.at_rest);
    of_scene.turn(rotation);
    if (of_scene.axes() == ModeAxes::resting)
      throw Error(scene.source,
                  "linearize: the coefficients are constant in axes that rest only, in which nodes "
                  "turn; name what does not turn, or make it alike in all directions");
  }
  of_scene.require_linear();
  try {
    Linearization linear = of_motions(of_scene.model(), of_scene.motions(), !options.time);
    linear.model = scene.name;
    linear.file = scene.file;
    linear.rotation = options.rotation;
    linear.time = options.time;
    const std::vector<std::string> notes = of_scene.notes_on_state();
    linear.notes.insert(linear.notes.end(), notes.begin(), notes.end());
    return linear;
  } catch (const Error& error) {
    throw Error(scene.source, std::string("linearize: ") + error.what());
  }
}

Linearization linearize(const Model& model, const State& given) {
  const System& system = *model.system;
  check_motion(system, 0.0);
  check_sizes(system, given);
  State state = given;
  if (const std::string failure = make_consistent(system, state); !failure.empty())
    throw Error("linearize: " + failure);
  if (const std::string why = why_not_linear(system, state); !why.empty())
    throw Error("linearize: " + why);
  SmallMotions motions(system);
  const double L = system.length_scale();
  const auto rests = [&](const std::vector<Vec6>& all) {
    constexpr double still = 1e-6;
    return std::all_of(all.begin(), all.end(), [&](const Vec6& v) {
      return v.head<3>().norm() <= still * L && v.tail<3>().norm() <= still;
    });
  };
  const bool equilibrium = rests(state.V) && rests(state.Vdot);
  if (!(equilibrium ? motions.about(state) : motions.frozen_at(state)))
    throw Error("linearize: " + range_failure(system.out_of_range(state)));
  return of_motions(model, motions, equilibrium);
}

void write_linearization(const Linearization& linear, const std::filesystem::path& directory) {
  Json all = Json::object();
  all["model"] = linear.model;
  all["file"] = linear.file;
  if (linear.rotation) all["rate"] = {{"value", linear.rotation->rate}, {"unit", "rad/s"}};
  if (linear.time) all["time"] = {{"value", *linear.time}, {"unit", "s"}};
  all["inputs"] = names_of(linear.ports.inputs);
  for (std::size_t i = 0; i < linear.state.inputs.size(); ++i)
    all["inputs"][i]["value"] = linear.state.inputs[i].at(linear.state.t).v;
  all["outputs"] = names_of(linear.ports.outputs);
  for (std::size_t i = 0; i < linear.ports.outputs.size(); ++i)
    all["outputs"][i]["value"] = linear.outputs(static_cast<Index>(i));
  if (linear.reduced) {
    all["states"] = names_of(linear.states);
    all["E"] = rows_of(linear.reduced->E);
    all["A"] = rows_of(linear.reduced->A);
    all["B"] = rows_of(linear.reduced->G);
    all["C"] = rows_of(linear.C);
    all["D"] = rows_of(linear.D);
  }
  all["notes"] = linear.notes;
  write_file(directory / "linear.json", all.dump() + "\n");
  write_file(directory / "M.mtx", matrix_market(linear.motion.M));
  write_file(directory / "C.mtx", matrix_market(linear.motion.C));
  write_file(directory / "K.mtx", matrix_market(linear.motion.K));
  write_file(directory / "G.mtx", matrix_market(linear.motion.B));
  write_file(directory / "F.mtx", matrix_market(linear.motion.F.sparseView(0.0, 0.0)));
}

std::string to_text(const Linearization& linear) {
  std::string text = fmt::format("{}, linearised about {}\n", linear.model,
                                 linear.rotation ? "a steady rotation"
                                 : linear.time ? fmt::format("its state at {:.9g} s", *linear.time)
                                               : std::string("its equilibrium"));
  text += fmt::format("{} motions of nodes, {} rows of constraints, {} inputs, {} outputs\n",
                      linear.motion.M.rows(), linear.motion.B.rows(), linear.ports.inputs.size(),
                      linear.ports.outputs.size());
  if (linear.reduced) {
    const ReducedMotion& r = *linear.reduced;
    const VecXc poles = eigenvalues_of(Eigen::PartialPivLU<MatX>(r.E).solve(r.A));
    constexpr double round_off = 1e-9;  // of the fastest pole
    const double growth = poles.size() > 0 ? poles.real().maxCoeff() : 0.0,
                 fastest = poles.size() > 0 ? poles.cwiseAbs().maxCoeff() : 0.0;
    text += fmt::format("{} states; {}\n", linear.states.size(),
                        growth > round_off * fastest
                            ? fmt::format("unstable: something grows as exp({:.6g} t)", growth)
                            : std::string("nothing grows (mbd modes has the poles)"));
    std::vector<std::vector<std::string>> table{{"state", "unit"}};
    constexpr std::size_t most = 12;
    for (std::size_t i = 0; i < linear.states.size() / 2 && i < most; ++i)
      table.push_back({linear.states[i].name, linear.states[i].unit});
    if (linear.states.size() / 2 > most)
      table.push_back({fmt::format("and {} more", linear.states.size() / 2 - most), ""});
    table.push_back({"and their rates", ""});
    text += "\n";
    study::table(text, table);
  }
  for (const std::string& note : linear.notes) text += "\nnote: " + note + "\n";
  return text;
}

}  // namespace mbd
