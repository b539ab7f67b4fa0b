#include "libmbd/study/accuracy/choose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/results/load_sampling.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/study/trial/norm.hpp"

namespace mbd {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Parts of the accuracy that each kind of error is made to keep. Together below 1: estimates scatter.
constexpr double part_of_time = 0.4, part_alone = 0.7;
constexpr double loose_tolerance = 1e-4;  // the first of beams
constexpr double aimed = 0.5;             // of a part, when a knob is turned
// Runs longer than that part of the limit are not made to see what strains show to err by so many times the accuracy.
constexpr double dear_look = 1.0 / 20, far_off = 100.0;
constexpr double finest_tolerance = 1e-13, coarsest_tolerance = 1e-3;
constexpr double finest_step = 1.0 / 4096;     // part of the model's own
constexpr double part_of_first_run = 1.0 / 6;  // of the limit: for one run with a tolerance, and
constexpr double dear = 100.0;                 // as much as the model's own run
constexpr double most_at_once = 8.0;           // smaller steps
constexpr double to_believe = 2.5;  // times the cost of a run: of one with a finer mesh too
constexpr int first_order = 3, highest_order = 8;
constexpr int usual_highest = 6;  // of a transient: above, more elements cost less
constexpr int most_elements = 4000;
constexpr double most_per_order = 100.0;  // that is believed
constexpr double slow = 3.0;              // decay below which elements are doubled
constexpr double much_jump = 0.3;         // of the strain
constexpr int most_without_gain = 3;      // refinements in a row
constexpr double hardly_less = 0.1;       // after all of them
constexpr double worth_a_look = 0.05;     // [s] of a run for which what is cheaper is tried
constexpr double enough_cheaper = 0.7;    // for less, nothing is changed
constexpr double zero_by_name = 1e-12;    // of the largest quantity of the unit: round-off

std::vector<Components> vectors_of(const Findings& findings,
                                   const std::vector<std::string>& names) {
  std::vector<Components> vectors;
  add_components(vectors, findings, names, "--for");
  // Of a path, the load is found; how long the way there was depends on the number of nodes.
  if (names.empty())
    std::erase_if(vectors, [](const Components& v) {
      return v.name.find('.') == std::string::npos && v.name != "load_factor";
    });
  return vectors;
}

// The largest of 1, 2 and 5 times a power of ten not above it, to the last bit what a model would write.
double rounded_down(double value) {
  const double power = std::floor(std::log10(value) + 1e-9);
  const double digit = value / std::pow(10.0, power) + 1e-6;
  return std::stod(fmt::format("{}e{}",
                               digit >= 5.0   ? 5
                               : digit >= 2.0 ? 2
                                              : 1,
                               static_cast<int>(power)));
}

// Ends the search; what has been found stays.
struct Enough {
  std::string reason;
  bool lost = false;  // differences do not fall: none of them says how large the error is
  bool late = false;  // the limit is reached
};

class Chooser {
 public:
  Chooser(const Scene& scene, const ChooseOptions& options) : scene_(scene), options_(options) {
    choice_.accuracy = options.accuracy;
    choice_.quantities = options.quantities;
  }

  Choice go() {
    const Model model = compiled();
    length_ = model.system->length_scale();
    Findings empty;
    for (const Column& column : columns(model)) {
      empty.columns.push_back(column.name);
      empty.units.push_back(column.unit);
    }
    // And what is wrong with their names before a run.
    const std::vector<Components> asked = vectors_of(empty, options_.quantities);
    if (moving() && !scene_.transient->errors && seen_by_motion(empty, asked))
      errors_ = ErrorsOf::motion;
    try {
      search();
    } catch (const Enough& enough) {
      choice_.reason = enough.reason;
      lost_ = enough.lost;
      if (enough.late) believe_kept();
    }
    try {  // where the search ended before
      if (choice_.error && *choice_.error <= options_.accuracy) {
        if (flexible() && !loads_seen_) look_at_loads_of(choice_.setting);
        if (!at_stations_) look_at_stations(get(choice_.setting));
      }
    } catch (const Enough& enough) {
      choice_.reason = enough.reason;
    }
    finish();
    return std::move(choice_);
  }

 private:
  struct Known {
    Setting setting;
    Trial trial;
    std::size_t pilot = 0;
  };
  struct Mesh {
    int order = 0, elements = 0;  // 0: no beams
    bool operator==(const Mesh&) const = default;
  };
  struct Kept {
    Mesh mesh;
    double knob = 0.0, rest = 0.0;
  };
  struct Measured {
    double knob = 0.0, error = 0.0;
  };

  // Whether steps need not look at velocities for all that is asked for.
  bool seen_by_motion(const Findings& empty, const std::vector<Components>& asked) const {
    if (scene_.transient->velocity_tolerance || scene_.transient->angular_velocity_tolerance)
      return false;
    for (const Components& vector : asked)
      for (const std::size_t column : vector.columns) {
        const schema::Quantity* const quantity =
            schema::recorded_in(scene_, empty.columns[column]).quantity;
        if (!quantity || !follows_from_motion(*quantity)) return false;
      }
    return !asked.empty();
  }

