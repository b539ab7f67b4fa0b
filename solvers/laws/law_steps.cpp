#include "solvers/laws/law_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "libmbd/core/law_cells.hpp"

namespace mbd {
namespace {

constexpr long most_of_all = 1'000'000;  // cells of all laws

// Longest step from the end of any cell, the shortest of them.
std::pair<double, double> narrowest(const std::vector<double>& ends) {
  std::pair<double, double> least{std::numeric_limits<double>::infinity(), 0.0};
  constexpr std::size_t reach = LawSteps::reach;
  for (std::size_t i = 0; i + reach < ends.size(); ++i)
    least = std::min(least, {ends[i + reach] - ends[i], ends[i + reach / 2]});
  return least;
}

// What sensors and inputs are held at, in SI units (Expression::held_at): at 0 what stands beside them is seen, otherwise what
// they are multiplied with.
constexpr std::array<double, 3> held_values{0.0, 1.0, -0.6};
constexpr double same_place = 1e-6;  // of the time that is looked at

}  // namespace

std::vector<Expression> held_laws(const Expression& law, double begin) {
  std::vector<Expression> all;
  for (const double value : held_values) {
    Expression held = law.held_at(value, value);
    if (std::isfinite(held(begin).v)) all.push_back(std::move(held));
  }
  return all;
}

LawSteps::LawSteps(const System& system, double begin, double end) {
  std::set<std::pair<std::string, std::size_t>>
      known;  // laws by text: many places of a load share one
  std::set<std::vector<double>> patterns;
  long left = most_of_all;
  for (std::size_t i = 0; i < system.signals().size(); ++i) {
    bool is_rate = false;
    const Expression* const law = system.signals()[i].expression(is_rate);
    if (law == nullptr || law->is_constant()) continue;
    ++facts_.laws;
    const bool drives = system.signal_use(i) == SignalUse::drive;
    static constexpr std::array<int, 2> both{1, 2};
    const std::span<const int> more(both.data(), !drives ? 0 : is_rate ? 1 : 2);
    if (!known.emplace(law->text(), more.size()).second) continue;
    const std::string& name = system.signal_name(i);
    const std::string who = name.empty() ? fmt::format("signal {}", i + 1) : name;
    const auto cells_of = [&](const Expression& of) {
      LawCells cells = find_cells(of, more, begin, end, std::min(most_cells, left));
      left = std::max(left - cells.count(), 1L);
      return cells;
    };
    const auto limit = [&](LawCells cells) {
      if (cells.ends.size() <= reach + 1) return;
      if (!patterns.insert(cells.ends).second) return;
      const auto [step, at] = narrowest(cells.ends);
      if (facts_.longest_step == 0.0 || step < facts_.longest_step) {
        facts_.longest_step = step;
        facts_.at = at;
        facts_.which = who;
      }
      limits_.push_back({std::move(cells.ends), who});
    };
    const auto say = [&](const LawCells& cells) {
      facts_.unresolved.push_back(fmt::format(
          "{} is not resolved near t = {:.9g} s, where it changes {}", who, *cells.unresolved,
          cells.count() >= std::min(most_cells, left)
              ? fmt::format("too often: {} cells are spent", cells.count())
              : std::string("within a time too short to be told apart, or has a pole")));
    };
    if (!law->has_inputs() && !law->has_sensors()) {
      LawCells cells = cells_of(*law);
      if (cells.unresolved) say(cells);
      limit(std::move(cells));
      continue;
    }
    std::vector<LawCells> unresolved;
    for (const Expression& held : held_laws(*law, begin)) {
      LawCells cells = cells_of(held);
      if (cells.unresolved)
        unresolved.push_back(std::move(cells));
      else
        limit(std::move(cells));
    }
    // At the same time whatever is held; elsewhere it may be a pole to which sensors need not come.
    const double near = same_place * (end - begin);
    if (unresolved.size() > 1 &&
        std::abs(*unresolved.front().unresolved - *unresolved.back().unresolved) <= near)
      say(unresolved.front());
  }
}

double LawSteps::end_of_step(double t, std::size_t cells) const {
  double end = std::numeric_limits<double>::infinity();
  for (const Limits& law : limits_) {
    const auto next = std::upper_bound(law.ends.begin(), law.ends.end(), t);
    const auto over = static_cast<std::ptrdiff_t>(cells);
    if (law.ends.end() - next >= over) end = std::min(end, *(next + (over - 1)));
  }
  return end;
}

LawFacts LawSteps::facts_for(double h) const {
  LawFacts facts = facts_;
  const double allowed = h * (1.0 + 1e-9);
  for (const auto& [ends, name] : limits_) {
    for (std::size_t i = 0, j = 0; i < ends.size(); ++i) {
      while (j + 1 < ends.size() && ends[j + 1] <= ends[i] + allowed) ++j;
      const double cells = static_cast<double>(j - i) / static_cast<double>(reach);
      if (cells > facts.reach) {
        facts.reach = cells;
        if (cells > 1.0) {
          facts.which = name;
          facts.at = ends[(i + j) / 2];
        }
      }
    }
  }
  return facts;
}

}  // namespace mbd
