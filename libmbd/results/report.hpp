// What a run says of itself, and report.json.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libmbd/core/batch.hpp"
#include "libmbd/core/state.hpp"
#include "libmbd/results/certificate.hpp"
#include "libmbd/scene/scene.hpp"
#include "solvers/newton/report.hpp"
#include "solvers/statics/path.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {

std::string_view version();  // of the library, "0.1.0"

// Every counter, and what reports call it.
struct NamedCounter {
  std::string_view name;
  long Counters::*counter;
};
inline constexpr std::array<NamedCounter, 13> named_counters{{
    {"steps", &Counters::steps},
    {"substeps", &Counters::substeps},
    {"retries", &Counters::retries},
    {"rejected", &Counters::rejected},
    {"rank_tolerant_steps", &Counters::tolerant},
    {"restarts", &Counters::restarts},
    {"passed_kinks", &Counters::passed_kinks},
    {"iterations", &Counters::iterations},
    {"residuals", &Counters::residuals},
    {"tangents", &Counters::tangents},
    {"factorizations", &Counters::factorizations},
    {"substeps_of_five_stages", &Counters::of_five_stages},
    {"substeps_of_seven_stages", &Counters::of_seven_stages},
}};

struct Seconds {
  double wall = 0.0;
  double cpu = 0.0;  // of all threads
};

struct BatchReport {
  std::string type;
  Index size = 0;         // elements or joints
  std::size_t bytes = 0;  // of their data
};

// Largest violation of a constraint over the sampled states.
struct WorstConstraint {
  double value = 0.0;
  double time = 0.0;  // [s]
  std::string where;  // "revolute 'C', force 1"
};

// An expected number and what the run gave.
struct ExpectResult {
  Source source;
  std::string what;  // "C.displacement.3 at 0.999"
  double expected = 0.0;
  std::optional<double> got;  // empty: the run did not come that far
  double tolerance = 0.0;
  std::string reference;
  bool pass() const;
};

// How the settings of a run were chosen for an accuracy (libmbd/study/accuracy/choose.hpp has norms and ways).
struct ChosenAccuracy {
  double requested = 0.0;
  std::vector<std::string> quantities = {};  // that were asked for; none: all that are recorded
  std::optional<double> believed = {};       // error of this run; nothing: not known
  std::string quantity = {};                 // of which it is the error, the worst
  std::string setting = {};                  // "order 3, 2 elements, radau, tolerance 1e-05"
  bool met = false;
  std::string reason = {};  // if not
  double cpu = 0.0;         // of choosing [s]
  struct Pilot {
    std::string setting;
    double cpu = 0.0;             // [s]
    std::optional<double> error;  // believed
    bool cut_off = false;         // it would have taken longer than it may
    std::string failure;
  };
  std::vector<Pilot> pilots = {};
};

struct RunReport {
  std::string model, file, date;
  std::string id;  // of the run (history.hpp)
  std::vector<std::pair<std::string, double>> parameters;
  std::optional<StaticScene> statics;
  std::optional<TransientScene> transient;
  std::optional<PathScene> path;
  std::optional<ChosenAccuracy> accuracy;

  std::string failure;                 // empty: all went well (expectations apart)
  Failure kind = Failure::none;        // of what kind it is
  std::vector<std::string> redundant;  // constraints that repeat others, by joint
  std::vector<std::string> notes;      // what a user should know of a run that went well
  double t = 0.0;                      // reached [s]
  double load_factor = 1.0;            // reached
  long rows = 0;                       // of history.csv

  Index nodes = 0, unknowns = 0, multipliers = 0;
  std::vector<BatchReport> batches;
  Counters static_counters, transient_counters;
  LinearFacts static_linear, transient_linear;  // of their linear solvers
  StepSizes step_sizes;                         // of a transient
  LawFacts laws;                                // of time, in a transient
  std::optional<RoundOff> round_off;  // of its last step; nothing where the method does not know it
  int searched_steps = 0;             // load steps that the line search saved
  int most_static_iterations = 0, most_iterations = 0;  // in one load step, one time step

  // Of a <path>, and stability of the equilibrium of a <static>, where forces have a potential.
  std::vector<SpecialPoint> special;
  std::string path_end;               // why its branches end
  std::array<double, 2> path_load{};  // least and most load factor
  std::optional<Index> negative_eigenvalues;

  // Of states sampled evenly, the last among them.
  int sampled_states = 0;
  WorstConstraint position, velocity;            // |g| [m, rad], |gdot| [m/s, rad/s]
  Energies energy_start, energy_end;             // [J]
  double energy_least = 0.0, energy_most = 0.0;  // total [J]
  double kinetic_most = 0.0;                     // [J]
  Work work;                                     // up to the last of them
  Vec6 momentum_start = Vec6::Zero(), momentum_end = Vec6::Zero();  // System::momentum
  // What the integrator took out (or, if negative, put in): zero to the order of its errors [J].
  double dissipated() const { return energy_start.total() + work.total() - energy_end.total(); }
  double energy_moved() const;  // largest of kinetic energy, change of the total and works [J]

  Seconds compile, equilibrium, integration, output;  // of the parts; output is in no other
  std::optional<TimeError> time_error;                // of a transient, where it was asked for
  Seconds estimate;                                   // what that took, in no other part
  Certificate certificate;
  std::vector<ExpectResult> expects;
  std::vector<std::filesystem::path> results;  // files written

  bool complete() const { return failure.empty(); }
  bool as_expected() const;  // complete, and every expectation met
};

// "limit point", "bifurcation", "mark", "point".
std::string_view name_of(PathEvent event);

std::string to_json(const RunReport& report);

}  // namespace mbd
