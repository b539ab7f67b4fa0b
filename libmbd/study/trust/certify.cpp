#include "libmbd/study/trust/certify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "elements/beam/beam_motion.hpp"
#include "libmbd/compile/control.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/study/trust/sameness.hpp"
#include "libmbd/study/trust/transform.hpp"

namespace mbd {
namespace {

constexpr int certify_samples = 100;
constexpr double certify_runs = 12.0;  // about as many, of the cost of the first
constexpr std::uint64_t certify_seed = 1;
constexpr double tolerable_error = 0.01,
                 spoiling_error = 0.1;        // errors of a method (certificate.hpp)
constexpr double certify_fail_factor = 10.0;  // of a bound of sameness

std::string until_text(const Scene& scene, const Sameness& s) {
  if (!scene.transient) return {};
  return fmt::format(
      "; compared up to {:.6g} s{}", s.until,
      s.whole ? "" : ", from where on tolerances and round-off change more than 1e-3");
}

// A quantity, in words where it is one of a probe, which no model has.
std::string quantity_text(const Scene& probed, const std::string& quantity) {
  const std::size_t dot = quantity.find('.');
  for (const RecordScene& record : probed.records) {
    if (!record.name.starts_with("certify") || quantity.substr(0, dot) != record.name) continue;
    const std::string what = quantity.substr(dot + 1);
    if (!record.at) return what;
    const bool beam = record.at->kind == Place::Kind::beam;
    return fmt::format("{} of {}{}", what, label(beam ? "beam" : "body", record.at->name),
                       !beam                        ? ""
                       : record.at->parameter > 0.5 ? " at its end"
                                                    : " at its start");
  }
  return quantity;
}

std::string where_text(const Scene& probed, const Sameness& s) {
  if (s.quantity.empty()) return {};
  const std::string quantity = quantity_text(probed, s.quantity);
  if (probed.transient) return fmt::format("{}, at {:.6g} s", quantity, s.at);
  return probed.path ? fmt::format("{}, at special point {:g}", quantity, s.at) : quantity;
}

// Nothing to compare, or a run that fails, is a warning, or a failure, with its reason.
Check check_of_run(const std::string& name, const Scene& probed, const Trial& run,
                   const Sameness& same, double fail, const std::string& why) {
  Check check{.name = name, .where = where_text(probed, same)};
  if (!run.complete) {
    check.verdict = run.stopped ? Verdict::warn : Verdict::fail;
    check.where = run.failure;
    check.why =
        run.stopped ? "it took too long" : "this run does not come to its end, the first did";
    return check;
  }
  if (!same.what.empty()) {
    check.verdict = Verdict::fail;
    check.why = same.what;
    return check;
  }
  check.value = same.difference;
  check.warn = same.bound;
  check.fail = fail;
  check.why = why + until_text(probed, same);
  if (same.comparable) return bounded_check(check);
  check.verdict = Verdict::warn;
  check.warn = check.fail = 0.0;
  check.why =
      "not compared: what tolerances and round-off change is larger than 1e-3 from the beginning";
  return check;
}

constexpr const char* bound_of_sameness =
    "largest difference beside its bound, over the size of the quantity; bound: 10 times what "
    "another tolerance and a change in the twelfth digit make, and 10 tolerances of the run";

Check check_moved(const Scene& scene, const Twins& twins, const TrialOptions& limits) {
  const double size = compile(scene).system->length_scale();
  const RigidMotion motion = random_motion(certify_seed, size);
  std::vector<std::string> not_compared;
  const Trial run = run_trial(moved(twins.scene(), motion).scene, limits);
  Sameness same;
  if (run.complete)
    same = twins.compare(moved_back(run.findings, twins.scene(), motion, not_compared));
  return check_of_run("invariance, moved rigidly", twins.scene(), run, same,
                      certify_fail_factor * same.bound, bound_of_sameness);
}

Check check_reordered(const Twins& twins, const TrialOptions& limits) {
  const Trial run = run_trial(reordered(twins.scene(), certify_seed), limits);
  const Sameness same = run.complete ? twins.compare(run.findings) : Sameness{};
  return check_of_run("invariance, another order", twins.scene(), run, same,
                      certify_fail_factor * same.bound, bound_of_sameness);
}

// `finer`: steps so.
Check check_finer(const Twins& twins, const TrialOptions& limits, const TransientScene& finer) {
  Scene again = twins.scene();
  again.transient = finer;
  const Trial run = run_trial(again, limits);
  const Sameness same =
      run.complete ? twins.compare_finer(run.findings, tolerable_error) : Sameness{};
  return check_of_run(
      finer.step ? "half the step" : "a tenth of the tolerance", twins.scene(), run, same,
      spoiling_error,
      "largest difference of displacements and rotations, over the size of the quantity: about the "
      "error of the method");
}

// Nothing where no beam can have a higher order.
std::optional<Scene> with_higher_order(const Scene& scene) {
  Scene higher = scene;
  bool any = false;
  for (BeamScene& beam : higher.beams) {
    if (beam.order >= beam::max_order) continue;
    ++beam.order;
    any = true;
  }
  if (!any) return std::nullopt;
  return higher;
}

Check check_mesh(const Twins& twins, const TrialOptions& limits, const Scene& higher) {
  const Trial run = run_trial(higher, limits);
  const Sameness same =
      run.complete ? twins.compare_finer(run.findings, tolerable_error) : Sameness{};
  return check_of_run(std::string(mesh_run), twins.scene(), run, same, spoiling_error,
                      "largest difference of displacements and rotations, over the size of the "
                      "quantity: about the error of the mesh, of its inertia too; more or higher "
                      "elements lessen it");
}

}  // namespace

void certify(const Scene& given, const CertifyOptions& options, RunReport& report) {
  const auto tell = [&](const char* what) {
    if (options.progress) options.progress(what);
  };
  std::vector<Check>& checks = report.certificate.checks;
  Scene scene = without_inertial_marks(given);
  TrialOptions limits;
  limits.samples = certify_samples;
  limits.repeats = 1;
  limits.limit = options.within;
  limits.wall = 10.0 * options.within + 10.0;
  if (scene.transient) {
    const double cost = certify_runs * (report.integration.cpu + report.equilibrium.cpu);
    if (cost > options.within)
      scene = shortened(scene, scene.transient->duration * options.within / cost);
  }
  tell("again, with another tolerance, and with numbers changed in the twelfth digit");
  const Twins twins(scene, limits);
  if (!twins.failure().empty()) {
    checks.push_back({.name = "invariance",
                      .where = twins.failure(),
                      .why = "the runs that it is measured by do not come to their end",
                      .verdict = twins.base().stopped ? Verdict::warn : Verdict::fail});
    return;
  }
  if (const std::string feedback = first_feedback(scene); !feedback.empty()) {
    report.notes.push_back("the model was not run moved rigidly: " + feedback +
                           " looks at the motion along axes that would have to be moved with it");
  } else {
    tell("moved rigidly");
    checks.push_back(check_moved(scene, twins, limits));
  }

  tell("its parts in another order");
  checks.push_back(check_reordered(twins, limits));

  if (const auto higher = with_higher_order(twins.scene()); higher && !scene.path) {
    tell("with beams of one order more");
    checks.push_back(check_mesh(twins, limits, *higher));
  }

  if (!scene.transient) return;
  TransientScene finer = *scene.transient;
  const bool fixed = finer.step.has_value();
  if (fixed)
    finer.step = 0.5 * *finer.step;
  else
    finer.tolerance = std::max(1e-13, 0.1 * *finer.tolerance);
  tell(fixed ? "half the steps" : "a tenth of the tolerance");
  checks.push_back(check_finer(twins, limits, finer));
}

}  // namespace mbd
