// What laws of the motion (of springs, dampers, loads with sensors) do that a step goes over: between two places at which their
// arguments are known, a law goes up and comes down, and neither the method nor its estimate of errors knows of it.
//
// Of each law the cells (libmbd/core/law_cells.hpp; of a table its pieces) in the range that its argument has been in, and half as
// much beside it, are found when they are asked for. Over how many of them a step may go between two known places is that of laws
// of time (law_steps.hpp), unless the law stays between its values at both: a friction that turns round is no bump.
// Of a law with several sensors, each by itself with the others as they were at first, or 1 where they were 0: what moves with them
// may be missed.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

class PassedFeatures {
 public:
  explicit PassedFeatures(const System& system) : system_(system) {}

  // The first time [s] between the states, of rising times, by which an argument has gone over as much as it may and goes over
  // more; nothing: none does. Costs nothing where there are no such laws.
  std::optional<double> end(const State& begin, std::span<const State> inside, const State& end);

 private:
  struct Known {
    const Law* law = nullptr;         // or
    std::optional<Expression> other;  // of a sensor
    bool is_plain = false;            // there is nothing to go over
    double lo = 0.0, hi = 0.0;
    std::vector<double> places, values;  // ends of cells, rising, and the middles
    double least = 0.0, most = 0.0;      // of the values

    double at(double x) const { return law != nullptr ? (*law)(x).f : (*other)(x).v; }
    const Expression* expression() const { return law == nullptr ? &*other : law->expression(); }
    bool is_table() const { return expression() == nullptr; }
    static bool is_polynomial(const Expression& f);
    void cover(double x);
    void find();
  };
  // Arguments of all laws at a state; laws that are new are added to those known.
  void look(const State& state, std::vector<double>& x);
  static std::optional<double> over(Known& law, double from, double to);

  const System& system_;
  std::optional<bool> any_;  // whether there are such laws; not yet known
  std::vector<Known> known_;
  std::vector<double> before_, after_;
  std::vector<LawArgument> arguments_;
};

}  // namespace mbd
