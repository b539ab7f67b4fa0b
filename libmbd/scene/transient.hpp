// What a <transient> means: its steps, the method's own values where it gives none, and the times at which rows of
// results are written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// Number of fixed steps. Throws Error when the duration is not a whole number of steps to 1e-9 of itself (a
// shorter last step would change the integrator's error and is not what was asked for), and for a transient
// without `step`.
long number_of_steps(const TransientScene& transient);

// Where it is false the method derives the tolerance of its iterations from that of the error.
bool takes_newton_tolerance(const TransientScene& transient);

// The method's own where the scene gives none.
double rho_infinity_of(const TransientScene& transient);
StageCount stages_of(const TransientScene& transient);

// Of a step of Radau IIA: 3, 5 or 7; 0: as it goes.
std::size_t radau_stages(const TransientScene& transient);

// Other settings for a <transient>; what is absent stays.
struct SteppingChange {
  std::optional<TimeMethod> method = {};
  std::optional<double> step = {}, tolerance = {};  // [s], relative; one of them at most
  std::optional<StageCount> stages = {};            // of radau
};

// Makes the change, and leaves out what does not go with it then; rows of results stay where the scene has them.
// Returns a sentence for each attribute that is not used any more.
std::vector<std::string> change_stepping(TransientScene& transient, const SteppingChange& change);

// Time between rows of results [s]; the last may come sooner after the one before. Nothing where rows are written
// at the ends of steps and at the times of expected values.
std::optional<double> row_interval(const TransientScene& transient);

// When rows of results are written, besides t = 0 and the end.
class RowTimes {
 public:
  // `scene` has a <transient>. Throws Error as number_of_steps() does, and for more rows than any file holds.
  explicit RowTimes(const Scene& scene);

  bool at_steps() const { return at_steps_; }  // one where each step ends, and
  // at these times [s], which rise: infinity after the last. Those at the ends of fixed steps among them, unless
  // at_steps().
  double next() const { return next_; }
  void advance();
  // Whether some of them lie inside fixed steps. Of other steps all may.
  bool inside_steps() const { return inside_steps_; }

  double end() const { return end_; }      // of the last step, but for round-off [s]
  double slack() const { return slack_; }  // round-off of times [s]

 private:
  double at(long k) const;

  bool at_steps_ = false, inside_steps_ = false;
  double interval_ = 0.0;  // 0: those of the list
  std::vector<double> list_;
  double end_ = 0.0, slack_ = 0.0, next_ = 0.0;
  long k_ = 0;
};

}  // namespace mbd