  // What is wrong with the scene is told as run() tells it, but for elements that are bent too far as they are: the number of
  // them is to be chosen.
  Model compiled() {
    constexpr int most = 64;
    try {
      return compile(scene_);
    } catch (const Error&) {
      if (!flexible()) throw;
      const int own = *setting_of(scene_).elements;
      for (int more = 2; more <= most; more *= 2) {
        Setting finer;
        finer.elements = more * own;
        try {
          Model model = compile(with(scene_, finer));
          least_elements_ = more * own;
          return model;
        } catch (const Error&) {  // the first of them is told
        }
      }
      throw;
    }
  }

  bool flexible() const { return !scene_.beams.empty(); }
  bool moving() const { return scene_.transient.has_value(); }

  Setting setting(const Mesh& mesh, double tolerance) const {
    Setting s;
    if (flexible()) s.order = mesh.order, s.elements = mesh.elements;
    if (!moving()) return s;
    if (fixed_)
      s.step = *scene_.transient->step * tolerance;
    else
      s.method = TimeMethod::radau, s.tolerance = tolerance, s.errors = errors_;
    return s;
  }

  // What time is refined by to see its error: a tenth of a tolerance, half a step.
  double refinement() const { return fixed_ ? 2.0 : 10.0; }
  // Tolerances that read well; steps of which the duration is a whole number.
  double allowed(double knob) const {
    return fixed_ ? 1.0 / std::ceil(1.0 / knob - 1e-6) : rounded_down(knob);
  }
  double better(double knob) const { return allowed(knob / refinement()); }

  // Runs a pilot, of a scene that is made then, and writes it down.
  template <class MakeScene>
  Trial try_out(const Setting& setting, const std::string& text, const MakeScene& scene,
                double limit) {
    if (options_.progress) options_.progress(text);
    Trial trial;
    try {
      trial = run_trial(scene(),
                        {.resolution = flexible(), .audit = false, .limit = limit, .repeats = 1});
    } catch (const Error& error) {
      trial.failure = error.what();
    }
    Pilot pilot;
    pilot.setting = setting;
    pilot.text = text;
    pilot.cpu = trial.cpu;
    pilot.cut_off = trial.stopped;
    pilot.failure = trial.failure;
    choice_.cpu += pilot.cpu;
    choice_.pilots.push_back(std::move(pilot));
    return trial;
  }

  // Made once. Throws Enough where there is no time left.
  const Known& get(const Setting& setting, double limit = infinite) {
    for (const Known& known : known_)
      if (known.setting == setting) return known;
    const double left = options_.limit - choice_.cpu - (choice_.error ? 0.0 : reserve_);
    const std::string out_of_time =
        fmt::format("the limit of {:g} s of CPU time for choosing is reached", options_.limit);
    if (!(left > 0.0)) throw Enough{.reason = out_of_time, .late = true};
    const std::size_t pilot = choice_.pilots.size();
    known_.push_back({setting,
                      try_out(
                          setting, to_text(scene_, setting), [&] { return with(scene_, setting); },
                          std::min(left, limit)),
                      pilot});
    if (known_.back().trial.stopped && limit >= left)
      throw Enough{.reason = out_of_time, .late = true};
    return known_.back();
  }

  // Infinite where one of both did not come to its end.
  Disagreement compare(const Known& run, const Known& better) const {
    if (!run.trial.complete || !better.trial.complete) return {.rms = infinite};
    return disagreement(run.trial.findings, better.trial.findings, options_.accuracy,
                        options_.quantities, length_);
  }

  // Of equilibria: is all that is recorded round-off? Angles, and displacements beside the scene, tell.
  bool is_at_rest(const Findings& findings) const {
    constexpr double round_off = 1e-12;
    bool any = false;
    for (std::size_t c = 0; c < findings.columns.size(); ++c) {
      const std::string& unit = findings.units[c];
      if ((unit != "m" && unit != "rad") || depends_on_origin(findings.columns[c])) continue;
      any = true;
      for (const std::vector<double>& row : findings.rows)
        if (std::abs(row[c]) > round_off * (unit == "m" ? length_ : 1.0)) return false;
    }
    return any;
  }

  // What is believed of a run: its difference to a better one, whose own error is a part `rest` of it.
  double believe(const Known& run, const Known& better, double rest) {
    const Disagreement d = compare(run, better);
    const double error = d.rms * (1.0 + rest);
    if (!std::isfinite(error)) return error;
    // Two runs that agree in nothing happening may both have missed what should.
    if (moving() ? d.rms == 0.0 && !anything_changes(better.trial.findings)
                 : is_at_rest(better.trial.findings))
      throw Enough{
          "nothing that is recorded changes in the whole run: there is no error to be seen", true};
    Pilot& pilot = choice_.pilots[run.pilot];
    pilot.error = error;
    if (!choice_.error || error < *choice_.error || error <= options_.accuracy) {
      choice_.error = error;
      choice_.worst = d.worst;
      choice_.setting = run.setting;
      differs_from_ = d.from;
      as_zero_ = d.as_zero;
    }
    return error;
  }

