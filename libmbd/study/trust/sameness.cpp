#include "libmbd/study/trust/sameness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "solvers/linear/block_columns.hpp"

namespace mbd {
namespace {

constexpr double noise_safety = 10.0;      // on what was measured, and on tolerances
constexpr double comparable_bound = 1e-3;  // bounds above say nothing
constexpr double relative_perturbation = 1e-12;
constexpr std::uint64_t perturbation_seed = 20240607, perturbations = 3;
constexpr std::size_t most_places = 20;
constexpr double pose_unit =
    8.0 * std::numeric_limits<double>::epsilon();  // to which poses are known, of their size
constexpr double zero_beside = 1e-6;  // of others of its unit: what is smaller is measured by those

// The same run with another tolerance: a tenth where that is a choice, a hundred times where it is near round-off.
Scene with_other_tolerance(const Scene& scene) {
  Scene s = scene;
  if (s.statics) s.statics->tolerance *= 100.0;
  if (s.path) s.path->tolerance *= 100.0;
  if (s.transient) {
    TransientScene& t = *s.transient;
    constexpr double tighter = 0.1;
    if (t.tolerance) {
      t.tolerance = std::max(1e-13, tighter * *t.tolerance);
      for (std::optional<double>* const limit :
           {&t.position_tolerance, &t.rotation_tolerance, &t.velocity_tolerance,
            &t.angular_velocity_tolerance})
        if (*limit) **limit *= tighter;
    } else {
      t.newton_tolerance = tighter * newton_options(t).tolerance;
    }
  }
  return s;
}

// [kg], what moves with the nodes in straight motion; added mass with it.
double mass_of(const Model& model) {
  State state = model.initial;
  for (std::size_t n = 0; n < state.V.size(); ++n) {
    state.V[n].setZero();
    state.V[n].head<3>() = state.pose[n].R().transpose() * Vec3::UnitX();
  }
  std::vector<Vec6> momenta(state.pose.size(), Vec6::Zero());
  model.system->momenta(state, momenta);
  double mass = 0.0;
  for (std::size_t n = 1; n < momenta.size(); ++n)
    mass += (state.pose[n].R() * momenta[n].head<3>())(0);
  return mass;
}

// What a quantity of this unit would be in a scene of this size, mass and energy, and beside what else is recorded: one that is zero in
// truth is round-off, however it is measured by itself. 0: of this unit nothing is known.
class NaturalSizes {
 public:
  NaturalSizes(const Findings& findings, double length, double mass, double duration) : L_(length) {
    const auto of = [&](std::string_view unit) {
      double most = 0.0;
      for (std::size_t c = 0; c < findings.units.size(); ++c)
        if (findings.units[c] == unit)
          for (const auto& row : findings.rows) most = std::max(most, std::abs(row[c]));
      return most;
    };
    const double E = findings.energy;
    v_ = std::max({of("m/s"), L_ * of("rad/s"), mass > 0.0 ? std::sqrt(2.0 * E / mass) : 0.0});
    const double between_rows =
        duration / static_cast<double>(std::max<std::size_t>(findings.at.size(), 2));
    a_ = std::max({of("m/s2"), L_ * of("rad/s2"), v_ * v_ / L_,
                   between_rows > 0.0 ? v_ / between_rows : 0.0});
    F_ = std::max({of("N"), of("N.m") / L_, mass * a_, E / L_});
    p_ = std::max({of("N.s"), of("N.m.s") / L_, mass * v_});
  }

  double of(std::string_view unit) const {
    if (unit == "m/s") return v_;
    if (unit == "rad/s") return v_ / L_;
    if (unit == "m/s2") return a_;
    if (unit == "rad/s2") return a_ / L_;
    if (unit == "N") return F_;
    if (unit == "N.m") return F_ * L_;
    if (unit == "N.s") return p_;
    if (unit == "N.m.s") return p_ * L_;
    if (unit == "W") return F_ * v_;
    return 0.0;
  }

