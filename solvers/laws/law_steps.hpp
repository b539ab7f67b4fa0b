// Steps that do not pass over what the laws of time do: of loads, drives, motions, a moving base.
//
// Each law has cells (libmbd/core/law_cells.hpp), of a load by its value, of what drives by its value and two
// derivatives. A step may reach over three cells of a law at most: over half a period of a sine, and never over a
// whole bump, which has five and more. An estimate of the error then sees each of them.
#pragma once

#include <string>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

// What is known of the laws of time of a run.
struct LawFacts {
  int laws = 0;  // that vary
  double longest_step =
      0.0;            // [s] that resolves all of them everywhere; 0: no law asks for a limit
  double at = 0.0;    // [s] where that is needed
  std::string which;  // and by which law, as messages call it
  std::vector<std::string> unresolved;  // where a law is not resolved, one sentence for each law

  // A fixed step, or the most that steps reached over where laws ask for less: cells passed over those allowed.
  double reach = 0.0;
};

// A law of time, sensors and inputs as laws of time alone, where these are held at some numbers; those that are finite at
// `begin` [s].
std::vector<Expression> held_laws(const Expression& law, double begin);

class LawSteps {
 public:
  LawSteps() = default;
  // From `begin` to `end` [s].
  LawSteps(const System& system, double begin, double end);

  static constexpr std::size_t reach = 3;  // cells of a law that a step may reach over

  // The latest end of a step from t [s]; infinity: no law asks for one.
  double end_of_step(double t, std::size_t cells = reach) const;

  const LawFacts& facts() const { return facts_; }
  // The same, with `reach` of fixed steps of h [s].
  LawFacts facts_for(double h) const;

 private:
  struct Limits {
    std::vector<double> ends;  // of the cells of a law
    std::string name;          // as messages call it
  };
  std::vector<Limits> limits_;  // of laws with more cells than a step may reach over
  LawFacts facts_;
};

}  // namespace mbd