  // Where the limit was reached before anything was believed: the best run in time against one finer in all.
  void believe_kept() {
    if (choice_.error || !kept_) return;
    reserve_ = 0.0;
    try {
      const Known& run = get(setting(kept_->mesh, kept_->knob));
      believe(run, get(setting(finer(kept_->mesh), better(kept_->knob))), kept_->rest);
    } catch (const Enough&) {  // nothing is believed
    }
  }

  // ---- time -----------------------------------------------------------------------------------

  double power_of(const std::vector<Measured>& measured) const {
    const double usual = fixed_ ? 2.0 : 1.0;
    if (measured.size() < 2) return usual;
    const Measured &a = measured[measured.size() - 2], &b = measured.back();
    if (!std::isfinite(a.error) || !(b.error > 0.0)) return usual;
    return std::clamp(std::log(a.error / b.error) / std::log(a.knob / b.knob), 0.5, 1.2 * usual);
  }

  std::string not_approaching(const std::string& what, const Disagreement& d) const {
    std::string text = fmt::format("{} do not approach each other (they differ by {:.1e} in {}",
                                   what, d.rms, d.worst);
    if (moving() && d.from) text += fmt::format(", from t = {:.4g} s on", *d.from);
    return text + (moving() ? "): the motion is chaotic, rings faster than these runs resolve, or "
                              "loads change within less than an element"
                            : "): something changes within less than an element, or round-off is "
                              "all there is");
  }

  // Makes the tolerance as small as the part of the error that is time's needs on this mesh.
  void settle_time(const Mesh& mesh, double target) {
    std::vector<Measured> measured;
    for (int without_gain = 0;;) {
      const Known& run = get(setting(mesh, tolerance_));
      const Known& finer_run = get(setting(mesh, better(tolerance_)));
      const Disagreement d = compare(run, finer_run);
      measured.push_back({tolerance_, d.rms});
      const double power = power_of(measured);
      in_time_ = d.rms * (1.0 + rest_of(power));
      if (std::isfinite(d.rms)) {
        choice_.pilots[run.pilot].in_time = in_time_;
        if (!flexible()) believe(run, finer_run, rest_of(power));
      }
      if (in_time_ <= target) return;
      if (measured.size() >= 2) {
        const bool gain = !(d.rms > 0.5 * measured[measured.size() - 2].error);
        if (gain && flexible() && std::isfinite(d.rms)) {
          kept_ = Kept{mesh, tolerance_, std::max(0.2, rest_of(power))};
          reserve_ = std::min(to_believe * finer_run.trial.cpu, 0.4 * options_.limit);
        }
        without_gain = gain || !std::isfinite(d.rms) ? 0 : without_gain + 1;
      }
      const double finest = fixed_ ? finest_step : 10.0 * finest_tolerance;
      const bool at_end = !(tolerance_ > finest);
      // Of chaos one pair in a few may differ less by luck.
      if (without_gain >= most_without_gain ||
          (at_end && d.rms > hardly_less * measured.front().error))
        throw Enough{not_approaching("runs with ever smaller tolerances", d), true};
      if (at_end)
        throw Enough{
            fmt::format("{} below {:g} are not tried{}{}",
                        fixed_ ? "parts of the model's step" : "tolerances", tolerance_,
                        finer_run.trial.failure.empty() ? "" : ": ", finer_run.trial.failure),
            true};
      double next = tolerance_ / refinement();
      if (without_gain > 0) {
        next = tolerance_ /
               (refinement() * refinement());  // past the plateau, if there is an end of it
      } else if (std::isfinite(d.rms)) {
        next = tolerance_ * std::pow(aimed * target / in_time_, 1.0 / power);
        next =
            std::clamp(next, tolerance_ * (fixed_ ? 1.0 / most_at_once : 1e-4), tolerance_ * 0.5);
        // A run that exists already is worth more than one a little cheaper.
        if (next > tolerance_ / refinement() && next < 2.5 * tolerance_ / refinement())
          next = tolerance_ / refinement();
      }
      tolerance_ = allowed(std::max(next, finest));
    }
  }

  // Of the difference to the refined run, by the measured power.
  double rest_of(double power) const { return 1.0 / (std::pow(refinement(), power) - 1.0); }

  // Undamped axial waves of stiff beams take tolerances millions of steps, where the model's own steps damp them or
  // pass over them: if the first run with a tolerance is far dearer than the model's own, fractions of its step are
  // taken for what they can reach.
  void choose_steps(const Mesh& mesh) {
    if (!scene_.transient->step || scene_.transient->method == TimeMethod::radau) return;
    Setting own;
    own.order = mesh.order;
    own.elements = mesh.elements;
    const double cost = get(own).trial.cpu;
    const double most = std::max(1.0, std::min(options_.limit * part_of_first_run, dear * cost));
    if (!get(setting(mesh, tolerance_), most).trial.stopped) return;
    fixed_ = true;
    tolerance_ = 1.0;
    choice_.notes.push_back(
        "steps that follow a tolerance resolve waves for which there is no time: steps are fixed");
  }

