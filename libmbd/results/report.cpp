#include "libmbd/results/report.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/scene/transient.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Seconds& s) { return {{"wall", s.wall}, {"cpu", s.cpu}}; }

Json json(const Energies& e) {
  return {{"kinetic", e.kinetic},
          {"strain", e.strain},
          {"potential", e.potential},
          {"total", e.total()}};
}

Json json(const WorstConstraint& worst) {
  return {{"largest", worst.value}, {"time", worst.time}, {"where", worst.where}};
}

Json json(const Vec6& momentum) {
  return {{"linear", {momentum(0), momentum(1), momentum(2)}},
          {"angular_about_origin", {momentum(3), momentum(4), momentum(5)}}};
}

Json json(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

Json json(const ChosenAccuracy& accuracy) {
  Json pilots = Json::array();
  for (const ChosenAccuracy::Pilot& pilot : accuracy.pilots)
    pilots.push_back({{"setting", pilot.setting},
                      {"cpu", pilot.cpu},
                      {"error", json(pilot.error)},
                      {"cut_off", pilot.cut_off},
                      {"failure", pilot.failure.empty() ? Json() : Json(pilot.failure)}});
  return {{"requested", accuracy.requested},
          {"quantities", accuracy.quantities},
          {"believed", json(accuracy.believed)},
          {"quantity", accuracy.quantity},
          {"setting", accuracy.setting},
          {"met", accuracy.met},
          {"reason", accuracy.met ? Json() : Json(accuracy.reason)},
          {"cpu", accuracy.cpu},
          {"pilots", pilots}};
}

Json json(const Certificate& certificate) {
  Json checks = Json::array();
  for (const Check& check : certificate.checks)
    checks.push_back({{"name", check.name},
                      {"verdict", name_of(check.verdict)},
                      {"value", check.has_value() ? Json(check.value) : Json()},
                      {"warn_above", check.warn},
                      {"fail_above", check.fail},
                      {"unit", check.unit},
                      {"where", check.where},
                      {"why", check.why}});
  const Check* const culprit = certificate.culprit();
  return {{"verdict", name_of(certificate.verdict())},
          {"culprit", culprit != nullptr ? Json(culprit->name) : Json()},
          {"certified", certificate.certified},
          {"covers", certificate.covers()},
          {"does_not_cover", certificate.not_covered()},
          {"checks", checks}};
}

Json json(const LinearFacts& facts) {
  return {{"method", facts.method},
          {"factorizations", facts.factorizations},
          {"by_klu", facts.fallbacks},
          {"why_klu", facts.reason.empty() ? Json() : Json(facts.reason)},
          {"refinements", facts.refinements}};
}

Json json(const Counters& c) {
  Json all = Json::object();
  for (const NamedCounter& n : named_counters) all[std::string(n.name)] = c.*n.counter;
  return all;
}

// Those that a run with this transient uses, and no others.
Json settings(const TransientScene& transient) {
  Json all = {{"method", name_of(transient.method)}, {"duration", transient.duration}};
  const auto given = [&all](const char* name, const std::optional<double>& value) {
    if (value) all[name] = *value;
  };
  given("step", transient.step);
  given("tolerance", transient.tolerance);
  given("position_tolerance", transient.position_tolerance);
  given("rotation_tolerance", transient.rotation_tolerance);
  given("velocity_tolerance", transient.velocity_tolerance);
  given("angular_velocity_tolerance", transient.angular_velocity_tolerance);
  given("max_step", transient.max_step);
  if (transient.errors) all["errors"] = name_of(*transient.errors);
  const std::optional<double> interval = row_interval(transient);
  all["output"] = interval ? Json(*interval) : Json("steps");
  if (transient.method == TimeMethod::generalized_alpha) {
    all["rho_infinity"] = rho_infinity_of(transient);
    all["balance"] = name_of(transient.balance.value_or(Balance::acceleration));
  }
  if (transient.method == TimeMethod::radau) all["stages"] = name_of(stages_of(transient));
  all["linear_solver"] =
      name_of(transient.method == TimeMethod::ida ? LinearMethod::klu : transient.linear_solver);
  if (transient.inertia != InertiaTerms::full) all["inertia"] = "no_gyroscopic";
  if (takes_newton_tolerance(transient)) {
    const NewtonOptions newton = newton_options(transient);
    all["newton_tolerance"] = newton.tolerance;
    all["multiplier_tolerance"] = newton.multiplier_tolerance;
    all["max_iterations"] = newton.max_iterations;
  }
  return all;
}

Json settings(const RunReport& report) {
  Json all = Json::object();
  Json& parameters = all["parameters"] = Json::object();
  for (const auto& [name, value] : report.parameters) parameters[name] = value;
  if (report.statics) {
    const bool newton = report.statics->solver == StaticSolver::newton;
    all["static"] = {{"solver", newton ? "newton" : "kinsol"},
                     {"line_search", !newton || report.statics->line_search},
                     {"linear_solver", name_of(report.statics->linear_solver)},
                     {"steps", report.statics->steps},
                     {"tolerance", report.statics->tolerance}};
  }
  if (report.path)
    all["path"] = {
        {"method", report.path->method == PathMethod::crisfield ? "crisfield" : "bordered"},
        {"step", report.path->step},
        {"max_step", report.path->max_step},
        {"points", report.path->points},
        {"branch", report.path->branch},
        {"tolerance", report.path->tolerance}};
  if (report.transient) all["transient"] = settings(*report.transient);
  return all;
}

Json json(const std::vector<BatchReport>& batches) {
  Json all = Json::array();
  for (const BatchReport& batch : batches)
    all.push_back({{"type", batch.type}, {"size", batch.size}, {"bytes", batch.bytes}});
  return all;
}

Json json(const std::vector<ExpectResult>& expects) {
  Json all = Json::array();
  for (const ExpectResult& expect : expects)
    all.push_back({{"quantity", expect.what},
                   {"expected", expect.expected},
                   {"got", expect.got ? Json(*expect.got) : Json()},
                   {"tolerance", expect.tolerance},
                   {"pass", expect.pass()},
                   {"source", expect.reference}});
  return all;
}

Json newton(const Counters& counters, int most_iterations) {
  Json all = json(counters);
  all["most_iterations_in_a_step"] = most_iterations;
  return all;
}

Json static_solver(const RunReport& report) {
  Json all = newton(report.static_counters, report.most_static_iterations);
  all["load_steps_by_line_search"] = report.searched_steps;
  if (!report.static_linear.method.empty()) all["linear_solver"] = json(report.static_linear);
  return all;
}

Json transient_solver(const RunReport& report) {
  Json all = newton(report.transient_counters, report.most_iterations);
  if (!report.transient_linear.method.empty()) all["linear_solver"] = json(report.transient_linear);
  if (const std::optional<RoundOff>& floor = report.round_off)
    all["round_off_of_the_last_step"] = {{"velocity", floor->velocity},
                                         {"constraint_force", floor->force},
                                         {"constraint_moment", floor->moment},
                                         {"reciprocal_condition", floor->reciprocal_condition}};
  if (const LawFacts& laws = report.laws; laws.laws > 0)
    all["laws_of_time"] = {
        {"number", laws.laws},
        {"longest_step", laws.longest_step > 0.0 ? Json(laws.longest_step) : Json()},
        {"at", laws.at},
        {"by", laws.which},
        {"unresolved", laws.unresolved}};
  if (report.transient->tolerance) {
    const StepSizes& sizes = report.step_sizes;
    all["least_step"] = sizes.least;
    all["most_step"] = sizes.most;
    if (report.transient->method != TimeMethod::ida) {  // which keeps its estimates to itself
      all["largest_error_of_a_step"] = sizes.worst_error;
      all["sum_of_errors"] = {{"position", sizes.position_error},
                              {"rotation", sizes.rotation_error}};
    }
    if (report.transient->errors == ErrorsOf::motion)
      all["largest_velocity_error_not_held"] = sizes.velocity_left;
  }
  return all;
}

Json path_followed(const RunReport& report) {
  Json special = Json::array();
  for (const SpecialPoint& point : report.special)
    special.push_back({{"event", name_of(point.event)},
                       {"number", point.number},
                       {"branch", point.branch},
                       {"load_factor", point.load_factor},
                       {"arc_length", point.arc_length},
                       {"negative_eigenvalues_before", point.before ? Json(*point.before) : Json()},
                       {"negative_eigenvalues_after", point.after ? Json(*point.after) : Json()},
                       {"largest_motion", point.motion}});
  return {{"end", report.path_end},
          {"least_load_factor", report.path_load[0]},
          {"most_load_factor", report.path_load[1]},
          {"special_points", special}};
}

Json energy(const RunReport& report) {
  Json all = {{"start", json(report.energy_start)},
              {"end", json(report.energy_end)},
              {"least_total", report.energy_least},
              {"most_total", report.energy_most}};
  if (!report.transient) return all;
  all["work_of_loads"] = report.work.loads;
  all["work_of_drives"] = report.work.drives;
  all["work_of_damping"] = report.work.damping;
  all["dissipated_by_integrator"] = report.dissipated();
  return all;
}

Json json(const TimeError& error) {
  if (!error.known) return {{"relative", nullptr}, {"why", error.why_not}};
  Json all = {{"relative", error.relative}, {"displacement", error.displacement},
              {"rotation", error.rotation}, {"where", error.node},
              {"time", error.time},         {"until", error.until},
              {"from_a_run_in", error.how}};
  if (error.recorded >= 0.0)
    all["recorded"] = {{"over_its_change", error.recorded},
                       {"record", error.record},
                       {"time", error.recorded_time}};
  return all;
}

}  // namespace