 private:
  double L_, v_ = 0.0, a_ = 0.0, F_ = 0.0, p_ = 0.0;
};

bool is_under_multipliers(std::string_view unit) {
  return unit == "N" || unit == "N.m" || unit == "m/s2" || unit == "J" || unit == "W";
}

}  // namespace

Scene with_probes(const Scene& scene) {
  Scene s = scene;
  s.expects.clear();
  s.plots.clear();
  const bool moves = scene.transient.has_value();
  RecordScene all{{}, "certify", {}, {}, {"strain_energy", "potential_energy", "total_energy"}};
  if (moves)
    all.quantities.insert(all.quantities.end(),
                          {"kinetic_energy", "work_of_loads", "work_of_drives", "work_of_damping",
                           "linear_momentum", "angular_momentum"});
  s.records.push_back(all);
  std::size_t count = 0;
  const auto add = [&](const Place& place) {
    if (count >= most_places) return;
    RecordScene record{{}, fmt::format("certify{}", count++), place, {}, {"position", "rotation"}};
    if (moves)
      record.quantities.insert(record.quantities.end(), {"velocity", "angular_velocity_local"});
    s.records.push_back(record);
  };
  for (const BeamScene& beam : scene.beams)
    for (const double end : {1.0, 0.0}) add({Place::Kind::beam, beam.name, end});
  for (const BodyScene& body : scene.bodies) add({Place::Kind::body, body.name, 0.0});
  return s;
}

double shortest_lever(const Scene& scene) {
  const Model model = compile(scene);
  const System& system = *model.system;
  const double length = system.length_scale();
  double shortest = length;
  constexpr std::size_t most_compared = 300;
  std::vector<Vec3> points;
  for (Index n = 1; n < system.nodes(); ++n) points.push_back(system.reference_pose(n).r);
  for (const JointScene& j : scene.joints) {
    for (const std::optional<Vec3>& at : {j.at, j.at_a, j.at_b})
      if (at) points.push_back(*at);
    if (j.kind == "screw" && j.parameter)
      shortest = std::min(shortest, std::abs(*j.parameter) / (2.0 * std::numbers::pi));
  }
  if (points.size() > most_compared) points.resize(most_compared);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (const double d = (points[i] - points[k]).norm(); d > 1e-9 * length)
        shortest = std::min(shortest, d);
  return shortest;
}

Scene shortened(const Scene& scene, double duration) {
  Scene s = scene;
  if (!s.transient || !(duration < s.transient->duration)) return s;
  TransientScene& t = *s.transient;
  if (t.step) {
    const double steps = std::max(1.0, std::round(duration / *t.step));
    t.duration = steps * *t.step;
  } else {
    t.duration = duration;
  }
  return s;
}

Twins::Twins(const Scene& scene, const TrialOptions& options) : scene_(with_probes(scene)) {
  TrialOptions once = options;
  once.repeats = 1;
  base_ = run_trial(scene_, once);
  cpu_ = base_.cpu;
  if (!base_.complete) {
    failure_ = base_.failure;
    return;
  }
  const Model model = compile(scene_);
  length_ = model.system->length_scale();
  const Findings& a = base_.findings;
  const double mass = mass_of(model);
  set_round_off(model, mass);
  const NaturalSizes natural(a, length_, mass, scene_.transient ? scene_.transient->duration : 0.0);
  add_components(quantities_, a, {}, "the run");
  for (const Components& q : quantities_) {
    const Scale scale = scale_of(q, a, a.at.size(), zero_beside, Measure::value);
    double size = scale.value;
    own_scales_.push_back(size);
    if (const double usual = natural.of(q.unit);
        usual > 0.0 && (scale.is_zero || size <= zero_beside * usual))
      size = usual;
    // Of a total energy that is conserved, the number is arbitrary and its changes are errors.
    scales_.push_back(q.unit == "J" ? std::max(size, a.energy) : size);
  }
  noise_.assign(quantities_.size(), std::vector<double>(a.at.size(), 0.0));
  growth_ = noise_;
  if (!run_twins(once)) return;
  for (std::size_t q = 0; q < noise_.size(); ++q)
    for (std::size_t k = 0; k < noise_[q].size(); ++k) {
      noise_[q][k] += growth_[q][k];
      growth_[q][k] /= relative_perturbation;
    }
  for (std::vector<double>& growth : growth_)
    for (std::size_t k = 1; k < growth.size(); ++k) growth[k] = std::max(growth[k], growth[k - 1]);
  for (std::vector<double>& noise : noise_)
    for (std::size_t k = 1; k < noise.size(); ++k) noise[k] = std::max(noise[k], noise[k - 1]);
}

// Measures what another tolerance and other numbers change; false where one of the runs does not end: failure_ says why.
bool Twins::run_twins(const TrialOptions& once) {
  const Findings& a = base_.findings;
  for (std::uint64_t twin = 0; twin <= perturbations; ++twin) {
    const bool tolerance = twin == 0;
    const Trial run =
        run_trial(tolerance ? with_other_tolerance(scene_)
                            : perturbed(scene_, relative_perturbation, perturbation_seed + twin),
                  once);
    cpu_ += run.cpu;
    if (!run.complete) {
      failure_ = fmt::format(
          "{}: {}",
          tolerance ? "with another tolerance" : "with numbers changed in the twelfth digit",
          run.failure);
      return false;
    }
    // A twin that finds other special points says that they are not well determined.
    const bool fits = run.findings.at.size() == a.at.size();
    for (std::size_t q = 0; q < quantities_.size(); ++q)
      for (std::size_t k = 0; k < a.at.size(); ++k) {
        const double d =
            fits ? distance(quantities_[q], a, k, run.findings, k) / scales_[q] : comparable_bound;
        double& to = tolerance ? noise_[q][k] : growth_[q][k];
        to = std::max(to, d);
      }
  }
  return true;
}

void Twins::set_round_off(const Model& model, double mass) {
  const double stiffness =
      largest_stiffness(*model.system, model.initial, {.U = 1.0, .V = 0.0, .A = 0.0, .T_inv = {}});
  force_unit_ = pose_unit * length_ * stiffness;
  if (mass > 0.0) acceleration_unit_ = force_unit_ * static_cast<double>(base_.nodes) / mass;
}

double Twins::floor_of(const Components& quantity, double scale) const {
  if (scene_.path) return 1e-6;  // of special points: they are located to that (path.cpp)
  if (!scene_.transient) return 1e3 * scene_.statics->tolerance;
  const TransientScene& t = *scene_.transient;
  if (t.tolerance) return noise_safety * *t.tolerance;
  const NewtonOptions newton = newton_options(t);
  if (is_under_multipliers(quantity.unit)) {
    const double unit = quantity.unit == "N"      ? force_unit_
                        : quantity.unit == "m/s2" ? acceleration_unit_
                                                  : 0.0;
    return noise_safety * (newton.multiplier_tolerance + unit / scale);
  }
  // Each step leaves a tolerance, as in a random walk.
  const double walk =
      std::max(noise_safety, std::sqrt(static_cast<double>(base_.counters.substeps)));
  // An increment of motion is one of velocity over about half a step.
  const std::string& u = quantity.unit;
  double of_rates = 0.0;
  if (u == "rad/s") of_rates = 2.0 / *t.step / scale;
  if (u == "m/s") of_rates = 2.0 * length_ / *t.step / scale;
  if (u == "N.s" || u == "N.m.s")  // mass times velocity
    for (std::size_t q = 0; q < quantities_.size(); ++q)
      if (quantities_[q].unit == "m/s") {
        const double one = 2.0 * length_ / *t.step / own_scales_[q];
        of_rates = of_rates > 0.0 ? std::min(of_rates, one) : one;
      }
  // And round-off of poses, which are known to that of their own size, however little they change: 1 rad, the scene's length.
  const double size = u == "rad" ? 1.0 : u == "m" ? length_ : 0.0;
  return newton.tolerance * std::max(walk, of_rates) + pose_unit * walk * size / scale;
}

std::optional<double> Twins::far_noise(const Components& quantity, double scale, std::size_t place,
                                       const FarNoise& far) const {
  const double unit = pose_unit * far.distance;  // the floor of Newton's iterations [m]
  const std::string& u = quantity.unit;
  if (is_under_multipliers(u) || u == "N.s" || u == "N.m.s") return std::nullopt;
  const double length = u.starts_with("rad") ? far.lever : far.lever / far.length;
  if (!scene_.transient) {
    // Of curvatures, unit/spacing^2 along the whole length.
    const double nodes = static_cast<double>(std::max<Index>(base_.nodes, 2));
    return unit * nodes * nodes / length / scale;
  }
  // Each step leaves an error of motion, and of velocity that over h, as in a random walk.
  const double steps = static_cast<double>(std::max(1L, base_.counters.substeps));
  const double h = scene_.transient->step.value_or(scene_.transient->duration / steps);
  const double n = base_.findings.at[place] / h;
  if (u == "m" || u == "rad") return unit * (1.0 + n * std::sqrt(n)) / length / scale;
  return unit / h * std::sqrt(1.0 + n) / length / scale;
}

Sameness Twins::compare(const Findings& other, const FarNoise& far) const {
  return compare(other, far, std::nullopt);
}

Sameness Twins::compare_finer(const Findings& other, double bound) const {
  return compare(other, {}, bound);
}

Sameness Twins::compare(const Findings& other, const FarNoise& far,
                        std::optional<double> fixed) const {
  Sameness result;
  const Findings& a = base_.findings;
  const std::size_t places = std::min(a.at.size(), other.at.size());
  if (other.at.size() != a.at.size())
    result.what = fmt::format("{} places in place of {}", other.at.size(), a.at.size());
  std::vector<Components> theirs;
  add_components(theirs, other, {}, "the run");
  std::size_t until = places;
  double worst = -1.0;
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const Components& mine = quantities_[q];
    const auto found = std::find_if(theirs.begin(), theirs.end(),
                                    [&](const Components& c) { return c.name == mine.name; });
    if (found == theirs.end() || (fixed && mine.unit != "m" && mine.unit != "rad")) continue;
    const double floor = floor_of(mine, scales_[q]);
    for (std::size_t k = 0; k < places; ++k) {
      double bound = noise_safety * noise_[q][k] + floor;
      if (far.distance > 0.0) {
        const std::optional<double> noise = far_noise(mine, scales_[q], k, far);
        if (!noise) break;
        bound += *noise + noise_safety * pose_unit * far.distance / far.lever * growth_[q][k];
      }
      if (!(bound <= std::max(comparable_bound, 2.0 * floor))) {
        until = std::min(until, k);
        break;
      }
      if (fixed) bound = *fixed;
      Findings reordered;  // their columns in my order
      reordered.rows = {a.rows[k]};
      for (std::size_t i = 0; i < mine.columns.size(); ++i)
        reordered.rows[0][mine.columns[i]] = other.rows[k][found->columns[i]];
      reordered.branch = {k < other.branch.size() ? other.branch[k] : 0};
      const double difference = distance(mine, a, k, reordered, 0) / scales_[q];
      result.comparable = true;
      const double ratio =
          std::isfinite(difference) ? difference / bound : std::numeric_limits<double>::infinity();
      if (ratio > worst) {
        worst = ratio;
        result.difference = difference;
        result.bound = bound;
        result.quantity = mine.name;
        result.at = a.at[k];
      }
    }
  }
  result.whole = until >= places && places == a.at.size();
  result.until = until > 0 && !a.at.empty() ? a.at[std::min(until, a.at.size()) - 1] : 0.0;
  return result;
}

}  // namespace mbd