  // ---- space ----------------------------------------------------------------------------------

  Mesh first_mesh() const {
    const int own = *setting_of(scene_).elements;
    return {first_order, std::max(least_elements_, moving() ? own : (own + 1) / 2)};
  }

  // Of each beam that has elements of its own, the largest of them, a part of the beam: places divide beams too.
  std::vector<double> largest_parts(const Mesh& mesh) const {
    const Scene scene = with(scene_, setting(mesh, tolerance_));
    const ElementEnds ends(scene);
    const auto is_one = [&](const std::string& name) {
      return std::ranges::any_of(scene.rigids, [&](const RigidScene& rigid) {
        return std::ranges::find(rigid.of, name) != rigid.of.end();
      });
    };
    std::vector<double> parts;
    for (const BeamScene& beam : scene.beams) {
      if (is_one(beam.name)) continue;
      const std::vector<double> of = ends.of(beam, beam.elements);
      double most = 0.0;
      for (std::size_t i = 0; i + 1 < of.size(); ++i) most = std::max(most, of[i + 1] - of[i]);
      parts.push_back(most);
    }
    return parts;
  }

  // The mesh with twice the elements, or as many more as change it: where places divide beams into more than that, twice as many is
  // the same mesh. `all`: of every beam, and by nearly a half.
  Mesh divided(Mesh mesh, bool all) const {
    constexpr double same = 1.0 - 1e-9, nearly_half = 0.6;
    const std::vector<double> before = largest_parts(mesh);
    while (mesh.elements <= most_elements) {
      mesh.elements *= 2;
      const std::vector<double> now = largest_parts(mesh);
      const auto is_divided = [&](std::size_t i) {
        return now[i] < (all ? nearly_half : same) * before[i];
      };
      std::size_t count = 0;
      for (std::size_t i = 0; i < now.size(); ++i) count += is_divided(i) ? 1U : 0U;
      if (count == now.size() || (!all && count > 0)) break;
    }
    return mesh;
  }

  Mesh finer(const Mesh& mesh) const {
    Mesh better = mesh;
    // By symmetry one order more may change nothing of a single element.
    const int more = mesh.elements == 1 ? 2 : 1;
    if (mesh.order + more > highest_order) return divided(mesh, true);
    better.order += more;
    return better;
  }

  // By what factor one order more lessens the error, before that is measured; less than `slow`: it is elements
  // that are wanted.
  static double expected_rate(const Trial& trial) {
    double rate = 1000.0;
    for (const BeamResolution& beam : trial.beams) {
      if (beam.last() < 1e-9) continue;  // this one is resolved
      rate = std::min(rate, std::pow(beam.decay(), 1.5));
      if (beam.jump > much_jump * beam.strain && beam.decay() < slow * slow) rate = 1.0;
    }
    return rate;
  }

  // The next mesh, for an error `factor` times smaller.
  Mesh refined(const Mesh& mesh, double factor, const Trial& trial, std::optional<double> rate) {
    const int highest = moving() ? usual_highest : highest_order;
    const double per_order = std::min(rate.value_or(expected_rate(trial)), most_per_order);
    Mesh next = mesh;
    if (per_order >= slow && mesh.order < highest) {
      const int more = static_cast<int>(std::ceil(std::log(factor) / std::log(per_order) - 0.1));
      next.order = std::min(highest, mesh.order + std::clamp(more, 1, rate ? 4 : 2));
      return next;
    }
    // A field that is not smooth gains about two orders a doubling, of a smooth one all are felt.
    const double per_doubling =
        per_order >= slow ? std::pow(2.0, mesh.order) : std::min(4.0, std::pow(2.0, mesh.order));
    const double doublings =
        std::clamp(std::ceil(std::log(factor) / std::log(per_doubling) - 0.1), 1.0, 2.0);
    next = divided(mesh, false);
    if (doublings > 1.0) next = divided(next, false);
    // Where neither alone helps much, both do.
    if (mesh.order < highest) ++next.order;
    return next;
  }

  void search() {
    const double accuracy = options_.accuracy;
    tolerance_ = rounded_down(std::min(accuracy, coarsest_tolerance));
    if (flexible()) {
      settle_mesh();
    } else if (moving()) {
      settle_time({}, part_alone * accuracy);
      try_cheaper({});
    } else {
      const Known& run = get({});
      if (!run.trial.complete) throw Enough{run.trial.failure};
      choice_.error = scene_.statics ? scene_.statics->tolerance : scene_.path->tolerance;
      choice_.notes.push_back(
          "rigid parts at rest: nothing is approximated but by the tolerance of iterations");
    }
  }