std::string_view name_of(PathEvent event) {
  switch (event) {
    case PathEvent::limit:
      return "limit point";
    case PathEvent::bifurcation:
      return "bifurcation";
    case PathEvent::crossing:
      return "mark";
    case PathEvent::none:
      break;
  }
  return "point";
}

std::string_view version() { return MBD_VERSION; }

bool ExpectResult::pass() const { return got && std::abs(*got - expected) <= tolerance; }

double RunReport::energy_moved() const {
  return std::max({kinetic_most, energy_most - energy_least, std::abs(work.loads),
                   std::abs(work.drives), std::abs(work.damping)});
}

bool RunReport::as_expected() const {
  return complete() && std::all_of(expects.begin(), expects.end(),
                                   [](const ExpectResult& result) { return result.pass(); });
}

std::string to_json(const RunReport& report) {
  Json all = Json::object();
  all["model"] = report.model;
  all["file"] = report.file;
  all["version"] = version();
  Json& build = all["build"] = Json::object();
  for (const auto& [name, value] : to_lines(build_facts())) build[name] = value;
  all["date"] = report.date;
  all["run"] = report.id;
  all["status"] = !report.complete()     ? "failed"
                  : report.as_expected() ? "complete"
                                         : "complete, not as expected";
  all["failure"] = report.complete() ? Json() : Json(report.failure);
  if (!report.complete()) all["failure_kind"] = name_of(report.kind);
  all["redundant_constraints"] = report.redundant;
  all["notes"] = report.notes;
  all["reached"] = {{"time", report.t}, {"load_factor", report.load_factor}, {"rows", report.rows}};
  all["settings"] = settings(report);
  if (report.accuracy) all["accuracy"] = json(*report.accuracy);

  all["counts"] = {{"nodes", report.nodes},
                   {"unknowns", report.unknowns},
                   {"multipliers", report.multipliers},
                   {"batches", json(report.batches)}};
  Json& solver = all["solver"] = Json::object();
  if (report.statics) solver["static"] = static_solver(report);
  if (report.path) solver["path"] = newton(report.static_counters, report.most_static_iterations);
  if (report.transient) solver["transient"] = transient_solver(report);
  if (report.statics)
    all["negative_eigenvalues"] =
        report.negative_eigenvalues ? Json(*report.negative_eigenvalues) : Json();
  if (report.path) all["path"] = path_followed(report);

  all["sampled_states"] = report.sampled_states;
  all["constraint_residuals"] = {{"position", json(report.position)},
                                 {"velocity", json(report.velocity)}};
  all["energy"] = energy(report);
  if (report.transient)
    all["momentum"] = {{"start", json(report.momentum_start)}, {"end", json(report.momentum_end)}};
  all["seconds"] = {{"compile", json(report.compile)},
                    {"static", json(report.equilibrium)},
                    {"transient", json(report.integration)},
                    {"output", json(report.output)},
                    {"error_estimate", json(report.estimate)}};

  if (report.time_error) all["error_in_time"] = json(*report.time_error);
  all["certificate"] = json(report.certificate);
  all["expectations"] = json(report.expects);
  // Names from a model may hold bytes that are not UTF-8: replaced, not refused.
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mbd