  // Refines the mesh until the error is small enough.
  void settle_mesh() {
    const double accuracy = options_.accuracy;
    Mesh mesh = first_mesh();
    const int own = *setting_of(scene_).elements;
    std::vector<std::pair<Mesh, double>> measured;
    // Where waves ring, a smaller tolerance than is needed costs far more than the runs that tell it is not.
    if (moving()) {
      tolerance_ = std::max(tolerance_, loose_tolerance);
      choose_steps(mesh);
      bend_enough(mesh, own);
      if (fixed_ || !is_of_mesh(mesh, measured)) settle_time(mesh, part_of_time * accuracy);
    }
    for (int without_gain = 0;;) {
      bend_enough(mesh, own);
      const Known& run = get(setting(mesh, tolerance_));
      if (!run.trial.complete) throw Enough{"no run came to its end: " + run.trial.failure};
      const Mesh better_mesh = finer(mesh);
      const Known& finer_run =
          get(setting(better_mesh, moving() ? better(tolerance_) : tolerance_));
      const Disagreement d = compare(run, finer_run);
      const std::optional<double> rate = rate_of_orders(measured, mesh, d.rms);
      // Of the finer mesh at least what is usual of half an order; a tenth is of the tolerance.
      const double rest =
          std::max(rate ? 1.0 / (std::max(*rate, 2.0) - 1.0) : 0.2, fixed_ ? rest_of(2.0) : 0.0);
      const double error = believe(run, finer_run, std::clamp(rest, 0.1, 1.0));
      if (error <= 0.9 * accuracy) {
        if (const Mesh sees = look_at_loads(mesh, run); sees != mesh) {
          measured.clear();
          mesh = sees;
          continue;
        }
        look_at_stations(run);
        try_cheaper(mesh);
        return;
      }
      if (std::isfinite(d.rms)) {
        choice_.pilots[run.pilot].in_space = std::max(0.0, error - in_time_);
        if (is_of_time(mesh, run, error, !measured.empty() || time_is_guessed_)) continue;
      }
      if (!measured.empty() && std::isfinite(d.rms) && std::isfinite(measured.back().second)) {
        without_gain = d.rms > 0.5 * measured.back().second ? without_gain + 1 : 0;
        if (without_gain >= most_without_gain)
          throw Enough{not_approaching("runs with ever finer meshes", d), true};
      }
      measured.push_back({mesh, d.rms});
      const double factor = std::isfinite(error) ? std::max(1.5, error / (aimed * accuracy)) : 10.0;
      const Mesh next = refined(mesh, factor, run.trial, rate);
      if (next.elements > most_elements)
        throw Enough{fmt::format("more than {} elements", most_elements)};
      mesh = next;
    }
  }

  // A mesh too coarse to be bent so far gets more elements; smaller tolerances do not help it.
  void bend_enough(Mesh& mesh, int own) {
    for (Mesh more = mesh;; more.elements *= 2) {
      const bool complete = get(setting(more, tolerance_)).trial.complete;
      if (complete) mesh = more;
      if (complete || more.elements >= 4 * own) return;
    }
  }

  // Does the first mesh err by more than the loosest tolerance does? Then no time is spent on how that has to fall there: the
  // next mesh is tried with the tolerance that the difference of two runs lets expect, and time is settled where it matters.
  bool is_of_mesh(Mesh& mesh, std::vector<std::pair<Mesh, double>>& measured) {
    const double target = part_of_time * options_.accuracy, finer_tolerance = better(tolerance_);
    const Known& run = get(setting(mesh, finer_tolerance));
    const double in_time = compare(get(setting(mesh, tolerance_)), run).rms * (1.0 + rest_of(1.0));
    if (!std::isfinite(in_time) || in_time <= target) return false;
    double in_space = 0.0;
    for (const BeamResolution& beam : run.trial.beams) in_space = std::max(in_space, beam.last());
    // What strains lack says enough where it is much and a run that says more is dear.
    if (run.trial.cpu < dear_look * options_.limit ||
        in_space < std::max(in_time, far_off * options_.accuracy)) {
      const Known& finer_run = get(setting(finer(mesh), finer_tolerance));
      in_space = compare(run, finer_run).rms;
      if (!std::isfinite(in_space) || in_space < std::max(in_time, options_.accuracy)) return false;
      believe(run, finer_run, 0.2 + in_time / in_space);
      measured.push_back({mesh, in_space});
    }
    const double next = std::max(tolerance_ * aimed * target / in_time, 10.0 * finest_tolerance);
    tolerance_ = allowed(std::clamp(next, 1e-4 * tolerance_, 0.5 * tolerance_));
    in_time_ = target;
    time_is_guessed_ = true;
    mesh = cheapest(mesh, in_space / (aimed * options_.accuracy), run.trial);
    return true;
  }

  // The next mesh where nothing is measured yet. What is very smooth takes fewer nodes by higher orders on elements twice as
  // long: the error of order N is then 2^(N + 1) times as large.
  Mesh cheapest(const Mesh& mesh, double factor, const Trial& trial) {
    const Mesh same = refined(mesh, factor, trial, std::nullopt);
    const double per_order = std::min(expected_rate(trial), most_per_order);
    if (mesh.elements % 2 != 0) return same;
    for (int order = mesh.order + 1; order <= usual_highest; ++order)
      if (std::pow(per_order, order - mesh.order) >= factor * std::pow(2.0, order + 1) &&
          order * mesh.elements / 2 < same.order * same.elements)
        return {order, mesh.elements / 2};
    return same;
  }

  // By what factor one order more has lessened the difference to the finer mesh.
  static std::optional<double> rate_of_orders(const std::vector<std::pair<Mesh, double>>& measured,
                                              const Mesh& mesh, double rms) {
    if (measured.empty()) return std::nullopt;
    const auto& [before, error] = measured.back();
    const int orders = mesh.order - before.order;
    if (mesh.elements != before.elements || orders <= 0 || !std::isfinite(error) || !(rms > 0.0))
      return std::nullopt;
    return std::clamp(std::pow(error / rms, 1.0 / orders), 1.0, 1000.0);
  }

  // Is it the mesh, or did a finer one make the motion harder to follow? Then time is settled anew. `looks`: by one more run,
  // if need be.
  bool is_of_time(const Mesh& mesh, const Known& run, double error, bool looks) {
    if (!moving()) return false;
    if (error < 4.0 * in_time_) {
      settle_time(mesh, 0.5 * part_of_time * options_.accuracy);
      if (!(get(setting(mesh, tolerance_)).setting == run.setting)) return true;
    }
    if (!looks) return false;
    const Known& apart = get(setting(mesh, better(tolerance_)));
    in_time_ = compare(run, apart).rms * (1.0 + rest_of(fixed_ ? 2.0 : 1.0));
    choice_.pilots[run.pilot].in_time = in_time_;
    if (!(in_time_ > 0.5 * error)) return false;
    settle_time(mesh, part_of_time * options_.accuracy);
    return setting(mesh, tolerance_) != run.setting;
  }

  // ---- what is cheaper ------------------------------------------------------------------------

  // The choice stands, and `verifier` is the finer run that says so. Takes `other` instead if its error, against that
  // run, is small enough and its cost well below that of the choice.
  bool take_if_cheaper(const Setting& other, const Known& verifier) {
    const double cost = enough_cheaper * get(choice_.setting).trial.cpu;
    if (choice_.cpu + cost > options_.limit) return false;
    const Known& run = get(other, cost);
    const Disagreement d = compare(run, verifier);
    if (!std::isfinite(d.rms)) return false;
    double error = d.rms + 0.2 * verified_;
    if (at_stations_) error = std::max(error, from_stations(run).rms);
    choice_.pilots[run.pilot].error = error;
    if (error > 0.9 * options_.accuracy || run.trial.cpu > cost) return false;
    choice_.setting = other;
    choice_.error = error;
    choice_.worst = d.worst;
    differs_from_ = d.from;
    return true;
  }

  void try_cheaper(const Mesh& mesh) {
    if (!moving() || fixed_ || !choice_.error) return;
    const Known& chosen = get(setting(mesh, tolerance_));
    if (chosen.trial.cpu < worth_a_look) return;
    verified_ = *choice_.error;  // above that of the verifier
    const Known& verifier = get(setting(flexible() ? finer(mesh) : mesh, better(tolerance_)));
    // The scene's own way in time, on this mesh and on its own.
    if (scene_.transient->step && options_.accuracy >= 1e-4) {
      Setting own;
      if (flexible()) {
        own.order = mesh.order;
        own.elements = mesh.elements;
        take_if_cheaper(own, verifier);
      }
      take_if_cheaper({}, verifier);
    }
    // Velocities that nothing recorded sees need not be followed.
    if (!errors_ && !scene_.transient->errors &&
        errors_of(with(scene_, choice_.setting)) == ErrorsOf::velocities)
      for (const double times : {1.0, 10.0}) {
        Setting motion = setting(mesh, std::min(coarsest_tolerance, times * tolerance_));
        motion.errors = ErrorsOf::motion;
        if (!take_if_cheaper(motion, verifier)) break;
      }
    // Smooth motions need no steps of different lengths, nor what finds them.
    for (double n = std::floor(0.5 * static_cast<double>(chosen.trial.counters.steps)); n >= 1.0;
         n = std::floor(0.5 * n)) {
      Setting steps = setting(mesh, tolerance_);
      steps.tolerance.reset();
      steps.errors.reset();
      steps.step = scene_.transient->duration / n;
      if (!take_if_cheaper(steps, verifier)) break;
    }
    while (flexible() && choice_.setting.elements && *choice_.setting.elements > 1) {
      Setting fewer = choice_.setting;
      fewer.elements = (*fewer.elements + 1) / 2;
      if (take_if_cheaper(fewer, verifier)) continue;
      if (*fewer.order >= usual_highest) break;
      ++*fewer.order;
      if (!take_if_cheaper(fewer, verifier)) break;
    }
  }

  // The scene as chosen, but with ends of elements at all stations of linear tables that had kinks inside; nothing where there
  // are none. `whose`: a beam of them.
  std::optional<Scene> with_ends_at_stations(std::string& whose) const {
    Scene scene = with(scene_, choice_.setting);
    for (BeamScene& beam : scene.beams) {
      const Section* const section = section_of(scene, beam);
      if (section == nullptr || section->interpolation != Interpolation::linear ||
          beam.mesh == mbd::Mesh::stations)
        continue;
      const auto is_inside = [&](const Station& station) {
        const double place = station.at * beam.elements;
        return std::abs(place - std::round(place)) > 1e-9;
      };
      if (std::none_of(section->stations.begin(), section->stations.end(), is_inside)) continue;
      const auto parts = static_cast<int>(section->stations.size()) - 1;
      beam.mesh = mbd::Mesh::stations;
      beam.elements = (beam.elements + parts - 1) / parts;
      whose = beam.name;
    }
    if (whose.empty()) return std::nullopt;
    return scene;
  }

  LoadSampling missed_loads(const Mesh& mesh) const {
    if (scene_.distributed_loads.empty()) return {};
    const Scene scene = with(scene_, setting(mesh, tolerance_));
    return load_sampling(scene, compile(scene));
  }

  // A load along a beam may do something between all nodes of all runs, which then agree. Where nodes do not see it (load_sampling.hpp)
  // one more run tells whether it matters, on elements that do. Returns the mesh to go on with, `mesh` where it does not.
  Mesh look_at_loads(const Mesh& mesh, const Known& run) {
    constexpr double far_less = 0.1, less = 0.5;
    const LoadSampling missed = missed_loads(mesh);
    loads_seen_ = true;
    if (!(missed.error > options_.accuracy)) return mesh;
    const std::optional<double> believed = std::exchange(choice_.error, std::nullopt);
    Mesh sees = mesh;
    double left = missed.error;
    while (left > std::max(options_.accuracy, far_less * missed.error)) {
      const Mesh more = divided(sees, false);
      if (more.elements > most_elements) break;
      sees = more;
      left = missed_loads(sees).error;
    }
    if (left > less * missed.error)
      throw Enough{
          fmt::format("{} changes within less than an element, of which more than {} are "
                      "not tried",
                      missed.where, most_elements)};
    const Disagreement d = compare(run, get(setting(sees, tolerance_)));
    if (!(d.rms <= 0.9 * options_.accuracy)) {
      choice_.pilots[run.pilot].error = d.rms;
      return sees;
    }
    choice_.error = std::max(*believed, d.rms);
    return mesh;
  }

  // The same of a setting with which the search ended, which is not met where they matter.
  void look_at_loads_of(const Setting& chosen) {
    const Setting own = setting_of(with(scene_, chosen));
    if (!own.order || !own.elements) return;
    const Mesh mesh{*own.order, *own.elements};
    if (look_at_loads(mesh, get(chosen)) != mesh)
      throw Enough{"distributed loads change within less than an element"};
  }

  // Kinks inside elements are smoothed by every order alike: runs that agree may all be wrong. One run whose elements end there
  // tells; what is cheaper is held against it too.
  void look_at_stations(const Known& run) {
    std::string whose;
    const std::optional<Scene> scene = with_ends_at_stations(whose);
    if (!scene) return;
    at_stations_ = try_out(
        run.setting, "the same, mesh=\"stations\"", [&] { return *scene; },
        std::max(options_.limit - choice_.cpu, 0.0));
    const std::string remedy = fmt::format(
        "the table of beam \"{}\" has kinks inside its elements; give it mesh=\"stations\"", whose);
    if (!at_stations_->complete) {
      choice_.error.reset();
      throw Enough{
          fmt::format("a run that ends elements at the stations of tables did not come to "
                      "its end: {}",
                      remedy)};
    }
    const Disagreement d = from_stations(run);
    if (!(d.rms > *choice_.error)) return;
    choice_.error = d.rms;
    choice_.worst = d.worst;
    if (d.rms > options_.accuracy)
      throw Enough{
          fmt::format("{} (elements that end there move {} by {:.1e})", remedy, d.worst, d.rms)};
  }

  Disagreement from_stations(const Known& run) const {
    return disagreement(run.trial.findings, at_stations_->findings, options_.accuracy,
                        options_.quantities, length_);
  }

  void finish() {
    if (!choice_.error) {  // the best of what came to its end, the finest being the last
      for (const Known& known : known_)
        if (known.trial.complete) choice_.setting = known.setting;
    }
    if (lost_) choice_.error.reset();
    choice_.met = choice_.error && *choice_.error <= options_.accuracy;
    if (choice_.met) choice_.reason.clear();
    if (!choice_.met && choice_.reason.empty()) choice_.reason = "no finer setting was found";
    if (!as_zero_.empty())
      choice_.notes.push_back(fmt::format(
          "{} {} zero within the accuracy, and measured by the largest quantity of that unit",
          fmt::join(as_zero_, ", "), as_zero_.size() == 1 ? "is" : "are"));
    if (scene_.transient)
      for (const auto& limit :
           {scene_.transient->position_tolerance, scene_.transient->rotation_tolerance,
            scene_.transient->velocity_tolerance, scene_.transient->angular_velocity_tolerance})
        if (limit) {
          choice_.notes.push_back(
              "limits of errors in units, which the <transient> gives, stay in force beside the "
              "chosen tolerance");
          break;
        }
  }

  const Scene& scene_;
  const ChooseOptions& options_;
  Choice choice_;
  std::deque<Known> known_;         // references stay good
  bool fixed_ = false;              // fractions of the model's own step, in place of tolerances
  double tolerance_ = 0.0;          // or that fraction
  std::optional<ErrorsOf> errors_;  // the scene's own where there is none
  double in_time_ = 0.0;
  bool time_is_guessed_ = false;      // the tolerance follows from runs on another mesh
  int least_elements_ = 1;            // with fewer they are bent too far as they are
  double length_ = 0.0;               // of the scene [m]
  double verified_ = 0.0;             // believed of the run that was verified
  bool loads_seen_ = false;           // it is known what nodes miss of distributed loads
  std::optional<Trial> at_stations_;  // with ends of elements where tables had kinks inside
  // Nothing is believed yet: the finest run in time whose differences fell, and the CPU time kept to judge it [s].
  std::optional<Kept> kept_;
  double reserve_ = 0.0;
  bool lost_ = false;
  std::optional<double> differs_from_;
  std::vector<std::string> as_zero_;
};

}  // namespace

Disagreement disagreement(const Findings& run, const Findings& better, double accuracy,
                          const std::vector<std::string>& quantities, double length) {
  Disagreement result;
  if (run.columns != better.columns || run.at.size() != better.at.size() || better.at.empty()) {
    result.rms = infinite;
    return result;
  }
  // Forces beside moments over the scene, and the reverse: what is less is round-off of statics.
  constexpr double nothing_beside = 1e-9;
  double most_force = 0.0, most_moment = 0.0;
  for (const std::vector<double>& row : better.rows)
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (better.units[c] == "N") most_force = std::max(most_force, std::abs(row[c]));
      if (better.units[c] == "N.m") most_moment = std::max(most_moment, std::abs(row[c]));
    }
  for (const Components& vector : vectors_of(better, quantities)) {
    // What somebody asks for by name is not zero because another is large; total energies cancel, asked for or not.
    const double zero = quantities.empty() || vector.unit == "J" ? accuracy : zero_by_name;
    Scale scale = scale_of(vector, better, better.rows.size(), zero, Measure::change);
    if (length > 0.0) {
      const double beside = nothing_beside * (vector.unit == "N"     ? most_moment / length
                                              : vector.unit == "N.m" ? most_force * length
                                                                     : 0.0);
      if (scale.value < beside) scale = {beside, true};
    }
    if (scale.is_zero) result.as_zero.push_back(vector.name);
    double sum = 0.0;
    std::optional<double> from;
    for (std::size_t k = 0; k < better.rows.size(); ++k) {
      const double d = distance(vector, run, k, better, k) / scale.value;
      sum += d * d;
      if (d > accuracy && !from) from = better.at[k];
    }
    const double rms = std::sqrt(sum / static_cast<double>(better.rows.size()));
    if (rms > result.rms || result.worst.empty()) {
      result.rms = rms;
      result.worst = vector.name;
      result.from = from;
    }
  }
  return result;
}

Choice choose(const Scene& scene, const ChooseOptions& options) {
  if (!(options.accuracy >= finest_accuracy && options.accuracy <= coarsest_accuracy))
    throw Error(
        fmt::format("--accuracy {:g}: must be between {:g} and {:g}: the rms error of what is "
                    "recorded, over its largest value",
                    options.accuracy, finest_accuracy, coarsest_accuracy));
  if (scene.records.empty())
    throw Error(scene.source,
                "--accuracy is of recorded quantities, and the model has none; add a <record>");
  return Chooser(scene, options).go();
}

ChosenAccuracy summary_of(const Choice& choice) {
  ChosenAccuracy chosen{.requested = choice.accuracy,
                        .quantities = choice.quantities,
                        .believed = choice.error,
                        .quantity = choice.worst,
                        .met = choice.met,
                        .reason = choice.reason,
                        .cpu = choice.cpu};
  for (const Pilot& pilot : choice.pilots) {
    chosen.pilots.push_back({pilot.text, pilot.cpu, pilot.error, pilot.cut_off, pilot.failure});
    if (pilot.setting == choice.setting && chosen.setting.empty()) chosen.setting = pilot.text;
  }
  return chosen;
}

}  // namespace mbd
